# SPDX-License-Identifier: Apache-2.0
import ltmd
import meshes
import model
import numpy as np
import pytest
from tolerance import assert_close, assert_same_bits

NO_DEFORMATION = [1, 1, 1, 0, 0, 0]


def tensor(shape, deformed):
    mesh = shape.mesh()
    return ltmd.deformation_tensor(mesh, shape.rest(mesh), deformed)


def as_matrices(b):
    return b[:, [0, 3, 4, 3, 1, 5, 4, 5, 2]].reshape(-1, 3, 3).astype(float)


@pytest.mark.parametrize("seed", range(4))
def test_against_the_model(seed):
    shape = meshes.random_closed(np.random.default_rng(seed))
    deformed = meshes.twisted(shape)
    expected = model.deformation_tensor(
        shape.triangles, shape.corner_vert, len(shape.positions), shape.positions, deformed
    )
    b = tensor(shape, deformed)
    assert b.dtype == np.float32
    assert_close(b, expected)


def test_needs_no_uv_map():
    shape = meshes.sphere()
    deformed = meshes.twisted(shape)
    assert_same_bits(tensor(shape.with_(corner_uv=None), deformed), tensor(shape, deformed))


def test_undeformed_is_the_projector_on_the_tangent_plane():
    """B is I - n n^T on a surface at rest: without the turn it would read as a false stretch."""
    shape = meshes.sphere()
    n = model.normalised(
        model.vertex_normals(
            shape.triangles, shape.corner_vert, shape.positions, len(shape.positions)
        )
    )
    expected = np.eye(3) - n[:, :, None] * n[:, None, :]
    assert_close(
        as_matrices(tensor(shape, shape.positions)).reshape(-1, 9), expected.reshape(-1, 9)
    )


def test_rotation_turns_the_tensor(rng):
    q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    q *= np.sign(np.linalg.det(q))
    shape = meshes.sphere()
    deformed = meshes.twisted(shape)
    turned = (deformed @ q.T).astype(np.float32)
    expected = q @ as_matrices(tensor(shape, deformed)) @ q.T
    assert_close(
        as_matrices(tensor(shape, turned)).reshape(-1, 9), expected.reshape(-1, 9), factor=200
    )


@pytest.mark.parametrize("scale", [1e8, 1e-8])
def test_scale(scale):
    shape = meshes.sphere()
    deformed = meshes.twisted(shape)
    scaled = shape.with_(positions=(shape.positions * scale).astype(np.float32))
    b = tensor(scaled, (deformed * scale).astype(np.float32))
    assert_close(b, tensor(shape, deformed), factor=200)


def test_projection_on_the_uv_frame_is_the_tension(rng):
    """On a flat mesh no turn is needed, and with x along dP/du the tensor is T itself."""
    shape = meshes.grid(6, 5)
    p = shape.positions.astype(float)
    deformed = (p @ np.array([[1.3, 0.2, 0], [0.4, 0.8, 0], [0, 0, 1]])).astype(np.float32)
    b = tensor(shape, deformed)
    frame = model.frames(*shape.topology, deformed)[0]
    x, y = (np.tile(axis, (len(b), 1)).astype(np.float32) for axis in frame[:2])
    t = ltmd.project_tensor(b, x, y)
    assert_close(t, shape.tension(deformed, "vertex"))


def test_projection_against_the_model(rng):
    e = rng.normal(size=(100, 3, 3)) * 0.3 + np.eye(3)
    m = e @ np.swapaxes(e, 1, 2)
    b = m[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]].astype(np.float32)
    q = np.linalg.qr(rng.normal(size=(100, 3, 3)))[0].astype(np.float32)
    x, y = np.ascontiguousarray(q[:, 0]), np.ascontiguousarray(q[:, 1])
    expected = model.project_tensor(b, x, y)
    # det C is a difference: its error grows with the condition of C.
    s = model.stretch(expected)
    assert_close(
        ltmd.project_tensor(b, x, y),
        expected,
        scale=np.abs(expected).max(axis=1) * (s[:, 0] / s[:, 1]) ** 2,
    )


def test_degenerate_faces_are_left_out():
    shape = meshes.grid(3, 3)
    deformed = meshes.twisted(shape)
    extra = shape.with_(triangles=np.vstack([shape.triangles, [[0, 0, 1], [2, 2, 2]]]).astype("i4"))
    assert_close(tensor(extra, deformed), tensor(shape, deformed))


def test_vertices_without_a_usable_face():
    shape = meshes.make([(0, 1, 2)], [0, 1, 2], None, [(0, 0, 0), (1, 0, 0), (0, 1, 0), (5, 5, 5)])
    collapsed = np.zeros((4, 3), np.float32)
    assert np.array_equal(tensor(shape, collapsed), [NO_DEFORMATION] * 4)
    assert np.array_equal(tensor(shape, shape.positions)[3], NO_DEFORMATION)


def test_empty_mesh():
    shape = meshes.make([], [], None, [])
    assert tensor(shape, shape.positions).shape == (0, 6)


def test_same_bits_with_any_number_of_threads():
    shape = meshes.grid(60, 50)
    deformed = meshes.twisted(shape)
    results = []
    for count in (1, 2, 3, 4):
        ltmd.set_threads(count)
        results.append(tensor(shape, deformed))
    for result in results[1:]:
        assert_same_bits(result, results[0])
