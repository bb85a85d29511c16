# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake Tension: the deformation of mesh objects over frames, as one float EXR a frame and UV tile.

The order of a bake: look for everything that can be known to be wrong (Bake.__init__), open the
folder and evaluate the rest states (prepare), visit the frames, wait for the writers and read every
file back (run or start), switch the materials (finish). Only prepare and finish touch bpy.data.
"""

import os
import tempfile
import threading
import time
from dataclasses import dataclass, field

import bpy
import numpy as np
from bpy.props import (
    BoolProperty,
    CollectionProperty,
    EnumProperty,
    IntProperty,
    StringProperty,
)

from . import (
    device,
    evaluate,
    false_colour,
    frames,
    library,
    naming,
    rest_state,
    simulation,
    source,
    surface,
    usd,
)
from .library import LibraryMissing
from .properties import PASS_ITEMS
from .writable import REFUSAL, is_writable

PASSES = tuple(item[0].lower() for item in PASS_ITEMS)
DEFAULT_PASSES = ("tension",)
COMPRESSIONS = ("zip", "zips", "piz", "none")
# Lobe settings in the metadata of the passes that depend on them.
LOBE_KEYS = ("ltmd:alpha", "ltmd:m0", "ltmd:strength", "ltmd:height_response")
CONVENTION = "1"
# Shared texels hold one value for two places of the surface.
MOST_OVERLAP = 0.001
# Subdivision leaves UVs at a tile border a rounding beyond it, which must not open another tile.
UV_ROUNDING = 2e-6
# Relative; float32 matrices of an object that only turns differ by less.
METRIC_TOLERANCE = 1e-5


class Refused(Exception):
    """The input cannot be baked; .problems are sentences."""

    def __init__(self, *problems):
        super().__init__("\n".join(problems))
        self.problems = list(problems)


class WriteFailure(Exception):
    """A folder or file could not be written."""


@dataclass
class Settings:
    """What to bake. None in rest, uv_map and the like: the object's own setting."""

    objects: list
    frames: list
    rest: rest_state.Spec | None = None
    uv_map: str | None = None
    width: int = 1024
    height: int = 1024
    margin: int = 16
    passes: tuple = DEFAULT_PASSES
    folder: str = "//ltmd/"
    compression: str = "zip"
    half: bool = False
    mantissa_bits: int | None = None
    alpha: tuple | None = None
    usd: bool = False
    allow_overlap: bool = False
    resume: bool = False
    switch: bool = False


@dataclass
class Target:
    """One object on its way through a bake; holds no data-block, see evaluate.Evaluation."""

    name: str
    library: str
    uid: int
    stem: str
    spec: rest_state.Spec
    uv_map: str
    todo: set
    choices: list = field(default_factory=list)
    arrays: rest_state.MeshArrays | None = None
    mesh: object = None
    tiles: list = field(default_factory=list)
    overlap: float = 0.0
    degenerate: int = 0
    metric: np.ndarray | None = None
    lobe: dict = field(default_factory=dict)
    prepared: object = None
    bakers: dict = field(default_factory=dict)
    coverage: dict = field(default_factory=dict)
    files: list = field(default_factory=list)
    skipped: list = field(default_factory=list)
    uv_moves: bool = False


class Bake:
    """One bake. Every step may raise Refused, WriteFailure or LibraryMissing; report() is valid
    after each of them."""

    def __init__(self, scene, view_layer, settings, progress=None):
        self.started = time.monotonic()
        self.settings = settings
        self.progress = progress
        self.warnings = []
        self.told = []
        self.problems = []
        self.status = "failed"
        self.targets = []
        self.verified = False
        self.stopped = threading.Event()
        self.folder = os.path.normpath(bpy.path.abspath(settings.folder))
        self._scene = scene.session_uid
        self._layer = view_layer.name
        try:
            self.ltmd = library.ltmd()
            self._check(scene, view_layer)
        except BaseException as error:
            self._fail(error)
            raise

    # --- before the first frame -----------------------------------------------------------------

    def _check(self, scene, view_layer):
        settings = self.settings
        problems = []
        if settings.folder.startswith("//") and not bpy.data.filepath:
            problems.append(f'Save the file first: the folder "{settings.folder}" is beside it')
        if not settings.frames:
            problems.append("There is no frame to bake")
        elif min(settings.frames) < 0:
            problems.append(
                f"Frame {min(settings.frames)} is negative: Blender would read the file of frame 0 "
                "for it; shift the animation to frames from 0 on"
            )
        unknown = [name for name in settings.passes if name not in PASSES]
        if unknown:
            problems.append(f"Unknown pass {unknown[0]}: there is {', '.join(PASSES)}")
        if not settings.passes and not settings.usd:
            problems.append(f"There is no pass to bake: choose from {', '.join(PASSES)}")
        if settings.usd and usd.problem():
            problems.append(usd.problem())
        if not settings.objects:
            problems.append("There is no object to bake")
        frozen = _frozen_problem()
        if frozen:
            problems.append(frozen)
        names = [(obj.name, naming_library(obj)) for obj in bpy.data.objects]
        for obj in settings.objects:
            problem = self._object_problem(scene, view_layer, obj)
            if problem:
                problems.append(problem)
                continue
            target = Target(
                name=obj.name,
                library=naming_library(obj),
                uid=obj.session_uid,
                stem=naming.file_stem(obj.name, naming_library(obj), names),
                spec=settings.rest or object_rest(obj),
                uv_map=settings.uv_map if settings.uv_map is not None else obj.ltmd.uv_map,
                todo=set(settings.frames),
                lobe=lobe_of(obj, settings.alpha),
            )
            self.targets.append(target)
            problems += self._rest_problems(obj, target)
        self.order = self._order()
        for obj in settings.objects:
            problems += simulation.problems(obj, scene, self.order)
            edits = simulation.unkeyed_edits(obj, scene)
            if edits:
                self.warnings.append(
                    f'"{obj.name}" depends on edits that are not keyed ({", ".join(edits[:3])}'
                    f"{' …' if len(edits) > 3 else ''}): a change of frame undoes them, key them "
                    "or they are not baked"
                )
        if problems:
            raise Refused(*dict.fromkeys(problems))

    def _object_problem(self, scene, view_layer, obj):
        if obj.type != "MESH":
            return (
                f'"{obj.name}" is of type {obj.type.lower()}, only meshes can be baked: convert it '
                "to a mesh"
            )
        if obj.data.is_editmode:
            return f'"{obj.name}" is in Edit Mode: leave it first'
        hidden = hidden_reason(scene, view_layer, obj)
        if hidden:
            return f'"{obj.name}" is not in the render: {hidden}'
        wanted = self.settings.uv_map if self.settings.uv_map is not None else obj.ltmd.uv_map
        makes_uv = any(m.type == "NODES" and m.show_render for m in obj.modifiers)
        layers = obj.data.uv_layers
        if not makes_uv and not len(layers):
            return f'"{obj.name}" has no UV map: unwrap it, or use the live source'
        if not makes_uv and wanted and wanted not in layers:
            return f'"{obj.name}" has no UV map "{wanted}", it has: {", ".join(layers.keys())}'
        if self.settings.switch:
            for data in (obj, *source.materials(obj)):
                if not is_writable(data):
                    return (
                        f'"{data.name}" is linked from {data.library.filepath}, its material '
                        f"cannot be switched to the textures: {REFUSAL.lower()}"
                    )
        return None

    def _rest_problems(self, obj, target):
        if target.spec.mode != "object":
            return []
        shape = bpy.data.objects.get(target.spec.object)
        if shape is None or shape.type != "MESH":
            return [f'The rest object "{target.spec.object}" is not a mesh object of this file']
        return []

    def _order(self):
        """The frames to visit: rest frames that do not come first anyway, then the baked ones."""
        todo = sorted(set().union(*(target.todo for target in self.targets), ()))
        rest = sorted(
            {
                target.spec.frame
                for target in self.targets
                if target.spec.mode == "frame" and target.todo
            }
        )
        if rest and rest == todo[:1]:
            rest = []
        self._ahead = len(rest)
        return rest + todo

    def prepare(self):
        """The folder, the rest states, and the files that a resumed bake can keep."""
        try:
            self._open_folder()
            scene = self._find(bpy.data.scenes, self._scene)
            requests = {}
            for target in self.targets:
                obj = self._find(bpy.data.objects, target.uid)
                if target.spec.mode != "frame":
                    requests[target.uid] = (obj, target.spec, target.uv_map)
                if self.settings.resume:
                    # Which tiles there are must be known before the first frame is.
                    spec = rest_state.Spec()
                    requests[target.uid, "uv"] = (obj, spec, target.uv_map)
            try:
                found = rest_state.candidates(scene, requests) if requests else {}
            except rest_state.RestError as error:
                raise Refused(str(error)) from None
            for target in self.targets:
                target.choices = found.get(target.uid, [])
            if self.settings.resume:
                self._skip_finished({t.uid: found[t.uid, "uv"] for t in self.targets})
        except BaseException as error:
            self._fail(error)
            raise

    def _open_folder(self):
        try:
            os.makedirs(self.folder, exist_ok=True)
            with tempfile.TemporaryFile(dir=self.folder):
                pass
        except OSError as error:
            raise WriteFailure(
                f'The folder "{self.folder}" cannot be written: {error.strerror or error}'
            ) from None

    def _skip_finished(self, layouts):
        for target in self.targets:
            layout = layouts[target.uid]
            mesh = next((arrays for arrays in layout if arrays.uv is not None), None)
            if mesh is None:
                continue
            target.uv_map = target.uv_map or mesh.uv_map
            target.tiles = tiles = list(self._mesh(target, mesh).tiles)
            for frame in sorted(target.todo):
                paths = self._paths(target, tiles, frame)
                finished = [path for files in paths.values() for path in files.values()]
                done = all(
                    self._is_finished(path, target, tile, name, frame)
                    for tile, files in paths.items()
                    for name, path in files.items()
                )
                if self.settings.usd:
                    path = self._usd_path(target, frame)
                    wanted = self._usd_metadata(target, frame)
                    done = done and os.path.exists(path) and usd.metadata(path) == wanted
                    finished.append(path)
                if done:
                    target.todo.discard(frame)
                    target.skipped += finished
        # A simulation that is not baked has to be stepped through from its start.
        stepped = any(
            simulation.unbaked(self._find(bpy.data.objects, target.uid)) and target.todo
            for target in self.targets
        )
        if not stepped:
            self.order = self._order()

    def _is_finished(self, path, target, tile, name, frame):
        """Whether the file holds this frame under these settings and can be read to its end."""
        if not os.path.exists(path):
            return False
        wanted = self._metadata(target, tile) | {"ltmd:frame": str(frame), "ltmd:pass": name}
        ignored = ("ltmd:frame_start", "ltmd:frame_end")
        bits = min(self.settings.mantissa_bits or 23, 10 if self.settings.half else 23)
        try:
            found = self.ltmd.exr_metadata(path)
            if any(found.get(key) != wanted[key] for key in wanted if key not in ignored):
                return False
            if found.get("ltmd:mantissa_bits", "23") != str(bits):
                return False
            if name in ("alpha2", "roughness"):
                given = [float(v) for key in LOBE_KEYS for v in found.get(key, "").split()]
                if given != lobe_numbers(target.lobe):
                    return False
            shape = self.ltmd.read_exr(path).shape
        except (OSError, ValueError):
            return False
        return shape[:2] == (self.settings.height, self.settings.width)

    # --- the frames -----------------------------------------------------------------------------

    def run(self, stop=None):
        """Visits all frames and returns; stop() true ends it between two frames."""
        evaluation = self._evaluation(stop)
        if self.order:
            evaluate.run(evaluation)
        self._ended(evaluation)

    def start(self, done):
        """The same as a job of the window; done() is called on the main thread when it is over."""
        evaluation = self._evaluation(None)

        def over():
            try:
                self._ended(evaluation)
            except (Refused, WriteFailure, LibraryMissing):
                pass
            done()

        if self.order:
            evaluate.start(evaluation, over)
        else:
            over()

    def _evaluation(self, stop):
        scene = self._find(bpy.data.scenes, self._scene)
        layer = scene.view_layers[self._layer]
        self._visited = 0
        return evaluate.Evaluation(
            scene,
            layer,
            [target.uid for target in self.targets],
            self.order,
            self._visit,
            self._conclude,
            lambda: self.stopped.is_set() or (stop is not None and stop()),
        )

    def _visit(self, frame, objects):
        frozen = _frozen_problem()
        if frozen:
            # A driver that only the render evaluates.
            raise Refused(frozen)
        ahead = self._visited < self._ahead
        self._visited += 1
        for target in self.targets:
            takes_rest = (
                target.spec.mode == "frame" and target.spec.frame == frame and target.mesh is None
            )
            bakes = not ahead and frame in target.todo
            if not (takes_rest or bakes):
                continue
            obj = objects[target.uid]
            if obj is None:
                raise Refused(f'"{target.name}" is not in the render at frame {frame}')
            if takes_rest:
                target.arrays = rest_state.read_mesh(obj.data, target.uv_map)
            if bakes:
                self._bake(target, frame, obj)
        if self.progress is not None:
            self.progress(frame, self._visited, len(self.order))

    def _bake(self, target, frame, obj):
        mesh = obj.data
        if target.mesh is None:
            self._set_up(target, mesh)
        positions = rest_state.read_positions(mesh)
        arrays = target.arrays
        if len(positions) != len(arrays.positions):
            raise Refused(
                f'"{target.name}" has {len(positions)} vertices at frame {frame}, its rest state '
                f"has {len(arrays.positions)}: the number must not change"
            )
        if not np.array_equal(rest_state.read_corner_vert(mesh), arrays.corner_vert):
            raise Refused(f'"{target.name}" has other faces at frame {frame} than its rest state')
        uv = rest_state.read_uv(mesh, arrays.uv_map)
        if not target.uv_moves and uv is not None and not np.array_equal(uv, arrays.uv):
            target.uv_moves = True
            self.warnings.append(
                f'The UV map "{arrays.uv_map}" of "{target.name}" is different at frame {frame}: '
                "the texture is laid out in the UVs of the rest state"
            )
        matrix = metric_matrix(obj.matrix_world)
        try:
            self._measure_in(target, matrix)
            if matrix is not None:
                positions = transformed(positions, matrix)
            if self.settings.passes:
                paths = self._paths(target, target.tiles, frame)
                for tile, files in paths.items():
                    self._baker(target, tile).frame(
                        positions,
                        files,
                        metadata={"ltmd:frame": str(frame)},
                        rest=target.prepared,
                    )
                    target.files += files.values()
            if self.settings.usd:
                path = self._usd_path(target, frame)
                usd.write(
                    path,
                    target.name,
                    rest_state.read_positions(mesh),
                    obj.matrix_world,
                    usd.read_face_sizes(mesh),
                    arrays.corner_vert,
                    arrays.uv,
                    self.ltmd.tension(target.mesh, target.prepared, positions),
                    self._usd_metadata(target, frame),
                )
                target.files.append(path)
        except ValueError as error:
            raise Refused(f'"{target.name}" at frame {frame}: {error}') from None
        except OSError as error:
            raise WriteFailure(str(error)) from None

    def _set_up(self, target, mesh):
        """At the first frame: which rest mesh it is, and whether its UVs can hold a texture."""
        try:
            if target.arrays is None:
                target.arrays = rest_state.pick(target.name, target.choices, mesh)
        except rest_state.RestError as error:
            raise Refused(str(error)) from None
        target.choices = []
        arrays = target.arrays
        if arrays.kept:
            self.warnings.append(
                f'The rest state of "{target.name}" keeps the Geometry Nodes modifiers '
                f"{', '.join(arrays.kept)}, which make its points; if they also move them, use a "
                "rest frame or a rest object"
            )
        if arrays.uv is None:
            # A map made by Geometry Nodes is not on the rest mesh.
            arrays.uv_map = target.uv_map or rest_state.default_uv_map(mesh)
            arrays.uv = rest_state.read_uv(mesh, arrays.uv_map) if arrays.uv_map else None
        if arrays.uv is None:
            wanted = f' "{target.uv_map}"' if target.uv_map else ""
            raise Refused(f'"{target.name}" has no UV map{wanted} in the render: unwrap it')
        target.uv_map = arrays.uv_map
        target.mesh = self._mesh(target, arrays)
        target.tiles = list(target.mesh.tiles)
        report = self.ltmd.RestState(target.mesh, arrays.positions).report
        target.overlap = float(report.overlap_fraction)
        target.degenerate = int(report.degenerate_triangles)
        if not self.settings.passes:
            return  # corners share nothing
        if target.overlap > MOST_OVERLAP and not self.settings.allow_overlap:
            raise Refused(
                f'{target.overlap:.1%} of the UV map "{arrays.uv_map}" of "{target.name}" is used '
                "by more than one place of the surface, and a texel holds one value: use the live "
                "source, the tension attribute or a UV map without overlap, or allow the overlap"
            )
        if target.overlap > MOST_OVERLAP:
            self.warnings.append(
                f'{target.overlap:.1%} of the UV map "{arrays.uv_map}" of "{target.name}" overlaps'
            )

    def _mesh(self, target, arrays):
        uv = snapped(arrays.uv)
        used = uv[arrays.triangles.ravel()]
        if len(used) == 0:
            raise Refused(f'"{target.name}" has no faces')
        if not np.isfinite(used).all():
            raise Refused(f'The UV map "{arrays.uv_map}" of "{target.name}" is not finite')
        low, high = used.min(axis=0), used.max(axis=0)
        if low.min() < 0 or high[0] > 10 or high[1] > 100:
            raise Refused(
                f'The UV map "{arrays.uv_map}" of "{target.name}" leaves the UDIM range: u is '
                f"{low[0]:.6g} to {high[0]:.6g} of 0 to 10, v is {low[1]:.6g} to {high[1]:.6g} of "
                "0 to 100. Move the islands into it"
            )
        return self.ltmd.Mesh(arrays.triangles, arrays.corner_vert, uv, len(arrays.positions))

    def _measure_in(self, target, matrix):
        """Measures the rest state in the metric of the object at this frame."""
        metric = np.eye(3) if matrix is None else matrix.T @ matrix
        known = target.prepared is not None
        if known and np.abs(metric - target.metric).max() <= METRIC_TOLERANCE:
            return
        positions = target.arrays.positions
        if matrix is not None:
            positions = transformed(positions, matrix)
        target.prepared = self.ltmd.RestState(target.mesh, positions)
        target.metric = metric

    def _baker(self, target, tile):
        baker = target.bakers.get(tile)
        if baker is None:
            baker = self.ltmd.SequenceBaker(
                target.mesh,
                target.prepared,
                self.settings.width,
                self.settings.height,
                passes=list(self.settings.passes),
                margin=self.settings.margin,
                tile=tile,
                compression=self.settings.compression,
                half=self.settings.half,
                mantissa_bits=self.settings.mantissa_bits,
                metadata=self._metadata(target, tile),
                **target.lobe,
            )
            target.bakers[tile] = baker
            target.coverage[naming.udim(tile)] = dict(baker.coverage_report)
        return baker

    def _close(self, target):
        bakers, target.bakers = target.bakers, {}
        failure = None
        for baker in bakers.values():
            try:
                baker.finish()
            except OSError as error:
                failure = failure or error
        if failure is not None:
            raise WriteFailure(str(failure)) from None

    def _conclude(self):
        """Waits for the writers and checks every written file."""
        for target in self.targets:
            self._close(target)
            if self.settings.usd:
                written = [self._usd_path(target, frame) for frame in sorted(target.todo)]
                self.problems += [
                    f"{path}: cannot be read: bake it again"
                    for path in written
                    if usd.metadata(path) is None
                ]
            if not target.todo or not self.settings.passes:
                continue
            names = {
                os.path.basename(path)[: -len(".0000.exr")]
                for files in self._paths(target, target.tiles, 0).values()
                for path in files.values()
            }
            found = self.ltmd.verify(self.folder, sorted(target.todo), sorted(names))
            self.problems += found.problems

    def _metadata(self, target, tile):
        settings = self.settings
        return {
            "ltmd:convention": CONVENTION,
            "ltmd:object": target.name,
            "ltmd:uv_map": target.uv_map,
            "ltmd:frame_start": str(min(settings.frames)),
            "ltmd:frame_end": str(max(settings.frames)),
            "ltmd:udim": str(naming.udim(tile)),
            "ltmd:per": "corner",
            "ltmd:rest": str(target.spec),
            "ltmd:margin": str(settings.margin),
            "ltmd:version": self.ltmd.__version__,
        }

    def _usd_metadata(self, target, frame):
        left_out = ("ltmd:udim", "ltmd:margin", "ltmd:frame_start", "ltmd:frame_end")
        values = self._metadata(target, (0, 0)) | {"ltmd:frame": str(frame), "ltmd:pass": "tension"}
        return {key: value for key, value in values.items() if key not in left_out}

    def _usd_path(self, target, frame):
        name = naming.file_name(target.stem, "tension", frame)
        return os.path.join(self.folder, name.removesuffix(".exr") + ".usdc")

    def _paths(self, target, tiles, frame):
        """{tile: {pass: path}} of a frame."""
        numbered = naming.is_udim(tiles)
        return {
            tile: {
                name: os.path.join(
                    self.folder,
                    naming.file_name(target.stem, name, frame, tile if numbered else None),
                )
                for name in self.settings.passes
            }
            for tile in tiles
        }

    # --- after the last frame -------------------------------------------------------------------

    def _ended(self, evaluation):
        """Waits for the writers; whatever went wrong, the files that exist are complete."""
        error = evaluation.error
        for target in self.targets:
            if evaluation.cancelled:
                for baker in target.bakers.values():
                    baker.cancel()
            try:
                self._close(target)
            except self.ltmd.Cancelled:
                pass
            except WriteFailure as failure:
                error = error or failure
        try:
            if error is not None:
                raise error
        except BaseException as raised:
            self._fail(raised)
            raise
        if evaluation.cancelled:
            self.status = "cancelled"
        else:
            self.verified = True
            self.status = "damaged" if self.problems else "ok"

    def finish(self):
        """If asked, turns the materials to the files; on the main thread."""
        if self.status != "ok":
            return
        if self.settings.switch and "tension" not in self.settings.passes:
            self.told.append("The materials stay as they are: only the pass tension turns them")
        elif self.settings.switch:
            for target in self.targets:
                self._switch(target)

    def _switch(self, target):
        obj = self._find(bpy.data.objects, target.uid)
        frames = sorted(set(self.settings.frames))
        files = {
            naming.udim(tile): {"path": paths["tension"], "frames": frames}
            for tile, paths in self._paths(target, target.tiles, frames[0]).items()
        }
        # The material must look the images up with the map they are laid out in.
        obj.ltmd.uv_map = target.uv_map
        for material in source.materials(obj):
            self.told += source.switch_to_texture(obj, material, files) or ()
        for material in source.materials(obj):
            false_colour.refresh(material, device.uses_osl(bpy.context))

    def _fail(self, error):
        status = {Refused: "refused", WriteFailure: "write_failed"}.get(type(error), "failed")
        if isinstance(error, KeyboardInterrupt):
            status = "cancelled"
        self.status = status
        self.problems += getattr(error, "problems", None) or [str(error) or type(error).__name__]

    def _find(self, collection, uid):
        found = next((data for data in collection if data.session_uid == uid), None)
        if found is None:
            raise Refused("An object or scene of this bake was removed meanwhile")
        return found

    def report(self):
        """Everything about the bake in plain types, for JSON."""
        files = [path for target in self.targets for path in target.files if os.path.exists(path)]
        return {
            "status": self.status,
            "version": getattr(getattr(self, "ltmd", None), "__version__", None),
            "folder": self.folder,
            "frames": sorted(set(self.settings.frames)),
            "passes": list(self.settings.passes),
            "files": files,
            "skipped": [path for target in self.targets for path in target.skipped],
            "seconds": round(time.monotonic() - self.started, 3),
            "verified": self.verified,
            "objects": [
                {
                    "name": target.name,
                    "library": target.library,
                    "file_stem": target.stem,
                    "rest": str(target.spec),
                    "uv_map": target.uv_map,
                    "tiles": [naming.udim(tile) for tile in target.tiles],
                    "vertices": len(target.arrays.positions) if target.arrays else None,
                    "triangles": len(target.arrays.triangles) if target.arrays else None,
                    "degenerate_triangles": target.degenerate,
                    "overlap_fraction": round(target.overlap, 6),
                    "coverage": target.coverage,
                    "files": len([path for path in target.files if os.path.exists(path)]),
                }
                for target in self.targets
            ],
            "warnings": self.warnings,
            "problems": self.problems,
        }


def _frozen_problem():
    frozen = simulation.frozen_driver()
    if frozen is None:
        return None
    return (
        f"The Python driver {frozen} may not run in this file, so the rig does not move as it "
        "should: allow the file to run scripts (--enable-autoexec) and bake again"
    )


def naming_library(obj):
    return obj.library.filepath if obj.library is not None else ""


def object_rest(obj):
    """The rest state from the settings of the object."""
    settings = obj.ltmd
    if settings.rest_mode == "FRAME":
        return rest_state.Spec("frame", frame=settings.rest_frame)
    if settings.rest_mode == "OBJECT":
        shape = settings.rest_object
        return rest_state.Spec("object", object=shape.name if shape is not None else "")
    return rest_state.Spec()


def lobe_of(obj, alpha=None):
    """The lobe at rest of the object's first set-up material, as arguments of SequenceBaker."""
    ltmd = library.ltmd()
    values = {"Roughness": 0.5, "Stretch": 0.0, "Rotation": 0.0, "Shear": 0.0}
    values |= {"Strength": 1.0, "Height Response": 0.0}
    for material in source.materials(obj)[:1]:
        node = surface.lobe(material)
        if node is not None:
            values = {
                key: node.inputs[key].default_value if key in node.inputs else value
                for key, value in values.items()
            }
    stretch = min(max(values["Stretch"], -0.99), 0.99)
    # The shader's alpha is the square of its roughness; mirrors have none to speak of.
    own = max(values["Roughness"], 0.01) ** 2
    return {
        "alpha": alpha or (own, own),
        "M0": ltmd.material_matrix(stretch, values["Rotation"], values["Shear"]),
        "strength": max(values["Strength"], 0.0),
        "height_response": values["Height Response"],
    }


def lobe_numbers(lobe):
    """The numbers of a lobe in the order of LOBE_KEYS."""
    return [*lobe["alpha"], *lobe["M0"].ravel(), lobe["strength"], lobe["height_response"]]


def metric_matrix(matrix_world):
    """The 3x3 of an object scaled to unit size, or None if it only turns, moves and scales evenly.

    Tension does not change under those, so the positions can stay as they are.
    """
    matrix = np.array(matrix_world, np.float64)[:3, :3]
    size = np.sqrt(np.sum(matrix * matrix) / 3)
    if not np.isfinite(size) or size == 0:
        return None
    matrix /= size
    if np.abs(matrix.T @ matrix - np.eye(3)).max() <= METRIC_TOLERANCE:
        return None
    return matrix


def snapped(uv):
    """UVs with those next to a tile border moved onto it."""
    border = np.rint(uv)
    return np.where(np.abs(uv - border) < UV_ROUNDING, border, uv)


def transformed(positions, matrix):
    return np.ascontiguousarray(positions.astype(np.float64) @ matrix.T, dtype=np.float32)


def hidden_reason(scene, view_layer, obj):
    """Why the render does not contain the object, or None."""
    if obj.hide_render:
        return "it is disabled in renders (the camera icon in the Outliner)"
    if obj.name not in scene.objects:
        return f'it is not in the scene "{scene.name}"'
    if not view_layer.use:
        return f'the view layer "{view_layer.name}" is not used for rendering'
    if _is_rendered(view_layer.layer_collection, obj):
        return None
    if obj.name not in view_layer.objects:
        return f'its collection is excluded from the view layer "{view_layer.name}"'
    return "its collection is disabled in renders"


def _is_rendered(layer_collection, obj):
    if layer_collection.exclude or layer_collection.collection.hide_render:
        return False
    if any(other == obj for other in layer_collection.collection.objects):
        return True
    return any(_is_rendered(child, obj) for child in layer_collection.children)


def render_layer(scene, preferred, objects):
    """The view layer to evaluate: the preferred one if it renders all objects."""
    layers = [preferred, *(layer for layer in scene.view_layers if layer != preferred)]
    for layer in layers:
        if all(hidden_reason(scene, layer, obj) is None for obj in objects):
            return layer
    return preferred


class LtmdBakeTarget(bpy.types.PropertyGroup):
    """The name of one object, as argument of ltmd.bake."""


class LTMD_OT_bake(bpy.types.Operator):
    """Bake the tension of the selected mesh objects to image files, one per frame"""

    bl_idname = "ltmd.bake"
    bl_label = "Bake Tension"

    objects: CollectionProperty(
        name="Objects",
        description="Names of the objects; none: the selected meshes",
        type=LtmdBakeTarget,
        options={"SKIP_SAVE"},
    )
    collection: StringProperty(
        name="Collection",
        description="Bake the meshes of this collection",
        options={"SKIP_SAVE"},
    )
    rest: StringProperty(
        name="Rest State",
        description="basis, frame:N or object:NAME; empty: the setting of each object",
        options={"SKIP_SAVE"},
    )
    uv_map: StringProperty(
        name="UV Map",
        description="The UV map to bake into; empty: the setting of each object",
        options={"SKIP_SAVE"},
    )
    frames: StringProperty(
        name="Frames",
        description="Such as 1-24, 7 or 1-24x2; empty: the range of the active object",
        options={"SKIP_SAVE"},
    )
    size: IntProperty(
        name="Size",
        description="Width and height of the images in pixels; 0: the setting of the object",
        default=0,
        min=0,
        max=65536,
        options={"SKIP_SAVE"},
    )
    margin: IntProperty(
        name="Margin",
        description="How far values continue beyond a UV island; -1: the setting of the object",
        default=-1,
        min=-1,
        max=64,
        options={"SKIP_SAVE"},
    )
    directory: StringProperty(
        name="Output Folder",
        description="Folder of the images; empty: the setting of the object",
        options={"SKIP_SAVE"},
    )
    passes: EnumProperty(
        name="Passes",
        description="What to bake; none: the setting of the active object",
        items=PASS_ITEMS,
        options={"ENUM_FLAG", "SKIP_SAVE"},
    )
    compression: EnumProperty(
        name="Compression",
        description="Compression of the EXR files, none of them loses anything",
        items=(
            ("zip", "ZIP", "16 rows at a time"),
            ("zips", "ZIPS", "One row at a time"),
            ("piz", "PIZ", "Wavelets"),
            ("none", "None", "Fastest to write, largest files"),
        ),
        default="zip",
        options={"SKIP_SAVE"},
    )
    half: BoolProperty(
        name="Half Float",
        description="Store 16 bits a number: a twentieth of the size, off by up to 0.05 %",
        default=False,
        options={"SKIP_SAVE"},
    )
    mantissa_bits: IntProperty(
        name="Mantissa Bits",
        description="Round the numbers to so many bits, for smaller files; 0: keep them all",
        default=0,
        min=0,
        max=23,
        options={"SKIP_SAVE"},
    )
    allow_overlap: BoolProperty(
        name="Allow Overlap",
        description="Bake although several places of the surface share texels",
        default=False,
        options={"SKIP_SAVE"},
    )
    resume: BoolProperty(
        name="Resume",
        description="Keep complete files of earlier bakes with the same settings",
        default=False,
        options={"SKIP_SAVE"},
    )
    switch: BoolProperty(
        name="Use Textures",
        description="Turn the LTMD materials of the objects to the baked images",
        default=True,
        options={"SKIP_SAVE"},
    )

    def execute(self, context):
        # Also after the question of invoke().
        return self._run(context, in_window=getattr(self, "asked", False))

    def invoke(self, context, event):
        if bpy.app.background:
            return self._run(context, in_window=False)
        try:
            objects = self._objects(context)
        except Refused:
            objects = []
        edits = [words for obj in objects for words in simulation.unkeyed_edits(obj, context.scene)]
        if edits:
            # A change of frame undoes them before anyone can read a warning.
            self.asked = True
            return context.window_manager.invoke_confirm(
                self,
                event,
                title="Edits Without Keys",
                message=f"Baking changes the frame, which undoes them: {', '.join(edits[:3])}",
                confirm_text="Bake Anyway",
                icon="WARNING",
            )
        return self._run(context, in_window=True)

    def _run(self, context, in_window):
        if evaluate.is_running() or bpy.app.is_job_running("RENDER"):
            self.report({"ERROR"}, "A bake or a render is running already")
            return {"CANCELLED"}
        bake = None
        try:
            bake = self._bake(context)
            bake.prepare()
            if in_window:
                self._say_names(bake)
                bake.start(lambda: _finish_in_window(bake))
                return {"FINISHED"}
            bake.run()
            bake.finish()
        except (Refused, WriteFailure, LibraryMissing) as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        self._say_names(bake)
        for words in bake.told:
            self.report({"INFO"}, words)
        for warning in bake.warnings:
            self.report({"WARNING"}, warning)
        if bake.status != "ok":
            self.report({"ERROR"}, _summary(bake))
            return {"CANCELLED"}
        self.report({"INFO"}, _summary(bake))
        return {"FINISHED"}

    def _say_names(self, bake):
        for target in bake.targets:
            if target.stem != target.name:
                self.report({"INFO"}, f'The files of "{target.name}" are named {target.stem}')

    def _bake(self, context):
        scene = context.scene
        objects = self._objects(context)
        if not objects:
            raise Refused("Select a mesh object to bake")
        main = context.object if context.object in objects else objects[0]
        own = main.ltmd
        try:
            rest = rest_state.Spec.parse(self.rest) if self.rest else None
            text = self.frames or f"{own.frame_start}-{own.frame_end}"
            numbers = frames.parse(text)
        except ValueError as error:
            raise Refused(str(error)) from None
        settings = Settings(
            objects=objects,
            frames=numbers,
            rest=rest,
            uv_map=self.uv_map or None,
            width=self.size or own.size,
            height=self.size or own.size,
            margin=self.margin if self.margin >= 0 else own.margin,
            folder=self.directory or own.directory,
            passes=tuple(name for name in PASSES if name.upper() in (self.passes or own.passes)),
            compression=self.compression,
            half=self.half,
            mantissa_bits=self.mantissa_bits or None,
            allow_overlap=self.allow_overlap,
            resume=self.resume,
            switch=self.switch,
        )
        return Bake(scene, render_layer(scene, context.view_layer, objects), settings)

    def _objects(self, context):
        if self.objects or self.collection:
            return named_objects(
                context.scene,
                [item.name for item in self.objects],
                [self.collection] if self.collection else [],
            )[0]
        selected = [obj for obj in context.selected_objects if obj.type == "MESH"]
        if not selected and context.object is not None:
            selected = [context.object]
        return selected


def named_objects(scene, names, collections):
    """(objects, warnings): what the names stand for. Of a collection the meshes in the render."""
    objects, warnings, problems = [], [], []
    for name in names:
        obj = scene.objects.get(name)
        if obj is None:
            problems.append(f'There is no object "{name}" in the scene "{scene.name}"')
        else:
            objects.append(obj)
    for name in collections:
        collection = bpy.data.collections.get(name)
        if collection is None and name == scene.collection.name:
            collection = scene.collection
        if collection is None:
            problems.append(f'There is no collection "{name}"')
            continue
        found = 0
        for obj in collection.all_objects:
            if obj.type != "MESH":
                continue
            layer = render_layer(scene, scene.view_layers[0], [obj])
            reason = hidden_reason(scene, layer, obj)
            if reason is None:
                objects.append(obj)
                found += 1
            else:
                warnings.append(f'"{obj.name}" is left out: {reason}')
        if not found:
            problems.append(f'The collection "{name}" has no mesh that is rendered')
    if problems:
        raise Refused(*problems)
    return list(dict.fromkeys(objects)), warnings


def _summary(bake):
    if bake.status == "ok":
        count = sum(len(target.files) for target in bake.targets)
        kept = sum(len(target.skipped) for target in bake.targets)
        return f"{count} files baked{f', {kept} kept' if kept else ''} in {bake.folder}"
    if bake.status == "cancelled":
        return "The bake was cancelled; the files written so far are complete"
    return "\n".join(bake.problems)


def _finish_in_window(bake):
    """The end of a bake in a window, on the main thread."""
    try:
        bake.finish()
    except Refused as error:
        bake.problems += error.problems
        bake.status = "refused"
    if bake.status == "ok" and bake.settings.switch:
        bpy.ops.ed.undo_push(message="Bake Tension")
    lines = [*_summary(bake).splitlines(), *bake.told, *bake.warnings]
    icon = "INFO" if bake.status == "ok" else "ERROR"
    for line in lines:
        print("LTMD:", line)

    def draw(self, _context):
        for line in lines:
            self.layout.label(text=line)

    manager = bpy.context.window_manager
    if manager.windows:
        with bpy.context.temp_override(window=manager.windows[0]):
            manager.popup_menu(draw, title="Bake Tension", icon=icon)


CLASSES = (LtmdBakeTarget, LTMD_OT_bake)


def register():
    for cls in CLASSES:
        bpy.utils.register_class(cls)


def unregister():
    for cls in reversed(CLASSES):
        bpy.utils.unregister_class(cls)
