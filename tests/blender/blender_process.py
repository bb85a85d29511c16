# SPDX-License-Identifier: Apache-2.0
"""Run test scripts in a child process that has Blender as a module.

One process per script: bpy may crash at exit after success, and a changed setting must not reach
the next test. The parent calls run(); inside the child the functions of the second half of this
file, `bpy`, `np` and `ARGUMENTS` are already there.

    result = run("report(version=bpy.app.version)")
"""

import json
import os
import subprocess
import sys
import tempfile
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


# ---- parent -------------------------------------------------------------------------------------


def blender_version():
    """The Blender to test: LTMD_BLENDER, by default 4.5."""
    return os.environ.get("LTMD_BLENDER") or "4.5"


def blender_python(blender=None):
    """A Python that has bpy: of that version, or LTMD_BPY_PYTHON, or as LTMD_BLENDER says."""
    named = os.environ.get("LTMD_BPY_PYTHON")
    if named and not blender:
        return named
    cache = os.environ.get("LTMD_CACHE") or os.path.join(
        os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"), "ltmd"
    )
    return os.path.join(cache, f"venv-bpy{blender or blender_version()}", "bin", "python")


def run(
    source, *, arguments=None, addon=True, environment=None, timeout=300, check=True, blender=None
):
    """Run `source` in a child; return what it gave to report() as a dict.

    arguments: JSON values, seen there as ARGUMENTS. addon: load the add-on from the source tree.
    environment: changes to the environment (None removes a variable).
    blender: a version, other than the one under test.
    check: a child that fails raises AssertionError with its output. The dict always holds "_code"
    (exit status) and "_output" (stdout and stderr together).
    """
    with tempfile.TemporaryDirectory(prefix="ltmd_test_") as folder:
        script = Path(folder) / "script.py"
        answer = Path(folder) / "answer.json"
        body = Path(folder) / "body.py"
        body.write_text(textwrap.dedent(source))
        script.write_text(
            "import os, sys\n"
            f"sys.path.insert(0, {str(Path(__file__).parent)!r})\n"
            "from blender_process import *\n"
            "from blender_process import _start, _stop\n"
            f"bpy, np, ARGUMENTS = _start({str(answer)!r}, {json.dumps(arguments)!r}, {addon!r})\n"
            "try:\n"
            f"    exec(compile(open({str(body)!r}).read(), {str(body)!r}, 'exec'))\n"
            "except BaseException:\n    _stop(failed=True)\n_stop()\n"
        )
        env = dict(os.environ, BLENDER_USER_RESOURCES=str(Path(folder) / "user"))
        if blender:
            env["LTMD_BLENDER"] = blender
        for name, value in (environment or {}).items():
            if value is None:
                env.pop(name, None)
            else:
                env[name] = value
        done = subprocess.run(
            [blender_python(blender), str(script)],
            env=env,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            timeout=timeout,
        )
        if check and done.returncode != 0:
            log = [line for line in done.stdout.splitlines() if not line.startswith("Fra:")]
            raise AssertionError(f"child ended with {done.returncode}:\n" + "\n".join(log))
        result = json.loads(answer.read_text()) if answer.exists() else {}
        result["_code"] = done.returncode
        result["_output"] = done.stdout
        return result


# ---- child --------------------------------------------------------------------------------------

_answer_path = None
_answers = {}


def _start(answer_path, arguments, addon):
    global _answer_path
    _answer_path = answer_path
    import bpy
    import numpy

    # Without it a Script node finds no oslquery and gets no sockets.
    bpy.utils.expose_bundled_modules()
    wanted = os.environ.get("LTMD_BLENDER")
    if wanted and not bpy.app.version_string.startswith(wanted):
        raise RuntimeError(f"Blender {bpy.app.version_string} runs instead of {wanted}")
    empty_scene()
    if addon:
        load_addon()
    return bpy, numpy, json.loads(arguments)


def _stop(failed=False):
    if failed:
        import traceback

        traceback.print_exc()
    Path(_answer_path).write_text(json.dumps(_answers, default=lambda value: value.tolist()))
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(1 if failed else 0)


def report(**values):
    """Hand values (JSON types, NumPy arrays and scalars) to the parent."""
    _answers.update(values)


def empty_scene():
    """An empty file; extensions stay enabled."""
    import bpy

    bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True, app_template="")


def load_addon():
    """Register the add-on from the source tree; return its package."""
    if str(ROOT) not in sys.path:
        sys.path.insert(0, str(ROOT))
    import blender_addon

    blender_addon.register()
    return blender_addon


def link(obj):
    """Link a new object to the scene and make it active and selected; return it."""
    import bpy

    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    obj.select_set(True)
    return obj


def mesh_object(name, vertices, faces, uvs=None):
    """A linked mesh object; uvs are per corner, in the order of the faces' corners."""
    import bpy
    import numpy as np

    mesh = bpy.data.meshes.new(name)
    points = [tuple(map(float, v)) for v in vertices]
    mesh.from_pydata(points, [], [list(map(int, f)) for f in faces])
    if uvs is not None:
        layer = mesh.uv_layers.new(name="UVMap")
        layer.uv.foreach_set("vector", np.ascontiguousarray(uvs, np.float32).ravel())
    mesh.update()
    return link(bpy.data.objects.new(name, mesh))


def camera(location, target=(0, 0, 0), ortho_scale=None):
    """A camera that looks at target; orthographic if a scale is given."""
    import bpy
    from mathutils import Vector

    data = bpy.data.cameras.new("Camera")
    obj = bpy.data.objects.new("Camera", data)
    bpy.context.scene.collection.objects.link(obj)
    obj.location = location
    obj.rotation_euler = (Vector(target) - Vector(location)).to_track_quat("-Z", "Y").to_euler()
    if ortho_scale:
        data.type = "ORTHO"
        data.ortho_scale = ortho_scale
    bpy.context.scene.camera = obj
    return obj


def cycles(width=32, height=32, samples=1, osl=True):
    """Cycles for exact comparisons: fixed seed, no filter tricks, no denoiser."""
    import bpy

    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.shading_system = osl
    scene.cycles.samples = samples
    scene.cycles.seed = 0
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.cycles.blur_glossy = 0.0
    scene.cycles.sample_clamp_indirect = 0.0
    scene.cycles.pixel_filter_type = "BOX"
    scene.render.resolution_x = width
    scene.render.resolution_y = height
    scene.render.resolution_percentage = 100
    scene.render.film_transparent = False
    scene.render.threads_mode = "FIXED"
    scene.render.threads = 2
    return scene


def render(frame=None, animation_frames=None):
    """Render; return float32[height, width, 4], row 0 = top (a list of them for frames)."""
    import bpy

    scene = bpy.context.scene
    with tempfile.TemporaryDirectory(prefix="ltmd_render_") as folder:
        settings = scene.render.image_settings
        settings.file_format = "OPEN_EXR"
        settings.color_mode = "RGBA"
        settings.color_depth = "32"
        if animation_frames:
            images = []
            for number in animation_frames:
                scene.frame_start = scene.frame_end = number
                scene.render.filepath = os.path.join(folder, "f_####")
                bpy.ops.render.render(animation=True)
                images.append(read_image(os.path.join(folder, f"f_{number:04d}.exr")))
            return images
        if frame is not None:
            scene.frame_set(frame)
        scene.render.filepath = os.path.join(folder, "picture.exr")
        bpy.ops.render.render(write_still=True)
        return read_image(scene.render.filepath)


def read_image(path):
    """Pixels of a file as float32[height, width, channels], by Blender's own OpenImageIO."""
    import OpenImageIO as oiio

    source = oiio.ImageInput.open(str(path))
    if source is None:
        raise OSError(f"cannot read {path}: {oiio.geterror()}")
    pixels = source.read_image("float")
    source.close()
    return pixels


def write_image(path, pixels):
    """Write float32[height, width, channels] by Blender's own OpenImageIO."""
    import numpy as np
    import OpenImageIO as oiio

    pixels = np.ascontiguousarray(pixels, np.float32)
    height, width, channels = pixels.shape
    target = oiio.ImageOutput.create(str(path))
    target.open(str(path), oiio.ImageSpec(width, height, channels, "float"))
    target.write_image(pixels)
    target.close()
