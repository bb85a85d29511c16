# SPDX-License-Identifier: Apache-2.0
"""Rest states by basis, frame and object."""

import bake_reference as reference
import numpy as np
from blender_process import run


def assert_image(path, rest, deformed):
    mask, expected = reference.texels(rest, reference.corner_tension(rest, deformed), 64)
    error = np.abs(reference.read(path)[..., :3] - expected)[mask].max()
    assert mask.sum() > 500
    assert error <= reference.TOLERANCE * max(1.0, np.abs(expected).max())


def test_rest_by_frame_and_by_object(tmp_path):
    got = run(
        """
        from bake_scenes import *
        from blender_addon.rest_state import Spec
        obj = sheet()
        keyed_shape(obj, lambda p: p * (1.6, 1, 1) + 0.2 * p[:, [1, 2, 0]])
        subsurf(obj, render_levels=1)
        frames = {f: evaluated(obj, f) for f in (1, 3, 4)}

        by_frame = bake([obj], [1, 4], ARGUMENTS + "/frame", rest=Spec("frame", frame=3))
        in_range = bake([obj], [1, 3], ARGUMENTS + "/range", rest=Spec("frame", frame=1))

        # The same base mesh, another shape: it goes through the subdivision of the baked object.
        shape = sheet("Shape")
        for vertex in shape.data.vertices:
            vertex.co = vertex.co * 2
        shape.hide_render = True
        uv = shape.data.uv_layers[0].uv
        uv.foreach_set("vector", np.zeros(2 * len(shape.data.loops), np.float32))
        by_object = bake([obj], [1], ARGUMENTS + "/object", rest=Spec("object", object="Shape"))

        # The subdivided mesh itself.
        applied = sheet("Applied")
        subsurf(applied, levels=1)
        bpy.ops.object.modifier_apply(modifier="Subdivision")
        by_applied = bake([obj], [1], ARGUMENTS + "/applied", rest=Spec("object", object="Applied"))

        # The settings of the object itself.
        obj.ltmd.rest_mode = "OBJECT"
        obj.ltmd.rest_object = shape
        own = bake([obj], [1], ARGUMENTS + "/own")
        works = (by_frame, in_range, by_object, by_applied, own)
        report(frames=frames, kinds=[str(w.targets[0].spec) for w in works],
               status=[w.status for w in works],
               refused=[refusal([obj], [1], ARGUMENTS, rest=Spec("object", object=name))
                        for name in ("Nothing", "Armature", "Wrong")
                        if name != "Wrong" or sheet("Wrong", cells=3)])
        """,
        arguments=str(tmp_path),
    )
    assert got["status"] == ["ok"] * 5
    assert got["kinds"] == ["frame:3", "frame:1", "object:Shape", "object:Applied", "object:Shape"]
    frames = got["frames"]
    for frame in ("1", "4"):
        path = tmp_path / "frame" / f"Sheet_tension.000{frame}.exr"
        assert_image(path, frames["3"], frames[frame])
        assert reference.metadata(path)["ltmd:rest"] == "frame:3"
    for frame in ("1", "3"):
        path = tmp_path / "range" / f"Sheet_tension.000{frame}.exr"
        assert_image(path, frames["1"], frames[frame])
    twice = {**frames["1"], "positions": 2 * np.array(frames["1"]["positions"])}
    for folder in ("object", "own"):
        assert_image(tmp_path / folder / "Sheet_tension.0001.exr", twice, frames["1"])
    assert_image(tmp_path / "applied" / "Sheet_tension.0001.exr", frames["1"], frames["1"])
    assert 'rest object "Nothing" is not a mesh' in got["refused"][0]
    assert "has 81 vertices in the render, its rest state has 49" in got["refused"][2]


def test_nothing_of_the_scene_is_changed(tmp_path):
    got = run(
        """
        from bake_scenes import *
        from blender_addon import bake as baking, rest_state
        obj = monkey()
        keyed_shape(obj, lambda p: 2 * p)
        armature(obj)
        subsurf(obj)
        geometry_nodes(obj, "Move", "GeometryNodeTransform", Scale=(2, 1, 1))
        scene = bpy.context.scene
        scene.frame_set(2)
        scene.render.use_sequencer = scene.render.use_multiview = True

        def state():
            render = scene.render
            return [
                [obj.show_only_shape_key, obj.active_shape_key_index],
                [(m.name, m.show_render, m.show_viewport) for m in obj.modifiers],
                sorted(o.name for o in bpy.data.objects), sorted(s.name for s in bpy.data.scenes),
                sorted(m.name for m in bpy.data.meshes), sorted(a.name for a in bpy.data.actions),
                [render.engine, render.use_sequencer, render.use_multiview, render.use_compositing],
                bpy.context.preferences.view.render_display_type, scene.frame_current,
                scene.camera is None, bpy.context.view_layer.objects.active.name,
                sorted(scene.keys()),
            ]

        before = state()
        done = bake([obj], [1, 3], ARGUMENTS, width=16, height=16)
        after = [state()]
        refusal([obj], [1], ARGUMENTS, rest=rest_state.Spec("object", object="Armature"))
        armature_mesh = sheet("Other")
        bpy.data.objects.remove(armature_mesh)
        bpy.context.view_layer.objects.active = obj
        bpy.data.meshes.remove(bpy.data.meshes["Other"])
        # An error inside the evaluation.
        work = baking.Bake(scene, bpy.context.view_layer,
                           baking.Settings([obj], [1], folder=ARGUMENTS, width=16, height=16))
        work.prepare()
        work._bake = lambda *_: 1 / 0
        try:
            work.run()
        except ZeroDivisionError:
            after.append(state())
        report(before=before, after=after, status=[done.status, work.status])
        """,
        arguments=str(tmp_path),
    )
    assert got["status"] == ["ok", "failed"]
    assert got["after"] == [got["before"]] * 2


def test_a_file_saved_in_mid_bake_opens_as_it_was_before(tmp_path):
    # As an automatic save would; an undo step is put right the same way.
    got = run(
        """
        from bake_scenes import *
        obj = sheet()
        scene = bpy.context.scene
        scene.frame_set(7)
        engine = scene.render.engine
        path = ARGUMENTS + "/saved.blend"
        bake([obj], [1, 2, 3], ARGUMENTS, progress=lambda frame, *_: frame == 2
             and bpy.ops.wm.save_as_mainfile(filepath=path, copy=True))
        bpy.ops.wm.open_mainfile(filepath=path)
        scene = bpy.context.scene
        report(same=scene.render.engine == engine and scene.camera is None,
               frame=scene.frame_current, objects=[o.name for o in bpy.data.objects],
               keys=list(scene.keys()))
        """,
        arguments=str(tmp_path),
    )
    assert got["same"] and got["frame"] == 7 and got["objects"] == ["Sheet"] and got["keys"] == []


def test_nodes_that_only_move_points_are_left_out_of_the_rest_state(tmp_path):
    got = run(
        """
        from bake_scenes import *
        obj = sheet()
        geometry_nodes(obj, "Move", "GeometryNodeTransform", Scale=(2, 1, 1))
        geometry_nodes(obj, "Divide", "GeometryNodeSubdivideMesh")
        work = bake([obj], [1], ARGUMENTS)
        report(kept=work.targets[0].arrays.kept, warnings=work.warnings,
               pixels=read_image(work.targets[0].files[0])[8:-8, 8:-8, :3])
        """,
        arguments=str(tmp_path),
    )
    assert got["kept"] == ["Divide"] and "Divide" in got["warnings"][0]
    assert np.abs(np.array(got["pixels"]) - (2, 0, 1)).max() < 1e-5
