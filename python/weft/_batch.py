"""Many worlds, stepped in parallel."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arguments import choose, indices, numbers, real, whole
from ._errors import tell
from ._world import Cloth, World

Targets = Mapping[str, tuple[ArrayLike, ArrayLike]]


class _Fields(Mapping[str, NDArray[np.float32]]):
    """Arrays of a batch by the names of cloths: (worlds, n, 3) float32, filled by every step."""

    def __init__(self, batch: Batch, is_velocity: bool) -> None:
        self._batch, self._is_velocity = batch, is_velocity
        self._arrays: dict[str, NDArray[np.float32]] = {}

    def __getitem__(self, cloth: str) -> NDArray[np.float32]:
        if cloth not in self._arrays:
            count = self._batch._count(cloth)
            array = np.empty((len(self._batch), count, 3), np.float32)
            recording = self._batch._recording(cloth, self._is_velocity, array[:, None])
            recording.copy(self._batch._core)
            self._batch._recordings.append(recording)
            self._arrays[cloth] = array
        return self._arrays[cloth]

    def __iter__(self) -> Iterator[str]:
        return iter(self._batch._ids)

    def __len__(self) -> int:
        return len(self._batch._ids)


class Batch:
    """Worlds stepped in parallel, each on one thread, with the bits that it has when stepped by itself.

    make_world: called with 0, 1, …, returns a World, which the batch copies. Every world has the same cloths by name
    and number of particles. threads: of the batch.

    >>> from weft import grid
    >>> def make_world(i):
    ...     world = World()
    ...     sheet = world.add_cloth(grid(cells=(8, 8)), name="sheet", position=(0, 0.1 * i, 0))
    ...     sheet.pin(sheet.corners[:2])
    ...     return world
    >>> batch = Batch(make_world, 4, threads=2)
    >>> height = batch.positions["sheet"]                 # (4, 81, 3): one array, filled by every step
    >>> reports = batch.step(1 / 60)
    >>> height.shape, len(reports)
    ((4, 81, 3), 4)
    """

    def __init__(self, make_world: Callable[[int], World], num_worlds: int, *, threads: int = 1) -> None:
        count, num_threads = whole(num_worlds, "num_worlds"), whole(threads, "threads")
        if count < 1 or num_threads < 1:
            raise _core.InputError("num_worlds and threads: expected at least 1")
        self._core = _core.Batch(num_threads)
        self._ids: dict[str, list[_core.ClothId]] = {}
        self._counts: dict[str, int] = {}
        for index in range(count):
            world = make_world(index)
            choose(world, "make_world", World, "a function that returns a World")
            self._take(world, index)
        self._core.make_worlds()
        self._num_worlds = count
        self._recordings: list[_core.Recording] = []
        self._positions, self._velocities = _Fields(self, False), _Fields(self, True)
        self._told: set[str] = set()

    def _take(self, world: World, index: int) -> None:
        firsts: dict[str, Cloth] = {}
        for cloth in world.cloths:
            firsts.setdefault(cloth.name, cloth)
        counts = {name: cloth.num_particles for name, cloth in firsts.items()}
        if index > 0 and counts != self._counts:
            raise _core.InputError(
                f"world {index} has the cloths {counts}, and world 0 {self._counts}; a batch needs the same in all"
            )
        self._counts = counts
        for name, cloth in firsts.items():
            self._ids.setdefault(name, []).append(cloth._id)
        self._core.add(world._core)

    def __len__(self) -> int:
        return self._num_worlds

    def __getitem__(self, index: int) -> World:
        """One of the worlds, to read, or to change between two steps."""
        choose(index, "index", (int, np.integer), "a whole number")
        if not -self._num_worlds <= index < self._num_worlds:
            raise IndexError(f"there is no world {index} in a batch of {self._num_worlds}")
        return World._of(self._core.world(index % self._num_worlds))

    def __repr__(self) -> str:
        return f"<weft.Batch of {self._num_worlds} worlds: {', '.join(self._ids)}>"

    @property
    def positions(self) -> Mapping[str, NDArray[np.float32]]:
        """By cloth: positions in all worlds, (worlds, n, 3) float32 [m]. One array for ever, filled by every step."""
        return self._positions

    @property
    def velocities(self) -> Mapping[str, NDArray[np.float32]]:
        """By cloth: velocities in all worlds, (worlds, n, 3) float32 [m/s]. Filled by every step."""
        return self._velocities

    def step(self, dt: float, *, targets: Targets | None = None, check: bool = True) -> list[_core.StepReport]:
        """Advances all worlds by dt > 0 [s].

        targets: by cloth, pinned particles and where they are at the end of the step: (worlds, k, 3) [m].
        Raises SimulationError if a world's step failed, with all reports; the others are stepped. `check=False`
        leaves that to the reports.
        """
        moves = [] if targets is None else self._moves(targets)
        reports = self._core.step(real(dt, "dt"), 1, moves, self._recordings)
        self._tell(reports, check)
        return reports

    def reset(self, worlds: ArrayLike | None = None) -> None:
        """Returns worlds to their start, bit by bit: indices or a mask; without an argument all."""
        chosen = np.arange(self._num_worlds) if worlds is None else worlds
        self._core.reset(indices(chosen, self._num_worlds, "worlds", "worlds"))
        self._refresh()

    def rollout(
        self, goals: ArrayLike, dt: float, *, cloth: str | None = None, particles: ArrayLike | None = None
    ) -> NDArray[np.float32]:
        """Steps all worlds along goals of pinned particles, (worlds, T, k, 3) [m], in one call.

        cloth: whose; without it, the only one. particles: which; without them its pins in their order. Returns its
        positions after every step, (worlds, T, n, 3) float32 [m]: a new array. Ctrl-C ends it between two steps.
        """
        name = self._only_cloth() if cloth is None else cloth
        count = self._count(name)
        array = numbers(goals, "goals")
        given = self[0][name].pins if particles is None else particles  # type: ignore[union-attr]
        chosen = indices(given, count, "particles")
        if array.ndim != 4 or array.shape[0] != self._num_worlds or array.shape[2:] != (len(chosen), 3):
            raise _core.InputError(
                f"goals: expected shape ({self._num_worlds}, T, {len(chosen)}, 3), found {array.shape}"
            )
        out = np.empty((self._num_worlds, array.shape[1], count, 3), np.float32)
        moves = [_core.Targets(self._ids[name], chosen, np.ascontiguousarray(array))]
        try:
            if array.shape[1] > 0:
                reports = self._core.step(
                    real(dt, "dt"), array.shape[1], moves, [self._recording(name, False, out)]
                )
                self._tell(reports, True)
        finally:
            self._refresh()
        return out

    def _refresh(self) -> None:
        for recording in self._recordings:
            recording.copy(self._core)

    def _tell(self, reports: list[_core.StepReport], check: bool) -> None:
        for index, report in enumerate(reports):
            if report._is_clean:
                continue
            describe, who = self._core.world(index).describe, f"world {index}: "
            tell(report, describe, self._told, raises=reports if check else None, who=who, stacklevel=4)

    def _only_cloth(self) -> str:
        if len(self._ids) != 1:
            raise _core.InputError(f"cloth: name one of {list(self._ids)}")
        return next(iter(self._ids))

    def _count(self, cloth: str) -> int:
        if cloth not in self._counts:
            raise _core.InputError(f"cloth: no cloth is named {cloth!r}; there are {list(self._counts)}")
        return self._counts[cloth]

    def _recording(self, cloth: str, is_velocity: bool, array: NDArray[np.float32]) -> _core.Recording:
        return _core.Recording(self._ids[cloth], is_velocity, array)

    def _moves(self, targets: Targets) -> list[_core.Targets]:
        choose(targets, "targets", Mapping, "a dict of pairs (particles, goals) by cloth")
        moves = []
        for name, given in targets.items():
            choose(given, f"targets[{name!r}]", (tuple, list), "a pair (particles, goals)")
            if len(given) != 2:
                found = f"found {len(given)} items"
                raise _core.InputError(f"targets[{name!r}]: expected a pair (particles, goals), {found}")
            particles, goals = indices(given[0], self._count(name), "particles"), numbers(given[1], "goals")
            if goals.shape != (self._num_worlds, len(particles), 3):
                raise _core.InputError(
                    f"goals: expected shape ({self._num_worlds}, {len(particles)}, 3), found {goals.shape}"
                )
            moves.append(_core.Targets(self._ids[name], particles, np.ascontiguousarray(goals[:, None])))
        return moves
