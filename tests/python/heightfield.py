# SPDX-License-Identifier: Apache-2.0
"""A microsurface as triangles, whose masking is measured by casting rays: the judge of figure 11 of
masking-shadowing. It knows nothing of microfacet models.

Heights are a periodic Gaussian random field on a grid, so slopes are Beckmann's. M maps the grid's
vertices q to (M q, h), and with them triangles, normals and all that rays meet.
"""

import numba
import numpy as np


def gaussian_heights(rng, size, correlation, alpha):
    """float[size, size]: heights with the autocorrelation exp(-r^2 / correlation^2), one unit
    between neighbours, whose facets have the mean squared slope alpha^2 of Beckmann's
    distribution."""
    k = np.fft.fftfreq(size) * 2 * np.pi
    spectrum = np.fft.fft2(rng.normal(size=(size, size)))
    spectrum *= np.exp(-(k[:, None] ** 2 + k**2) * correlation**2 / 8)
    h = np.fft.ifft2(spectrum).real
    # Both triangles of a cell have a side along either axis.
    along_x, along_y = np.roll(h, -1, axis=0) - h, np.roll(h, -1, axis=1) - h
    return h * alpha / np.sqrt(np.mean(along_x**2) + np.mean(along_y**2))


@numba.njit
def first_triangles(h, M, inverse, origins, v, own):
    """int[rays, 3]: the first triangle (i, j, half) that each ray meets, its own left out; half is
    -1 for a ray that meets none. Half 0 of a cell is below its diagonal from (1, 0) to (0, 1)."""
    n = h.shape[0]
    low, high = h.min(), h.max()
    found = np.full((len(origins), 3), -1)
    # The grid's cells along the ray.
    dx = inverse[0, 0] * v[0] + inverse[0, 1] * v[1]
    dy = inverse[1, 0] * v[0] + inverse[1, 1] * v[1]
    for r in range(len(origins)):
        ox, oy, oz = origins[r, 0], origins[r, 1], origins[r, 2]
        x = inverse[0, 0] * ox + inverse[0, 1] * oy
        y = inverse[1, 0] * ox + inverse[1, 1] * oy
        i, j = int(np.floor(x)), int(np.floor(y))
        next_x = ((i + (dx > 0)) - x) / dx if dx != 0 else np.inf
        next_y = ((j + (dy > 0)) - y) / dy if dy != 0 else np.inf
        t = 0.0
        while low <= oz + t * v[2] <= high:
            end = min(next_x, next_y)
            a, b = h[i % n, j % n], h[(i + 1) % n, j % n]
            c, d = h[i % n, (j + 1) % n], h[(i + 1) % n, (j + 1) % n]
            if min(oz + t * v[2], oz + end * v[2]) <= max(max(a, b), max(c, d)):
                nearest = np.inf
                for half in range(2):
                    if i == own[r, 0] and j == own[r, 1] and half == own[r, 2]:
                        continue
                    # The corner and two edges from it; then Moeller and Trumbore's test.
                    side = 1 - 2 * half
                    corner = a if half == 0 else d
                    px = M[0, 0] * (i + half) + M[0, 1] * (j + half) - ox
                    py = M[1, 0] * (i + half) + M[1, 1] * (j + half) - oy
                    pz = corner - oz
                    ex, ey = side * M[0, 0], side * M[1, 0]
                    fx, fy = side * M[0, 1], side * M[1, 1]
                    ez = (b if half == 0 else c) - corner
                    fz = (c if half == 0 else b) - corner
                    qx = v[1] * fz - v[2] * fy
                    qy = v[2] * fx - v[0] * fz
                    qz = v[0] * fy - v[1] * fx
                    determinant = ex * qx + ey * qy + ez * qz
                    if determinant == 0:
                        continue
                    s = -(px * qx + py * qy + pz * qz) / determinant
                    wx, wy, wz = ey * pz - ez * py, ez * px - ex * pz, ex * py - ey * px
                    u = (v[0] * wx + v[1] * wy + v[2] * wz) / determinant
                    distance = (fx * wx + fy * wy + fz * wz) / determinant
                    if s >= 0 and u >= 0 and s + u <= 1 and 0 < distance < nearest:
                        nearest = distance
                        found[r, 0], found[r, 1], found[r, 2] = i, j, half
                if nearest < np.inf:
                    break
            t = end
            if next_x < next_y:
                next_x += abs(1 / dx)
                i += 1 if dx > 0 else -1
            else:
                next_y += abs(1 / dy)
                j += 1 if dy > 0 else -1
    return found


class Heightfield:
    def __init__(self, heights, M=None):
        self.heights = heights
        self.M = np.eye(2) if M is None else np.asarray(M, dtype=np.float64)
        self.inverse = np.linalg.inv(self.M)

    def vertices(self, i, j):
        n = len(self.heights)
        h = self.heights[i % n, j % n]
        return np.concatenate([np.stack([i, j], axis=-1) @ self.M.T, h[..., None]], axis=-1)

    def triangles(self, index):
        """A corner and the two edges from it, float[n, 3] each."""
        i, j, half = index.T
        corner = self.vertices(i + half, j + half)
        e = self.vertices(i + 1 - half, j + half) - corner
        f = self.vertices(i + half, j + 1 - half) - corner
        return corner, e, f

    def normals(self, index):
        _, e, f = self.triangles(index)
        m = np.cross(e, f)
        m *= np.sign(m[:, 2:])
        return m / np.linalg.norm(m, axis=1, keepdims=True)

    def first(self, origins, v, own):
        v = np.ascontiguousarray(v, dtype=np.float64)
        return first_triangles(self.heights, self.M, self.inverse, origins, v, own)

    def visible_normals(self, rng, v, count):
        """The normals that `count` parallel rays meet, spread uniformly over what v sees."""
        places = rng.random((count, 2)) * len(self.heights)
        top = np.full((count, 1), self.heights.max())
        origins = np.concatenate([places @ self.M.T, top], axis=1)
        return self.normals(self.first(origins, -v, np.full((count, 3), -1)))

    def points(self, rng, count):
        """Points spread uniformly over the macrosurface, and the triangles they lie on."""
        places = rng.random((count, 2)) * len(self.heights)
        cell = places.astype(np.int64)
        part = places - cell
        half = (part.sum(axis=1) > 1).astype(np.int64)
        index = np.concatenate([cell, half[:, None]], axis=1)
        corner, e, f = self.triangles(index)
        part = np.where(half[:, None] == 1, 1 - part, part)
        return corner + part[:, :1] * e + part[:, 1:] * f, index

    def visible(self, points, index, v):
        """bool[n]: which points of triangles that face v it sees, from its side of the surface."""
        seen = self.normals(index) @ v * np.sign(v[2]) > 0
        seen[seen] = self.first(points[seen], v, index[seen])[:, 2] < 0
        return seen
