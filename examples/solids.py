# SPDX-License-Identifier: Apache-2.0
"""Meshes from signed distances (positive outside), blended smoothly, and from smooth outlines."""

import numpy as np


def dot(a, b):
    return np.sum(a * b, axis=-1)


def ellipsoid(p, centre, radii, tilt=0.0, lean=0.0):
    """An ellipsoid turned by tilt about y, then by lean about x (radians)."""
    q = p - centre
    c, s = np.cos(lean), np.sin(lean)
    q = np.stack([q[..., 0], c * q[..., 1] + s * q[..., 2], c * q[..., 2] - s * q[..., 1]], -1)
    c, s = np.cos(tilt), np.sin(tilt)
    q = np.stack([c * q[..., 0] - s * q[..., 2], q[..., 1], s * q[..., 0] + c * q[..., 2]], -1)
    # The distance is exact only for a sphere, but 0 and smooth at the surface.
    near = np.linalg.norm(q / radii, axis=-1)
    slope = np.linalg.norm(q / np.square(radii), axis=-1)
    return near * (near - 1) / np.maximum(slope, 1e-9)


def capsule(p, start, end, r_start, r_end):
    """A rod between two balls."""
    start, end = np.asarray(start, float), np.asarray(end, float)
    along = end - start
    t = np.clip(dot(p - start, along) / dot(along, along), 0, 1)
    return np.linalg.norm(p - start - t[..., None] * along, axis=-1) - (
        r_start + t * (r_end - r_start)
    )


def blend(a, b, width):
    """The union, filled smoothly over the width where the two meet."""
    h = np.clip(0.5 + 0.5 * (b - a) / width, 0, 1)
    return b + h * (a - b) - width * h * (1 - h)


def mesh(name, distance, low, high, step):
    """The surface where distance(points) is 0, as a mesh of quads; its vertices."""
    import bpy
    import openvdb

    axes = [np.arange(a, b, step) for a, b in zip(low, high, strict=True)]
    # Slice by slice: the whole grid's temporaries would not fit the cache.
    values = [distance(np.stack(np.meshgrid(x, *axes[1:], indexing="ij"), -1)[0]) for x in axes[0]]
    values = np.array(values, np.float32)
    grid = openvdb.FloatGrid(background=10.0)
    grid.copyFromArray(values)
    points, quads = grid.convertToQuads()
    points = points * step + np.asarray(low)
    # Towards the surface itself: the grid's cells would show in highlights.
    for _ in range(3):
        value = distance(points)
        slope = np.stack(
            [distance(points + d) - distance(points - d) for d in 0.5 * step * np.eye(3)], axis=-1
        )
        slope /= step
        points -= (value / np.maximum(dot(slope, slope), 0.25))[:, None] * slope
    made = bpy.data.meshes.new(name)
    made.from_pydata(points.tolist(), [], quads.tolist())
    made.shade_smooth()
    return made, points


def smooth_curve(points, count, before=None):
    """count points at equal distances on the centripetal Catmull-Rom curve through the points.

    before: the point before the first one, which sets the direction there.
    """
    points = np.asarray(points, float)
    first = 2 * points[0] - points[1] if before is None else before
    points = np.vstack([first, points, 2 * points[-1] - points[-2]])
    knots = np.r_[0, np.cumsum(np.sqrt(np.linalg.norm(np.diff(points, axis=0), axis=1)))]
    curve = []
    for i in range(1, len(points) - 2):
        level, t = points[i - 1 : i + 3], knots[i - 1 : i + 3]
        s = np.linspace(t[1], t[2], 200, endpoint=False)[:, None]
        level = [
            level[k] + (s - t[k]) / (t[k + 1] - t[k]) * (level[k + 1] - level[k]) for k in range(3)
        ]
        level = [
            level[k] + (s - t[k]) / (t[k + 2] - t[k]) * (level[k + 1] - level[k]) for k in range(2)
        ]
        curve.append(level[0] + (s - t[1]) / (t[2] - t[1]) * (level[1] - level[0]))
    curve = np.vstack([*curve, points[-2:-1]])
    length = np.r_[0, np.cumsum(np.linalg.norm(np.diff(curve, axis=0), axis=1))]
    return np.stack(
        [np.interp(np.linspace(0, length[-1], count), length, c) for c in curve.T], axis=1
    )


def turned(name, outline, segments):
    """The outline (radius, height) turned about z; u runs around it from the back, v along it."""
    import bpy

    rings = len(outline)
    turn = np.linspace(0, 1, segments + 1)
    angle = (turn[:-1] + 0.25) * 2 * np.pi
    around = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    positions = [np.c_[radius * around, np.full(segments, height)] for radius, height in outline]
    ring, segment = np.meshgrid(np.arange(rings - 1), np.arange(segments), indexing="ij")
    steps = [(0, 0), (0, 1), (1, 1), (1, 0)]
    faces = [(ring + r) * segments + (segment + s) % segments for r, s in steps]
    uv = [np.stack([(segment + s) / segments, (ring + r) / (rings - 1)], -1) for r, s in steps]
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(np.vstack(positions).tolist(), [], np.stack(faces, -1).reshape(-1, 4).tolist())
    layer = mesh.uv_layers.new(name="UVMap").uv
    layer.foreach_set("vector", np.stack(uv, -2).astype(np.float32).ravel())
    mesh.shade_smooth()
    return mesh
