# SPDX-License-Identifier: Apache-2.0
"""The module's OpenEXR is its own: nothing of a host is called, nothing is offered to it.

Blender's executable has another OpenEXR among its global symbols. What a module leaves undefined or
visible binds to those first; bpy, being a module itself, would not show it.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from blender_process import blender_python

ROUND_TRIP = """
import numpy as np, tempfile, os
pixels = np.random.default_rng(0).random((70, 50, 4), dtype=np.float32)
with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "x.exr")
    for compression in ("zip", "zips", "none"):
        ltmd.write_exr(path, pixels, compression=compression, metadata={"ltmd:convention": "1"})
        assert np.array_equal(ltmd.read_exr(path), pixels)
        assert ltmd.exr_metadata(path)["ltmd:convention"] == "1"
        judge(path, pixels)
print("round trip done")
"""


def module_file(python):
    """The compiled module that a Python imports."""
    code = "import ltmd._ltmd as m; print(m.__file__)"
    return subprocess.run(
        [python, "-c", code], check=True, capture_output=True, text=True
    ).stdout.strip()


def symbols(*arguments):
    done = subprocess.run(["nm", *arguments], check=True, capture_output=True, text=True)
    return {line.split()[-1].split("@")[0] for line in done.stdout.splitlines() if line.split()}


def test_only_the_entry_point_is_visible():
    assert symbols("-D", "--defined-only", module_file(blender_python())) == {"PyInit__ltmd"}


def test_nothing_of_openexr_is_asked_of_the_host():
    asked = symbols("-D", "--undefined-only", module_file(blender_python()))
    assert len(asked) > 50
    assert not [name for name in asked if re.search(r"^exr_|Imf_|Imath_|Iex_|IlmThread_", name)]


def libraries():
    folder = os.environ.get("LTMD_OPENEXR") or Path(blender_python()).parents[2] / "openexr"
    return sorted(Path(folder).glob("lib/*.a"))


@pytest.fixture(scope="module")
def hostile(tmp_path_factory):
    """A library that offers every function of OpenEXR and Imath; each kills the process."""
    assert len(libraries()) >= 5
    names = set()
    for library in libraries():
        names |= symbols("--defined-only", "--extern-only", library)
    names = sorted(n for n in names if re.search(r"^exr_|Imf_|Imath_|Iex_|IlmThread_", n))
    assert len(names) > 1000 and "exr_start_write" in names
    folder = tmp_path_factory.mktemp("hostile")
    lines = [".text"]
    for name in names:
        lines += [f".globl {name}", f".type {name}, @function", f"{name}: .byte 0x0f, 0x0b"]
    lines.append('.section .note.GNU-stack,"",@progbits')
    (folder / "host.s").write_text("\n".join(lines) + "\n")
    library = folder / "libhost.so"
    subprocess.run(["gcc", "-shared", "-o", library, folder / "host.s"], check=True)
    return library


def test_a_round_trip_beside_a_host_whose_openexr_traps(hostile):
    script = (
        "import ctypes, ltmd\n"
        "assert ctypes.CDLL(None).exr_start_write\n"  # the host's is among the global symbols
        "judge = lambda path, pixels: None\n" + ROUND_TRIP
    )
    environment = dict(os.environ, LD_PRELOAD=str(hostile))
    done = subprocess.run(
        [blender_python(), "-c", script], env=environment, capture_output=True, text=True
    )
    assert done.returncode == 0 and "round trip done" in done.stdout, done.stderr


def test_the_trap_catches_a_module_that_does_not_hide_its_openexr(hostile, tmp_path):
    script = (
        "import ctypes, sys, numpy, OpenEXR\n"
        "assert ctypes.CDLL(None).exr_start_write\n"
        "print('loaded', flush=True)\n"
        "pixels = {'RGB': numpy.ones((4, 4, 3), 'f')}\n"
        "OpenEXR.File({'type': OpenEXR.scanlineimage}, pixels).write(sys.argv[1])\n"
    )
    command = [sys.executable, "-c", script, tmp_path / "x.exr"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode != 0 and "exr_start_write" in done.stderr  # no trap, so not global
    environment = dict(os.environ, LD_PRELOAD=str(hostile))
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    assert done.returncode < 0, (done.returncode, done.stdout, done.stderr)


def test_a_round_trip_beside_another_openexr():
    script = """
import os, sys
sys.setdlopenflags(os.RTLD_NOW | os.RTLD_GLOBAL)
import OpenImageIO as oiio
import OpenEXR
import ltmd
loaded = {line.split("/")[-1].strip() for line in open("/proc/self/maps") if "/" in line}
assert any("OpenEXR" in name for name in loaded), loaded

def judge(path, pixels):
    source = oiio.ImageInput.open(path)
    assert np.array_equal(source.read_image("float"), pixels)
    source.close()
    output = oiio.ImageOutput.create(path)
    output.open(path, oiio.ImageSpec(50, 70, 4, "float"))
    output.write_image(pixels)
    output.close()
    assert np.array_equal(ltmd.read_exr(path), pixels)
    with OpenEXR.File(path) as file:
        assert np.array_equal(file.channels()["RGBA"].pixels, pixels)
"""
    done = subprocess.run(
        [sys.executable, "-c", script + ROUND_TRIP], capture_output=True, text=True
    )
    assert done.returncode == 0 and "round trip done" in done.stdout, done.stderr
