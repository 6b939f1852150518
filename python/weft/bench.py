"""Speed of the package, as ratios within one run: `python -m weft.bench`; of farms: `python -m weft.bench farm`."""

from __future__ import annotations

import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _core, farm
from ._batch import Batch
from ._mesh import grid
from ._world import World

_STEP = 1 / 60


def _hang(cells: int, *, contact: bool = False, ball: bool = False) -> World:
    """A square metre of cotton, hung by two corners and released."""
    world = World(contact=contact)
    sheet = world.add_cloth(grid(size=(1, 1), cells=(cells, cells)), name="sheet")
    sheet.pin(sheet.corners[:2])
    if ball:
        world.add_collider(_core.Sphere(center=(0.5, -0.3, 0.3), radius=0.2))
    return world


def _median_ratio(first: Callable[[], object], second: Callable[[], object], rounds: int) -> tuple[float, float]:
    """Median of first ÷ second over alternating calls, and the median seconds of the second."""
    times: tuple[list[float], list[float]] = ([], [])
    for n in range(2 * rounds):
        which = (n + n // 2) % 2  # first, second, second, first, …
        start = time.perf_counter()
        (first, second)[which]()
        times[which].append(time.perf_counter() - start)
    ratio = statistics.median(a / b for a, b in zip(*times, strict=True))
    return ratio, statistics.median(times[1])


def _row(what: str, figure: str, aim: str = "") -> None:
    print(f"{what:<66} {figure:>12}   {aim}", flush=True)


def _repeat(call: Callable[[], object], count: int) -> Callable[[], None]:
    def repeat() -> None:
        for _ in range(count):
            call()

    return repeat


def _bench_step() -> None:
    by_python = _hang(63)
    in_cpp = _core.Batch(1)  # its loop over steps is C++
    in_cpp.add(by_python._core)
    in_cpp.make_worlds()
    steps = 20
    ratio, per_call = _median_ratio(
        _repeat(lambda: by_python.step(_STEP), steps), lambda: in_cpp.step(_STEP, steps, [], []), 15
    )
    _row(f"World.step, 64 × 64: Python ÷ C++ ({1e3 * per_call / steps:.2f} ms)", f"{ratio:.3f}", "≤ 1.01")


def _bench_copies() -> None:
    for size, aim, aim_new in ((32, 2, 3), (64, 1, 3), (128, 1, 3), (256, 1, 3), (512, 1, 0)):
        world = _hang(size - 1)
        sheet = world.cloths[0]
        out = np.empty((len(sheet), 3), np.float32)
        for _ in range(3):
            world.step(_STEP)
        copies, rounds = (50, 10) if size < 200 else (5, 4)
        step = _repeat(lambda world=world: world.step(_STEP), 3)  # type: ignore[misc]
        copy = _repeat(lambda sheet=sheet, out=out: sheet.copy_positions(out), copies)  # type: ignore[misc]
        share = 100 * 3 / copies * _median_ratio(copy, step, rounds)[0]
        _row(f"copy_positions, {size} × {size}, of a step", f"{share:.2f} %", f"≤ {aim} %")
        new = _repeat(lambda sheet=sheet: sheet.positions, copies)  # type: ignore[misc]
        share = 100 * 3 / copies * _median_ratio(new, step, rounds)[0]
        aim_of_new = f"≤ {aim_new} %" if aim_new else ""
        _row(f"positions (a new array), {size} × {size}, of a step", f"{share:.2f} %", aim_of_new)


def _seconds_per_step(world: World, steps: int) -> float:
    """Makes the steps several times, and goes on from their end."""
    start, times = world.snapshot(), []
    for _ in range(8):
        world.restore(start)
        begin = time.perf_counter()
        for _ in range(steps):
            world.step(_STEP)
        times.append((time.perf_counter() - begin) / steps)
    return statistics.median(times)


def _bench_batch(what: str, *, contact: bool, resets: bool) -> None:
    count = 64
    steps, rounds = (100, 3) if resets else (4, 12)  # a reset after every hundredth step

    def make_world(i: int) -> World:
        return _hang(31, contact=contact, ball=contact)

    one, two, lone = Batch(make_world, count, threads=1), Batch(make_world, count, threads=2), make_world(0)
    random = np.random.default_rng(1)

    def seconds(batch: Batch, mask: NDArray[np.bool_]) -> float:
        start = time.perf_counter()
        batch._core.step(_STEP, steps, [], [])
        if resets:
            batch.reset(mask)
        return time.perf_counter() - start

    ratios, per_world, rates, cores = [], [], [], []
    for _ in range(rounds):
        mask = random.random(count) < 0.5
        by_one = seconds(one, mask)
        cpu = time.process_time()
        by_two = seconds(two, mask)
        cores.append((time.process_time() - cpu) / by_two)
        ratios.append(by_one / by_two)
        rates.append(count * steps / by_two)
        if not resets:
            per_world.append(by_one / (count * steps) / _seconds_per_step(lone, steps))
    used = f"used {statistics.median(cores):.2f} cores"
    _row(f"Batch of 64, 32 × 32, {what}: one thread ÷ two", f"{statistics.median(ratios):.2f}", f"≥ 1.8; {used}")
    if not resets and not contact:
        ratio = statistics.median(per_world)
        _row(f"Batch of 64, 32 × 32, {what}: a world's step ÷ a lone world's", f"{ratio:.3f}", "≤ 1.05")
    _row(f"Batch of 64, 32 × 32, {what}: two threads", f"{statistics.median(rates):.0f} steps/s")


def _bench_restore() -> None:
    world = _hang(63)
    for _ in range(5):
        world.step(_STEP)
    saved, state = np.frombuffer(world.save(), np.uint8), world.snapshot()
    copy = np.empty_like(saved)
    ratio, _ = _median_ratio(
        _repeat(lambda: world.restore(state), 50), _repeat(lambda: np.copyto(copy, saved), 50), 15
    )
    _row(f"restore, 64 × 64 ÷ memcpy of its {len(saved) / 1e6:.2f} MB of saved bytes", f"{ratio:.2f}", "≤ 4")
    ratio, _ = _median_ratio(lambda: world.restore(state), lambda: world.step(_STEP), 15)
    _row("restore, 64 × 64, of a step", f"{100 * ratio:.1f} %")


def _bench_import() -> None:
    def load(modules: str) -> float:
        code = f"import time; start = time.perf_counter(); import {modules}; print(time.perf_counter() - start)"
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
        output = subprocess.run([sys.executable, "-c", code], env=environment, capture_output=True, check=True).stdout
        return float(output)

    beyond = statistics.median(load("numpy, weft") - load("numpy") for _ in range(7))
    _row("import weft, beyond NumPy", f"{1e3 * beyond:.0f} ms", "≤ 50 ms")


def _bench_mujoco() -> None:
    try:
        import mujoco  # type: ignore[import-not-found,unused-ignore]
        from mujoco import rollout  # type: ignore[import-not-found,unused-ignore]
    except ImportError:
        _row("MuJoCo's rollout: not installed", "–")
        return
    model = mujoco.MjModel.from_xml_string(
        """<mujoco><option timestep="0.002" solver="CG" tolerance="1e-6"/><size memory="1G"/><worldbody>
        <flexcomp name="sheet" type="grid" count="32 32 1" spacing="0.032 0.032 0.032" dim="2" radius="0.001" mass="0.12">
        <edge equality="true" damping="0.001"/><contact selfcollide="none"/><pin id="0 31"/></flexcomp>
        </worldbody></mujoco>"""
    )
    state = mujoco.MjData(model)
    size = mujoco.mj_stateSize(model, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    initial = np.empty(size)
    mujoco.mj_getState(model, state, initial, mujoco.mjtState.mjSTATE_FULLPHYSICS)
    worlds, steps = 8, 8  # 8 × 2 ms: a frame
    start = time.perf_counter()
    rollout.rollout(model, [mujoco.MjData(model) for _ in range(2)], np.tile(initial, (worlds, 1)), nstep=steps)
    rate = worlds * steps / 8 / (time.perf_counter() - start)
    _row("MuJoCo's rollout, a flex of 32 × 32, frames of 8 × 2 ms, two threads", f"{rate:.0f} frames/s")


def _make_case(case: dict[str, int]) -> World:
    world = _hang(8)
    world.cloths[0].velocities = (0, 0, 1e-4 * case["n"])
    return world


def _measure_case(world: World) -> dict[str, float]:
    return {"height": world.cloths[0].center_of_mass[1]}


def _loop_over_cases(steps: int, count: int) -> None:
    for n in range(count):
        world = _make_case({"n": n})
        for _ in range(steps):
            world.step(_STEP)
        _measure_case(world)


def count_cases(steps: int, file: str, parent: int) -> None:
    """Cases without a farm, while the parent process lives. After each one, writes their number to a file."""
    stream, number = os.open(file, os.O_WRONLY | os.O_CREAT), 0
    while os.getppid() == parent:
        _loop_over_cases(steps, 1)
        number += 1
        os.pwrite(stream, f"{number:12}".encode(), 0)


def _bench_farm(num_cases: int, milliseconds: int, aim: int) -> None:
    """Cases of a duration by one worker of a farm, and at the same time by a loop in another process."""
    few, times = max(1, 2000 // milliseconds), []
    for _ in range(3):
        start = time.perf_counter()
        _loop_over_cases(10, few)
        times.append((time.perf_counter() - start) / (10 * few))
    steps = max(1, round(1e-3 * milliseconds / min(times)))
    with farm.local(1) as client, tempfile.TemporaryDirectory() as folder:
        cases, count = farm.grid(n=range(num_cases)), Path(folder, "count")
        options: dict[str, Any] = {"client": client, "progress": False, "measure": _measure_case}
        farm.run(_make_case, cases[:1], seconds=_STEP, out=f"{folder}/first", **options)
        code = f"import weft.bench; weft.bench.count_cases({steps}, {str(count)!r}, {os.getpid()})"
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
        loop = subprocess.Popen([sys.executable, "-c", code], env=environment, start_new_session=True)
        try:
            while not count.is_file() or not count.read_text():
                time.sleep(0.01)
            before, start = int(count.read_text()), time.perf_counter()
            farm.run(_make_case, cases, seconds=steps * _STEP, dt=_STEP, out=f"{folder}/farm", **options)
            looped, spent = int(count.read_text()) - before, time.perf_counter() - start
        finally:
            loop.kill()
            loop.wait()
    what = f"a farm of {num_cases} cases of {1e3 * spent / looped:.0f} ms, beyond a loop at the same time"
    _row(what, f"{100 * (looped / num_cases - 1):.1f} %", f"≤ {aim} %")


def bench_farms() -> None:
    """Prints the rows of farms."""
    try:
        _bench_farm(10_000, 10, 25)
        _bench_farm(600, 200, 3)
    except ImportError as error:
        _row(str(error), "–")


def main() -> None:
    """Prints the table: what, the figure, and the aim."""
    _bench_step()
    _bench_copies()
    _bench_batch("no contact", contact=False, resets=False)
    _bench_batch("ball and contact", contact=True, resets=False)
    _bench_batch("no contact, resets", contact=False, resets=True)
    _bench_mujoco()
    _bench_restore()
    _bench_import()


if __name__ == "__main__":
    bench_farms() if sys.argv[1:] == ["farm"] else main()
