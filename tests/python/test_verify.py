# SPDX-License-Identifier: Apache-2.0
import ltmd
import meshes
import numpy as np
import pytest

FRAMES = range(3, 9)
GOOD = np.tile(np.float32([1.2, 0.1, 0.9]), (4, 6, 1))


def write(folder, frame, pixels=GOOD, name="ball_tension", convention=1, span=FRAMES, **extra):
    metadata = {
        "ltmd:convention": convention,
        "ltmd:pass": "tension",
        "ltmd:frame": frame,
        "ltmd:frame_start": min(span),
        "ltmd:frame_end": max(span),
        **extra,
    }
    path = folder / f"{name}.{frame:04d}.exr"
    ltmd.write_exr(path, np.ascontiguousarray(pixels, np.float32), metadata=metadata)
    return path


@pytest.fixture
def folder(tmp_path):
    for frame in FRAMES:
        write(tmp_path, frame)
    return tmp_path


def test_a_whole_sequence_is_fine(folder):
    report = ltmd.verify(folder)
    assert report.ok and report.problems == []
    assert report.sequences == {"ball_tension": list(FRAMES)}
    assert ltmd.verify(str(folder), frames=list(FRAMES)).ok


def test_a_baked_sequence_is_fine(tmp_path):
    shape = meshes.sphere(12, 8)
    mesh = shape.mesh()
    sequence = ltmd.SequenceBaker(mesh, shape.rest(mesh), 32, 32, passes=["tension", "stretch"])
    for frame in range(1, 4):
        paths = {p: tmp_path / f"ball_{p}.{frame:04d}.exr" for p in ("tension", "stretch")}
        sequence.frame(meshes.twisted(shape), paths, metadata={"ltmd:frame": frame})
    sequence.finish()
    report = ltmd.verify(tmp_path)
    assert report.ok, report.problems
    assert report.sequences == {"ball_tension": [1, 2, 3], "ball_stretch": [1, 2, 3]}


@pytest.mark.parametrize("missing", [3, 5, 8])
def test_a_missing_frame_is_named(missing, folder):
    """The first and the last are missed too: every file states the range of its job."""
    (folder / f"ball_tension.{missing:04d}.exr").unlink()
    report = ltmd.verify(folder)
    assert not report.ok
    assert len(report.problems) == 1
    assert "ball_tension" in report.problems[0] and str(missing) in report.problems[0]
    assert report.sequences["ball_tension"] == [f for f in FRAMES if f != missing]


def test_expected_frames_are_an_argument(folder):
    report = ltmd.verify(folder, frames=[3, 4, 11])
    assert len(report.problems) == 1 and "11" in report.problems[0]


def test_a_gap_without_a_stated_range(tmp_path):
    for frame in (1, 2, 4):
        ltmd.write_exr(
            tmp_path / f"ball_tension.{frame:04d}.exr",
            GOOD,
            metadata={"ltmd:convention": 1, "ltmd:pass": "tension"},
        )
    report = ltmd.verify(tmp_path)
    assert len(report.problems) == 1 and "3" in report.problems[0]


def changed(value, channel):
    pixels = GOOD.copy()
    pixels[2, 3, channel] = value
    return pixels


@pytest.mark.parametrize(
    "pixels",
    [
        changed(np.nan, 1),
        changed(np.inf, 0),
        changed(0, 0),
        changed(-1, 2),
        changed(1e4, 2),
        GOOD[:, :5],
        np.dstack([GOOD, np.full(GOOD.shape[:2], 0.5)]),
    ],
    ids=["nan", "inf", "no stretch", "negative", "too large", "other size", "alpha"],
)
def test_wrong_pixels_are_named(pixels, folder):
    write(folder, 5, pixels)
    report = ltmd.verify(folder)
    assert not report.ok
    assert any("0005" in problem or "frame 5" in problem for problem in report.problems)
    assert all("0004" not in problem for problem in report.problems)


def test_mixed_conventions(folder):
    write(folder, 5, convention=ltmd.convention + 1)
    report = ltmd.verify(folder)
    assert any("0005" in problem and "convention" in problem for problem in report.problems)


@pytest.mark.parametrize("part", [0, 0.3, 0.9])
def test_a_truncated_file(part, folder):
    path = folder / "ball_tension.0005.exr"
    content = path.read_bytes()
    path.write_bytes(content[: int(len(content) * part)])
    report = ltmd.verify(folder)
    assert any("0005" in problem for problem in report.problems), report.problems


def test_several_sequences_and_tiles(folder):
    for udim in (1001, 1002):
        for frame in FRAMES:
            if (udim, frame) != (1002, 6):
                write(folder, frame, name=f"skin.001_tension.{udim}", **{"ltmd:udim": udim})
    report = ltmd.verify(folder)
    assert len(report.problems) == 1
    assert "skin.001_tension.1002" in report.problems[0] and "6" in report.problems[0]
    assert sorted(report.sequences) == [
        "ball_tension",
        "skin.001_tension.1001",
        "skin.001_tension.1002",
    ]


def test_other_files_are_left_alone(folder):
    ltmd.write_exr(folder / "backdrop.0001.exr", np.full((2, 2, 3), np.nan, np.float32))
    (folder / "notes.txt").write_text("mine")
    (folder / "folder.exr").mkdir()
    assert ltmd.verify(folder).problems == []


def test_nothing_there(tmp_path):
    report = ltmd.verify(tmp_path)
    assert not report.ok and report.sequences == {}
    with pytest.raises(OSError, match="absent"):
        ltmd.verify(tmp_path / "absent")


def test_temporary_files_of_a_running_bake_are_no_frames(folder):
    """A writer's half file beside the frames, under whatever name it has, is not taken for one."""
    report = ltmd.verify(folder)
    assert report.ok
    negative = folder / "ball_tension.-003.exr"
    ltmd.write_exr(negative, GOOD, metadata={"ltmd:convention": 1, "ltmd:pass": "tension"})
    ltmd.verify(folder)
