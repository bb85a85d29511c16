# SPDX-License-Identifier: Apache-2.0
"""The layers know only what lies below them; geometry and distributions meet in one header."""

import ast
import pathlib
import re
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]

# In each branch a header may include those before it. Private headers of cpp/src have their place
# among the public ones.
BASE = ["export", "version", "errors", "threads", "parallel", "for_items", "text", "utf8_path"]
GEOMETRY = [
    "mesh_view", "vector_math", "tangent_frame", "rest_state", "rest_state_data", "tension",
    "deformation_tensor", "texel_coverage", "bake",
]  # fmt: skip
DISTRIBUTION = [
    "require_range", "unit_mdf", "unit_form",
    "matrix2", "direction", "slope_distribution", "wide_loop",
    "transformed_distribution",
    "any_distribution", "elementary", "error_function", "visible_slope",
    "gauss_quadrature", "gauss_legendre", "find_root", "visible_normals", "lobe_normals",
    "bounded_normals", "ggx", "beckmann", "lobe_table", "lobe_mixture",
    "tabulated", "gtr", "std_distribution", "phong", "sheen", "discrete_ggx",
    "ashikhmin_shirley", "gauss", "schlick_mdf", "sawicki_ds", "ellipsoid_ndf",
    "non_centred_distribution", "fresnel", "beta_function", "v_cavity", "masking", "smith_masking",
    "height_masking", "microfacet_brdf", "visible_normals_mean", "diffuse_microfacets",
    "multiple_scattering", "mdf_conversion", "major_axis", "line_integral", "environment",
]  # fmt: skip
JOIN = ["lobe_parameters"]
FILES = ["exr", "passes", "sequence_baker", "verify"]
STANDARD = re.compile(r"[a-z_]+")
OPENEXR = re.compile(r"(Imath|Imf|Iex|Ilm|half)\w*\.h")


def may_know(term, whole_branch=False):
    """The headers that `<term>.h` may include; a source may include its whole branch."""
    layers = {
        tuple(BASE): [],
        tuple(GEOMETRY): BASE,
        tuple(DISTRIBUTION): BASE,
        tuple(JOIN): BASE + GEOMETRY + DISTRIBUTION,
        tuple(FILES): BASE + GEOMETRY + JOIN,  # what a file holds of a lobe comes by the join
    }
    for layer, below in layers.items():
        if term in layer:
            return [*below, *(layer if whole_branch else layer[: layer.index(term)])]
    pytest.fail(f"{term}: this header has no place in the layers; give it one in this test")


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


def test_public_headers_include_the_standard_library_and_headers_below_them():
    for path in files("cpp/include/ltmd", ".h"):
        for kind, name in includes(path):
            if kind == "<":
                assert STANDARD.fullmatch(name), f"{path.name}: <{name}> in a public header"
                continue
            below = re.fullmatch(r"ltmd/(\w+)\.h", name)
            assert below, f"{path.name}: {name} in a public header"
            assert below[1] in may_know(path.stem), f"{path.name} includes {name}"


def test_sources_include_openexr_and_headers_below_them():
    for path in files("cpp/src", ".cpp", ".h"):
        for kind, name in includes(path):
            if kind == "<":
                allowed = STANDARD.fullmatch(name) or OPENEXR.fullmatch(name)
                assert allowed, f"{path.name}: <{name}>"
                continue
            below = pathlib.PurePath(name).stem
            inside = [ROOT / "cpp/include" / name, ROOT / "cpp/src" / name]
            assert any(p.exists() for p in inside), f"{path.name}: {name}"
            known = may_know(path.stem, whole_branch=path.suffix == ".cpp")
            assert below in known, f"{path.name} includes {name}"


def test_bindings_and_command_include_public_headers():
    others = {"cpp/bindings": r"pybind11/\w+\.h", "cpp/cli": r"CLI/CLI\.hpp|tiny_obj_loader\.h"}
    for folder, library in others.items():
        for path in files(folder, ".cpp", ".h"):
            for kind, name in includes(path):
                if kind == "<":
                    allowed = STANDARD.fullmatch(name) or re.fullmatch(library, name)
                else:
                    public = name.startswith("ltmd/") and (ROOT / "cpp/include" / name).exists()
                    allowed = public or path.with_name(name).exists()
                assert allowed, f"{path.name}: {name}"


def test_the_library_knows_no_blender():
    word = re.compile(r"\b(bpy|mathutils|DNA_\w+|BKE_\w+|bl_ext|blender_addon)\b")
    for path in files("cpp", ".h", ".cpp", ".py", ".pyi") + files("osl", ".h", ".osl"):
        found = word.search(path.read_text())
        assert not found, f"{path.name}: {found}"


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
    known = set("bpy mathutils numpy bl_ui _cycles addon_utils bpy_extras gpu pxr".split())
    for path in files("blender_addon", ".py"):
        for level, name in imports(path):
            top = name.partition(".")[0]
            beside = path.with_name(f"{top}.py").exists()
            if level or beside or top in sys.stdlib_module_names or top in known:
                continue
            assert top == "ltmd" and path.name == "library.py", f"{path} imports {name}"


# Making, reshaping and comparing arrays, and the size of an object's 3x3 matrix.
ARRAY_WORK = set(
    "abs allclose array array_equal asarray ascontiguousarray concatenate empty eye float32 "
    "float64 full int32 isfinite ndarray ones rint sqrt stack sum unique where zeros".split()
)


# Stock nodes have no tables: these turn the shaders' fits into curves.
CURVES_OF_NODES = {"gtr_lobes.py", "coat_albedo.py"}


def test_the_extension_only_reshapes_arrays():
    for path in files("blender_addon", ".py"):
        if path.name in CURVES_OF_NODES:
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Attribute) and getattr(node.value, "id", "") == "np":
                where = f"{path.name}:{node.lineno}"
                assert node.attr in ARRAY_WORK, f"{where}: np.{node.attr} is the library's work"
            elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.MatMult):
                # Positions in the metric of the object, and that metric.
                measures = path.name in ("bake.py", "modifier.py")
                assert measures, f"{path.name}:{node.lineno}: a matrix product"
            elif isinstance(node, ast.ImportFrom) and node.module == "math":
                names = {alias.name for alias in node.names}
                assert names <= {"pi", "sqrt"}, f"{path.name}:{node.lineno}: {names}"


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


# Each includes only earlier ones, and those before "ltmd_alpha2.h" none: there the branches meet.
SHADER_HEADERS = [
    f"ltmd_{name}.h"
    for name in (
        "lobe_table", "albedo_fit", "fresnel", "frame", "tension",
        "alpha2", "surface", "energy", "lobes", "inputs", "reference",
    )
]  # fmt: skip


def test_shader_headers_keep_the_branches_apart():
    """Tension and frames, lobes, and the headers that join them."""
    joint = SHADER_HEADERS.index("ltmd_alpha2.h")
    for path in files("osl/include", ".h"):
        assert path.name in SHADER_HEADERS, f"{path.name} has no place in the layers; give it one"
        place = SHADER_HEADERS.index(path.name)
        for _, name in includes(path):
            assert place >= joint, f"{path.name} includes {name}"
            assert name in SHADER_HEADERS[:place], f"{path.name} includes {name}"
