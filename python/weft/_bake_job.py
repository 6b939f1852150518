"""Jobs of `python -m weft.bake`: the folder that a program writes, and the bake reads.

    job.json            settings, and the sizes of all arrays
    cloth_0_rest.npy …  arrays of each cloth and collider, by the names of the fields below
    motion.bin          a record per frame, appended while the bake runs: matrices, pinned vertices, colliders
"""

from __future__ import annotations

import fcntl
import json
import os
import signal
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core

FORMAT = 1
_ARRAYS = {
    "rest": (np.float64, 3), "start": (np.float64, 3), "faces": (np.int32, 3), "uv": (np.float64, None),
    "pins": (np.int32, 0), "weights": (np.float64, 0), "stitches": (np.int32, 2),
}  # fmt: skip


@dataclass
class ClothInput:
    """A cloth of a bake. Its arrays are by vertex of the program's mesh, in the world's coordinates [m].

    rest: the rest shape (n, 3). start: positions at the first frame (n, 3). faces: triangles (t, 3). uv: (t, 3, 2), warp runs
    along u; None: `warp`, a direction of the rest shape. pins: pinned vertices (k,), and their weights (k,) in (0, 1]: 1 is
    held, less is a spring (`pin_stiffness`). stitches: pairs of vertices that draw together within seam_time [s]. layer: order
    of garments over each other. cache: the PC2 file that is written.
    """

    name: str
    cache: str
    fabric: dict[str, Any]
    rest: NDArray[np.float64]
    start: NDArray[np.float64]
    faces: NDArray[np.int32]
    uv: NDArray[np.float64] | None = None
    warp: tuple[float, float, float] | None = None
    pins: NDArray[np.int32] = field(default_factory=lambda: np.empty(0, np.int32))
    weights: NDArray[np.float64] = field(default_factory=lambda: np.empty(0))
    stitches: NDArray[np.int32] = field(default_factory=lambda: np.empty((0, 2), np.int32))
    seam_time: float = 1.0
    layer: int = 0


@dataclass
class ColliderInput:
    """A mesh that cloth collides with. start: positions at the first frame (n, 3) [m]. faces: triangles (t, 3). solid:
    as in `World.add_collider`."""

    name: str
    start: NDArray[np.float64]
    faces: NDArray[np.int32]
    friction: float = 0.3
    solid: bool | None = None


@dataclass
class Job:
    """A bake: `num_frames` frames, the start included.

    first_frame: its number, in messages and caches. threads: 0: one per core. gravity [m/s²]. untangle: whether cloth that
    crosses something at the start is set apart.
    """

    fps: float
    num_frames: int
    cloths: list[ClothInput]
    colliders: list[ColliderInput] = field(default_factory=list)
    first_frame: int = 1
    steps_per_frame: int = 1
    quality: str = "default"
    threads: int = 0
    gravity: tuple[float, float, float] = (0.0, 0.0, -9.81)
    untangle: bool = True

    def write(self, folder: str | os.PathLike[str]) -> None:
        """Begins a job: earlier contents of the folder, but no caches, are removed."""
        path = Path(folder)
        path.mkdir(parents=True, exist_ok=True)
        with take_over(path):
            for name in ("job.json", "motion.bin", "checkpoint.weft", "report.json"):
                (path / name).unlink(missing_ok=True)
            contents: dict[str, Any] = {"format": FORMAT}
            for entry in fields(self):
                if entry.name not in ("cloths", "colliders"):
                    contents[entry.name] = getattr(self, entry.name)
            contents["cloths"] = [_write(path, f"cloth_{n}", cloth) for n, cloth in enumerate(self.cloths)]
            contents["colliders"] = [_write(path, f"collider_{n}", body) for n, body in enumerate(self.colliders)]
            (path / "job.json.partial").write_text(json.dumps(contents, indent=1), encoding="utf-8")
            os.replace(path / "job.json.partial", path / "job.json")

    @staticmethod
    def read(folder: str | os.PathLike[str]) -> Job:
        """Raises InputError for a folder without a job, or with a damaged one."""
        path = Path(folder)
        try:
            contents = json.loads((path / "job.json").read_text(encoding="utf-8"))
            if contents.pop("format") != FORMAT:
                raise _core.InputError(f"{path}/job.json is a job of another version of Weft; bake again")
            cloths = [_read(path, f"cloth_{n}", ClothInput, entry) for n, entry in enumerate(contents.pop("cloths"))]
            bodies = [_read(path, f"collider_{n}", ColliderInput, e) for n, e in enumerate(contents.pop("colliders"))]
            contents["gravity"] = tuple(contents["gravity"])
            return Job(cloths=cloths, colliders=bodies, **contents)
        except FileNotFoundError as error:
            raise _core.InputError(f"{path} holds no job: there is no {Path(error.filename).name}") from None
        except OSError as error:
            raise _core.InputError(f"{path}: {error.strerror}") from None
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            if isinstance(error, _core.InputError):
                raise
            raise _core.InputError(f"{path} holds a damaged job ({error}); bake again") from None

    def difference(self, other: Job) -> str:
        """What differs from another job, in words; empty: nothing that a bake depends on."""
        for entry in fields(self):
            if entry.name not in ("cloths", "colliders", "threads") and getattr(self, entry.name) != getattr(other, entry.name):
                return entry.name.replace("_", " ")
        if self._names() != other._names():
            return "the objects"
        mine: list[ClothInput | ColliderInput] = [*self.cloths, *self.colliders]
        others: list[ClothInput | ColliderInput] = [*other.cloths, *other.colliders]
        for body, twin in zip(mine, others, strict=True):
            for entry in fields(body):
                a, b = getattr(body, entry.name), getattr(twin, entry.name)
                if entry.name in _ARRAYS and a is not None and b is not None:
                    same = a.shape == b.shape and np.allclose(a, b, rtol=0, atol=1e-6)
                else:
                    same = a is b or json.dumps(a) == json.dumps(b)
                if not same:
                    return f'{entry.name} of "{body.name}"'
        return ""

    def _names(self) -> tuple[list[str], list[str]]:
        return [cloth.name for cloth in self.cloths], [body.name for body in self.colliders]

    @property
    def record(self) -> np.dtype[Any]:
        """A frame in motion.bin: to_world of each cloth, its pinned vertices; the vertices of each collider [m]."""
        parts: list[Any] = []
        for n, cloth in enumerate(self.cloths):
            parts += [(f"to_world_{n}", "<f8", (4, 4)), (f"pins_{n}", "<f8", (len(cloth.pins), 3))]
        parts += [(f"collider_{n}", "<f4", (len(body.start), 3)) for n, body in enumerate(self.colliders)]
        return np.dtype(parts)


def take_over(folder: Path) -> BinaryIO:
    """A lock on the folder, until it is closed: an earlier bake, whose program has gone, is asked to end first."""
    stream = open(folder / "lock", "a+b")
    try:
        fcntl.flock(stream, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        stream.seek(0)
        os.kill(int(stream.read()), signal.SIGTERM)
        fcntl.flock(stream, fcntl.LOCK_EX)
    stream.truncate(0)
    stream.write(str(os.getpid()).encode())
    stream.flush()
    return stream


def _write(folder: Path, prefix: str, part: Any) -> dict[str, Any]:
    entry = {}
    for one in fields(part):
        value = getattr(part, one.name)
        if one.name in _ARRAYS and value is not None:
            np.save(folder / f"{prefix}_{one.name}.npy", np.ascontiguousarray(value, _ARRAYS[one.name][0]))
            value = list(np.shape(value))
        entry[one.name] = value
    return entry


def _read(folder: Path, prefix: str, kind: Any, entry: dict[str, Any]) -> Any:
    values = dict(entry)
    for name in _ARRAYS.keys() & values.keys():
        if values[name] is not None:
            values[name] = np.load(folder / f"{prefix}_{name}.npy", allow_pickle=False)
            if list(values[name].shape) != entry[name]:
                raise _core.InputError(f"{folder}/{prefix}_{name}.npy is damaged; bake again")
    if values.get("warp") is not None:
        values["warp"] = tuple(values["warp"])
    return kind(**values)


class MotionWriter:
    """Appends frames to a job's motion.bin; those that are there stay."""

    def __init__(self, folder: str | os.PathLike[str], job: Job) -> None:
        self._record = job.record
        self._file: BinaryIO = open(Path(folder) / "motion.bin", "ab")
        self.num_frames = self._file.tell() // self._record.itemsize
        self._file.truncate(self.num_frames * self._record.itemsize)
        self._file.seek(0, os.SEEK_END)

    def add_frame(self, to_world: list[ArrayLike], pins: list[ArrayLike], colliders: list[ArrayLike]) -> None:
        """to_world: of each cloth, from its own coordinates in the cache to the world's in metres: (4, 4)."""
        frame = np.zeros((), self._record)
        for n, (matrix, points) in enumerate(zip(to_world, pins, strict=True)):
            frame[f"to_world_{n}"], frame[f"pins_{n}"] = matrix, points
        for n, points in enumerate(colliders):
            frame[f"collider_{n}"] = points
        self._file.write(frame.tobytes())
        self._file.flush()
        self.num_frames += 1

    def close(self) -> None:
        self._file.close()


class MotionReader:
    """Frames of a job's motion.bin, which may grow meanwhile."""

    def __init__(self, folder: str | os.PathLike[str], job: Job) -> None:
        self._path, self._record = Path(folder) / "motion.bin", job.record

    @property
    def num_frames(self) -> int:
        """Whole ones, now."""
        try:
            return self._path.stat().st_size // self._record.itemsize
        except FileNotFoundError:
            return 0

    def frame(self, k: int) -> np.void:
        """Raises InputError for numbers that are not finite."""
        rows: NDArray[np.void] = np.fromfile(self._path, self._record, 1, offset=k * self._record.itemsize)
        frame: np.void = rows[0]
        for name in self._record.names or ():
            if not np.isfinite(frame[name]).all():
                raise _core.InputError(f"motion.bin: {name} of frame {k} is not a finite number")
        return frame
