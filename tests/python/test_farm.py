"""Farms: every case has its row once, with the bits of a lone run, whatever happens to workers, farm and folder."""

from __future__ import annotations

import importlib.util
import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import weft
from worlds import python

for package in ("distributed", "pyarrow"):
    if importlib.util.find_spec(package) is None:
        pytest.skip(f"the Python package {package} is missing", allow_module_level=True)

import dask
import farms
import pyarrow.parquet
from distributed import Client, LocalCluster
from farms import DT, SECONDS, Log, Tokens, control, lone_hash, make_world, measure
from weft import _farm_folder, farm

CASES = farm.grid(height=[1.0, 1.1, 1.2, 1.3], push=range(10))
HASHES = [lone_hash(case) for case in CASES]
LIMIT = 240  # for anything that has to happen at all [s]


@contextmanager
def workers(count: int, *, threads: int = 1) -> Iterator[Client]:
    """Workers on this machine, restarted when they die, by forks of a process that has imported dask.

    dask gives up a worker that is killed while it starts: the cluster forgets it after 3 s, and scale() makes another.
    """
    with (
        dask.config.set(
            {"distributed.worker.multiprocessing-method": "forkserver", "distributed.deploy.lost-worker-timeout": "3s"}
        ),
        LocalCluster(
            n_workers=count, threads_per_worker=threads, host="127.0.0.1", dashboard_address="127.0.0.1:0",
            worker_dashboard_address="127.0.0.1:0", silence_logs=60, memory_limit=0,
        ) as cluster,
        Client(cluster) as client,
    ):  # fmt: skip
        yield client


def scaled(client: Client, count: int) -> Callable[[int, int, float, float], object]:
    """A progress that starts workers which dask has given up."""
    return lambda *_: client.cluster.scale(count)


@pytest.fixture(scope="module")
def two() -> Iterator[Client]:
    """Two workers that no test kills."""
    with workers(2) as client:
        yield client


def run(cases: list[dict[str, Any]], out: Path, **options: Any) -> Any:
    given = {"make_world": make_world, "control": control, "measure": measure, "seconds": SECONDS, "dt": DT, **options}
    return farm.run(given.pop("make_world"), cases, out=out, progress=given.pop("progress", False), **given)


def hashes(table: Any) -> list[str]:
    found: list[str] = table["state_hash"].to_pylist()
    return found


def until(condition: Callable[[], bool]) -> None:
    end = time.monotonic() + LIMIT
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


# Kills.


@pytest.mark.parametrize("count", [1, 2, 3])
def test_twenty_kills_of_working_processes_lose_nothing(count: int, tmp_path: Path) -> None:
    tokens = Tokens(tmp_path / "kills", 20)
    with workers(count) as client:
        # By chance, one case can be hit several times: it is not a culprit.
        deadly = farms.deadly_control(tmp_path / "kills")
        table = run(CASES, tmp_path / "out", control=deadly, client=client, max_deaths=21, progress=scaled(client, count))
    assert len(tokens) == 0
    assert hashes(table) == HASHES and table["error"].null_count == len(CASES)
    everything = farm.table(tmp_path / "out")
    assert sorted(hashes(everything)) == sorted(HASHES)
    assert len({(case["height"], case["push"]) for case in everything.to_pylist()}) == len(CASES)
    assert os.listdir(tmp_path / "out" / "live") == [] and os.listdir(tmp_path / "out" / "rows") != []


def process(out: Path, log: Path, what: str) -> subprocess.Popen[bytes]:
    path = os.pathsep.join([str(Path(farms.__file__).parent), *filter(None, sys.path)])
    environment = {**os.environ, "PYTHONPATH": path}
    return subprocess.Popen([sys.executable, farms.__file__, str(out), str(log), what], env=environment)


def test_a_killed_farm_goes_on_with_a_second_one_in_its_folder(tmp_path: Path) -> None:
    out = tmp_path / "out"
    killed = process(out, tmp_path / "log", "die")
    assert killed.wait(LIMIT) == -signal.SIGKILL
    done = farm.table(out).num_rows
    assert 10 <= done < len(CASES)
    both = [process(out, tmp_path / f"log{n}", "live") for n in range(2)]
    assert [each.wait(LIMIT) for each in both] == [0, 0]
    table = farm.table(out)
    assert sorted(hashes(table)) == sorted(HASHES)
    farms_of = table["farm"].to_pylist()
    assert sum(f"-{killed.pid}-" in each for each in farms_of) >= 10  # these were read
    assert os.listdir(out / "live") == []


def test_ctrl_c_keeps_finished_cases(tmp_path: Path, two: Client) -> None:
    done = 0

    def tell(number: int, count: int, spent: float, left: float) -> None:
        nonlocal done
        done = number
        if number >= 12:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        run(CASES, tmp_path, client=two, progress=tell)
    kept = farm.table(tmp_path)
    assert 12 <= done <= kept.num_rows <= len(CASES) and os.listdir(tmp_path / "live") == []
    table = run(CASES, tmp_path, client=two)
    assert hashes(table) == HASHES
    assert set(kept["id"].to_pylist()) <= set(table["id"].to_pylist())
    assert len(set(table["farm"].to_pylist())) == (2 if kept.num_rows < len(CASES) else 1)


def test_a_restarted_scheduler_loses_nothing(tmp_path: Path) -> None:
    with workers(1) as client:
        restarts = iter([5, 20])
        due = next(restarts)

        def tell(number: int, count: int, spent: float, left: float) -> None:
            nonlocal due
            if number >= due:
                due = next(restarts, 1000)
                client.restart()  # cancels every future

        assert hashes(run(CASES, tmp_path, client=client, progress=tell)) == HASHES
        assert due == 1000


def test_a_culprit_gets_its_sentence_and_its_victims_their_rows(tmp_path: Path) -> None:
    def deadly(world: weft.World, step: int) -> None:
        if step == 2 and world.cloths[0].num_particles == 36:
            farms.die()
        control(world, step)

    cases = [dict(case, cells=5 if n == 7 else 4) for n, case in enumerate(CASES[:16])]
    with workers(1, threads=2) as client:
        table = run(cases, tmp_path, control=deadly, client=client, progress=scaled(client, 1))
    errors = table["error"].to_pylist()
    assert errors[7].startswith("the case ended its worker 3 times, each time as the only case in it")
    assert [error for n, error in enumerate(errors) if n != 7] == [None] * 15
    assert [each for n, each in enumerate(hashes(table)) if n != 7] == [h for n, h in enumerate(HASHES[:16]) if n != 7]


def test_a_farm_without_workers_says_so_and_goes_on_with_the_first(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(farm, "_UNSERVED", 0.2)
    with workers(0) as client:
        later = threading.Timer(3, lambda: client.cluster.scale(1))
        later.start()
        with pytest.warns(RuntimeWarning, match="no worker for 0.2 s, and waits"):
            table = run(CASES[:2], tmp_path, client=client)
        later.join()
    assert hashes(table) == HASHES[:2]


def test_a_deadly_make_world_gets_its_sentence_and_is_not_called_again(tmp_path: Path) -> None:
    log = Log(tmp_path / "log")

    def deadly(case: dict[str, Any]) -> weft.World:
        if case["push"] == 1:
            log.add("death")
            farms.die()
        return make_world(case)

    with workers(1) as client:
        table = run(CASES[:3], tmp_path / "out", make_world=deadly, client=client, progress=scaled(client, 1))
        assert [error is None for error in table["error"].to_pylist()] == [True, False, True]
        deaths = len(log.lines())
        assert deaths >= 3
        assert run(CASES[:3], tmp_path / "out", make_world=deadly, client=client).equals(table)
    assert len(log.lines()) == deaths


def test_no_cases_are_a_table_without_rows(tmp_path: Path, two: Client) -> None:
    table = run([], tmp_path, client=two)
    assert table.num_rows == 0 and "state_hash" in table.column_names


def test_a_full_folder_of_one_worker_loses_nothing(tmp_path: Path) -> None:
    with workers(2) as client:
        full = farms.full_folder(tmp_path / "full")
        tokens = Tokens(tmp_path / "full", 1)
        table = run(CASES[:20], tmp_path / "rows", make_world=full, client=client)
        assert len(tokens) == 0 and hashes(table) == HASHES[:20]
        table = run(CASES[:20], tmp_path / "frames", client=client, frames=3)  # one of both is still full
        assert hashes(table) == HASHES[:20]
        Tokens(tmp_path / "full", 4)
        with pytest.raises(weft.InputError, match="cannot write .*File too large; finished cases are kept"):
            run(CASES, tmp_path / "both", make_world=full, client=client, frames=1)


# Long cases.


def test_a_long_case_goes_on_from_its_checkpoint(tmp_path: Path) -> None:
    tokens, log = {step: Tokens(tmp_path / f"kill{step}", 1) for step in (10, 11, 30)}, Log(tmp_path / "log")

    def deadly(world: weft.World, step: int) -> None:
        log.add(step)
        if step in tokens and tokens[step].take():
            farms.die()
        control(world, step)

    case = {"height": 1.0, "cells": 6}
    with workers(1) as client:
        options = {"client": client, "frames": 2, "seconds": 40 * DT, "checkpoint_every": 1e-9,
                   "progress": scaled(client, 1)}  # fmt: skip
        table = run([case], tmp_path / "out", control=deadly, **options)
        assert [int(line) for line in log.lines()] == [*range(11), *range(10, 12), *range(11, 31), *range(30, 40)]
        lone = run([case], tmp_path / "lone", **options)
    assert hashes(table) == hashes(lone) == [lone_hash(case, 40 * DT)]
    (frames,) = table["frames"].to_pylist()
    files = [tmp_path / folder / frames / "sheet.pc2" for folder in ("out", "lone")]
    assert files[0].read_bytes() == files[1].read_bytes()
    positions = np.frombuffer(files[0].read_bytes(), "<f4", offset=32).reshape(21, 49, 3)
    world = make_world(case)
    for step in range(41):
        if step % 2 == 0:
            assert np.array_equal(positions[step // 2], world.cloths[0].positions.astype(np.float32))
        control(world, step)
        world.step(DT)
    assert weft.read_obj(files[0].with_suffix(".obj")).faces.shape == (72, 3)
    assert os.listdir(tmp_path / "out" / "parts") == []


def test_a_damaged_checkpoint_is_not_used(tmp_path: Path) -> None:
    file, world = tmp_path / "checkpoint", make_world({"height": 1})
    assert _farm_folder.load_checkpoint(file) is None
    _farm_folder.save_checkpoint(file, world, {"step": 3})
    loaded = _farm_folder.load_checkpoint(file)
    assert loaded and loaded[1] == {"step": 3} and loaded[0].state_hash() == world.state_hash()
    data = bytearray(file.read_bytes())
    for place in (3, 40, 70, len(data) - 1):
        data[place] ^= 1
        file.write_bytes(data)
        assert _farm_folder.load_checkpoint(file) is None
        data[place] ^= 1
    file.write_bytes(data[:-1])
    assert _farm_folder.load_checkpoint(file) is None


# Cases and their rows.


def test_finished_cases_are_read_and_changed_ones_run(tmp_path: Path, two: Client) -> None:
    log, cases = Log(tmp_path / "log"), CASES[:6]

    def counting(world: weft.World) -> dict[str, Any]:
        log.add(world.state_hash())
        return measure(world)

    def heavier(case: dict[str, Any]) -> weft.World:
        world = make_world(case)
        if case["push"] == 2:
            world.gravity = (0, -10, 0)
        return world

    def computed(**options: Any) -> tuple[int, Any]:
        before = len(log.lines())
        table = run(cases, tmp_path / "out", measure=counting, client=two, **options)
        return len(log.lines()) - before, table

    number, first = computed()
    assert number == 6 and sorted(log.lines()) == sorted(HASHES[:6])
    number, again = computed()
    assert number == 0 and again.equals(first)
    number, changed = computed(make_world=heavier)
    assert number == 1
    assert [a == b for a, b in zip(hashes(changed), hashes(first), strict=True)] == [n != 2 for n in range(6)]
    assert computed(key="2")[0] == 6
    assert computed(seconds=2 * SECONDS)[0] == 6
    assert computed(dt=DT / 2)[0] == 6
    assert computed(frames=4)[0] == 6
    number, once_more = computed()
    assert number == 0 and hashes(once_more) == hashes(first)
    assert farm.table(tmp_path / "out").num_rows == 6 + 1 + 6 + 6 + 6


def test_cases_with_equal_worlds_have_rows_but_one_run(tmp_path: Path, two: Client) -> None:
    log = Log(tmp_path / "log")

    def counting(world: weft.World) -> dict[str, Any]:
        log.add("run")
        return measure(world)

    first = run([{"height": 1.0, "seed": 0}], tmp_path / "out", measure=counting, client=two)
    table = run([{"height": 1.0, "seed": n} for n in range(5)], tmp_path / "out", measure=counting, client=two)
    assert len(log.lines()) == 1
    assert table["seed"].to_pylist() == list(range(5)) and set(hashes(table)) == set(hashes(first))
    assert farm.table(tmp_path / "out").num_rows == 5


def test_columns_and_the_parquet_file(tmp_path: Path, two: Client) -> None:
    cases = [dict(case, label=f"n{n}", fabric=np.float32(0.5)) for n, case in enumerate(CASES[:3])]
    table = run(cases, tmp_path / "out", client=two)
    first = table.to_pylist()[0]
    assert [first[name] for name in ("height", "push", "label", "fabric")] == [1.0, 0, "n0", 0.5]
    world = make_world(cases[0])
    for step in range(12):
        control(world, step)
        world.step(DT)
    assert first["low"] == world.cloths[0].positions[:, 1].min()
    assert first["center"] == list(world.cloths[0].center_of_mass)
    assert first["report"]["steps"] == 12 and first["report"]["warnings"] == [] and first["error"] is None
    assert first["wall_seconds"] > 0 and first["host"] and first["seconds"] == SECONDS and first["dt"] == DT
    stored = pyarrow.parquet.read_table(tmp_path / "out" / "cases.parquet")
    assert stored.equals(farm.table(tmp_path / "out"))
    assert len(os.listdir(tmp_path / "out" / "rows")) == 1  # merged


def test_a_case_that_fails_is_a_row_with_its_sentence(tmp_path: Path, two: Client) -> None:
    def fragile(case: dict[str, Any]) -> weft.World:
        if case["push"] == 1:
            raise LookupError("no such\nperson")
        world = make_world(case)
        if case["push"] == 2:
            settings = weft.ExplicitSettings(substeps=1)
            world = weft.World(integrator=weft.IntegratorSettings(integrator="explicit", explicit_euler=settings))
            world.add_cloth(weft.grid(cells=(8, 8)), fabric=weft.Springs(structural=1e6), name="stiff").pin([0])
        if case["push"] == 4:
            world.gravity = (0, -9, 0)
        return world if case["push"] != 3 else "world"  # type: ignore[return-value]

    def moody(world: weft.World, step: int) -> None:
        if step == 5 and world.gravity[1] == -9:
            raise ValueError("enough")

    def picky(world: weft.World) -> dict[str, Any]:
        return {"push" if world.cloths[0].positions[0, 1] > 1.05 else "value": 1}

    cases = [*CASES[:5], CASES[10]]
    options = {"make_world": fragile, "control": moody, "measure": picky, "client": two}
    table = run(cases, tmp_path, **options)
    errors = table["error"].to_pylist()
    assert errors[0] is None
    assert errors[1] == "make_world: LookupError: no such person"
    assert errors[2].startswith("step ") and "the step failed" in errors[2]
    assert errors[3] == "make_world: its result: expected a World, found 'world'"
    assert errors[4] == "control, step 5: ValueError: enough"
    assert errors[5] == 'measure: "push" is the name of a column already; choose another name'
    assert [each is None for each in hashes(table)] == [error is not None for error in errors]
    assert run(cases, tmp_path, **options).equals(table)
    healed = run(cases, tmp_path, **{**options, "make_world": make_world, "control": control}, retry_failed=True)
    assert [error is None for error in healed["error"].to_pylist()] == [True] * 5 + [False]


def test_measures_that_no_table_has(tmp_path: Path, two: Client) -> None:
    table = run(CASES[:1], tmp_path / "a", measure=lambda world: {"self": world}, client=two)
    assert table["error"].to_pylist()[0].startswith('measure: "self": expected a number, text, array')

    def mixed(world: weft.World) -> dict[str, Any]:
        return {"value": 1 if world.cloths[0].positions[0, 1] > 1.05 else "text"}

    with pytest.raises(weft.InputError, match='column "value": values of the cases have no common type'):
        run([CASES[0], CASES[10]], tmp_path / "b", measure=mixed, client=two)
    assert len(_farm_folder.read_rows(tmp_path / "b")) == 2


def test_rows_merge_without_loss(tmp_path: Path) -> None:
    (tmp_path / "rows").mkdir()
    rows = [
        {"id": f"{n % 7}", "case": {"n": n % 5}, "error": None if n % 2 else "e", "frames": None, "finished": f"{n:03}"}
        for n in range(40)
    ]
    for row in rows:
        _farm_folder.add_rows(tmp_path, [row])
    before = _farm_folder.read_rows(tmp_path)
    assert len(before) == 35
    assert all(row["error"] is None for row in before.values() if int(row["finished"]) % 2)
    _farm_folder.merge_rows(tmp_path)
    assert _farm_folder.read_rows(tmp_path) == before and len(os.listdir(tmp_path / "rows")) == 1
    _farm_folder.add_rows(tmp_path, rows[:1])
    _farm_folder.merge_rows(tmp_path)
    assert _farm_folder.read_rows(tmp_path) == before and len(os.listdir(tmp_path / "rows")) == 1


# The interface.


def test_a_script_without_a_guard_runs_on_this_machine(tmp_path: Path) -> None:
    code = """
import sys, weft
from farms import make_world
table = weft.farm.run(make_world, weft.farm.grid(height=[1, 2, 3]), seconds=0.1, out=sys.argv[1], workers=2)
print(table.num_rows, table["error"].null_count)
"""
    done = python(code, str(tmp_path / "drops"))
    assert (done.returncode, done.stdout) == (0, "3 3\n"), done.stderr
    assert done.stderr == "drops: case 3 of 3, 0 s left\n"


def test_every_combination_is_a_case() -> None:
    cases = farm.grid(fabric=["denim", "silk"], drop=np.linspace(0.2, 1, 50), seed=range(20))
    assert len(cases) == 2000 and cases[-1] == {"fabric": "silk", "drop": 1.0, "seed": 19}
    assert json.loads(json.dumps(cases)) == cases
    assert farm.grid() == [{}] and farm.grid(a=[]) == []


@pytest.mark.parametrize(
    "options, words",
    [
        ({"cases": [3]}, "cases: expected a list of dicts, found 3"),
        ({"cases": {"a": 1}}, "cases: expected a list of dicts"),
        ({"cases": [{"id": 3}]}, "cases: 'id' is no name for a value; the table has error, state_hash"),
        ({"cases": [{"a": {1}}]}, "cases: a: expected a number, text, array, list or dict"),
        ({"make_world": None}, "make_world: expected a function, found None"),
        ({"measure": 3}, "measure: expected a function, found 3"),
        ({"seconds": 0}, "seconds and dt: expected at least one step, found 0 s and"),
        ({"dt": -1}, "seconds and dt"),
        ({"frames": -1}, "frames: expected at least 0, found -1"),
        ({"max_deaths": 0}, "max_deaths: expected at least 1, found 0"),
        ({"checkpoint_every": 0}, "checkpoint_every: expected a number above 0, found 0"),
        ({"key": 3}, "key: expected a text, found 3"),
        ({"client": 3}, "client: expected a dask.distributed.Client, found 3"),
        ({"workers": 0}, "workers: expected at least 1, found 0"),
    ],
)
def test_mistakes_are_one_sentence(options: dict[str, Any], words: str, tmp_path: Path) -> None:
    given = {"cases": [{"height": 1.0}], "out": tmp_path / "out", **options}
    with pytest.raises(weft.InputError) as caught:
        run(given.pop("cases"), **given)
    assert str(caught.value).startswith(words)
    assert not (tmp_path / "out").exists()


def test_mistakes_of_folders_and_functions(tmp_path: Path, two: Client) -> None:
    with pytest.raises(weft.InputError, match="holds no farm: there is no folder rows"):
        farm.table(tmp_path)
    (tmp_path / "file").touch()
    with pytest.raises(weft.InputError, match="file cannot be written: Not a directory"):
        run(CASES[:1], tmp_path / "file", client=two)
    lock = threading.Lock()
    with pytest.raises(weft.InputError, match="measure and control cannot be sent to workers: TypeError: cannot pickle"):
        run(CASES[:1], tmp_path / "out", control=lambda world, step: lock.acquire(), client=two)
    with pytest.raises(weft.InputError, match="workers: a client has its own workers"):
        run(CASES[:1], tmp_path / "out", client=two, workers=2)


def test_without_its_packages_a_farm_names_them() -> None:
    code = """
import sys
sys.modules["distributed"] = None
import weft
for call in (lambda: weft.farm.run(None, [], seconds=1, out="x"), lambda: weft.farm.table("x")):
    try:
        call()
    except ImportError as error:
        print(error)
print("dask" in sys.modules, len(weft.farm.grid(a=[1, 2])))
"""
    sentence = "weft.farm needs the Python packages dask, distributed and pyarrow: pip install weft[farm]\n"
    assert python(code).stdout == 2 * sentence + "False 2\n"
