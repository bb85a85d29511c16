# SPDX-License-Identifier: Apache-2.0
"""What cannot be baked is refused in a sentence, before anything is written."""

import pytest
from blender_process import run

CASES = {
    "hidden": ("Refused", "disabled in renders"),
    "edit mode": ("Refused", "Edit Mode"),
    "hidden collection": ("Refused", "collection is disabled in renders"),
    "excluded": ("Refused", "excluded from the view layer"),
    "unused layer": ("Refused", "not used for rendering"),
    "appears late": ("Refused", "not in the render at frame 1"),
    "no uv": ("Refused", "has no UV map"),
    "wrong uv": ("Refused", 'no UV map "Other", it has: UVMap'),
    "negative uv": ("Refused", "leaves the UDIM range"),
    "uv beyond 10": ("Refused", "leaves the UDIM range"),
    "overlap": ("Refused", "more than one place"),
    "overlap allowed": ("", ""),
    "curve": ("Refused", "only meshes can be baked"),
    "negative frame": ("Refused", "Frame -1 is negative"),
    "unsaved": ("Refused", "Save the file first"),
    "file as folder": ("WriteFailure", "cannot be written"),
    "growing mesh": ("Refused", "at frame 3, its rest state has"),
    "not finite": ("Refused", "at frame 1"),
    "cloth jump": ("Refused", 'cloth simulation "Cloth" is not baked'),
    "cloth step 2": ("Refused", "is not baked"),
    "cloth from its start": ("", ""),
    "cloth baked": ("", ""),
    "soft body jump": ("Refused", "soft body simulation"),
    "bound to cloth": ("Refused", '(of "Cloth")'),
    "driver": ("Refused", "--enable-autoexec"),
    "linked": ("Refused", "Make a library override first".lower()),
}


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    folder = tmp_path_factory.mktemp("refusals")
    return run(
        """
        from bake_scenes import *

        folder = ARGUMENTS
        answers, written = {}, {}

        def case(name, obj, frames=(1,), **settings):
            out = os.path.join(folder, name)
            settings.setdefault("folder", out)
            target = settings.pop("folder")
            answers[name] = refusal([obj], frames, target, **settings)
            written[name] = os.listdir(out) if os.path.isdir(out) else []

        scene = bpy.context.scene
        layer = bpy.context.view_layer
        obj = sheet()
        obj.hide_render = True
        case("hidden", obj)
        obj.hide_render = False

        bpy.ops.object.mode_set(mode="EDIT")
        case("edit mode", obj)
        bpy.ops.object.mode_set(mode="OBJECT")

        collection = bpy.data.collections.new("Group")
        scene.collection.children.link(collection)
        collection.objects.link(obj)
        scene.collection.objects.unlink(obj)
        collection.hide_render = True
        case("hidden collection", obj)
        collection.hide_render = False
        layer.layer_collection.children["Group"].exclude = True
        case("excluded", obj)
        layer.layer_collection.children["Group"].exclude = False
        layer.use = False
        case("unused layer", obj)
        layer.use = True

        late = sheet("Late")
        late.hide_render = True
        late.keyframe_insert("hide_render", frame=1)
        late.hide_render = False
        late.keyframe_insert("hide_render", frame=3)
        scene.frame_set(3)
        case("appears late", late, [1, 2])

        case("no uv", sheet("No UV", uv=False))
        case("wrong uv", obj, uv_map="Other")
        case("negative uv", sheet("Negative", uv_offset=(-0.5, 0.0)))
        case("uv beyond 10", sheet("Beyond", uv_offset=(9.5, 0.0)))
        folded = sheet("Folded")
        uv = np.empty(2 * len(folded.data.loops), np.float32)
        folded.data.uv_layers[0].uv.foreach_get("vector", uv)
        folded.data.uv_layers[0].uv.foreach_set("vector", np.abs(uv - 0.5))
        case("overlap", folded)
        case("overlap allowed", folded, allow_overlap=True)
        case("curve", link(bpy.data.objects.new("Curve", bpy.data.curves.new("Curve", "CURVE"))))
        case("negative frame", obj, [-1, 0, 1])
        case("unsaved", obj, folder="//ltmd/")
        open(os.path.join(folder, "a file"), "w").close()
        case("file as folder", obj, folder=os.path.join(folder, "a file"))

        growing = sheet("Growing")
        modifier = subsurf(growing, render_levels=1)
        modifier.keyframe_insert("render_levels", frame=2)
        modifier.render_levels = 2
        modifier.keyframe_insert("render_levels", frame=3)
        scene.frame_set(1)
        case("growing mesh", growing, [1, 2, 3])

        broken = sheet("Broken")
        broken.shape_key_add(name="Basis")
        key = broken.shape_key_add(name="Broken")
        key.data[3].co.x = float("nan")
        key.value = 1.0
        case("not finite", broken)

        def cloth(name):
            made = sheet(name, cells=3)
            made.modifiers.new("Cloth", "CLOTH")
            return made

        case("cloth jump", cloth("Jump"), [5, 6])
        case("cloth step 2", cloth("Step"), [1, 3, 5])
        case("cloth from its start", cloth("Start"), [1, 2, 3])
        baked = cloth("Cloth")
        bound = sheet("Bound")
        bound.modifiers.new("Surface", "SURFACE_DEFORM").target = baked
        case("bound to cloth", bound, [3])
        cache = baked.modifiers["Cloth"].point_cache
        cache.frame_end = 6
        with bpy.context.temp_override(point_cache=cache):
            bpy.ops.ptcache.bake(bake=True)
        case("cloth baked", baked, [5, 6])
        soft = sheet("Soft")
        soft.modifiers.new("Softbody", "SOFT_BODY")
        case("soft body jump", soft, [4])

        bpy.data.objects["Sheet"].data.materials.append(bpy.data.materials.new("Skin"))
        bpy.context.view_layer.objects.active = obj
        bpy.ops.ltmd.setup()
        library = os.path.join(folder, "library.blend")
        bpy.ops.wm.save_as_mainfile(filepath=library)
        empty_scene()
        with bpy.data.libraries.load(library, link=True) as (source, wanted):
            wanted.objects = ["Sheet"]
        bpy.context.scene.collection.objects.link(wanted.objects[0])
        case("linked", wanted.objects[0], switch=True)

        empty_scene()
        driven = sheet("Driven")
        driven.shape_key_add(name="Basis")
        driver = driven.shape_key_add(name="Wide").driver_add("value").driver
        driver.expression = "bpy.context.scene.frame_current"
        path = os.path.join(folder, "driven.blend")
        bpy.ops.wm.save_as_mainfile(filepath=path)
        bpy.ops.wm.open_mainfile(filepath=path, use_scripts=False)
        bpy.context.view_layer.update()
        case("driver", bpy.data.objects["Driven"])
        report(answers=answers, written=written)
        """,
        arguments=str(folder),
    )


@pytest.mark.parametrize("case", CASES)
def test_refusal(answers, case):
    kind, words = CASES[case]
    answer = answers["answers"][case]
    if not kind:
        assert answer == ""
        assert answers["written"][case]
        return
    assert answer.startswith(f"{kind}: ")
    assert words in answer
    if case != "growing mesh":
        assert answers["written"][case] == []


def test_every_problem_is_told_at_once_and_edits_are_warned_of(tmp_path):
    got = run(
        """
        from bake_scenes import *
        from blender_addon import bake as baking
        hidden, bare = sheet("Hidden"), sheet("Bare", uv=False)
        hidden.hide_render = True
        both = refusal([hidden, bare], [-2], ARGUMENTS)
        obj = sheet()
        keyed_shape(obj, lambda p: 2 * p)
        bpy.context.scene.frame_set(1)
        obj.data.shape_keys.key_blocks[1].value = 0.7
        report(both=both, warnings=bake([obj], [1], ARGUMENTS).warnings)
        """,
        arguments=str(tmp_path),
    )
    for word in ("Hidden", "Bare", "Frame -2"):
        assert word in got["both"]
    assert len(got["warnings"]) == 1 and "not keyed" in got["warnings"][0]
