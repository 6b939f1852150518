"""Cases of farms, and what happens to their workers. Tokens are files: who removes one acts on it, in any process."""

from __future__ import annotations

import os
import random
import resource
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import weft
from weft import _farm_folder
from worlds import hanging

SECONDS, DT = 0.2, 1 / 60  # of a case: 12 steps


class Tokens:
    """A number of files in a folder."""

    def __init__(self, folder: Path, count: int = 0) -> None:
        self._folder = folder
        folder.mkdir(parents=True, exist_ok=True)
        for n in range(count):
            (folder / str(n)).touch()

    def __len__(self) -> int:
        return len(os.listdir(self._folder))

    def take(self) -> bool:
        """Whether this call removed one; never true twice for one token."""
        for name in os.listdir(self._folder):
            try:
                os.unlink(self._folder / name)
            except FileNotFoundError:
                continue
            return True
        return False


class Log:
    """Lines that several processes append."""

    def __init__(self, file: Path) -> None:
        self._file = file

    def add(self, line: object) -> None:
        handle = os.open(self._file, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        os.write(handle, f"{line}\n".encode())
        os.close(handle)

    def lines(self) -> list[str]:
        return self._file.read_text().split() if self._file.is_file() else []


def die() -> None:
    os.kill(os.getpid(), signal.SIGKILL)


def make_world(case: dict[str, Any]) -> weft.World:
    world = hanging(case.get("cells", 4), height=case["height"])
    world.cloths[0].velocities = (0.1 * case.get("push", 0), 0, 0.3)
    return world


def control(world: weft.World, step: int) -> None:
    world.cloths[0].set_forces((0, 0, 1e-4 * step))


def measure(world: weft.World) -> dict[str, Any]:
    return {"low": world.cloths[0].positions[:, 1].min(), "center": world.cloths[0].center_of_mass}


def lone_hash(case: dict[str, Any], seconds: float = SECONDS) -> str:
    """The state of a case that runs by itself, in this process."""
    world = make_world(case)
    for step in range(round(seconds / DT)):
        control(world, step)
        world.step(DT)
    return world.state_hash()


def deadly_control(tokens: Path) -> Callable[[weft.World, int], None]:
    """Kills its process at random steps, and at random before and after the file of rows appears."""

    def act(world: weft.World, step: int) -> None:
        control(world, step)
        if random.random() < 0.08 and Tokens(tokens).take():
            die()
        if _farm_folder.os is os:
            _farm_folder.os = _DeadlyModule(tokens)  # type: ignore[assignment]

    return act


class _DeadlyModule:
    """The module os of the functions that write rows."""

    def __init__(self, tokens: Path) -> None:
        self._tokens = tokens

    def __getattr__(self, name: str) -> Any:
        return getattr(os, name)

    def replace(self, part: Path, file: Path) -> None:
        when = random.random()
        if when < 0.1 and Tokens(self._tokens).take():
            die()
        os.replace(part, file)
        if when > 0.9 and Tokens(self._tokens).take():
            die()


def full_folder(tokens: Path) -> Callable[[dict[str, Any]], weft.World]:
    """A make_world whose process can write no file from the first token on."""

    def make(case: dict[str, Any]) -> weft.World:
        if Tokens(tokens).take():
            _, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
            resource.setrlimit(resource.RLIMIT_FSIZE, (0, hard))
        return make_world(case)

    return make


def main() -> None:
    """A farm in a process of its own: OUT LOG [die|wait]."""
    out, log, what = Path(sys.argv[1]), Log(Path(sys.argv[2])), sys.argv[3]

    def tell(done: int, count: int, spent: float, left: float) -> None:
        log.add(done)
        if what == "die" and 10 <= done < count:
            die()

    cases = weft.farm.grid(height=[1.0, 1.1, 1.2, 1.3], push=range(10))
    table = weft.farm.run(
        make_world, cases, seconds=SECONDS, dt=DT, control=control, measure=measure, out=out, workers=1, progress=tell
    )
    assert table.num_rows == len(cases)


if __name__ == "__main__":
    main()
