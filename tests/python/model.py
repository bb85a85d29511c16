# SPDX-License-Identifier: Apache-2.0
"""A float64 NumPy model of frames, tension and bake, written from the design's conventions alone.

Slow and plain on purpose: explicit frames, loops over vertices, brute-force nearest points. It
shares no code and no formula with the library where there is a choice (T comes from frames or from
a Cholesky factor here, from E there).
"""

import numpy as np

IDENTITY = np.array([1.0, 0.0, 1.0])
SMALLEST, LARGEST = 1e-3, 1e3


def edges(triangles, corner_vert, positions):
    p = np.asarray(positions, float)[np.asarray(corner_vert)[np.asarray(triangles)]]
    return p[:, 1] - p[:, 0], p[:, 2] - p[:, 0]


def uv_edges(triangles, corner_uv):
    uv = np.asarray(corner_uv, float)[np.asarray(triangles)]
    return uv[:, 1] - uv[:, 0], uv[:, 2] - uv[:, 0]


def uv_area_sign(triangles, corner_uv):
    a, b = uv_edges(triangles, corner_uv)
    return np.sign(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).astype(int)


def normalised(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def frames(triangles, corner_vert, corner_uv, positions):
    """x = normalised dP/du, z = normalised e1 x e2, y = z x x, per triangle: [T, 3 axes, 3]."""
    e1, e2 = edges(triangles, corner_vert, positions)
    a, b = uv_edges(triangles, corner_uv)
    area = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    x = normalised((e1 * b[:, 1:] - e2 * a[:, 1:]) / area[:, None])
    z = normalised(np.cross(e1, e2))
    return np.stack([x, np.cross(z, x), z], axis=1)


def is_degenerate(triangles, corner_vert, positions):
    e1, e2 = edges(triangles, corner_vert, positions)
    longest2 = np.max([np.sum(e**2, axis=1) for e in (e1, e2, e2 - e1)], axis=0)
    return np.linalg.norm(np.cross(e1, e2), axis=1) <= 1e-7 * longest2


def rest_area(triangles, corner_vert, positions):
    return np.linalg.norm(np.cross(*edges(triangles, corner_vert, positions)), axis=1) / 2


def in_frame(frame, e1, e2):
    """The 2x2 matrix whose columns are two edges in a frame's (x, y)."""
    return np.stack(
        [np.stack([np.sum(axis * e, axis=1) for e in (e1, e2)], axis=1) for axis in frame[:2]],
        axis=1,
    )


def triangle_tension(triangles, corner_vert, corner_uv, rest, deformed):
    """T = D R^-1 per triangle, the identity where it is not defined, singular values clamped."""
    t = np.tile(IDENTITY, (len(triangles), 1))
    good = ~is_degenerate(triangles, corner_vert, rest) & (uv_area_sign(triangles, corner_uv) != 0)
    tris = np.asarray(triangles)[good]
    if not len(tris):
        return t
    frame = np.swapaxes(frames(tris, corner_vert, corner_uv, rest), 0, 1)
    r = in_frame(frame, *edges(tris, corner_vert, rest))
    d = np.stack(edges(tris, corner_vert, deformed), axis=2)  # 3x2, no frame
    e = d @ np.linalg.inv(r)
    _, s, vt = np.linalg.svd(e, full_matrices=False)
    matrices = np.empty_like(r)
    plain = (s.min(axis=1) >= SMALLEST) & (s.max(axis=1) <= LARGEST)
    if plain.any():
        moved = np.swapaxes(frames(tris[plain], corner_vert, corner_uv, deformed), 0, 1)
        edges_moved = edges(tris[plain], corner_vert, deformed)
        matrices[plain] = in_frame(moved, *edges_moved) @ np.linalg.inv(r[plain])
    for i in np.flatnonzero(~plain):
        # T is the upper Cholesky factor of C = E^T E, which needs no deformed frame.
        c = vt[i].T @ np.diag(np.clip(s[i], SMALLEST, LARGEST) ** 2) @ vt[i]
        matrices[i] = np.linalg.cholesky(c).T
    assert np.allclose(matrices[:, 1, 0], 0, atol=1e-9 * np.abs(matrices).max())
    t[good] = matrices[:, [0, 0, 1], [0, 1, 1]]
    return t


def weighted_mean(t, weight):
    total = weight.sum()
    return (t * weight[:, None]).sum(axis=0) / total if total > 0 else IDENTITY


def corner_fans(triangles, corner_vert, corner_uv):
    """Per corner the sorted triangles of its fan; corners of no triangle get none."""
    triangles, corner_vert = np.asarray(triangles), np.asarray(corner_vert)
    sign = uv_area_sign(triangles, corner_uv)
    bits = np.ascontiguousarray(corner_uv, np.float32).view(np.uint32)
    at_vertex = {}
    for triangle, corners in enumerate(triangles):
        for corner in corners:
            at_vertex.setdefault(int(corner_vert[corner]), []).append((triangle, int(corner)))
    fans = [[] for _ in corner_vert]
    for vertex, members in at_vertex.items():
        groups = {}
        for triangle, corner in members:
            key = (*bits[corner].tolist(), sign[triangle])
            groups.setdefault(key, []).append((triangle, corner))
        for group in groups.values():
            others = {t: set(corner_vert[triangles[t]].tolist()) - {vertex} for t, _ in group}
            left = set(others)
            while left:
                fan, border = set(), [left.pop()]
                while border:
                    t = border.pop()
                    fan.add(t)
                    border += [s for s in left if others[s] & others[t]]
                    left -= set(border)
                for t, corner in group:
                    if t in fan:
                        fans[corner] = sorted(set(fans[corner]) | fan)
    return fans


def tension(triangles, corner_vert, corner_uv, vertex_count, rest, deformed, per="corner"):
    t = triangle_tension(triangles, corner_vert, corner_uv, rest, deformed)
    if per == "triangle":
        return t
    area = rest_area(triangles, corner_vert, rest)
    if per == "corner":
        fans = corner_fans(triangles, corner_vert, corner_uv)
    else:
        fans = [[] for _ in range(vertex_count)]
        for triangle, corners in enumerate(np.asarray(corner_vert)[np.asarray(triangles)]):
            for vertex in corners:
                fans[vertex].append(triangle)
    return np.array([weighted_mean(t[fan], area[fan]) for fan in fans]).reshape(-1, 3)


def matrix(t):
    t = np.asarray(t, float)
    return np.stack([t[..., 0], t[..., 1], 0 * t[..., 0], t[..., 2]], axis=-1).reshape(
        *t.shape[:-1], 2, 2
    )


def vertex_normals(triangles, corner_vert, positions, vertex_count):
    """Angle-weighted, of the faces with area."""
    p = np.asarray(positions, float)[np.asarray(corner_vert)[np.asarray(triangles)]]
    face = np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
    length = np.linalg.norm(face, axis=1)
    normals = np.zeros((vertex_count, 3))
    for k in range(3):
        a, b = p[:, (k + 1) % 3] - p[:, k], p[:, (k + 2) % 3] - p[:, k]
        with np.errstate(invalid="ignore", divide="ignore"):
            cosine = np.sum(a * b, axis=1) / np.linalg.norm(a, axis=1) / np.linalg.norm(b, axis=1)
            weighted = face / length[:, None] * np.arccos(np.clip(cosine, -1, 1))[:, None]
        vertices = np.asarray(corner_vert)[np.asarray(triangles)[:, k]]
        np.add.at(normals, vertices[length > 0], weighted[length > 0])
    return normals


def deformation_tensor(triangles, corner_vert, vertex_count, rest, deformed):
    """B = D (R^T R)^-1 D^T per face, turned by the smallest rotation onto the vertex normal."""
    area = rest_area(triangles, corner_vert, rest)
    usable = ~is_degenerate(triangles, corner_vert, rest)
    usable &= rest_area(triangles, corner_vert, deformed) > 0
    r = np.stack(edges(triangles, corner_vert, rest), axis=2)
    d = np.stack(edges(triangles, corner_vert, deformed), axis=2)
    normals = vertex_normals(triangles, corner_vert, deformed, vertex_count)
    sums, weights = np.zeros((vertex_count, 3, 3)), np.zeros(vertex_count)
    for i in np.flatnonzero(usable):
        b = d[i] @ np.linalg.inv(r[i].T @ r[i]) @ d[i].T
        face_normal = normalised(np.cross(d[i][:, 0], d[i][:, 1]))
        for vertex in np.asarray(corner_vert)[np.asarray(triangles)[i]]:
            turn = smallest_rotation(face_normal, normalised(normals[vertex]))
            sums[vertex] += area[i] * turn @ b @ turn.T
            weights[vertex] += area[i]
    mean = np.where(
        weights[:, None, None] > 0, sums / np.maximum(weights, 1e-300)[:, None, None], np.eye(3)
    )
    return mean[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]


def smallest_rotation(a, b):
    """The rotation about a x b that takes unit vector a to b (not defined for b = -a)."""
    w = np.cross(a, b)
    k = np.array([[0, -w[2], w[1]], [w[2], 0, -w[0]], [-w[1], w[0], 0]])
    return np.eye(3) + k + k @ k / (1 + a @ b)


def project_tensor(tensor, x, y):
    xx, yy, zz, xy, xz, yz = np.moveaxis(np.asarray(tensor, float), -1, 0)
    b = np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=-1).reshape(*xx.shape, 3, 3)
    f = np.stack([x, y], axis=-1).astype(float)
    c = np.swapaxes(f, -1, -2) @ b @ f
    t22 = np.sqrt(c[..., 1, 1])
    return np.stack([np.sqrt(np.linalg.det(c)) / t22, c[..., 0, 1] / t22, t22], axis=-1)


def stretch(t):
    s = np.linalg.svd(matrix(t), compute_uv=False)
    return np.stack([s[..., 0], s[..., 1], s[..., 0] * s[..., 1]], axis=-1)


class Bake:
    """The nearest point of every triangle to every texel centre, in texels; row 0 = top."""

    def __init__(self, triangles, corner_uv, width, height, tile=(0, 0)):
        self.triangles = np.asarray(triangles)
        self.width, self.height = width, height
        uv = np.asarray(corner_uv, float) - tile
        pixel = np.stack([uv[:, 0] * width, (1 - uv[:, 1]) * height], axis=1)
        self.corners = pixel[self.triangles]
        y, x = np.mgrid[0:height, 0:width]
        self.centres = np.stack([x + 0.5, y + 0.5], axis=-1).reshape(-1, 2)
        points = [nearest_point(self.centres, triangle) for triangle in self.corners]
        self.weights = np.array([w for w, _, _ in points]).reshape(-1, len(self.centres), 3)
        self.distance = np.array([d for _, d, _ in points]).reshape(-1, len(self.centres))
        self.depth = np.array([b for _, _, b in points]).reshape(-1, len(self.centres))

    def values(self, corner_values):
        """What each triangle gives each texel: [T, texels, k]."""
        v = np.asarray(corner_values, float)[self.triangles]
        return np.einsum("tnc,tck->tnk", self.weights, v)

    def touches(self, slack=0.0):
        """Texels whose square, grown by slack, meets a triangle."""
        hit = np.zeros(len(self.centres), bool)
        half = 0.5 + slack
        square = np.array([[-half, -half], [half, -half], [half, half], [-half, half]])
        for triangle in self.corners:
            apart = np.zeros(len(self.centres), bool)
            sides = np.roll(triangle, -1, axis=0) - triangle
            # Two convex shapes are apart when an edge normal of one of them separates them.
            for axis in [(1, 0), (0, 1), *np.stack([-sides[:, 1], sides[:, 0]], axis=1)]:
                axis = np.asarray(axis, float)
                t, s, c = triangle @ axis, square @ axis, self.centres @ axis
                apart |= (c + s.max() < t.min()) | (c + s.min() > t.max())
            hit |= ~apart
        return hit


def nearest_point(points, triangle):
    """Barycentric weights and distance of a triangle's nearest point, and the depth inside."""
    best = np.full(len(points), np.inf)
    weights = np.zeros((len(points), 3))
    for k in range(3):
        a, b = triangle[k], triangle[(k + 1) % 3]
        length2 = (b - a) @ (b - a)
        s = np.clip((points - a) @ (b - a) / length2, 0, 1) if length2 > 0 else 0 * points[:, 0]
        d = np.linalg.norm(points - a - s[:, None] * (b - a), axis=1)
        nearer = d < best
        best = np.where(nearer, d, best)
        edge = np.zeros((len(points), 3))
        edge[:, k], edge[:, (k + 1) % 3] = 1 - s, s
        weights[nearer] = edge[nearer]
    a, b, c = triangle
    area = (b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0]
    depth = np.zeros(len(points))
    if area != 0:
        w = np.empty((len(points), 3))
        for k in range(3):
            p, q = triangle[(k + 1) % 3] - points, triangle[(k + 2) % 3] - points
            w[:, k] = (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]) / area
        inside = (w >= 0).all(axis=1)
        weights[inside] = w[inside]
        depth = np.where(inside, best, 0)
        best = np.where(inside, 0, best)
    return weights, best, depth
