# SPDX-License-Identifier: Apache-2.0
"""What the functions take: dtypes, shapes, indices, memory, threads."""

import gc
import subprocess
import sys
import threading
import time
import tracemalloc

import ltmd
import meshes
import numpy as np
import pytest
from tolerance import assert_same_bits


@pytest.fixture
def shape():
    return meshes.sphere(12, 8)


def calls(shape):
    """Every function that takes positions, as a function of them."""
    mesh = shape.mesh()
    rest = shape.rest(mesh)
    return {
        "RestState": lambda p: ltmd.RestState(mesh, p),
        "tension, rest": lambda p: ltmd.tension(mesh, p, shape.positions),
        "tension": lambda p: ltmd.tension(mesh, rest, p),
        "tension per vertex": lambda p: ltmd.tension(mesh, rest, p, per="vertex"),
        "tension per triangle": lambda p: ltmd.tension(mesh, rest, p, per="triangle"),
        "deformation_tensor": lambda p: ltmd.deformation_tensor(mesh, rest, p),
        "SequenceBaker": lambda p: ltmd.SequenceBaker(mesh, p, 8, 8),
    }


NAMES = list(calls(meshes.grid(1, 1)))


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("name", NAMES)
def test_the_first_position_that_is_not_finite_is_named(name, value, shape):
    positions = shape.positions.copy()
    positions[23, 2] = value
    positions[61, 0] = value
    with pytest.raises(ValueError, match=r"\b23\b"):
        calls(shape)[name](positions)


@pytest.mark.parametrize("name", NAMES)
def test_another_topology_gives_both_counts(name, shape):
    count = len(shape.positions)
    for other in (count - 1, count + 1, 0):
        positions = np.zeros((other, 3), np.float32)
        with pytest.raises(ValueError, match=rf"\b{other}\b") as error:
            calls(shape)[name](positions)
        assert str(count) in str(error.value)


@pytest.mark.parametrize("name", NAMES)
def test_wrong_dtype_and_shape_of_positions(name, shape):
    call = calls(shape)[name]
    for dtype in (np.float64, np.float16, np.int32, np.complex64, ">f4"):
        with pytest.raises(TypeError, match="float32"):
            call(shape.positions.astype(dtype))
    for wrong in (shape.positions.tolist(), None, "positions"):
        with pytest.raises(TypeError):
            call(wrong)
    for wrong in (
        shape.positions[:, :2],
        shape.positions.ravel(),
        shape.positions[None],
        np.float32(1) * np.zeros((len(shape.positions), 4), np.float32),
    ):
        with pytest.raises(ValueError, match="shape") as error:
            call(np.ascontiguousarray(wrong))
        assert "3)" in str(error.value) and str(np.shape(wrong)) in str(error.value)


def test_wrong_mesh_arrays(shape):
    t, v, uv = shape.topology
    n = len(shape.positions)
    for bad in (
        (t.astype(np.int64), v, uv),
        (t.astype(np.uint32), v, uv),
        (t, v.astype(np.int64), uv),
        (t, v, uv.astype(np.float64)),
        (t.tolist(), v, uv),
        (t, None, uv),
    ):
        with pytest.raises(TypeError):
            ltmd.Mesh(*bad, n)
    for bad in (
        (t.ravel(), v, uv),
        (np.ascontiguousarray(t[:, :2]), v, uv),
        (t, v[:, None], uv),
        (t, v, np.ascontiguousarray(uv[:, :1])),
        (t, v, uv[1:]),
        (t, v, uv.ravel()),
    ):
        with pytest.raises(ValueError, match="shape"):
            ltmd.Mesh(*bad, n)
    for count in (-1, 1 << 31, 1.5, None, "many"):
        with pytest.raises((ValueError, TypeError, OverflowError)):
            ltmd.Mesh(t, v, uv, count)


@pytest.mark.parametrize("index", [-1, 10**9, "end"])
def test_indices_out_of_range_are_named(index, shape):
    t, v, uv = shape.topology
    n = len(shape.positions)
    bad = t.copy()
    bad[7, 1] = len(v) if index == "end" else index
    with pytest.raises(ValueError, match=r"\b7\b") as error:
        ltmd.Mesh(bad, v, uv, n)
    assert str(bad[7, 1]) in str(error.value)
    bad = v.copy()
    bad[31] = n if index == "end" else index
    with pytest.raises(ValueError, match=r"\b31\b") as error:
        ltmd.Mesh(t, bad, uv, n)
    assert str(bad[31]) in str(error.value)


def test_uv_that_is_not_finite_is_named(shape):
    for value in (np.nan, np.inf):
        uv = shape.corner_uv.copy()
        uv[40, 1] = value
        with pytest.raises(ValueError, match=r"\b40\b"):
            shape.with_(corner_uv=uv).mesh()


def test_no_uv_map(shape):
    bare = shape.with_(corner_uv=None)
    mesh = bare.mesh()
    rest = bare.rest(mesh)
    assert mesh.corner_uv is None
    for per in ("triangle", "vertex", "corner"):
        with pytest.raises(ValueError, match="UV"):
            ltmd.tension(mesh, rest, bare.positions, per=per)
    with pytest.raises(ValueError, match="UV"):
        ltmd.bake(mesh, np.zeros((len(bare.corner_vert), 3), np.float32), 8, 8)
    with pytest.raises(ValueError, match="UV"):
        _ = mesh.tiles
    assert rest.report.no_uv_triangles in (0, len(bare.triangles))


def test_uv_outside_the_tiles(shape):
    """Far tiles work; UVs beyond any reasonable tile are an error, not an endless loop."""
    far = shape.with_(corner_uv=(shape.corner_uv * 0.5 + [500, -300]).astype(np.float32))
    assert far.mesh().tiles == [(500, -300)]
    huge = shape.with_(corner_uv=(shape.corner_uv * 1e30).astype(np.float32))
    start = time.monotonic()
    with pytest.raises(ValueError):
        _ = huge.mesh().tiles
    pixels = ltmd.bake(huge.mesh(), np.ones((len(huge.corner_vert), 3), np.float32), 16, 16)
    assert np.isfinite(pixels).all()
    assert np.isfinite(huge.tension(meshes.twisted(huge))).all()
    assert time.monotonic() - start < 20


def test_udim_numbers():
    assert [ltmd.udim(tile) for tile in [(0, 0), (9, 0), (0, 1), (9, 99)]] == [
        1001,
        1010,
        1011,
        2000,
    ]
    for tile in [(10, 0), (-1, 0), (0, 100)]:
        with pytest.raises(ValueError):
            ltmd.udim(tile)


def test_wrong_words_and_numbers(shape):
    mesh = shape.mesh()
    values = np.zeros((len(shape.corner_vert), 3), np.float32)
    with pytest.raises(ValueError, match="face.*triangle.*vertex.*corner"):
        ltmd.tension(mesh, shape.positions, shape.positions, per="face")
    for size in [(0, 8), (8, -1), (65537, 1)]:
        with pytest.raises(ValueError):
            ltmd.bake(mesh, values, *size)
    for margin in (-1, 65):
        with pytest.raises(ValueError, match=str(margin)):
            ltmd.bake(mesh, values, 8, 8, margin=margin)
    for background in [(1, 0), (1, 0, 1, 1)]:
        with pytest.raises(ValueError):
            ltmd.bake(mesh, values, 8, 8, background=background)
    with pytest.raises(ValueError, match=rf"{len(values)}.*{len(values) - 1}"):
        ltmd.bake(mesh, values[1:], 8, 8)
    with pytest.raises(TypeError, match="float64"):
        ltmd.bake(mesh, values.astype(float), 8, 8)
    for tile in [(0,), 5, (0, 0, 0), None]:
        with pytest.raises((ValueError, TypeError)):
            ltmd.bake(mesh, values, 8, 8, tile=tile)
    for count in (-1, 1025):
        with pytest.raises(ValueError):
            ltmd.set_threads(count)


def test_a_rest_state_of_another_mesh_is_refused(shape):
    other = meshes.grid(3, 3)
    with pytest.raises(ValueError, match="mesh"):
        ltmd.tension(other.mesh(), shape.rest(), other.positions)


def test_shapes_of_tensor_projection():
    b, x = np.ones((4, 6), np.float32), np.ones((4, 3), np.float32)
    with pytest.raises(ValueError):
        ltmd.project_tensor(b, x[:3], x)
    with pytest.raises(ValueError, match="shape"):
        ltmd.project_tensor(x, x, x)
    with pytest.raises(TypeError):
        ltmd.project_tensor(b, x.astype(float), x)
    for function in (ltmd.stretch, ltmd.tension_matrix):
        with pytest.raises(ValueError, match="shape"):
            function(b)
        with pytest.raises(TypeError):
            function(x.astype(float))
        assert function(np.zeros((0, 3), np.float32)).shape[0] == 0


def test_arrays_that_are_not_contiguous_are_copied(shape):
    deformed = meshes.twisted(shape)
    strided = np.zeros((len(deformed), 6), np.float32)[:, ::2]
    strided[:] = deformed
    assert not strided.flags.c_contiguous
    assert_same_bits(shape.tension(strided), shape.tension(deformed))
    order = np.asfortranarray(deformed)
    assert_same_bits(shape.tension(order), shape.tension(deformed))
    packed = np.zeros(len(deformed), [("x", "u1"), ("p", "f4", 3)])
    packed["p"] = deformed
    assert_same_bits(shape.tension(packed["p"]), shape.tension(deformed))


def test_arrays_that_are_read_only_are_taken(shape):
    deformed = meshes.twisted(shape)
    for array in (deformed, *shape.topology, shape.positions):
        array.flags.writeable = False
    shape.tension(deformed)


def many_positions():
    """One triangle in a sea of unused vertices: inputs far larger than outputs."""
    count = 4_000_000
    positions = np.zeros((count, 3), np.float32)
    positions[1, 0] = positions[2, 1] = 1
    return meshes.make([(0, 1, 2)], [0, 1, 2], [(0, 0), (1, 0), (0, 1)], [(0, 0, 0)]).with_(
        positions=positions
    )


def test_contiguous_arrays_are_not_copied():
    shape = many_positions()
    mesh = shape.mesh()
    rest = shape.rest(mesh)
    deformed = shape.positions
    ltmd.tension(mesh, rest, deformed, per="triangle")
    tracemalloc.start()
    try:
        ltmd.tension(mesh, rest, deformed, per="triangle")
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < deformed.nbytes / 10


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_no_hidden_copy_of_the_positions():
    """tracemalloc does not see C++ memory; the peak of the process does."""

    def peak():
        with open("/proc/self/status") as status:
            line = next(line for line in status if line.startswith("VmHWM"))
        return int(line.split()[1]) * 1024

    shape = many_positions()
    mesh = shape.mesh()
    rest = shape.rest(mesh)
    ltmd.tension(mesh, rest, shape.positions, per="triangle")
    gc.collect()
    with open("/proc/self/clear_refs", "w") as refs:
        refs.write("5")
    before = peak()
    ltmd.tension(mesh, rest, shape.positions, per="triangle")
    assert peak() - before < shape.positions.nbytes / 4


def test_mesh_arrays_are_not_copied_and_stay_alive(shape):
    mesh = shape.mesh()
    assert np.shares_memory(mesh.triangles, shape.triangles)
    assert np.shares_memory(mesh.corner_vert, shape.corner_vert)
    assert np.shares_memory(mesh.corner_uv, shape.corner_uv)
    deformed = meshes.twisted(shape)
    expected = shape.tension(deformed)
    arrays = [a.copy() for a in shape.topology]
    mesh = ltmd.Mesh(*arrays, len(shape.positions))
    positions = shape.positions.copy()
    rest = ltmd.RestState(mesh, positions)
    del arrays, positions
    gc.collect()
    junk = [np.full(10000, 7, np.int32) for _ in range(200)]
    assert_same_bits(ltmd.tension(mesh, rest, deformed), expected)
    del mesh
    assert rest.report.overlap_fraction >= 0
    assert len(junk) == 200


def test_mutating_the_mesh_s_arrays_does_not_crash():
    """A view of the caller's arrays is only as good as they are: an error, never a crash."""
    code = """
import ltmd, meshes, numpy as np
shape = meshes.sphere(12, 8)
mesh = shape.mesh()
rest = shape.rest(mesh)
values = np.ones((len(shape.corner_vert), 3), np.float32)
shape.triangles[:] = 2**30
shape.corner_vert[:] = -2**30
for call in (
    lambda: ltmd.bake(mesh, values, 16, 16),
    lambda: ltmd.RestState(mesh, shape.positions),
    lambda: ltmd.tension(mesh, rest, shape.positions),
    lambda: ltmd.deformation_tensor(mesh, rest, shape.positions),
    lambda: ltmd.SequenceBaker(mesh, rest, 16, 16),
    lambda: mesh.tiles,
    lambda: rest.report.overlap_fraction,
):
    try:
        call()
    except ValueError:
        pass
print("alive")
"""
    child = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        cwd=__file__.rpartition("/")[0],
    )
    assert "alive" in child.stdout, child.returncode


def ticks_during(call):
    """How often another Python thread ran while `call` did; the switch interval hides nothing."""
    ticks, stop = [0], threading.Event()

    def tick():
        while not stop.is_set():
            ticks[0] += 1
            time.sleep(0.0005)

    interval = sys.getswitchinterval()
    thread = threading.Thread(target=tick)
    thread.start()
    time.sleep(0.01)
    # The interpreter itself gives no turn in this time: only a released GIL does.
    sys.setswitchinterval(100)
    try:
        before = ticks[0]
        call()
        after = ticks[0]
    finally:
        sys.setswitchinterval(interval)
        stop.set()
        thread.join()
    return after - before


def test_the_gil_is_released(tmp_path):
    shape = meshes.grid(400, 400)
    mesh = shape.mesh()
    rest = shape.rest(mesh)
    t = np.tile(np.float32([1, 0, 1]), (2_000_000, 1))
    pixels = np.random.default_rng(0).random((1024, 1024, 4), np.float32)
    values = shape.tension(shape.positions)
    sequence = ltmd.SequenceBaker(mesh, rest, 1024, 1024, in_flight=1)

    def frames():
        for frame in range(3):
            sequence.frame(shape.positions, {"tension": tmp_path / f"f.{frame:04d}.exr"})

    def repeated(call):
        return lambda: [call() for _ in range(20)]

    ltmd.set_threads(1)
    for name, call in {
        "stretch": lambda: ltmd.stretch(t),
        "tension": repeated(lambda: ltmd.tension(mesh, rest, shape.positions)),
        "RestState": lambda: ltmd.RestState(mesh, shape.positions),
        "deformation_tensor": repeated(
            lambda: ltmd.deformation_tensor(mesh, rest, shape.positions)
        ),
        "bake": lambda: ltmd.bake(mesh, values, 1024, 1024),
        "overlap": lambda: rest.report.overlap_fraction,
        "write_exr": lambda: ltmd.write_exr(tmp_path / "picture.exr", pixels),
        "read_exr": lambda: ltmd.read_exr(tmp_path / "picture.exr"),
        "frame": frames,
        "finish": sequence.finish,
        "verify": lambda: ltmd.verify(tmp_path),
    }.items():
        assert ticks_during(call) > 0, name


@pytest.mark.parametrize("per", ["triangle", "vertex", "corner"])
def test_same_bits_with_any_number_of_threads(per):
    shape = meshes.grid(90, 80, wrap=True)
    deformed = meshes.twisted(shape)
    results = []
    for count in (1, 2, 3, 4):
        ltmd.set_threads(count)
        results.append(shape.tension(deformed, per))
    for result in results[1:]:
        assert_same_bits(result, results[0])


def test_calls_from_many_threads_at_once(shape):
    """A rest state is immutable: any number of threads may use it."""
    mesh = shape.mesh()
    rest = shape.rest(mesh)
    expected = [ltmd.tension(mesh, rest, meshes.twisted(shape, k / 8)) for k in range(8)]
    found = [None] * 8

    def work(k):
        for _ in range(50):
            found[k] = ltmd.tension(mesh, rest, meshes.twisted(shape, k / 8))

    threads = [threading.Thread(target=work, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for a, b in zip(found, expected, strict=True):
        assert_same_bits(a, b)


def test_stub_names_what_the_module_has():
    """The committed stub and the module agree on their public names."""
    import ast
    import pathlib

    import ltmd._ltmd as module

    stub = pathlib.Path(ltmd.__file__).with_name("_ltmd.pyi")
    tree = ast.parse(stub.read_text())
    aliases = {"Path", "Per", "Compression"}
    names = {n.name for n in tree.body if isinstance(n, ast.ClassDef | ast.FunctionDef)}
    names |= {n.target.id for n in tree.body if isinstance(n, ast.AnnAssign)}
    assert names - aliases == {n for n in dir(module) if not n.startswith("_")} | {"__version__"}
    for cls in (n for n in tree.body if isinstance(n, ast.ClassDef)):
        members = {n.name for n in cls.body if isinstance(n, ast.FunctionDef)}
        real = {n for n in vars(getattr(module, cls.name)) if not n.startswith("_")}
        assert {n for n in members if not n.startswith("_")} == real or not members, cls.name
    assert pathlib.Path(ltmd.__file__).with_name("py.typed").exists()


def test_every_public_function_has_a_docstring():
    for name in ltmd.__all__:
        thing = getattr(ltmd, name)
        if callable(thing) and not (isinstance(thing, type) and issubclass(thing, Exception)):
            assert (thing.__doc__ or "").strip(), name
