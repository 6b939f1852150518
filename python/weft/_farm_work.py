"""Work of a farm's workers: batches of cases, from the world to the row."""

from __future__ import annotations

import contextlib
import dataclasses
import datetime
import functools
import importlib
import json
import os
import pickle
import socket
import threading
import time
import uuid
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import _core
from ._arguments import choose
from ._farm_folder import (
    Done, Frames, Row, Unwritable, add_rows, build_id, canonical, case_id, load_checkpoint, plain, remove_parts,
    save_checkpoint,
)  # fmt: skip
from ._world import World

Case = Mapping[str, Any]

COLUMNS = ("error", "state_hash", "report", "wall_seconds", "host", "finished", "frames", "id", "seconds", "dt", "key",
           "build", "farm")  # fmt: skip

_STOP_EVERY = 0.25  # between two tests whether the farm is to stop [s]
_ROWS_EVERY = 5.0  # between two files of rows of a batch that takes longer than planned [s]
_FOLDER_WAIT = 20.0  # until a file of the farm is seen on another machine [s]


@dataclass
class Plan:
    """A farm's settings, for all its workers."""

    make_world: Callable[[Any], World]
    measure: Callable[[World], Mapping[str, Any]] | None
    control: Callable[[World, int], object] | None
    seconds: float  # simulated [s]
    dt: float  # [s]
    key: str
    frames: int  # steps between two frames; 0: none
    checkpoint_every: float  # [s]
    max_deaths: int
    retry_failed: bool
    build: str

    @property
    def num_steps(self) -> int:
        return round(self.seconds / self.dt)


@dataclass
class Report:
    """Result of a batch."""

    cases: list[tuple[int, str, bool]]  # index, id, whether it was computed and not read
    seconds: float = 0.0  # from the start of the batch to its end [s]
    rows: list[Row] | None = None  # those that this worker cannot write
    unwritable: str = ""  # why
    refused: str = ""  # why this worker cannot work for the farm
    host: str = ""
    worker: str = ""  # address


class Refused(Exception):
    """This worker cannot work for the farm."""


class _Stopped(Exception):
    """The farm ends."""


class _Room:
    """Cases in this process: several, or one that is alone."""

    def __init__(self) -> None:
        self._changed, self._inside, self._waiting, self._is_alone = threading.Condition(), 0, 0, False

    @contextlib.contextmanager
    def enter(self, *, alone: bool) -> Iterator[None]:
        with self._changed:
            self._waiting += alone
            self._changed.wait_for(lambda: not self._is_alone and not (self._inside if alone else self._waiting))
            self._waiting -= alone
            self._is_alone = alone
            self._inside += 1
        try:
            yield
        finally:
            with self._changed:
                self._is_alone = False
                self._inside -= 1
                self._changed.notify_all()


class _Place:
    """A farm's folder as this process sees it, with the farm's functions."""

    def __init__(self, folder: Path, farm: str) -> None:
        self.folder, self.farm, self.live = folder, farm, folder / "live" / farm
        self.room, self.lock, self.host = _Room(), threading.Lock(), socket.gethostname()
        self._stop_time, self._stops = 0.0, False
        file, end = self.live / "plan.pickle", time.monotonic() + _FOLDER_WAIT
        while not self.live.is_dir() and time.monotonic() < end:
            time.sleep(0.1)
        try:
            data = file.read_bytes()
        except OSError:
            if self.live.is_dir():
                raise _Stopped from None
            raise Refused(f"{self.host} does not have {folder}; all workers of a farm share the folder out=") from None
        try:
            plan = pickle.loads(data)
        except Exception as error:
            raise Refused(
                f"{self.host} cannot load the functions of the farm ({words(error)}); define them in the script "
                "itself, or install their module there"
            ) from None
        assert isinstance(plan, Plan)
        self.plan = plan
        if plan.build != build_id():
            raise Refused(f"{self.host} has another build of weft ({build_id()}) than the farm ({plan.build})")
        self.done = Done(folder)

    @property
    def retry_of(self) -> str | None:
        return self.farm if self.plan.retry_failed else None

    def check_stop(self) -> None:
        """Raises _Stopped if the farm ends: its functions are removed first."""
        now = time.monotonic()
        if now - self._stop_time >= _STOP_EVERY:
            self._stop_time, self._stops = now, not (self.live / "plan.pickle").exists()
        if self._stops:
            raise _Stopped


_place_lock = threading.Lock()


@functools.lru_cache(maxsize=4)
def _place(folder: str, farm: str) -> _Place:
    return _Place(Path(folder), farm)


def work(folder: str, farm: str, batch: str, items: Sequence[tuple[int, Case]], careful: bool) -> Report:
    """Computes the cases of a batch that have no row, and writes their rows.

    careful: one at a time, alone in this process, with a file of rows each. So is every further attempt at a batch
    whose worker died: its mark is there.
    """
    start = time.perf_counter()
    try:
        with _place_lock:  # one for all threads of this process
            place = _place(folder, farm)
    except Refused as error:
        return Report([], refused=str(error))
    except _Stopped:
        return Report([])
    mark = place.live / batch
    careful = careful or mark.exists()
    with contextlib.suppress(OSError):
        mark.touch()
    report = _Batch(place, careful).run(items)
    report.host, report.seconds = place.host, time.perf_counter() - start
    report.worker = importlib.import_module("distributed").get_worker().address
    if report.rows is None:  # by the folder too: dask loses results of workers that die
        with contextlib.suppress(OSError):
            part = place.live / f".{batch}.partial"
            part.write_text(json.dumps(dataclasses.asdict(report)))
            os.replace(part, place.live / f"{batch}.report")
    mark.unlink(missing_ok=True)
    return report


class _Batch:
    def __init__(self, place: _Place, careful: bool) -> None:
        self._place, self._plan, self._careful = place, place.plan, careful
        self._report = Report([])
        self._rows: list[tuple[int, Row]] = []  # not yet written

    def run(self, items: Sequence[tuple[int, Case]]) -> Report:
        place, report, flushed = self._place, self._report, time.monotonic()
        with contextlib.suppress(_Stopped, Unwritable):
            try:
                for index, case in items:
                    place.check_stop()
                    with place.lock:
                        place.done.refresh()
                    with place.room.enter(alone=self._careful):
                        self._compute(index, case)
                    if self._careful or time.monotonic() - flushed > _ROWS_EVERY:
                        self._write_rows()
                        flushed = time.monotonic()
            except Unwritable as error:
                report.unwritable = str(error)
                raise
            finally:
                self._write_rows()
        return report

    def _write_rows(self) -> None:
        if not self._rows:
            return
        rows, report = [row for _, row in self._rows], self._report
        try:
            add_rows(self._place.folder, rows)
        except OSError as error:
            report.rows = (report.rows or []) + rows
            report.unwritable = error.strerror or str(error)
        else:
            remove_parts(self._place.folder, rows)
        report.cases += [(index, row["id"], True) for index, row in self._rows]
        self._rows = []

    def _compute(self, index: int, case: Case) -> None:
        """Adds the row of a case that has none."""
        place, start = self._place, time.perf_counter()
        deaths = _Deaths(place.live, index) if self._careful else None
        values = plain(case, "case")
        row: Row = {
            "id": "", "case": values, "measures": {}, "error": None, "state_hash": None, "report": None, "frames": None,
            "seconds": self._plan.seconds, "dt": self._plan.dt, "key": self._plan.key, "build": self._plan.build,
            "host": place.host, "farm": place.farm,
        }  # fmt: skip
        if deaths and deaths.count >= self._plan.max_deaths:
            row["id"] = deaths.id or self._id_without_world(values, "deadly")
            row["error"] = (
                f"the case ended its worker {deaths.count} times, each time as the only case in it; memory or a crash "
                "of make_world, control or measure is the usual cause"
            )
        else:
            try:
                if self._fill(row, index, case, deaths):
                    return
            finally:  # this process lives
                if deaths:
                    deaths.end_attempt()
        row["wall_seconds"] = time.perf_counter() - start
        row["finished"] = datetime.datetime.now(datetime.timezone.utc).isoformat(timespec="microseconds")
        with place.lock:
            place.done.add(row)
        self._rows.append((index, row))

    def _id_without_world(self, values: Any, make_world: str) -> str:
        """Of a case whose make_world fails, or is deadly."""
        world = f"{make_world}: {canonical(values)}".encode()
        return case_id(world, self._plan.seconds, self._plan.dt, self._plan.key)

    def _fill(self, row: Row, index: int, case: Case, deaths: _Deaths | None) -> bool:
        """Computes a row. True: the case has one already."""
        plan, place, text = self._plan, self._place, canonical(row["case"])
        deadly = self._id_without_world(row["case"], "deadly")
        with place.lock:
            found = place.done.find(deadly, text, False, place.retry_of)
        if self._is_read(index, deadly, found):
            return True
        if deaths:
            deaths.begin_attempt("", -1)
        try:
            world = plan.make_world(dict(case))
            choose(world, "its result", World, "a World")
        except Exception as error:
            row["id"], row["error"] = self._id_without_world(row["case"], "fails"), f"make_world: {words(error)}"
            with place.lock:
                found = place.done.find(row["id"], text, False, place.retry_of)
            return self._is_read(index, row["id"], found)
        id = row["id"] = case_id(world.save(), plan.seconds, plan.dt, plan.key)
        with place.lock:
            found = place.done.find(id, text, plan.frames > 0, place.retry_of)
        if self._is_read(index, id, found):
            return True
        if found is None and (twin := self._twin(id)):
            row.update({key: twin[key] for key in ("measures", "error", "state_hash", "report", "frames")})
            return False
        run = _CaseRun(place, id, world)
        if deaths:
            deaths.begin_attempt(id, run.step)
        try:
            run.finish(row)
        finally:
            run.close()
        return False

    def _is_read(self, index: int, id: str, found: bool | None) -> bool:
        if found:
            self._report.cases.append((index, id, False))
        return bool(found)

    def _twin(self, id: str) -> Row | None:
        """A row of another case with an equal world; None while another thread still has it."""
        own = [row for _, row in self._rows if row["id"] == id]
        return own[0] if own else self._place.done.row(id)


class _CaseRun:
    """Steps of a case, from its last checkpoint."""

    def __init__(self, place: _Place, id: str, world: World) -> None:
        self._place, self._plan, self._id, self._world = place, place.plan, id, world
        self._parts, self._target = place.folder / "parts" / id, place.folder / "frames" / id
        self._frames: Frames | None = None
        self.step = 0
        self._summary: dict[str, Any] = {"steps": 0, "iterations": 0, "warnings": []}
        self._told: list[str] = []
        if self._plan.frames and not self._target.is_dir():
            self._frames = Frames(self._parts / "frames", world)
        saved = load_checkpoint(self._parts / "checkpoint")
        if saved and (self._frames is None or self._frames.has(saved[1]["frames"])):
            threads, (self._world, state) = world.threads, saved
            self._world.threads = threads
            self.step, self._summary, self._told = state["step"], state["report"], state["told"]
        elif self._frames:
            self._frames.write(world, 0)

    def close(self) -> None:
        if self._frames:
            self._frames.close()

    def finish(self, row: Row) -> None:
        """The remaining steps. Raises _Stopped, after a checkpoint of a case that has made steps."""
        plan, saved = self._plan, time.monotonic()
        where = ""
        row["report"] = self._summary
        try:
            while self.step < plan.num_steps:
                self._place.check_stop()
                if time.monotonic() - saved >= plan.checkpoint_every:
                    self._save()
                    saved = time.monotonic()
                where = f"control, step {self.step}"
                if plan.control:
                    plan.control(self._world, self.step)
                where = f"step {self.step}"
                self._advance()
            where = "measure"
            measures = plan.measure(self._world) if plan.measure else {}
            choose(measures, "its result", Mapping, "a dict")
            row["measures"] = {str(name): plain(value, f'"{name}"') for name, value in measures.items()}
            twice = [name for name in row["measures"] if name in row["case"] or name in COLUMNS]
            if twice:
                row["measures"] = {}
                raise _core.InputError(f'"{twice[0]}" is the name of a column already; choose another name')
        except (_Stopped, Unwritable):
            if self.step > 0:
                self._save()
            raise
        except Exception as error:
            row["error"] = f"{where}: {words(error)}"
            return
        row["state_hash"] = self._world.state_hash()
        if plan.frames:
            if self._frames:
                self._frames.finish(self._num_frames, self._target)
            row["frames"] = f"frames/{self._id}"

    @property
    def _num_frames(self) -> int:
        return self.step // self._plan.frames + 1 if self._plan.frames else 0

    def _advance(self) -> None:
        report = self._world.step(self._plan.dt, check=False)
        if not report.ok:
            raise _core.InputError("the step failed: " + "; ".join(map(self._world.describe, report.warnings)))
        for warning in report.warnings:
            if warning.code not in self._told:
                self._told.append(warning.code)
                self._summary["warnings"].append(f"step {self.step}: {self._world.describe(warning)}")
        self.step += 1
        self._summary["steps"] = self.step
        self._summary["iterations"] += report.iterations
        if self._frames and self.step % self._plan.frames == 0:
            self._frames.write(self._world, self.step // self._plan.frames)

    def _save(self) -> None:
        """A checkpoint. Where it cannot be written the case goes on without."""
        state = {"step": self.step, "frames": self._num_frames, "report": self._summary, "told": self._told}
        with contextlib.suppress(OSError):
            if self._frames:
                self._frames.sync()
            save_checkpoint(self._parts / "checkpoint", self._world, state)


class _Deaths:
    """Attempts at a case that was alone in its worker, and ended with it. A mark is written when an attempt begins, and
    removed when it ends. Attempts before the newest checkpoint do not count: the case has made progress since.
    """

    def __init__(self, live: Path, index: int) -> None:
        self._live, self._index = live, index
        self._mark: Path | None = None
        marks = []
        for file in live.glob(f"lone.{index}.*"):
            with contextlib.suppress(OSError, ValueError):
                marks.append(json.loads(file.read_text()))
        newest = max((step for _, step in marks), default=0)
        self.count = sum(step == newest for _, step in marks)
        self.id = next((id for id, step in marks if id and step == newest), "")

    def begin_attempt(self, id: str, step: int) -> None:
        """Also again, after its world was made."""
        if self._mark is None:
            self._mark = self._live / f"lone.{self._index}.{uuid.uuid4().hex}"
        part = self._mark.with_name("." + self._mark.name)
        with contextlib.suppress(OSError):
            part.write_text(json.dumps((id, step)))
            os.replace(part, self._mark)

    def end_attempt(self) -> None:
        for file in self._live.glob(f"lone.{self._index}.*"):
            file.unlink(missing_ok=True)


def words(error: Exception) -> str:
    """An exception as one line."""
    text = " ".join(str(error).split())
    if isinstance(error, _core.InputError) and text:
        return text
    return f"{type(error).__name__}: {text}" if text else type(error).__name__

