# SPDX-License-Identifier: Apache-2.0
import ltmd
import meshes
import model
import numpy as np
import pytest
from tolerance import EPS, assert_close, assert_same_bits

PER = ["triangle", "vertex", "corner"]


def shapes(rng):
    return {
        "soup": meshes.soup(rng, 200),
        "plane": meshes.grid(9, 7),
        "tube": meshes.grid(16, 6, wrap=True),
        "sphere": meshes.sphere(),
        "mirrored": meshes.mirrored(),
        "islands": meshes.random_closed(rng),
    }


def rotation(rng):
    q = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return q * np.sign(np.linalg.det(q))


def composed(first, second):
    """(t11, t12, t22) of the product second x first."""
    product = model.matrix(second) @ model.matrix(first)
    return product[:, [0, 0, 1], [0, 1, 1]]


def test_convention_of_the_three_numbers():
    """Contract: t11 = stretch along U, t22 = across it, t12 = shear; det T = area ratio."""
    shape = meshes.grid(1, 1)
    for deformation, expected in [
        (np.diag([2.0, 1, 1]), (2, 0, 1)),
        (np.diag([1, 0.5, 1]), (1, 0, 0.5)),
        ([[1, 0.25, 0], [0, 1, 0], [0, 0, 1]], (1, 0.25, 1)),
        # dP'/du turns to +v: the frame turns along and the shear stays in t12.
        ([[1, 0, 0], [1, 1, 0], [0, 0, 1]], (np.sqrt(2), 1 / np.sqrt(2), 1 / np.sqrt(2))),
    ]:
        deformed = (shape.positions @ np.transpose(deformation)).astype(np.float32)
        for per in PER:
            t = shape.tension(deformed, per)
            assert t.dtype == np.float32
            assert_close(t, np.tile(expected, (len(t), 1)), factor=10)


def test_mirrored_uv_changes_x_only():
    """With u mirrored, x points the other way and so does y: shear keeps its sign."""
    shape = meshes.grid(1, 1)
    mirrored = shape.with_(corner_uv=np.ascontiguousarray(shape.corner_uv * [-1, 1], np.float32))
    deformed = (shape.positions @ np.transpose([[1, 0.25, 0], [0, 1, 0], [0, 0, 1]])).astype("f4")
    assert_close(mirrored.tension(deformed), np.tile([1, 0.25, 1], (4, 1)))


@pytest.mark.parametrize("per", PER)
@pytest.mark.parametrize("name", shapes(np.random.default_rng(0)))
def test_against_the_model(name, per, rng):
    shape = shapes(rng)[name]
    deformed = meshes.soup_deformation(rng, shape) if name == "soup" else meshes.twisted(shape)
    expected = model.tension(*shape.topology, len(shape.positions), shape.positions, deformed, per)
    assert np.abs(expected - model.IDENTITY).max() > 0.1
    assert_close(shape.tension(deformed, per), expected)


@pytest.mark.parametrize("per", PER)
@pytest.mark.parametrize("name", shapes(np.random.default_rng(0)))
def test_undeformed_is_the_identity(name, per, rng):
    shape = shapes(rng)[name]
    t = shape.tension(shape.positions, per)
    assert_close(t, np.tile(model.IDENTITY, (len(t), 1)))


@pytest.mark.parametrize("name", ["soup", "sphere", "mirrored", "islands"])
def test_composition(name, rng):
    shape = shapes(rng)[name]
    if name == "soup":
        middle = meshes.soup_deformation(rng, shape)
        last = meshes.soup_deformation(rng, shape.with_(positions=middle))
    else:
        middle = meshes.twisted(shape)
        last = meshes.twisted(shape.with_(positions=middle), -0.9)
    first = shape.tension(middle, "triangle")
    second = shape.with_(positions=middle).tension(last, "triangle")
    product = composed(first, second)
    # The two factors' own errors are multiplied by the other factor.
    scale = np.abs(first).max(axis=1) * np.abs(second).max(axis=1)
    assert_close(shape.tension(last, "triangle"), product, scale=scale)


@pytest.mark.parametrize("per", PER)
@pytest.mark.parametrize("name", shapes(np.random.default_rng(0)))
def test_rigid_motion_changes_nothing(name, per, rng):
    shape = shapes(rng)[name]
    moved = (shape.positions @ rotation(rng).T + rng.uniform(-1, 1, 3)).astype(np.float32)
    t = shape.tension(moved, per)
    # Rounding the moved positions alone is worth eps x position / edge.
    e1, e2 = model.edges(shape.triangles, shape.corner_vert, shape.positions)
    edge = min(np.linalg.norm(e, axis=1).min() for e in (e1, e2, e2 - e1))
    assert_close(t, np.tile(model.IDENTITY, (len(t), 1)), scale=max(1, np.abs(moved).max() / edge))


def test_rigid_motion_after_a_deformation(rng):
    shape = meshes.sphere()
    deformed = meshes.twisted(shape)
    turned = (deformed @ rotation(rng).T).astype(np.float32)
    assert_close(shape.tension(turned), shape.tension(deformed), factor=200)


@pytest.mark.parametrize("name", shapes(np.random.default_rng(0)))
def test_triangle_and_vertex_order(name, rng):
    shape = shapes(rng)[name]
    deformed = meshes.twisted(shape)
    triangle_order = rng.permutation(len(shape.triangles))
    vertex_order = rng.permutation(len(shape.positions))
    corner_order = rng.permutation(len(shape.corner_vert))
    place_of_vertex, place_of_corner = np.argsort(vertex_order), np.argsort(corner_order)
    shuffled = meshes.make(
        place_of_corner[shape.triangles[triangle_order]],
        place_of_vertex[shape.corner_vert[corner_order]],
        shape.corner_uv[corner_order],
        shape.positions[vertex_order],
    )
    moved = np.ascontiguousarray(deformed[vertex_order])
    assert_same_bits(
        shuffled.tension(moved, "triangle"), shape.tension(deformed, "triangle")[triangle_order]
    )
    # Sums over faces may run in another order.
    assert_close(shuffled.tension(moved, "vertex"), shape.tension(deformed, "vertex")[vertex_order])
    assert_close(shuffled.tension(moved), shape.tension(deformed)[corner_order])


def test_corner_order_within_triangles(rng):
    shape = meshes.soup(rng, 100)
    deformed = meshes.soup_deformation(rng, shape)
    for turn in (1, 2):
        rolled = shape.with_(triangles=np.ascontiguousarray(np.roll(shape.triangles, turn, axis=1)))
        assert_close(rolled.tension(deformed), shape.tension(deformed))


@pytest.mark.parametrize("per", PER)
def test_uv_shift_is_bit_equal(per, rng):
    shape = meshes.sphere()
    # UVs with few bits stay exact when they are shifted.
    uv = np.round(shape.corner_uv * 1024) / 1024
    shape = shape.with_(corner_uv=uv.astype(np.float32))
    deformed = meshes.twisted(shape)
    for shift in ([1, 0], [0, 1], [-3, 2], [7.5, 0.25]):
        moved = shape.with_(corner_uv=(uv + shift).astype(np.float32))
        assert_same_bits(moved.tension(deformed, per), shape.tension(deformed, per))


@pytest.mark.parametrize("per", PER)
@pytest.mark.parametrize("scale", [1e8, 1e-8])
@pytest.mark.parametrize("name", shapes(np.random.default_rng(0)))
def test_scale_of_the_mesh(name, scale, per, rng):
    shape = shapes(rng)[name]
    scaled = shape.with_(positions=(shape.positions * scale).astype(np.float32))
    deformed = (meshes.twisted(shape) * scale).astype(np.float32)
    expected = model.tension(*shape.topology, len(shape.positions), scaled.positions, deformed, per)
    assert_close(scaled.tension(deformed, per), expected)


@pytest.mark.parametrize("scale", [1e4, 1e-4, 1e-6])
def test_scale_of_the_uv_map(scale, rng):
    shape = meshes.sphere()
    scaled = shape.with_(corner_uv=(shape.corner_uv * scale).astype(np.float32))
    deformed = meshes.twisted(shape)
    expected = model.tension(*scaled.topology, len(shape.positions), shape.positions, deformed)
    assert_close(scaled.tension(deformed), expected)
    assert scaled.rest().report.no_uv_triangles == 0


@pytest.mark.parametrize("per", PER)
def test_uniform_scale(per):
    shape = meshes.sphere()
    for s in (0.01, 0.5, 3, 100):
        t = shape.tension((shape.positions * s).astype(np.float32), per)
        assert_close(t, np.tile([s, 0, s], (len(t), 1)))


def test_corner_means_stop_at_seams_and_mirrors():
    shape = meshes.mirrored()
    # The shear of the two halves is opposite: a mean across the mirror would lose it.
    deformed = shape.positions.copy()
    deformed[:, 1] += 0.5 * np.abs(deformed[:, 0])
    right = np.empty(len(shape.corner_vert), bool)
    right[shape.triangles] = (
        shape.positions[shape.corner_vert[shape.triangles], 0].mean(axis=1, keepdims=True) > 0
    )
    expected = model.tension(*shape.topology, len(shape.positions), shape.positions, deformed)
    assert (np.sign(expected[:, 1]) == np.where(right, 1, -1)).all()
    assert_close(shape.tension(deformed), expected)


def test_fans_that_share_only_a_vertex_are_apart():
    """Two pairs of triangles meet in one vertex with the same UV: they are two fans."""
    positions = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (-1, 0, 0), (-1, -1, 0)]
    triangles = [(0, 1, 2), (3, 4, 5)]
    verts = [0, 1, 2, 0, 3, 4]
    uv = np.array(positions)[verts][:, :2] / 2 + 0.5
    shape = meshes.make(triangles, verts, uv, positions)
    deformed = np.array([(0, 0, 0), (2, 0, 0), (2, 1, 0), (-1, 0, 0), (-1, -1, 0)], np.float32)
    t = shape.tension(deformed)
    assert_close(t[0:1], [[2, 0, 1]])
    assert_close(t[3:4], [[1, 0, 1]])
    assert_close(shape.tension(deformed, "vertex")[0:1], [[1.5, 0, 1]])


def test_mean_is_weighted_by_rest_area():
    positions = [(0, 0, 0), (3, 0, 0), (0, 1, 0), (-1, 0, 0)]
    shape = meshes.make(
        [(0, 1, 2), (0, 2, 3)], [0, 1, 2, 3], np.array(positions)[:, :2] / 8 + 0.5, positions
    )
    deformed = np.array([(0, 0, 0), (6, 0, 0), (0, 1, 0), (-1, 0, 0)], np.float32)
    # Areas 1.5 and 0.5: t11 = (2 x 1.5 + 1 x 0.5) / 2.
    for per in ("vertex", "corner"):
        assert_close(shape.tension(deformed, per)[[0, 2]], [[1.75, 0, 1]] * 2)


def test_report_counts():
    assert meshes.grid(4, 4).rest().report.seam_vertices == 0
    assert meshes.grid(16, 6, wrap=True).rest().report.seam_vertices == 7
    mirrored = meshes.mirrored(4, 4).rest().report
    assert mirrored.mirrored_triangles == 32
    assert mirrored.seam_vertices == 5
    assert mirrored.degenerate_triangles == mirrored.no_uv_triangles == 0


def degenerate_cases():
    flat = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    uv = [(0, 0), (1, 0), (0, 1)]
    return {
        "rest in a point": ([(1, 1, 1)] * 3, flat, uv),
        "rest in a line": ([(0, 0, 0), (1, 1, 1), (2, 2, 2)], flat, uv),
        "rest in a line, rounded": ([(0, 0, 0), (0.1, 0.3, 0.7), (0.3, 0.9, 2.1)], flat, uv),
        "uv in a point": (flat, [(0, 0, 0), (2, 0, 0), (0, 1, 0)], [(0.5, 0.5)] * 3),
        "uv in a line": (flat, [(0, 0, 0), (2, 0, 0), (0, 1, 0)], [(0, 0), (0.5, 0.5), (1, 1)]),
    }


@pytest.mark.parametrize("name", degenerate_cases())
def test_degenerate_rest_gives_the_identity_and_is_counted(name):
    rest, deformed, uv = degenerate_cases()[name]
    shape = meshes.make([(0, 1, 2)], [0, 1, 2], uv, rest)
    report = shape.rest().report
    if name.startswith("rest"):
        assert report.degenerate_triangles == 1
    else:
        assert report.no_uv_triangles == 1
    for per in PER:
        t = shape.tension(np.array(deformed, np.float32), per)
        assert np.array_equal(t, np.tile(model.IDENTITY, (len(t), 1)))


def test_degenerate_threshold():
    """|e1 x e2| <= 1e-7 max edge^2: just under it is degenerate, well over it is not."""
    for height, degenerate in [(0.9e-7, 1), (1.2e-7, 0), (1e-4, 0)]:
        shape = meshes.make(
            [(0, 1, 2)],
            [0, 1, 2],
            [(0, 0), (1, 0), (0.5, 1)],
            [(0, 0, 0), (1, 0, 0), (0.5, height, 0)],
        )
        assert shape.rest().report.degenerate_triangles == degenerate, height


COLLAPSED = {
    "a point": [(1, 2, 3)] * 3,
    "a line along u": [(0, 0, 0), (1, 0, 0), (0.5, 0, 0)],
    "a line across u": [(0, 0, 0), (0, 0, 0), (0, 1, 0)],
    "a line across u, dP/du not zero": [(0, 0, 0), (0, 1, 0), (0, 3, 0)],
    "u vanishes": [(0, 0, 0), (0, 0, 0), (0, 0, 2)],
    "very large": [(0, 0, 0), (1e5, 0, 0), (0, 1e6, 0)],
    "very thin": [(0, 0, 0), (1, 0, 0), (0, 1e-6, 0)],
}


@pytest.mark.parametrize("name", COLLAPSED)
def test_collapsed_triangles_are_clamped(name):
    shape = meshes.make(
        [(0, 1, 2)], [0, 1, 2], [(0, 0), (1, 0), (0, 1)], [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    )
    deformed = np.array(COLLAPSED[name], np.float32)
    for per in PER:
        t = shape.tension(deformed, per)
        assert np.isfinite(t).all()
        s = model.stretch(t)[:, :2]
        assert (s >= 1e-3 * (1 - 100 * EPS)).all() and (s <= 1e3 * (1 + 100 * EPS)).all()
        assert (t[:, [0, 2]] > 0).all()
        expected = model.tension(*shape.topology, 3, shape.positions, deformed, per)
        assert_close(t, expected, factor=1000)


def test_collapsed_triangles_with_shear(rng):
    """Random rank-one deformations: the clamped singular values, whatever the direction of U."""
    shape = meshes.soup(rng, 200, quality=0.4)
    p = shape.positions.reshape(-1, 3, 3)
    line = rng.normal(size=(len(p), 3))
    line /= np.linalg.norm(line, axis=1, keepdims=True)
    deformed = (np.sum(p * line[:, None], axis=2)[..., None] * [0, 0, 1]).reshape(-1, 3)
    t = shape.tension(deformed.astype(np.float32), "triangle")
    assert np.isfinite(t).all()
    expected = model.triangle_tension(*shape.topology, shape.positions, deformed.astype("f4"))
    assert_close(model.stretch(t)[:, :2], model.stretch(expected)[:, :2])


def test_degenerate_triangles_leave_their_neighbours_alone(rng):
    """A triangle of no area has no weight in the means around it."""
    shape = meshes.grid(3, 3)
    deformed = meshes.twisted(shape)
    extra = meshes.make(
        np.vstack([shape.triangles, [[0, 0, 1], [2, 2, 2]]]),
        shape.corner_vert,
        shape.corner_uv,
        shape.positions,
    )
    assert extra.rest().report.degenerate_triangles == 2
    for per in ("corner", "vertex"):
        assert_close(extra.tension(deformed, per), shape.tension(deformed, per))


def test_corners_and_vertices_of_no_face():
    shape = meshes.grid(1, 1)
    loose = meshes.make(
        shape.triangles,
        np.append(shape.corner_vert, [0, 4]),
        np.vstack([shape.corner_uv, [[0, 0], [1, 1]]]),
        np.vstack([shape.positions, [[9, 9, 9]]]),
    )
    deformed = (loose.positions * 2).astype(np.float32)
    assert np.array_equal(loose.tension(deformed)[4:], [model.IDENTITY] * 2)
    assert np.array_equal(loose.tension(deformed, "vertex")[4:], [model.IDENTITY])


def test_empty_mesh():
    shape = meshes.make([], [], [], [])
    for per in PER:
        assert shape.tension(shape.positions, per).shape == (0, 3)
    assert shape.mesh().tiles == []
    assert shape.rest().report.degenerate_triangles == 0


def test_one_triangle(rng):
    shape = meshes.soup(rng, 1)
    deformed = meshes.soup_deformation(rng, shape)
    one = shape.tension(deformed, "triangle")
    assert one.shape == (1, 3)
    assert_same_bits(shape.tension(deformed, "corner"), np.repeat(one, 3, axis=0))


def test_rest_as_an_array_is_a_rest_state(rng):
    shape = meshes.sphere()
    deformed = meshes.twisted(shape)
    t = ltmd.tension(shape.mesh(), shape.positions, deformed, per="corner")
    assert_same_bits(t, shape.tension(deformed))


def test_tension_matrix_and_stretch(rng):
    t = np.exp(rng.uniform(-2, 2, (5, 7, 3))).astype(np.float32)
    t[..., 1] -= 2
    assert np.array_equal(ltmd.tension_matrix(t), model.matrix(t).astype(np.float32))
    expected = model.stretch(t)
    s = ltmd.stretch(t)
    assert s.shape == t.shape and s.dtype == np.float32
    assert_close(s.reshape(-1, 3)[:, :2], expected.reshape(-1, 3)[:, :2])
    assert_close(s.reshape(-1, 3)[:, 2:], expected.reshape(-1, 3)[:, 2:])


def test_stretch_is_the_same_on_both_sides_of_a_seam():
    shape = meshes.mirrored()
    deformed = (shape.positions @ np.array([[1.5, 0.4, 0], [0, 0.7, 0], [0, 0, 1]])).astype("f4")
    s = ltmd.stretch(shape.tension(deformed))
    assert_close(s, np.tile(s[0], (len(s), 1)))
