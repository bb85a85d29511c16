# SPDX-License-Identifier: Apache-2.0
"""The command ltmd, from OBJ files to EXR files, against the Python package and the model."""

import dataclasses
import os
import pathlib
import re
import signal
import subprocess
import time

import ltmd
import meshes
import model
import numpy as np
import OpenEXR
import pytest
from test_bake import assert_bake
from tolerance import assert_same_bits

COMMAND = pathlib.Path(
    os.environ.get("LTMD_COMMAND")
    or pathlib.Path(__file__).resolve().parents[2] / "build/release/ltmd"
)
DONE, PROBLEMS, USAGE, BAD_INPUT, WRITE_FAILED, INTERRUPTED = 0, 1, 2, 3, 4, 130


def run(*arguments, code=DONE):
    if not COMMAND.is_file():
        pytest.fail(
            f"there is no {COMMAND}: build it with 'tests/run.sh environment cpp' (it needs CLI11 "
            "and tinyobjloader), or set LTMD_COMMAND"
        )
    done = subprocess.run(
        [COMMAND, *map(str, arguments)], capture_output=True, text=True, timeout=120
    )
    assert done.returncode == code, (done.returncode, done.stdout, done.stderr)
    return done


@dataclasses.dataclass
class Polygons:
    """A mesh as OBJ has it: faces are lists of (vertex, uv) indices."""

    positions: np.ndarray
    uvs: np.ndarray
    faces: list

    def write(self, path, positions=None, with_uv=True):
        lines = ["mtllib missing.mtl", "o first"]
        lines += [
            "v {} {} {}".format(*p) for p in (self.positions if positions is None else positions)
        ]
        if with_uv:
            lines += ["vt {} {}".format(*uv) for uv in self.uvs]
        for i, face in enumerate(self.faces):
            if i == len(self.faces) // 2:
                lines.append("g second")
            corners = [f"{v + 1}/{t + 1}" if with_uv else f"{v + 1}" for v, t in face]
            lines.append("f " + " ".join(corners))
        path.write_text("\n".join(lines) + "\n")
        return path

    def shape(self, cuts):
        """Cut into triangles: `cuts` gives the corners of each triangle of a face."""
        corners = [face[k] for face in self.faces for cut in cuts(self, face) for k in cut]
        vert, uv = np.array(corners).T
        return meshes.make(np.arange(len(corners)), vert, self.uvs[uv], self.positions)


def by_shorter_diagonal(mesh, face):
    if len(face) == 3:
        return [(0, 1, 2)]
    p = mesh.positions[[v for v, _ in face]].astype(float)
    if np.linalg.norm(p[2] - p[0]) < np.linalg.norm(p[3] - p[1]):
        return [(0, 1, 2), (0, 2, 3)]
    return [(0, 1, 3), (1, 2, 3)]


def quads(columns, rows, wrap=False, tiles=1, bend=0.0):
    """A grid or a tube with a seam, its UVs spread over tiles side by side, clear of borders."""
    grid = meshes.grid(columns, rows, wrap)
    rng = np.random.default_rng(3)
    noise = rng.normal(0, bend, grid.positions.shape) if bend else 0
    positions = (grid.positions + noise).astype(np.float32)
    uv = grid.corner_uv.reshape(-1, 4, 2).astype(float)
    tile = np.floor(uv.mean(axis=1)[:, :1] * tiles)
    uv[..., 0] = tile + 0.1 + 0.8 * (uv[..., 0] * tiles - tile)
    uv[..., 1] = 0.1 + 0.8 * uv[..., 1]
    verts = grid.corner_vert.reshape(-1, 4)
    faces = [[(int(v), 4 * f + k) for k, v in enumerate(vs)] for f, vs in enumerate(verts)]
    return Polygons(positions, uv.reshape(-1, 2).astype(np.float32), faces)


def twisted(mesh):
    return meshes.twisted(meshes.make([], [], None, mesh.positions))


def pixels(path):
    """As another program reads them."""
    with OpenEXR.File(str(path)) as file:
        channels = file.channels()
        (picture,) = [c.pixels for c in channels.values()]
        return picture


def tension_of(shape, deformed, per="corner"):
    return model.tension(*shape.topology, len(shape.positions), shape.positions, deformed, per=per)


@pytest.fixture
def tube(tmp_path):
    mesh = quads(9, 6, wrap=True, tiles=3)
    deformed = twisted(mesh)
    mesh.write(tmp_path / "rest.obj")
    mesh.write(tmp_path / "face.0007.obj", deformed)
    return mesh, deformed


def test_quads_a_seam_and_three_tiles_against_the_model(tmp_path, tube):
    mesh, deformed = tube
    out = tmp_path / "out/tube_<pass>.<UDIM>.<frame>.exr"
    names = ("rest.obj", "face.0007.obj")
    done = run(
        "tension", *(tmp_path / n for n in names), "-o", out, "--size", "48x32", "--margin", 3
    )
    assert "face.0007.obj, tile 1003 (3 of 3)" in done.stderr
    assert done.stdout == ""
    shape = mesh.shape(by_shorter_diagonal)
    t = tension_of(shape, deformed)
    for tile in range(3):
        picture = pixels(tmp_path / f"out/tube_tension.{1001 + tile}.0007.exr")
        assert picture.shape == (32, 48, 4) and (picture[..., 3] == 1).all()
        assert_bake(picture[..., :3], shape, t, (tile, 0), 3)
    assert len(list((tmp_path / "out").iterdir())) == 3
    assert "3 frames" not in run("verify", tmp_path / "out").stdout
    run("verify", tmp_path / "out", "--frames", "7")
    missing = run("verify", tmp_path / "out", "--frames", "7-9", code=PROBLEMS)
    assert "frames 8 to 9 are missing" in missing.stderr


@pytest.mark.parametrize("per", ["corner", "vertex", "triangle"])
def test_same_bits_as_the_python_package(tmp_path, tube, per):
    mesh, deformed = tube
    shape = mesh.shape(by_shorter_diagonal)
    common = [tmp_path / "rest.obj", tmp_path / "face.0007.obj", "--size", 40, "--tile", 1002]
    command = ["tension", *common, "--per", per, "--pass", "tension,stretch", "--threads", 1]
    run(*command, "-o", tmp_path / "a.exr", "-o", tmp_path / "b.exr", "--compression", "none")
    with_python = {name: tmp_path / f"{name}.exr" for name in ("tension", "stretch")}
    prepared = shape.mesh()
    baker = ltmd.SequenceBaker(
        prepared, shape.rest(prepared), 40, 40, list(with_python), tile=(1, 0), per=per
    )
    baker.frame(deformed, with_python)
    baker.finish()
    assert_same_bits(ltmd.read_exr(tmp_path / "a.exr"), ltmd.read_exr(with_python["tension"]))
    assert_same_bits(ltmd.read_exr(tmp_path / "b.exr"), ltmd.read_exr(with_python["stretch"]))
    header = ltmd.exr_metadata(tmp_path / "b.exr")
    assert header["ltmd:pass"] == "stretch" and header["ltmd:per"] == per
    assert header["ltmd:udim"] == "1002" and header["ltmd:object"] == "rest"


@pytest.mark.parametrize("name", ["alpha2", "roughness", "wrinkle"])
def test_passes_of_a_lobe(tmp_path, tube, name):
    mesh, deformed = tube
    shape = mesh.shape(by_shorter_diagonal)
    out, expected = tmp_path / "command.exr", tmp_path / "python.exr"
    lobe = ["--alpha", "0.3,0.2", "--m0=-0.4,0.3,0.1", "--strength", 0.7, "--height-response", 0.5]
    run(
        *("tension", tmp_path / "rest.obj", tmp_path / "face.0007.obj", "-o", out),
        *("--pass", name, *lobe, "--half", "--mantissa-bits", 8, "--tile", 1003),
        *("--size", 24, "--compression", "piz"),
    )
    prepared = shape.mesh()
    options = {"alpha": (0.3, 0.2), "M0": ltmd.material_matrix(-0.4, 0.3, 0.1), "strength": 0.7}
    options |= {"height_response": 0.5, "half": True, "mantissa_bits": 8, "compression": "piz"}
    baker = ltmd.SequenceBaker(
        prepared, shape.rest(prepared), 24, 24, [name], tile=(2, 0), **options
    )
    baker.frame(deformed, {name: expected})
    baker.finish()
    assert_same_bits(ltmd.read_exr(out), ltmd.read_exr(expected))
    keys = ("ltmd:alpha", "ltmd:m0", "ltmd:strength", "ltmd:height_response", "ltmd:mantissa_bits")
    ours, theirs = ltmd.exr_metadata(out), ltmd.exr_metadata(expected)
    assert [ours.get(key) for key in keys] == [theirs.get(key) for key in keys]


def test_quads_are_cut_by_the_rest_state_alone(tmp_path):
    # Sheared so that the other diagonal is the shorter one once deformed.
    mesh = quads(3, 3, bend=0.02)
    deformed = mesh.positions + mesh.positions[:, 1:2] * np.float32([1.5, 0, 0])
    mesh.write(tmp_path / "rest.obj")
    mesh.write(tmp_path / "sheared.obj", deformed)
    out = tmp_path / "out.exr"
    run("tension", tmp_path / "rest.obj", tmp_path / "sheared.obj", "-o", out, "--size", 32)
    shape = mesh.shape(by_shorter_diagonal)
    assert_bake(pixels(out)[..., :3], shape, tension_of(shape, deformed), (0, 0), 16)


def polygon(corners, centre=(0, 0), concave=False):
    angle = 2 * np.pi * np.arange(corners) / corners
    radius = np.where(concave & (np.arange(corners) % 2 == 1), 0.6, 1.0)
    if concave:
        radius *= np.random.default_rng(corners).uniform(0.4, 1, corners)
    plane = radius[:, None] * np.stack([np.cos(angle), np.sin(angle)], 1)
    positions = np.pad(plane + centre, [(0, 0), (0, 1)]).astype(np.float32)
    return Polygons(
        positions, (0.5 + 0.4 * plane).astype(np.float32), [[(i, i) for i in range(corners)]]
    )


@pytest.mark.parametrize("centre", [(0, 0), (10, -7)])
@pytest.mark.parametrize(
    "corners, concave",
    [(4, True), (5, False), (5, True), (6, True), (9, False), (12, True), (300, False)],
)
def test_polygons_are_cut_whole(tmp_path, corners, concave, centre):
    # A plane deformed linearly: however it is cut, T is the same everywhere inside.
    mesh = polygon(corners, centre, concave)
    mesh.write(tmp_path / "rest.obj")
    mesh.write(tmp_path / "wide.obj", mesh.positions * np.float32([2, 0.5, 1]))
    out = tmp_path / "out.exr"
    arguments = ["tension", tmp_path / "rest.obj", tmp_path / "wide.obj", "-o", out]
    run(*arguments, "--size", 64, "--margin", 0)
    picture = pixels(out)
    # Slivers of the 300-gon feel the rounding of its positions.
    measured = np.abs(picture - np.float32([2, 0, 0.5, 1])).max(axis=2) < 0.05
    outline = mesh.uvs * 64
    ahead = np.roll(outline, -1, axis=0)
    area = np.abs(np.sum(outline[:, 0] * ahead[:, 1] - outline[:, 1] * ahead[:, 0])) / 2
    # Every texel that the polygon touches is covered: its area and about half its border more.
    border = np.linalg.norm(ahead - outline, axis=1).sum()
    assert area - 1 < measured.sum() < area + 1.5 * border
    assert measured[32, 32]


def test_several_frames_and_their_numbers(tmp_path):
    mesh = quads(3, 2)
    mesh.write(tmp_path / "rest.obj")
    for frame in (8, 9, 10):
        wide = mesh.positions * np.float32([frame / 8, 1, 1])
        mesh.write(tmp_path / f"take2_{frame}.obj", wide)
    files = [tmp_path / f"take2_{frame}.obj" for frame in (8, 9, 10)]
    out = tmp_path / "out/plane_<pass>.<frame>.exr"
    run("tension", tmp_path / "rest.obj", *files, "-o", out, "--size", 16)
    report = ltmd.verify(tmp_path / "out")
    assert report.ok and report.sequences == {"plane_tension": [8, 9, 10]}
    assert pixels(tmp_path / "out/plane_tension.0010.exr")[8, 8, 0] == pytest.approx(1.25)
    header = ltmd.exr_metadata(tmp_path / "out/plane_tension.0009.exr")
    assert (header["ltmd:frame_start"], header["ltmd:frame_end"]) == ("8", "10")
    other = tmp_path / "other/plane_<pass>.<frame>.exr"
    arguments = ["tension", tmp_path / "rest.obj", *files, "-o", other, "--size", 16]
    run(*arguments, "--frames", "1-5x2")
    assert ltmd.verify(tmp_path / "other", [1, 3, 5]).ok
    run(*arguments, "--frames", "1-2", code=USAGE)


def test_info(tmp_path, tube):
    out = tmp_path / "out.exr"
    common = [tmp_path / "rest.obj", tmp_path / "rest.obj"]
    run("tension", *common, "-o", out, "--tile", 1001, "--size", "16x8", "--quiet")
    text = run("info", out).stdout
    assert "16 x 8" in text and "ltmd:pass = tension" in text
    assert "G: " in text and "A: 1 to 1" in text
    run("info", tmp_path / "none.exr", code=BAD_INPUT)
    run("info", tmp_path / "rest.obj", code=BAD_INPUT)


def test_help_and_version():
    assert run("--version").stdout.strip() == f"ltmd {ltmd.__version__}"
    text = run("--help").stdout
    for command in ("tension", "verify", "info", "convert"):
        assert command in text
        assert run(command, "--help").stdout
    assert "Exit codes" in text


@pytest.mark.parametrize(
    "arguments, said",
    [
        ([], "subcommand"),
        (["tension", "rest.obj"], "required"),
        (["tension", "rest.obj", "face.0007.obj"], "--output"),
        (["tension", "rest.obj", "face.0007.obj", "-o", "x.exr"], "<UDIM>"),
        (["tension", "rest.obj", "face.0007.obj", "-o", "x.exr", "--size", "0"], "65536"),
        (["tension", "rest.obj", "face.0007.obj", "-o", "x.exr", "--size", "8x"], "65536"),
        (["tension", "rest.obj", "face.0007.obj", "-o", "x.exr", "--per", "face"], "per"),
        (["tension", "rest.obj", "face.0007.obj", "-o", "x.exr", "--pass", "nothing"], "pass"),
        (["tension", "rest.obj", "face.0007.obj", "-o", "x.exr", "--margin", "65"], "margin"),
        (
            ["tension", "rest.obj", "face.0007.obj", "-o", "x.exr", "--pass", "tension,stretch"],
            "<pass>",
        ),
        (["tension", "rest.obj", "face.0007.obj", "rest.obj", "-o", "x.exr"], "<frame>"),
        (["tension", "rest.obj", "rest.obj", "-o", "x.<frame>.exr"], "--frames"),
        (
            ["tension", "rest.obj", "face.0007.obj", "-o", "x.<frame>.exr", "--frames", "7-"],
            "1-24",
        ),
        (["tension", "rest.obj", "face.0007.obj", "-o", "x.exr", "--alpha", "0"], "alpha"),
        (["tension", "rest.obj", "face.0007.obj", "-o", "x.exr", "--m0", "1,0,0"], "stretch"),
        (["verify"], "DIR"),
        (["verify", ".", "--frames", "3,3"], "twice"),
    ],
)
def test_wrong_arguments(tmp_path, monkeypatch, tube, arguments, said):
    monkeypatch.chdir(tmp_path)
    assert said in run(*arguments, code=USAGE).stderr
    assert not list(tmp_path.glob("*.exr"))


def changed(mesh, **changes):
    return dataclasses.replace(mesh, **changes)


def bad_inputs(mesh):
    one_off = [list(face) for face in mesh.faces]
    one_off[0][0] = (mesh.faces[5][0][0], one_off[0][0][1])
    far = [[(v, t + 10**6) for v, t in face] for face in mesh.faces]
    return {
        "fewer vertices": (mesh, changed(mesh, positions=mesh.positions[:-9]), "vertices"),
        "other faces": (mesh, changed(mesh, faces=mesh.faces[:-1]), "53 faces"),
        "other vertices in a face": (mesh, changed(mesh, faces=one_off), "other vertices"),
        "no faces": (changed(mesh, faces=[]), mesh, "no faces"),
        "texture coordinates beyond the file": (changed(mesh, faces=far), mesh, "coordinate"),
        "overlap": (changed(mesh, uvs=mesh.uvs % 1), mesh, "overlap"),
        "no UV area": (changed(mesh, uvs=mesh.uvs * 0), mesh, "no face has area"),
    }


@pytest.mark.parametrize("name", list(bad_inputs(quads(9, 6, wrap=True, tiles=3))))
def test_bad_input(tmp_path, name):
    rest, deformed, said = bad_inputs(quads(9, 6, wrap=True, tiles=3))[name]
    paths = rest.write(tmp_path / "rest.obj"), deformed.write(tmp_path / "deformed.obj")
    done = run("tension", *paths, "-o", tmp_path / "x.<UDIM>.exr", "--size", 8, code=BAD_INPUT)
    assert said in done.stderr, done.stderr
    assert not list(tmp_path.glob("*.exr"))


def test_files_that_are_no_meshes(tmp_path, tube):
    mesh, _ = tube
    rest, deformed = tmp_path / "rest.obj", tmp_path / "face.0007.obj"
    plain = mesh.write(tmp_path / "plain.obj", with_uv=False)
    (tmp_path / "noise.obj").write_bytes(np.random.default_rng(0).bytes(4000))
    (tmp_path / "empty.obj").write_text("")
    out = ["-o", tmp_path / "x.<UDIM>.exr", "--size", 8]
    cases = {
        (plain, deformed): "no texture coordinates (vt)",
        (tmp_path / "none.obj", deformed): "no such file",
        (rest, tmp_path / "none.obj"): "no such file",
        (tmp_path, deformed): "cannot be read",
        (tmp_path / "empty.obj", deformed): "no faces",
        (tmp_path / "noise.obj", deformed): "noise.obj",
        (rest, tmp_path / "noise.obj"): "noise.obj",
    }
    for paths, said in cases.items():
        assert said in run("tension", *paths, *out, code=BAD_INPUT).stderr
    message = run("tension", rest, deformed, *out, "--tile", 1004, code=BAD_INPUT).stderr
    assert "1001, 1002, 1003" in message
    assert not list(tmp_path.glob("*.exr"))
    # Positions alone need no texture coordinates.
    run("tension", rest, plain, *out)


TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n\n# drawn\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n"


@pytest.mark.parametrize("ends", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize(
    "old, new, said",
    [
        ("v 1 0 0", "v 1 nan 0", "line 2: a vertex has 'nan', not a finite number"),
        ("v 0 1 0", "v -inf 1 0", "line 3: a vertex has '-inf', not a finite number"),
        ("v 0 1 0", "v 0 1e39 0", "line 3: a vertex has '1e39', not a finite number"),
        ("v 0 1 0", "v 0 one 0", "line 3: a vertex has 'one', not a finite number"),
        ("v 0 1 0", "v 0 1", "line 3: a vertex has 2 of 3 numbers"),
        ("vt 1 0", "vt 1 inf", "line 7: a texture coordinate has 'inf', not a finite number"),
        ("3/3", "4/3", "line 9: a face uses vertex 4 of 3"),
        ("3/3", "0/3", "line 9: a face uses vertex 0 of 3"),
        ("3/3", "-4/3", "line 9: a face uses vertex -4 of 3"),
        ("3/3", "3/-9", "line 9: a face uses texture coordinate -9 of 3"),
        ("3/3", "4294967299/3", "line 9: a face uses the index 4294967299/3"),
    ],
)
def test_bad_numbers_are_named_by_line(tmp_path, ends, old, new, said):
    good, bad = tmp_path / "good.obj", tmp_path / "bad.obj"
    good.write_bytes(TRIANGLE.replace("\n", ends).encode())
    bad.write_bytes(TRIANGLE.replace(old, new).replace("\n", ends).encode())
    out = ["-o", tmp_path / "x.exr", "--size", 8]
    for paths in ((bad, good), (good, bad)):
        assert f"{bad}: {said}" in run("tension", *paths, *out, code=BAD_INPUT).stderr
    assert not (tmp_path / "x.exr").exists()
    run("tension", good, good, *out)


def test_numbers_of_every_form(tmp_path):
    path = tmp_path / "forms.obj"
    forms = {"v 1 0 0": "v +1. -0 0e5 1.0", "vt 1 0": "vt 1.0 .0 0", "vt 0 0": "vt 0"}
    text = TRIANGLE
    for old, new in forms.items():
        text = text.replace(old, new)
    path.write_text(text.replace("f 1/1 2/2 3/3", "f -3/-3/ 2/2 3/3"))
    out = tmp_path / "x.exr"
    run("tension", path, path, "-o", out, "--size", 8)
    assert (pixels(out)[..., :3] == (1, 0, 1)).all()


def test_file_names_in_other_scripts(tmp_path):
    folder = tmp_path / "Ordner ä 日本"
    folder.mkdir()
    mesh = quads(2, 2)
    rest = mesh.write(folder / "Größe.obj")
    out = folder / "größe_<pass>.<frame>.exr"
    run("tension", rest, rest, "-o", out, "--frames", 3, "--size", 8)
    written = folder / "größe_tension.0003.exr"
    assert ltmd.exr_metadata(written)["ltmd:object"] == "Größe"
    assert "größe_tension: 1 frame" in run("verify", folder).stdout
    assert "8 x 8" in run("info", written).stdout
    missing = folder / "fehlt ø.obj"
    said = run("tension", missing, rest, "-o", out, "--frames", 3, code=BAD_INPUT).stderr
    assert "fehlt ø.obj" in said


def test_overlap_can_be_allowed(tmp_path):
    mesh = quads(9, 6, wrap=True, tiles=3)
    path = changed(mesh, uvs=mesh.uvs % 1).write(tmp_path / "rest.obj")
    arguments = ["tension", path, path, "-o", tmp_path / "x.exr", "--size", 8]
    assert "warning" in run(*arguments, "--allow-overlap").stderr


def test_stills_of_tiles_are_no_frames(tmp_path, tube):
    paths = tmp_path / "rest.obj", tmp_path / "face.0007.obj"
    out = tmp_path / "out/tube.<UDIM>.exr"
    run("tension", *paths, "-o", out, "--size", 8, "--tile", "1001,1003")
    said = run("verify", tmp_path / "out").stdout
    assert "tube.1001: 1 frame" in said and "tube.1003: 1 frame" in said


def test_a_folder_that_cannot_be_written(tmp_path, tube):
    (tmp_path / "file").write_text("")
    paths = tmp_path / "rest.obj", tmp_path / "face.0007.obj"
    out = ["--tile", 1001, "--size", 8, "-o"]
    run("tension", *paths, *out, tmp_path / "file/x.exr", code=WRITE_FAILED)
    (tmp_path / "x.exr").mkdir()
    run("tension", *paths, *out, tmp_path / "x.exr", code=WRITE_FAILED)


def test_verify_finds_damage(tmp_path):
    run("verify", tmp_path, code=PROBLEMS)
    run("verify", tmp_path / "none", code=BAD_INPUT)
    path = tmp_path / "plane_tension.0001.exr"
    ltmd.write_exr(path, np.ones((8, 8, 3), np.float32), metadata={"ltmd:convention": 1})
    run("verify", tmp_path)
    path.write_bytes(path.read_bytes()[:-40])
    assert "plane_tension" in run("verify", tmp_path, code=PROBLEMS).stderr


@pytest.mark.skipif(os.name == "nt", reason="signals of POSIX")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupt_leaves_whole_files(tmp_path, number):
    mesh = quads(4, 4)
    rest = mesh.write(tmp_path / "rest.obj")
    out = tmp_path / "out"
    count = 400
    running = subprocess.Popen(
        [COMMAND, "tension", rest, *[rest] * count, "--frames", f"1-{count}", "--size", "512"]
        + ["-o", out / "plane_tension.<frame>.exr"],
        stderr=subprocess.PIPE,
        text=True,
    )
    end = time.monotonic() + 60
    while not list(out.glob("*.exr")) and time.monotonic() < end:
        time.sleep(0.01)
    running.send_signal(number)
    _, said = running.communicate(timeout=60)
    assert running.returncode == INTERRUPTED, said
    assert "interrupted after" in said
    files = sorted(out.iterdir())
    assert 0 < len(files) < count
    for path in files:
        assert path.suffix == ".exr"
        assert ltmd.read_exr(path).shape == (512, 512, 4)


def converted(*arguments):
    return [float(line) for line in run("convert", *arguments).stdout.splitlines()]


def test_convert():
    phong, ggx = "phong_exponent", "ggx_alpha"
    assert converted(phong, 120, "--to", ggx) == pytest.approx(
        [ltmd.convert(120, phong, ggx)], rel=1e-6
    )
    values = [10, 120, 1e5]
    for method in ("rmse", "half_angle", "closed_form"):
        expected = ltmd.convert(values, phong, ggx, method)
        found = converted(phong, *values, "--to", ggx, "--method", method)
        assert found == pytest.approx(expected, rel=1e-6)
    found = converted("gtr_alpha", 0.2, "--to", ggx, "--gamma", 3)
    assert found == pytest.approx([ltmd.convert(0.2, "gtr_alpha", ggx, gamma=3)], rel=1e-6)
    listed = run("convert", "--list").stdout
    assert re.findall(r"^\w+", listed, re.MULTILINE) == list(ltmd.MDF_PARAMETERS)


@pytest.mark.parametrize(
    "arguments, said",
    [
        ([], "--to"),
        (["phong_exponent", 120], "--to"),
        (["phong_exponent", "--to", "ggx_alpha"], "values"),
        (["phong_exponent", "many", "--to", "ggx_alpha"], "many"),
        (["phong", 120, "--to", "ggx_alpha"], "beckmann_alpha, gauss_m"),
        (["phong_exponent", 120, "--to", "alpha"], "beckmann_alpha, gauss_m"),
        (["phong_exponent", 120, "--to", "ggx_alpha", "--method", "best"], "rmse, half_angle"),
        (["ggx_alpha", 0.2, 0.95, "--to", "phong_exponent"], "0.95 at index 1"),
        (["gtr_alpha", 0.2, "--to", "ggx_alpha", "--gamma", 0], "gamma is 0"),
    ],
)
def test_convert_refuses_in_words(arguments, said):
    done = run("convert", *arguments, code=USAGE)
    assert said in done.stderr and not done.stdout
