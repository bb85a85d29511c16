# SPDX-License-Identifier: Apache-2.0
"""Runs inside a real Blender with a window; see run.sh. Ends with "WINDOW DONE" if all holds.

    blender --factory-startup --python window.py -- FOLDER missing|whole

FOLDER holds released.zip, whose wheels do not fit this Python, missing.zip, which has none, and
whole.zip, which has the right one.
"""

import importlib
import json
import os
import subprocess
import sys
import traceback
from pathlib import Path

import bpy
import numpy as np

FOLDER, CASE = sys.argv[sys.argv.index("--") + 1 :]
OUT = Path(FOLDER) / f"out-{CASE}"
PACKAGE = "bl_ext.user_default.ltmd"
PANELS = {
    "LTMD_PT_object",
    "LTMD_PT_object_bake",
    "LTMD_PT_material",
    "LTMD_PT_view3d",
    "LTMD_PT_view3d_bake",
}
drawn = {}


def part(name):
    return importlib.import_module(f"{PACKAGE}.{name}")


def picture(name):
    bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=2)
    subprocess.run(["xwd", "-root", "-silent", "-out", OUT / f"{name}.xwd"], check=True)


def install(name):
    bpy.ops.extensions.package_install_files(
        filepath=f"{FOLDER}/{name}.zip", repo="user_default", enable_on_install=True
    )


def refuses(action, words):
    try:
        action()
    except RuntimeError as error:
        assert words in str(error), error
    else:
        raise AssertionError(f"nothing was said of: {words}")


def area(kind):
    return next(a for a in bpy.context.window.screen.areas if a.type == kind)


def instrument(panel):
    """Open every panel and note what each one shows when Blender draws it."""

    def noted(original, identifier):
        def draw(self, context):
            words = []
            label = panel.sentence

            def sentence(layout, context, text, **options):
                words.append(text)
                return label(layout, context, text, **options)

            panel.sentence = sentence
            try:
                original(self, context)
            finally:
                panel.sentence = label
            drawn[identifier] = words

        return draw

    panel.unregister()
    for cls in panel.CLASSES:
        cls.bl_options = set()
        cls.draw = noted(cls.draw, cls.__name__)
    panel.register()


def show_panels():
    """Draw all five; return the sentences of each."""
    drawn.clear()
    properties = area("PROPERTIES")
    view = area("VIEW_3D")
    view.spaces.active.show_region_ui = True
    for tab in ("OBJECT", "MATERIAL"):
        properties.spaces.active.context = tab
        yield 0.3
        for region in view.regions:
            if region.type == "UI":
                region.active_panel_category = "LTMD"
        bpy.ops.wm.redraw_timer(type="DRAW_WIN_SWAP", iterations=1)
        yield 0.3
    assert set(drawn) == PANELS, f"not drawn: {PANELS - set(drawn)}"


def monkey():
    bpy.ops.object.select_all(action="SELECT")
    bpy.ops.object.delete()
    bpy.ops.mesh.primitive_monkey_add()
    return bpy.context.object


def check_files(obj, count):
    """The host's own OpenEXR, in this process, must read what ours wrote, and the reverse."""
    import ltmd

    files = sorted((OUT / "ltmd").glob("*.exr"))
    assert len(files) >= count, files
    maps = {line.split("/")[-1].strip() for line in open("/proc/self/maps") if "/" in line}
    hosts = {
        name: [m for m in maps if name in m] for name in ("libOpenEXR", "libOpenImageIO", "libtbb")
    }
    assert all(hosts.values()), hosts
    print("loaded by the host:", hosts)
    for path in files[:: max(1, len(files) // 5)]:
        ours = ltmd.read_exr(str(path))
        image = bpy.data.images.load(str(path))
        image.colorspace_settings.is_data = True
        image.alpha_mode = "CHANNEL_PACKED"
        theirs = np.empty(len(image.pixels), np.float32)
        image.pixels.foreach_get(theirs)
        # Blender's first row is the lowest.
        assert np.array_equal(theirs.reshape(ours.shape)[::-1], ours), path
        image.filepath_raw = str(OUT / "again.exr")
        image.file_format = "OPEN_EXR"
        image.pixels.foreach_set(theirs)
        image.save()
        again = ltmd.read_exr(str(OUT / "again.exr"))
        # Blender writes this image in half float.
        assert np.abs(again - ours).max() <= np.abs(ours).max() / 1024, path
        bpy.data.images.remove(image)


def escape():
    """A real key press with the pointer over the viewport; simulated events end no jobs."""
    view = area("VIEW_3D")
    x = view.x + view.width // 3
    y = bpy.context.window.height - view.y - view.height // 2
    subprocess.run(["xdotool", "mousemove", str(x), str(y), "key", "Escape"], check=True)


def working():
    return bpy.app.is_job_running("RENDER") or part("evaluate").is_running()


def steps():
    if CASE == "missing":
        # A released zip on another Python: Blender itself refuses it in words.
        refuses(lambda: install("released"), "Python version")
    install(CASE)
    assert PACKAGE in bpy.context.preferences.addons
    instrument(part("panel"))
    obj = monkey()
    yield 0.3
    yield from show_panels()
    words = " ".join(sum(drawn.values(), []))
    problem = part("library").problem()
    if CASE == "missing":
        # In words: what is missing, and what would help.
        assert problem and problem in words, words
        assert f"Python 3.{sys.version_info.minor}" in problem and "install" in problem
        assert "Not set up" in words and "Save the file first" in words
        refuses(lambda: bpy.ops.ltmd.bake(), "needs the ltmd library")
        # Debian builds Blender without OSL: stock nodes, and a modifier that measures.
        bpy.ops.ltmd.setup(object_name="")
        assert obj.ltmd.source == "TENSOR"
        assert part("surface").lobe(obj.active_material).label == "LTMD Glossy (no OSL)"
        yield from show_panels()
        assert "stock nodes are used" in " ".join(sum(drawn.values(), []))
        picture("missing")
        return
    assert problem is None, problem

    # The file that was set up by a Blender with OSL; timers and extensions live on.
    bpy.ops.wm.open_mainfile(filepath=str(OUT / "scene.blend"))
    yield 0.5
    obj = bpy.context.object
    assert obj.ltmd.source == "LIVE"
    yield from show_panels()
    assert "Live" in " ".join(sum(drawn.values(), []))

    # Esc in mid-bake.
    obj.ltmd.size, obj.ltmd.frame_end = 512, 1000
    bpy.context.scene.frame_set(7)
    engine = bpy.context.scene.render.engine
    override = {"window": bpy.context.window_manager.windows[0], "area": area("VIEW_3D")}
    with bpy.context.temp_override(**override):
        bpy.ops.ltmd.bake("INVOKE_DEFAULT", allow_overlap=True)
    folder = OUT / "ltmd"
    for _ in range(600):
        yield 0.1
        if len(list(folder.glob("*.exr"))) >= 5:
            break
    assert working(), "the bake ended before Esc"
    escape()
    for _ in range(600):
        yield 0.1
        if not working():
            break
    yield 1.0
    assert not working(), "Esc did not end the bake"
    written = len(list(folder.glob("*.exr")))
    assert 5 <= written < 1000, written
    assert not [p for p in folder.iterdir() if p.suffix != ".exr"], "temporary files are left"
    assert obj.ltmd.source == "LIVE"
    assert bpy.context.scene.render.engine == engine and bpy.context.scene.frame_current == 7
    print("ESC after", written, "files")
    check_files(obj, 5)

    # A whole one.
    escape()  # closes the message
    yield 0.5
    obj.ltmd.frame_end = 20
    with bpy.context.temp_override(**override):
        bpy.ops.ltmd.bake("INVOKE_DEFAULT", allow_overlap=True)
    for _ in range(900):
        yield 0.1
        if not working():
            break
    yield 1.0
    assert obj.ltmd.source == "TEXTURE"
    check_files(obj, 20)
    escape()
    yield 0.5
    yield from show_panels()
    assert "Texture" in " ".join(sum(drawn.values(), []))

    # For the manual: this build of Blender has no OSL, users' builds have.
    part("device").mismatch = lambda *_: None
    part("device").osl_status = lambda _context: (
        True,
        "Renders on the CPU with Open Shading Language",
    )
    bpy.ops.wm.open_mainfile(filepath=str(OUT / "shown.blend"))
    yield 0.5
    bpy.context.scene.frame_set(20)
    yield from show_panels()
    words = " ".join(sum(drawn.values(), []))
    assert "Attribute" in words and "Red: 1.5 times the length" in words, words
    view = area("VIEW_3D")
    view.spaces.active.shading.type = "MATERIAL"
    region = next(r for r in view.regions if r.type == "WINDOW")
    with bpy.context.temp_override(area=view, region=region):
        bpy.ops.view3d.view_selected()
    for _ in range(40):  # EEVEE compiles its shaders meanwhile
        yield 1.0
    picture("panel")


def main():
    work = steps()

    def tick():
        try:
            return next(work)
        except StopIteration:
            (OUT / "drawn.json").write_text(json.dumps(drawn))
            print("WINDOW DONE", flush=True)
            status = 0
        except BaseException:
            traceback.print_exc()
            try:
                picture("failure")
            except Exception:
                traceback.print_exc()
            status = 1
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)

    # Persistent: it lives on when a file is saved or loaded.
    bpy.app.timers.register(tick, first_interval=1.0, persistent=True)


bpy.context.preferences.view.show_splash = False
main()
