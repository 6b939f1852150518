"""Farms: thousands of runs on this machine, or on a cluster by dask.distributed. Needs `pip install weft[farm]`.

>>> import weft
>>> cases = weft.farm.grid(fabric=["denim", "silk"], drop=[0.2, 0.4, 0.6])
>>> len(cases), cases[1]
(6, {'fabric': 'denim', 'drop': 0.4})
"""

from __future__ import annotations

import contextlib
import importlib
import itertools
import json
import math
import os
import queue
import shutil
import socket
import subprocess
import sys
import tempfile
import time
import uuid
import warnings
from collections import Counter, deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _core
from ._arguments import choose, real, whole
from ._farm_folder import Row, add_rows, build_id, canonical, merge_rows, plain, read_rows, remove_parts, write_whole
from ._farm_work import COLUMNS, Case, Plan, Report, words, work
from ._progress import Progress, print_progress, show_progress
from ._world import World

if TYPE_CHECKING:
    import pyarrow  # type: ignore[import-not-found,import-untyped,unused-ignore]
    from distributed import Client  # type: ignore[import-not-found,unused-ignore]

__all__ = ["grid", "local", "run", "table"]

_BATCH = 2.0  # computing time of a batch [s]
_MAX_BATCH = 1000  # cases
_RESULT_WAIT = 30.0  # for a report that the worker could not write into the folder [s]
_STOP_WAIT = 30.0  # for workers to end their steps after Ctrl-C [s]
_MAX_LOSSES = 20  # workers that end with a case, before the farm gives up
_UNSERVED = 60.0  # without any worker, before the farm says so [s]
_ROUNDS = 5  # over cases whose rows are missing at the end


def grid(**values: Iterable[Any]) -> list[dict[str, Any]]:
    """Cases of all combinations of values; the last one changes fastest.

    >>> grid(a=[1, 2], b="xy")
    [{'a': 1, 'b': 'x'}, {'a': 1, 'b': 'y'}, {'a': 2, 'b': 'x'}, {'a': 2, 'b': 'y'}]
    """
    lists = [[item.item() if isinstance(item, np.generic) else item for item in each] for each in values.values()]
    return [dict(zip(values, combination, strict=True)) for combination in itertools.product(*lists)]


def _require() -> Any:
    """The module distributed. Raises ImportError unless the packages of weft[farm] are there."""
    try:
        importlib.import_module("pyarrow")
        return importlib.import_module("distributed")
    except ImportError:
        raise ImportError(
            "weft.farm needs the Python packages dask, distributed and pyarrow: pip install weft[farm]"
        ) from None


@contextlib.contextmanager
def local(workers: int | None = None) -> Iterator[Client]:
    """A client of workers on this machine, one process each; by default one for each core. They end with the block.

    Nothing listens beyond 127.0.0.1. `run` starts such workers itself if it is given no client; several runs share
    the workers of a block.
    """
    distributed = _require()
    count = len(os.sched_getaffinity(0)) if workers is None else whole(workers, "workers")
    if count < 1:
        raise _core.InputError(f"workers: expected at least 1, found {count}")
    with contextlib.ExitStack() as stack:
        scratch = stack.enter_context(tempfile.TemporaryDirectory(prefix="weft-farm-", ignore_cleanup_errors=True))
        cluster = stack.enter_context(
            distributed.LocalCluster(n_workers=0, host="127.0.0.1", dashboard_address="127.0.0.1:0", silence_logs="error")
        )
        environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join(filter(None, [os.getcwd(), *sys.path])),
            "DASK_LOGGING__DISTRIBUTED": "critical",
        }
        # Processes that do not import the calling script, and that Ctrl-C in a terminal does not reach.
        command = [
            sys.executable, "-m", "distributed.cli.dask_worker", cluster.scheduler_address, "--nworkers", str(count),
            "--nthreads", "1", "--host", "127.0.0.1", "--dashboard-address", "127.0.0.1:0", "--death-timeout", "30",
            "--local-directory", scratch,
        ]  # fmt: skip
        process = subprocess.Popen(command, env=environment, start_new_session=True)
        stack.callback(_end, process)
        client = stack.enter_context(distributed.Client(cluster))
        while len(client.nthreads()) < count:
            if process.poll() is not None:
                raise RuntimeError(f"the workers of the farm ended at their start, with exit code {process.returncode}")
            time.sleep(0.05)
        yield client


def _end(process: subprocess.Popen[bytes]) -> None:
    process.terminate()
    try:
        process.wait(10)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, 9)
        process.wait()


def run(
    make_world: Callable[[Any], World],
    cases: Sequence[Case],
    *,
    seconds: float,
    out: str | os.PathLike[str],
    measure: Callable[[World], Mapping[str, Any]] | None = None,
    control: Callable[[World, int], object] | None = None,
    dt: float = 1 / 60,
    key: str = "",
    frames: int = 0,
    client: Client | None = None,
    workers: int | None = None,
    progress: bool | Progress = True,
    retry_failed: bool = False,
    checkpoint_every: float = 30,
    max_deaths: int = 3,
) -> pyarrow.Table:
    """Runs every case that has no row in the folder `out`; returns a table with a row per case, in their order.

    make_world: called with a case, returns its World. control: called with the world and the number of the step, from
    0, before each step. measure: called with the world after the last step, returns a dict of numbers, texts or
    arrays: columns of the table. seconds: simulated time of a case; dt: of a step [s]. key: a text to change when
    `measure` or `control` changes, so that finished cases run again. frames: steps between two frames that are
    written to point caches; 0: none. client: of dask.distributed; by default `workers` processes on this machine.
    progress: True, False, or a function of cases done, cases, seconds spent and seconds left. retry_failed: whether
    cases with an error run again. checkpoint_every: computing time between two checkpoints of a long case [s].
    max_deaths: a case that ends so many workers, as the only case in each and without a new checkpoint, gets an error.

    A case is finished when its row is in the folder: with the same world, seconds, dt, key and build of the engine it
    is read. A case that fails has a sentence in the column `error`. Ctrl-C ends the farm; finished cases stay, and
    long ones continue from a checkpoint. Raises InputError for bad input, and if the folder cannot be written;
    ImportError without weft[farm].
    """
    _require()
    plan = Plan(
        make_world, measure, control, real(seconds, "seconds"), real(dt, "dt"), key, whole(int(frames), "frames"),
        real(checkpoint_every, "checkpoint_every"), whole(max_deaths, "max_deaths"), bool(retry_failed), build_id(),
    )  # fmt: skip
    _check(plan, cases, out)
    with contextlib.ExitStack() as stack:
        if client is None:
            client = stack.enter_context(local(workers))
        elif workers is not None:
            raise _core.InputError("workers: a client has its own workers")
        farm = stack.enter_context(_farm_of(Path(out).absolute(), plan, list(cases), client, progress))
        farm.compute()
        return farm.finish()


def table(out: str | os.PathLike[str]) -> pyarrow.Table:
    """All rows of a farm's folder, at any time, also while a farm runs.

    Cases that ran again with another world, time, key or build have a row for each; `id`, `key`, `build` and `finished`
    distinguish them. Raises InputError if the folder holds no farm.
    """
    _require()
    folder = Path(out)
    if not (folder / "rows").is_dir():
        raise _core.InputError(f"{folder} holds no farm: there is no folder rows")
    rows = read_rows(folder)
    return _as_table([rows[place] for place in sorted(rows, key=lambda place: rows[place]["finished"])])


def _check(plan: Plan, cases: Sequence[Case], out: object) -> None:
    choose(out, "out", (str, os.PathLike), "a folder")
    choose(plan.key, "key", str, "a text")
    for name in ("make_world", "measure", "control"):
        given = getattr(plan, name)
        if not callable(given) and (given is not None or name == "make_world"):
            raise _core.InputError(f"{name}: expected a function, found {given!r:.60}")
    if plan.dt <= 0 or plan.num_steps < 1:
        raise _core.InputError(
            f"seconds and dt: expected at least one step, found {plan.seconds:g} s and {plan.dt:g} s"
        )
    for name, least in (("frames", 0), ("max_deaths", 1)):
        if getattr(plan, name) < least:
            raise _core.InputError(f"{name}: expected at least {least}, found {getattr(plan, name)}")
    if plan.checkpoint_every <= 0:
        raise _core.InputError(f"checkpoint_every: expected a number above 0, found {plan.checkpoint_every:g}")
    choose(cases, "cases", Sequence, "a list of dicts")
    for case in cases:
        choose(case, "cases", Mapping, "a list of dicts")
        for name, value in case.items():
            if not isinstance(name, str) or name in COLUMNS:
                raise _core.InputError(f"cases: {name!r} is no name for a value; the table has {', '.join(COLUMNS)}")
            plain(value, f"cases: {name}")


# The farm.


@dataclass
class _Flight:
    """A batch on its way."""

    indices: list[int]
    future: Any  # of dask, of a Report
    file: Path  # of the same report, written by the worker


@dataclass
class _Farm:
    """A running farm: cases that wait, batches on their way, ids of those that have a row."""

    folder: Path
    plan: Plan
    cases: list[Case]
    client: Any  # of dask
    tell: Progress | None
    name: str
    ids: dict[int, str] = field(default_factory=dict)  # of finished cases
    waiting: deque[int] = field(default_factory=deque)
    suspects: deque[int] = field(default_factory=deque)  # cases whose workers died
    flights: dict[str, _Flight] = field(default_factory=dict)
    landed: queue.SimpleQueue[str] = field(default_factory=queue.SimpleQueue)
    losses: Counter[int] = field(default_factory=Counter)
    avoided: set[str] = field(default_factory=set)  # workers that cannot write the folder
    start: float = field(default_factory=time.monotonic)
    threads: int = 0  # of all workers
    served: float = field(default_factory=time.monotonic)  # when there was a worker last, or that there is none was said
    asked: float = -math.inf  # when
    num_computed: int = 0
    time_per_case: float = 0.0  # of the cases so far, read ones included [s]

    @property
    def live(self) -> Path:
        return self.folder / "live" / self.name

    def compute(self) -> None:
        """Until every case has a row."""
        self.waiting.extend(range(len(self.cases)))
        for _ in range(_ROUNDS):
            self._drain()
            rows = read_rows(self.folder)
            missing = [n for n, case in enumerate(self.cases) if (self.ids[n], _text(case)) not in rows]
            if not missing:
                return
            self.waiting.extend(missing)
            for index in missing:
                del self.ids[index]
        raise _core.InputError(f"{self.folder}: rows of {len(missing)} cases are missing; do all workers write there?")

    def _drain(self) -> None:
        while self.waiting or self.suspects or self.flights:
            self._fill()
            with contextlib.suppress(queue.Empty):
                self._land(self.flights.pop(self.landed.get(timeout=0.5)))
                while True:
                    self._land(self.flights.pop(self.landed.get_nowait()))
            self._show()

    def _show(self) -> None:
        if self.tell is None:
            return
        spent = time.monotonic() - self.start
        left = (len(self.cases) - len(self.ids)) * spent / (self.num_computed or len(self.ids) or 1)
        self.tell(len(self.ids), len(self.cases), spent, left)

    # Batches.

    def _fill(self) -> None:
        """Two batches for each thread of the workers: one that it computes, one that follows."""
        if self.client.status in ("closing", "closed"):
            raise RuntimeError(f"the connection to the scheduler of dask is closed; {_KEPT}")
        now = time.monotonic()
        if now - self.asked > 1:
            self.asked = now
            with contextlib.suppress(OSError, TimeoutError):  # while the scheduler is away
                self.threads = sum(self.client.nthreads().values())
            self._warn_without_workers(now)
        most = 2 * max(1, self.threads)
        while (self.waiting or self.suspects) and len(self.flights) < most:
            if self.waiting:
                self._submit([self.waiting.popleft() for _ in range(self._batch_size(most))], careful=False)
            else:
                self._submit([self.suspects.popleft()], careful=True)

    def _warn_without_workers(self, now: float) -> None:
        """Every minute: a queue of Slurm may give some later, and workers that die at their start never come."""
        if self.threads == 0 and now - self.served > _UNSERVED:
            warnings.warn(
                f"the farm has had no worker for {_UNSERVED:g} s, and waits; look at the queue, or at the workers' logs",
                RuntimeWarning,
                stacklevel=2,
            )
            self.served = now
        elif self.threads > 0:
            self.served = now

    def _batch_size(self, most: int) -> int:
        left = len(self.waiting)
        if self.time_per_case == 0:
            return 1
        fits = round(_BATCH / self.time_per_case)
        return max(1, min(fits, _MAX_BATCH, left, math.ceil(left / most)))

    def _submit(self, indices: list[int], *, careful: bool) -> None:
        batch = uuid.uuid4().hex
        items = [(index, self.cases[index]) for index in indices]
        good: list[str] = []
        if self.avoided and self.plan.frames:
            good = [address for address in self.client.nthreads() if address not in self.avoided]
        future = self.client.submit(
            work, str(self.folder), self.name, batch, items, careful, key=f"weft-cases-{batch}", pure=False,
            **({"workers": good, "allow_other_workers": True} if good else {}),
        )  # fmt: skip
        self.flights[batch] = _Flight(indices, future, self.live / f"{batch}.report")
        future.add_done_callback(lambda _: self.landed.put(batch))

    def _land(self, flight: _Flight) -> None:
        """Takes a batch's report. Cases without a row run again."""
        status, report = flight.future.status, _report_of(flight)
        if report:
            self._take(report, flight)
        elif status == "error":
            error = flight.future.exception()
            if type(error).__name__ != "KilledWorker":
                raise RuntimeError(f"a worker of the farm failed: {words(error)}; {_KEPT}") from error
            self.losses.update(flight.indices)
            for index in flight.indices:
                if self.losses[index] > _MAX_LOSSES:
                    raise RuntimeError(f"workers end before they report on case {self.cases[index]!r:.80}: {error}")
            self.suspects.extend(flight.indices)
        else:  # the scheduler was restarted, or a worker left with the result
            self.waiting.extend(flight.indices)

    def _take(self, report: Report, flight: _Flight) -> None:
        if report.refused:
            raise _core.InputError(report.refused)
        if report.rows:
            self._write(report.rows, report)
        for index, id, is_new in report.cases:
            self.ids[index] = id
            self.num_computed += is_new
        missing = [index for index in flight.indices if index not in self.ids]
        self.waiting.extend(missing)
        if report.unwritable and missing:
            self.avoided.add(report.worker)
            if self.avoided >= set(self.client.nthreads()):
                raise _core.InputError(f"{report.host} cannot write {self.folder}: {report.unwritable}; {_KEPT}")
        if report.cases:
            mean = report.seconds / len(report.cases)
            self.time_per_case = (self.time_per_case + mean) / 2 if self.time_per_case else mean

    def _write(self, rows: list[Row], report: Report) -> None:
        """Writes rows that their worker cannot write."""
        try:
            add_rows(self.folder, rows)
            remove_parts(self.folder, rows)
        except OSError as error:
            raise _core.InputError(
                f"{report.host} and {socket.gethostname()} cannot write {self.folder}: {error.strerror}; {_KEPT}"
            ) from None

    # The end.

    def stop(self) -> None:
        """Ends the batches on their way between two steps, and takes their reports."""
        (self.live / "plan.pickle").unlink(missing_ok=True)
        end = time.monotonic() + _STOP_WAIT
        while any(not flight.future.done() for flight in self.flights.values()) and time.monotonic() < end:
            time.sleep(0.05)
        for flight in self.flights.values():
            report = _report_of(flight)
            if report and report.rows:
                self._write(report.rows, report)
        self.client.cancel([flight.future for flight in self.flights.values()])

    def finish(self) -> pyarrow.Table:
        """Merges the files of rows; the table of the cases."""
        pyarrow, parquet = importlib.import_module("pyarrow"), importlib.import_module("pyarrow.parquet")
        merge_rows(self.folder)
        rows = read_rows(self.folder)
        own = [rows[self.ids[n], _text(case)] for n, case in enumerate(self.cases)]
        stream = pyarrow.BufferOutputStream()
        parquet.write_table(table(self.folder), stream)
        write_whole(self.folder / "cases.parquet", stream.getvalue().to_pybytes())
        failed = sum(row["error"] is not None for row in own)
        if failed and self.tell is not None:
            print(f"{self.folder}: {failed} of {len(own)} cases failed; column error has the reasons", file=sys.stderr)
        return _as_table(own)


def _report_of(flight: _Flight) -> Report | None:
    """None for a batch that was lost or has failed."""
    try:
        report = Report(**json.loads(flight.file.read_text()))
        flight.file.unlink()
        return report
    except OSError:
        asyncio, futures = importlib.import_module("asyncio"), importlib.import_module("concurrent.futures")
    try:
        return flight.future.result(timeout=_RESULT_WAIT) if flight.future.status == "finished" else None
    except (OSError, asyncio.TimeoutError, asyncio.CancelledError, futures.CancelledError):  # its worker has died
        return None


_KEPT = "finished cases are kept, and read when it runs again"


@contextlib.contextmanager
def _farm_of(
    folder: Path, plan: Plan, cases: list[Case], client: Any, progress: bool | Progress
) -> Iterator[_Farm]:
    choose(client, "client", _require().Client, "a dask.distributed.Client")
    if client.asynchronous:
        raise _core.InputError("client: expected one that is not asynchronous")
    try:
        data = importlib.import_module("cloudpickle").dumps(plan)
    except Exception as error:
        raise _core.InputError(f"make_world, measure and control cannot be sent to workers: {words(error)}") from None
    name = f"{socket.gethostname()}-{os.getpid()}-{uuid.uuid4().hex[:8]}"
    try:
        for part in ("rows", "live"):
            (folder / part).mkdir(parents=True, exist_ok=True)
        _remove_dead(folder / "live")
        new = folder / "live" / f".{name}"
        new.mkdir()
        write_whole(new / "plan.pickle", data)
        new.rename(folder / "live" / name)  # with its contents at once
    except OSError as error:
        raise _core.InputError(f"{folder} cannot be written: {error.strerror}") from None
    is_log = not sys.stderr.isatty() and "ipykernel" not in sys.modules
    show = print_progress if is_log else show_progress
    tell = show(folder.name, "case") if progress is True else progress or None
    farm = _Farm(folder, plan, cases, client, tell, name)
    try:
        try:
            yield farm
        except BaseException:
            farm.stop()
            raise
    finally:
        shutil.rmtree(farm.live, ignore_errors=True)


def _remove_dead(live: Path) -> None:
    """Folders of farms of this machine whose process was killed."""
    host = socket.gethostname()
    for each in live.iterdir():
        start, _, rest = each.name.lstrip(".").rpartition("-")
        owner, _, process = start.rpartition("-")
        if owner == host and process.isdigit() and not Path("/proc", process).exists():
            shutil.rmtree(each, ignore_errors=True)


def _text(case: Case) -> str:
    return canonical(plain(case, "case"))


def _as_table(rows: list[Row]) -> pyarrow.Table:
    """Columns: values of the cases, measures, COLUMNS. Raises InputError for values that have no common type."""
    pyarrow = importlib.import_module("pyarrow")
    columns: dict[str, list[Any]] = {}
    for part in ("case", "measures"):
        for row in rows:
            for name in row[part]:
                columns.setdefault(name, [])
    for name, values in columns.items():
        values.extend(row["case"].get(name, row["measures"].get(name)) for row in rows)
    for name in COLUMNS:
        columns[name] = [row[name] for row in rows]
    arrays = {}
    for name, values in columns.items():
        try:
            arrays[name] = pyarrow.array(values)
        except (pyarrow.ArrowException, OverflowError) as error:
            raise _core.InputError(f'column "{name}": values of the cases have no common type: {error}') from None
    return pyarrow.table(arrays)
