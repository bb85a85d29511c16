# SPDX-License-Identifier: Apache-2.0
"""The command line: arguments, exit codes, the report, the launcher."""

import importlib.util
import json
import os
import signal
import subprocess

import bake_reference as reference
import pytest
from blender_process import ROOT, blender_python, run

LAUNCHER = ROOT / "blender_addon" / "ltmd_launch.py"


def pure(name):
    """A module of the add-on that needs no Blender."""
    path = ROOT / "blender_addon" / f"{name}.py"
    spec = importlib.util.spec_from_file_location(f"pure_{name}", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """A saved file: "Sheet", "Other" and "Hidden" in "Skins"; beside it one with a driver."""
    path = tmp_path_factory.mktemp("command") / "scene.blend"
    run(
        """
        from bake_scenes import *
        collection = bpy.data.collections.new("Skins")
        bpy.context.scene.collection.children.link(collection)
        for name in ("Sheet", "Other", "Hidden"):
            obj = sheet(name, cells=8)
            keyed_shape(obj, lambda p: p * (2, 1, 1) + 0.3 * np.sin(7 * p[:, [1, 2, 0]]))
            collection.objects.link(obj)
            bpy.context.scene.collection.objects.unlink(obj)
        obj.hide_render = True
        bpy.context.scene.frame_end = 3
        bpy.ops.wm.save_as_mainfile(filepath=ARGUMENTS)
        driver = bpy.data.objects["Sheet"].driver_add("delta_scale", 0).driver
        driver.expression = "bpy.context.scene.frame_current"
        bpy.ops.wm.save_as_mainfile(filepath=ARGUMENTS.replace("scene", "driven"), copy=True)
        """,
        arguments=str(path),
    )
    return path


def launch(*arguments, **options):
    return subprocess.run(
        [blender_python(), str(LAUNCHER), *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=120,
        **options,
    )


def test_launcher_prints_one_json_report(scene, tmp_path):
    # Frames, size and file names as given; the folder relative to the shell's, not the launcher's.
    done = launch(
        "bake", scene, "--collection", "Skins", "--frames", "1-3x2", "--size", 32,
        "--rest", "frame:1", "--uv-map", "UVMap", "--out", "out", "--json", cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    assert done.stdout.count("\n") == 1
    names = [f"{name}_tension.000{frame}.exr" for name in ("Sheet", "Other") for frame in (1, 3)]
    assert report["status"] == "ok" and report["exit_code"] == 0
    assert report["frames"] == [1, 3]
    assert report["files"] == [str(tmp_path / "out" / name) for name in names]
    assert sorted(os.listdir(tmp_path / "out")) == sorted(names)
    assert report["problems"] == []
    assert len(report["warnings"]) == 1 and '"Hidden" is left out' in report["warnings"][0]
    assert [entry["name"] for entry in report["objects"]] == ["Sheet", "Other"]
    assert report["objects"][0]["vertices"] == 81 and report["objects"][0]["triangles"] == 128
    assert report["verified"] and report["seconds"] > 0
    assert reference.read(report["files"][0]).shape == (32, 32, 4)


def test_launcher_inside_blender_takes_the_open_file(scene):
    """As in `blender -b SCENE --python ltmd_launch.py -- bake …`, with the default folder."""
    got = run(
        """
        import runpy
        bpy.ops.wm.open_mainfile(filepath=ARGUMENTS[0])
        sys.argv = ["blender", "-b", ARGUMENTS[0], "--python", ARGUMENTS[1], "--",
                    "bake", "--object", "Sheet", "Other", "--frames", "2", "--size", "16"]
        runpy.run_path(ARGUMENTS[1], run_name="__main__")
        """,
        arguments=[str(scene), str(LAUNCHER)],
        addon=False,
        check=False,
    )
    assert got["_code"] == 0, got["_output"]
    assert "ltmd: 2 files written, 0 kept" in got["_output"]
    folder = scene.parent / "ltmd"
    assert sorted(os.listdir(folder)) == ["Other_tension.0002.exr", "Sheet_tension.0002.exr"]


def test_exit_codes(scene, tmp_path):
    got = run(
        """
        from blender_addon import command, library
        scene, folder = ARGUMENTS
        file = os.path.join(folder, "file")
        open(file, "w").close()
        out = ["--out", os.path.join(folder, "out"), "--size", "16"]
        sheet = ["bake", scene, "--object", "Sheet", *out]
        codes = {
            "nothing": command.main([]),
            "help": command.main(["bake", "--help"]),
            "no object": command.main(["bake", scene]),
            "both": command.main([*sheet, "--collection", "Skins"]),
            "bad frames": command.main([*sheet, "--frames", "4-1"]),
            "bad size": command.main([*sheet, "--size", "0"]),
            "bad rest": command.main([*sheet, "--rest", "frame:x"]),
            "bad pass": command.main([*sheet, "--pass", "colour"]),
            "ok": command.main([*sheet, "--frames", "1-3"]),
            "resume": command.main([*sheet, "--frames", "1-3", "--resume"]),
            "verify": command.main(["verify", out[1]]),
            "verify frames": command.main(["verify", out[1], "--frames", "1-4"]),
            "verify nothing": command.main(["verify", os.path.join(folder, "nowhere")]),
            "no file": command.main(["bake", scene + "x", "--object", "Sheet"]),
            "not a scene": command.main(["bake", file, "--object", "Sheet"]),
            "unknown object": command.main(["bake", scene, "--object", "Nobody", *out]),
            "unknown collection": command.main(["bake", scene, "--collection", "None", *out]),
            "negative": command.main([*sheet, "--frames=-2-3"]),
            "driver": command.main(
                ["bake", scene.replace("scene", "driven"), "--object", "Sheet", *out]),
            "driver allowed": command.main(
                ["bake", scene.replace("scene", "driven"), "--object", "Sheet", *out,
                 "--enable-autoexec", "--frames", "1"]),
            "folder is a file": command.main(["bake", scene, "--object", "Sheet", "--out", file]),
        }
        path = os.path.join(out[1], "Sheet_tension.0002.exr")
        data = open(path, "rb").read()
        open(path, "wb").write(data[:-100])
        codes["verify damaged"] = command.main(["verify", out[1], "--json"])
        library._module = None
        sys.modules["ltmd"] = None
        codes["no library"] = command.main([*sheet, "--frames", "1"])
        report(codes=codes)
        """,
        arguments=[str(scene), str(tmp_path)],
    )
    assert got["codes"] == {
        "nothing": 2,
        "help": 0,
        "no object": 2,
        "both": 2,
        "bad frames": 2,
        "bad size": 2,
        "bad rest": 2,
        "bad pass": 2,
        "ok": 0,
        "resume": 0,
        "verify": 0,
        "verify frames": 6,
        "verify nothing": 3,
        "no file": 3,
        "not a scene": 3,
        "unknown object": 3,
        "unknown collection": 3,
        "negative": 3,
        "driver": 3,
        "driver allowed": 0,
        "folder is a file": 4,
        "verify damaged": 6,
        "no library": 1,
    }
    assert "ltmd: 0 files written, 3 kept" in got["_output"]


def test_a_terminated_bake_ends_with_whole_files(scene, tmp_path):
    process = subprocess.Popen(
        [blender_python(), str(LAUNCHER), "bake", str(scene), "--object", "Sheet",
         "--frames", "1-5000", "--size", "64", "--out", str(tmp_path), "--json"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )  # fmt: skip
    for line in process.stderr:
        if "frame 3" in line:
            process.send_signal(signal.SIGTERM)
            break
    out, _ = process.communicate(timeout=60)
    assert process.returncode == 5
    report = json.loads(out)
    assert report["status"] == "cancelled"
    assert 0 < len(report["files"]) < 5000
    assert sorted(map(os.path.basename, report["files"])) == sorted(os.listdir(tmp_path))
    for path in report["files"]:
        reference.read(path)


def test_frame_lists():
    parse = pure("frames").parse
    assert parse("7") == [7]
    assert parse("1-4") == [1, 2, 3, 4]
    assert parse("1-3,20,2") == [1, 2, 3, 20]
    assert parse("1-24x10") == [1, 11, 21]
    assert parse("-2--1") == [-2, -1]
    for text in ("", "a", "3-1", "1-4x0", "1-", "1,,2", "1-2-3", "1-999999999"):
        with pytest.raises(ValueError):
            parse(text)


def test_file_names():
    naming = pure("naming")
    assert naming.file_stem("Suzanne") == "Suzanne"
    assert naming.file_name("Suzanne", "tension", 7) == "Suzanne_tension.0007.exr"
    assert naming.file_name("Suzanne", "tension", 12345, (2, 1)) == "Suzanne_tension.1013.12345.exr"
    stem = naming.file_stem("a/b")
    # A name that copies the hashed one does not meet it.
    names = ["a/b", "a:b", "a.b", "a_b", "à_b", stem, "con", "x" * 200, "x" * 201, ""]
    stems = [naming.file_stem(name) for name in names]
    assert len(set(stems)) == len(names)
    assert all(len(s) < 130 and s.isascii() and not set(s) & set(":/. ") for s in stems)
    assert "con" not in stems
    # Letter case and libraries.
    others = [("Ball", ""), ("ball", ""), ("Ball", "//lib.blend")]
    stems = [naming.file_stem(*pair, others) for pair in others]
    assert len({s.lower() for s in stems}) == 3
    # An override keeps its name beside the linked object it overrides.
    others = [("Ball", ""), ("Ball", "//lib.blend"), ("Ball", "//other.blend")]
    stems = [naming.file_stem(*pair, others) for pair in others]
    assert stems[0] == "Ball" and len(set(stems)) == 3
    assert [naming.file_stem(*pair, others) for pair in others] == stems
