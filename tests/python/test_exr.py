# SPDX-License-Identifier: Apache-2.0
"""Files are judged by the OpenEXR and OpenImageIO wheels, not by our own reader alone."""

import os
import resource
import signal
import subprocess
import sys

import ltmd
import numpy as np
import OpenEXR
import OpenImageIO as oiio
import pytest
from tolerance import assert_same_bits

CODECS = {
    "none": OpenEXR.NO_COMPRESSION,
    "zips": OpenEXR.ZIPS_COMPRESSION,
    "zip": OpenEXR.ZIP_COMPRESSION,
}


def picture(rng, height=37, width=53, channels=4):
    """Values of every kind: tiny, huge, negative, zero, denormal, infinite, not a number."""
    bits = rng.integers(0, 2**32, (height, width, channels), dtype=np.uint32)
    pixels = bits.view(np.float32)
    pixels[: height // 2] = rng.normal(1, 0.1, pixels[: height // 2].shape)
    pixels[0, :4, 0] = [0, -0.0, np.inf, -np.inf]
    pixels[1, 0] = 1e-42
    # Signalling bits of a NaN need not survive every reader.
    pixels[np.isnan(pixels)] = np.nan
    return pixels


def by_openexr(path):
    with OpenEXR.File(str(path), separate_channels=True) as file:
        channels = {name: np.array(c.pixels) for name, c in file.channels().items()}
        return channels, dict(file.header())


def by_openimageio(path):
    image = oiio.ImageInput.open(str(path))
    assert image, oiio.geterror()
    pixels, spec = image.read_image(oiio.FLOAT), image.spec()
    image.close()
    return np.array(pixels, np.float32).reshape(spec.height, spec.width, spec.nchannels), spec


@pytest.mark.parametrize("compression", CODECS)
def test_round_trip_is_bit_equal(compression, tmp_path, rng):
    path = tmp_path / "picture.exr"
    pixels = picture(rng)
    ltmd.write_exr(path, pixels, compression=compression)
    assert_same_bits(ltmd.read_exr(path), pixels)
    channels, header = by_openexr(path)
    assert header["compression"] == CODECS[compression]
    for i, name in enumerate("RGBA"):
        assert_same_bits(np.ascontiguousarray(channels[name]), np.ascontiguousarray(pixels[..., i]))
    values, spec = by_openimageio(path)
    assert list(spec.channelnames) == ["R", "G", "B", "A"]
    assert spec.getattribute("compression") == compression
    assert all(f == oiio.FLOAT for f in spec.channelformats) and spec.format == oiio.FLOAT
    assert_same_bits(values, pixels)


@pytest.mark.parametrize("size", [(1, 1), (1, 300), (300, 1), (17, 16), (15, 33)])
def test_sizes(size, tmp_path, rng):
    path = tmp_path / "picture.exr"
    pixels = picture(rng, *size) if size[0] > 2 and size[1] > 4 else rng.random((*size, 4), "f4")
    for compression in CODECS:
        ltmd.write_exr(path, pixels, compression=compression)
        assert_same_bits(ltmd.read_exr(path), pixels)
        assert_same_bits(by_openimageio(path)[0], pixels)


def test_default_channels(tmp_path, rng):
    path = tmp_path / "picture.exr"
    for count, names in [(1, "Y"), (3, "RGBA"), (4, "RGBA")]:
        pixels = rng.random((6, 5, count), np.float32)
        ltmd.write_exr(path, pixels)
        channels, _ = by_openexr(path)
        assert sorted(channels) == sorted(names)
        values = ltmd.read_exr(path)
        assert_same_bits(np.ascontiguousarray(values[..., :count]), pixels)
        if count == 3:
            assert (values[..., 3] == 1).all()


def test_named_channels(tmp_path, rng):
    path = tmp_path / "picture.exr"
    pixels = rng.random((6, 5, 3), np.float32)
    ltmd.write_exr(path, pixels, channels=["t.z", "A", "t.x"])
    channels, _ = by_openexr(path)
    for i, name in enumerate(["t.z", "A", "t.x"]):
        assert np.array_equal(channels[name], pixels[..., i])
    # R, G, B, A first, then the file's own order (alphabetical).
    assert_same_bits(ltmd.read_exr(path), np.ascontiguousarray(pixels[..., [1, 2, 0]]))


def test_metadata(tmp_path):
    path = tmp_path / "picture.exr"
    metadata = {
        "ltmd:convention": 1,
        "ltmd:object": "Ballon – été 風船",
        "ltmd:frame": 12,
        "note": "two\nlines",
        "empty": "",
    }
    ltmd.write_exr(path, np.ones((2, 2, 3), np.float32), metadata=metadata)
    expected = {key: str(value) for key, value in metadata.items()}
    found = ltmd.exr_metadata(path)
    assert {key: found.get(key) for key in expected} == expected
    _, header = by_openexr(path)
    assert header["ltmd:object"] == metadata["ltmd:object"]
    assert str(header["ltmd:frame"]) == "12"
    _, spec = by_openimageio(path)
    assert str(spec.getattribute("ltmd:convention")) == "1"


def test_reads_what_others_write(tmp_path, rng):
    path = str(tmp_path / "other.exr")
    pixels = rng.random((20, 31, 4), np.float32)
    for compression in ("none", "rle", "zip", "piz"):
        spec = oiio.ImageSpec(31, 20, 4, oiio.FLOAT)
        spec.attribute("compression", compression)
        out = oiio.ImageOutput.create(path)
        assert out.open(path, spec) and out.write_image(pixels) and out.close()
        assert_same_bits(ltmd.read_exr(path), pixels)
    spec = oiio.ImageSpec(31, 20, 3, oiio.HALF)
    spec.tile_width = spec.tile_height = 16
    out = oiio.ImageOutput.create(path)
    assert out.open(path, spec) and out.write_image(pixels[..., :3]) and out.close()
    assert_same_bits(ltmd.read_exr(path), pixels[..., :3].astype(np.float16).astype(np.float32))


def test_metadata_of_other_programs_need_not_be_utf8(tmp_path):
    path = tmp_path / "picture.exr"
    ltmd.write_exr(path, np.ones((2, 2, 3), np.float32), metadata={"comment": "Ballon XYZ"})
    path.write_bytes(path.read_bytes().replace(b"Ballon XYZ", b"Ballon \xe9t\xe9"))
    assert ltmd.exr_metadata(path)["comment"] == "Ballon \ufffdt\ufffd"


def test_a_higher_convention_is_refused_in_words(tmp_path):
    path = tmp_path / "picture.exr"
    ltmd.write_exr(
        path, np.ones((2, 2, 3), np.float32), metadata={"ltmd:convention": ltmd.convention + 1}
    )
    for read in (ltmd.read_exr, ltmd.exr_metadata):
        with pytest.raises(OSError, match="convention.*2"):
            read(path)


@pytest.mark.parametrize("content", [b"", b"not a picture", b"\x76\x2f\x31\x01" + bytes(60)])
def test_unreadable_files(content, tmp_path):
    path = tmp_path / "broken.exr"
    path.write_bytes(content)
    for read in (ltmd.read_exr, ltmd.exr_metadata):
        with pytest.raises(OSError, match="broken.exr"):
            read(path)


@pytest.mark.parametrize("compression", CODECS)
def test_truncated_files(compression, tmp_path, rng):
    path = tmp_path / "broken.exr"
    ltmd.write_exr(path, picture(rng), compression=compression)
    whole = path.read_bytes()
    for length in (8, 100, len(whole) // 2, len(whole) - 1):
        path.write_bytes(whole[:length])
        with pytest.raises(OSError, match="broken.exr"):
            ltmd.read_exr(path)


@pytest.mark.slow
def test_damaged_files_never_crash(tmp_path, rng):
    path = tmp_path / "broken.exr"
    ltmd.write_exr(path, rng.random((9, 8, 3), np.float32), compression="zip")
    whole = np.frombuffer(path.read_bytes(), np.uint8)
    for _ in range(500):
        broken = whole.copy()
        broken[rng.integers(0, len(whole), 3)] = rng.integers(0, 256, 3)
        path.write_bytes(broken.tobytes())
        for read in (ltmd.read_exr, ltmd.exr_metadata):
            try:
                read(path)
            except (OSError, MemoryError):
                pass


def test_missing_files(tmp_path):
    for read in (ltmd.read_exr, ltmd.exr_metadata):
        with pytest.raises(OSError, match="absent.exr"):
            read(tmp_path / "absent.exr")
        with pytest.raises(OSError):
            read(tmp_path)


def only_files(folder):
    return sorted(os.listdir(folder))


def test_a_file_in_place_of_the_folder(tmp_path):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(OSError, match="picture.exr"):
        ltmd.write_exr(tmp_path / "file" / "picture.exr", np.ones((2, 2, 3), np.float32))
    with pytest.raises(OSError, match="absent"):
        ltmd.write_exr(tmp_path / "absent" / "picture.exr", np.ones((2, 2, 3), np.float32))
    with pytest.raises(OSError, match="/dev/full"):
        ltmd.write_exr("/dev/full/picture.exr", np.ones((2, 2, 3), np.float32))
    assert only_files(tmp_path) == ["file"]
    assert (tmp_path / "file").read_text() == "mine"


def test_a_folder_in_place_of_the_file(tmp_path):
    (tmp_path / "picture.exr").mkdir()
    with pytest.raises(OSError, match="picture.exr"):
        ltmd.write_exr(tmp_path / "picture.exr", np.ones((2, 2, 3), np.float32))
    assert only_files(tmp_path) == ["picture.exr"]


def full_disk(bytes_left):
    """For preexec_fn: writes past this size fail, as on a full disk."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (bytes_left, bytes_left))


@pytest.mark.parametrize("compression", CODECS)
def test_a_full_disk_leaves_the_old_file(compression, tmp_path, rng):
    path = tmp_path / "picture.exr"
    ltmd.write_exr(path, rng.random((4, 4, 3), np.float32))
    before = path.read_bytes()
    code = """
import sys, ltmd, numpy as np
pixels = np.random.default_rng(0).random((200, 200, 4), np.float32)
try:
    ltmd.write_exr(sys.argv[1], pixels, compression=sys.argv[2])
except OSError as error:
    print("refused:", error)
"""
    child = subprocess.run(
        [sys.executable, "-c", code, str(path), compression],
        preexec_fn=lambda: full_disk(20000),
        capture_output=True,
        text=True,
    )
    assert child.returncode == 0, child.stderr
    assert "refused:" in child.stdout and "picture.exr" in child.stdout
    assert path.read_bytes() == before
    assert only_files(tmp_path) == ["picture.exr"]


def test_an_existing_file_is_replaced_whole(tmp_path, rng):
    path = tmp_path / "picture.exr"
    ltmd.write_exr(path, rng.random((64, 64, 4), np.float32))
    old = os.open(path, os.O_RDONLY)
    pixels = rng.random((3, 3, 4), np.float32)
    ltmd.write_exr(path, pixels)
    assert_same_bits(ltmd.read_exr(path), pixels)
    # A reader that has the old file open still sees all of it: renamed, not written over.
    assert os.fstat(old).st_size > 64 * 64 * 4
    os.close(old)
    assert only_files(tmp_path) == ["picture.exr"]


def test_names_of_files(tmp_path):
    for name in ("été 風船.exr", "with space.0001.exr", "no_suffix"):
        ltmd.write_exr(tmp_path / name, np.ones((2, 2, 1), np.float32))
        assert ltmd.read_exr(str(tmp_path / name)).shape == (2, 2, 1)


def test_files_have_the_permissions_of_ordinary_ones(tmp_path):
    umask = os.umask(0o022)
    try:
        ltmd.write_exr(tmp_path / "picture.exr", np.ones((2, 2, 1), np.float32))
    finally:
        os.umask(umask)
    assert (tmp_path / "picture.exr").stat().st_mode & 0o777 == 0o644


def test_wrong_arguments(tmp_path):
    path = tmp_path / "picture.exr"
    good = np.ones((4, 4, 3), np.float32)
    with pytest.raises(TypeError, match="float32.*float64"):
        ltmd.write_exr(path, good.astype(float))
    with pytest.raises(ValueError, match=r"\(4, 4\)"):
        ltmd.write_exr(path, good[..., 0].copy())
    with pytest.raises(ValueError, match="channels"):
        ltmd.write_exr(path, np.ones((4, 4, 5), np.float32))
    with pytest.raises(ValueError):
        ltmd.write_exr(path, good, channels=["R", "G"])
    with pytest.raises(ValueError):
        ltmd.write_exr(path, good, channels=["R", "G", "R"])
    with pytest.raises(ValueError):
        ltmd.write_exr(path, good, channels=["R", "G", ""])
    with pytest.raises(ValueError, match="lzw.*none.*zips.*zip"):
        ltmd.write_exr(path, good, compression="lzw")
    with pytest.raises(ValueError):
        ltmd.write_exr(path, good, metadata={"": "x"})
    with pytest.raises(ValueError):
        ltmd.write_exr(path, np.ones((0, 4, 3), np.float32))
    # Names that the header needs for itself.
    with pytest.raises(ValueError, match="channels|compression|dataWindow"):
        ltmd.write_exr(path, good, metadata={"dataWindow": "mine"})
    assert not path.exists()


def test_same_bits_with_any_number_of_threads(tmp_path, rng):
    pixels = picture(rng, 300, 200)
    contents = []
    for count in (1, 2, 3, 4):
        ltmd.set_threads(count)
        ltmd.write_exr(tmp_path / "picture.exr", pixels, metadata={"b": 1, "a": 2})
        contents.append((tmp_path / "picture.exr").read_bytes())
    assert contents[1:] == contents[:-1]
