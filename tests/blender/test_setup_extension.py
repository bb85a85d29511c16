# SPDX-License-Identifier: Apache-2.0
"""The zip as users install it: built, installed, enabled, set up, rendered, switched off."""

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from blender_process import ROOT, blender_python, run

sys.path.insert(0, str(ROOT / "blender_addon"))

from build_extension import platform, version  # noqa: E402


def stub_wheel(folder):
    """A wheel with the library's name for this Python that holds nothing."""
    name = f"pyltmd-{version()}"
    path = Path(folder) / f"{name}-py3-none-linux_x86_64.whl"
    with zipfile.ZipFile(path, "w") as wheel:
        wheel.writestr("ltmd/__init__.py", "stub = True\n")
        info = f"{name}.dist-info"
        about = f"Metadata-Version: 2.1\nName: pyltmd\nVersion: {version()}\n"
        wheel.writestr(f"{info}/METADATA", about)
        tag = "Wheel-Version: 1.0\nRoot-Is-Purelib: false\nTag: py3-none-linux_x86_64\n"
        wheel.writestr(f"{info}/WHEEL", tag)
        wheel.writestr(f"{info}/RECORD", "")
    return path


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    folder = tmp_path_factory.mktemp("extension")
    output = folder / "ltmd.zip"
    script = ROOT / "blender_addon/build_extension.py"
    command = [blender_python(), script, stub_wheel(folder), "-o", output]
    subprocess.run(command, check=True, capture_output=True)
    return output


def test_the_zip_holds_what_it_needs_and_no_more(package):
    with zipfile.ZipFile(package) as zipped:
        names = zipped.namelist()
        shaders = [n for n in names if n.endswith(".osl")]
        assert len(shaders) == len(list((ROOT / "osl").glob("*.osl")))
        for shader in shaders:
            assert '"ltmd_' not in zipped.read(shader).decode()  # every include is put in
        manifest = zipped.read("blender_manifest.toml").decode()
    assert f'version = "{version()}"' in manifest and 'platforms = ["linux-x64"]' in manifest
    assert "build_extension.py" not in names and not any("__pycache__" in n for n in names)
    assert "LICENSE" in names


def test_installed_it_sets_up_and_renders(package, tmp_path):
    result = run(
        """
bpy.ops.extensions.package_install_files(filepath=ARGUMENTS, repo="user_default",
                                         enable_on_install=True)
empty_scene()
scene = cycles(8, 8)
obj = mesh_object("Plane", [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0)], [(0, 1, 2, 3)])
camera((0, 0, 3), ortho_scale=.5)
light = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
scene.collection.objects.link(light)
bpy.ops.ltmd.setup(object_name="Plane")
picture = render()
import importlib
gtr_lobes = importlib.import_module("bl_ext.user_default.ltmd.nodes.gtr_lobes")
lobes = [len(gtr_lobes.table(beyond, 4)) for beyond in (False, True)]
enabled = [name for name in bpy.context.preferences.addons.keys() if name.endswith(".ltmd")]
import addon_utils
addon_utils.disable(enabled[0])
report(picture=picture[..., :3], enabled=enabled, lobes=lobes,
       gone=not hasattr(bpy.types.Object, "ltmd"))
""",
        arguments=str(package),
        addon=False,
    )
    assert result["enabled"] == ["bl_ext.user_default.ltmd"]
    assert min(p for row in result["picture"] for pixel in row for p in pixel) > 0.01
    assert result["gone"]
    assert result["lobes"] == [2, 2]  # what the groups of stock nodes read from the shaders' folder
    assert "Traceback" not in result["_output"]


@pytest.mark.parametrize(
    ("tag", "expected"),
    [
        ("manylinux_2_27_x86_64.manylinux_2_28_x86_64", "linux-x64"),
        ("linux_x86_64", "linux-x64"),
        ("win_amd64", "windows-x64"),
        ("win_arm64", "windows-arm64"),
        ("macosx_11_0_arm64", "macos-arm64"),
        ("macosx_10_15_x86_64", "macos-x64"),
        ("any", None),
    ],
)
def test_platform_of_a_wheel(tag, expected):
    assert platform(f"pyltmd-1.0.0-cp311-cp311-{tag}.whl") == expected
