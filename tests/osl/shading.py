# SPDX-License-Identifier: Apache-2.0
"""For scripts in a child process: scenes that show a shader's values, and what they should be.

The expected values are float64 and follow the paper's D R^-1 with explicit frames, not the shaders'
formulas.
"""

import sys

import bpy
import numpy as np
from blender_process import ROOT, camera, cycles, mesh_object, render, write_image

sys.path.insert(0, str(ROOT))

from blender_addon import nodes  # noqa: E402
from blender_addon.nodes import (  # noqa: E402
    conductor,
    dielectric,
    glossy,
    live_tension,
    parameters,
    tension_view,
    texture_tension,
)

__all__ = [
    "affine_quad", "camera", "conductor", "cycles", "deform", "dielectric", "glossy", "group",
    "lit_plane", "live_tension", "lobe", "material", "material_matrix", "mesh_object", "nodes",
    "parameters", "render", "shader_node", "show", "strengthened", "tension_model",
    "tension_view", "texture_tension", "write_image",
]  # fmt: skip

QUAD = np.array([(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], float)
QUAD_UV = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)


def material(obj):
    """An empty material on the object; return its tree and output."""
    made = bpy.data.materials.new("Test")
    made.use_nodes = True
    made.node_tree.nodes.clear()
    obj.data.materials.clear()
    obj.data.materials.append(made)
    return made.node_tree, made.node_tree.nodes.new("ShaderNodeOutputMaterial")


def group(tree, module):
    return nodes.group_node(tree, module)


def shader_node(tree, path):
    """A Script node of an .osl file that includes the shaders' headers."""
    from blender_addon.osl_inline import inlined

    node = tree.nodes.new("ShaderNodeScript")
    text = bpy.data.texts.new("Probe.osl")
    text.write(inlined(path, ROOT / "osl" / "include"))
    node.mode = "INTERNAL"
    node.script = text
    assert node.outputs, "the shader does not compile"
    return node


def show(tree, output, socket):
    """Emit a vector or colour: the picture's pixels are its values."""
    emission = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(socket, emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])


def deform(obj, positions):
    """A shape key, fully on, with these positions."""
    if not obj.data.shape_keys:
        obj.shape_key_add(name="Basis")
    key = obj.shape_key_add(name="Deformed")
    key.data.foreach_set("co", np.asarray(positions, np.float32).ravel())
    key.value = 1.0


def lit_plane():
    """A square with a UV map under an area light; its tree and output, and view(side)."""
    obj = mesh_object("Plane", QUAD, [(0, 1, 2, 3)], QUAD_UV)
    light = bpy.data.objects.new("Light", bpy.data.lights.new("Light", "AREA"))
    light.data.energy, light.data.size = 60, 1.0
    bpy.context.scene.collection.objects.link(light)

    def view(side):
        """See the front (1) or the back (-1), with the light on the same side."""
        light.location = (0.4, -1.2, 1.5 * side)
        light.rotation_euler = (0, 0, 0) if side > 0 else (np.pi, 0, 0)
        return camera((0.8, 1.5, 1.4 * side), ortho_scale=2.4)

    return *material(obj), view


def affine_quad(matrix, uv=QUAD_UV, rest_attribute=True):
    """A square of side 2 in the plane z = 0, deformed by a 2x2 matrix."""
    obj = mesh_object("Quad", QUAD, [(0, 1, 2, 3)], uv)
    deform(obj, np.c_[QUAD[:, :2] @ np.asarray(matrix, float).T, QUAD[:, 2]])
    if rest_attribute:
        store = obj.data.attributes.new("ltmd_rest", "FLOAT_VECTOR", "POINT")
        store.data.foreach_set("vector", QUAD.astype(np.float32).ravel())
    return obj


def _frame(points, uv):
    e1, e2 = points[1] - points[0], points[2] - points[0]
    w1, w2 = uv[1] - uv[0], uv[2] - uv[0]
    x = (e1 * w2[1] - e2 * w1[1]) / (w1[0] * w2[1] - w1[1] * w2[0])
    x = x / np.linalg.norm(x)
    z = np.cross(e1, e2)
    z = z / np.linalg.norm(z)
    return np.array([x, np.cross(z, x)]), np.array([e1, e2]).T


def tension_model(rest, deformed, uv):
    """(t11, t12, t22) of one triangle and its dP/du: T = D R^-1 in U-preserving frames."""
    frame_r, edges_r = _frame(np.asarray(rest, float), np.asarray(uv, float))
    frame_d, edges_d = _frame(np.asarray(deformed, float), np.asarray(uv, float))
    t = (frame_d @ edges_d) @ np.linalg.inv(frame_r @ edges_r)
    assert abs(t[1, 0]) < 1e-9 and t[0, 0] > 0 and t[1, 1] > 0
    return np.array([t[0, 0], t[0, 1], t[1, 1]]), frame_d[0]


def material_matrix(stretch, rotation, shear):
    """M0 = Rot(rotation) [[1, shear], [0, 1]] M_s."""
    s = 1 / (1 - stretch) if stretch >= 0 else 1 + stretch
    c, d = np.cos(rotation), np.sin(rotation)
    return np.array([[c, -d], [d, c]]) @ np.array([[1, shear], [0, 1]]) @ np.diag([s, 1 / s])


def strengthened(t, strength):
    """V^s Rot(s phi) of T = V Rot(phi), by singular values."""
    t = np.array([[t[0], t[1]], [0, t[2]]], float)
    u, s, w = np.linalg.svd(t)
    turn = u @ w
    phi = strength * np.arctan2(turn[1, 0], turn[0, 0])
    c, d = np.cos(phi), np.sin(phi)
    return u @ np.diag(s**strength) @ u.T @ np.array([[c, -d], [d, c]])


def lobe(alpha, matrix, heights=1.0):
    """alpha_x, alpha_y and the angle of alpha_x of an isotropic lobe under a matrix."""
    inverse = np.linalg.inv(matrix)
    values, vectors = np.linalg.eigh(alpha**2 * heights**2 * inverse.T @ inverse)
    return np.sqrt(values[0]), np.sqrt(values[1]), np.arctan2(vectors[1, 0], vectors[0, 0])
