"""The verbs of `python -m weft`: run, check, convert, scenes, fabrics, bench."""

from __future__ import annotations

import argparse
import os
import re
import sys
from pathlib import Path

from . import _core, bench
from ._convert import as_options, convert_files
from ._errors import SimulationError
from ._scene import Scene, load_scene, run, scenes


def _load(options: argparse.Namespace) -> Scene:
    scene = load_scene(options.scene)
    for assignment in options.set:
        scene.set(assignment)
    return scene


def _run(options: argparse.Namespace) -> int:
    scene = _load(options)
    folder = options.out or os.path.join("out", scene.name)
    result = run(
        scene, frames=options.frames, threads=options.threads, out=folder, progress=True, glb=options.glb,
        obj=options.obj, audit=options.audit, start_from=options.start_from, unfinished=options.unfinished,
    )  # fmt: skip
    print(f"{scene.name}: {result.num_frames} frames, state hash {result.report['state_hash']}, {folder}")
    for problem in result.problems:
        print(f"problem: {problem}", file=sys.stderr)
    if result.outcome == "interrupted":
        return 130
    return int(result.outcome == "failed" or (options.strict and bool(result.problems)))


def _check(options: argparse.Namespace) -> int:
    scene = _load(options)
    scene.world()
    print(f"{scene.name}: valid")
    return 0


def _convert(options: argparse.Namespace) -> int:
    os.environ.setdefault("USDC_USE_PREAD", "1")  # read by USD: files are read, not mapped, and leave memory again
    frames = None if options.frames is None else _frames(options.frames)
    chosen = as_options(options.fps, options.up, options.scale, frames, options.mesh, options.node)
    try:
        files, notes = convert_files(Path(options.file), Path(options.out), chosen)
    except ImportError as error:
        raise _core.InputError(str(error)) from None
    for note in notes:
        print(f"note: {note}", file=sys.stderr)
    print("\n".join(map(str, files)))
    return 0


def _frames(text: str) -> tuple[int, int | None]:
    """A:B, A: or :B."""
    found = re.fullmatch("([0-9]*):([0-9]*)", text)
    if not found:
        raise _core.InputError(f"--frames {text}: expected FIRST:LAST, whole numbers from 0")
    return int(found[1] or 0), int(found[2]) if found[2] else None


def _scenes(options: argparse.Namespace) -> int:
    print("\n".join(scenes()))
    return 0


def _fabrics(options: argparse.Namespace) -> int:
    print("\n".join(f"{name}: {text}" for name, text in _core.fabric_presets()))
    return 0


def _bench(options: argparse.Namespace) -> int:
    bench.main()
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m weft", description="Cloth simulation.")
    parser.add_argument("--version", action="version", version=f"weft {_core.version}")
    verbs = parser.add_subparsers(required=True, metavar="VERB")
    for name, call, text in (
        ("run", _run, "simulate a scene; write its frames and a report"),
        ("check", _check, "check a scene file: every mistake, with line and column"),
        ("convert", _convert, "convert a mesh, a point cache, the point caches of a run, or USD"),
        ("scenes", _scenes, "list the shipped scenes"),
        ("fabrics", _fabrics, "list the fabrics by name"),
        ("bench", _bench, "measure the package's speed, as ratios"),
    ):
        verb = verbs.add_parser(name, help=text, description=text)
        verb.set_defaults(call=call)
        if name == "convert":
            _add_convert(verb)
        if name not in ("run", "check"):
            continue
        verb.add_argument("scene", help="a scene file, or the name of a shipped scene")
        verb.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="change a value")
        if name == "check":
            continue
        verb.add_argument("--out", metavar="DIR", help="folder for the results (default: out/SCENE)")
        verb.add_argument("--frames", type=int, help="frames to simulate, instead of the scene's own duration")
        verb.add_argument("--threads", type=int, default=1, help="threads (default: 1); never changes the result")
        verb.add_argument("--no-glb", dest="glb", action="store_false", help="do not write animation.glb")
        verb.add_argument("--obj", action="store_true", help="also write an OBJ file per cloth and frame")
        verb.add_argument("--audit", action="store_true", help="also report the energy balance; slower")
        verb.add_argument("--start-from", metavar="DIR@FRAME", help="begin with the cloths of a frame of an earlier run")
        kept = verb.add_mutually_exclusive_group()
        kept.add_argument("--resume", dest="unfinished", action="store_const", const="resume", default="refuse",
                          help="continue an unfinished run in the folder")  # fmt: skip
        kept.add_argument("--fresh", dest="unfinished", action="store_const", const="discard", default="refuse",
                          help="discard an unfinished run in the folder")  # fmt: skip
        verb.add_argument("--strict", action="store_true", help="exit with 1 if the run has problems")
    return parser


def _add_convert(verb: argparse.ArgumentParser) -> None:
    verb.add_argument("file", metavar="IN", help="a mesh (.obj, .ply, .stl, .glb, .gltf), a point cache "
                      "(.pc2, .mdd), the folder of a run, or USD (.usdc, .usda, .usd, .usdz)")  # fmt: skip
    verb.add_argument("out", metavar="OUT", help="a mesh (.obj, .ply; of a cache one per frame), a point cache "
                      "(.pc2, .mdd), or USD (.usdc, .usda, .usd); USD needs pip install weft[usd]")  # fmt: skip
    verb.add_argument("--fps", type=float, metavar="N", help="frames per second of a cache that does not say it "
                      "(default: 60); of USD, the frames that are sampled")  # fmt: skip
    verb.add_argument("--up", choices=("y", "z"), help="the input's vertical axis; the output's is y "
                      "(default: y; USD says it)")  # fmt: skip
    verb.add_argument("--scale", type=float, metavar="S", help="length of the input's unit in metres "
                      "(default: 1; USD says it)")  # fmt: skip
    verb.add_argument("--frames", metavar="A:B", help="the frames to convert, from 0, both included")
    verb.add_argument("--mesh", metavar="FILE", help="the mesh of a cache's points, to write .obj, .ply or USD; a run "
                      "has its own")  # fmt: skip
    verb.add_argument("--node", metavar="PATH", help="prim of USD whose meshes are read (default: all)")


def main() -> int:
    """Exit code: 0 done, 1 failed, 2 bad input, 130 interrupted."""
    options = _parser().parse_args()
    try:
        code: int = options.call(options)
        return code
    except (_core.InputError, _core.GraphicsError) as error:
        print(error, file=sys.stderr)
        return 2
    except SimulationError as error:
        print(error, file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(main())
