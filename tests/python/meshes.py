# SPDX-License-Identifier: Apache-2.0
"""Meshes for tests: each is a `Shape` of the four arrays and the rest positions."""

from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True)
class Shape:
    triangles: np.ndarray
    corner_vert: np.ndarray
    corner_uv: np.ndarray | None
    positions: np.ndarray

    @property
    def topology(self):
        return self.triangles, self.corner_vert, self.corner_uv

    def mesh(self):
        import ltmd

        return ltmd.Mesh(*self.topology, len(self.positions))

    def rest(self, mesh=None):
        import ltmd

        return ltmd.RestState(mesh or self.mesh(), self.positions)

    def tension(self, deformed, per="corner"):
        import ltmd

        mesh = self.mesh()
        return ltmd.tension(mesh, self.rest(mesh), deformed, per=per)

    def with_(self, **changes):
        return replace(self, **changes)


def make(triangles, corner_vert, corner_uv, positions):
    return Shape(
        np.ascontiguousarray(triangles, np.int32).reshape(-1, 3),
        np.ascontiguousarray(corner_vert, np.int32),
        None if corner_uv is None else np.ascontiguousarray(corner_uv, np.float32).reshape(-1, 2),
        np.ascontiguousarray(positions, np.float32).reshape(-1, 3),
    )


def soup(rng, count, quality=0.15):
    """Separate triangles with random UVs of both signs; slivers are drawn again."""

    def draw(dimension):
        out = np.empty((count, 3, dimension))
        todo = np.arange(count)
        while len(todo):
            out[todo] = rng.uniform(-1, 1, (len(todo), 3, dimension))
            a, b = out[todo, 1] - out[todo, 0], out[todo, 2] - out[todo, 0]
            gram = np.sum(a * a, 1) * np.sum(b * b, 1) - np.sum(a * b, 1) ** 2
            longest = np.max([np.sum(e * e, 1) for e in (a, b, b - a)], axis=0)
            todo = todo[np.sqrt(np.maximum(gram, 0)) < quality * longest]
        return out

    corners = np.arange(3 * count)
    return make(corners, corners, draw(2) * 0.5 + 0.5, draw(3))


def soup_deformation(rng, shape, largest=3.0):
    """Each triangle of a soup moved by its own linear map with singular values in [1/l, l]."""
    p = shape.positions.reshape(-1, 3, 3).astype(float)
    out = np.empty_like(p)
    for i in range(len(p)):
        q1, q2 = np.linalg.qr(rng.normal(size=(3, 3)))[0], np.linalg.qr(rng.normal(size=(3, 3)))[0]
        s = np.exp(rng.uniform(-1, 1, 3) * np.log(largest))
        out[i] = p[i] @ (q1 * s @ q2).T
    return out.reshape(-1, 3).astype(np.float32)


def grid(columns, rows, wrap=False):
    """A plane of quads cut in two, UV = the unit square; `wrap` closes it to a tube with a seam."""
    ij = np.stack(np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij"), -1)
    ij = ij.reshape(-1, 2)
    quads = np.stack([ij, ij + [0, 1], ij + [1, 1], ij + [1, 0]], axis=1)
    uv = quads[..., ::-1] / [columns, rows]
    if wrap:
        vert = quads[..., 0] * columns + quads[..., 1] % columns
        i, j = np.meshgrid(np.arange(rows + 1), np.arange(columns), indexing="ij")
        angle = 2 * np.pi * j / columns
        positions = np.stack([np.cos(angle), np.sin(angle), 3 * i / rows], -1)
    else:
        vert = quads[..., 0] * (columns + 1) + quads[..., 1]
        i, j = np.meshgrid(np.arange(rows + 1), np.arange(columns + 1), indexing="ij")
        positions = np.stack([j / columns, i / rows, 0 * i], -1)
    first = 4 * np.arange(len(quads))[:, None]
    triangles = np.concatenate([first + [0, 1, 2], first + [0, 2, 3]], axis=1)
    return make(triangles, vert.ravel(), uv.reshape(-1, 2), positions)


def sphere(segments=16, rings=8):
    """Closed, with a UV seam and poles whose corners have their own UVs."""
    triangles, verts, uvs = [], [], []
    positions = [(0, 0, -1)]
    for i in range(1, rings):
        t = np.pi * (i / rings - 0.5)
        a = 2 * np.pi * np.arange(segments) / segments
        positions += list(
            np.stack([np.cos(t) * np.cos(a), np.cos(t) * np.sin(a), 0 * a + np.sin(t)], 1)
        )
    positions.append((0, 0, 1))

    def vertex(i, j):
        if i == 0:
            return 0
        return len(positions) - 1 if i == rings else 1 + (i - 1) * segments + j % segments

    for i in range(rings):
        for j in range(segments):
            quad = [(i, j), (i, j + 1), (i + 1, j + 1), (i + 1, j)]
            if i == 0:
                quad = [(0, j + 0.5), *quad[2:]]
            elif i == rings - 1:
                quad = [*quad[:2], (rings, j + 0.5)]
            start = len(verts)
            for ci, cj in quad:
                verts.append(vertex(ci, int(cj)))
                uvs.append((cj / segments, ci / rings))
            triangles += [(start, start + k, start + k + 1) for k in range(1, len(quad) - 1)]
    return make(triangles, verts, uvs, positions)


def mirrored(columns=4, rows=4):
    """Two grids side by side that share vertices and UVs along x = 0: the left UVs are mirrored."""
    shape = grid(2 * columns, rows)
    positions = shape.positions * [2, 1, 1] - [1, 0, 0]
    u = np.abs(positions[shape.corner_vert, 0])
    return make(
        shape.triangles,
        shape.corner_vert,
        np.stack([u, positions[shape.corner_vert, 1]], 1),
        positions,
    )


def random_closed(rng, segments=11, rings=7):
    """A closed, bumpy surface whose UVs are cut in turned islands, one mirrored."""
    shape = sphere(segments, rings)
    bump = 1 + 0.2 * rng.uniform(-1, 1, len(shape.positions))
    uv = shape.corner_uv[shape.triangles].astype(float) - 0.5
    centre = uv.mean(axis=1)
    island = (centre[:, 0] > 0).astype(int) + 2 * (centre[:, 1] > 0)
    a = rng.uniform(0, 2 * np.pi, 4)
    turn = np.array([[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]]).transpose(2, 0, 1)
    turn[3] = turn[3] @ np.diag([1, -1])
    uv = np.einsum("tij,tkj->tki", turn[island], uv) + 0.5
    corners = np.arange(3 * len(shape.triangles))
    verts = shape.corner_vert[shape.triangles].ravel()
    return make(corners, verts, uv, shape.positions * bump[:, None])


def twisted(shape, amount=0.7):
    """A smooth deformation with stretch, shear, bending and translation."""
    x, y, z = shape.positions.astype(float).T
    angle = amount * z + 0.3 * x
    return np.stack(
        [
            1.4 * (x * np.cos(angle) - y * np.sin(angle)) + 0.2 * y**2,
            0.8 * (x * np.sin(angle) + y * np.cos(angle)) + 0.5,
            z * (1 + 0.25 * x) + 0.3 * np.sin(2 * y),
        ],
        axis=1,
    ).astype(np.float32)
