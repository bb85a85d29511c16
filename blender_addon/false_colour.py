# SPDX-License-Identifier: GPL-3.0-or-later
"""The deformation in false colour instead of the material's surface, and back.

The material's own surface stays linked, as the unused side of a Mix Shader before each output, so
the graph itself records what hiding restores.
"""

from . import nodes, source, surface, versions
from .nodes import tension_view, tension_view_no_osl

# Values of surface.KEY.
PART = "view"
EEVEE = surface.EEVEE
_KEPT = ("Mode", "Range", "Density", "Shading")


def _nodes(material):
    return surface.our_nodes(material, PART) + surface.our_nodes(material, EEVEE)


def views(material):
    """The nodes with the false colours."""
    kinds = (tension_view.NAME, tension_view_no_osl.NAME)
    return [
        node
        for node in _nodes(material)
        if node.type == "GROUP" and node.node_tree and node.node_tree.get(nodes.GROUP_KEY) in kinds
    ]


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
    measured = next((n for n in surface.takers(material) if n[surface.KEY] == "surface"), None)
    if measured is None:
        raise source.SourceError(f"{material.name} has no LTMD node: press Set Up LTMD again")
    if tree.get_output_node("CYCLES") is None:
        raise source.SourceError(f"{material.name} has no Material Output: add one")
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
    _insert(tree, cycles, module, PART, wires, mode, limit)
    if eevee not in (None, cycles) and "Tension" in wires:
        readable = _without_osl(material, wires["Tension"].node)
        if readable:
            wires = {"Tension": readable.outputs["Tension"]}
            _insert(tree, eevee, tension_view_no_osl, EEVEE, wires, mode, limit)
    nodes.remove_unused()


def refresh(material, osl):
    """Show the same of a tension that has another source, or on another device."""
    shown = views(material)
    if shown:
        values = {name: shown[0].inputs[name].default_value for name in _KEPT}
        show(material, osl=osl)
        for view in views(material):
            for name, value in values.items():
                view.inputs[name].default_value = value


def _without_osl(material, given):
    """A node that reads the source's tension without OSL, or None."""
    name = given.node_tree.get(nodes.GROUP_KEY, "") if given.type == "GROUP" else ""
    if name.endswith(" (no OSL)"):
        return given
    module = versions.modules().get(f"{name} (no OSL)")
    if module is None:
        return None
    tree = material.node_tree
    twin = surface.own(nodes.group_node(tree, module), EEVEE, given.parent)
    twin.location = (given.location.x, given.location.y + 200)
    for socket in given.inputs:
        if not socket.is_linked:
            twin.inputs[socket.name].default_value = socket.default_value
            continue
        feeding = socket.links[0].from_socket
        if socket.name == "Previous":  # of a chain of UDIM tiles
            feeding = _without_osl(material, feeding.node).outputs[feeding.name]
        tree.links.new(feeding, twin.inputs[socket.name])
    return twin


def hide(material):
    """Show the material's own surface again."""
    tree = material.node_tree
    for node in _nodes(material):
        if node.type == "MIX_SHADER":
            own = node.inputs[1].links[0].from_socket if node.inputs[1].is_linked else None
            for target in [wire.to_socket for wire in node.outputs[0].links]:
                if own is not None:
                    tree.links.new(own, target)
        tree.nodes.remove(node)


def _insert(tree, output, module, part, wires, mode, limit):
    before = tree.nodes.active
    mix = surface.own(tree.nodes.new("ShaderNodeMixShader"), part, output.parent)
    mix.inputs[0].default_value = 1.0
    mix.label = "Show Tension"
    mix.location = (output.location.x - 20, output.location.y + 200)
    view = surface.own(nodes.group_node(tree, module), part, output.parent)
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
