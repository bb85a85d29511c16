# SPDX-License-Identifier: Apache-2.0
import os
import resource
import signal
import subprocess
import sys
import time

import ltmd
import meshes
import numpy as np
import pytest
from tolerance import assert_same_bits

FRAMES = range(1, 8)


@pytest.fixture
def shape():
    """A sphere whose chart leaves background on all sides."""
    sphere = meshes.sphere(12, 8)
    return sphere.with_(corner_uv=(sphere.corner_uv * 0.6 + 0.2).astype(np.float32))


def deformed(shape, frame):
    return meshes.twisted(shape, 0.1 * frame)


def name(folder, frame, what="tension"):
    return str(folder / f"ball_{what}.{frame:04d}.exr")


def baker(shape, size=64, **options):
    mesh = shape.mesh()
    return ltmd.SequenceBaker(mesh, shape.rest(mesh), size, size, **options)


@pytest.mark.parametrize("per", ["corner", "vertex", "triangle"])
def test_frames_are_single_bakes_bit_for_bit(per, shape, tmp_path):
    sequence = baker(
        shape, passes=["tension", "stretch"], per=per, margin=4, metadata={"ltmd:object": "ball"}
    )
    for frame in FRAMES:
        paths = {what: name(tmp_path, frame, what) for what in ("tension", "stretch")}
        sequence.frame(deformed(shape, frame), paths, metadata={"ltmd:frame": frame})
    sequence.finish()
    assert sequence.progress == (2 * len(FRAMES), 2 * len(FRAMES))
    mesh = shape.mesh()
    for frame in FRAMES:
        t = shape.tension(deformed(shape, frame), per)
        for what, values in (("tension", t), ("stretch", ltmd.stretch(t))):
            if per == "vertex":
                values = values[shape.corner_vert]
            elif per == "triangle":
                # Flat faces: corners of their own.
                values = np.repeat(values, 3, axis=0)
            corners = shape
            if per == "triangle":
                order = shape.triangles.ravel()
                corners = meshes.make(
                    np.arange(len(order)),
                    shape.corner_vert[order],
                    shape.corner_uv[order],
                    shape.positions,
                )
            background = (1, 0, 1) if what == "tension" else (1, 1, 1)
            expected = ltmd.bake(
                corners.mesh() if per == "triangle" else mesh,
                np.ascontiguousarray(values),
                64,
                64,
                margin=4,
                background=background,
            )
            assert (expected[0, 0] == background).all()
            pixels = ltmd.read_exr(name(tmp_path, frame, what))
            assert pixels.shape == (64, 64, 4)
            assert (pixels[..., 3] == 1).all()
            assert_same_bits(np.ascontiguousarray(pixels[..., :3]), expected)
            metadata = ltmd.exr_metadata(name(tmp_path, frame, what))
            assert metadata["ltmd:convention"] == "1"
            assert metadata["ltmd:pass"] == what
            assert metadata["ltmd:per"] == per
            assert metadata["ltmd:object"] == "ball"
            assert metadata["ltmd:frame"] == str(frame)


def test_same_bits_with_any_number_of_threads(shape, tmp_path):
    contents = []
    for count in (1, 2, 3, 4):
        ltmd.set_threads(count)
        sequence = baker(shape)
        for frame in FRAMES:
            sequence.frame(deformed(shape, frame), {"tension": name(tmp_path, frame)})
        sequence.finish()
        contents.append([(tmp_path / file).read_bytes() for file in sorted(os.listdir(tmp_path))])
    assert len(contents[0]) == len(FRAMES)
    assert contents[1:] == contents[:-1]


def test_frame_keeps_no_view_of_the_caller_s_array(shape, tmp_path):
    """The caller may reuse one buffer for every frame."""
    sequence = baker(shape, 256, in_flight=4)
    buffer = np.empty_like(shape.positions)
    for frame in FRAMES:
        buffer[:] = deformed(shape, frame)
        sequence.frame(buffer, {"tension": name(tmp_path, frame)})
        buffer[:] = np.nan
    sequence.finish()
    for frame in FRAMES:
        expected = ltmd.bake(shape.mesh(), shape.tension(deformed(shape, frame)), 256, 256)
        pixels = ltmd.read_exr(name(tmp_path, frame))
        assert_same_bits(np.ascontiguousarray(pixels[..., :3]), expected)


@pytest.mark.parametrize("in_flight", [1, 2, 4])
def test_the_queue_is_bounded(in_flight, shape, tmp_path):
    sequence = baker(shape, 512, in_flight=in_flight)
    for frame in range(12):
        sequence.frame(deformed(shape, frame), {"tension": name(tmp_path, frame)})
        written, submitted = sequence.progress
        assert submitted == frame + 1
        assert submitted - written <= in_flight
    sequence.finish()
    assert sequence.progress == (12, 12)


def test_memory_is_bounded(tmp_path):
    """A bake needs coverage (12 bytes a texel), the frames in flight and a few mesh arrays."""
    code = """
import resource, sys
import ltmd, meshes, numpy as np
shape = meshes.sphere(32, 16)
mesh = shape.mesh()
rest = shape.rest(mesh)
size = 1024
warm = ltmd.SequenceBaker(mesh, rest, 8, 8)
warm.frame(shape.positions, {"tension": sys.argv[1] + "/warm.exr"})
warm.finish()
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
sequence = ltmd.SequenceBaker(mesh, rest, size, size, in_flight=2, compression="none")
for frame in range(10):
    path = f"{sys.argv[1]}/f.{frame:04d}.exr"
    sequence.frame(meshes.twisted(shape, frame / 10), {"tension": path})
sequence.finish()
print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) * 1024 / size**2)
"""
    child = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path)],
        capture_output=True,
        text=True,
        cwd=os.path.dirname(__file__),
    )
    assert child.returncode == 0, child.stderr
    # 12 + 2 x 16 bytes a texel; scratch of the margin and the writers' buffers on top.
    assert float(child.stdout) < 12 + 2 * 16 + 24


def test_progress_grows(shape, tmp_path):
    sequence = baker(shape, 256, in_flight=1)
    assert sequence.progress == (0, 0)
    seen = []
    for frame in FRAMES:
        sequence.frame(deformed(shape, frame), {"tension": name(tmp_path, frame)})
        seen.append(sequence.progress)
    sequence.finish()
    assert [submitted for _, submitted in seen] == list(range(1, len(FRAMES) + 1))
    assert all(a[0] <= b[0] for a, b in zip(seen, seen[1:], strict=False))


def test_a_writer_s_error_reaches_the_caller(shape, tmp_path):
    sequence = baker(shape)
    (tmp_path / "file").write_text("mine")
    sequence.frame(deformed(shape, 1), {"tension": name(tmp_path, 1)})
    with pytest.raises(OSError, match="ball_tension.0002.exr"):
        sequence.frame(deformed(shape, 2), {"tension": name(tmp_path / "file", 2)})
        for frame in range(3, 6):
            sequence.frame(deformed(shape, frame), {"tension": name(tmp_path, frame)})
        sequence.finish()
    with pytest.raises(OSError, match="ball_tension.0002.exr"):
        sequence.finish()
    assert ltmd.read_exr(name(tmp_path, 1)).shape == (64, 64, 4)
    assert (tmp_path / "file").read_text() == "mine"
    assert not [f for f in os.listdir(tmp_path) if "ball_tension" not in f and f != "file"]


def test_the_last_frame_s_error_comes_from_finish(shape, tmp_path):
    sequence = baker(shape)
    sequence.frame(deformed(shape, 1), {"tension": name(tmp_path / "absent", 1)})
    with pytest.raises(OSError, match="absent"):
        sequence.finish()


def test_a_full_disk_reaches_the_caller(shape, tmp_path):
    code = """
import sys
import ltmd, meshes
shape = meshes.sphere(12, 8)
mesh = shape.mesh()
sequence = ltmd.SequenceBaker(mesh, shape.rest(mesh), 512, 512, compression="none")
try:
    for frame in range(4):
        sequence.frame(shape.positions, {"tension": f"{sys.argv[1]}/ball_tension.{frame:04d}.exr"})
    sequence.finish()
except OSError as error:
    print("refused:", error)
"""

    def full_disk():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (100000, 100000))

    child = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path)],
        preexec_fn=full_disk,
        capture_output=True,
        text=True,
        cwd=os.path.dirname(__file__),
    )
    assert child.returncode == 0, child.stderr
    assert "refused:" in child.stdout and "ball_tension.000" in child.stdout
    assert os.listdir(tmp_path) == []


def test_cancel(shape, tmp_path):
    sequence = baker(shape, 512, in_flight=4)
    for frame in range(4):
        sequence.frame(deformed(shape, frame), {"tension": name(tmp_path, frame)})
    sequence.cancel()
    with pytest.raises(ltmd.Cancelled):
        sequence.frame(deformed(shape, 5), {"tension": name(tmp_path, 5)})
    del sequence
    for file in os.listdir(tmp_path):
        # What stays is whole; nothing temporary is left.
        assert ltmd.read_exr(tmp_path / file).shape == (512, 512, 4)
    assert not os.path.exists(name(tmp_path, 5))


def test_cancel_from_another_thread_frees_a_waiting_frame(shape, tmp_path):
    import threading

    sequence = baker(shape, 1024, in_flight=1)
    stopped = threading.Event()

    def bake():
        try:
            for frame in range(10000):
                sequence.frame(shape.positions, {"tension": name(tmp_path, frame)})
        except ltmd.Cancelled:
            stopped.set()

    thread = threading.Thread(target=bake)
    thread.start()
    time.sleep(0.3)
    sequence.cancel()
    thread.join(20)
    assert stopped.is_set()


def test_context_manager(shape, tmp_path):
    with baker(shape) as sequence:
        sequence.frame(deformed(shape, 1), {"tension": name(tmp_path, 1)})
    assert sequence.progress == (1, 1)
    with pytest.raises(KeyError), baker(shape) as sequence:
        raise KeyError("mine")
    with pytest.raises(OSError, match="absent"), baker(shape) as sequence:
        sequence.frame(deformed(shape, 1), {"tension": name(tmp_path / "absent", 1)})


def test_forgotten_baker_leaves_no_half_file(shape, tmp_path):
    sequence = baker(shape, 512)
    sequence.frame(deformed(shape, 1), {"tension": name(tmp_path, 1)})
    del sequence
    assert set(os.listdir(tmp_path)) <= {"ball_tension.0001.exr"}


def test_file_names_in_other_scripts(shape, tmp_path):
    folder = tmp_path / "Ordner ä 日本"
    folder.mkdir()
    path = folder / "größe_tension.0001.exr"
    with baker(shape, metadata={"ltmd:object": "Größe"}) as sequence:
        sequence.frame(deformed(shape, 1), {"tension": path})
    assert os.listdir(folder) == [path.name]
    assert ltmd.read_exr(path).shape == (64, 64, 4)
    assert ltmd.exr_metadata(path)["ltmd:object"] == "Größe"
    assert ltmd.verify(folder).sequences == {"größe_tension": [1]}
    with pytest.raises(OSError, match="fehlt ø"):
        ltmd.read_exr(folder / "fehlt ø.exr")


def test_a_frame_with_its_own_rest_state(shape, tmp_path):
    """One coverage for an object whose metric changes."""
    mesh = shape.mesh()
    flat = np.ascontiguousarray(shape.positions * np.float32([1, 2, 0.5]))
    moved = deformed(shape, 1)
    with ltmd.SequenceBaker(mesh, shape.rest(mesh), 64, 64) as sequence:
        sequence.frame(moved, {"tension": name(tmp_path, 1)})
        sequence.frame(moved, {"tension": name(tmp_path, 2)}, rest=flat)
        prepared = ltmd.RestState(mesh, flat)
        sequence.frame(moved, {"tension": name(tmp_path, 3)}, rest=prepared)
        del prepared
        sequence.frame(moved, {"tension": name(tmp_path, 4)})
        with pytest.raises(ValueError, match="another mesh"):
            sequence.frame(moved, {"tension": name(tmp_path, 5)}, rest=shape.rest())
        with pytest.raises(ValueError, match="vertices"):
            sequence.frame(moved, {"tension": name(tmp_path, 5)}, rest=flat[1:])
    assert len(os.listdir(tmp_path)) == 4
    for frame, rest in ((1, shape.positions), (2, flat), (3, flat), (4, shape.positions)):
        expected = ltmd.bake(mesh, ltmd.tension(mesh, rest, moved), 64, 64)
        pixels = ltmd.read_exr(name(tmp_path, frame))
        assert_same_bits(np.ascontiguousarray(pixels[..., :3]), expected)


def test_finish_and_use_again(shape, tmp_path):
    sequence = baker(shape)
    sequence.frame(deformed(shape, 1), {"tension": name(tmp_path, 1)})
    sequence.finish()
    sequence.finish()
    with pytest.raises((ValueError, RuntimeError)):
        sequence.frame(deformed(shape, 2), {"tension": name(tmp_path, 2)})


def test_nothing_to_bake(shape):
    sequence = baker(shape)
    sequence.finish()
    assert sequence.progress == (0, 0)


def test_wrong_arguments(shape, tmp_path):
    mesh = shape.mesh()
    with pytest.raises(ValueError, match="glossiness"):
        baker(shape, passes=["glossiness"])
    with pytest.raises(ValueError):
        baker(shape, passes=[])
    with pytest.raises(ValueError):
        baker(shape, in_flight=0)
    with pytest.raises(ValueError):
        baker(shape, size=0)
    with pytest.raises(ValueError, match="UV"):
        baker(shape.with_(corner_uv=None))
    with pytest.raises(TypeError):
        ltmd.SequenceBaker(mesh, shape.positions.astype(float), 8, 8)
    sequence = baker(shape)
    with pytest.raises(ValueError, match="path"):
        sequence.frame(shape.positions, {})
    with pytest.raises(ValueError, match="stretch"):
        sequence.frame(
            shape.positions, {"tension": name(tmp_path, 1), "stretch": name(tmp_path, 1, "stretch")}
        )
    broken = shape.positions.copy()
    broken[17, 1] = np.nan
    with pytest.raises(ValueError, match="17"):
        sequence.frame(broken, {"tension": name(tmp_path, 1)})
    with pytest.raises(TypeError, match="float64"):
        sequence.frame(shape.positions.astype(float), {"tension": name(tmp_path, 1)})
    with pytest.raises(ValueError, match=str(len(shape.positions))):
        sequence.frame(shape.positions[1:].copy(), {"tension": name(tmp_path, 1)})
    # None of this stops the sequence.
    sequence.frame(shape.positions, {"tension": name(tmp_path, 1)})
    sequence.finish()
    assert os.listdir(tmp_path) == ["ball_tension.0001.exr"]


LOBE = {"alpha": (0.1, 0.3), "M0": [[1, 0.4], [0.1, 0.8]], "strength": 0.7, "height_response": 0.5}


@pytest.mark.parametrize("per", ["corner", "vertex"])
def test_every_pass_is_its_function_of_the_tension(per, shape, tmp_path):
    sequence = baker(shape, passes=ltmd.passes, per=per, margin=4, **LOBE)
    paths = {what: name(tmp_path, 3, what) for what in ltmd.passes}
    sequence.frame(deformed(shape, 3), paths)
    sequence.finish()
    t = shape.tension(deformed(shape, 3), per)
    t = t[shape.corner_vert] if per == "vertex" else t
    rest = np.array([1, 0, 1], np.float32)
    functions = {
        "tension": lambda t: t,
        "stretch": ltmd.stretch,
        "wrinkle": ltmd.wrinkle,
        "alpha2": lambda t: ltmd.alpha2(t, **LOBE),
        "roughness": lambda t: ltmd.roughness(t, **LOBE),
    }
    assert list(functions) == ltmd.passes
    for what, function in functions.items():
        background = function(rest)
        values = np.ascontiguousarray(function(t))
        expected = ltmd.bake(shape.mesh(), values, 64, 64, margin=4, background=background)
        pixels = ltmd.read_exr(paths[what])
        assert_same_bits(pixels[0, 0, : len(background)], background)
        assert_same_bits(np.ascontiguousarray(pixels[..., : len(background)]), expected)
        if what != "roughness":
            assert (pixels[..., 3] == 1).all()
        metadata = ltmd.exr_metadata(paths[what])
        assert metadata["ltmd:pass"] == what
        assert "ltmd:mantissa_bits" not in metadata
        if what in ("alpha2", "roughness"):
            assert [float(v) for v in metadata["ltmd:alpha"].split()] == [0.1, 0.3]
            assert [float(v) for v in metadata["ltmd:m0"].split()] == [1, 0.4, 0.1, 0.8]
            assert float(metadata["ltmd:strength"]) == 0.7
            assert float(metadata["ltmd:height_response"]) == 0.5
        else:
            assert "ltmd:alpha" not in metadata
    assert ltmd.verify(tmp_path).problems == []


@pytest.mark.parametrize("precision", [{"half": True}, {"mantissa_bits": 6}, {"mantissa_bits": 1}])
def test_rounded_sequences_say_so_and_pass_verify(precision, shape, tmp_path):
    with baker(shape, passes=ltmd.passes, compression="piz", alpha=0.3, **precision) as sequence:
        sequence.frame(deformed(shape, 6), {what: name(tmp_path, 6, what) for what in ltmd.passes})
    bits = precision.get("mantissa_bits", 10)
    with baker(shape, passes=ltmd.passes, alpha=0.3) as sequence:
        sequence.frame(deformed(shape, 6), {what: str(tmp_path / what) for what in ltmd.passes})
    for what in ltmd.passes:
        path = name(tmp_path, 6, what)
        assert ltmd.exr_metadata(path)["ltmd:mantissa_bits"] == str(bits)
        exact = ltmd.read_exr(str(tmp_path / what))
        error = np.abs(ltmd.read_exr(path) - exact)
        # Half has no more than 2^-24 absolutely.
        assert (error <= 2.0 ** -(bits + 1) * np.abs(exact) + 2.0**-25).all()
        assert error.max() > 0
    assert ltmd.verify(tmp_path).problems == []


def test_refuses_a_bad_lobe_or_precision(shape):
    for options, words in (
        ({"mantissa_bits": 0}, "1 to 23"),
        ({"alpha": 0}, "above 0"),
        ({"M0": np.zeros((2, 2))}, "invertible"),
        ({"compression": "b44"}, "piz"),
    ):
        with pytest.raises(ValueError, match=words):
            baker(shape, **options)
