# SPDX-License-Identifier: Apache-2.0
"""The modifiers LTMD Tension, Tensor and Rest Position against the library, and their removal."""

import numpy as np
from blender_process import run

SCENE = """
import ltmd
import bmesh
from mathutils import Matrix
from blender_addon import modifier, source

def read(mesh, name, count, width=3):
    values = np.empty((count, width), np.float32)
    data = mesh.attributes[name].data
    data.foreach_get("value" if width == 1 else "vector", values.ravel())
    return values

def sphere(name, subdivisions=3):
    # Longitude and latitude: a seam, and poles whose corners have each their own UV.
    bm = bmesh.new()
    bmesh.ops.create_icosphere(bm, subdivisions=subdivisions, radius=1)
    mesh = bpy.data.meshes.new(name)
    bm.to_mesh(mesh)
    co = read(mesh, "position", len(mesh.vertices)).astype(float)
    uv = np.empty((len(mesh.loops), 2))
    for face in mesh.polygons:
        corner = co[list(face.vertices)]
        u = np.arctan2(corner[:, 1], corner[:, 0]) / (2 * np.pi)
        pole = np.hypot(corner[:, 0], corner[:, 1]) < 1e-6
        u = np.where((np.ptp(u[~pole]) > .5) & (u < 0), u + 1, u)
        u[pole] = u[~pole].mean()
        uv[list(face.loop_indices)] = np.c_[u, np.arcsin(np.clip(corner[:, 2], -1, 1)) / np.pi]
    mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", uv.astype(np.float32).ravel())
    obj = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(obj)
    return obj

def bend(co):
    waves = .05 * np.sin(3 * co[:, [1, 2, 0]])
    return co @ np.array([[1.4, .3, 0], [-.2, .8, .1], [.1, 0, 1.1]]).T + waves

def key(obj, positions):
    if not obj.data.shape_keys:
        obj.shape_key_add(name="Basis")
    shape = obj.shape_key_add(name="Deformed")
    shape.data.foreach_set("co", positions.astype(np.float32).ravel())
    shape.value = 1

def evaluated(obj):
    return obj.evaluated_get(bpy.context.evaluated_depsgraph_get()).data

def library(obj, rest, deformed, mesh):
    # Both states in the metric of the rendered object.
    matrix = np.array(obj.matrix_world)[:3, :3]
    mesh.calc_loop_triangles()
    triangles = np.array([t.loops for t in mesh.loop_triangles], np.int32)
    corner_vert = np.array([loop.vertex_index for loop in mesh.loops], np.int32)
    uv = np.empty((len(corner_vert), 2), np.float32)
    mesh.uv_layers[0].uv.foreach_get("vector", uv.ravel())
    made = ltmd.Mesh(triangles, corner_vert, uv, len(mesh.vertices))
    rest = ltmd.RestState(made, (rest @ matrix.T).astype(np.float32))
    deformed = (deformed @ matrix.T).astype(np.float32)
    return (ltmd.tension(made, rest, deformed, per="corner"),
            ltmd.deformation_tensor(made, rest, deformed))

def symmetric(b):
    return np.moveaxis(np.array([[b[:, 0], b[:, 3], b[:, 4]], [b[:, 3], b[:, 1], b[:, 5]],
                                 [b[:, 4], b[:, 5], b[:, 2]]]), -1, 0)

def attributes(obj):
    # The attributes that the modifiers leave on the evaluated mesh.
    values = {}
    for kind in ("ATTRIBUTE", "TENSOR"):
        source.measure(obj, kind)
        mesh = evaluated(obj)
        if kind == "ATTRIBUTE":
            values["tension"] = read(mesh, "ltmd_tension", len(mesh.loops))
        else:
            values["tensor"] = np.c_[read(mesh, "ltmd_tensor_diagonal", len(mesh.vertices)),
                                     read(mesh, "ltmd_tensor_off_diagonal", len(mesh.vertices))]
    return values
"""


def test_values_are_the_librarys():
    result = run(
        SCENE
        + """
out = {}
for name, matrix in (
    ("plain", Matrix()),
    ("turned", Matrix.Translation((5, 1, 2)) @ Matrix.Rotation(.7, 4, (1, 2, 3)) * 1.5),
    ("stretched", Matrix.Rotation(.7, 4, (1, 2, 3)) @ Matrix.Diagonal((2, .6, 1.2, 1))),
    ("mirrored", Matrix.Diagonal((-1.5, .7, 1, 1))),
):
    obj = sphere(name)
    obj.matrix_world = matrix
    co = read(obj.data, "position", len(obj.data.vertices))
    moved = bend(co)
    key(obj, moved)
    bpy.context.view_layer.update()
    got = attributes(obj)
    tension, tensor = library(obj, co, moved, obj.data)
    scale = np.array(matrix)[:3, :3]
    scale = scale / abs(np.linalg.det(scale)) ** (1 / 3)
    tensor = symmetric(tensor)
    world = scale @ symmetric(got["tensor"]) @ scale.T
    # Seen on the surface: in the plane of the vertex's normal, which has the eigenvalue 0.
    values, vectors = np.linalg.eigh(tensor)
    plane = vectors[:, :, 1:]
    seen = plane.transpose(0, 2, 1) @ (world - tensor) @ plane
    out[name] = dict(tension=np.abs(got["tension"] - tension).max(),
                     tensor=np.abs(world - tensor).max(), seen=np.abs(seen).max(),
                     largest=np.abs(tensor).max(),
                     limits=[modifier.limits(obj)])
report(**out)
"""
    )
    for name in ("plain", "turned", "stretched", "mirrored"):
        case = result[name]
        print(name, case)
        # float32 sums over up to 8 corners.
        assert case["tension"] < 5e-6, (name, case)
        assert case["limits"] == [None], case
        if name in ("plain", "turned"):
            assert case["tensor"] < 1e-5 * case["largest"], (name, case)
        # Vertex normals are those of the picture: weighted by angle before the scale, the library's
        # after it. Their tilt, about 4 degrees here, enters squared.
        assert case["seen"] < 0.02 * case["largest"], (name, case)


def test_quads_degenerate_faces_and_subdivision():
    result = run(
        SCENE
        + """
out = {}
# A quad whose corners are three triangles of one tension, and faces without area or UV area.
co = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (2, 0, 0), (3, 0, 0), (2, 1, 0)], float)
mesh = bpy.data.meshes.new("Faces")
mesh.from_pydata(co.tolist(), [], [(0, 1, 2, 3), (1, 4, 5), (4, 6, 2)])
uv = np.array([(0, 0), (1, 0), (1, 1), (0, 1), (.1, .1), (.2, .1), (.3, .1), *[(0, 0)] * 3],
              np.float32)
mesh.uv_layers.new(name="UVMap").uv.foreach_set("vector", uv.ravel())
obj = bpy.data.objects.new("Faces", mesh)
bpy.context.scene.collection.objects.link(obj)
key(obj, co * (2, .5, 1))
got = attributes(obj)
out["quad"], out["degenerate"] = got["tension"][:4], got["tension"][4:]
out["tensor"] = got["tensor"]

# Behind a subdivision the rest state is subdivided too; in the viewport at its level.
obj = sphere("Smooth", 1)
co = read(obj.data, "position", len(obj.data.vertices))
key(obj, bend(co))
obj.modifiers.new("Subdivision", "SUBSURF").levels = 1
obj.ltmd.source = "NONE"
got = attributes(obj)
plain = {}
for name, value in (("rest", 0), ("deformed", 1)):
    obj.data.shape_keys.key_blocks[1].value = value
    bpy.context.view_layer.update()
    final = evaluated(obj)
    plain[name] = read(final, "position", len(final.vertices))
final = bpy.data.meshes.new_from_object(
    obj.evaluated_get(bpy.context.evaluated_depsgraph_get()))
tension, tensor = library(obj, plain["rest"], plain["deformed"], final)
out["smooth"] = np.abs(got["tension"] - tension).max(axis=1)
out["count"] = len(obj.data.loops)
report(**out)
"""
    )
    assert np.allclose(result["quad"], (2, 0, 0.5), atol=1e-6)
    assert np.allclose(result["degenerate"], (1, 0, 1), atol=0)
    tensor = np.array(result["tensor"])
    assert np.isfinite(tensor).all()
    assert np.allclose(tensor[0], (4, 0.25, 0, 0, 0, 0), atol=1e-5)
    smooth = np.array(result["smooth"])
    assert len(smooth) > 3 * result["count"]
    # Quads are measured by the triangle at each corner, by the library as they are cut.
    assert np.median(smooth) < 0.01 and smooth.max() < 0.25, (np.median(smooth), smooth.max())


def test_set_up_and_remove_leave_nothing_behind(tmp_path):
    result = run(
        SCENE
        + """
def everything():
    return {name: sorted(x.name for x in getattr(bpy.data, name))
            for name in ("objects", "meshes", "node_groups", "materials")}
obj = sphere("Ball", 1)
material = bpy.data.materials.new("Rubber")
material.use_nodes = True
obj.data.materials.append(material)
co = read(obj.data, "position", len(obj.data.vertices))
key(obj, bend(co))
before = everything(), sorted(obj.data.attributes.keys())
out = {}
for kind in ("LIVE", "TENSOR", "ATTRIBUTE"):
    bpy.ops.ltmd.setup(object_name="Ball", source=kind)
    out[kind] = [obj.ltmd.source, [m.name for m in obj.modifiers],
                 sorted(obj.data.attributes.keys()),
                 sorted(n.node_tree.name for n in material.node_tree.nodes
                        if n.type == "GROUP" and n.get("ltmd") == "source")]
# A second object with another source gets its own material; the first keeps its own.
other = obj.copy()
other.data = obj.data.copy()
other.modifiers.clear()
other.ltmd.source = "NONE"
bpy.context.scene.collection.objects.link(other)
other.name = "Other"
bpy.ops.ltmd.setup(object_name="Other", source="TENSOR")
out["shared"] = [obj.material_slots[0].material == other.material_slots[0].material,
                 obj.ltmd.source, other.ltmd.source]
# Switched together, two objects keep one material; a twin of a live one leaves it its rest state.
pair = []
for name in ("One", "Two"):
    twin = sphere(name, 1)
    twin.data.materials.append(bpy.data.materials.get("Pair") or bpy.data.materials.new("Pair"))
    key(twin, bend(co))
    pair.append(twin)
bpy.data.materials["Pair"].use_nodes = True
for o in bpy.context.scene.objects:
    o.select_set(o in pair)
bpy.context.view_layer.objects.active = pair[0]
bpy.ops.ltmd.setup()
bpy.ops.ltmd.setup(source="ATTRIBUTE")
out["together"] = [[o.ltmd.source, o.material_slots[0].material.name] for o in pair]
linked = pair[0].copy()
bpy.context.scene.collection.objects.link(linked)
linked.name = "Linked"
bpy.ops.ltmd.setup(object_name="One", source="LIVE")
bpy.ops.ltmd.setup(object_name="Linked", source="TENSOR")
out["twin"] = "ltmd_rest" in pair[0].data.attributes
for o in (*pair, linked):
    bpy.ops.ltmd.remove(object_name=o.name)
for o in (linked, *pair):
    mesh = o.data
    bpy.data.objects.remove(o)
    if not mesh.users:
        bpy.data.meshes.remove(mesh)
# Saved and opened again, at another pose, the modifier still measures.
path = ARGUMENTS["path"]
bpy.ops.wm.save_as_mainfile(filepath=path)
bpy.ops.wm.open_mainfile(filepath=path)
obj = bpy.data.objects["Ball"]
values = []
for value in (0, 1):
    obj.data.shape_keys.key_blocks[1].value = value
    bpy.context.view_layer.update()
    mesh = evaluated(obj)
    values.append(read(mesh, "ltmd_tension", len(mesh.loops)))
out["rest"] = np.abs(values[0] - (1, 0, 1)).max()
out["moved"] = np.abs(values[1] - (1, 0, 1)).max()
# One frame kept in the mesh: the same values, at every frame, until it is set up again.
bpy.ops.ltmd.store_tension(object_name="Ball")
kept = read(obj.data, "ltmd_tension", len(obj.data.loops))
out["stored"] = [np.abs(kept - values[1]).max(), len(obj.modifiers), source.modifier_limits(obj)]
bpy.ops.ltmd.setup(object_name="Ball")
out["measured again"] = ["ltmd_tension" in obj.data.attributes, len(obj.modifiers)]
# Another topology: shown at rest, and said.
obj.modifiers.new("Cut", "TRIANGULATE")
obj.modifiers.new("More", "SUBSURF").levels = 1
obj.modifiers.move(len(obj.modifiers) - 1, 0)
bpy.context.view_layer.update()
out["changed"] = ["ltmd_tension" in evaluated(obj).attributes, source.modifier_limits(obj)]
obj.modifiers.remove(obj.modifiers["More"])
bpy.context.view_layer.update()
out["not last"] = source.modifier_limits(obj)
obj.modifiers.remove(obj.modifiers["Cut"])
bpy.ops.ltmd.remove(object_name="Other")
bpy.data.meshes.remove(bpy.data.objects["Other"].data)
bpy.ops.ltmd.remove(object_name="Ball")
for m in list(bpy.data.materials):
    if not m.users:
        bpy.data.materials.remove(m)
after = everything(), sorted(obj.data.attributes.keys())
report(before=before, after=after, **out)
""",
        arguments={"path": str(tmp_path / "scene.blend")},
    )
    assert result["before"] == result["after"]
    assert result["LIVE"][1] == [] and "ltmd_rest" in result["LIVE"][2]
    for kind, name in (("TENSOR", "LTMD Tensor"), ("ATTRIBUTE", "LTMD Tension")):
        source, modifiers, attributes, groups = result[kind]
        assert (source, modifiers, groups) == (kind, [name], [f"LTMD {kind.title()} Tension"])
        assert not [a for a in attributes if a.startswith("ltmd")]
    assert result["shared"] == [False, "ATTRIBUTE", "TENSOR"]
    assert result["together"] == [["ATTRIBUTE", "Pair"]] * 2
    assert result["twin"] is True
    assert result["rest"] < 1e-6 and result["moved"] > 0.2
    assert result["stored"][:2] == [0, 0] and "frame 1" in result["stored"][2]
    assert result["measured again"] == [False, 1]
    assert result["changed"][0] is False and "Set Up LTMD again" in result["changed"][1]
    assert "to the end" in result["not last"]
