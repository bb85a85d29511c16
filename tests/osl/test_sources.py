# SPDX-License-Identifier: Apache-2.0
"""Every source of tension gives the same numbers, however the surface comes before the camera."""

import numpy as np
from blender_process import ROOT, run

PRELUDE = (
    f"""
sys.path.insert(0, {str(ROOT / "tests" / "osl")!r})
from shading import *
from blender_process import link
from mathutils import Matrix, Vector
from blender_addon import source
from blender_addon.nodes import attribute_tension, tensor_tension
"""
    + """
GROUPS = {"LIVE": live_tension, "ATTRIBUTE": attribute_tension, "TENSOR": tensor_tension}
cycles(64, 16)
# Four parallelograms in a row, apart in space and in UV, every second one with mirrored UVs.
CORNERS = np.array([(-1, -.8), (.9, -1), (1, .8), (-.9, 1)])
ISLAND = np.array([(.03, .03), (.21, .06), (.22, .2), (.04, .17)])
CENTRES = np.array([(3. * k, 0, 0) for k in range(4)])
# Rest to deformed, in space: stretched, squeezed, sheared and tilted.
MAPS = [np.array(m, float) for m in (
    [[1.2, .3, 0], [.1, .7, 0], [.2, .3, 1]], [[.6, -.4, 0], [.2, 1.1, 0], [0, -.2, 1]],
    [[.8, .1, 0], [-.5, .9, 0], [.4, 0, 1]], [[1.1, 0, 0], [.6, .5, 0], [-.3, .1, 1]])]
REST = np.array([(*c, 0) for c in CORNERS])
UVS = [ISLAND * (1 if k % 2 else -1, 1) + (.25 * k + (0 if k % 2 else .25), .3 * (k % 3))
       for k in range(4)]

def row():
    faces = np.arange(16).reshape(4, 4)
    rest = np.concatenate([REST + c for c in CENTRES])
    moved = np.concatenate([REST @ m.T + c for m, c in zip(MAPS, CENTRES)])
    obj = mesh_object("Row", rest, faces, np.concatenate(UVS))
    deform(obj, moved)
    return obj

def expected(matrix, k):
    world = np.array(matrix)[:3, :3]
    return tension_model(REST[:3] @ world.T, REST[:3] @ MAPS[k].T @ world.T, UVS[k][:3])

def look(matrix=Matrix(), back=False):
    # One picture of the row, straight on; the x axis of the row along the picture.
    matrix = Matrix(matrix)
    for old in [o for o in bpy.data.objects if o.type == "CAMERA"]:
        bpy.data.objects.remove(old)
    ends = [matrix @ Vector(c) for c in (CENTRES[0], CENTRES[3])]
    along = (ends[1] - ends[0]).normalized()
    normal = (along.cross(matrix.to_3x3() @ Vector((0, 1, 0)))).normalized()
    side = -normal if back else normal
    middle = (ends[0] + ends[1]) / 2
    view = camera(middle + 10 * side, middle, ortho_scale=(ends[1] - ends[0]).length * 4 / 3)
    up = side.cross(along)
    view.matrix_world = Matrix.Translation(middle + 10 * side) @ Matrix(
        (along, up, side)).transposed().to_4x4()

def at_faces(pixels):
    # Two by two pixels about the centre of each face; the picture is 4 faces wide.
    return np.array([pixels[7:9, 7 + 16 * k:9 + 16 * k, :3] for k in range(4)])

def errors(node, tree, output, matrix):
    worst = {}
    for socket, place in (("Tension", 0), ("Tangent", 1)):
        show(tree, output, node.outputs[socket])
        got = at_faces(render())
        want = np.array([expected(matrix, k)[place] for k in range(4)])[:, None, None]
        worst[socket] = np.abs(got - want).max()
    return worst

def node_of(kind, tree):
    node = group(tree, GROUPS[kind])
    uv_map = tree.nodes.new("ShaderNodeUVMap")
    tree.links.new(uv_map.outputs[0], node.inputs["UV"])
    return node
"""
)


def check(cases):
    assert cases
    for case in cases:
        *name, worst = case
        assert worst["Tension"] < 1e-4, (name, worst)
        assert worst["Tangent"] < 1e-4, (name, worst)


def test_all_sources_are_the_analytic_tension_on_any_side_of_any_object(tmp_path):
    result = run(
        PRELUDE
        + """
cases = []
obj = row()
tree, output = material(obj)
sources = {kind: node_of(kind, tree) for kind in GROUPS}
for label, matrix in (
    ("plain", Matrix()),
    ("stretched", Matrix.Rotation(.4, 4, "Z") @ Matrix.Diagonal((1.8, .6, 1.3, 1))),
    ("mirrored", Matrix.Diagonal((-1.5, .7, 1, 1))),
):
    obj.matrix_world = matrix
    bpy.context.view_layer.update()
    for kind, node in sources.items():
        source.measure(obj, kind)
        for back in (False, True):
            look(matrix, back)
            cases.append((label, kind, back, errors(node, tree, output, matrix)))

# The same from baked images.
obj.matrix_world = Matrix()
bpy.ops.wm.save_as_mainfile(filepath=ARGUMENTS["folder"] + "/scene.blend")
bpy.ops.ltmd.setup(object_name="Row")
bpy.ops.ltmd.bake(frames="1", size=256, directory=ARGUMENTS["folder"])
assert obj.ltmd.source == "TEXTURE"
tree = obj.material_slots[0].material.node_tree
node = next(n for n in tree.nodes if n.type == "GROUP" and n.node_tree.name == texture_tension.NAME)
output = tree.get_output_node("CYCLES")
for back in (False, True):
    look(back=back)
    cases.append(("plain", "TEXTURE", back, errors(node, tree, output, Matrix())))
report(cases=cases)
""",
        arguments={"folder": str(tmp_path)},
    )
    assert len(result["cases"]) == 3 * 3 * 2 + 2
    check(result["cases"])


def test_instances_and_mirrors_show_the_same_numbers():
    result = run(
        PRELUDE
        + """
cases = []
scene = bpy.context.scene
obj = row()
tree, output = material(obj)
sources = {kind: node_of(kind, tree) for kind in GROUPS}
obj.matrix_world = Matrix.Rotation(.4, 4, "Z") @ Matrix.Diagonal((1.8, .6, 1.3, 1))
bpy.context.view_layer.update()

collection = bpy.data.collections.new("Rows")
collection.objects.link(obj)
scene.collection.objects.unlink(obj)
holder = bpy.data.objects.new("Instance", None)
holder.instance_type, holder.instance_collection = "COLLECTION", collection

duplicate = obj.copy()  # its mesh is the same, its modifiers are its own

tree_of_nodes = bpy.data.node_groups.new("Instance", "GeometryNodeTree")
tree_of_nodes.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
info = tree_of_nodes.nodes.new("GeometryNodeObjectInfo")
info.inputs["Object"].default_value = obj
info.inputs["As Instance"].default_value = True
place = tree_of_nodes.nodes.new("GeometryNodeTransform")
place.inputs["Scale"].default_value = (1.8, .6, 1.3)
tree_of_nodes.links.new(info.outputs["Geometry"], place.inputs[0])
tree_of_nodes.links.new(place.outputs[0], tree_of_nodes.nodes.new("NodeGroupOutput").inputs[0])
nodes_holder = bpy.data.objects.new("Nodes", bpy.data.meshes.new("Empty"))
nodes_holder.modifiers.new("Instance", "NODES").node_group = tree_of_nodes

mirror = Matrix.Rotation(.3, 4, "Z") @ Matrix.Diagonal((1, -1, 1, 1))
for kind, node in sources.items():
    source.measure(obj, kind)
    for label, moved in (("turned", Matrix.Rotation(.8, 4, (1, 1, 0)) @ Matrix.Scale(1.7, 4)),
                         ("mirrored", mirror)):
        scene.collection.objects.link(holder)
        holder.matrix_world = moved
        bpy.context.view_layer.update()
        look(moved @ obj.matrix_world)
        cases.append(("collection " + label, kind, errors(node, tree, output,
                                                         moved @ obj.matrix_world)))
        scene.collection.objects.unlink(holder)
    # The attribute belongs to the shape of the object's scale: this one has the same.
    scene.collection.objects.link(nodes_holder)
    nodes_holder.matrix_world = moved = Matrix.Rotation(.5, 4, "X")
    bpy.context.view_layer.update()
    look(moved @ Matrix.Diagonal((1.8, .6, 1.3, 1)))
    cases.append(("Geometry Nodes", kind, errors(node, tree, output,
                                                 moved @ Matrix.Diagonal((1.8, .6, 1.3, 1)))))
    scene.collection.objects.unlink(nodes_holder)

# A linked duplicate of other proportions measures for itself.
scene.collection.objects.link(duplicate)
duplicate.matrix_world = Matrix.Diagonal((.7, 1.6, 1, 1))
bpy.context.view_layer.update()
look(duplicate.matrix_world)
for kind, node in sources.items():
    source.measure(duplicate, kind)
    cases.append(("duplicate", kind, errors(node, tree, output, duplicate.matrix_world)))

# In a mirror above the row, which turns a level view down.
look(duplicate.matrix_world)
x, y, _ = scene.camera.matrix_world.translation
level = Matrix.Rotation(np.pi / 2, 4, "X")
scene.camera.matrix_world = Matrix.Translation((x, y - 30, 10)) @ level
for kind, node in sources.items():
    source.measure(duplicate, kind)
    glass = mesh_object("Mirror", [(-20, -20, 0), (20, -20, 0), (20, 20, 0), (-20, 20, 0)],
                        [(0, 1, 2, 3)])
    shine, surface_output = material(glass)
    mirror = shine.nodes.new("ShaderNodeBsdfAnisotropic")
    mirror.inputs["Color"].default_value = (1, 1, 1, 1)
    mirror.inputs["Roughness"].default_value = 0
    shine.links.new(mirror.outputs[0], surface_output.inputs["Surface"])
    glass.rotation_euler = (-np.pi / 4, 0, 0)
    glass.location = (x, y, 10)
    cases.append(("mirror", kind, errors(node, tree, output, duplicate.matrix_world)))
    bpy.data.objects.remove(glass)
report(cases=cases)
"""
    )
    assert len(result["cases"]) == 3 * (2 + 1 + 1 + 1)
    check(result["cases"])


def test_motion_blur_live_follows_the_shutter_and_attributes_do_not():
    """t11 runs from 1 to 2 while the shutter is open: the mean of its square tells them apart."""
    result = run(
        PRELUDE
        + """
scene = cycles(8, 8, samples=256)
scene.render.use_motion_blur = True
scene.render.motion_blur_shutter = 1.0
obj = affine_quad([[3, 0], [0, 1]], rest_attribute=False)
shape = obj.data.shape_keys.key_blocks[1]
for frame, value in ((1, 0.0), (3, 0.5)):  # t11 = 1 + 2 value: 1 at frame 1, 2 at frame 3
    shape.value = value
    shape.keyframe_insert("value", frame=frame)
action = obj.data.shape_keys.animation_data.action
curves = (action.fcurves if hasattr(action, "fcurves")
          else action.layers[0].strips[0].channelbags[0].fcurves)
for point in curves[0].keyframe_points:
    point.interpolation = "LINEAR"
scene.frame_set(2)
camera((0, 0, 3), ortho_scale=0.1)
tree, output = material(obj)
out = {}
for kind in GROUPS:
    source.measure(obj, kind)
    scene.render.motion_blur_shutter = 2.0
    node = node_of(kind, tree)
    square = tree.nodes.new("ShaderNodeVectorMath")
    square.operation = "MULTIPLY"
    for socket in square.inputs[:2]:
        tree.links.new(node.outputs["Tension"], socket)
    show(tree, output, square.outputs[0])
    out[kind] = render(frame=2)[..., :3].mean(axis=(0, 1))
report(**out)
"""
    )
    # Cycles stratifies time and its shutter table is .002 early: 1e-2 of the mean is far from both.
    assert abs(result["LIVE"][0] - (1.5**2 + 1 / 12)) < 0.02, result["LIVE"]
    for kind in ("ATTRIBUTE", "TENSOR"):
        assert abs(result[kind][0] - 1.5**2) < 1e-4, result[kind]


def test_subdivision_before_and_after_the_deformer_and_adaptive():
    """A plane under an affine map: however it is cut, the tension is the same everywhere."""
    result = run(
        PRELUDE
        + """
import bmesh
cycles(16, 16)
A = np.array([[1.6, .5], [.2, .7]])
out = {}
def plane(name, deformer):
    bm = bmesh.new()
    bmesh.ops.create_grid(bm, x_segments=4, y_segments=4, size=1)
    mesh = bpy.data.meshes.new(name)
    bm.to_mesh(mesh)
    co = np.array([v.co for v in mesh.vertices])
    corner = np.array([loop.vertex_index for loop in mesh.loops])
    layer = mesh.uv_layers.new(name="UVMap")
    layer.uv.foreach_set("vector", (co[corner, :2] / 2 + .5).astype(np.float32).ravel())
    obj = link(bpy.data.objects.new(name, mesh))
    if deformer == "keys":
        deform(obj, np.c_[co[:, :2] @ A.T, co[:, 2]])
    return obj

def lattice(obj):
    # Linear in between: exactly the affine map.
    data = bpy.data.lattices.new("Lattice")
    data.interpolation_type_u = data.interpolation_type_v = data.interpolation_type_w = "KEY_LINEAR"
    cage = bpy.data.objects.new("Lattice", data)
    bpy.context.scene.collection.objects.link(cage)
    cage.scale = (4, 4, 4)
    for point in data.points:
        x, y, z = point.co
        point.co_deform = (*(A @ (x, y)), z)
    modifier = obj.modifiers.new("Lattice", "LATTICE")
    modifier.object = cage

def subdivide(obj):
    modifier = obj.modifiers.new("Subdivision", "SUBSURF")
    modifier.levels = modifier.render_levels = 1
    modifier.subdivision_type = "SIMPLE"
    return modifier

def measure(name, obj, kinds=GROUPS, want=A):
    camera((0, 0, 3), ortho_scale=0.5)
    tree, output = material(obj)
    t, tangent = tension_model([(0, 0, 0), (1, 0, 0), (0, 1, 0)],
                               [(0, 0, 0), (*A[:, 0], 0), (*A[:, 1], 0)], [(0, 0), (1, 0), (0, 1)])
    for kind in kinds:
        told = source.measure(obj, kind)
        node = node_of(kind, tree)
        show(tree, output, node.outputs["Tension"])
        out[f"{name} {kind}"] = [np.abs(render()[..., :3] - t).max(), told]
    bpy.data.objects.remove(obj)

obj = plane("Before", None)
subdivide(obj)
lattice(obj)
measure("before", obj)
obj = plane("After", None)
lattice(obj)
subdivide(obj)
measure("after", obj)
obj = plane("Keys", "keys")
subdivide(obj)
measure("keys", obj)

# Rest states that Generated coordinates do not have: another object, and a frame.
obj = plane("Other", "keys")
subdivide(obj)
shape = plane("Shape", None)
shape.hide_render = True
obj.ltmd.rest_mode, obj.ltmd.rest_object = "OBJECT", shape
measure("other object", obj)
obj = plane("Frame", "keys")
key = obj.data.shape_keys.key_blocks[1]
for frame, value in ((1, 1.0), (5, 0.0)):
    key.value = value
    key.keyframe_insert("value", frame=frame)
subdivide(obj)
obj.ltmd.rest_mode, obj.ltmd.rest_frame = "FRAME", 5
bpy.context.scene.frame_set(1)
measure("frame", obj)

obj = plane("Adaptive", "keys")
last = subdivide(obj)
if hasattr(bpy.context.scene.cycles, "feature_set"):
    bpy.context.scene.cycles.feature_set = "EXPERIMENTAL"
if hasattr(last, "use_adaptive_subdivision"):
    last.use_adaptive_subdivision = True
else:
    obj.cycles.use_adaptive_subdivision = True
measure("adaptive", obj)

# Geometry Nodes that deform, behind a subdivision: Generated coordinates move with them.
obj = plane("Nodes", None)
subdivide(obj)
tree = bpy.data.node_groups.new("Bend", "GeometryNodeTree")
for way in ("INPUT", "OUTPUT"):
    tree.interface.new_socket("Geometry", in_out=way, socket_type="NodeSocketGeometry")
start, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
move = tree.nodes.new("GeometryNodeSetPosition")
position = tree.nodes.new("GeometryNodeInputPosition")
rows = tree.nodes.new("ShaderNodeCombineXYZ")
for k in range(2):
    product = tree.nodes.new("ShaderNodeVectorMath")
    product.operation = "DOT_PRODUCT"
    product.inputs[1].default_value = (*A[k], 0)
    tree.links.new(position.outputs[0], product.inputs[0])
    tree.links.new(product.outputs["Value"], rows.inputs[k])
tree.links.new(start.outputs[0], move.inputs["Geometry"])
tree.links.new(rows.outputs[0], move.inputs["Position"])
tree.links.new(move.outputs[0], end.inputs[0])
obj.modifiers.new("Bend", "NODES").node_group = tree
measure("Geometry Nodes", obj)
report(**out)
"""
    )
    names = ("before", "after", "keys", "other object", "frame", "adaptive", "Geometry Nodes")
    for name in names:
        for kind in ("LIVE", "ATTRIBUTE", "TENSOR"):
            error, told = result[f"{name} {kind}"]
            assert error < 1e-4, (name, kind, error, told)
    for kind in ("ATTRIBUTE", "TENSOR"):
        assert "adaptive" in str(result[f"adaptive {kind}"][1])


def test_missing_attributes_flat_triangles_and_shared_materials():
    result = run(
        PRELUDE
        + """
out = {}
cycles(16, 16)
A, B = [[1.6, .5], [.2, .7]], [[.6, -.3], [.4, 1.2]]
view = camera((0, 0, 3), ortho_scale=0.5)
obj = affine_quad(A)
tree, output = material(obj)
# No attribute of that name: the rest state.
for kind in ("ATTRIBUTE", "TENSOR"):
    show(tree, output, node_of(kind, tree).outputs["Tension"])
    out["missing " + kind] = render()[..., :3]
# A lit lobe over a surface whose triangles have no area at rest, then none when deformed.
world = bpy.data.worlds.new("World")
world.use_nodes = True
world.node_tree.nodes["Background"].inputs[0].default_value = (1, 1, 1, 1)
bpy.context.scene.world = world
lobe_node = group(tree, glossy)
tree.links.new(lobe_node.outputs["BSDF"], output.inputs["Surface"])
flat = np.array([(-1, -1, 0), (1, 1, 0), (1, 1, 0), (-1, -1, 0)], float)
basis, moved = (key.data for key in obj.data.shape_keys.key_blocks)
quad = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], float)
for label, rest, deformed in (("no area at rest", flat, quad),
                              ("nearly flat", quad, quad * (1, 1e-6, 1))):
    basis.foreach_set("co", rest.ravel().astype(np.float32))
    obj.data.vertices.foreach_set("co", rest.ravel().astype(np.float32))
    moved.foreach_set("co", deformed.ravel().astype(np.float32))
    obj.data.update()
    for kind in GROUPS:
        source.measure(obj, kind)
        node = node_of(kind, tree)
        for name in ("Tension", "Tangent"):
            tree.links.new(node.outputs[name], lobe_node.inputs[name])
        view.data.ortho_scale = .5 if label == "no area at rest" else 1e-6
        picture = render()[..., :3]
        out[f"{label} {kind}"] = [bool(np.isfinite(picture).all()), picture.mean()]
bpy.data.objects.remove(obj)

# One material on two deforming objects, each measured for itself.
first, second = affine_quad(A, rest_attribute=False), affine_quad(B, rest_attribute=False)
second.location.x = 6
tree, output = material(first)
second.data.materials.append(first.data.materials[0])
for kind in GROUPS:
    show(tree, output, node_of(kind, tree).outputs["Tension"])
    for which in (first, second):
        source.measure(which, kind)
    for label, x in (("first", 0), ("second", 6)):
        view.location.x = x
        view.data.ortho_scale = .5
        out[f"{label} {kind}"] = render()[8, 8, :3]
for label, matrix in (("first", A), ("second", B)):
    corners = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0)], float)
    moved = np.c_[corners[:, :2] @ np.array(matrix).T, [0, 0, 0]]
    out[label] = tension_model(corners, moved, [(0, 0), (1, 0), (1, 1)])[0]
report(**out)
"""
    )
    for kind in ("ATTRIBUTE", "TENSOR"):
        assert np.allclose(result["missing " + kind], (1, 0, 1), atol=1e-6), kind
    for label in ("no area at rest", "nearly flat"):
        for kind in ("LIVE", "ATTRIBUTE", "TENSOR"):
            finite, mean = result[f"{label} {kind}"]
            # A white world: 0.7 at rest; a squeeze to 1/1000 makes it rough and dark, not black.
            assert finite and mean > (0.3 if label == "no area at rest" else 0.01), (label, kind)
    for label in ("first", "second"):
        for kind in ("LIVE", "ATTRIBUTE", "TENSOR"):
            assert np.allclose(result[f"{label} {kind}"], result[label], atol=1e-4), (label, kind)
