"""Shapes of cloth and of mesh colliders."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arguments import faces as as_faces
from ._arguments import numbers, vectors


class Mesh:
    """A triangle mesh. For cloth, its vertices are the rest shape.

    vertices: (num_vertices, 3) [m]. faces: (num_triangles, 3), counter-clockwise seen from the front.
    uv: texture coordinates by vertex (num_vertices, 2) or by corner (num_triangles, 3, 2); warp runs along u.

    >>> square = Mesh([(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)], [(0, 2, 1), (0, 3, 2)])
    >>> square
    Mesh(4 vertices, 2 faces)
    """

    def __init__(self, vertices: ArrayLike, faces: ArrayLike, uv: ArrayLike | None = None) -> None:
        self.vertices: NDArray[np.float64] = vectors(vertices, "vertices")
        self.faces: NDArray[np.int32] = as_faces(faces, len(self.vertices), "faces")
        self.uv: NDArray[np.float64] | None = None
        if uv is not None:
            array = numbers(uv, "uv")
            if array.shape == (len(self.vertices), 2):
                array = array[self.faces]
            if array.shape != (len(self.faces), 3, 2):
                raise _core.InputError(
                    f"uv: expected shape ({len(self.vertices)}, 2) by vertex or ({len(self.faces)}, 3, 2) by corner, "
                    f"found {array.shape}"
                )
            self.uv = np.ascontiguousarray(array)

    def __repr__(self) -> str:
        return f"Mesh({len(self.vertices)} vertices, {len(self.faces)} faces{', uv' if self.uv is not None else ''})"


def as_mesh(shape: Any) -> Mesh:
    """A Mesh from anything with `vertices` and `faces`, as trimesh's and pyvista's meshes have them.

    Texture coordinates come from `uv`, or from `visual.uv` (trimesh). Raises InputError for other things.
    """
    if isinstance(shape, Mesh):
        return shape
    if not hasattr(shape, "vertices") or not hasattr(shape, "faces"):
        raise _core.InputError(
            f"shape: expected a grid, a solid or a mesh with vertices and faces, found {shape!r:.60}"
        )
    uv = getattr(shape, "uv", None)
    if uv is None:
        uv = getattr(getattr(shape, "visual", None), "uv", None)
    return Mesh(shape.vertices, shape.faces, uv)


def grid(size: tuple[float, float] = (1.0, 1.0), cells: tuple[int, int] = (32, 32)) -> _core.Grid:
    """Rectangular cloth of `size` [m] along x and z, as a grid of so many cells.

    The grid is horizontal, with its first corner at the origin; particles are counted along x, row by row along z.

    >>> grid(size=(1, 2), cells=(10, 20)).num_particles
    231
    """
    lengths, counts = numbers(size, "size"), numbers(cells, "cells")
    if lengths.shape != (2,):
        raise _core.InputError(f"size: expected 2 lengths, found shape {lengths.shape}")
    if counts.shape != (2,) or (counts % 1).any():
        raise _core.InputError(f"cells: expected 2 integers, found {cells!r:.60}")
    if not (1 <= counts.min() and counts.max() <= 4096):
        raise _core.InputError(f"cells: expected from 1 to 4096, found {cells!r:.60}")
    return _core.Grid(
        size_x=float(lengths[0]), size_z=float(lengths[1]), cells_x=int(counts[0]), cells_z=int(counts[1])
    )


def read_obj(file: str | os.PathLike[str]) -> Mesh:
    """Reads a Wavefront OBJ file: vertices in the file's order, quads and polygons cut into triangles.

    Raises InputError ("FILE:LINE: …") for an unusable one.
    """
    vertices, faces, uv = _core.read_obj(os.fspath(file))
    return Mesh(vertices, faces, uv if len(uv) else None)


def write_obj(file: str | os.PathLike[str], mesh: Any) -> None:
    """Writes an OBJ file, with enough digits to read the same numbers back. Raises InputError if it cannot."""
    own = as_mesh(mesh)
    _core.write_obj(os.fspath(file), own.vertices, own.faces, own.uv)
