"""Arguments as arrays: conversion, and messages that name the argument, what it is and what it has to be."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

_IDENTITY: Floats = np.eye(3)


def numbers(value: ArrayLike, name: str) -> Floats:
    """A float64 array of finite numbers."""
    try:
        array = np.asarray(value)
        if array.dtype.kind not in "fiu" and array.size:
            raise TypeError
        array = array.astype(np.float64, copy=False)
    except (TypeError, ValueError):
        raise _core.InputError(f"{name}: expected an array of numbers, found {_words(value)}") from None
    if not np.isfinite(array).all():
        place = np.argwhere(~np.isfinite(array))[0]
        at = "[" + ", ".join(map(str, place)) + "]" if place.size else ""
        raise _core.InputError(f"{name}: expected finite numbers, found {array[tuple(place)]} at {name}{at}")
    return array


def vectors(value: ArrayLike, name: str, count: int | None = None) -> Floats:
    """A (count, 3) array of numbers; one vector stands for all, if the count is known."""
    array = numbers(value, name)
    if count is not None and array.shape == (3,):
        array = np.broadcast_to(array, (count, 3))
    if array.ndim != 2 or array.shape[1] != 3 or (count is not None and array.shape[0] != count):
        rows = "n" if count is None else count
        raise _core.InputError(f"{name}: expected shape ({rows}, 3), found {array.shape}")
    return np.ascontiguousarray(array)


def vector(value: ArrayLike, name: str) -> tuple[float, float, float]:
    """Three numbers."""
    array = numbers(value, name)
    if array.shape != (3,):
        raise _core.InputError(f"{name}: expected 3 numbers, found shape {array.shape}")
    return (float(array[0]), float(array[1]), float(array[2]))


def indices(value: ArrayLike, count: int, name: str, things: str = "particles") -> Ints:
    """Indices below `count` by NumPy's rules: integers, negative ones from the end, or a mask of all things."""
    try:
        array = np.asarray(value)
    except ValueError:
        raise _core.InputError(f"{name}: expected indices or a mask, found {_words(value)}") from None
    if array.dtype == np.bool_ and array.ndim > 0:
        if array.shape != (count,):
            raise _core.InputError(f"{name}: expected a mask of shape ({count},), found {array.shape}")
        return np.flatnonzero(array).astype(np.int32)
    if array.size == 0:
        return np.empty(0, np.int32)
    if array.dtype.kind not in "iu":
        raise _core.InputError(f"{name}: expected integers or a mask, found {_words(value)}")
    if array.ndim > 1:
        raise _core.InputError(f"{name}: expected a list of indices, found shape {array.shape}")
    array = np.atleast_1d(array)
    outside = (array >= count) if array.dtype.kind == "u" else (array >= count) | (array < -count)
    if outside.any():
        raise _core.InputError(f"{name}: index {array[outside][0]} is out of range for {count} {things}")
    signed = array.astype(np.int64)
    return np.where(signed < 0, signed + count, signed).astype(np.int32)


def faces(value: ArrayLike, num_vertices: int, name: str) -> Ints:
    """A (num_triangles, 3) array of vertex indices."""
    try:
        array = np.asarray(value)
    except ValueError:
        raise _core.InputError(f"{name}: expected an array of integers, found {_words(value)}") from None
    if array.dtype.kind not in "iu":
        raise _core.InputError(f"{name}: expected integers, found {_words(value)}")
    if array.ndim != 2 or array.shape[1] != 3:
        quads = "; cut quads into triangles first" if array.ndim == 2 and array.shape[1] == 4 else ""
        raise _core.InputError(f"{name}: expected shape (num_triangles, 3), found {array.shape}{quads}")
    wrong = (array < 0) | (array >= num_vertices)
    if wrong.any():
        raise _core.InputError(f"{name}: vertex {array[wrong][0]} is out of range for {num_vertices} vertices")
    return np.ascontiguousarray(array, np.int32)


def whole_numbers(value: ArrayLike, name: str) -> Ints:
    """A list of whole numbers of 32 bits."""
    try:
        array = np.asarray(value)
    except ValueError:
        raise _core.InputError(f"{name}: expected integers, found {_words(value)}") from None
    if array.size == 0:
        return np.empty(0, np.int32)
    if array.dtype.kind not in "iu" or array.ndim != 1 or array.max() >= 2**31 or array.min() < -(2**31):
        raise _core.InputError(f"{name}: expected a list of integers of 32 bits, found {_words(value)}")
    return np.ascontiguousarray(array, np.int32)


def pairs_of(value: ArrayLike, name: str) -> Ints:
    """Pairs of whole numbers (n, 2)."""
    try:
        array = np.asarray(value)
    except ValueError:
        raise _core.InputError(f"{name}: expected pairs of integers, found {_words(value)}") from None
    if array.size and array.shape[1:] != (2,):
        raise _core.InputError(f"{name}: expected shape (n, 2), found {array.shape}")
    return whole_numbers(array.ravel(), name).reshape(-1, 2)


def real(value: object, name: str) -> float:
    """A finite number."""
    try:
        number = float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise _core.InputError(f"{name}: expected a number, found {value!r:.60}") from None
    if isinstance(value, (str, bytes)) or not math.isfinite(number):
        raise _core.InputError(f"{name}: expected a finite number, found {value!r:.60}")
    return number


def whole(value: object, name: str) -> int:
    """A whole number that fits 32 bits."""
    choose(value, name, (int, np.integer), "a whole number")
    number: int = int(value)  # type: ignore[call-overload]
    if abs(number) >= 2**31:
        raise _core.InputError(f"{name}: expected a whole number of at most 32 bits, found {number}")
    return number


def rotation(value: Any, name: str = "rotation") -> Floats:
    """A rotation matrix: from a (3, 3) matrix, a quaternion (w, x, y, z), angles in degrees about fixed x, then y,
    then z, or an object with `as_matrix()`, as SciPy's."""
    if value is None:
        return _IDENTITY
    if hasattr(value, "as_matrix"):
        value = value.as_matrix()
    array = numbers(value, name)
    if array.shape == (3, 3):
        return np.ascontiguousarray(array)
    if array.shape == (4,):
        return _core.rotation_from_quaternion(*array.tolist())
    if array.shape == (3,):
        return _core.rotation_from_angles((float(array[0]), float(array[1]), float(array[2])))
    raise _core.InputError(
        f"{name}: expected a (3, 3) matrix, a quaternion (w, x, y, z) or 3 angles in degrees, found shape {array.shape}"
    )


def choose(value: object, name: str, kinds: type | tuple[type, ...], expected: str) -> None:
    """Raises InputError unless the value is of one of the kinds."""
    if not isinstance(value, kinds) or (isinstance(value, bool) and kinds is not bool):
        raise _core.InputError(f"{name}: expected {expected}, found {_words(value)}")


def output(out: Any, count: int, name: str = "out") -> NDArray[Any]:
    """Somebody's own array to write (count, 3) numbers to."""
    if not isinstance(out, np.ndarray) or out.dtype not in (np.float32, np.float64):
        raise _core.InputError(f"{name}: expected an array of float32 or float64, found {_words(out)}")
    if out.shape != (count, 3) or not out.flags.c_contiguous or not out.flags.writeable:
        state = "" if out.flags.c_contiguous and out.flags.writeable else ", which is not contiguous or read-only"
        raise _core.InputError(
            f"{name}: expected a writable, contiguous array of shape ({count}, 3), found {out.shape}{state}"
        )
    return out


def _words(value: object) -> str:
    if isinstance(value, np.ndarray):
        return f"an array of {value.dtype}"
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
