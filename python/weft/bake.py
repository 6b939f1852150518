"""Bakes cloth for another program, in a process of its own: `python -m weft.bake JOB`.

JOB is a folder that `Job.write` has made. Its frames arrive by `MotionWriter` while the bake runs, which waits for the next
one until its standard input ends. Each cloth gets a PC2 file that is complete after every frame. Progress is on standard
output, a JSON object per line; the last one is also in JOB/report.json. SIGTERM and Ctrl-C end the bake within a step. Called
again, an ended or killed bake goes on from its last checkpoint, and ends with the same bytes as an unbroken one.

Exit code: 0 done, 1 a step failed, 2 bad input, 130 cancelled or without further frames.
"""

from __future__ import annotations

import json
import os
import re
import signal
import struct
import sys
import threading
import time
from concurrent.futures import Future, ThreadPoolExecutor
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from . import _core
from ._bake_job import ClothInput, ColliderInput, Job, MotionReader, MotionWriter, take_over
from ._mesh import Mesh, find_crossings
from ._world import Cloth, Collider, World

_CHECKPOINT_SECONDS = 5.0  # between checkpoints
_RATE = 20.0  # of pins with weights, see pin_stiffness() [1/s]
_HEADER = struct.Struct("<12s2i2fi")  # of PC2 files
_PACE = 8  # frames whose mean gives the time left


def pin_stiffness(masses: NDArray[np.float64], weights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Stiffness of pins by weights in (0, 1): mass · (20/s)² · w / (1 − w) [N/m]; half of the critical damping.

    Under its own weight cloth then sags by g / (20/s)² · (1 − w) / w, on every mesh: 2.5 cm for 0.5, 2.7 mm for 0.9.
    """
    return masses * _RATE**2 * weights / (1 - weights)


class Cache:
    """A PC2 file that is complete after every frame. It keeps its first `keep` frames; an earlier file until the first one."""

    def __init__(self, file: str, num_points: int, first_frame: int, keep: int) -> None:
        self._size = 12 * num_points
        try:
            Path(file).parent.mkdir(parents=True, exist_ok=True)
            self._file: BinaryIO = os.fdopen(os.open(file, os.O_RDWR | os.O_CREAT, 0o666), "r+b")
            is_short = self._file.seek(0, os.SEEK_END) < _HEADER.size + keep * self._size
        except OSError as error:
            raise _core.InputError(f"{file} cannot be written: {error.strerror}") from None
        if keep and is_short:
            raise _core.InputError(f"{file} has fewer frames than its checkpoint; bake again")
        self._name, self.num_frames = file, keep
        self._header = (b"POINTCACHE2\0", 1, num_points, float(first_frame), 1.0)
        if keep:
            self._write_count()

    def _write(self, at: int, data: bytes) -> None:
        try:
            self._file.seek(at)
            self._file.write(data)
            self._file.flush()
        except OSError as error:
            raise _core.InputError(f"{self._name} cannot be written: {error.strerror}") from None

    def _write_count(self) -> None:
        self._write(0, _HEADER.pack(*self._header, self.num_frames))
        self._file.truncate(_HEADER.size + self.num_frames * self._size)

    def add_frame(self, positions: NDArray[np.float64]) -> None:
        """Positions before their number: a reader finds whole frames only."""
        self._write(_HEADER.size + self.num_frames * self._size, positions.astype("<f4").tobytes())
        self.num_frames += 1
        self._write_count()


class _Sheet:
    """A cloth of the world, and what the program calls it."""

    def __init__(self, cloth: Cloth, given: ClothInput) -> None:
        self.cloth, self.given, self.faces = cloth, given, cloth.faces
        of_vertex = cloth.particle_of_vertex
        particles = of_vertex[given.pins]
        self.firsts = np.unique(particles, return_index=True)[1]  # vertices may share a particle
        self.firsts = self.firsts[particles[self.firsts] >= 0]
        self.pinned = particles[self.firsts]
        self.dropped = np.flatnonzero(of_vertex < 0)
        corners = cloth.rest[self.faces]
        sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2).max(axis=1)
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        self.is_measured = areas > 0.1 * cloth.fabric.thickness * sides  # not slivers, whose strain means nothing

    def largest_strain(self) -> float:
        return float(np.max(self.cloth.stretches[self.is_measured, 1], initial=1)) - 1

    def begin(self) -> None:
        """Moves the cloth from its rest shape to its start, and pins it there."""
        given, of_vertex = self.given, self.cloth.particle_of_vertex
        if not np.array_equal(given.rest, given.start):
            kept = np.flatnonzero(of_vertex >= 0)
            at = np.full((len(self.cloth), 3), np.nan)
            at[of_vertex[kept]] = given.start[kept]
            self.cloth.positions = _filled(at, self.faces)
        weights, masses = given.weights[self.firsts], self.cloth.masses[self.pinned]
        held = weights > 0.999
        if held.any():
            self.cloth.pin(self.pinned[held])
        stiffness = pin_stiffness(masses, np.where(held, 0.5, weights))
        for n in np.flatnonzero(~held):
            damping = float(np.sqrt(stiffness[n] * masses[n]))
            self.cloth.pin(self.pinned[n : n + 1], stiffness=float(stiffness[n]), damping=damping)

    def local(self, to_world: NDArray[np.float64]) -> NDArray[np.float64]:
        """The mesh's vertices in the coordinates of the cache."""
        vertices = self.cloth.vertices
        vertices[self.dropped] = self.given.start[self.dropped]
        back = np.linalg.inv(to_world)
        local: NDArray[np.float64] = vertices @ back[:3, :3].T + back[:3, 3]
        return local


def _filled(at: NDArray[np.float64], faces: NDArray[np.int32]) -> NDArray[np.float64]:
    """Particles that no vertex has, of divided slivers, are put between their neighbours."""
    while (missing := np.isnan(at[:, 0])).any():
        known = faces[~missing[faces].all(1) & missing[faces].any(1)]
        if not len(known):
            raise _core.InputError("a piece of the mesh consists of slivers alone")
        middle = np.nanmean(at[known], axis=1)
        for corner in range(3):
            new = missing[known[:, corner]]
            at[known[new, corner]] = middle[new]
    return at


def _build_world(job: Job) -> World:
    world = World(gravity=job.gravity, threads=job.threads or os.cpu_count() or 1)
    world.contact = True
    world.integrator = _core.IntegratorSettings(newton=_core.NewtonSettings(quality=job.quality))  # type: ignore[arg-type]
    part: ClothInput | ColliderInput
    try:
        for part in job.colliders:
            world.add_collider(Mesh(part.start, part.faces), friction=part.friction, solid=part.solid, name=part.name)
        for part in job.cloths:
            mesh = Mesh(part.rest, part.faces, part.uv)
            world.add_cloth(
                mesh, fabric=_core.Fabric(**part.fabric), warp=part.warp, stitches=part.stitches, seam_time=part.seam_time,
                layer=part.layer, name=part.name,
            )  # fmt: skip
    except _core.InputError as error:
        raise error if part.name in str(error) else _core.InputError(f'"{part.name}": {error}') from None
    return world


class _Report:
    """Results so far, which a checkpoint keeps."""

    def __init__(self, job: Job) -> None:
        self.values: dict[str, Any] = {
            "outcome": "running", "frames": 0, "of": job.num_frames, "seconds": 0.0, "simulation_seconds": 0.0,
            "strain": {cloth.name: {"most": 0.0, "frame": job.first_frame, "last": 0.0} for cloth in job.cloths},
            "crossings": {"most": 0, "frame": job.first_frame, "frames": 0}, "warnings": [], "words": [],
        }  # fmt: skip
        self._job = job

    def warn(self, kind: str, sentence: str) -> None:
        """The first one of a kind is kept."""
        if all(kind != known for known, _ in self.values["warnings"]):
            self.values["warnings"].append([kind, sentence])

    def add_strain(self, name: str, strain: float, frame: int) -> None:
        entry = self.values["strain"][name]
        entry["last"] = strain
        if strain > entry["most"]:
            entry["most"], entry["frame"] = strain, frame

    def add_crossings(self, count: int, frame: int) -> None:
        entry = self.values["crossings"]
        entry["frames"] += count > 0
        if count > entry["most"]:
            entry["most"], entry["frame"] = count, frame

    def finish(self, outcome: str, sentence: str) -> dict[str, Any]:
        """`words`: the report as sentences."""
        values = self.values
        words = [sentence] if sentence else []
        if values["frames"] > 1:
            for name, strain in values["strain"].items():
                words.append(
                    f"{name}: stretched by at most {100 * strain['most']:.1f} % (frame {strain['frame']}), "
                    f"by {100 * strain['last']:.1f} % in the last frame."
                )
        if values["frames"]:
            crossings = values["crossings"]
            words.append(
                f"{crossings['most']} pairs of triangles cross in frame {crossings['frame']}, and some in "
                f"{crossings['frames']} frames."
                if crossings["most"]
                else f"Nothing crosses in any of {values['frames']} frames."
            )
        words += [sentence for _, sentence in values["warnings"]]
        return {**values, "outcome": outcome, "message": sentence, "words": words}


class _Checker:
    """Counts crossings on a thread of its own, beside the next steps."""

    def __init__(self, job: Job, report: _Report, sheets: list[_Sheet]) -> None:
        self._job, self._report, self._sheets = job, report, sheets
        self._pool, self._waiting = ThreadPoolExecutor(1), list[tuple[int, Future[int]]]()

    def add(self, frame: int, record: np.void) -> None:
        cloths = [(sheet.cloth.positions, sheet.faces) for sheet in self._sheets]
        bodies = [(record[f"collider_{n}"].astype(float), body.faces) for n, body in enumerate(self._job.colliders)]
        self._waiting.append((frame, self._pool.submit(lambda: len(find_crossings(cloths, colliders=bodies)))))
        self.finish(keep=1)

    def finish(self, keep: int = 0) -> None:
        while len(self._waiting) > keep:
            frame, count = self._waiting.pop(0)
            self._report.add_crossings(count.result(), frame)


class _Bake:
    def __init__(self, folder: Path) -> None:
        self._folder, self._job = folder, Job.read(folder)
        self._motion = MotionReader(folder, self._job)
        self._cancelled, self._input_ended = threading.Event(), threading.Event()
        self._began, self._report = time.perf_counter(), _Report(self._job)
        self._since_checkpoint = self._began
        self._recent: list[float] = []

    def cancel(self, *_: object) -> None:
        self._cancelled.set()

    def watch_input(self) -> None:
        """The program holds the other end of the pipe: it ends with the last frame, or with the program."""

        def watch() -> None:
            try:
                while os.read(sys.stdin.fileno(), 4096):
                    pass
            except (OSError, ValueError, AttributeError):
                pass  # there is no standard input
            self._input_ended.set()

        threading.Thread(target=watch, daemon=True).start()

    def _wait_for(self, frame: int) -> bool:
        while not self._cancelled.is_set():
            ended = self._input_ended.is_set()  # before the count
            if self._motion.num_frames > frame:
                return True
            if ended:
                return False
            time.sleep(0.01)
        return False

    # Checkpoints: a line of JSON, then the world.

    def _read_checkpoint(self) -> World | None:
        try:
            text, data = (self._folder / "checkpoint.weft").read_bytes().split(b"\n", 1)
        except FileNotFoundError:
            return None
        self._report.values = json.loads(text)
        return World.load(data)

    def _write_checkpoint(self, world: World) -> None:
        self._checker.finish()
        values = {**self._report.values, "seconds": self._seconds()}
        part = self._folder / "checkpoint.weft.partial"
        part.write_bytes(json.dumps(values).encode() + b"\n" + world.save())
        os.replace(part, self._folder / "checkpoint.weft")
        self._since_checkpoint = time.perf_counter()

    def _seconds(self) -> float:
        return float(self._report.values["seconds"]) + time.perf_counter() - self._began

    # The bake.

    def run(self) -> dict[str, Any]:
        """Raises InputError."""
        job = self._job
        world = self._read_checkpoint() or _build_world(job)
        done: int = self._report.values["frames"]
        world.threads = job.threads or os.cpu_count() or 1
        self._world = world
        self._sheets = [_Sheet(cloth, given) for cloth, given in zip(world.cloths, job.cloths, strict=True)]
        self._bodies = world.colliders
        self._checker = _Checker(job, self._report, self._sheets)
        self._caches = [Cache(given.cache, len(given.rest), job.first_frame, done) for given in job.cloths]
        _say({"event": "start", "frames": done, "of": job.num_frames})
        if done == 0:
            if not self._wait_for(0):
                return self._end("cancelled")
            self._start()
            done = 1
        before = self._motion.frame(done - 1)
        while done < job.num_frames:
            if not self._wait_for(done):
                return self._end("cancelled")
            after = self._motion.frame(done)
            start, began = world.snapshot(), time.perf_counter()
            failure = self._advance(before, after, job.first_frame + done)
            if failure is not None:
                world.restore(start)
                return self._end("failed" if failure else "cancelled", failure)
            self._add_frame(job.first_frame + done, after)
            before, done = after, done + 1
            self._tell(time.perf_counter() - began)
            if time.perf_counter() - self._since_checkpoint > _CHECKPOINT_SECONDS:
                self._write_checkpoint(world)
        return self._end("done")

    def _start(self) -> None:
        for sheet in self._sheets:
            sheet.begin()
            for note in sheet.cloth.notes:
                self._report.warn(note, _sentence(note))
            if sheet.given.warp is not None and sheet.given.uv is None:
                name = sheet.given.name
                self._report.warn(f"warp {name}", f"{name}: its mesh has no UV map, which gives the direction of warp.")
        for body in self._bodies:
            for note in body.notes:
                self._report.warn(note, _sentence(note))
        if self._job.untangle:
            for note in self._world.untangle():
                self._report.warn(note, f"At the start, {_sentence(note)}")
        self._add_frame(self._job.first_frame, self._motion.frame(0))
        self._tell(0)

    def _advance(self, before: np.void, after: np.void, frame: int) -> str | None:
        """Makes the steps of a frame. None: done; a sentence: failed; empty: cancelled."""
        steps, world = self._job.steps_per_frame, self._world
        moving = [n for n in range(len(self._bodies)) if not np.array_equal(before[f"collider_{n}"], after[f"collider_{n}"])]
        for step in range(1, steps + 1):
            share = step / steps
            for n, sheet in enumerate(self._sheets):
                if len(sheet.pinned):
                    a, b = before[f"pins_{n}"][sheet.firsts], after[f"pins_{n}"][sheet.firsts]
                    sheet.cloth.set_targets(sheet.pinned, a + share * (b - a))
            for n in moving:
                a, b = before[f"collider_{n}"].astype(float), after[f"collider_{n}"]
                self._bodies[n].move_vertices(a + share * (b - a))
            if self._cancelled.is_set():
                return ""
            began = time.perf_counter()
            report = world.step(1 / (self._job.fps * steps), check=False)
            self._report.values["simulation_seconds"] += time.perf_counter() - began
            sentences = [(warning.code, world.describe(warning)) for warning in report.warnings]
            if not report.ok:
                return f"Frame {frame} failed: " + "; ".join(sentence for _, sentence in sentences) + "."
            for code, sentence in sentences:
                self._report.warn(code, f"Frame {frame}: {_in_words(sentence)}.")
        return None

    def _add_frame(self, frame: int, record: np.void) -> None:
        for n, (sheet, cache) in enumerate(zip(self._sheets, self._caches, strict=True)):
            cache.add_frame(sheet.local(record[f"to_world_{n}"]))
            self._report.add_strain(sheet.given.name, sheet.largest_strain(), frame)
        self._checker.add(frame, record)
        self._report.values["frames"] += 1

    def _tell(self, seconds: float) -> None:
        self._recent = (self._recent + [seconds])[-_PACE:] if seconds else []
        values, mean = self._report.values, sum(self._recent) / max(len(self._recent), 1)
        left = mean * (values["of"] - values["frames"]) if self._recent else None
        _say({"event": "frame", "frames": values["frames"], "of": values["of"], "seconds_left": left})

    def _end(self, outcome: str, sentence: str = "") -> dict[str, Any]:
        self._write_checkpoint(self._world)
        values, first = self._report.values, self._job.first_frame
        if outcome == "cancelled":
            reason = "Cancelled" if self._cancelled.is_set() else "No further frames have come"
            until = first + values["frames"] - 1
            sentence = f"{reason}: frames {first} to {until} are baked." if values["frames"] else f"{reason}: no frame is baked."
        values["seconds"] = self._seconds()
        return self._report.finish(outcome, sentence)


def _sentence(note: str) -> str:
    return note if note.endswith((".", "?", "!")) else note + "."


def _in_words(sentence: str) -> str:
    """Keys of scenes are settings of the program here."""
    key = r"(solver\.)?(max_steps_per_frame|steps_per_frame|iterations)"
    return re.sub(rf"{key}( or {key})*", "the quality", sentence)


def _say(line: dict[str, Any]) -> None:
    try:
        print(json.dumps(line), flush=True)
    except BrokenPipeError:  # nobody listens; the files are still written
        sys.stdout = open(os.devnull, "w")  # noqa: SIM115


def run(folder: str | os.PathLike[str]) -> dict[str, Any]:
    """Bakes a job, and returns its report, which is also written to report.json."""
    path, report = Path(folder), dict[str, Any]()
    if not (path / "job.json").is_file():
        raise _core.InputError(f"{path} holds no job: there is no job.json")
    lock = take_over(path)
    try:
        bake = _Bake(path)
        for which in (signal.SIGTERM, signal.SIGINT):
            signal.signal(which, bake.cancel)
        bake.watch_input()
        report = bake.run()
    except _core.InputError as error:
        report = {"outcome": "refused", "message": str(error), "words": [_sentence(str(error))], "warnings": []}
    (path / "report.json.partial").write_text(json.dumps(report, indent=1), encoding="utf-8")
    os.replace(path / "report.json.partial", path / "report.json")
    lock.close()
    return report


def main(arguments: list[str]) -> int:
    """Exit code: see the module."""
    if len(arguments) != 1:
        print("usage: python -m weft.bake JOB", file=sys.stderr)
        return 2
    try:
        report = run(arguments[0])
    except _core.InputError as error:
        report = {"outcome": "refused", "message": str(error), "words": [str(error)]}
    _say({"event": "end", **report})
    return {"done": 0, "failed": 1, "refused": 2, "cancelled": 130}[report["outcome"]]


__all__ = ["Cache", "ClothInput", "ColliderInput", "Job", "MotionReader", "MotionWriter", "main", "pin_stiffness", "run"]

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
