"""Errors and warnings of the package."""

from __future__ import annotations

import warnings
from collections.abc import Callable

from . import _core


class SimulationError(RuntimeError):
    """A step failed: the world is as it was before it. `report` says why; after a batch's step it is a list."""

    def __init__(self, message: str, report: _core.StepReport | list[_core.StepReport]) -> None:
        super().__init__(message)
        self.report = report


class SimulationWarning(UserWarning):
    """A step was made, but its result is below the requested accuracy. The sentence names the key to change."""


class FileWarning(UserWarning):
    """A file was read or written, but could not say or hold everything. The sentence names the option to set."""


def tell_of_file(notes: list[str]) -> None:
    """Warns of a file's notes, as seen by the caller of the package's function that calls this."""
    for note in notes:
        warnings.warn(note, FileWarning, stacklevel=3)


def tell(
    report: _core.StepReport,
    describe: Callable[[_core.StepWarning], str],
    told: set[str],
    *,
    raises: _core.StepReport | list[_core.StepReport] | None,
    who: str = "",
    stacklevel: int,
) -> None:
    """Warns of a step's problems once per kind: of those that are not in `told`. `stacklevel` as seen from here.

    A failed step raises SimulationError with `raises` instead; None: it does not, and nothing is told.
    """
    if not report.ok:
        if raises is not None:
            raise SimulationError(who + "; ".join(map(describe, report.warnings)), raises)
        return
    for warning in report.warnings:
        if warning.code not in told:
            told.add(warning.code)
            warnings.warn(who + describe(warning), SimulationWarning, stacklevel=stacklevel)
