# SPDX-License-Identifier: Apache-2.0
"""Baked texels against a float64 model of the rendered mesh."""

import os

import bake_reference as reference
import numpy as np
import pytest
from blender_process import run


def assert_texels(
    path, rest, deformed, size, tile=(0, 0), least=100, tolerance=reference.TOLERANCE
):
    mask, expected = reference.texels(rest, reference.corner_tension(rest, deformed), size, tile)
    pixels = reference.read(path)
    assert pixels.shape == (size, size, 4)
    assert (pixels[..., 3] == 1).all()
    assert mask.sum() >= least
    error = np.abs(pixels[..., :3] - expected)[mask].max()
    limit = tolerance * np.abs(expected[mask]).max()
    assert error <= limit, f"{path}: {error:.2e} > {limit:.2e}"
    return expected[mask]


def test_texels_equal_the_model_of_the_rendered_mesh(tmp_path):
    # Hidden in the viewport and coarser there: only what the render shows counts.
    got = run(
        """
        from bake_scenes import *
        obj = monkey()
        keyed_shape(obj, lambda p: p * (1.5, 1, 1) + 0.2 * p[:, [2, 0, 1]])
        armature(obj)
        subsurf(obj, levels=0, render_levels=1)
        rest = at_rest(obj)
        frames = {f: evaluated(obj, f) for f in (1, 2, 3, 4)}
        obj.hide_viewport = True
        scene = bpy.context.scene
        scene.frame_set(3)
        before = (scene.render.engine, scene.camera, len(bpy.data.objects), len(bpy.data.scenes))
        work = bake([obj], [1, 2, 3, 4], ARGUMENTS, width=128, height=128, allow_overlap=True)
        after = (scene.render.engine, scene.camera, len(bpy.data.objects), len(bpy.data.scenes))
        report(rest=rest, frames=frames, report=work.report(), same=before == after,
               frame=scene.frame_current, registered=hasattr(bpy.types, "LtmdBake"))
        """,
        arguments=str(tmp_path),
    )
    assert got["report"]["status"] == "ok" and got["report"]["verified"]
    assert got["same"] and got["frame"] == 3 and not got["registered"]
    assert sorted(os.listdir(tmp_path)) == [f"Suzanne_tension.000{f}.exr" for f in (1, 2, 3, 4)]
    for frame, deformed in got["frames"].items():
        path = tmp_path / f"Suzanne_tension.{int(frame):04d}.exr"
        expected = assert_texels(path, got["rest"], deformed, 128, least=5000)
        if frame == "1":
            assert np.abs(expected - (1, 0, 1)).max() < 1e-5
        if frame == "4":
            # The test would pass on a rig that does not move.
            assert np.ptp(expected, axis=0).min() > 0.3
    assert reference.metadata(tmp_path / "Suzanne_tension.0002.exr") == {
        "ltmd:convention": "1",
        "ltmd:pass": "tension",
        "ltmd:object": "Suzanne",
        "ltmd:uv_map": "UVMap",
        "ltmd:frame": "2",
        "ltmd:frame_start": "1",
        "ltmd:frame_end": "4",
        "ltmd:udim": "1001",
        "ltmd:per": "corner",
        "ltmd:rest": "basis",
        "ltmd:margin": "2",
        "ltmd:version": got["report"]["version"],
    }


def test_rest_is_the_identity_for_every_rig(tmp_path):
    got = run(
        """
        from bake_scenes import *

        def mirror(obj):
            modifier = obj.modifiers.new("Mirror", "MIRROR")
            modifier.use_mirror_u = False
            modifier.mirror_offset_u = 1.0

        def lattice(obj):
            cage = link(bpy.data.objects.new("Cage", bpy.data.lattices.new("Cage")))
            obj.modifiers.new("Lattice", "LATTICE").object = cage

        def simplify(obj):
            subsurf(obj, render_levels=2)

        stretch = lambda p: p * (1.5, 1, 1)
        # Each applied in turn; the deformation starts after frame 1.
        rigs = {
            "keys": [lambda o: keyed_shape(o, stretch)],
            "keys, subdivision": [lambda o: keyed_shape(o, stretch), subsurf],
            "bones": [armature],
            "bones, subdivision": [armature, subsurf],
            "subdivision, bones": [subsurf, armature],
            "keys, bones, subdivision": [lambda o: keyed_shape(o, stretch), armature, subsurf],
            "mirror, bones": [mirror, armature],
            "lattice": [lattice, subsurf],
            "nodes that make points": [
                lambda o: geometry_nodes(o, "Subdivide", "GeometryNodeSubdivideMesh"), armature],
            "subdivision under Simplify": [simplify, armature],
        }
        worst = {}
        scene = bpy.context.scene
        for index, (name, parts) in enumerate(rigs.items()):
            empty_scene()
            scene = bpy.context.scene
            scene.render.use_simplify = name.endswith("Simplify")
            scene.render.simplify_subdivision_render = 1
            obj = monkey(f"rig {index}")
            for part in parts:
                part(obj)
            scene.frame_set(4)
            work = bake([obj], [1, 4], ARGUMENTS, allow_overlap=True, width=32, height=32)
            pixels = [read_image(path)[..., :3] for path in work.targets[0].files[:2]]
            worst[name] = [float(np.abs(p - (1, 0, 1)).max()) for p in pixels]
            if name.endswith("Simplify"):
                worst["vertices"] = len(work.targets[0].arrays.positions)
        report(worst=worst)
        """,
        arguments=str(tmp_path),
    )
    assert got["worst"].pop("vertices") < 3000
    for rig, (rest, moved) in got["worst"].items():
        assert rest < 1e-4, rig
        assert rig in ("lattice",) or moved > 0.1, rig


def test_object_scale_is_not_stretch(tmp_path):
    got = run(
        """
        from bake_scenes import *
        obj = sheet(cells=6)
        keyed_shape(obj, lambda p: p * (1.4, 1, 1) + 0.3 * p[:, [2, 0, 1]])
        for frame, scale in ((1, (1, 1, 1)), (4, (3, 0.5, 2))):
            obj.scale = scale
            obj.keyframe_insert("scale", frame=frame)
        obj.rotation_euler = (0.3, 0.4, 0.5)
        rest = at_rest(obj)
        frames = {f: evaluated(obj, f) for f in (1, 2, 3, 4)}
        import ltmd
        made, baker = [], ltmd.SequenceBaker
        def counted(*args, **options):
            made.append(1)
            return baker(*args, **options)
        ltmd.SequenceBaker = counted
        bake([obj], [1, 2, 3, 4], ARGUMENTS)
        ltmd.SequenceBaker = baker
        still = sheet("Still", cells=6)
        still.scale = (3, 0.5, 2)
        still.keyframe_insert("scale", frame=1)
        still.scale = (0.2, 0.5, -2)
        still.keyframe_insert("scale", frame=2)
        work = bake([still], [1, 2], ARGUMENTS)
        report(rest=rest, frames=frames, still=work.targets[0].files, bakers=len(made))
        """,
        arguments=str(tmp_path),
    )
    assert got["bakers"] == 1  # the coverage does not depend on the scale
    differ = []
    for frame, deformed in got["frames"].items():
        path = tmp_path / f"Sheet_tension.{int(frame):04d}.exr"
        # The add-on rounds the turned and scaled positions to float32.
        tolerance = reference.rounded_tolerance(got["rest"])
        expected = assert_texels(path, got["rest"], deformed, 64, least=3000, tolerance=tolerance)
        plain = reference.corner_tension(got["rest"], {**deformed, "matrix": np.eye(3)})
        differ.append(np.abs(expected[0] - plain[0]).max())
    # Uneven scale does change the tension of a sheared shape: the metric matters.
    assert differ[0] < 1e-6 and differ[-1] > 0.05
    for path in got["still"]:
        assert np.abs(reference.read(path)[..., :3] - (1, 0, 1)).max() < 1e-5


def test_two_objects_share_one_pass_over_the_frames(tmp_path):
    got = run(
        """
        from bake_scenes import *
        objects = [sheet("One"), sheet("Two", cells=3)]
        rest = [at_rest(obj) for obj in objects]
        for obj, size in zip(objects, (2.0, 0.5)):
            keyed_shape(obj, lambda p: p * (size, 1, 1))
        frames = [evaluated(obj, 4) for obj in objects]
        visited = []
        bpy.context.scene.view_layers.new("Second")
        note = lambda scene, *_: visited.append(scene.frame_current)
        bpy.app.handlers.frame_change_pre.append(note)
        bpy.context.scene.frame_set(1)
        visited.clear()
        work = bake(objects, [1, 4], ARGUMENTS)
        report(rest=rest, frames=frames, visited=visited, report=work.report())
        """,
        arguments=str(tmp_path),
    )
    assert [entry["files"] for entry in got["report"]["objects"]] == [2, 2]
    assert len(got["report"]["files"]) == 4
    # Once each, whatever the number of objects and view layers.
    assert got["visited"].count(4) == 1
    for name, rest, deformed in zip(("One", "Two"), got["rest"], got["frames"], strict=True):
        assert_texels(tmp_path / f"{name}_tension.0004.exr", rest, deformed, 64)


def test_tiles_become_files_with_their_udim(tmp_path):
    got = run(
        """
        from bake_scenes import *
        obj = sheet(uv_scale=(2.0, 1.0))
        rest = at_rest(obj)
        keyed_shape(obj, lambda p: p * (1.5, 1, 1) + p[:, [1, 2, 2]] * (0.4, 0, 0))
        deformed = evaluated(obj, 4)
        work = bake([obj], [4], ARGUMENTS)
        lone = sheet("Lone", uv_offset=(3.0, 1.0))
        bake([lone], [0], ARGUMENTS)
        report(rest=rest, deformed=deformed, report=work.report())
        """,
        arguments=str(tmp_path),
    )
    assert got["report"]["objects"][0]["tiles"] == [1001, 1002]
    for tile in ((0, 0), (1, 0)):
        path = tmp_path / f"Sheet_tension.{1001 + tile[0]}.0004.exr"
        assert_texels(path, got["rest"], got["deformed"], 64, tile, least=3000)
        assert reference.metadata(path)["ltmd:udim"] == str(1001 + tile[0])
    assert (tmp_path / "Lone_tension.1014.0000.exr").exists()


def test_names_with_odd_characters_get_files_of_their_own(tmp_path):
    names = ["a/b", "a:b", "Bébé", "dot.001", "Plain", "plain"]
    got = run(
        """
        from bake_scenes import *
        objects = [sheet(name) for name in ARGUMENTS[1]]
        work = bake(objects, [1], ARGUMENTS[0])
        report(stems={t.name: t.stem for t in work.targets}, files=work.report()["files"])
        """,
        arguments=[str(tmp_path), names],
    )
    assert list(got["stems"]) == names
    stems = list(got["stems"].values())
    assert len({stem.lower() for stem in stems}) == len(names)
    assert all(stem.isascii() and not set(stem) & set("/:.") for stem in stems)
    for path, name in zip(got["files"], names, strict=True):
        assert reference.metadata(path)["ltmd:object"] == name


def test_operator_bakes_and_turns_the_material_to_the_files(tmp_path):
    got = run(
        """
        from bake_scenes import *
        bpy.ops.wm.save_as_mainfile(filepath=ARGUMENTS + "/scene.blend")
        obj = sheet()
        obj.data.materials.append(bpy.data.materials.new("Skin"))
        bpy.ops.ltmd.setup()
        keyed_shape(obj, lambda p: p * (2, 1, 1))
        outcome = bpy.ops.ltmd.bake(objects=[{"name": "Sheet"}], frames="1-3", size=32)
        images = [n for n in obj.active_material.node_tree.nodes if n.type == "TEX_IMAGE"]
        report(outcome=list(outcome), source=obj.ltmd.source, uv_map=obj.ltmd.uv_map,
               paths=[n.image.filepath for n in images])
        try:
            bpy.ops.ltmd.bake(objects=[{"name": "Nobody"}], frames="1")
        except RuntimeError as error:
            report(error=str(error))
        """,
        arguments=str(tmp_path),
    )
    assert got["outcome"] == ["FINISHED"]
    assert got["source"] == "TEXTURE" and got["uv_map"] == "UVMap"
    assert got["paths"] == ["//ltmd/Sheet_tension.0001.exr"]
    assert len(os.listdir(tmp_path / "ltmd")) == 3
    assert 'no object "Nobody"' in got["error"]


@pytest.mark.parametrize("kind", ["cancel", "blocked file", "full disk"])
def test_interrupted_bake_leaves_whole_files_only(tmp_path, kind):
    """Frame 3 cannot be written, or the bake stops before it; an older file 3 stays as it was."""
    older = tmp_path / "Sheet_tension.0003.exr"
    if kind == "blocked file":
        # A folder in its place: a rename over it fails for any user.
        (older / "inside").mkdir(parents=True)
    got = run(
        """
        from bake_scenes import *
        import resource, signal
        from blender_addon import bake as baking
        folder, kind = ARGUMENTS
        obj = sheet(cells=8)
        keyed_shape(obj, lambda p: p + 0.2 * np.sin(9 * p[:, [1, 2, 0]]))
        if kind != "blocked file":
            bake([obj], [3], folder, width=256, height=256)
        older = f"{folder}/Sheet_tension.0003.exr"
        before = open(older, "rb").read() if kind != "blocked file" else b""
        checks = []
        def stop():
            checks.append(1)
            return kind == "cancel" and len(checks) == 3
        if kind == "full disk":
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (4096, resource.RLIM_INFINITY))
            obj.name = "Other"
        frames = [3] if kind == "full disk" else [1, 2, 3, 4]
        outcome = ""
        try:
            work = bake([obj], frames, folder, width=256, height=256, stop=stop)
            outcome = work.status
            report(files=work.report()["files"])
        except (baking.WriteFailure, baking.Refused) as error:
            outcome = f"{type(error).__name__}: {error}"
        if kind == "full disk":
            resource.setrlimit(resource.RLIMIT_FSIZE, (resource.RLIM_INFINITY,) * 2)
        after = open(older, "rb").read() if before else b""
        scene = bpy.context.scene
        report(outcome=outcome, same=before == after, names=sorted(os.listdir(folder)),
               engine=scene.render.engine)
        """,
        arguments=[str(tmp_path), kind],
    )
    assert got["same"]
    assert got["engine"] != "LTMD_BAKE"
    files = [f"Sheet_tension.000{frame}.exr" for frame in (1, 2, 3)]
    if kind == "cancel":
        assert got["outcome"] == "cancelled"
        assert set(got["names"]) <= set(files) and files[2] in got["names"]
        written = [name for name in got["names"] if name != files[2]]
        assert sorted(map(os.path.basename, got["files"])) == written
    elif kind == "blocked file":
        assert got["outcome"].startswith("WriteFailure") and "0003.exr" in got["outcome"]
        assert set(files) <= set(got["names"]) <= {*files, "Sheet_tension.0004.exr"}
    else:
        assert got["outcome"].startswith("WriteFailure") and "Other" in got["outcome"]
        assert got["names"] == [files[2]]
    for name in got["names"]:
        if os.path.isfile(tmp_path / name):
            reference.read(tmp_path / name)


def test_resume_keeps_what_is_whole_and_was_baked_alike(tmp_path):
    got = run(
        """
        from bake_scenes import *
        obj = sheet()
        keyed_shape(obj, lambda p: p * (2, 1, 1))
        name = lambda f: f"{ARGUMENTS}/Sheet_tension.{f:04d}.exr"
        kept = lambda work: [int(p[-8:-4]) for p in work.report()["skipped"]]
        bake([obj], [1, 2], ARGUMENTS)
        data = open(name(2), "rb").read()
        open(name(2), "wb").write(data[: len(data) - 200])
        more = bake([obj], [1, 2, 3], ARGUMENTS, resume=True)
        whole = open(name(2), "rb").read() == data
        again = bake([obj], [1, 2, 3], ARGUMENTS, resume=True)
        other = bake([obj], [1, 2], ARGUMENTS, resume=True, margin=3)
        smaller = bake([obj], [1], ARGUMENTS, resume=True, width=32, height=32)
        report(kept=[kept(w) for w in (more, again, other, smaller)], whole=whole,
               status=[w.status for w in (more, again, other, smaller)])
        """,
        arguments=str(tmp_path),
    )
    assert got["kept"] == [[1], [1, 2, 3], [], []]
    assert got["status"] == ["ok"] * 4
