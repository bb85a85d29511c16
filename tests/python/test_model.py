# SPDX-License-Identifier: Apache-2.0
"""The model itself against cases that can be worked out by hand."""

import meshes
import model
import numpy as np


def test_affine_maps_of_a_plane():
    """A plane under p' = A p: T is the upper triangular factor Q A of the QR decomposition."""
    shape = meshes.grid(3, 2)
    for a in ([[2, 0], [0, 0.5]], [[1, 0.3], [0, 1]], [[0.2, -1.1], [0.9, 0.4]]):
        deformed = shape.positions.astype(float)
        deformed[:, :2] = deformed[:, :2] @ np.transpose(a)
        r = np.linalg.cholesky(np.transpose(a) @ np.array(a, float)).T
        for per in ("triangle", "vertex", "corner"):
            t = model.tension(*shape.topology, len(shape.positions), shape.positions, deformed, per)
            assert np.allclose(t, [r[0, 0], r[0, 1], r[1, 1]])


def test_frames_are_right_handed_with_z_along_the_face_normal():
    shape = meshes.random_closed(np.random.default_rng(0))
    assert set(model.uv_area_sign(shape.triangles, shape.corner_uv)) == {-1, 1}
    f = model.frames(*shape.topology, shape.positions)
    assert np.allclose(f @ np.swapaxes(f, 1, 2), np.eye(3))
    assert np.allclose(np.linalg.det(f), 1)


def test_fans():
    plane = meshes.grid(3, 3)
    sizes = [len(fan) for fan in model.corner_fans(*plane.topology)]
    assert max(sizes) == 6 and sum(s == 0 for s in sizes) == 0
    tube = meshes.grid(8, 3, wrap=True)
    fans = model.corner_fans(*tube.topology)
    on_seam = np.isin(tube.corner_uv[:, 0], [0, 1])
    assert max(len(fans[c]) for c in np.flatnonzero(on_seam)) == 3


def test_tensor_of_a_flat_mesh_is_e_e_transposed():
    shape = meshes.grid(2, 2)
    e = np.array([[1.5, 0.2], [0.1, 0.7]])
    deformed = shape.positions.astype(float)
    deformed[:, :2] = deformed[:, :2] @ e.T
    b = model.deformation_tensor(
        shape.triangles, shape.corner_vert, len(shape.positions), shape.positions, deformed
    )
    c = e @ e.T
    assert np.allclose(b, [c[0, 0], c[1, 1], 0, c[0, 1], 0, 0])


def test_bake_of_one_triangle():
    bake = model.Bake([(0, 1, 2)], [(0, 0), (1, 0), (0, 1)], 4, 4)
    distance = bake.distance.reshape(4, 4)
    # The lower left half of the tile, rows counted from the top.
    assert (distance == 0).sum() == 10
    assert np.isclose(distance[0, 3], np.hypot(1.5, 1.5))
    assert bake.touches(-1e-9).sum() == 10
    values = bake.values(np.array([[0.0, 0], [1, 0], [0, 1]]))[0].reshape(4, 4, 2)
    assert np.allclose(values[3, 0], [0.125, 0.125])
    assert np.allclose(values[0, 3], [0.5, 0.5])
