"""Batches: the bits of lone worlds, arrays filled by every step, resets and rollouts."""

from __future__ import annotations

import warnings
from collections.abc import Callable

import numpy as np
import pytest
import weft
from worlds import DT, advance, cloth_of, draped, hanging

COUNT = 4


def raised(i: int) -> weft.World:
    """A hanging sheet, of another height in each world."""
    return hanging(8, height=1 + 0.25 * i)


def falling(i: int) -> weft.World:
    """A sheet that falls on a ball, of another fabric in each world."""
    world = draped(8)
    cloth_of(world).fabric = weft.find_fabric("cotton_shirting")._replace(density=0.1 + 0.02 * i)
    return world


def hashes(batch: weft.Batch) -> list[str]:
    return [batch[i].state_hash() for i in range(len(batch))]


def lone(make_world: Callable[[int], weft.World], steps: int) -> list[str]:
    worlds = [make_world(i) for i in range(COUNT)]
    for world in worlds:
        advance(world, steps)
    return [world.state_hash() for world in worlds]


@pytest.mark.parametrize("threads", [1, 2, 3])
@pytest.mark.parametrize("make_world", [raised, falling])
def test_a_batch_has_the_bits_of_lone_worlds(make_world: Callable[[int], weft.World], threads: int) -> None:
    batch = weft.Batch(make_world, COUNT, threads=threads)
    for _ in range(14):
        reports = batch.step(DT)
    assert len(reports) == len(batch) == COUNT and all(report.ok for report in reports)
    assert hashes(batch) == lone(make_world, 14)
    assert len(set(hashes(batch))) == COUNT


def test_arrays_are_the_same_for_ever_and_filled_by_every_step() -> None:
    batch = weft.Batch(raised, COUNT, threads=2)
    positions, velocities = batch.positions["sheet"], batch.velocities["sheet"]
    assert positions.shape == velocities.shape == (COUNT, 81, 3)
    assert positions.dtype == velocities.dtype == np.float32
    assert list(batch.positions) == ["sheet"] and len(batch.positions) == 1

    def check() -> None:
        for i in range(COUNT):
            sheet = cloth_of(batch[i])
            assert np.array_equal(positions[i], sheet.positions.astype(np.float32))
            assert np.array_equal(velocities[i], sheet.velocities.astype(np.float32))

    check()
    for _ in range(3):
        before = positions.copy()
        batch.step(DT)
        check()
        assert not np.array_equal(positions, before)
        assert batch.positions["sheet"] is positions and batch.velocities["sheet"] is velocities
    batch.reset()
    check()
    batch.rollout(np.repeat(positions[:, None, [0, 8]], 2, axis=1), DT)
    check()


def test_the_array_outlives_the_batch() -> None:
    batch = weft.Batch(raised, 2)
    positions = batch.positions["sheet"]
    batch.step(DT)
    before = positions.copy()
    del batch
    assert np.array_equal(positions, before)


@pytest.mark.parametrize(
    "chosen", [[0, 2], [-1], [True, False, False, True], np.array([1]), 3, [], None],
    ids=["indices", "negative", "mask", "array", "one", "none", "all"],
)  # fmt: skip
def test_reset_worlds_have_their_first_bits_and_the_others_go_on(chosen: object) -> None:
    batch = weft.Batch(falling, COUNT, threads=2)
    first = hashes(batch)
    for _ in range(12):
        batch.step(DT)
    later = hashes(batch)
    batch.reset(chosen)  # type: ignore[arg-type]
    is_reset = np.ones(COUNT, bool)
    if chosen is not None:
        is_reset = np.isin(np.arange(COUNT), np.arange(COUNT)[chosen])  # type: ignore[index]
    assert hashes(batch) == [first[i] if is_reset[i] else later[i] for i in range(COUNT)]
    for _ in range(12):
        batch.step(DT)
    assert [hashes(batch)[i] for i in np.flatnonzero(is_reset)] == [later[i] for i in np.flatnonzero(is_reset)]


def goals_of(batch: weft.Batch, steps: int) -> tuple[np.ndarray, np.ndarray]:
    """Two corners that rise, at another speed in each world."""
    corners = np.array([0, 8])
    rise = np.linspace(0, 0.05, steps + 1)[1:, None] * np.array([0.0, 1.0, 0.2])
    starts = np.stack([cloth_of(batch[i]).positions[corners] for i in range(len(batch))])
    speeds = 1 + np.arange(len(batch))
    return corners, starts[:, None] + speeds[:, None, None, None] * rise[None, :, None]


@pytest.mark.parametrize("threads", [1, 2])
def test_a_rollout_is_its_steps(threads: int) -> None:
    steps = 6
    batch, twin = weft.Batch(raised, COUNT, threads=threads), weft.Batch(raised, COUNT)
    corners, goals = goals_of(batch, steps)
    states = batch.rollout(goals, dt=DT)
    assert states.shape == (COUNT, steps, 81, 3) and states.dtype == np.float32
    positions = twin.positions["sheet"]
    for step in range(steps):
        twin.step(DT, targets={"sheet": (corners, goals[:, step])})
        assert np.array_equal(states[:, step], positions)
    assert hashes(batch) == hashes(twin)
    worlds = [raised(i) for i in range(COUNT)]
    for i, world in enumerate(worlds):
        for step in range(steps):
            cloth_of(world).set_targets(corners, goals[i, step])
            world.step(DT)
    assert hashes(batch) == [world.state_hash() for world in worlds]
    assert positions[:, corners] == pytest.approx(goals[:, -1], abs=1e-6)


def test_a_rollout_names_particles_and_cloth() -> None:
    batch, twin = weft.Batch(raised, 2), weft.Batch(raised, 2)
    corners, goals = goals_of(batch, 3)
    states = batch.rollout(goals[:, :, ::-1], DT, cloth="sheet", particles=corners[::-1] - 81)
    assert np.array_equal(states, twin.rollout(goals, DT))


def test_a_rollout_without_steps_changes_nothing() -> None:
    batch = weft.Batch(raised, 2)
    before = hashes(batch)
    assert batch.rollout(np.empty((2, 0, 2, 3)), DT).shape == (2, 0, 81, 3)
    assert hashes(batch) == before


def test_worlds_of_a_batch_are_read_and_changed_between_steps() -> None:
    batch = weft.Batch(raised, 2)
    batch[0].gravity = (0, 0, 0)
    cloth_of(batch[-1]).velocities = (0, 1, 0)
    batch.step(DT)
    expected = [raised(0), raised(1)]
    expected[0].gravity = (0, 0, 0)
    cloth_of(expected[1]).velocities = (0, 1, 0)
    assert hashes(batch) == [world.state_hash() for world in expected if world.step(DT).ok]


def test_the_batch_copies_the_worlds_that_it_is_given() -> None:
    world = hanging(6)
    batch = weft.Batch(lambda i: world, 2)
    before = world.state_hash()
    batch.step(DT)
    assert world.state_hash() == before and hashes(batch)[0] == hashes(batch)[1] != before


def test_of_two_cloths_of_one_name_the_first_counts() -> None:
    def make_world(i: int) -> weft.World:
        world = weft.World(gravity=(0, 0, 0))
        for height in (1.0, 2.0):
            world.add_cloth(weft.grid(cells=(3, 3)), position=(0, height + i, 0), name="twin")
        return world

    batch = weft.Batch(make_world, 3)
    assert batch.positions["twin"][:, :, 1].mean(1) == pytest.approx([1, 2, 3])


# Errors.


def test_a_failed_world_is_told_of_with_all_reports_and_the_others_are_stepped() -> None:
    batch, twin = weft.Batch(raised, COUNT, threads=2), weft.Batch(raised, COUNT)
    for b in (batch, twin):
        b[1].contact = False
        cloth_of(b[1]).set_forces((0, 1e38, 0))
    before = hashes(batch)
    with pytest.raises(weft.SimulationError, match='^world 1: cloth "sheet": the motion of particle') as caught:
        batch.step(DT)
    reports = caught.value.report
    assert isinstance(reports, list)
    assert [report.ok for report in reports] == [True, False, True, True]
    after = hashes(batch)
    assert after[1] == before[1]
    expected = lone(raised, 1)
    assert [after[i] for i in (0, 2, 3)] == [expected[i] for i in (0, 2, 3)]
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        silent = twin.step(DT, check=False)
    assert [report.ok for report in silent] == [True, False, True, True] and hashes(twin) == after
    batch.reset([1])
    cloth_of(batch[1]).set_forces(None)
    assert all(report.ok for report in batch.step(DT))


@pytest.mark.parametrize("failing", [0, 2, 5])
def test_a_rollout_tells_of_a_failed_step(failing: int) -> None:
    batch = weft.Batch(raised, 3)
    _, goals = goals_of(batch, 6)
    goals[1, failing] = 1e38
    with pytest.raises(weft.SimulationError, match="^world 1: ") as caught:
        batch.rollout(goals, DT)
    reports = caught.value.report
    assert isinstance(reports, list) and [report.ok for report in reports] == [True, False, True]
    times = np.array([batch[i].time for i in range(3)])
    assert np.round(times / DT).astype(int).tolist() == [failing + 1, failing, failing + 1]  # it ends with that step


def test_warnings_come_once_per_kind() -> None:
    batch = weft.Batch(raised, 2)
    for i in range(2):
        cloth_of(batch[i]).velocities = (0, 1e10, 0)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        reports = batch.step(DT)
        batch.reset()
        for i in range(2):
            cloth_of(batch[i]).velocities = (0, 1e10, 0)
        again = batch.step(DT)
    kinds = {warning.code for report in reports for warning in report.warnings}
    assert len(kinds) > 0 and kinds == {warning.code for report in again for warning in report.warnings}
    assert [warning.category for warning in caught] == [weft.SimulationWarning] * len(kinds)
    assert all(str(warning.message).startswith('world 0: cloth "sheet": ') for warning in caught)
    assert {warning.filename for warning in caught} == {__file__}


def two(i: int) -> weft.World:
    world = hanging(6)
    world.add_cloth(weft.grid(cells=(2, 2)), name="other", position=(3, 0, 0))
    return world


ZEROS = np.zeros((3, 2, 3))
WRONG: dict[str, tuple[Callable[[weft.Batch], object], type[Exception], str]] = {
    "length of step": (lambda b: b.step(0), weft.InputError,
                       "the time step must be a finite number of seconds above 0"),
    "text as step": (lambda b: b.step("a"), weft.InputError, "dt: expected a number, found 'a'"),
    "no cloth": (lambda b: b.step(DT, targets={"x": ([0, 6], ZEROS)}), weft.InputError,
                 "cloth: no cloth is named 'x'; there are ['sheet', 'other']"),
    "no pin": (lambda b: b.step(DT, targets={"sheet": ([0, 1], ZEROS)}), weft.InputError,
               'cloth "sheet": particle 1 is not pinned'),
    "too many goals": (lambda b: b.step(DT, targets={"sheet": ([0], ZEROS)}), weft.InputError,
                       "goals: expected shape (3, 1, 3), found (3, 2, 3)"),
    "goals of several steps": (lambda b: b.step(DT, targets={"sheet": ([0, 6], ZEROS[:, None])}), weft.InputError,
                               "goals: expected shape (3, 2, 3), found (3, 1, 2, 3)"),
    "goals of no step": (lambda b: b.step(DT, targets={"sheet": ([0, 6], np.zeros((3, 0, 2, 3)))}), weft.InputError,
                         "goals: expected shape (3, 2, 3), found (3, 0, 2, 3)"),
    "goal that is no number": (lambda b: b.step(DT, targets={"sheet": ([0, 6], ZEROS * np.nan)}), weft.InputError,
                               "goals: expected finite numbers, found nan at goals[0, 0, 0]"),
    "targets that are no dict": (lambda b: b.step(DT, targets=[1]), weft.InputError,  # type: ignore[arg-type]
                                 "targets: expected a dict of pairs (particles, goals) by cloth, found [1]"),
    "targets that are no pair": (lambda b: b.step(DT, targets={"sheet": [1]}), weft.InputError,  # type: ignore
                                 "targets['sheet']: expected a pair (particles, goals), found 1 items"),
    "world to reset": (lambda b: b.reset([0, 3]), weft.InputError,
                       "worlds: index 3 is out of range for 3 worlds"),
    "mask to reset": (lambda b: b.reset([True, False]), weft.InputError,
                      "worlds: expected a mask of shape (3,), found (2,)"),
    "world": (lambda b: b[3], IndexError, "there is no world 3 in a batch of 3"),
    "negative world": (lambda b: b[-4], IndexError, "there is no world -4 in a batch of 3"),
    "array": (lambda b: b.positions["x"], weft.InputError,
              "cloth: no cloth is named 'x'; there are ['sheet', 'other']"),
    "rollout of one of two": (lambda b: b.rollout(ZEROS[:, None], DT), weft.InputError,
                              "cloth: name one of ['sheet', 'other']"),
    "rollout's goals": (lambda b: b.rollout(ZEROS, DT, cloth="sheet"), weft.InputError,
                        "goals: expected shape (3, T, 2, 3), found (3, 2, 3)"),
    "no worlds": (lambda b: weft.Batch(two, 0), weft.InputError, "num_worlds and threads: expected at least 1"),
    "no threads": (lambda b: weft.Batch(two, 1, threads=0), weft.InputError,
                   "num_worlds and threads: expected at least 1"),
    "half a world": (lambda b: weft.Batch(two, 2.5), weft.InputError,  # type: ignore[arg-type]
                     "num_worlds: expected a whole number, found 2.5"),
    "no world": (lambda b: weft.Batch(lambda i: None, 1), weft.InputError,  # type: ignore[arg-type, return-value]
                 "make_world: expected a function that returns a World, found None"),
    "unequal worlds": (lambda b: weft.Batch(lambda i: hanging(2 + i), 2), weft.InputError,
                       "world 1 has the cloths {'sheet': 16}, and world 0 {'sheet': 9}; a batch needs the same in all"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_errors(name: str) -> None:
    batch = weft.Batch(two, 3, threads=2)
    before = hashes(batch)
    call, kind, sentence = WRONG[name]
    with pytest.raises(kind) as caught:
        call(batch)
    assert type(caught.value) is kind and caught.value.args == (sentence,)
    assert hashes(batch) == before
    assert all(report.ok for report in batch.step(DT))


def test_errors_of_make_world_are_passed_on() -> None:
    def make_world(i: int) -> weft.World:
        raise OSError("no mesh")

    with pytest.raises(OSError, match="^no mesh$"):
        weft.Batch(make_world, 2)
