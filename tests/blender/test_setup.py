# SPDX-License-Identifier: Apache-2.0
"""Set Up LTMD and Remove: what they add, that it renders, and that the user's tree comes back."""

from pathlib import Path

import numpy as np
from blender_process import run

PRELUDE = """
from blender_addon import source, surface, setup
from trees import *
"""


def test_remove_restores_every_tree():
    result = run(
        PRELUDE
        + """
def linked_colour(m):
    noise = m.node_tree.nodes.new("ShaderNodeTexNoise")
    m.node_tree.links.new(noise.outputs["Color"], principled(m).inputs["Base Color"])
    m.node_tree.links.new(noise.outputs["Fac"], principled(m).inputs["Roughness"])
    bump = m.node_tree.nodes.new("ShaderNodeBump")
    m.node_tree.links.new(bump.outputs[0], principled(m).inputs["Normal"])
    disp = m.node_tree.nodes.new("ShaderNodeDisplacement")
    end = m.node_tree.nodes["Material Output"]
    m.node_tree.links.new(disp.outputs[0], end.inputs["Displacement"])
def everything(m):
    for name, v in (("Metallic", .5), ("Alpha", .5), ("Emission Strength", 1), ("Coat Weight", 1),
                    ("Transmission Weight", 1), ("Anisotropic", .5)):
        principled(m).inputs[name].default_value = v
def mixed(m):
    t = m.node_tree
    mix, glass = t.nodes.new("ShaderNodeMixShader"), t.nodes.new("ShaderNodeBsdfGlass")
    t.links.new(glass.outputs[0], mix.inputs[1])
    t.links.new(principled(m).outputs[0], mix.inputs[2])
    t.links.new(mix.outputs[0], t.nodes["Material Output"].inputs[0])
def no_principled(m):
    m.node_tree.nodes.remove(principled(m))
def two_outputs(m):
    t = m.node_tree
    t.nodes["Material Output"].target = "EEVEE"
    other = t.nodes.new("ShaderNodeOutputMaterial")
    other.target = "CYCLES"
    t.links.new(principled(m).outputs[0], other.inputs[0])
def spare_output(m):
    m.node_tree.nodes.new("ShaderNodeOutputMaterial").is_active_output = False
def no_output(m):
    m.node_tree.nodes.clear()
def no_nodes(m):
    m.use_nodes = False

out = {}
for make in (lambda m: None, linked_colour, everything, mixed, no_principled, two_outputs,
             spare_output, no_output, no_nodes):
    obj = cube()
    material = new_material("M", obj)
    make(material)
    before, data = dump(material), counts()
    bpy.ops.ltmd.setup(object_name=obj.name)
    cycles_out = material.node_tree.get_output_node("CYCLES")
    eevee_out = material.node_tree.get_output_node("EEVEE")
    entry = dict(set_up=material.ltmd.set_up, source=obj.ltmd.source, texts=len(bpy.data.texts),
                 cycles=cycles_out.label, eevee=eevee_out.label if eevee_out else None,
                 attribute="ltmd_rest" in obj.data.attributes)
    bpy.ops.ltmd.setup(object_name=obj.name)  # again: nothing twice
    entry["lobes"] = sum(n.label == "LTMD Glossy" for n in material.node_tree.nodes)
    bpy.ops.ltmd.remove(object_name=obj.name)
    after = dump(material)
    entry.update(same=before == after, left=obj.ltmd.source, before=before, after=after,
                 attribute_left="ltmd_rest" in obj.data.attributes,
                 data=data == counts())
    out[make.__name__] = entry
    bpy.data.objects.remove(obj)
    bpy.data.materials.remove(material)
report(out=out, engine=bpy.context.scene.render.engine, osl=bpy.context.scene.cycles.shading_system)
"""
    )
    assert result["engine"] == "CYCLES" and result["osl"]
    for name, entry in result["out"].items():
        assert entry["set_up"] == 1 and entry["source"] == "LIVE", name
        assert entry["cycles"] == "LTMD Output", name
        assert entry["eevee"] != "LTMD Output" or name == "no_output", name
        assert entry["attribute"] and not entry["attribute_left"], name
        assert entry["texts"] == 0 and entry["lobes"] == 1, name
        assert entry["same"], (name, entry["before"], entry["after"])
        assert entry["left"] == "NONE" and entry["data"], name


def test_an_object_without_material_gets_one_and_loses_it_again():
    result = run(
        PRELUDE
        + """
obj = cube(uv=False)
bpy.ops.ltmd.setup(object_name="Cube")
during = [m.name for m in obj.data.materials], obj.ltmd.source
bpy.ops.ltmd.remove(object_name="Cube")
report(during=during, after=[len(obj.data.materials), len(bpy.data.materials), obj.ltmd.slot_added])
"""
    )
    assert result["during"][1] == "LIVE" and len(result["during"][0]) == 1
    assert result["after"] == [0, 0, False]


RENDERED = (
    PRELUDE
    + """
def lit_scene():
    cycles(32, 32, samples=8)
    camera((4, -5, 3), ortho_scale=5)
    light = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    light.data.energy = 3
    light.rotation_euler = (.5, .5, 0)
    bpy.context.scene.collection.objects.link(light)
"""
)


def test_renders_the_same_after_saving_and_in_a_blender_without_the_extension(tmp_path):
    path = str(Path(tmp_path) / "scene.blend")
    first = run(
        RENDERED
        + """
lit_scene()
obj = cube()
material = new_material("Rubber", obj)
principled(material).inputs["Base Color"].default_value = (.8, .1, .05, 1)
obj.shape_key_add(name="Basis")
key = obj.shape_key_add(name="Long")
for point in key.data:
    point.co.x *= 1.6
    point.co.y *= .7
key.value = 1
bpy.ops.ltmd.setup(object_name="Cube")
with_tension = render()[..., :3]
surface.lobe(material).inputs["Strength"].default_value = 0
without = render()[..., :3]
surface.lobe(material).inputs["Strength"].default_value = 1
bpy.ops.wm.save_as_mainfile(filepath=ARGUMENTS)
report(picture=with_tension, difference=np.abs(with_tension - without).max())
""",
        arguments=path,
    )
    assert np.mean(first["picture"]) > 0.01 and first["difference"] > 1e-3
    assert np.array(first["picture"])[16, 16, 0] > 3 * np.array(first["picture"])[16, 16, 2]
    for addon in (True, False):
        again = run(
            """
bpy.ops.wm.open_mainfile(filepath=ARGUMENTS)
report(picture=render()[..., :3], texts=len(bpy.data.texts))
""",
            arguments=path,
            addon=addon,
        )
        assert np.array_equal(first["picture"], again["picture"])
        assert again["texts"] == 0
    # And still removable in the reopened file.
    removed = run(
        """
bpy.ops.wm.open_mainfile(filepath=ARGUMENTS)
bpy.ops.ltmd.remove(object_name="Cube")
m = bpy.data.materials["Rubber"]
report(nodes=sorted(n.name for n in m.node_tree.nodes), groups=len(bpy.data.node_groups),
       target=m.node_tree.nodes["Material Output"].target)
""",
        arguments=path,
    )
    assert removed["nodes"] == ["Material Output", "Principled BSDF"]
    assert removed["groups"] == 0 and removed["target"] == "ALL"


def test_linked_data_is_refused_in_words_and_overrides_work(tmp_path):
    path = str(Path(tmp_path) / "library.blend")
    run(
        PRELUDE
        + """
obj = cube()
new_material("Shared", obj)
bpy.ops.wm.save_as_mainfile(filepath=ARGUMENTS)
""",
        arguments=path,
    )
    result = run(
        PRELUDE
        + """
with bpy.data.libraries.load(ARGUMENTS, link=True) as (found, wanted):
    wanted.objects = ["Cube"]
linked = wanted.objects[0]
bpy.context.scene.collection.objects.link(linked)
try:
    bpy.ops.ltmd.setup(object_name="Cube")
    refused = "not refused"
except RuntimeError as error:
    refused = str(error)
override = linked.override_create(remap_local_usages=True)
told = setup.set_up(override)
report(refused=refused, told=told, source=override.ltmd.source,
       slots=[[s.link, s.material.name, s.material.library is None, surface.is_set_up(s.material)]
              for s in override.material_slots],
       mesh_attributes=list(override.data.attributes.keys()))
""",
        arguments=path,
    )
    assert "Make a library override first" in result["refused"]
    assert result["source"] == "LIVE"
    assert result["slots"] == [["OBJECT", "Shared Cube", True, True]]
    assert "ltmd_rest" not in result["mesh_attributes"]
    assert any("own copy" in sentence for sentence in result["told"])


def test_nodes_that_the_user_deleted_come_back_or_are_asked_for():
    result = run(
        PRELUDE
        + """
from blender_addon import false_colour

obj = cube()
material = new_material("M", obj)
before = dump(material)
nodes = material.node_tree.nodes
whole = []
for find in (surface.frame, surface.lobe, lambda m: nodes["LTMD Live Tension"]):
    setup.set_up(obj)
    nodes.remove(find(material))
    setup.set_up(obj)
    taker = surface.lobe(material)
    whole.append(taker is not None and taker.inputs["Tension"].is_linked)
setup.remove(obj)
same = dump(material) == before

setup.set_up(obj)
for node in [n for n in nodes if n.type == "OUTPUT_MATERIAL"]:
    nodes.remove(node)
try:
    false_colour.show(material)
except source.SourceError as error:
    said = str(error)
report(whole=whole, same=same, said=said)
"""
    )
    assert result["whole"] == [True] * 3 and result["same"]
    assert "M has no Material Output" in result["said"]


def test_a_refused_source_leaves_no_material_behind():
    result = run(
        PRELUDE
        + """
obj = cube(uv=False)
said = []
for kind, mode in (("ATTRIBUTE", "BASIS"), ("LIVE", "OBJECT")):
    obj.ltmd.rest_mode = mode
    try:
        setup.set_up(obj, kind)
    except source.SourceError as error:
        said.append(str(error))
report(said=said, left=[len(bpy.data.materials), len(obj.data.materials), obj.ltmd.source])
"""
    )
    assert "needs a UV map" in result["said"][0] and "rest object" in result["said"][1]
    assert result["left"] == [0, 0, "NONE"]


def test_remove_leaves_other_objects_their_own_and_linked_materials_alone(tmp_path):
    path = str(Path(tmp_path) / "library.blend")
    run(
        PRELUDE
        + """
obj = cube()
new_material("Foreign", obj)
setup.set_up(obj)
bpy.ops.wm.save_as_mainfile(filepath=ARGUMENTS)
""",
        arguments=path,
    )
    result = run(
        PRELUDE
        + """
a, b = cube("A"), cube("B")
shared, own = new_material("Shared", a), new_material("Own", b)
b.data.materials.append(shared)
for obj in (a, b):
    setup.set_up(obj)
told = setup.remove(a)
kept = [b.ltmd.source, "ltmd_rest" in b.data.attributes, surface.is_set_up(own)]

with bpy.data.libraries.load(ARGUMENTS, link=True) as (found, wanted):
    wanted.materials = ["Foreign"]
foreign = wanted.materials[0]
a.data.materials[0] = foreign
nodes = len(foreign.node_tree.nodes)
try:
    bpy.ops.ltmd.remove(object_name="A")
except RuntimeError as error:
    refused = str(error)
report(told=told, kept=kept, refused=refused, same=len(foreign.node_tree.nodes) == nodes)
""",
        arguments=path,
    )
    assert result["told"] == ["Shared is shared: also removed from B"]
    assert result["kept"] == ["LIVE", True, True]
    assert "Foreign: nodes of linked" in result["refused"] and result["same"]


def test_shared_material_becomes_a_copy_only_for_textures():
    result = run(
        PRELUDE
        + """
a, b = cube("A"), cube("B")
material = new_material("Shared", a)
b.data.materials.append(material)
twin = bpy.data.objects.new("Twin", a.data)  # shares the mesh as well
link(twin)
bpy.ops.object.select_all(action="SELECT")
bpy.ops.ltmd.setup()
live = [o.material_slots[0].material.name for o in (a, b, twin)]
told = source.switch_to_texture(a, material, {1001: {"path": "/tmp/none.0001.exr", "frames": [1]}})
after = [o.material_slots[0].material.name for o in (a, b, twin)]
report(live=live, told=told, after=after, sources=[o.ltmd.source for o in (a, b, twin)])
"""
    )
    assert result["live"] == ["Shared"] * 3
    assert result["after"] == ["Shared A", "Shared", "Shared"]
    assert "own copy" in result["told"][0] and "Twin" in result["told"][0]
    assert result["sources"] == ["TEXTURE", "LIVE", "LIVE"]


def test_each_frame_shows_its_own_file(tmp_path):
    result = run(
        PRELUDE
        + """
scene = cycles(4, 4)
obj = mesh_object("Plane", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2, 3)],
                  [(0, 0), (1, 0), (1, 1), (0, 1)])
camera((0, 0, 3), ortho_scale=.5)
material = new_material("M", obj)
frames = [0, 1, 7, 24, 1001]
for frame in frames:
    pixels = np.ones((8, 8, 4), np.float32)
    pixels[..., :3] = (1 + frame / 100, -frame / 1000, 2 / (2 + frame))
    write_image(os.path.join(ARGUMENTS, f"Plane_tension.{frame:04d}.exr"), pixels)
bpy.ops.ltmd.setup(object_name="Plane")
bpy.ops.wm.save_as_mainfile(filepath=os.path.join(ARGUMENTS, "scene.blend"))
first = os.path.join(ARGUMENTS, "Plane_tension.0000.exr")
source.switch_to_texture(obj, material, {1001: {"path": first, "frames": frames}})
# Look at the tension itself.
tree = material.node_tree
socket = surface.lobe(material).inputs["Tension"].links[0].from_socket
emission = tree.nodes.new("ShaderNodeEmission")
tree.links.new(socket, emission.inputs["Color"])
tree.links.new(emission.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
scene.frame_end = 2000
picture = next(n for n in tree.nodes if n.type == "TEX_IMAGE")
stills = [render(frame)[2, 2, :3] for frame in frames]
animated = [p[2, 2, :3] for p in render(animation_frames=frames)]
missing = [render(frame)[2, 2, :3] for frame in (12, 1500)]
limits = [source.texture_limits(obj, frame) for frame in (7, 1500)]
bpy.ops.wm.save_mainfile()
bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)
reloaded = [render(frame)[2, 2, :3] for frame in frames]
picture = next(n for n in bpy.data.materials["M"].node_tree.nodes if n.type == "TEX_IMAGE")
report(expected=[(1 + f / 100, -f / 1000, 2 / (2 + f)) for f in frames], stills=stills,
       animated=animated, reloaded=reloaded, missing=missing, limits=limits,
       path=picture.image.filepath, data=picture.image.colorspace_settings.is_data,
       images=len(bpy.data.images))
""",
        arguments=str(tmp_path),
    )
    for kind in ("stills", "animated", "reloaded"):
        assert np.abs(np.array(result[kind]) - result["expected"]).max() < 1e-5, result[kind]
    assert np.allclose(result["missing"], (1, 0, 1), atol=1e-6)  # never another frame's file
    assert result["limits"][0] is None and "baked are the frames 0 to 1001" in result["limits"][1]
    assert result["path"] == "//Plane_tension.0000.exr"
    assert result["data"]


RIGS = (
    PRELUDE
    + """
def sphere(name="Ball"):
    bpy.ops.mesh.primitive_uv_sphere_add(segments=12, ring_count=8)
    obj = bpy.context.object
    obj.name = name
    return obj

MATRIX = np.array([[1.5, .4, 0], [0, .7, 0], [0, .2, 1.2]])

def bones(obj):
    # One bone for all vertices: an affine pose is exact on every facet.
    data = bpy.data.armatures.new("Rig")
    rig = link(bpy.data.objects.new("Rig", data))
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    bone = data.edit_bones.new("All")
    bone.head, bone.tail = (0, 0, 0), (0, 1, 0)
    bpy.ops.object.mode_set(mode="OBJECT")
    obj.vertex_groups.new(name="All").add(range(len(obj.data.vertices)), 1, "REPLACE")
    modifier = obj.modifiers.new("Armature", "ARMATURE")
    modifier.object = rig
    def pose(on):
        rig.pose.bones["All"].scale = (1.5, .7, 1.2) if on else (1, 1, 1)
    return pose

def keys(obj):
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Deformed")
    for point in key.data:
        point.co = MATRIX @ np.array(point.co)
    key.value = 0
    def pose(on):
        key.value = 1.0 if on else 0.0
    return pose

def subsurf(obj):
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = 2

def mirror(obj):
    obj.modifiers.new("Mirror", "MIRROR").use_axis = (False, True, False)
    for vertex in obj.data.vertices:
        vertex.co.y += 1.5

def simple(obj):
    obj.modifiers.new("Simple", "SUBSURF").subdivision_type = "SIMPLE"

def solidify(obj):
    obj.modifiers.new("Solidify", "SOLIDIFY").thickness = .1

cycles(48, 48)
camera((3, -6, 4), ortho_scale=6)
world = bpy.data.worlds.new("World")
out = {}
for name, parts, scale in (
    ("keys", (keys,), False),
    ("armature", (bones,), True),
    ("subsurf, keys", (subsurf, keys), False),
    ("armature, subsurf", (bones, subsurf), True),
    ("subsurf, armature", (subsurf, bones), True),
    ("mirror, armature", (mirror, bones), True),
    ("mirror, subsurf, armature", (mirror, subsurf, bones), True),
    ("simple subdivision, armature", (simple, bones), True),
    ("solidify, armature", (solidify, bones), True),
):
    obj = sphere()
    for part in parts:
        pose = part(obj) or (pose if "pose" in dir() else None)
    material = new_material("M", obj)
    bpy.ops.ltmd.setup(object_name=obj.name)
    tree = material.node_tree
    socket = surface.lobe(material).inputs["Tension"].links[0].from_socket
    emission = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(socket, emission.inputs["Color"])
    tree.links.new(emission.outputs[0], tree.get_output_node("CYCLES").inputs["Surface"])
    pose(False)
    at_rest = render()
    hit = at_rest[..., 0] > 0
    pose(True)
    posed = render()
    there = posed[..., 0] > 0
    t = posed[there][:, :3].astype(float)
    # Squared stretches lie between those of the whole map, and their extremes come near.
    c = t[:, 0] ** 2, t[:, 0] * t[:, 1], t[:, 1] ** 2 + t[:, 2] ** 2
    mean, dev = (c[0] + c[2]) / 2, np.hypot((c[0] - c[2]) / 2, c[1])
    limits = np.linalg.svd(np.diag((1.5, .7, 1.2)) if scale else MATRIX, compute_uv=False)
    out[name] = dict(hit=int(hit.sum()), rest=np.abs(at_rest[hit][:, :3] - (1, 0, 1)).max(),
                     largest=np.sqrt(mean + dev).max(), smallest=np.sqrt(mean - dev).min(),
                     limits=[limits[0], limits[-1]], generated=source.needs_generated(obj))
    for item in list(bpy.data.objects):
        if item.type in ("MESH", "ARMATURE"):
            bpy.data.objects.remove(item)
    bpy.data.materials.remove(material)
report(out=out)
"""
)


def test_rigs_are_at_rest_at_rest_and_follow_the_pose():
    result = run(RIGS)
    for name, entry in result["out"].items():
        print(
            f"{name}: at rest off by {entry['rest']:.1e}; stretch {entry['smallest']:.4f} to "
            f"{entry['largest']:.4f}, limits {entry['limits'][1]:.4f}, {entry['limits'][0]:.4f}"
        )
    for name, entry in result["out"].items():
        assert entry["hit"] > 150, (name, entry)
        assert entry["rest"] < 5e-5, (name, entry)
        high, low = entry["limits"]
        assert low * 0.999 < entry["smallest"] < low * 1.1, (name, entry)
        assert high * 0.9 < entry["largest"] < high * 1.001, (name, entry)
        assert entry["generated"] == any(
            word in name for word in ("subsurf", "simple", "solidify")
        ), name


def test_without_the_library_the_add_on_registers_and_says_what_is_needed():
    result = run(
        """
sys.modules["ltmd"] = None  # as if no wheel fitted this Python
load_addon()
from blender_addon import library, panel
from layout import Layout

obj = mesh_object("Plane", [(-1, -1, 0), (1, -1, 0), (1, 1, 0)], [(0, 1, 2)])
words = []
panel.draw(Layout(words), bpy.context)
panel.draw_bake(Layout(words), bpy.context)
before = " ".join(words)
bpy.ops.ltmd.setup(object_name="Plane")
words = []
panel.draw(Layout(words), bpy.context)
import blender_addon
blender_addon.unregister()
blender_addon.register()
report(problem=library.problem(), before=before, after=" ".join(words))
""",
        addon=False,
    )
    assert "Python" in result["problem"] and "ltmd library" in result["problem"]
    assert "Not set up" in result["before"]
    assert "The render engine is not Cycles" in result["before"]
    assert "ltmd library" in result["before"] and "Output Folder" in result["before"]
    assert "Renders on the CPU with Open Shading Language" in result["after"]
    assert "Live:" in result["after"] and "Roughness" in result["after"]


def test_remove_after_textures_leaves_no_image_and_the_same_tree():
    result = run(
        PRELUDE
        + """
a, b = cube("A"), cube("B")
material = new_material("Shared", a)
b.data.materials.append(material)
before = dump(material)
bpy.ops.ltmd.setup(object_name="A")
bpy.ops.ltmd.setup(object_name="B")
files = {u: {"path": f"/tmp/none.{u}.0001.exr", "frames": [1, 2]} for u in (1001, 1002, 1011)}
source.switch_to_texture(a, material, files)
own = a.material_slots[0].material
nodes = len(surface.our_nodes(own, "source"))
source.switch_to_texture(a, own, files)  # again: replaced, not doubled
again = len(surface.our_nodes(own, "source")), len(bpy.data.images)
bpy.ops.ltmd.setup(object_name="A")  # set-up alone keeps the baked images
assert a.ltmd.source == "TEXTURE"
bpy.ops.ltmd.setup(object_name="A", source="LIVE")
live = len(bpy.data.images), a.ltmd.source
source.switch_to_texture(a, own, files)
bpy.ops.ltmd.remove(object_name="A")
b_still = surface.is_set_up(material), b.ltmd.source
bpy.ops.ltmd.remove(object_name="B")
report(nodes=nodes, again=again, live=live, b_still=b_still, images=len(bpy.data.images),
       own=dump(own) == before, shared=dump(material) == before, groups=len(bpy.data.node_groups),
       left=[list(o.data.attributes.keys()) for o in (a, b)])
"""
    )
    assert result["nodes"] == 1 + 3 * 2 + 2  # a UV map, per tile image and group, two shifts
    assert result["again"] == [9, 3] and result["live"] == [0, "LIVE"]
    assert result["b_still"] == [True, "LIVE"]
    assert result["images"] == 0 and result["groups"] == 0
    assert result["own"] and result["shared"]
    assert not any("ltmd_rest" in names for names in result["left"])


def test_a_shader_that_does_not_compile_is_said_in_words_and_changes_nothing(tmp_path):
    result = run(
        PRELUDE
        + """
from pathlib import Path
from blender_addon import osl_script
folder = Path(ARGUMENTS["folder"])
shaders = osl_script.folder()
osl_script.folder = lambda: folder
obj, bare = cube(), cube("Bare")
material = new_material("M", obj)
before, data = dump(material), counts()
said = []
for broken in ("ltmd_glossy", "ltmd_tension_live"):
    for name in ("ltmd_glossy", "ltmd_tension_live"):
        text = "shader x( { broken" if name == broken else osl_script.inlined(
            shaders / f"{name}.osl")
        (folder / f"{name}.osl").write_text(text)
    for name in ("Cube", "Bare"):
        try:
            bpy.ops.ltmd.setup(object_name=name)
        except RuntimeError as error:
            said.append(str(error))
report(said=said, same=dump(material) == before, data=[data, counts()],
       source=[obj.ltmd.source, bare.ltmd.source, material.ltmd.set_up],
       slots=len(bare.material_slots),
       attributes=[list(o.data.attributes.keys()) for o in (obj, bare)])
""",
        arguments={"folder": str(tmp_path)},
    )
    assert len(result["said"]) == 4
    for sentence, shader in zip(
        result["said"], ["ltmd_glossy"] * 2 + ["ltmd_tension_live"] * 2, strict=True
    ):
        assert f"The shader {shader} could not be compiled" in sentence
    assert result["same"] and result["data"][0] == result["data"][1]
    assert result["source"] == ["NONE", "NONE", 0] and result["slots"] == 0
    assert not any("ltmd_rest" in names for names in result["attributes"])


def test_a_blender_built_without_osl_sets_up_with_stock_nodes():
    result = run(
        PRELUDE
        + """
from blender_addon import device, osl_script

def no_compiler(node, name, scene=None):
    raise RuntimeError(f"compiled {name}")

osl_script.fill = no_compiler
device.has_osl = lambda context: False
source.COMPILES = False
obj = cube()
material = new_material("M", obj)
before = dump(material)
said = []
bpy.ops.ltmd.convert_material(object_name="Cube", method="DRIVE")
out = [obj.ltmd.source, [n.label for n in surface.our_nodes(material, "source")]]
try:
    bpy.ops.ltmd.setup(object_name="Cube", source="LIVE")
except RuntimeError as error:
    said.append(str(error))
files = {1001: {"path": "/tmp/none.0001.exr", "frames": [1, 2]}}
source.switch_to_texture(obj, material, files)
out += [obj.ltmd.source, [n.label for n in surface.our_nodes(material, "source")]]
bpy.ops.ltmd.remove(object_name="Cube")
report(out=out, said=said, same=dump(material) == before)
"""
    )
    kind, names, textures, last = result["out"]
    assert kind == "TENSOR" and "LTMD Tensor Tension (no OSL)" in names
    assert "Live tension needs Open Shading Language" in result["said"][0]
    assert textures == "TEXTURE" and "LTMD Texture Tension (no OSL)" in last
    assert result["same"]
