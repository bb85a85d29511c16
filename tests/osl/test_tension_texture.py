# SPDX-License-Identifier: Apache-2.0
"""Texture tension: what is in the file is what the shader gets, tile by tile."""

from blender_process import ROOT, run

PRELUDE = (
    f"""
sys.path.insert(0, {str(ROOT / "tests" / "osl")!r})
from shading import *
import tempfile
folder = tempfile.mkdtemp()
"""
    + """
def picture_node(tree, pixels, name):
    path = os.path.join(folder, name)
    write_image(path, pixels)
    image = bpy.data.images.load(path)
    image.colorspace_settings.is_data = True
    image.alpha_mode = "CHANNEL_PACKED"
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = image
    node.extension = "EXTEND"
    return node

def filled(t):
    pixels = np.ones((4, 4, 4), np.float32)
    pixels[..., :3] = t
    return pixels
"""
)


def test_constant_tension_and_exact_tangent_on_both_faces():
    result = run(
        PRELUDE
        + """
cycles(8, 8)
uv = np.array([(.1, .2), (.8, .3), (.7, .9), (0, .8)])  # an affine map: a parallelogram
uv[2] = uv[1] + uv[3] - uv[0]
A = [[0.5, -0.9], [0.3, 1.1]]
obj = affine_quad(A, uv)
view = camera((0, 0, 3), ortho_scale=0.5)
tree, output = material(obj)
rest = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0)])
moved = np.c_[rest[:, :2] @ np.array(A).T, [0, 0, 0]]
t, tangent = tension_model(rest, moved, uv[:3])
uv_map = tree.nodes.new("ShaderNodeUVMap")
picture = picture_node(tree, filled(t), "t.exr")
tension = group(tree, texture_tension)
live = group(tree, live_tension)
tree.links.new(uv_map.outputs[0], picture.inputs["Vector"])
tree.links.new(uv_map.outputs[0], tension.inputs["UV"])
tree.links.new(uv_map.outputs[0], live.inputs["UV"])
tree.links.new(picture.outputs["Color"], tension.inputs["Image"])
cases = []
for back in (False, True):
    view.location.z = -3 if back else 3
    view.rotation_euler = (np.pi, 0, 0) if back else (0, 0, 0)
    for node in (tension, live):
        for socket, expected in (("Tension", t), ("Tangent", tangent)):
            show(tree, output, node.outputs[socket])
            cases.append([node.name, socket, back, np.abs(render()[..., :3] - expected).max()])
report(cases=cases, t=t)
"""
    )
    assert result["t"][1] < -0.1  # a negative number survives the file and the image node
    for case in result["cases"]:
        assert case[-1] < 1e-5, case


def test_tiles_pick_their_own_image():
    result = run(
        PRELUDE
        + """
cycles(8, 8)
# Three squares in a row, on tiles 1001, 1002 and 1012, and one on a tile without image.
corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
tiles = [(0, 0), (1, 0), (1, 1), (3, 0)]
vertices, faces, uvs = [], [], []
for index, tile in enumerate(tiles):
    faces.append([4 * index + k for k in range(4)])
    vertices += [(2 * index + x, y, 0) for x, y in corners]
    uvs += [(tile[0] + x, tile[1] + y) for x, y in corners]
obj = mesh_object("Row", vertices, faces, uvs)
tree, output = material(obj)
uv_map = tree.nodes.new("ShaderNodeUVMap")
previous = None
values = {1001: (1.5, -.25, .75), 1002: (2, .5, .25), 1012: (.5, 0, 3)}
for number, t in values.items():
    shift = tree.nodes.new("ShaderNodeVectorMath")
    shift.operation = "SUBTRACT"
    shift.inputs[1].default_value = ((number - 1001) % 10, (number - 1001) // 10, 0)
    picture = picture_node(tree, filled(t), f"{number}.exr")
    tension = group(tree, texture_tension)
    tension.inputs["Tile"].default_value = number
    tree.links.new(uv_map.outputs[0], shift.inputs[0])
    tree.links.new(shift.outputs[0], picture.inputs["Vector"])
    tree.links.new(uv_map.outputs[0], tension.inputs["UV"])
    tree.links.new(picture.outputs["Color"], tension.inputs["Image"])
    if previous:
        tree.links.new(previous.outputs["Tension"], tension.inputs["Previous"])
    previous = tension
show(tree, output, previous.outputs["Tension"])
expected = list(values.values()) + [(1, 0, 1)]
errors = []
for index, t in enumerate(expected):
    camera((2 * index + .5, .5, 3), (2 * index + .5, .5, 0), ortho_scale=0.999)
    errors.append(np.abs(render()[..., :3] - t).max())
report(errors=errors)
"""
    )
    assert max(result["errors"]) < 1e-5, result["errors"]


def test_a_broken_pixel_is_the_rest_state():
    result = run(
        PRELUDE
        + """
cycles(4, 4)
obj = mesh_object("Plane", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2, 3)],
                  [(0, 0), (1, 0), (1, 1), (0, 1)])
camera((0, 0, 3), ortho_scale=0.5)
tree, output = material(obj)
tension = group(tree, texture_tension)
show(tree, output, tension.outputs["Tension"])
out = []
for t in ((np.nan, 0, 1), (0, 0, 0), (1, np.inf, 1), (-1, 0, 1)):
    tension.inputs["Image"].default_value = (*t, 1)
    out.append(np.abs(render()[..., :3] - (1, 0, 1)).max())
report(out=out)
"""
    )
    assert max(result["out"]) < 1e-6
