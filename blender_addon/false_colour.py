# SPDX-License-Identifier: GPL-3.0-or-later
"""The deformation in false colour instead of the material's surface, and back.

The material's own surface stays linked, as the unused side of a Mix Shader before each output, so
the graph itself records what hiding restores.
"""

from . import nodes, source, surface
from .nodes import attribute_tension, tension_view, tension_view_no_osl

PART = "view"  # of surface.KEY


def views(material):
    """The nodes with the false colours."""
    return [node for node in surface.our_nodes(material, PART) if "Tension" in node.inputs]


def is_shown(material):
    return surface.is_set_up(material) and bool(views(material))


def legend(view):
    """What the colours mean, in words."""
    mode, limit = view.inputs["Mode"].default_value, view.inputs["Range"].default_value
    what = "area" if mode == 1 else "length"
    words = f"Grey: as at rest. Red: {limit:g} times the {what}. Blue: {1 / limit:.0%} of it."
    if mode != 1:
        words += " Purple: both, across each other."
    if mode == 2 and nodes.without_osl(view.node_tree):
        words += " Strokes need Open Shading Language."
    elif mode == 2:
        words += " Strokes lie along the largest stretch."
    return words


def show(material, mode=0, limit=2.0, osl=True):
    """Show the tension; mode: number in properties.VIEWS, limit: stretch of full colour.

    Where EEVEE has its own output and the tension can be read there, it shows the colours too.
    """
    tree = material.node_tree
    measured = next(
        (
            node
            for node in surface.our_nodes(material, "surface")
            if node.type == "GROUP" and "Tension" in node.inputs and "Tangent" in node.inputs
        ),
        None,
    )
    if measured is None:
        raise source.SourceError(f"{material.name} has no LTMD node: press Set Up LTMD again")
    module = tension_view if osl else tension_view_no_osl
    for needed in (module, tension_view_no_osl):
        nodes.ensure(needed)
    hide(material)
    wires = {
        name: measured.inputs[name].links[0].from_socket
        for name in ("Tension", "Tangent")
        if measured.inputs[name].is_linked
    }
    cycles, eevee = (tree.get_output_node(engine) for engine in ("CYCLES", "EEVEE"))
    _insert(tree, cycles, module, wires, mode, limit)
    if eevee not in (None, cycles):
        readable = _readable(material, wires)
        if readable:
            _insert(tree, eevee, tension_view_no_osl, {"Tension": readable}, mode, limit)
    nodes.remove_unused()


def _readable(material, wires):
    """A socket with the tension for engines without OSL, or None."""
    given = wires["Tension"].node if "Tension" in wires else None
    if given is None or given.type != "GROUP":
        return wires.get("Tension")
    if nodes.without_osl(given.node_tree):
        return wires["Tension"]
    if given.node_tree.get(nodes.GROUP_KEY) == attribute_tension.NAME:
        kept = material.node_tree.nodes.new("ShaderNodeAttribute")
        kept.attribute_name = attribute_tension.ATTRIBUTE
        kept.location = (given.location.x, given.location.y + 200)
        return surface.own(kept, PART, given.parent).outputs["Vector"]
    # An image holds the tension itself; UDIM tiles would have to be put together.
    images = [n for n in surface.our_nodes(material, "source") if n.type == "TEX_IMAGE"]
    return images[0].outputs["Color"] if len(images) == 1 else None


def hide(material):
    """Show the material's own surface again."""
    tree = material.node_tree
    for node in surface.our_nodes(material, PART):
        if node.type == "MIX_SHADER":
            own = node.inputs[1].links[0].from_socket if node.inputs[1].is_linked else None
            for target in [wire.to_socket for wire in node.outputs[0].links]:
                if own is not None:
                    tree.links.new(own, target)
        tree.nodes.remove(node)


def _insert(tree, output, module, wires, mode, limit):
    before = tree.nodes.active
    mix = surface.own(tree.nodes.new("ShaderNodeMixShader"), PART, output.parent)
    mix.inputs[0].default_value = 1.0
    mix.label = "Show Tension"
    mix.location = (output.location.x - 20, output.location.y + 200)
    view = surface.own(nodes.group_node(tree, module), PART, output.parent)
    view.location = (output.location.x - 260, output.location.y + 200)
    view.inputs["Mode"].default_value = mode
    view.inputs["Range"].default_value = limit
    for name, socket in wires.items():
        tree.links.new(socket, view.inputs[name])
    if output.inputs["Surface"].is_linked:
        tree.links.new(output.inputs["Surface"].links[0].from_socket, mix.inputs[1])
    tree.links.new(view.outputs[0], mix.inputs[2])
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    tree.nodes.active = before
