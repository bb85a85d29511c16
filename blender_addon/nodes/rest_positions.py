# SPDX-License-Identifier: GPL-3.0-or-later
"""Nodes that give the rest position in object space.

It is the point attribute `ltmd_rest` where the mesh has one, otherwise the Generated coordinates:
those are the undeformed surface divided by twice the texture space's size, which an Attribute node
reads from each object's own mesh, so one material serves many objects.
"""

REST_ATTRIBUTE = "ltmd_rest"


def add_rest_positions(tree, x, y):
    """(ltmd_rest, the same by Generated up to an offset, the object's size): sockets."""
    rest = tree.nodes.new("ShaderNodeAttribute")
    rest.attribute_name = REST_ATTRIBUTE
    rest.location = (x - 300, y + 200)

    generated = tree.nodes.new("ShaderNodeTexCoord")
    generated.location = (x - 300, y)
    size = tree.nodes.new("ShaderNodeAttribute")
    size.attribute_type = "OBJECT"
    size.attribute_name = "texspace_size"
    size.location = (x - 500, y - 300)
    doubled = tree.nodes.new("ShaderNodeVectorMath")
    doubled.operation = "SCALE"
    doubled.inputs["Scale"].default_value = 2.0
    doubled.location = (x - 300, y - 300)
    unscaled = tree.nodes.new("ShaderNodeVectorMath")
    unscaled.operation = "MULTIPLY"
    unscaled.location = (x - 100, y - 100)

    link = tree.links.new
    link(size.outputs["Vector"], doubled.inputs[0])
    link(generated.outputs["Generated"], unscaled.inputs[0])
    link(doubled.outputs["Vector"], unscaled.inputs[1])
    return rest.outputs["Vector"], unscaled.outputs["Vector"], doubled.outputs["Vector"]
