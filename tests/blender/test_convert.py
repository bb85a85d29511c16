# SPDX-License-Identifier: Apache-2.0
"""Convert Material to LTMD: the same picture at rest, the deformed highlight of stock nodes, and
the user's tree back."""

import numpy as np
from blender_process import ROOT, run

PRELUDE = (
    f"""
sys.path[:0] = [{str(ROOT / "tests" / "blender")!r}, {str(ROOT / "tests" / "osl")!r}]
"""
    + """
from trees import *
from blender_addon import device, drive, setup, source, surface

def everything(material):
    # Also what animates the tree, and which links are muted.
    data = material.node_tree.animation_data
    return dump(material) + json.dumps([
        sorted(w.to_socket.identifier for w in material.node_tree.links if w.is_muted),
        data is None,
        sorted(f.data_path for f in data.drivers) if data else [],
        bool(data and data.action),
    ])

def node(m, kind):
    return m.node_tree.nodes.new(kind)

def link(m, a, b):
    return m.node_tree.links.new(a, b)

def set_values(m, **values):
    for name, value in values.items():
        principled(m).inputs[name.replace("_", " ")].default_value = value

def textured(m):
    noise, bump = node(m, "ShaderNodeTexNoise"), node(m, "ShaderNodeBump")
    link(m, noise.outputs["Fac"], principled(m).inputs["Roughness"])
    link(m, noise.outputs["Color"], principled(m).inputs["Base Color"])
    link(m, noise.outputs["Fac"], bump.inputs["Height"])
    link(m, bump.outputs[0], principled(m).inputs["Normal"])

def metal(m):
    set_values(m, Metallic=1, Roughness=.3, Anisotropic=.7, Anisotropic_Rotation=.15)

def metal_with_tangent(m):
    set_values(m, Metallic=1, Roughness=.3)
    tangent, noise = node(m, "ShaderNodeTangent"), node(m, "ShaderNodeTexNoise")
    tangent.direction_type, tangent.axis = "RADIAL", "X"
    link(m, tangent.outputs[0], principled(m).inputs["Tangent"])
    for name in ("Anisotropic", "Anisotropic Rotation"):
        link(m, noise.outputs["Fac"], principled(m).inputs[name])

def coated(m):
    set_values(m, Coat_Weight=1, Coat_Roughness=.2, Roughness=.6, Alpha=.7)

def glass(m):
    set_values(m, Transmission_Weight=1, Roughness=.2)

def skin(m):
    set_values(m, Subsurface_Weight=.5, Sheen_Weight=.5)

def mixed(m):
    # Through a reroute: a glossy and a metallic node, one link muted.
    glossy, mix = node(m, "ShaderNodeBsdfAnisotropic"), node(m, "ShaderNodeMixShader")
    other, reroute = node(m, "ShaderNodeBsdfMetallic"), node(m, "NodeReroute")
    glossy.inputs["Anisotropy"].default_value = .5  # of the sign of ours: with the same noise
    # Without Rotation, which stock Glossy nodes turn otherwise without OSL than with it.
    other.inputs["Anisotropy"].default_value = .6
    value = node(m, "ShaderNodeValue")
    value.outputs[0].default_value = .9
    link(m, value.outputs[0], glossy.inputs["Roughness"]).is_muted = True
    link(m, glossy.outputs[0], reroute.inputs[0])
    link(m, reroute.outputs[0], mix.inputs[1])
    link(m, other.outputs[0], mix.inputs[2])
    link(m, mix.outputs[0], m.node_tree.nodes["Material Output"].inputs["Surface"])

def animated(m):
    socket = principled(m).inputs["Roughness"]
    for frame, value in ((1, .2), (11, .8)):
        socket.default_value = value
        socket.keyframe_insert("default_value", frame=frame)
    driver = principled(m).inputs["Anisotropic"].driver_add("default_value").driver
    driver.type = "AVERAGE"
    target = driver.variables.new().targets[0]
    target.id, target.data_path = bpy.data.objects["Cube"], "location.z"

def linked_group(m):
    # The colour comes from a node group.
    tree = bpy.data.node_groups.new("Colour", "ShaderNodeTree")
    tree.interface.new_socket("Color", in_out="OUTPUT", socket_type="NodeSocketColor")
    end = tree.nodes.new("NodeGroupOutput")
    end.inputs[0].default_value = (.1, .6, .2, 1)
    user = node(m, "ShaderNodeGroup")
    user.node_tree = tree
    link(m, user.outputs[0], principled(m).inputs["Base Color"])

MATERIALS = (lambda m: None, textured, metal, metal_with_tangent, coated, glass, skin, mixed,
             animated, linked_group)

def scene(osl=True, size=32, samples=4):
    made = cycles(size, size, samples=samples, osl=osl)
    made.cycles.max_bounces = 3
    camera((4, -5, 3), ortho_scale=4.5)
    sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
    sun.data.energy = 3
    sun.data.angle = 0
    sun.rotation_euler = (.5, .5, 0)
    bpy.context.scene.collection.objects.link(sun)
    world = bpy.data.worlds.new("World")
    world.color = (.4, .5, .6)
    bpy.context.scene.world = world
    return made
"""
)


def test_at_rest_nothing_changes_and_remove_gives_the_tree_back():
    result = run(
        PRELUDE
        + """
obj = cube()
bpy.ops.object.shade_smooth()
scene()
obj.location.z = .3
out = {}

def changed(picture, other):
    # Rounding may send a path elsewhere where lobes are picked at random: how many pixels differ.
    return (np.abs(picture - other).max(axis=2) > 1e-4).mean()

def both():
    pictures = []
    for osl in (False, True):
        bpy.context.scene.cycles.shading_system = osl
        pictures.append(render())
    return pictures[::-1]

for make in MATERIALS:
    obj.data.materials.clear()
    material = new_material("M", obj)
    make(material)
    # Two lobes are only evaluated: which one a ray follows depends on their order in the graph.
    bpy.context.scene.cycles.max_bounces = 0 if make is mixed else 3
    bpy.context.scene.world.color = (0, 0, 0) if make is mixed else (.4, .5, .6)
    bpy.context.scene.frame_set(6)
    tree, data, (plain, plain_svm) = everything(material), counts(), both()
    bpy.ops.ltmd.convert_material(object_name=obj.name)
    after, unmatched = both()
    device.match(material, False)
    _, without = both()
    bpy.context.scene.cycles.shading_system = False
    told = device.mismatch(material, bpy.context)
    device.match(material, True)
    entry = dict(error=changed(after, plain), without=changed(without, plain_svm), told=told,
                 words=device.mismatch(material, bpy.context),
                 unmatched=changed(unmatched, plain_svm),
                 mean=plain[..., :3].mean(), driven=drive.is_driven(material),
                 taken=[[n.label for n in surface.takers(material)]],
                 outputs=sum(n.type == "OUTPUT_MATERIAL" for n in material.node_tree.nodes))
    bpy.ops.ltmd.convert_material(object_name=obj.name)  # again: nothing twice
    entry["again"] = len(surface.takers(material)) == len(entry["taken"][0])
    bpy.ops.ltmd.convert_material(object_name=obj.name, method="REPLACE")
    entry["replaced"] = [surface.lobe(material).label, drive.is_driven(material),
                         surface.lobe(material).inputs["Tension"].is_linked]
    bpy.ops.ltmd.convert_material(object_name=obj.name, method="DRIVE")
    entry["back"] = [drive.is_driven(material), changed(render(), plain)]
    bpy.ops.ltmd.remove(object_name=obj.name)
    entry.update(same=everything(material) == tree, left=counts() == data,
                 trees=[tree, everything(material)])
    out[make.__name__] = entry
report(out=out)
"""
    )
    for name, entry in result["out"].items():
        assert entry["mean"] > 0.02 and entry["driven"], name
        assert entry["error"] <= 0.002 and entry["without"] <= 0.002, (name, entry)
        # Without its shader a driven material is shown at rest, but for anisotropy.
        anisotropic = name in ("metal", "metal_with_tangent", "mixed", "animated")
        assert anisotropic or entry["unmatched"] <= 0.002, (name, entry)
        assert entry["told"] is None and "shows the rest state" in entry["words"], (name, entry)
        assert entry["outputs"] == 1 and entry["again"], name
        assert entry["replaced"] == ["LTMD Glossy", False, True], (name, entry["replaced"])
        assert entry["back"][0] and entry["back"][1] <= 0.002, (name, entry["back"])
        assert entry["same"] and entry["left"], (name, entry["trees"])
    assert len(result["out"]["coated"]["taken"][0]) == 2
    assert len(result["out"]["metal"]["taken"][0]) == 2


def test_a_deformed_plane_is_that_of_stock_nodes_with_the_analytic_alphas():
    """To a ratio of alphas of 10; on Principled and Metallic nodes it ends there, on Glossy not."""
    result = run(
        PRELUDE
        + """
from shading import affine_quad, lobe, material_matrix
scene()
camera((1.2, 2.2, 1.9), ortho_scale=2.4)
kinds = {"ShaderNodeBsdfPrincipled": ("Anisotropic", "Anisotropic Rotation", True),
         "ShaderNodeBsdfMetallic": ("Anisotropy", "Rotation", True),
         "ShaderNodeBsdfAnisotropic": ("Anisotropy", "Rotation", False)}
cases = []
for kind, (amount, turn, rough) in kinds.items():
    for deformation, anisotropic, rotation, own in (
        ([[1.5, .4], [0, .8]], 0, 0, 0), ([[1.5, .4], [0, .8]], .4, .2, 0),
        ([[.7, .2], [.3, 1.2]], .3, 0, .5), ([[2, 0], [0, .5]], 0, 0, 0)):
        obj = affine_quad(deformation, rest_attribute=False)
        material = new_material("M", obj)
        bsdf = principled(material)
        if bsdf.bl_idname != kind:
            bsdf = material.node_tree.nodes.new(kind)
            material.node_tree.links.new(
                bsdf.outputs[0], material.node_tree.nodes["Material Output"].inputs[0])
        elif kind == "ShaderNodeBsdfPrincipled":
            bsdf.inputs["Metallic"].default_value = 1
        tangent = material.node_tree.nodes.new("ShaderNodeTangent")
        tangent.direction_type = "UV_MAP"
        # The user's tangent is that of another UV map, turned against the tension's.
        other = obj.data.uv_layers.new(name="Own")
        c, s = np.cos(own), np.sin(own)
        corners = np.array([v.co[:2] for v in obj.data.vertices]) @ [[c, -s], [s, c]]
        other.uv.foreach_set("vector", corners.astype(np.float32).ravel())
        tangent.uv_map = "Own"
        material.node_tree.links.new(tangent.outputs[0], bsdf.inputs["Tangent"])
        bsdf.inputs["Roughness"].default_value = .5
        anisotropic *= 1 if rough else -1
        bsdf.inputs[amount].default_value = anisotropic
        bsdf.inputs[turn].default_value = rotation
        bpy.ops.ltmd.convert_material(object_name=obj.name)
        got = render()[..., :3]

        # The same by hand, with the lobe of T M0.
        f = np.array(deformation, float)
        c, s = f[:, 0] / np.linalg.norm(f[:, 0])
        tension = np.array([[c, s], [-s, c]]) @ f
        stretch = (1 - .9 * anisotropic)**.5 - 1 if rough else anisotropic
        ax, ay, angle = lobe(.25, tension @ material_matrix(stretch, 2 * np.pi * rotation + own, 0))
        direction = np.array([[c, -s], [s, c]]) @ (np.cos(angle), np.sin(angle))
        if rough:
            direction = (-direction[1], direction[0])
        bpy.ops.ltmd.remove(object_name=obj.name)
        constant = material.node_tree.nodes.new("ShaderNodeCombineXYZ")
        constant.inputs[0].default_value, constant.inputs[1].default_value = direction
        material.node_tree.links.new(constant.outputs[0], bsdf.inputs["Tangent"])
        bsdf.inputs["Roughness"].default_value = (min(ax, 1) * min(ay, 1))**.25
        ratio = min(ax, 1) / min(ay, 1)
        bsdf.inputs[amount].default_value = (
            min((1 - ratio) / .9, 1) if rough else 1 - ratio**.5)
        bsdf.inputs[turn].default_value = 0
        want = render()[..., :3]
        cases.append((kind, deformation, anisotropic, np.abs(got - want).max(), want.max(),
                      want.mean()))
        bpy.data.objects.remove(obj)
report(cases=cases)
"""
    )
    for kind, deformation, anisotropic, error, brightest, mean in result["cases"]:
        assert mean > 0.02
        assert error < 1e-5 * max(1, brightest), (kind, deformation, anisotropic, error, brightest)


def test_refusals_sharing_and_limits(tmp_path):
    result = run(
        PRELUDE
        + """
import os
folder = ARGUMENTS
# A library with one object.
shared = cube("Linked")
new_material("Linked", shared)
bpy.data.libraries.write(folder + "/library.blend", {shared})
bpy.data.objects.remove(shared)
bpy.data.materials.remove(bpy.data.materials["Linked"])
with bpy.data.libraries.load(folder + "/library.blend", link=True) as (there, here):
    here.materials = ["Linked"]
foreign = here.materials[0]

def attempt(**properties):
    try:
        return list(bpy.ops.ltmd.convert_material(**properties))
    except RuntimeError as error:
        return str(error)

out = {}
obj = cube("A")
obj.data.materials.append(foreign)
out["linked"] = attempt(object_name="A"), obj.ltmd.source, "ltmd_rest" in obj.data.attributes
override = foreign.override_create()
obj.data.materials[0] = override
out["override"] = attempt(object_name="A")
obj.data.materials.clear()

plain = new_material("Plain", obj)
plain.node_tree.nodes.remove(principled(plain))
before = everything(plain)
out["nothing"] = attempt(object_name="A"), before == everything(plain)
out["no mesh"] = attempt(object_name="Missing")
setup.set_up(obj)
before, materials = everything(plain), len(bpy.data.materials)
out["nothing to drive"] = (attempt(object_name="A"), before == everything(plain),
                           surface.is_set_up(plain), len(bpy.data.materials) == materials)
setup.remove(obj)

# A Principled inside a group, one outside.
good = new_material("Good", obj)
tree = bpy.data.node_groups.new("Hidden", "ShaderNodeTree")
tree.interface.new_socket("BSDF", in_out="OUTPUT", socket_type="NodeSocketShader")
inner = tree.nodes.new("ShaderNodeBsdfPrincipled")
tree.links.new(inner.outputs[0], tree.nodes.new("NodeGroupOutput").inputs[0])
user, mix = node(good, "ShaderNodeGroup"), node(good, "ShaderNodeMixShader")
user.node_tree = tree
link(good, principled(good).outputs[0], mix.inputs[1])
link(good, user.outputs[0], mix.inputs[2])
link(good, mix.outputs[0], good.node_tree.nodes["Material Output"].inputs[0])
told = setup.set_up(obj, method="DRIVE")
out["told"] = told, drive.is_driven(good), surface.is_set_up(plain), drive.limits(good)

# Two selected objects share the material; removing from one says so and restores it once.
other = cube("B")
other.data.materials.append(good)
for each in (obj, other):
    each.select_set(True)
out["both"] = attempt(), [o.ltmd.source for o in (obj, other)], len(surface.takers(good))
out["removed"] = setup.remove(obj), surface.is_set_up(good), other.ltmd.source

before = everything(good)
bpy.ops.ed.undo_push(message="Before")
bpy.ops.ltmd.convert_material(object_name="A")
bpy.ops.ed.undo_push(message="Convert")
converted = drive.is_driven(bpy.data.materials["Good"])
bpy.ops.ed.undo()
out["undo"] = converted, everything(bpy.data.materials["Good"]) == before
report(out=out)
""",
        arguments=str(tmp_path),
    )
    out = result["out"]
    error, source, stored = out["linked"]
    assert "make it local first" in error and source == "NONE" and not stored
    assert "make it local first" in out["override"]
    error, same = out["nothing"]
    assert "no Principled, Glossy or Metallic BSDF" in error and same
    assert "no object named Missing" in out["no mesh"]
    error, *unchanged = out["nothing to drive"]
    assert "Plain: no Principled, Glossy or Metallic BSDF" in error and all(unchanged)
    told, good, plain, limits = out["told"]
    assert good and not plain and "10 : 1" in limits
    assert any("the Principled BSDF of Hidden is inside a node group" in words for words in told)
    assert out["both"] == [["FINISHED"], ["LIVE", "LIVE"], 1]
    assert out["undo"] == [True, True]
    assert out["removed"] == [["Good is shared: also removed from B"], False, "NONE"]


def test_without_osl_the_twins_are_taken_and_follow_the_device():
    result = run(
        PRELUDE
        + """
obj = cube()
obj.shape_key_add(name="Basis")
key = obj.shape_key_add(name="Long")
for point in key.data:
    point.co.x *= 1.5
key.value = 1
material = new_material("M", obj)
scene(osl=False)
out = {}
bpy.ops.ltmd.setup(object_name="Cube", use_osl=False)
out["twin"] = surface.lobe(material).label, device.uses_osl(bpy.context), render()[..., :3].mean()
out["source"] = obj.ltmd.source, [n.label for n in surface.our_nodes(material, "source")]
stretched = render()
surface.lobe(material).inputs["Strength"].default_value = 0
out["seen"] = np.abs(render() - stretched).max()
surface.lobe(material).inputs["Strength"].default_value = 1
out["live"] = setup.set_up(obj, "LIVE", osl=False)
setup.set_up(obj, "TENSOR", osl=False)
out["same"] = device.mismatch(material, bpy.context)
surface.lobe(material).inputs["Roughness"].default_value = .3
bpy.context.scene.cycles.shading_system = True
out["changed"] = device.mismatch(material, bpy.context)
bpy.ops.ltmd.setup(object_name="Cube")
out["shader"] = (surface.lobe(material).label, device.mismatch(material, bpy.context),
                 surface.lobe(material).inputs["Roughness"].default_value, render()[..., :3].mean())
bpy.context.scene.cycles.shading_system = False
out["off"] = device.mismatch(material, bpy.context), render()[..., :3].mean()
bpy.ops.ltmd.setup(object_name="Cube", use_osl=False)
out["again"] = surface.lobe(material).label, render()[..., :3].mean()
report(out=out)
"""
    )
    out = result["out"]
    assert out["twin"][:2] == ["LTMD Glossy (no OSL)", False] and out["twin"][2] > 0.01
    assert out["source"][0] == "TENSOR" and "LTMD Tensor Tension (no OSL)" in out["source"][1]
    assert out["seen"] > 0.01
    assert any("live tension needs" in sentence for sentence in out["live"])
    assert out["same"] is None and "update" in out["changed"]
    assert out["shader"][:2] == ["LTMD Glossy", None]
    assert np.isclose(out["shader"][2], 0.3)
    assert "black" in out["off"][0]
    assert out["again"][0] == "LTMD Glossy (no OSL)"
    assert np.isclose(out["again"][1], out["shader"][3], rtol=1e-3)
