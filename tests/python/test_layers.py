# SPDX-License-Identifier: Apache-2.0
"""The layers know only what lies below them: geometry, files, Python, then Blender."""

import ast
import pathlib
import re
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]
GEOMETRY = [
    "export",
    "version",
    "errors",
    "threads",
    "mesh_view",
    "tangent_frame",
    "rest_state",
    "tension",
    "deformation_tensor",
    "texel_coverage",
    "bake",
    "exr",
    "sequence_baker",
    "verify",
]
STANDARD_OR_OPENEXR = re.compile(r"[a-z_]+|(Imath|Imf|Iex|Ilm|half)\w*\.h")


def includes(path):
    return re.findall(r'^\s*#\s*include\s+([<"])([^>"]+)[>"]', path.read_text(), re.MULTILINE)


def imports(path):
    """(level, module) of each import, level 0 being absolute."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from ((0, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield node.level, node.module or ""


def files(folder, *suffixes):
    found = [p for s in suffixes for p in sorted((ROOT / folder).rglob(f"*{s}"))]
    if not found:
        pytest.fail(f"no {suffixes} in {folder}: this test has nothing to read")
    return found


def test_public_headers_include_only_headers_below_them():
    for path in files("cpp/include/ltmd", ".h"):
        for kind, name in includes(path):
            if kind == "<":
                assert re.fullmatch(r"[a-z_]+", name), f"{path.name}: <{name}> in a public header"
                continue
            assert name.startswith("ltmd/"), f"{path.name}: {name}"
            below, above = name[5:-2], path.stem
            if above in GEOMETRY:
                assert below in GEOMETRY, f"{above} includes {below} of the other branch"
                assert GEOMETRY.index(below) < GEOMETRY.index(above), f"{above} includes {below}"


def test_sources_include_only_the_standard_library_and_openexr():
    for path in files("cpp/src", ".cpp", ".h"):
        for kind, name in includes(path):
            if kind == "<":
                assert STANDARD_OR_OPENEXR.fullmatch(name), f"{path.name}: <{name}>"
            else:
                inside = [ROOT / "cpp/include" / name, ROOT / "cpp/src" / name]
                assert any(p.exists() for p in inside), f"{path.name}: {name}"


def test_the_library_ends_no_process_and_prints_nothing():
    words = re.compile(
        r"\b(exit|abort|terminate|printf|puts)\s*\(|std::c(out|err|log)|locale::global"
    )
    for path in files("cpp/src", ".cpp", ".h") + files("cpp/bindings", ".cpp", ".h"):
        code = re.sub(r"//.*", "", path.read_text()).replace("std::snprintf", "")
        assert not words.search(code), f"{path.name}: {words.search(code)}"


def test_the_package_imports_numpy_at_most():
    for path in files("cpp/python", ".py", ".pyi"):
        for level, name in imports(path):
            top = name.partition(".")[0]
            known = top in sys.stdlib_module_names or top in ("numpy", "ltmd")
            assert level > 0 or known, f"{path.name} imports {name}"


def test_the_extension_reaches_the_library_in_one_place():
    known = {"bpy", "mathutils", "numpy", "bl_ui", "_cycles", "addon_utils", "bpy_extras", "gpu"}
    known.add("pxr")  # Blender brings it
    for path in files("blender_addon", ".py"):
        for level, name in imports(path):
            top = name.partition(".")[0]
            beside = path.with_name(f"{top}.py").exists()
            if level or beside or top in sys.stdlib_module_names or top in known:
                continue
            assert top == "ltmd" and path.name == "library.py", f"{path} imports {name}"


def test_shaders_include_only_their_own_headers_and_read_no_files():
    reads = re.compile(
        r"\b(texture|texture3d|environment|gettextureinfo|(pointcloud|dict)_\w+)\s*\("
    )
    for path in files("osl", ".osl", ".h"):
        for _, name in includes(path):
            allowed = ("stdosl.h", "stdcycles.h")
            assert name.startswith("ltmd_") or name in allowed, f"{path.name}: {name}"
        code = re.sub(r"//.*", "", path.read_text())
        assert not reads.search(code), f"{path.name}: {reads.search(code)}"
