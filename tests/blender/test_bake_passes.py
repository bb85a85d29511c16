# SPDX-License-Identifier: Apache-2.0
"""Passes besides tension, precision of the files, and tension as a USD primvar."""

import os

import bake_reference as reference
import numpy as np
import pytest
from blender_process import run

PASSES = ("tension", "stretch", "wrinkle", "alpha2", "roughness")


@pytest.fixture(scope="module")
def scene(tmp_path_factory):
    """A saved file with "Sheet", stretched and sheared evenly at frame 2, set up with LTMD."""
    path = tmp_path_factory.mktemp("passes") / "scene.blend"
    run(
        """
        from bake_scenes import *
        obj = sheet("Sheet", uv_scale=0.6, uv_offset=(0.2, 0.2))
        keyed_shape(obj, lambda p: p * (2, 0.5, 1) + p[:, [1, 2, 2]] * (0.25, 0, 0), frames=(1, 2))
        bpy.context.scene.frame_end = 2
        bpy.ops.wm.save_as_mainfile(filepath=ARGUMENTS)
        """,
        arguments=str(path),
    )
    return path


def expected():
    """Each pass of T = [[2, .25], [0, .5]] and alpha (.1, .2): background first."""
    t = np.array([[2, 0.25], [0, 0.5]])
    largest, smallest = np.linalg.svd(t, compute_uv=False)
    inverse = np.linalg.inv(t)
    sigma = inverse.T @ np.diag([0.01, 0.04]) @ inverse
    values, vectors = np.linalg.eigh(sigma)
    x, y = vectors[:, 0]
    twice = 2 * np.arctan2(y, x)
    return {
        "tension": ((1, 0, 1, 1), (2, 0.25, 0.5, 1)),
        "stretch": ((1, 1, 1, 1), (largest, smallest, 1, 1)),
        "wrinkle": ((1, 1, 0, 1), (2, np.hypot(0.25, 0.5), np.arctan2(0.25, 0.5), 1)),
        "alpha2": ((0.01, 0, 0.04, 1), (sigma[0, 0], sigma[0, 1], sigma[1, 1], 1)),
        "roughness": ((0.1, 0.2, 1, 0), (*np.sqrt(values), np.cos(twice), np.sin(twice))),
    }


def test_every_pass_has_its_numbers_and_metadata(scene, tmp_path):
    got = run(
        """
        from blender_addon import command
        scene, folder = ARGUMENTS
        asked = ["bake", scene, "--object", "Sheet", "--frames", "1-2", "--size", "32",
                 "--margin", "2", "--out", folder, "--pass", "tension,stretch,wrinkle", "--pass",
                 "roughness,alpha2,tension", "--alpha", "0.1,0.2", "--compression", "piz"]
        codes = [command.main(asked), command.main([*asked, "--resume"]),
                 command.main([*asked, "--resume", "--alpha", "0.3"]),
                 command.main(asked), command.main(["verify", folder])]
        from blender_addon import bake, library
        report(codes=codes, passes=bake.PASSES, known=library.ltmd().passes)
        """,
        arguments=[str(scene), str(tmp_path)],
    )
    assert got["codes"] == [0] * 5, got["_output"]
    assert got["passes"] == got["known"] == list(PASSES)
    output = got["_output"]
    assert output.count("10 files written, 0 kept") == 3, output
    assert output.count("0 files written, 10 kept") == 1
    names = [f"Sheet_{name}.000{frame}.exr" for name in PASSES for frame in (1, 2)]
    assert sorted(os.listdir(tmp_path)) == sorted(names)
    for name, (rest, value) in expected().items():
        pixels = reference.read(tmp_path / f"Sheet_{name}.0002.exr")
        assert np.allclose(pixels[16, 16], value, atol=2e-6, rtol=2e-6), name
        assert np.allclose(pixels[0, 0], rest, atol=1e-7, rtol=0), name
        metadata = reference.metadata(tmp_path / f"Sheet_{name}.0002.exr")
        assert metadata["ltmd:pass"] == name
        assert ("ltmd:alpha" in metadata) == (name in ("alpha2", "roughness"))
        pixels = reference.read(tmp_path / f"Sheet_{name}.0001.exr")
        assert np.allclose(pixels, rest, atol=1e-6, rtol=0), name


def test_the_set_up_material_gives_the_lobe_and_reads_tension_alone(tmp_path):
    got = run(
        """
        from bake_scenes import *
        from blender_addon import surface
        obj = sheet("Sheet")
        keyed_shape(obj, lambda p: p * (2, 1, 1), frames=(1, 2))
        bpy.ops.ltmd.setup()
        material = obj.material_slots[0].material
        lobe = surface.lobe(material)
        lobe.inputs["Roughness"].default_value = 0.3
        lobe.inputs["Stretch"].default_value = 0.5
        obj.ltmd.passes = {"ROUGHNESS"}
        obj.ltmd.size = 16
        first = bpy.ops.ltmd.bake(directory=ARGUMENTS, frames="2")
        source = obj.ltmd.source
        second = bpy.ops.ltmd.bake(directory=ARGUMENTS, frames="2", passes={"STRETCH", "TENSION"},
                                   half=True)
        images = [node.image.filepath for node in surface.our_nodes(material, "source")
                  if getattr(node, "image", None)]
        report(first=list(first), second=list(second), source=source, now=obj.ltmd.source,
               images=images)
        """,
        arguments=str(tmp_path),
    )
    assert got["first"] == got["second"] == ["FINISHED"], got["_output"]
    assert got["source"] == "LIVE" and got["now"] == "TEXTURE"
    assert len(got["images"]) == 1 and got["images"][0].endswith("Sheet_tension.0002.exr")
    pixels = reference.read(tmp_path / "Sheet_roughness.0002.exr")
    # alpha .09, narrowed by 2 at rest and by 2 again along u, widened by 2 along v.
    assert np.allclose(pixels[8, 8], (0.0225, 0.18, 1, 0), atol=1e-6)
    assert reference.metadata(tmp_path / "Sheet_stretch.0002.exr")["ltmd:mantissa_bits"] == "10"


def test_precision_is_part_of_the_settings(scene, tmp_path):
    got = run(
        """
        from blender_addon import command
        scene, folder = ARGUMENTS
        asked = ["bake", scene, "--object", "Sheet", "--size", "16", "--out", folder, "--resume"]
        report(codes=[command.main([*asked, *more]) for more in (
            [], ["--half"], ["--half", "--mantissa-bits", "12"], ["--mantissa-bits", "6"],
            ["--mantissa-bits", "0"], ["--pass", "tension,colour"], ["--alpha", "0"])])
        """,
        arguments=[str(scene), str(tmp_path)],
    )
    assert got["codes"] == [0, 0, 0, 0, 2, 2, 2], got["_output"]
    assert got["_output"].count("2 files written, 0 kept") == 3
    assert got["_output"].count("0 files written, 2 kept") == 1
    assert reference.metadata(tmp_path / "Sheet_tension.0002.exr")["ltmd:mantissa_bits"] == "6"


def test_usd_holds_the_tension_as_a_primvar(scene, tmp_path):
    got = run(
        """
        from blender_addon import command
        scene, folder = ARGUMENTS
        asked = ["bake", scene, "--object", "Sheet", "--frames", "1-2", "--out", folder, "--usd"]
        codes = [command.main(asked), command.main([*asked, "--resume"])]
        names = sorted(os.listdir(folder))
        codes.append(command.main([*asked, "--pass", "tension", "--size", "16"]))
        from pxr import Usd, UsdGeom
        stage = Usd.Stage.Open(os.path.join(folder, "Sheet_tension.0002.usdc"))
        mesh = UsdGeom.Mesh(stage.GetDefaultPrim().GetChildren()[0])
        primvar = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("ltmd_tension")
        layer = dict(stage.GetRootLayer().customLayerData)
        report(codes=codes, names=names, tension=np.array(primvar.Get()),
               type=str(primvar.GetTypeName()), interpolation=primvar.GetInterpolation(),
               points=len(mesh.GetPointsAttr().Get()),
               sizes=np.array(mesh.GetFaceVertexCountsAttr().Get()), layer=layer,
               axis=UsdGeom.GetStageUpAxis(stage))
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
        bpy.ops.wm.usd_import(filepath=os.path.join(folder, "Sheet_tension.0002.usdc"))
        mesh = next(obj for obj in bpy.data.objects if obj.type == "MESH").data
        attribute = mesh.attributes["ltmd_tension"]
        values = np.empty(3 * len(attribute.data), np.float32)
        attribute.data.foreach_get("vector", values)
        report(kind=[attribute.data_type, attribute.domain], imported=values.reshape(-1, 3))
        """,
        arguments=[str(scene), str(tmp_path)],
    )
    assert got["codes"] == [0, 0, 0], got["_output"]
    assert "0 files written, 2 kept" in got["_output"]
    assert got["names"] == ["Sheet_tension.0001.usdc", "Sheet_tension.0002.usdc"]
    assert len(os.listdir(tmp_path)) == 4
    assert len({os.stat(tmp_path / name).st_mode for name in os.listdir(tmp_path)}) == 1
    assert got["type"] == "float3[]" and got["interpolation"] == "faceVarying"
    assert got["points"] == 25 and got["sizes"] == [4] * 16 and got["axis"] == "Z"
    assert got["layer"]["ltmd:convention"] == "1" and got["layer"]["ltmd:frame"] == "2"
    assert got["layer"]["ltmd:object"] == "Sheet" and got["layer"]["ltmd:pass"] == "tension"
    assert np.array(got["tension"]).shape == (64, 3)
    assert np.allclose(got["tension"], (2, 0.25, 0.5), atol=1e-6)
    assert got["kind"] == ["FLOAT_VECTOR", "CORNER"]
    assert np.allclose(got["imported"], (2, 0.25, 0.5), atol=1e-6)


def test_usd_that_cannot_be_written_fails_in_words(scene, tmp_path):
    got = run(
        """
        from blender_addon import command
        scene, folder = ARGUMENTS
        os.mkdir(os.path.join(folder, "Sheet_tension.0002.usdc"))
        code = command.main(["bake", scene, "--object", "Sheet", "--out", folder, "--usd"])
        report(code=code)
        """,
        arguments=[str(scene), str(tmp_path)],
    )
    assert got["code"] == 4, got["_output"]
    assert "Sheet_tension.0002.usdc" in got["_output"]
    assert sorted(os.listdir(tmp_path)) == ["Sheet_tension.0001.usdc", "Sheet_tension.0002.usdc"]


def test_usd_needs_no_uv_map_without_overlap(tmp_path):
    got = run(
        """
        from bake_scenes import *
        obj = sheet("Sheet")
        for corner in obj.data.uv_layers[0].uv:
            corner.vector = (corner.vector[0] % 0.5, corner.vector[1])
        keyed_shape(obj, lambda p: p * (2, 1, 1), frames=(1, 2))
        refused = refusal([obj], [2], ARGUMENTS)
        work = bake([obj], [2], ARGUMENTS, passes=(), usd=True)
        report(refused=refused, status=work.status, files=work.report()["files"])
        """,
        arguments=str(tmp_path),
    )
    assert "more than one place" in got["refused"]
    assert got["status"] == "ok" and len(got["files"]) == 1
