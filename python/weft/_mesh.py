"""Shapes of cloth and of mesh colliders."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arguments import faces as as_faces
from ._arguments import numbers, pairs_of, real, vectors, whole_numbers
from ._errors import tell_of_file


class Polygons:
    """The faces of a mesh file as they are there: quads and polygons, texture coordinates by corner, named groups.

    sizes: (num_polygons,) corners of each, 3 or more. corners: vertices of the first polygon, then of the second, ….
    uv: texture coordinates (num_corners, 2), NaN where the file has none. groups, objects: the polygons of each name,
    ascending indices; of an OBJ file those behind its lines g and o. A polygon is in one object at most. lines: pairs of
    vertices (k, 2) that a line l of an OBJ file joins, such as the sewing of Blender.

    >>> quad = Polygons([4], [0, 1, 2, 3], groups={"hem": [0]})
    >>> quad
    Polygons(1 polygons, groups hem)
    >>> quad.vertices_of("hem")
    array([0, 1, 2, 3], dtype=int32)
    """

    def __init__(
        self,
        sizes: ArrayLike,
        corners: ArrayLike,
        *,
        uv: ArrayLike | None = None,
        groups: Mapping[str, ArrayLike] | None = None,
        objects: Mapping[str, ArrayLike] | None = None,
        lines: ArrayLike = (),
    ) -> None:
        self.sizes = whole_numbers(sizes, "sizes")
        self.corners = whole_numbers(corners, "corners")
        if (self.sizes < 3).any():
            raise _core.InputError(f"sizes: expected 3 or more corners of each, found {self.sizes.min()}")
        if int(self.sizes.sum(dtype=np.int64)) != len(self.corners):
            raise _core.InputError(
                f"corners: expected {self.sizes.sum(dtype=np.int64)}, the sum of sizes, found {len(self.corners)}"
            )
        self.uv = None if uv is None else self._as_uv(uv)
        self.groups = self._as_groups(groups, "groups")
        self.objects = self._as_groups(objects, "objects")
        self.lines = pairs_of(lines, "lines")

    def _as_uv(self, uv: ArrayLike) -> NDArray[np.float64]:
        try:
            array = np.ascontiguousarray(uv, np.float64)
        except (TypeError, ValueError):
            raise _core.InputError(f"uv: expected an array of numbers, found {uv!r:.60}") from None
        if array.shape != (len(self.corners), 2):
            raise _core.InputError(f"uv: expected shape ({len(self.corners)}, 2), found {array.shape}")
        return array

    def _as_groups(self, groups: Mapping[str, ArrayLike] | None, name: str) -> dict[str, NDArray[np.int32]]:
        if groups is None:
            return {}
        if not isinstance(groups, Mapping) or not all(isinstance(key, str) for key in groups):
            raise _core.InputError(f"{name}: expected polygons by name, found {groups!r:.60}")
        arrays = {key: whole_numbers(of, f"{name}[{key!r}]") for key, of in groups.items()}
        for key, array in arrays.items():
            wrong = (array < 0) | (array >= len(self.sizes))
            if wrong.any():
                raise _core.InputError(
                    f"{name}[{key!r}]: polygon {array[wrong][0]} is out of range for {len(self.sizes)} polygons"
                )
        return arrays

    def vertices_of(self, name: str) -> NDArray[np.int32]:
        """The vertices of the polygons of a group or object, ascending. Raises InputError for an unknown name."""
        chosen = [names[name] for names in (self.groups, self.objects) if name in names]
        if not chosen:
            known = ", ".join(f'"{known}"' for known in [*self.objects, *self.groups])
            raise _core.InputError(f'there is no group "{name}"; there are {known or "none"}')
        polygons = np.zeros(len(self.sizes), bool)
        polygons[np.concatenate(chosen)] = True
        return np.unique(self.corners[np.repeat(polygons, self.sizes)])

    def __repr__(self) -> str:
        names = ", ".join(dict.fromkeys([*self.objects, *self.groups]))
        return f"Polygons({len(self.sizes)} polygons{', groups ' + names if names else ''})"


class Mesh:
    """A triangle mesh. For cloth, its vertices are the rest shape.

    vertices: (num_vertices, 3) [m]. faces: (num_triangles, 3), counter-clockwise seen from the front.
    uv: texture coordinates by vertex (num_vertices, 2) or by corner (num_triangles, 3, 2); warp runs along u.
    polygons: of a mesh that was read, the faces of the file, which writing keeps; set it to None to write triangles.
    deformation: the motion of its vertices, of a mesh from `read_gltf`; None: rigid.

    >>> square = Mesh([(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)], [(0, 2, 1), (0, 3, 2)])
    >>> square
    Mesh(4 vertices, 2 faces)
    """

    def __init__(self, vertices: ArrayLike, faces: ArrayLike, uv: ArrayLike | None = None) -> None:
        self.vertices: NDArray[np.float64] = vectors(vertices, "vertices")
        self.faces: NDArray[np.int32] = as_faces(faces, len(self.vertices), "faces")
        self.uv: NDArray[np.float64] | None = None
        self.polygons: Polygons | None = None
        self.deformation: _core.VertexMotion | None = None
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

    `polygons` of the mesh has the file's faces and groups. Raises InputError ("FILE:LINE: …") for an unusable one. A
    FileWarning names what was ignored.
    """
    vertices, faces, uv, polygons, notes = _core.read_obj(os.fspath(file))
    tell_of_file(notes)
    return mesh_with(vertices, faces, uv, polygons_from(*polygons))


def read_mesh(file: str | os.PathLike[str]) -> Mesh:
    """Reads a PLY, STL, glTF or OBJ file by the ending of its name, as read_obj(). `weft.usd.read_mesh` reads USD.

    Raises InputError for an unusable one. A FileWarning names what was ignored.
    """
    vertices, faces, uv, polygons, notes = _core.read_mesh(os.fspath(file))
    tell_of_file(notes)
    return mesh_with(vertices, faces, uv, polygons_from(*polygons))


def read_gltf(file: str | os.PathLike[str], *, node: str = "", clip: str = "", scale: float = 1.0) -> Mesh:
    """Reads the meshes of a glTF file (.glb, .gltf) as a body that moves: skins, morph targets, nodes.

    node: only its meshes and those below it. clip: the animation, by default the first one. scale: length of the file's
    unit [m]. The vertices are those at the start of the clip, and `deformation` of the mesh is its motion: as a
    collider it moves (`World.add_collider`). Raises InputError for an unusable file, node or clip. A FileWarning names
    what was ignored.
    """
    for name, text in (("node", node), ("clip", clip)):
        if not isinstance(text, str):
            raise _core.InputError(f"{name}: expected a name, found {text!r:.60}")
    vertices, faces, uv, deformation, _, notes = _core.read_gltf(os.fspath(file), node, clip, real(scale, "scale"))
    tell_of_file(notes)
    mesh = Mesh(vertices, faces)
    mesh.uv = uv if len(uv) else None
    mesh.deformation = deformation
    return mesh


def rest_from_uv(mesh: Any, *, scale: float | None = None) -> NDArray[np.float64]:
    """The triangles of a garment's pattern, for `rest` of `World.add_cloth`: (num_faces, 3, 3) corners [m].

    They are the mesh's texture coordinates times `scale` [m]; None: the scale at which they have the area of the mesh.
    Raises InputError for a mesh without texture coordinates, or with some without area.

    >>> square = Mesh([(0, 0, 0), (1, 0, 0), (1, 0, 1)], [(0, 2, 1)], uv=[(0, 0), (5, 0), (5, 5)])
    >>> rest_from_uv(square).round(9).tolist()
    [[[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0]]]
    """
    own = as_mesh(mesh)
    return _core.rest_from_uv(own.vertices, own.faces, own.uv, None if scale is None else real(scale, "scale"))


def find_crossings(cloths: Iterable[Any], *, colliders: Iterable[Any] = ()) -> NDArray[np.int32]:
    """Pairs of triangles that cross, by the exact, independent checker of runs: (k, 4) surface, triangle, other surface,
    other triangle. Surfaces are counted through cloths, then colliders; the first one of a pair is a cloth.

    Each is a pair (vertices, faces), a Mesh, or any object with `vertices` and `faces`. Touching is not crossing, and
    colliders may cross themselves and each other. Raises InputError for invalid ones.

    >>> flat = Mesh([(0, 0, 0), (1, 0, 0), (0, 0, 1)], [(0, 2, 1)])
    >>> upright = Mesh([(0.2, -1, 0.2), (0.2, 1, 0.2), (0.2, -1, 9)], [(0, 1, 2)])
    >>> find_crossings([flat, upright]).tolist()
    [[0, 0, 1, 0]]
    """
    surfaces = []
    for shapes, is_cloth in ((cloths, True), (colliders, False)):
        for shape in shapes:
            mesh = Mesh(*shape) if isinstance(shape, tuple) else as_mesh(shape)
            surfaces.append((mesh.vertices, mesh.faces, is_cloth))
    return np.array(_core.find_crossings(surfaces), np.int32).reshape(-1, 4)


def mesh_with(
    vertices: NDArray[np.float64], faces: NDArray[np.int32], uv: NDArray[np.float64], polygons: Polygons
) -> Mesh:
    """A mesh from a file. Its texture coordinates are NaN at corners without any; none at all: empty."""
    mesh = Mesh(vertices, faces)
    mesh.uv = uv if len(uv) else None
    mesh.polygons = polygons
    return mesh


def polygons_from(
    sizes: NDArray[np.int32],
    corners: NDArray[np.int32],
    uv: NDArray[np.float64],
    groups: list[tuple[str, bool, NDArray[np.int32]]],
    lines: NDArray[np.int32],
) -> Polygons:
    """Polygons from what the module reads."""
    return Polygons(
        sizes, corners, uv=uv if len(uv) else None,
        groups={name: of for name, is_object, of in groups if not is_object},
        objects={name: of for name, is_object, of in groups if is_object}, lines=lines,
    )  # fmt: skip


def write_obj(file: str | os.PathLike[str], mesh: Any) -> None:
    """Writes an OBJ file, with enough digits to read the same numbers back. Raises InputError if it cannot.

    Of a mesh with `polygons` these are written, with their texture coordinates and groups, instead of the triangles.
    """
    own = as_mesh(mesh)
    if own.polygons is None:
        _core.write_obj(os.fspath(file), own.vertices, own.faces, own.uv)
    else:
        _core.write_obj_polygons(os.fspath(file), own.vertices, *_arrays(own.polygons))


def write_mesh(file: str | os.PathLike[str], mesh: Any) -> None:
    """Writes a .obj or .ply file, as write_obj(); PLY without groups. `weft.usd.write_mesh` writes USD.

    Raises InputError for another ending, and if it cannot be written.
    """
    own = as_mesh(mesh)
    if own.polygons is None:
        _core.write_mesh(os.fspath(file), own.vertices, own.faces, own.uv)
    else:
        _core.write_mesh_polygons(os.fspath(file), own.vertices, *_arrays(own.polygons))


def _arrays(
    polygons: Polygons,
) -> tuple[
    NDArray[np.int32], NDArray[np.int32], NDArray[np.float64] | None, list[tuple[str, bool, NDArray[np.int32]]], NDArray[np.int32]
]:
    """Polygons as the module takes them."""
    groups = [(name, True, of) for name, of in polygons.objects.items()]
    groups += [(name, False, of) for name, of in polygons.groups.items()]
    return polygons.sizes, polygons.corners, polygons.uv, groups, polygons.lines
