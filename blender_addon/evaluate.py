# SPDX-License-Identifier: GPL-3.0-or-later
"""Frames evaluated as a render sees them.

A private render engine is the only way to a depsgraph in render mode: levels of the modifiers for
the render, "Is Viewport" false, objects that are hidden in the viewport only. All frames are
visited in one call of render(); in a window that call runs on a worker thread, where bpy.data must
not be written.
"""

import bpy

ENGINE = "LTMD_BAKE"


class Evaluation:
    """One run over frames. Holds names and ids, no data-blocks: an undo may free those meanwhile.

    visit(frame, {session_uid: evaluated object or None}) is called for every frame in order; None
    stands for an object the render does not contain at this frame. conclude() follows the last
    frame, on the same thread. An exception ends the run and is kept in .error.
    """

    def __init__(self, scene, view_layer, uids, frames, visit, conclude=None, stop=None):
        self.scene = scene.session_uid
        self.scene_name = scene.name
        self.view_layer = view_layer.name
        self.uids = set(uids)
        self.frames = list(frames)
        self.visit = visit
        self.conclude = conclude
        self.stop = stop
        self.started = False
        self.finished = False
        self.cancelled = False
        self.error = None

    def run(self, engine, depsgraph):
        # render() comes once for every view layer.
        if self.started or depsgraph.view_layer.name != self.view_layer:
            return
        self.started = True
        current = depsgraph.scene.frame_current
        subframe = depsgraph.scene.frame_subframe
        try:
            for done, frame in enumerate(self.frames):
                if engine.test_break() or (self.stop is not None and self.stop()):
                    self.cancelled = True
                    return
                if not bpy.app.background:
                    engine.update_stats("LTMD", f"Frame {frame} ({done + 1} of {len(self.frames)})")
                engine.frame_set(frame, 0.0)
                self.visit(frame, self._objects(depsgraph))
                engine.update_progress((done + 1) / len(self.frames))
            if self.conclude is not None:
                self.conclude()
            self.finished = True
        except Exception as error:
            self.error = error
        finally:
            engine.frame_set(current, subframe)

    def _objects(self, depsgraph):
        found = dict.fromkeys(self.uids)
        for obj in depsgraph.objects:
            # An evaluated copy has no id of its own.
            uid = obj.original.session_uid
            if uid in found:
                found[uid] = obj
        return found


_current = None


def _make_engine():
    # Registered for the time of a run only: it has no place in the user's list of engines.
    class LtmdBake(bpy.types.RenderEngine):
        bl_idname = ENGINE
        bl_label = "LTMD Bake"

        def render(self, depsgraph):
            if _current is not None:
                _current.run(self, depsgraph)

    return LtmdBake


# What a scene was before, kept in the scene itself: an undo step or an automatic save made while
# frames are visited holds it too, and is put right when it comes back.
_BEFORE = "ltmd_before_bake"
_RENDER = ("engine", "use_compositing", "use_sequencer", "use_multiview", "use_single_layer")


def _take(scene):
    before = {name: getattr(scene.render, name) for name in _RENDER}
    before.update(frame=scene.frame_current, subframe=scene.frame_subframe)
    scene[_BEFORE] = before
    if scene.camera is None:
        # A render without a camera is refused; any object will do.
        scene.camera = bpy.data.objects.new(".ltmd camera", None)
        scene.camera[_BEFORE] = True
    # File Output nodes and sequencer strips must not act on a bake.
    for name in _RENDER[1:]:
        setattr(scene.render, name, False)
    scene.render.engine = ENGINE


def _give_back(scene):
    before = scene.get(_BEFORE)
    if before is None:
        return
    for name in _RENDER:
        setattr(scene.render, name, before[name])
    frame, subframe = before["frame"], before["subframe"]
    del scene[_BEFORE]
    if (scene.frame_current, scene.frame_subframe) != (frame, subframe):
        scene.frame_set(frame, subframe=subframe)


def _give_all_back():
    for scene in bpy.data.scenes:
        if scene.library is None:
            _give_back(scene)
    for obj in list(bpy.data.objects):
        if obj.library is None and _BEFORE in obj:
            bpy.data.objects.remove(obj)


class _Session:
    """A scene turned to our engine until end()."""

    def __init__(self, evaluation):
        global _current
        if _current is not None:
            raise RuntimeError("Another bake is running")
        self.engine = _make_engine()
        bpy.utils.register_class(self.engine)
        _current = evaluation
        view = bpy.context.preferences.view
        self.display = view.render_display_type
        view.render_display_type = "NONE"
        try:
            _take(_scene(evaluation.scene))
        except BaseException:
            self.end()
            raise

    def end(self):
        global _current
        _current = None
        bpy.context.preferences.view.render_display_type = self.display
        _give_all_back()
        bpy.utils.unregister_class(self.engine)


def _scene(uid):
    return next((scene for scene in bpy.data.scenes if scene.session_uid == uid), None)


def run(evaluation):
    """Visits all frames and returns when done."""
    session = _Session(evaluation)
    try:
        bpy.ops.render.render(scene=evaluation.scene_name)
    finally:
        session.end()
    if not (evaluation.finished or evaluation.cancelled or evaluation.error):
        evaluation.cancelled = True


def start(evaluation, done):
    """Visits the frames in a render job of the window; done() is called on the main thread."""
    session = _Session(evaluation)

    def poll():
        if bpy.app.is_job_running("RENDER"):
            return 0.2
        session.end()
        # An undo ends the job between two frames, without an error.
        if not (evaluation.finished or evaluation.error):
            evaluation.cancelled = True
        done()
        return None

    try:
        bpy.ops.render.render("INVOKE_DEFAULT", scene=evaluation.scene_name)
    except Exception:
        session.end()
        raise
    bpy.app.timers.register(poll, first_interval=0.2, persistent=True)


def is_running():
    return _current is not None


@bpy.app.handlers.persistent
def _repair(*_):
    if _current is None:
        _give_all_back()


_HANDLERS = (bpy.app.handlers.undo_post, bpy.app.handlers.redo_post, bpy.app.handlers.load_post)


def register():
    for handlers in _HANDLERS:
        handlers.append(_repair)


def unregister():
    for handlers in _HANDLERS:
        handlers.remove(_repair)
