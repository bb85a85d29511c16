# SPDX-License-Identifier: GPL-3.0-or-later
"""`blender SCENE.blend -c ltmd bake …` and `ltmd verify DIR`: bakes without a display.

Exit codes: 0 done; 1 failed otherwise; 2 wrong arguments; 3 the scene cannot be baked as asked;
4 a file or folder could not be written; 5 cancelled, the files written so far are complete;
6 files are missing or damaged.
"""

import argparse
import contextlib
import json
import os
import signal
import sys
import traceback

import bpy

from . import bake, frames, library, rest_state, simulation
from .library import LibraryMissing

OK, FAILED, USAGE, REFUSED, WRITE_FAILED, CANCELLED, DAMAGED = range(7)
CODES = {
    "ok": OK,
    "failed": FAILED,
    "refused": REFUSED,
    "write_failed": WRITE_FAILED,
    "cancelled": CANCELLED,
    "damaged": DAMAGED,
}


def _frames(text):
    try:
        return frames.parse(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _rest(text):
    try:
        return rest_state.Spec.parse(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from None


def _size(text):
    try:
        size = int(text)
    except ValueError:
        size = 0
    if not 1 <= size <= 65536:
        raise argparse.ArgumentTypeError(f"a size is 1 to 65536 pixels, not {text!r}")
    return size


def _margin(text):
    if not text.isdigit() or int(text) > 64:
        raise argparse.ArgumentTypeError(f"a margin is 0 to 64 pixels, not {text!r}")
    return int(text)


def _passes(text):
    names = [name for name in text.split(",") if name]
    for name in names:
        if name not in bake.PASSES:
            raise argparse.ArgumentTypeError(
                f"there is no pass {name!r}, choose from {', '.join(bake.PASSES)}"
            )
    return names


def _mantissa_bits(text):
    if not text.isdigit() or not 1 <= int(text) <= 23:
        raise argparse.ArgumentTypeError(f"mantissa bits are 1 to 23, not {text!r}")
    return int(text)


def _alpha(text):
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if not 1 <= len(values) <= 2 or not all(0 < value < 1e3 for value in values):
        raise argparse.ArgumentTypeError(f"alpha is one or two numbers above 0, not {text!r}")
    return values[0], values[-1]


def make_parser():
    parser = argparse.ArgumentParser(
        prog="ltmd",
        description="Bake the deformation of meshes to EXR files.",
        epilog=__doc__.split("\n\n", 1)[1],
    )
    commands = parser.add_subparsers(dest="command", required=True)

    baking = commands.add_parser("bake", help="bake frames of objects", epilog=parser.epilog)
    baking.add_argument("scene", nargs="?", metavar="SCENE.blend", help="the file to open first")
    what = baking.add_mutually_exclusive_group(required=True)
    what.add_argument("--object", action="append", nargs="+", metavar="NAME", default=[])
    what.add_argument(
        "--collection",
        action="append",
        metavar="NAME",
        default=[],
        help="all meshes of the collection that are rendered",
    )
    baking.add_argument(
        "--rest",
        type=_rest,
        metavar="basis|frame:N|object:NAME",
        help="the state without deformation (default: the setting of each object, else basis)",
    )
    baking.add_argument("--uv-map", metavar="NAME", help="default: the map active for render")
    baking.add_argument(
        "--frames", type=_frames, metavar="1-24", help="7, 1-24, 1-10,20 or 1-24x2 (default: scene)"
    )
    baking.add_argument("--size", type=_size, default=1024, help="pixels (default: 1024)")
    baking.add_argument("--margin", type=_margin, default=16, help="pixels (default: 16)")
    baking.add_argument(
        "--pass",
        dest="passes",
        action="extend",
        type=_passes,
        metavar="NAME[,NAME…]",
        help=f"of {', '.join(bake.PASSES)} (default: tension); may be repeated",
    )
    baking.add_argument(
        "--alpha",
        type=_alpha,
        metavar="X[,Y]",
        help="of the passes alpha2 and roughness at rest (default: the material's roughness²)",
    )
    baking.add_argument(
        "--usd",
        action="store_true",
        help="a .usdc a frame: the mesh with the tension as primvar; no images without --pass",
    )
    baking.add_argument(
        "--out", metavar="DIR", default="//ltmd/", help="default: //ltmd/, beside the scene file"
    )
    baking.add_argument("--compression", choices=bake.COMPRESSIONS, default="zip")
    baking.add_argument(
        "--half", action="store_true", help="16-bit float: smaller, off by ≤ 0.05 %%"
    )
    baking.add_argument(
        "--mantissa-bits",
        type=_mantissa_bits,
        metavar="1-23",
        help="round to so many bits for smaller files (default: keep all)",
    )
    baking.add_argument("--json", action="store_true", help="print one JSON report on stdout")
    baking.add_argument(
        "--enable-autoexec", action="store_true", help="let the scene file run its Python drivers"
    )
    baking.add_argument(
        "--resume", action="store_true", help="keep complete files with the same settings"
    )
    baking.add_argument(
        "--allow-overlap", action="store_true", help="bake UV maps that use texels twice"
    )

    verifying = commands.add_parser("verify", help="check baked files", epilog=parser.epilog)
    verifying.add_argument("directory", metavar="DIR")
    verifying.add_argument("--frames", type=_frames, metavar="1-24", help="frames that must exist")
    verifying.add_argument("--json", action="store_true", help="print one JSON report on stdout")
    return parser


def main(arguments):
    """Runs the command and returns its exit code."""
    try:
        options = make_parser().parse_args(arguments)
    except SystemExit as ending:
        return ending.code or OK
    report = {"command": options.command, "status": "failed", "warnings": [], "problems": []}
    if options.command == "bake":
        # Readers find the same keys whatever happens.
        report |= {"folder": "", "frames": [], "files": [], "skipped": [], "objects": []}
        report |= {"seconds": 0.0, "verified": False}
    with _quiet_stdout(options.json) as out, _Stop() as stop:
        try:
            run = {"bake": _bake, "verify": _verify}[options.command]
            run(options, report, stop)
        except bake.Refused as error:
            _fail(report, "refused", error.problems)
        except bake.WriteFailure as error:
            _fail(report, "write_failed", [str(error)])
        except LibraryMissing as error:
            _fail(report, "failed", [str(error)])
        except KeyboardInterrupt:
            _fail(report, "cancelled", [])
        except Exception as error:
            traceback.print_exc()
            _fail(report, "failed", [f"{type(error).__name__}: {error}"])
        code = CODES[report["status"]]
        report["exit_code"] = code
        _print_report(options, report, out)
    return code


def _fail(report, status, problems):
    report["status"] = status
    report["problems"] = list(dict.fromkeys([*report["problems"], *problems]))


def _bake(options, report, stop):
    # Before anything else: without the library an open file is of no use.
    library.ltmd()
    _open_scene(options)
    scene = bpy.context.scene
    names = [name for group in options.object for name in group]
    objects, warnings = bake.named_objects(scene, names, options.collection)
    report["warnings"] = warnings
    layer = bake.render_layer(scene, bpy.context.view_layer, objects)
    settings = bake.Settings(
        objects=objects,
        frames=options.frames or list(range(scene.frame_start, scene.frame_end + 1)),
        rest=options.rest,
        uv_map=options.uv_map,
        width=options.size,
        height=options.size,
        margin=options.margin,
        passes=tuple(dict.fromkeys(options.passes or (() if options.usd else bake.DEFAULT_PASSES))),
        folder=_folder(options.out),
        compression=options.compression,
        half=options.half,
        mantissa_bits=options.mantissa_bits,
        alpha=options.alpha,
        usd=options.usd,
        allow_overlap=options.allow_overlap,
        resume=options.resume,
    )

    def progress(frame, done, count):
        print(f"ltmd: frame {frame} ({done} of {count})", file=sys.stderr, flush=True)

    work = None
    try:
        work = bake.Bake(scene, layer, settings, progress)
        work.prepare()
        work.run(stop)
        work.finish()
    finally:
        if work is not None:
            report.update(work.report())
            report["warnings"] = warnings + report["warnings"]


def _open_scene(options):
    path = options.scene
    if path is None and not bpy.data.filepath:
        if options.enable_autoexec:
            raise bake.Refused("There is no scene file: give SCENE.blend")
        return
    if path is not None and not os.path.isfile(path):
        raise bake.Refused(f'There is no file "{path}"')
    if path is None and options.enable_autoexec and simulation.frozen_driver():
        # The file was loaded before this command could allow its scripts.
        path = bpy.data.filepath
    if path is not None:
        try:
            bpy.ops.wm.open_mainfile(
                filepath=os.path.abspath(path), use_scripts=options.enable_autoexec, load_ui=False
            )
        except RuntimeError as error:
            raise bake.Refused(f'The file "{path}" cannot be opened: {error}') from None
    # Drivers that may not run are noticed when they are first evaluated.
    bpy.context.view_layer.update()


def _folder(text):
    # Relative to the shell's folder, as everywhere on a command line; // as everywhere in Blender.
    return text if text.startswith("//") else os.path.abspath(text)


def _verify(options, report, _stop):
    ltmd = library.ltmd()
    report["folder"] = os.path.abspath(options.directory)
    if not os.path.isdir(options.directory):
        raise bake.Refused(f'There is no folder "{options.directory}"')
    found = ltmd.verify(options.directory, options.frames)
    report["sequences"] = {
        name: list(map(int, numbers)) for name, numbers in found.sequences.items()
    }
    report["problems"] = list(found.problems)
    if not found.sequences:
        report["problems"].append(f'"{options.directory}" holds no baked files')
    report["status"] = "damaged" if report["problems"] else "ok"


def _print_report(options, report, out):
    if options.json:
        out.write(json.dumps(report) + "\n")
        out.flush()
        return
    for target in report.get("objects", ()):
        if target["file_stem"] != target["name"]:
            print(f'ltmd: the files of "{target["name"]}" are named {target["file_stem"]}')
    for warning in report["warnings"]:
        print("ltmd: warning:", warning, file=sys.stderr)
    for problem in report["problems"]:
        print("ltmd:", problem, file=sys.stderr)
    if report["command"] == "verify":
        for name, numbers in report.get("sequences", {}).items():
            print(f"ltmd: {name}: {len(numbers)} frames, {numbers[0]} to {numbers[-1]}")
    elif report["files"] or report["skipped"]:
        print(
            f"ltmd: {len(report['files'])} files written, {len(report['skipped'])} kept, in "
            f"{report['folder']} ({report['seconds']:.1f} s)"
        )
    print("ltmd:", report["status"].replace("_", " "), flush=True)


@contextlib.contextmanager
def _quiet_stdout(only_json):
    """With JSON nothing else may be on stdout, and Blender itself prints there."""
    sys.stdout.flush()
    if not only_json:
        yield sys.stdout
        return
    saved = os.dup(1)
    os.dup2(2, 1)
    try:
        with os.fdopen(os.dup(saved), "w") as out:
            yield out
    finally:
        sys.stdout.flush()
        os.dup2(saved, 1)
        os.close(saved)


class _Stop:
    """True after SIGINT or SIGTERM: a farm that takes the machine back gets whole files."""

    SIGNALS = (signal.SIGINT, signal.SIGTERM)

    def __init__(self):
        self.requested = False
        self.before = {}

    def __call__(self):
        return self.requested

    def __enter__(self):
        with contextlib.suppress(ValueError):
            for number in self.SIGNALS:
                self.before[number] = signal.signal(number, self._request)
        return self

    def _request(self, *_):
        self.requested = True

    def __exit__(self, *_):
        for number, handler in self.before.items():
            signal.signal(number, handler if handler is not None else signal.SIG_DFL)


_handle = None


def register():
    global _handle
    _handle = bpy.utils.register_cli_command("ltmd", main)


def unregister():
    global _handle
    if _handle is not None:
        bpy.utils.unregister_cli_command(_handle)
        _handle = None
