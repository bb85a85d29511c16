# SPDX-License-Identifier: Apache-2.0
"""Show Tension: the colours of the deformation, and the material again, untouched."""

import numpy as np
from blender_process import run

PRELUDE = """
from trees import *
from blender_addon import device, false_colour, source, surface

def stretched(name="Sheet"):
    '''A sheet of side 2, stretched twice along x, above the camera's whole picture.'''
    obj = mesh_object(name, [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2, 3)],
                      [(0, 0), (1, 0), (1, 1), (0, 1)])
    obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Wide")
    for point in key.data:
        point.co.x *= 2
    key.value = 1
    return obj
"""

COLOURS = (
    PRELUDE
    + """
scene = cycles(4, 4)
camera((0, 0, 3), ortho_scale=0.5)
obj = stretched()
material = new_material("M", obj)
principled(material).inputs["Emission Strength"].default_value = 1
bpy.ops.ltmd.setup(object_name=obj.name)
before, groups = dump(material), len(bpy.data.node_groups)
plain = render()[..., :3]
show = bpy.ops.ltmd.show_tension
out = {}
for mode in ("MAGNITUDE", "AREA", "DIRECTIONS"):
    show(object_name=obj.name, show="TENSION", mode=mode, range=4)
    out[mode] = render()[2, 2, :3]
values = [(v.inputs["Mode"].default_value, v.inputs["Range"].default_value)
          for v in false_colour.views(material)]

# Another file, later; then a change of the source while the tension is shown.
path = ARGUMENTS["folder"] + "/shown.blend"
show(object_name=obj.name, show="TENSION", mode="MAGNITUDE", range=4)
bpy.ops.wm.save_as_mainfile(filepath=path)
bpy.ops.wm.open_mainfile(filepath=path)
obj, material = bpy.data.objects["Sheet"], bpy.data.materials["M"]
loaded = render()[2, 2, :3]
bpy.ops.ltmd.setup(object_name=obj.name)
again = render()[2, 2, :3]
shown = false_colour.is_shown(material)
show(object_name=obj.name)
hidden = dump(material)
back = render()[..., :3]

# Without OSL the view is made of stock nodes; the tension is a value here.
show(object_name=obj.name)
scene = bpy.context.scene
scene.cycles.shading_system = False
show(object_name=obj.name, show="TENSION", range=4)
view = false_colour.views(material)[0]
for link in list(view.inputs["Tension"].links):
    material.node_tree.links.remove(link)
view.inputs["Tension"].default_value = (2, 0, 1)
stock = view.node_tree.name, render()[2, 2, :3]
scene.cycles.shading_system = True
show(object_name=obj.name)
same = [before == hidden, before == dump(material)]
groups = [groups, len(bpy.data.node_groups)]

# EEVEE has its own output, which the colours reach where they can be read without OSL.
eevee = {}
for kind in ("LIVE", "ATTRIBUTE", "TENSOR"):
    bpy.ops.ltmd.setup(object_name=obj.name, source=kind)
    now = dump(material)
    show(object_name=obj.name, mode="AREA", range=3)
    material.ltmd.view_range = 5
    output = material.node_tree.get_output_node("EEVEE")
    node = output.inputs["Surface"].links[0].from_node
    view = node.inputs[2].links[0].from_node if node.type == "MIX_SHADER" else None
    eevee[kind] = [node.type, len(false_colour.views(material))]
    if view:
        eevee[kind] += [view.node_tree["ltmd_group"], view.inputs["Range"].default_value,
                        view.inputs["Tension"].links[0].from_node.node_tree["ltmd_group"],
                        device.mismatch(material, bpy.context)]
        # In Cycles the attribute is there as well.
        bpy.context.view_layer.update()
        end = material.node_tree.nodes["LTMD Output"].inputs["Surface"]
        kept = end.links[0].from_socket
        material.node_tree.links.new(view.outputs[0], end)
        view.inputs["Mode"].default_value, view.inputs["Range"].default_value = 0, 4
        eevee[kind].append(render()[2, 2, :3])
        material.node_tree.links.new(kept, end)
    show(object_name=obj.name)
    eevee[kind].append(dump(material) == now)
# Shown while the source changes.
show(object_name=obj.name, mode="DIRECTIONS", range=7)
bpy.ops.ltmd.setup(object_name=obj.name, source="ATTRIBUTE")
kept = [[v.inputs[n].default_value for n in ("Mode", "Range")]
        for v in false_colour.views(material)]
report(eevee=eevee, kept=kept, out=out, values=values, loaded=loaded, again=again, shown=shown,
       plain=plain, back=back, stock=stock, same=same, groups=groups)
"""
)


def test_shown_and_hidden_again(tmp_path):
    found = run(COLOURS, arguments={"folder": str(tmp_path)})
    red, green, blue = found["out"]["MAGNITUDE"]
    assert red > 1.5 * blue and abs(green - blue) < 0.02, found["out"]
    assert np.allclose(found["out"]["MAGNITUDE"], found["out"]["AREA"], atol=1e-6)
    assert not np.allclose(found["out"]["MAGNITUDE"], found["out"]["DIRECTIONS"], atol=0.02)
    assert found["values"] == [[2, 4.0]]
    for other in ("loaded", "again"):
        assert np.allclose(found[other], found["out"]["MAGNITUDE"], atol=1e-6), other
    assert found["shown"] and found["same"] == [True, True]
    assert found["back"] == found["plain"]
    assert found["groups"][0] == found["groups"][1]
    name, pixel = found["stock"]
    assert name == "LTMD Tension View (no OSL)"
    assert np.allclose(pixel, found["out"]["MAGNITUDE"], atol=1e-6)
    eevee = found["eevee"]
    assert eevee["LIVE"] == ["BSDF_PRINCIPLED", 1, True]
    for kind in ("Attribute", "Tensor"):
        *head, source, warned, pixel, same = eevee[kind.upper()]
        assert head == ["MIX_SHADER", 2, "LTMD Tension View (no OSL)", 5.0]
        assert source == f"LTMD {kind} Tension (no OSL)" and warned is None and same
        assert np.allclose(pixel, found["out"]["MAGNITUDE"], atol=1e-5)
    assert found["kept"] == [[2, 7.0], [2, 7.0]]


def test_remove_while_shown_shared_materials_and_refusals():
    found = run(
        PRELUDE
        + """
a, b, other = stretched("A"), stretched("B"), stretched("Other")
material = new_material("Shared", a)
b.data.materials.append(material)
before = dump(material)
show = bpy.ops.ltmd.show_tension
said = []
for act in (lambda: show(object_name="Other"), lambda: show(object_name="None")):
    try:
        act()
    except RuntimeError as error:
        said.append(str(error))
for obj in (a, b):
    bpy.ops.ltmd.setup(object_name=obj.name)
set_up = dump(material)
bpy.ops.object.select_all(action="DESELECT")
for obj in (a, b):
    obj.select_set(True)
bpy.context.view_layer.objects.active = a
show()
shown = false_colour.is_shown(material), len(false_colour.views(material))
show()
hidden = dump(material) == set_up
show()
bpy.ops.ltmd.remove()
report(said=said, shown=shown, hidden=hidden, same=before == dump(material),
       left=[len(bpy.data.node_groups), len(bpy.data.texts)])
"""
    )
    assert "Other is not set up" in found["said"][0] and "Set Up LTMD" in found["said"][0]
    assert "no object named None" in found["said"][1]
    assert found["shown"] == [True, 1] and found["hidden"]
    assert found["same"] and found["left"] == [0, 0]
