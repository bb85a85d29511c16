# SPDX-License-Identifier: Apache-2.0
"""Makes the sample files of contract.md and expected.json, what a right reader gets from them.

    python make.py [FOLDER]

The files come from the library; the expected numbers come from float64 NumPy and the deformations
themselves: for an affine deformation T is known exactly.
"""

import json
import pathlib
import sys

import ltmd
import numpy as np

SIZE = 32
MARGIN = 4
# Rest corners of a chart (a parallelogram in the plane z = 0), its UVs, and the 3x2 matrix that
# deforms it. Lower left, lower right, upper left, upper right quarter of the texture.
SQUARE = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
ROOM = 5 / SIZE  # around each chart's UVs
CHARTS = {
    "stretched twice along U, squeezed to a half along V": (
        SQUARE, [(2, 0), (0, 0.5), (0, 0)]
    ),
    "sheared and turned out of the plane": (
        SQUARE, [(1, 0.75), (0, 0.6), (0.2, 0.8)]
    ),
    "mirrored UVs": (
        SQUARE * (-1, 1), [(1.25, -0.5), (0.25, 0.75), (0, 0)]
    ),
    "UVs turned by 30 degrees, squeezed to a fifth": (
        SQUARE @ [(np.sqrt(3) / 2, -0.5), (0.5, np.sqrt(3) / 2)], [(0.2, 0), (0, 1), (0, 0.5)]
    ),
}  # fmt: skip
# Tensions whose numbers are linear in (u, v): reading between texel centres gives them exactly.
GRADIENT = np.array([(0.5, 0.25, 1.0), (1.0, -0.5, 0.25), (0.25, 1.0, 0.5)])  # 1, u, v
LOBES = [  # alpha along U and V, and the material's own M0, by rows
    {"alpha": [0.25, 0.25], "m0": [[1, 0], [0, 1]]},
    {"alpha": [0.1, 0.4], "m0": [[1, 0], [0, 1]]},
    {"alpha": [0.2, 0.2], "m0": [[1.6, -0.375], [0.8, 0.5]]},
]


def chart_uv(quarter):
    """UVs of a chart's corners: a square with room around it, in one quarter of the tile."""
    return (SQUARE * (0.5 - 2 * ROOM) + ROOM) + (0.5 * (quarter % 2), 0.5 * (quarter // 2))


def exact_tension(rest, uv, matrix):
    """T of an affine map of a parallelogram: upper triangular, in frames with x along dP/du."""
    du = np.linalg.solve(
        np.array([uv[1] - uv[0], uv[3] - uv[0]]), [rest[1] - rest[0], rest[3] - rest[0]]
    )[0]
    x = du / np.linalg.norm(du)
    to_rest = np.array([x, (-x[1], x[0])]).T  # frame -> plane; z points at the viewer
    # E = D R^-1 without a deformed frame; its R factor, with a positive diagonal, is T.
    q, r = np.linalg.qr(np.asarray(matrix, float) @ to_rest)
    return r * np.sign(np.diag(r))[:, None]


def lobe(t, alpha, m0):
    """(alpha_x, alpha_y, angle) by eigenvectors of Sigma' = M^-T Sigma M^-1."""
    inverse = np.linalg.inv(np.asarray(t) @ np.asarray(m0, float))
    values, vectors = np.linalg.eigh(inverse.T @ np.diag(np.square(alpha)) @ inverse)
    angle = np.arctan2(vectors[1, 0], vectors[0, 0]) % np.pi
    return [*np.sqrt(values), 0.0 if np.isclose(*values, rtol=1e-6) else angle]


def expected(file, uv, t):
    t = np.asarray(t, float)
    return {
        "file": file,
        "uv": list(uv),
        "tension": [t[0, 0], t[0, 1], t[1, 1]],
        "lobes": [{**case, "lobe": lobe(t, **case)} for case in LOBES],
    }


def passes(t, alpha, m0):
    """R, G, B, A of every pass."""
    inverse = np.linalg.inv(t @ np.asarray(m0, float))
    sigma = inverse.T @ np.diag(np.square(alpha)) @ inverse
    alpha_x, alpha_y, angle = lobe(t, alpha, m0)
    largest, smallest = np.linalg.svd(t, compute_uv=False)
    shear = np.arctan2(t[0, 1], t[1, 1])
    return {
        "tension": [t[0, 0], t[0, 1], t[1, 1], 1],
        "stretch": [largest, smallest, np.linalg.det(t), 1],
        "wrinkle": [t[0, 0], np.hypot(t[0, 1], t[1, 1]), shear, 1],
        "alpha2": [sigma[0, 0], sigma[0, 1], sigma[1, 1], 1],
        "roughness": [alpha_x, alpha_y, np.cos(2 * angle), np.sin(2 * angle)],
    }


def swatches(folder):
    """Four charts in one texture; frame 1 is the rest state, frame 2 deformed."""
    uv = np.concatenate([chart_uv(quarter) for quarter in range(len(CHARTS))])
    rest, moved, triangles, points, texels = [], [], [], [], []
    for quarter, (corners, matrix) in enumerate(CHARTS.values()):
        place = corners + (3 * quarter, 0)
        rest.append(np.c_[place, [0] * 4])
        moved.append(corners @ np.asarray(matrix, float).T + (3 * quarter, 0, 0))
        first = 4 * quarter
        a, b = corners[1] - corners[0], corners[3] - corners[0]
        # Seen from above, whatever the UVs do.
        is_up = a[0] * b[1] - a[1] * b[0] > 0
        faces = [(0, 1, 2), (0, 2, 3)] if is_up else [(0, 2, 1), (0, 3, 2)]
        triangles += [tuple(first + k for k in face) for face in faces]
        t = exact_tension(corners, chart_uv(quarter), matrix)
        low, high = chart_uv(quarter)[0], chart_uv(quarter)[2]
        for s in ((0.5, 0.5), (0.13, 0.71), (0, 0), (1, 0.4)):
            at = low + (high - low) * s
            points += [
                expected("swatches_tension.0001.exr", at, np.eye(2)),
                expected("swatches_tension.0002.exr", at, t),
            ]
            for frame, matrix_t in ((1, np.eye(2)), (2, t)):
                for name, values in passes(matrix_t, **LOBES[-1]).items():
                    file = f"swatches_{name}.{frame:04d}.exr"
                    texels.append({"file": file, "uv": list(at), "values": values})
    rest, moved = (np.concatenate(p).astype(np.float32) for p in (rest, moved))
    mesh = ltmd.Mesh(
        np.array(triangles, np.int32),
        np.arange(len(rest), dtype=np.int32),
        uv.astype(np.float32),
        len(rest),
    )
    metadata = {
        "ltmd:object": "Swatches",
        "ltmd:uv_map": "UVMap",
        "ltmd:rest": "frame:1",
        "ltmd:frame_start": 1,
        "ltmd:frame_end": 2,
        "ltmd:margin": MARGIN,
    }
    names = list(passes(np.eye(2), **LOBES[-1]))
    with ltmd.SequenceBaker(
        mesh,
        rest,
        SIZE,
        SIZE,
        names,
        margin=MARGIN,
        metadata=metadata,
        alpha=LOBES[-1]["alpha"],
        M0=LOBES[-1]["m0"],
    ) as baker:
        for frame, positions in ((1, rest), (2, moved)):
            paths = {name: folder / f"swatches_{name}.{frame:04d}.exr" for name in names}
            baker.frame(positions, paths, metadata={"ltmd:frame": frame})
    return points, texels


def gradient(folder):
    """A tension that is linear in UV, over two UDIM tiles."""
    uv = SQUARE * (2, 1)
    values = (np.c_[np.ones(4), uv] @ GRADIENT).astype(np.float32)
    mesh = ltmd.Mesh(
        np.array([(0, 1, 2), (0, 2, 3)], np.int32),
        np.arange(4, dtype=np.int32),
        uv.astype(np.float32),
        4,
    )
    points = []
    for tile in (0, 1):
        name = f"gradient_tension.{1001 + tile}.0001.exr"
        pixels = ltmd.bake(mesh, values, SIZE, SIZE, tile=(tile, 0), margin=MARGIN)
        ltmd.write_exr(
            folder / name,
            pixels,
            metadata={
                "ltmd:convention": ltmd.convention,
                "ltmd:pass": "tension",
                "ltmd:object": "Gradient",
                "ltmd:uv_map": "UVMap",
                "ltmd:frame": 1,
                "ltmd:udim": 1001 + tile,
                "ltmd:per": "corner",
                "ltmd:version": ltmd.__version__,
                "ltmd:margin": MARGIN,
            },
        )
        for at in ((0.3, 0.2), (0.515, 0.77), (0.9, 0.55)):
            t11, t12, t22 = np.array([1, at[0] + tile, at[1]]) @ GRADIENT
            points.append(expected(name, (at[0] + tile, at[1]), [[t11, t12], [0, t22]]))
    return points


def main(folder):
    folder = pathlib.Path(folder)
    points, texels = swatches(folder)
    points += gradient(folder)
    lines = [",\n".join(json.dumps(entry) for entry in entries) for entries in (points, texels)]
    (folder / "expected.json").write_text(
        f'{{"convention": {ltmd.convention}, "points": [\n{lines[0]}\n], '
        f'"passes": [\n{lines[1]}\n]}}\n'
    )


if __name__ == "__main__":
    main(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent)
