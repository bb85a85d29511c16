# SPDX-License-Identifier: Apache-2.0
"""Large and bad input, and a file system that fails in the middle of a sequence."""

import json
import os
import shutil
import subprocess
import sys

import ltmd
import meshes
import numpy as np
import pytest
from tolerance import assert_close

HERE = os.path.dirname(__file__)


def child(code, *arguments, **environment):
    """The output of a Python that runs `code` beside these tests."""
    done = subprocess.run(
        [sys.executable, "-c", code, *map(str, arguments)],
        capture_output=True,
        text=True,
        cwd=HERE,
        env=dict(os.environ, **environment),
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


TEN_MILLION = """
import json, time
import numpy as np
import ltmd
from meshes import grid

def status(key):
    return 1024 * int(next(s for s in open("/proc/self/status") if s.startswith(key)).split()[1])

def reset_peak():
    open("/proc/self/clear_refs", "w").write("5")

side = 2237
line = np.arange(side + 1, dtype=np.int32)
i, j = np.meshgrid(line, line, indexing="ij")
positions = np.stack([j / side, i / side, 0 * i], -1).reshape(-1, 3).astype(np.float32)
corner_uv = np.ascontiguousarray(positions[:, :2])
first = (i[:-1, :-1] * (side + 1) + j[:-1, :-1]).reshape(-1, 1)
quad = np.concatenate([first, first + 1, first + side + 2, first + side + 1], axis=1)
triangles = np.ascontiguousarray(quad[:, [0, 1, 2, 0, 2, 3]].reshape(-1, 3))
corner_vert = np.arange(len(positions), dtype=np.int32)
deformed = positions * np.float32([2, 0.5, 1])
del i, j, first, quad
mesh = ltmd.Mesh(triangles, corner_vert, corner_uv, len(positions))
layout = sum(a.nbytes for a in (triangles, corner_vert, corner_uv))
arrays = layout + positions.nbytes
result = {"triangles": len(triangles)}

def measure(name, arrays, texels, call):
    reset_peak()
    before, start = status("VmRSS"), time.perf_counter()
    out = call()
    seconds, taken = time.perf_counter() - start, status("VmHWM") - before - 12 * texels
    result[name] = {"seconds": seconds, "bytes": taken, "factor": taken / arrays}
    return out

rest = measure("rest", arrays, 0, lambda: ltmd.RestState(mesh, positions))
t = measure("tension", arrays, 0, lambda: ltmd.tension(mesh, rest, deformed))
size = 1024
coverage = measure("coverage", layout, size**2, lambda: ltmd.TexelCoverage(mesh, size, size))
result["error"] = float(np.abs(t - (2, 0, 0.5)).max())
result["shape"] = t.shape
result["covered"] = coverage.covered
pixels = coverage.bake(t)
result["baked"] = float(np.abs(pixels - (2, 0, 0.5)).max())
report = rest.report
result["report"] = [report.degenerate_triangles, report.mirrored_triangles, report.seam_vertices]
print(json.dumps(result))
"""


@pytest.mark.slow
def test_ten_million_triangles(capsys):
    """The memory of each step is bounded by the arrays it is given; the times are only shown."""
    found = json.loads(child(TEN_MILLION))
    with capsys.disabled():
        for step in ("rest", "tension", "coverage"):
            print(f"\n10 million triangles, {step}: {found[step]['seconds']:.2f} s, ", end="")
            print(f"{found[step]['bytes'] / 1e6:.0f} MB", end=" ")
            print(f"= {found[step]['factor']:.1f} x what it is made of", end="")
    assert found["triangles"] >= 10_000_000
    assert found["error"] < 1e-3 and found["baked"] < 1e-3  # float32 positions of small faces
    assert found["covered"] == 1024**2
    assert found["report"] == [0, 0, 0]
    # Beside the texels, bytes per byte of the arrays given: of the coverage without the positions.
    assert found["coverage"]["factor"] < 3
    assert found["rest"]["factor"] < 3
    assert found["tension"]["factor"] < 1.4


def tiled(columns, rows):
    """A bent sheet whose quads lie on columns x rows tiles, every other one with mirrored UVs."""
    sheet = meshes.grid(4 * columns, 4 * rows)
    uv = sheet.corner_uv[sheet.triangles].astype(float) * (columns, rows)
    tile = np.floor(uv.mean(axis=1))
    local = 0.1 + 0.8 * (uv - tile[:, None])
    odd = (tile.sum(axis=1) % 2 == 1)[:, None]
    local[..., 0] = np.where(odd, 1 - local[..., 0], local[..., 0])
    corners = np.arange(3 * len(sheet.triangles))
    verts = sheet.corner_vert[sheet.triangles].ravel()
    shape = meshes.make(corners, verts, local + tile[:, None], sheet.positions)
    return shape, tile.astype(int), odd[:, 0]


def test_sixteen_tiles_half_of_them_mirrored(tmp_path):
    shape, tile, odd = tiled(4, 4)
    matrix = np.array([(1.5, 0.4), (0, 0.7), (0.3, 0.2)])
    deformed = (shape.positions[:, :2] @ matrix.T).astype(np.float32)
    mesh = shape.mesh()
    rest = shape.rest(mesh)
    assert mesh.tiles == [(u, v) for v in range(4) for u in range(4)]
    assert rest.report.mirrored_triangles == odd.sum() == len(odd) // 2
    assert rest.report.overlap_fraction == 0
    # The same affine map everywhere, and turning x and y over changes no number of T.
    q, r = np.linalg.qr(matrix)
    r *= np.sign(np.diag(r))[:, None]
    expected = np.array([r[0, 0], r[0, 1], r[1, 1]])
    t = ltmd.tension(mesh, rest, deformed)
    assert_close(t, np.tile(expected, (len(t), 1)), factor=1000)
    for u, v in mesh.tiles:
        name = f"sheet_tension.{ltmd.udim((u, v))}.0001.exr"
        with ltmd.SequenceBaker(mesh, rest, 32, 32, tile=(u, v), margin=2) as baker:
            baker.frame(deformed, {"tension": tmp_path / name}, metadata={"ltmd:frame": 1})
        assert ltmd.exr_metadata(tmp_path / name)["ltmd:udim"] == str(1001 + u + 10 * v)
        pixels = ltmd.read_exr(tmp_path / name)[..., :3].copy()
        is_identity = (pixels == (1, 0, 1)).all(axis=2)
        assert_close(pixels[~is_identity], np.tile(expected, ((~is_identity).sum(), 1)), 1000)
        # 0.8 of the tile and two texels of margin on each side.
        assert abs((~is_identity).sum() - (0.8 * 32 + 4) ** 2) < 60
        # A tile holds what its own faces alone would bake in the tile 1001.
        own = (tile == (u, v)).all(axis=1)
        alone = shape.with_(
            triangles=shape.triangles[own],
            corner_uv=np.ascontiguousarray(shape.corner_uv - np.float32([u, v])),
        )
        expected_pixels = ltmd.bake(alone.mesh(), t, 32, 32, margin=2)
        assert_close(pixels.reshape(-1, 3), expected_pixels.reshape(-1, 3), 1000)
    report = ltmd.verify(tmp_path)
    assert report.ok and len(report.sequences) == 16


def test_a_mirror_line_is_not_averaged():
    """Slanted UVs mirrored at x = 0: the frames of both sides lean apart, t12 changes its sign."""
    shape = meshes.mirrored(4, 4)
    uv = shape.corner_uv + np.float32([0, 0.5]) * shape.corner_uv[:, :1]
    shape = shape.with_(corner_uv=np.ascontiguousarray(uv))
    deformed = shape.positions * np.float32([2, 1, 1])
    faces = shape.tension(deformed, per="triangle")
    corners = shape.tension(deformed)[shape.triangles]
    for k in range(3):
        assert_close(corners[:, k], faces)
    x = shape.positions[shape.corner_vert, 0][shape.triangles].mean(axis=1)
    assert (faces[:, 1] * np.sign(x) * np.sign(faces[0, 1] * x[0]) > 0.3).all()


@pytest.mark.parametrize(("width", "is_reported"), [(0.0005, False), (0.002, True)])
def test_overlap_of_a_thousandth_is_seen(width, is_reported):
    """Two charts side by side that share a strip of the given part of the covered area."""
    quad = np.array([(0, 0), (1, 0), (1, 1), (0, 1)], float)
    # The strip holds whole columns of the 1024 texels at which overlap is measured.
    strip = round(width * 1024) / 1024 or 1 / 2048
    uv = np.concatenate([quad * (0.5, 1), quad * (0.5, 1) + (0.5 - strip, 0)])
    positions = np.c_[np.concatenate([quad, quad + (2, 0)]), np.zeros(8)]
    triangles = [(0, 1, 2), (0, 2, 3), (4, 5, 6), (4, 6, 7)]
    shape = meshes.make(triangles, np.arange(8), uv, positions)
    overlap = shape.rest().report.overlap_fraction
    assert (overlap > 0.001) == is_reported, overlap
    assert abs(overlap - strip) < 1e-3


FAILING = r"""
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

/* The disk is full after so many bytes in regular files, or writing waits until a file exists. */
static long left;
__attribute__((constructor)) static void start(void) {
    const char *text = getenv("DISK_BYTES");
    left = text ? atol(text) : 1L << 60;
}
static int room(int fd, size_t size) {
    struct stat info;
    if (fd < 3 || fstat(fd, &info) || !S_ISREG(info.st_mode)) return 1;
    const char *wanted = getenv("WRITES_WAIT_FOR");
    while (wanted && access(wanted, F_OK)) usleep(1000);
    return __atomic_sub_fetch(&left, (long)size, __ATOMIC_SEQ_CST) >= 0;
}
ssize_t write(int fd, const void *data, size_t size) {
    ssize_t (*next)(int, const void *, size_t) = dlsym(RTLD_NEXT, "write");
    if (!room(fd, size)) { errno = ENOSPC; return -1; }
    return next(fd, data, size);
}
ssize_t writev(int fd, const struct iovec *parts, int count) {
    ssize_t (*next)(int, const struct iovec *, int) = dlsym(RTLD_NEXT, "writev");
    size_t size = 0;
    for (int i = 0; i < count; ++i) size += parts[i].iov_len;
    if (!room(fd, size)) { errno = ENOSPC; return -1; }
    return next(fd, parts, count);
}
int rename(const char *from, const char *to) {
    int (*next)(const char *, const char *) = dlsym(RTLD_NEXT, "rename");
    const char *name = getenv("RENAME_FAILS");
    if (name && strstr(to, name)) { errno = EACCES; return -1; }
    return next(from, to);
}
"""

SEQUENCE = """
import sys
import ltmd, meshes
shape = meshes.sphere(12, 8)
mesh = shape.mesh()
baker = ltmd.SequenceBaker(mesh, shape.rest(mesh), 64, 64, compression="none")
try:
    for frame in range(1, 9):
        baker.frame(shape.positions, {"tension": f"{sys.argv[1]}/ball_tension.{frame:04d}.exr"})
    baker.finish()
except OSError as error:
    print("refused:", error)
"""


@pytest.fixture(scope="session")
def failing_files(tmp_path_factory):
    """A library for LD_PRELOAD with a full disk and a failing rename."""
    folder = tmp_path_factory.mktemp("failing")
    (folder / "failing.c").write_text(FAILING)
    compiler = shutil.which("gcc") or shutil.which("cc")
    library = str(folder / "failing.so")
    source = str(folder / "failing.c")
    subprocess.run([compiler, "-shared", "-fPIC", source, "-o", library, "-ldl"], check=True)
    return library


def frames_in(folder):
    return sorted(os.listdir(folder))


FRAME_BYTES = 64 * 64 * 16


def test_a_disk_that_fills_up_in_the_middle_of_a_sequence(failing_files, tmp_path):
    old = tmp_path / "ball_tension.0008.exr"
    ltmd.write_exr(old, np.ones((4, 4, 3), np.float32))
    before = old.read_bytes()
    room = str(int(3.5 * FRAME_BYTES))
    out = child(SEQUENCE, tmp_path, LD_PRELOAD=failing_files, DISK_BYTES=room)
    assert "refused:" in out and "No space left" in out
    assert str(tmp_path / "ball_tension.000") in out
    # Whole files only, of the frames before the disk was full; what was there is still there.
    found = frames_in(tmp_path)
    assert 2 <= len(found) <= 4 and found[-1] == old.name and old.read_bytes() == before
    for name in found[:-1]:
        assert ltmd.read_exr(tmp_path / name).shape == (64, 64, 4)


def test_a_rename_that_fails(failing_files, tmp_path):
    old = tmp_path / "ball_tension.0003.exr"
    ltmd.write_exr(old, np.ones((4, 4, 3), np.float32))
    before = old.read_bytes()
    out = child(SEQUENCE, tmp_path, LD_PRELOAD=failing_files, RENAME_FAILS="0003")
    assert f"refused: {old}" in out and "could not be put in place" in out
    assert old.read_bytes() == before
    assert not [name for name in frames_in(tmp_path) if not name.startswith("ball_tension.")]
    for name in set(frames_in(tmp_path)) - {old.name}:
        assert ltmd.read_exr(tmp_path / name).shape == (64, 64, 4)


FORGOTTEN = """
import os, sys, threading, time
import ltmd, meshes
folder, wanted = sys.argv[1:]
shape = meshes.sphere(12, 8)
mesh = shape.mesh()
baker = ltmd.SequenceBaker(mesh, shape.rest(mesh), 64, 64)
baker.frame(shape.positions, {"tension": f"{folder}/ball_tension.0001.exr"})
while not os.listdir(folder):
    time.sleep(0.001)
threading.Timer(0.2, lambda: open(wanted, "w").close()).start()
del mesh, shape
del baker
print("waited", os.path.exists(wanted), os.listdir(folder))
"""


def test_a_forgotten_baker_lets_other_threads_run(failing_files, tmp_path):
    """Its end waits for a file that only another Python thread can let go on."""
    folder, wanted = tmp_path / "out", tmp_path / "go on"
    folder.mkdir()
    out = child(FORGOTTEN, folder, wanted, LD_PRELOAD=failing_files, WRITES_WAIT_FOR=str(wanted))
    assert out == "waited True ['ball_tension.0001.exr']\n"


@pytest.mark.parametrize("call", ["write_exr", "verify", "read_exr"])
def test_the_error_names_the_path(call, tmp_path):
    path = tmp_path / "no such folder" / "ball_tension.0001.exr"
    arguments = {"write_exr": (path, np.ones((2, 2, 3), np.float32))}.get(call, (path,))
    with pytest.raises(OSError, match="no such folder"):
        getattr(ltmd, call)(*arguments)
