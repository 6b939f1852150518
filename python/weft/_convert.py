"""Conversion of files: meshes, point caches, runs, and USD where usd-core is installed."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import _core
from ._arguments import choose, real, whole
from ._errors import tell_of_file

USD_ENDINGS = (".usd", ".usda", ".usdc", ".usdz")


@dataclass(frozen=True)
class Options:
    """Options of a conversion, as in convert(). None: the file's own value, or the usual one."""

    fps: float | None = None
    up: str | None = None
    scale: float | None = None
    frames: tuple[int, int | None] = (0, None)
    mesh: Path | None = None
    node: str | None = None

    def range_of(self, name: object, count: int) -> range:
        """The chosen frames of `count`."""
        first, last = self.frames[0], count - 1 if self.frames[1] is None else self.frames[1]
        if not 0 <= first <= last < count:
            raise _core.InputError(f"{name} has the frames 0 to {count - 1}; it has not {first} to {last}")
        return range(first, last + 1)


def is_usd(file: Path) -> bool:
    """Whether the name has one of USD's endings."""
    return file.suffix.lower() in USD_ENDINGS


def convert_files(file: Path, out: Path, options: Options) -> tuple[list[Path], list[str]]:
    """Written files, and notes as sentences."""
    if is_usd(file) or is_usd(out):
        from . import usd

        return usd.convert_files(file, out, options)
    if options.node is not None:
        raise _core.InputError("node: an option of conversions from USD only")
    scale, mesh = options.scale or 1.0, "" if options.mesh is None else str(options.mesh)
    files, notes = _core.convert(str(file), str(out), options.fps, options.up == "z", scale, *options.frames, mesh)
    return [Path(name) for name in files], notes


def as_options(
    fps: float | None, up: str | None, scale: float | None, frames: tuple[int, int | None] | None,
    mesh: str | os.PathLike[str] | None, node: str | None,
) -> Options:  # fmt: skip
    """Checked options."""
    for name, value in (("fps", fps), ("scale", scale)):
        if value is not None and not real(value, name) > 0:
            raise _core.InputError(f"{name}: expected a number above 0, found {value}")
    if up not in (None, "y", "z"):
        raise _core.InputError(f'up: expected "y" or "z", found {up!r:.60}')
    first, last = (0, None) if frames is None else _first_and_last(frames)
    if node is not None:
        choose(node, "node", str, "the path of a prim")
    return Options(fps, up, scale, (first, last), None if mesh is None else Path(mesh), node)


def _first_and_last(frames: Any) -> tuple[int, int | None]:
    choose(frames, "frames", (tuple, list), "the first and the last frame")
    if len(frames) != 2:
        raise _core.InputError(f"frames: expected the first and the last frame, found {frames!r:.60}")
    first, last = whole(frames[0], "frames"), None if frames[1] is None else whole(frames[1], "frames")
    if first < 0:
        raise _core.InputError(f"frames: expected whole numbers from 0, found {first}")
    return first, last


def convert(
    file: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    fps: float | None = None,
    up: str | None = None,
    scale: float | None = None,
    frames: tuple[int, int | None] | None = None,
    mesh: str | os.PathLike[str] | None = None,
    node: str | None = None,
) -> list[Path]:
    """Converts a mesh (OBJ, PLY, STL, glTF), a point cache (PC2, MDD), the folder of a run, or USD; the endings decide.

    Meshes become OBJ, PLY or USD; those of glTF also PC2 or MDD. Point caches and runs become PC2, MDD, USD, or a mesh
    per frame. USD becomes a mesh or a point cache; it needs `pip install weft[usd]`. Returns the written files: of a
    run with several cloths one for each, in USD one.

    fps: frames per second of a cache that does not say it, by default 60; of USD, the frames that are sampled.
    up: the input's vertical axis, "y" or "z"; the output's is y. scale: length of the input's unit [m]. USD says
    both itself. frames: the first and the last frame, from 0; None: to the end. mesh: the mesh file of a point cache's
    points, for meshes and USD; a run has its own. node: the prim of USD whose meshes are read; by default all.

    A FileWarning names what a file cannot say or hold, and an absurd size. Raises InputError for files that cannot be
    read, written or converted; an earlier `out` then stays. Raises ImportError without usd-core.
    """
    files, notes = convert_files(Path(file), Path(out), as_options(fps, up, scale, frames, mesh, node))
    tell_of_file(notes)
    return files
