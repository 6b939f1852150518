"""Folder of a farm, shared by all processes that compute its cases: rows, frames, checkpoints, marks.

    rows/HASH.jsonl       rows, one case per line; named by the SHA-256 of the file, and never changed
    frames/ID/            point caches and meshes of a case
    parts/ID/             the same of an unfinished case, and its checkpoint
    live/FARM/            functions of a running farm; marks of started batches and of cases alone in a worker
    cases.parquet         all rows, for other programs

Rows are the state of a farm. Any process may add a file of rows at any time; two rows of one case are harmless.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import json
import os
import re
import shutil
import struct
import uuid
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from . import _core
from ._mesh import Mesh, write_obj
from ._world import World

Row = dict[str, Any]

_MERGED = 8 << 20  # files of rows below this size are merged [bytes]
_CHECKPOINT = b"weft farm checkpoint 1\n"
_PC2 = struct.Struct("<12siiffi")


class Unwritable(Exception):
    """The folder cannot be written by this process; not a fault of the case."""


def plain(value: Any, name: str) -> Any:
    """A value as JSON has it. Raises InputError for one that JSON has not."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, np.generic):
        value = value.item()
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if hasattr(value, "_asdict"):
        value = value._asdict()
    if isinstance(value, Mapping):
        return {str(key): plain(item, name) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item, name) for item in value]
    raise _core.InputError(f"{name}: expected a number, text, array, list or dict, found {value!r:.60}")


def canonical(case: Mapping[str, Any]) -> str:
    """A case's values as text, independent of their order."""
    return json.dumps(case, sort_keys=True)


@functools.cache
def build_id() -> str:
    """Version and the engine's compiled module: equal in processes with equal results."""
    with open(_core.__file__, "rb") as stream:
        return f"{_core.version} {hashlib.sha256(stream.read()).hexdigest()[:16]}"


def case_id(world: bytes, seconds: float, dt: float, key: str) -> str:
    """SHA-256 of everything that a case's result follows from."""
    digest = hashlib.sha256(b"weft farm 1")
    for part in (world, struct.pack("<dd", seconds, dt), build_id().encode(), key.encode()):
        digest.update(struct.pack("<q", len(part)))
        digest.update(part)
    return digest.hexdigest()


# Files.


def sync(path: Path) -> None:
    """Waits until a file or a folder is on disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def write_whole(file: Path, data: bytes) -> None:
    """Writes a file that is complete or absent, also after a crash of the machine."""
    part = file.with_name(f".{uuid.uuid4().hex}.partial")
    try:
        with open(part, "xb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(part, file)
    except BaseException:
        part.unlink(missing_ok=True)
        raise
    sync(file.parent)


# Rows.


def add_rows(folder: Path, rows: Iterable[Row]) -> None:
    """Adds a file of rows. Raises OSError if the folder cannot be written."""
    data = "".join(json.dumps(row) + "\n" for row in rows).encode()
    write_whole(folder / "rows" / f"{hashlib.sha256(data).hexdigest()[:32]}.jsonl", data)


def _rank(row: Row) -> tuple[bool, bool, str]:
    """The row of a case that counts is the largest: without an error, with frames, the newest."""
    return (row["error"] is None, row["frames"] is not None, row["finished"])


def _files(folder: Path) -> list[str]:
    return sorted(name for name in os.listdir(folder / "rows") if name.endswith(".jsonl"))


def read_rows(folder: Path) -> dict[tuple[str, str], Row]:
    """All rows, by id and canonical case."""
    rows: dict[tuple[str, str], Row] = {}
    for row in _new_rows(folder, set()):
        place = (row["id"], canonical(row["case"]))
        if place not in rows or _rank(rows[place]) < _rank(row):
            rows[place] = row
    return rows


def _new_rows(folder: Path, seen: set[str]) -> Iterator[Row]:
    """Rows of the files that are not in `seen`, which they are added to."""
    while True:
        try:
            for name in _files(folder):
                if name not in seen:
                    data = (folder / "rows" / name).read_bytes()
                    seen.add(name)
                    yield from map(json.loads, data.splitlines())
            return
        except FileNotFoundError:  # merged since the list was made; its rows are in a file that is newer than the list
            continue


def merge_rows(folder: Path) -> None:
    """Replaces small files of rows by one. Files are removed only after a file with all their rows is on disk."""
    small = [name for name in _files(folder) if (folder / "rows" / name).stat().st_size < _MERGED]
    if len(small) < 2:
        return
    lines: list[bytes] = []
    for name in small:
        lines += (folder / "rows" / name).read_bytes().splitlines(keepends=True)
    data = b"".join(dict.fromkeys(lines))
    merged = f"{hashlib.sha256(data).hexdigest()[:32]}.jsonl"
    write_whole(folder / "rows" / merged, data)
    for name in small:
        if name != merged:
            (folder / "rows" / name).unlink(missing_ok=True)


@dataclass
class _Found:
    """Rows of a case."""

    is_good: bool = False  # one of them is without an error
    has_frames: bool = False
    farms: set[str] = field(default_factory=set)


class Done:
    """Index of the cases that have a row."""

    def __init__(self, folder: Path) -> None:
        self._folder, self._seen, self._time = folder, set[str](), -1
        self._cases: dict[str, dict[str, _Found]] = {}  # by id and case

    def refresh(self) -> None:
        """Reads files that are new."""
        time = os.stat(self._folder / "rows").st_mtime_ns
        if time == self._time:
            return
        for row in _new_rows(self._folder, self._seen):
            self.add(row)
        self._time = time

    def add(self, row: Row) -> None:
        found = self._cases.setdefault(row["id"], {}).setdefault(canonical(row["case"]), _Found())
        if row["error"] is None:
            found.is_good = True
            found.has_frames |= row["frames"] is not None
        found.farms.add(row["farm"])

    def find(self, id: str, case: str, frames: bool, retry_of: str | None) -> bool | None:
        """Whether the case has a row: True; None: only another case with the same world has one.

        retry_of: a farm that repeats failed cases, except those that it has computed itself.
        """
        fits = {
            each for each, found in self._cases.get(id, {}).items()
            if (found.is_good and (found.has_frames or not frames))
            or (not found.is_good and (retry_of is None or retry_of in found.farms))
        }  # fmt: skip
        return True if case in fits else None if fits else False

    def row(self, id: str) -> Row | None:
        """The row that counts of the cases with this id, from the files."""
        rows = [row for row in read_rows(self._folder).values() if row["id"] == id]
        return max(rows, key=_rank, default=None)


# Frames.


def _file_names(world: World) -> list[str]:
    names: list[str] = []
    for cloth in world.cloths:
        name = stem = re.sub(r"[^\w.-]+", "_", cloth.name).lstrip(".") or "cloth"
        number = 1
        while name in names:
            number += 1
            name = f"{stem}_{number}"
        names.append(name)
    return names


def _write_at(handle: int, data: bytes, offset: int) -> None:
    left = memoryview(data)
    while left:
        written = os.pwrite(handle, left, offset)
        left, offset = left[written:], offset + written


class Frames:
    """Point caches of a case, a frame at a time, at their offsets.

    Every attempt at a case writes the same bytes to the same offsets, because its motion has the same bits. An
    attempt may therefore continue another's files, also while that one still runs.
    """

    def __init__(self, folder: Path, start: World) -> None:
        """start: the world before its first step. Raises Unwritable."""
        self._folder, self._handles, self._sizes = folder, list[int](), list[int]()
        try:
            folder.mkdir(parents=True, exist_ok=True)
            for name, cloth in zip(_file_names(start), start.cloths, strict=True):
                write_obj(folder / f"{name}.obj", Mesh(cloth.positions, cloth.faces))
                self._handles.append(os.open(folder / f"{name}.pc2", os.O_RDWR | os.O_CREAT, 0o666))
                self._sizes.append(cloth.num_particles)
        except (OSError, _core.InputError) as error:
            self.close()
            raise Unwritable(str(error)) from None

    def has(self, count: int) -> bool:
        """Whether so many frames are there."""
        return all(
            os.fstat(handle).st_size >= _PC2.size + 12 * size * count
            for handle, size in zip(self._handles, self._sizes, strict=True)
        )

    def write(self, world: World, index: int) -> None:
        """Raises Unwritable."""
        try:
            for cloth, handle, size in zip(world.cloths, self._handles, self._sizes, strict=True):
                data = cloth.positions.astype("<f4")
                if data.shape != (size, 3):
                    raise _core.InputError(f'cloth "{cloth.name}" has another number of particles than at the start')
                _write_at(handle, data.tobytes(), _PC2.size + 12 * size * index)
        except OSError as error:
            raise Unwritable(str(error)) from None

    def sync(self) -> None:
        """Raises OSError."""
        for handle in self._handles:
            os.fsync(handle)

    def finish(self, count: int, target: Path) -> None:
        """Completes files of so many frames, and moves their folder. Raises Unwritable."""
        try:
            for handle, size in zip(self._handles, self._sizes, strict=True):
                _write_at(handle, _PC2.pack(b"POINTCACHE2\0", 1, size, 0, 1, count), 0)
                os.ftruncate(handle, _PC2.size + 12 * size * count)
                os.fsync(handle)
            sync(self._folder)
            target.parent.mkdir(exist_ok=True)
            with contextlib.suppress(OSError):  # another attempt has moved it
                os.rename(self._folder, target)
            sync(target.parent)
            if not target.is_dir():
                raise OSError(f"{target} is missing")
        except OSError as error:
            raise Unwritable(str(error)) from None

    def close(self) -> None:
        for handle in self._handles:
            os.close(handle)
        self._handles = []


# Checkpoints.


def save_checkpoint(file: Path, world: World, state: dict[str, Any]) -> None:
    """Saves a world between two steps, with the state of its run. Raises OSError."""
    file.parent.mkdir(parents=True, exist_ok=True)
    head = json.dumps(state).encode() + b"\n"
    body = head + world.save()
    write_whole(file, _CHECKPOINT + hashlib.sha256(body).digest() + body)


def load_checkpoint(file: Path) -> tuple[World, dict[str, Any]] | None:
    """A saved world and its state; None without one, and for a damaged file."""
    try:
        data = file.read_bytes()
    except OSError:
        return None
    body = data[len(_CHECKPOINT) + 32 :]
    if not data.startswith(_CHECKPOINT) or data[len(_CHECKPOINT) :][:32] != hashlib.sha256(body).digest():
        return None
    head, world = body.split(b"\n", 1)
    return World.load(world), json.loads(head)


def remove_parts(folder: Path, rows: Iterable[Row]) -> None:
    """Of finished cases."""
    for row in rows:
        shutil.rmtree(folder / "parts" / row["id"], ignore_errors=True)
