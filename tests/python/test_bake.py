# SPDX-License-Identifier: Apache-2.0
import ltmd
import meshes
import model
import numpy as np
import pytest
from tolerance import assert_same_bits

NEAR = 1e-4  # texels: closer calls than this may fall either way
BACKGROUND = (1, 0, 1)


def fitted(shape, low=0.08, high=0.92):
    """The shape with its UVs scaled into the tile, clear of its border."""
    uv = shape.corner_uv.astype(float)
    first, last = uv.min(axis=0), uv.max(axis=0)
    uv = low + (uv - first) / (last - first) * (high - low)
    return shape.with_(corner_uv=uv.astype(np.float32))


def scattered(rng, count):
    """Small separate triangles, few of which overlap, in a tile."""
    shape = meshes.soup(rng, count)
    uv = shape.corner_uv.reshape(-1, 3, 2).astype(float)
    size = 1.2 / np.sqrt(count)
    uv = rng.uniform(0.1, 0.9, (count, 1, 2)) + (uv - uv.mean(axis=1, keepdims=True)) * size
    return shape.with_(corner_uv=uv.reshape(-1, 2).astype(np.float32))


def charts():
    rng = np.random.default_rng(1)
    return {
        "plane": fitted(meshes.grid(5, 4)),
        "tube with a seam": fitted(meshes.grid(8, 3, wrap=True)),
        "mirrored, overlapping": fitted(meshes.mirrored(3, 3)),
        "sphere": fitted(meshes.sphere(8, 6)),
        "islands, overlapping": fitted(meshes.random_closed(rng, 7, 5)),
        "scattered": scattered(rng, 40),
        "one triangle": scattered(rng, 1),
        "triangles below a texel": scattered(rng, 900),
    }


def assert_bake(pixels, shape, values, tile, margin, background=BACKGROUND):
    """Every texel holds a value that the model allows, to 1e-6 of the largest value."""
    height, width, channels = pixels.shape
    bake = model.Bake(shape.triangles, shape.corner_uv, width, height, tile)
    nearest = bake.distance.min(axis=0)
    candidates = bake.distance <= nearest + NEAR
    # The lowest index wins inside, unless its border runs through the centre.
    surely_inside = bake.depth > NEAR
    first = np.argmax(surely_inside, axis=0)
    for texel in np.flatnonzero(surely_inside.any(axis=0)):
        candidates[first[texel] + 1 :, texel] = False
    scale = np.abs(values).max()
    error = np.abs(bake.values(values) - pixels.reshape(1, -1, channels)).max(axis=2)
    of_triangle = np.where(candidates, error, np.inf).min(axis=0)
    of_background = np.abs(pixels.reshape(-1, channels) - background).max(axis=1)
    must_be_covered = bake.touches(-NEAR) | (nearest <= margin - NEAR)
    must_be_background = ~bake.touches(NEAR) & (nearest > margin + NEAR)
    error = np.where(
        must_be_covered,
        of_triangle,
        np.where(must_be_background, of_background, np.minimum(of_triangle, of_background)),
    )
    worst = int(np.argmax(error))
    assert error[worst] <= 1e-6 * scale, (
        f"{(error > 1e-6 * scale).sum()} of {error.size} texels are wrong, the worst at "
        f"row {worst // width}, column {worst % width}: {pixels.reshape(-1, channels)[worst]}, "
        f"{nearest[worst]:.4f} texels from triangle {np.argmin(bake.distance[:, worst])}, "
        f"which gives {bake.values(values)[np.argmin(bake.distance[:, worst]), worst]}"
    )
    return bake


def corner_values(rng, shape, channels=3):
    """A smooth field over UV plus a jump per triangle sign, equal where corners coincide."""
    sign = np.zeros(len(shape.corner_vert))
    sign[shape.triangles] = model.uv_area_sign(shape.triangles, shape.corner_uv)[:, None]
    u, v = shape.corner_uv.astype(float).T
    waves = [np.sin(3 * u + k) + np.cos(2 * v - k) + 0.3 * sign for k in range(channels)]
    return np.stack(waves, axis=1).astype(np.float32)


@pytest.mark.parametrize("margin", [0, 1, 16, 64])
@pytest.mark.parametrize("name", charts())
def test_against_the_model(name, margin, rng):
    shape = charts()[name]
    size = 24 if name == "triangles below a texel" else 96 if margin < 64 else 160
    values = corner_values(rng, shape)
    pixels = ltmd.bake(shape.mesh(), values, size, size, margin=margin)
    assert pixels.dtype == np.float32 and pixels.shape == (size, size, 3)
    assert_bake(pixels, shape, values, (0, 0), margin)


@pytest.mark.parametrize("size", [(64, 32), (33, 70), (1, 1), (1, 40), (7, 1)])
@pytest.mark.parametrize("name", ["plane", "scattered"])
def test_sizes_that_are_not_square(name, size, rng):
    shape = charts()[name]
    values = corner_values(rng, shape)
    pixels = ltmd.bake(shape.mesh(), values, *size, margin=3)
    assert pixels.shape == (size[1], size[0], 3)
    assert_bake(pixels, shape, values, (0, 0), 3)


@pytest.mark.parametrize("channels", [1, 2, 3, 4, 7])
def test_channels_and_background(channels, rng):
    shape = charts()["scattered"]
    values = corner_values(rng, shape, channels)
    background = tuple(float(x) for x in rng.uniform(-5, 5, channels).astype(np.float32))
    pixels = ltmd.bake(shape.mesh(), values, 40, 40, margin=1, background=background)
    assert pixels.shape == (40, 40, channels)
    assert_bake(pixels, shape, values, (0, 0), 1, background)
    assert (pixels.reshape(-1, channels) == np.float32(background)).all(axis=1).any()


def test_row_zero_is_the_top():
    shape = meshes.grid(1, 1)
    pixels = ltmd.bake(shape.mesh(), shape.corner_uv, 4, 4, background=(0, 0))
    assert np.allclose(pixels[0, :, 1], 0.875) and np.allclose(pixels[-1, :, 1], 0.125)
    assert np.allclose(pixels[:, 0, 0], 0.125) and np.allclose(pixels[:, -1, 0], 0.875)


def test_full_tile_has_no_background():
    shape = meshes.grid(7, 5)
    values = np.full((len(shape.corner_vert), 3), 2, np.float32)
    pixels = ltmd.bake(shape.mesh(), values, 64, 64, margin=0)
    assert (pixels == 2).all()


@pytest.mark.parametrize("tile", [(0, 0), (1, 0), (3, 2), (-1, 5)])
def test_tiles(tile, rng):
    shape = charts()["scattered"]
    values = corner_values(rng, shape)
    moved = shape.with_(corner_uv=(shape.corner_uv + tile).astype(np.float32))
    mesh = moved.mesh()
    assert mesh.tiles == [tile]
    pixels = ltmd.bake(mesh, values, 64, 64, tile=tile, margin=2)
    assert_bake(pixels, moved, values, tile, 2)
    elsewhere = ltmd.bake(mesh, values, 8, 8, tile=(tile[0] + 5, tile[1]))
    assert (elsewhere == BACKGROUND).all()


def test_chart_across_tiles(rng):
    """A chart that crosses borders is in every tile it reaches, and continues into the margin."""
    shape = charts()["plane"]
    uv = (shape.corner_uv * 1.5 + [0.2, -0.4]).astype(np.float32)
    shape = shape.with_(corner_uv=uv)
    values = corner_values(rng, shape)
    mesh = shape.mesh()
    assert mesh.tiles == [(0, -1), (1, -1), (0, 0), (1, 0)]
    for tile in mesh.tiles:
        pixels = ltmd.bake(mesh, values, 48, 48, tile=tile, margin=8)
        assert_bake(pixels, shape, values, tile, 8)


def test_margin_comes_from_the_neighbouring_tile_too(rng):
    """A texel near the border of a tile takes the nearest face even when it lies next door."""
    shape = charts()["plane"]
    shape = shape.with_(corner_uv=(shape.corner_uv + [0.95, 0]).astype(np.float32))
    values = corner_values(rng, shape)
    pixels = ltmd.bake(shape.mesh(), values, 32, 32, tile=(0, 0), margin=16)
    assert_bake(pixels, shape, values, (0, 0), 16)


def test_a_touched_texel_is_covered():
    """Conservative coverage: a sliver that misses every texel centre still shows, margin 0."""
    uv = [(0.1, 0.5001), (0.9, 0.5001), (0.5, 0.5003)]
    shape = meshes.make([(0, 1, 2)], [0, 1, 2], uv, [(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    values = np.full((3, 3), 5, np.float32)
    pixels = ltmd.bake(shape.mesh(), values, 10, 10, margin=0)
    covered = (pixels == 5).all(axis=2)
    assert covered[4, 1:9].all() and covered.sum() == 8
    coverage = ltmd.TexelCoverage(shape.mesh(), 10, 10, margin=0)
    assert coverage.covered == coverage.overlapping == 0


def test_overlaps_are_counted():
    # No texel centre of this size lies on an edge.
    shape = meshes.grid(1, 1)
    coverage = ltmd.TexelCoverage(shape.mesh(), 14, 16)
    assert (coverage.covered, coverage.overlapping) == (224, 0)
    assert shape.rest().report.overlap_fraction == 0
    half = meshes.make(
        [*shape.triangles, [4, 5, 6], [4, 6, 7]],
        [*shape.corner_vert, *shape.corner_vert],
        np.vstack([shape.corner_uv, shape.corner_uv * [0.5, 1]]),
        shape.positions,
    )
    coverage = ltmd.TexelCoverage(half.mesh(), 14, 16)
    assert (coverage.covered, coverage.overlapping) == (224, 112)
    assert abs(half.rest().report.overlap_fraction - 0.5) < 2e-3
    baker = ltmd.SequenceBaker(half.mesh(), half.positions, 14, 16)
    assert baker.coverage_report == {"covered": 224, "overlapping": 112}


def test_shared_edges_are_no_overlap(rng):
    """Centres exactly on edges and vertices belong to one face and count once."""
    for columns in (1, 2, 4, 8, 16):
        shape = meshes.grid(columns, columns)
        coverage = ltmd.TexelCoverage(shape.mesh(), 16, 16)
        assert (coverage.covered, coverage.overlapping) == (256, 0), columns
        # Texel centres on grid lines: 16 cells in 17 texels.
        shifted = shape.with_(corner_uv=(shape.corner_uv + np.float32(1 / 32)))
        coverage = ltmd.TexelCoverage(shifted.mesh(), 16, 16)
        assert coverage.overlapping == 0, columns


def test_mirrored_faces_are_covered(rng):
    shape = charts()["plane"]
    mirrored = shape.with_(corner_uv=np.ascontiguousarray([1, 0] + shape.corner_uv * [-1, 1], "f4"))
    values = corner_values(rng, shape)
    pixels = ltmd.bake(mirrored.mesh(), values, 64, 64)
    assert_bake(pixels, mirrored, values, (0, 0), 16)


def test_lowest_index_wins_where_faces_overlap():
    uv = [(0.1, 0.1), (0.9, 0.1), (0.1, 0.9)]
    shape = meshes.make(
        [(3, 4, 5), (0, 1, 2)], [0, 1, 2] * 2, uv * 2, [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    )
    values = np.repeat([[1.0], [2.0]], 3, axis=0).astype(np.float32)
    pixels = ltmd.bake(shape.mesh(), values, 32, 32, background=(0,))
    # Triangle 0 is made of corners 3, 4, 5, whose value is 2.
    assert set(np.unique(pixels)) == {0, 2}


def test_faces_without_uv_area(rng):
    """Points and lines in UV cover nothing by themselves and spoil nothing."""
    shape = charts()["plane"]
    count = len(shape.corner_vert)
    extra = meshes.make(
        np.vstack([[[count, count + 1, count + 2]], shape.triangles]),
        np.append(shape.corner_vert, [0, 1, 2]),
        np.vstack([shape.corner_uv, [[0.5, 0.5]] * 3]),
        shape.positions,
    )
    values = corner_values(rng, shape)
    padded = np.vstack([values, np.full((3, 3), 1e6)]).astype(np.float32)
    assert_same_bits(
        ltmd.bake(extra.mesh(), padded, 64, 64), ltmd.bake(shape.mesh(), values, 64, 64)
    )


def test_empty_mesh_is_all_background():
    shape = meshes.make([], [], np.zeros((0, 2)), [])
    pixels = ltmd.bake(shape.mesh(), np.zeros((0, 3), np.float32), 8, 4)
    assert pixels.shape == (4, 8, 3) and (pixels == BACKGROUND).all()


def test_very_small_and_very_large_faces(rng):
    """One face far larger than the tile, and one far smaller than a texel."""
    uv = [(-30, -20), (40, -25), (3, 50), (0.5, 0.5), (0.5 + 1e-6, 0.5), (0.5, 0.5 + 1e-6)]
    shape = meshes.make(
        [(3, 4, 5), (0, 1, 2)], [0, 1, 2, 0, 1, 2], uv, [(0, 0, 0), (1, 0, 0), (0, 1, 0)]
    )
    values = rng.uniform(0, 1, (6, 3)).astype(np.float32)
    pixels = ltmd.bake(shape.mesh(), values, 32, 32)
    assert_bake(pixels, shape, values, (0, 0), 16)


def test_tension_of_a_sequence_frame_is_the_bake_of_corner_tension(rng):
    shape = charts()["sphere"]
    t = shape.tension(meshes.twisted(shape))
    pixels = ltmd.bake(shape.mesh(), t, 64, 64)
    assert_bake(pixels, shape, t, (0, 0), 16)
    # Interpolated tension is invertible everywhere, the margin included.
    assert (pixels[..., 0] > 0).all() and (pixels[..., 2] > 0).all()


def test_same_bits_with_any_number_of_threads(rng):
    shape = charts()["islands, overlapping"]
    values = corner_values(rng, shape)
    results = []
    for count in (1, 2, 3, 4):
        ltmd.set_threads(count)
        results.append(ltmd.bake(shape.mesh(), values, 300, 200))
    for result in results[1:]:
        assert_same_bits(result, results[0])


def test_coverage_object_gives_the_same_bits(rng):
    shape = charts()["sphere"]
    values = corner_values(rng, shape)
    coverage = ltmd.TexelCoverage(shape.mesh(), 64, 48, margin=5)
    assert (coverage.width, coverage.height) == (64, 48)
    assert coverage.triangle.shape == (48, 64)
    assert_same_bits(coverage.bake(values), ltmd.bake(shape.mesh(), values, 64, 48, margin=5))
