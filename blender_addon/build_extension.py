# SPDX-License-Identifier: GPL-3.0-or-later
"""Build the installable extension from this folder, the shaders and finished wheels.

    python build_extension.py WHEEL... -o OUT.zip

Needs Python 3.11 and Blender's extension tool: from the bpy package of this Python or of the cache
(LTMD_CACHE, by default ~/.cache/ltmd), or named by --blender-ext.
"""

import argparse
import importlib.util
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
sys.path.insert(0, str(HERE))

from osl_inline import inlined  # noqa: E402

NOT_SHIPPED = {"build_extension.py", "__pycache__", "wheels", "osl"}


def version():
    """MAJOR.MINOR.PATCH from the one place where it is written."""
    header = (ROOT / "cpp/include/ltmd/version.h").read_text()
    numbers = [
        re.search(rf"#define LTMD_VERSION_{part}\s+(\d+)", header).group(1)
        for part in ("MAJOR", "MINOR", "PATCH")
    ]
    return ".".join(numbers)


def platform(wheel):
    """Blender's platform name for a wheel's tag; None for a wheel of every platform."""
    tag = Path(wheel).stem.split("-")[-1]
    if tag == "any":
        return None
    arm = bool(re.search(r"(arm64|aarch64)", tag))
    for start, names in (
        ("win", ("windows-x64", "windows-arm64")),
        ("macosx", ("macos-x64", "macos-arm64")),
        ("linux", ("linux-x64", None)),
        ("manylinux", ("linux-x64", None)),
    ):
        if tag.startswith(start) and names[arm]:
            return names[arm]
    raise SystemExit(f"Blender has no platform for the wheel {Path(wheel).name}")


def find_tool():
    """Blender's blender_ext.py."""
    packages = []
    spec = importlib.util.find_spec("bpy")
    if spec and spec.submodule_search_locations:
        packages.append(Path(list(spec.submodule_search_locations)[0]))
    cache = os.environ.get("LTMD_CACHE") or os.path.join(
        os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"), "ltmd"
    )
    packages += sorted(Path(cache).glob("venv-bpy*/lib/python*/site-packages/bpy"))
    for package in packages:
        for tool in sorted(package.glob("*/scripts/addons_core/bl_pkg/cli/blender_ext.py")):
            return tool
    raise SystemExit("Blender's blender_ext.py was not found: name it with --blender-ext")


def stage(folder, wheels):
    """Fill `folder` with everything the zip holds."""
    shutil.copytree(
        HERE, folder, dirs_exist_ok=True, ignore=lambda _path, names: NOT_SHIPPED & set(names)
    )
    (folder / "osl").mkdir()
    for shader in sorted((ROOT / "osl").glob("*.osl")):
        (folder / "osl" / shader.name).write_text(inlined(shader), encoding="utf-8")
    # The groups of stock nodes read the fitted lobes from it.
    (folder / "osl" / "include").mkdir()
    shutil.copy(ROOT / "osl" / "include" / "ltmd_lobe_table.h", folder / "osl" / "include")
    (folder / "wheels").mkdir()
    for wheel in wheels:
        shutil.copy(wheel, folder / "wheels")

    manifest = folder / "blender_manifest.toml"
    text = re.sub(
        r'^version = ".*"$', f'version = "{version()}"', manifest.read_text(), flags=re.MULTILINE
    )
    lines = "".join(f'  "./wheels/{Path(wheel).name}",\n' for wheel in wheels)
    platforms = sorted({p for p in map(platform, wheels) if p})
    filled = f"wheels = [\n{lines}]\n" if wheels else ""
    if platforms:
        filled += f"platforms = [{', '.join(f'{p!r}' for p in platforms)}]\n".replace("'", '"')
    # Top-level keys must stand before the first table.
    manifest.write_text(text.replace("\n[permissions]", f"\n{filled}\n[permissions]"))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("wheels", nargs="*", type=Path, metavar="WHEEL")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="OUT.zip")
    parser.add_argument("--blender-ext", type=Path, help="Blender's blender_ext.py")
    arguments = parser.parse_args()
    for wheel in arguments.wheels:
        if not wheel.is_file():
            raise SystemExit(f"There is no wheel {wheel}")
    tool = arguments.blender_ext or find_tool()
    output = arguments.output.resolve()
    output.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="ltmd_extension_") as temporary:
        folder = Path(temporary) / "ltmd"
        stage(folder, arguments.wheels)
        for command in (
            ["validate", str(folder)],
            ["build", "--source-dir", str(folder), "--output-filepath", str(output)],
        ):
            done = subprocess.run([sys.executable, str(tool), *command], text=True)
            if done.returncode:
                raise SystemExit(done.returncode)
    print(output)


if __name__ == "__main__":
    main()
