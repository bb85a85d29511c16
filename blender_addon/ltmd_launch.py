# SPDX-License-Identifier: GPL-3.0-or-later
"""The `ltmd` command where `blender -c ltmd` is not at hand:

    blender -b SCENE.blend --python ltmd_launch.py -- bake --object NAME …
    python ltmd_launch.py bake SCENE.blend --object NAME …

The second form needs a Python that has bpy and ltmd. The extension need not be installed: the
folder of this file is the package. Arguments and exit codes: see command.py.
"""

import importlib
import importlib.util
import os
import sys


def _package():
    """The enabled extension, or the package in the folder of this file, registered."""
    for name, module in list(sys.modules.items()):
        if (
            name.startswith("bl_ext.")
            and name.endswith(".ltmd")
            and f"{name}.command" in sys.modules
        ):
            return module
    folder = os.path.dirname(os.path.abspath(__file__))
    spec = importlib.util.spec_from_file_location(
        "ltmd_extension", os.path.join(folder, "__init__.py"), submodule_search_locations=[folder]
    )
    package = importlib.util.module_from_spec(spec)
    sys.modules["ltmd_extension"] = package
    spec.loader.exec_module(package)
    package.register()
    return package


def _import_bpy():
    """Blender may warn on stdout while it starts, where a JSON report must stand alone."""
    saved = os.dup(1)
    os.dup2(2, 1)
    try:
        importlib.import_module("bpy")
    finally:
        os.dup2(saved, 1)
        os.close(saved)


def main():
    if importlib.util.find_spec("bpy") is None:
        print("ltmd: this Python has no bpy: run the script inside Blender", file=sys.stderr)
        return 1
    _import_bpy()
    # Blender's own arguments end at "--"; a plain Python has none of them.
    end = sys.argv.index("--") if "--" in sys.argv else 0
    command = importlib.import_module(f"{_package().__name__}.command")
    return command.main(sys.argv[end + 1 :])


if __name__ == "__main__":
    code = 1
    try:
        code = main()
    except Exception:
        import traceback

        traceback.print_exc()
    # Blender may crash while it shuts down, which would hide the exit code.
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)
