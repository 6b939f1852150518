"""Progress on stderr: a bar of tqdm where it is installed, else a line every ten seconds."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from typing import Any

Progress = Callable[[int, int, float, float], object]
"""Of the number done, the number of all, seconds spent and seconds left."""


def show_progress(name: str, unit: str) -> Progress:
    try:
        from tqdm.auto import tqdm  # type: ignore[import-untyped,unused-ignore]
    except ImportError:
        return print_progress(name, unit)
    bar: Any = None

    def update(done: int, count: int, spent: float, left: float) -> None:
        nonlocal bar
        if bar is None:
            bar = tqdm(total=count, desc=name, unit=unit)
        bar.update(done - bar.n)
        if done == count:
            bar.close()

    return update


def print_progress(name: str, unit: str) -> Progress:
    last = time.monotonic()

    def update(done: int, count: int, spent: float, left: float) -> None:
        nonlocal last
        if time.monotonic() - last >= 10 or done == count:
            last = time.monotonic()
            print(f"{name}: {unit} {done} of {count}, {left:.0f} s left", file=sys.stderr)

    return update
