# SPDX-License-Identifier: Apache-2.0
"""Add > LTMD in the shader editor: every node, the right twin, and words where it cannot be."""

from blender_process import run

ADD = """
from trees import *
from blender_addon import add_node, osl_script, versions

material = new_material("M", None)
tree = material.node_tree
cycles()
added = []
for name in [n for n in add_node.MENU if n]:
    bpy.ops.ltmd.add_node(node=name, material="M")
    added.append([name, tree.nodes.active.node_tree["ltmd_group"], tree.nodes.active.select])
bpy.context.scene.cycles.shading_system = False
bpy.ops.ltmd.add_node(node="LTMD Tension View", material="M")
stock = tree.nodes.active.node_tree["ltmd_group"]
bpy.context.scene.cycles.shading_system = True

said = []
before = dump(material)
folder = osl_script.folder
osl_script.folder = lambda: __import__("pathlib").Path(ARGUMENTS["folder"])
(osl_script.folder() / "ltmd_warp.osl").write_text("shader ltmd_warp( { broken")
for group in [g for g in bpy.data.node_groups if g["ltmd_group"] == "LTMD Warp"]:
    group["ltmd_version"] = 0
for options in ({"material": "M", "node": "LTMD Warp"}, {"node": "LTMD Warp"}):
    try:
        bpy.ops.ltmd.add_node(**options)
    except RuntimeError as error:
        said.append(str(error))
same = before == dump(material)

new_material("Foreign", None)
library = ARGUMENTS["folder"] + "/library.blend"
bpy.data.libraries.write(library, {bpy.data.materials["Foreign"]})
bpy.data.materials.remove(bpy.data.materials["Foreign"])
with bpy.data.libraries.load(library, link=True) as (found, wanted):
    wanted.materials = ["Foreign"]
override = wanted.materials[0].override_create()
try:
    bpy.ops.ltmd.add_node(node="LTMD Glossy", material=override.name)
except RuntimeError as error:
    said.append(str(error))
report(added=added, stock=stock, said=said, same=same, texts=len(bpy.data.texts))
"""


def test_every_node_of_the_menu(tmp_path):
    found = run(ADD, arguments={"folder": str(tmp_path)})
    assert len(found["added"]) > 10
    for name, group, selected in found["added"]:
        assert name == group and selected
    assert found["stock"] == "LTMD Tension View (no OSL)"
    compiler, nowhere, override = found["said"]
    assert "ltmd_warp could not be compiled" in compiler and "name of a material" in nowhere
    assert "make it local first" in override
    assert found["same"] and found["texts"] == 0
