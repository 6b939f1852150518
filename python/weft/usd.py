"""USD files: .usdc, .usda, .usd, and .usdz to read. Needs usd-core: `pip install weft[usd]`.

>>> import weft, weft.usd
>>> with tempfile.TemporaryDirectory() as folder:
...     weft.usd.write_mesh(folder + "/flag.usdc", weft.Mesh([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [(0, 1, 2)]))
...     weft.usd.read_mesh(folder + "/flag.usdc")
Mesh(3 vertices, 1 faces)
"""

from __future__ import annotations

import math
import os
import re
import shutil
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arguments import choose, vector, whole
from ._convert import Options, as_options, is_usd
from ._errors import tell_of_file
from ._mesh import Mesh, Polygons, as_mesh, mesh_with
from ._scene import open_run

try:
    from pxr import (  # type: ignore[import-not-found,import-untyped,unused-ignore]
        Gf,
        Sdf,
        Tf,
        Usd,
        UsdGeom,
        UsdUtils,
        Vt,
    )
except ImportError:
    raise ImportError("USD files need the Python package usd-core: pip install weft[usd]") from None

__all__ = ["read_mesh", "write_mesh"]

_Floats = NDArray[np.float64]
_Ints = NDArray[np.int32]

_USUAL_FPS = 60.0
_SMALLEST, _LARGEST = 0.01, 100.0  # of cloth and bodies, without a note [m]
_WAITING = 16 << 20  # time samples in memory, until the layer is saved [bytes]


def read_mesh(
    file: str | os.PathLike[str], *, node: str | None = None, frame: int = 0, up: str | None = None,
    scale: float | None = None,
) -> Mesh:  # fmt: skip
    """The meshes of a USD file as one, in world coordinates, in metres and with y up.

    node: path of the prim whose meshes are read; by default all of the stage. frame: from the stage's start, in
    frames of its own rate. up, scale: instead of the stage's `upAxis` and `metersPerUnit` [m].

    Polygons are cut into triangles. Instances are read; guides, proxies and invisible meshes are left out. A
    FileWarning names what is left out, and a missing unit. Raises InputError for an unusable file.
    """
    notes: list[str] = []
    options = as_options(None, up, scale, None, None, node)
    with _quiet(notes):
        source = _Source(Path(file), options, notes)
        index = whole(frame, "frame")
        Options(frames=(index, index)).range_of(source.name, source.num_frames)
        faces = source.faces(index)
        corners = _core.triangulate(faces.points[faces.vertices], faces.counts)
    _check_size(source.name, faces.points, notes)
    tell_of_file(notes)
    uv = np.empty(0) if faces.uv is None else faces.uv[corners]
    polygons = Polygons(faces.counts, faces.vertices, uv=faces.uv)
    return mesh_with(faces.points, faces.vertices[corners], uv, polygons)


def write_mesh(
    file: str | os.PathLike[str], mesh: Any, *, name: str = "mesh", color: ArrayLike | None = None
) -> None:
    """Writes a mesh [m] as USD, with normals and texture coordinates, in floats. Raises InputError if it cannot.

    Of a mesh with `polygons` these are written, without groups. name: of the prim. color: linear red, green, blue in
    [0, 1].
    """
    own = as_mesh(mesh)
    choose(name, "name", str, "a name")
    notes: list[str] = []
    with _Writer(Path(file), notes) as writer:
        tint = None if color is None else vector(color, "color")
        if own.polygons is None:
            counts, uv = np.full(len(own.faces), 3, np.int32), None if own.uv is None else own.uv.reshape(-1, 2)
            faces = _Faces(own.vertices, counts, own.faces.reshape(-1), uv)
        else:
            faces = _Faces(own.vertices, own.polygons.sizes, own.polygons.corners, own.polygons.uv)
            wrong = faces.vertices[(faces.vertices < 0) | (faces.vertices >= len(own.vertices))]
            if len(wrong):
                raise _core.InputError(f"polygons: vertex {wrong[0]} is out of range for {len(own.vertices)} vertices")
            _note_groups("the mesh", len(own.polygons.groups) + len(own.polygons.objects), notes)
        path = writer.add_mesh(name, _Shape(faces, own.faces), tint)
        writer.add_frame(path, None, own.vertices.astype(np.float32))
    tell_of_file(notes)


def convert_files(file: Path, out: Path, options: Options) -> tuple[list[Path], list[str]]:
    """weft.convert() for USD files: written files, and notes as sentences."""
    notes: list[str] = []
    if is_usd(file):
        if is_usd(out):
            raise _core.InputError(f"{out}: USD is converted to .obj, .ply, .pc2 or .mdd; usdcat makes USD of USD")
        if options.mesh is not None:
            raise _core.InputError("mesh: USD has its faces itself")
        _make_folder(out.parent)
        with _quiet(notes):
            _convert_from(_Source(file, options, notes), out, options, notes)
    else:
        if options.node is not None:
            raise _core.InputError(f"node: {file} is not USD and has no prims")
        _convert_to(file, out, options, notes)
    return [out], notes


def _make_folder(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise _core.InputError(f"cannot create folder {folder}: {error.strerror}") from None


# From USD.


def _convert_from(source: _Source, out: Path, options: Options, notes: list[str]) -> None:
    frames = options.range_of(source.name, source.num_frames)
    if out.suffix.lower() not in (".pc2", ".mdd"):
        faces = source.faces(frames[0])
        _check_size(source.name, faces.points, notes)
        if source.num_frames > 1 and options.frames == (0, None):
            notes.append(f"{source.name} is animated; {out} has its first frame (--frames)")
        _core.write_mesh_polygons(str(out), faces.points, faces.counts, faces.vertices, faces.uv, [], np.empty((0, 2), np.int32))
        return
    start = source.positions(frames[0])
    _check_size(source.name, start, notes)
    writer = _core.PointCacheWriter(str(out), len(start), [source.time(k) for k in frames])
    for k in frames:
        positions = start if k == frames[0] else source.positions(k)
        if len(positions) != len(start):
            count = f"{len(positions)} points at frame {k}, {len(start)} at frame {frames[0]}"
            raise _core.InputError(f"{source.name} has {count}; a point cache has the same at all frames")
        writer.add_frame(positions.astype(np.float32))
    writer.finish()


@dataclass
class _Faces:
    """Polygons: numbers of their corners, and vertices and texture coordinates (NaN: none) of these."""

    points: _Floats  # (n, 3)
    counts: _Ints
    vertices: _Ints
    uv: _Floats | None


class _Source:
    """The meshes of a stage as one, in metres and with y up. Frames count from its start."""

    def __init__(self, file: Path, options: Options, notes: list[str]) -> None:
        self.name = str(file)
        self._stage = _open(file)
        self._notes = notes
        self._told: set[str] = set()
        self._meshes = [UsdGeom.Mesh(prim) for prim in self._find(options.node)]
        self._up_is_z, self._scale = self._read_unit(options)
        self._samples = sorted({t for mesh in self._meshes for t in _motion_samples(mesh)})
        self._start, self._step, self._rate, self.num_frames = self._read_frames(options.fps)

    def time(self, k: int) -> float:
        """[s]"""
        return (self._start + k * self._step) / self._rate

    def positions(self, k: int) -> _Floats:
        """(num_vertices, 3) [m]"""
        transforms = UsdGeom.XformCache(self._code(k))
        return np.concatenate([self._world(mesh, self._points(mesh, k), transforms) for mesh in self._meshes])

    def faces(self, k: int) -> _Faces:
        """At a frame [m]."""
        transforms = UsdGeom.XformCache(self._code(k))
        parts = [self._part(mesh, k, transforms) for mesh in self._meshes]
        firsts = np.cumsum([0, *(len(part.points) for part in parts)])
        uv = None
        if any(part.uv is not None for part in parts):
            uv = np.concatenate([np.full((len(p.vertices), 2), np.nan) if p.uv is None else p.uv for p in parts])
        return _Faces(
            np.concatenate([part.points for part in parts]),
            np.concatenate([part.counts for part in parts]),
            np.concatenate([part.vertices + n for part, n in zip(parts, firsts[:-1], strict=True)]).astype(np.int32),
            uv,
        )

    def _fail(self, prim: Any, mistake: str) -> _core.InputError:
        return _core.InputError(f"{self.name}: {prim.GetPath()} {mistake}")

    def _note(self, prim: Any, text: str) -> None:
        note = f"{self.name}: {prim.GetPath()} {text}"
        if note not in self._told:
            self._told.add(note)
            self._notes.append(note)

    # Choice of meshes.

    def _find(self, node: str | None) -> list[Any]:
        root = self._stage.GetPseudoRoot()
        if node is not None:
            root = self._stage.GetPrimAtPath(node) if Sdf.Path.IsValidPathString(node) else None
            if not root:
                raise _core.InputError(f"{self.name} has no prim {node} (--node); {self._describe()}")
        if root.IsA(UsdGeom.Mesh):  # named itself: whatever its purpose and visibility
            return [root]
        left_out: Counter[str] = Counter()
        found = []
        prims = iter(Usd.PrimRange(root, Usd.TraverseInstanceProxies()))
        for prim in prims:
            if prim.IsA(UsdGeom.PointInstancer):
                left_out["point instancers"] += 1
                prims.PruneChildren()
            elif prim.IsA(UsdGeom.Gprim):
                reason = self._reason_against(prim)
                if reason:
                    left_out[reason] += 1
                else:
                    found.append(prim)
        if left_out:
            words = ", ".join(f"{reason} ({count})" for reason, count in sorted(left_out.items()))
            self._notes.append(f"{self.name}: left out are {words}")
        if not found:
            place = "" if node is None else f" below {node}"
            raise _core.InputError(f"{self.name} has no mesh{place} to read")
        return found

    @staticmethod
    def _reason_against(prim: Any) -> str:
        if not prim.IsA(UsdGeom.Mesh):
            return "shapes that are not meshes"
        geometry = UsdGeom.Imageable(prim)
        if geometry.ComputePurpose() in (UsdGeom.Tokens.proxy, UsdGeom.Tokens.guide):
            return "proxies and guides"
        if geometry.ComputeVisibility(Usd.TimeCode.EarliestTime()) == UsdGeom.Tokens.invisible:
            return "invisible meshes"
        return ""

    def _describe(self) -> str:
        paths = [str(prim.GetPath()) for prim in self._stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
        more = f" and {len(paths) - 5} more" if len(paths) > 5 else ""
        return f"its meshes are {', '.join(paths[:5])}{more}" if paths else "it has no meshes"

    # Units, axes, time.

    def _read_unit(self, options: Options) -> tuple[bool, float]:
        scale = options.scale
        if scale is None:
            scale = UsdGeom.GetStageMetersPerUnit(self._stage)
            if not UsdGeom.StageHasAuthoredMetersPerUnit(self._stage):
                self._notes.append(f"{self.name} does not say its unit: {scale:g} m, USD's default (--scale)")
        if not (scale > 0 and math.isfinite(scale)):
            raise _core.InputError(f"{self.name}: metersPerUnit is {scale:g}; expected a number above 0 (--scale)")
        axis = options.up
        if axis is None:
            axis = str(UsdGeom.GetStageUpAxis(self._stage)).lower()
            if not self._stage.HasAuthoredMetadata(UsdGeom.Tokens.upAxis):
                self._notes.append(f"{self.name} does not say its vertical axis: {axis}, USD's default (--up)")
        if axis not in ("y", "z"):
            raise _core.InputError(f"{self.name}: upAxis is {axis!r}; expected Y or Z (--up)")
        return axis == "z", scale

    def _read_frames(self, fps: float | None) -> tuple[float, float, float, int]:
        """Start and step [time codes], time codes per second, number of frames."""
        stage = self._stage
        rate, own = stage.GetTimeCodesPerSecond(), stage.GetFramesPerSecond()
        for name, value in (("timeCodesPerSecond", rate), ("framesPerSecond", own)):
            if not (value > 0 and math.isfinite(value)):
                raise _core.InputError(f"{self.name}: {name} is {value:g}; expected a number above 0")
        if not self._samples:
            return 0.0, 1.0, rate, 1
        says = [stage.HasAuthoredMetadata(name) for name in ("timeCodesPerSecond", "framesPerSecond")]
        if not any(says):
            if fps is None:
                self._notes.append(f"{self.name} does not say its frames per second: {rate:g}, USD's default (--fps)")
            rate = fps or rate
        fps = fps or (own if says[1] else rate)
        start, end = self._samples[0], self._samples[-1]
        if stage.HasAuthoredTimeCodeRange():
            start, end = stage.GetStartTimeCode(), stage.GetEndTimeCode()
        if not start <= end:
            raise _core.InputError(f"{self.name}: endTimeCode {end:g} is before startTimeCode {start:g}")
        step = rate / fps
        return start, step, rate, int(math.floor((end - start) / step + 1e-6)) + 1

    def _code(self, k: int) -> Any:
        return Usd.TimeCode(self._start + k * self._step) if self._samples else Usd.TimeCode.EarliestTime()

    # Geometry.

    def _points(self, mesh: Any, k: int) -> _Floats:
        """In the prim's own coordinates and unit."""
        value = mesh.GetPointsAttr().Get(self._code(k))
        if value is None or len(value) == 0:
            raise self._fail(mesh, f"has no points at frame {k}")
        points = np.asarray(value, np.float64)
        if not np.isfinite(points).all():
            raise self._fail(mesh, f"has a point at frame {k} that is not finite")
        return points

    def _world(self, mesh: Any, points: _Floats, transforms: Any) -> _Floats:
        matrix = np.asarray(transforms.GetLocalToWorldTransform(mesh.GetPrim()))
        if not np.array_equal(matrix, np.eye(4)):
            x, y, z = points[:, :1], points[:, 1:2], points[:, 2:]
            points = x * matrix[0, :3] + y * matrix[1, :3] + z * matrix[2, :3] + matrix[3, :3]
        return _to_world(points, self._up_is_z, self._scale)

    def _part(self, mesh: Any, k: int, transforms: Any) -> _Faces:
        """One mesh, its polygons counter-clockwise seen from the front."""
        points, code = self._points(mesh, k), self._code(k)
        topology = (mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr(), mesh.GetHoleIndicesAttr())
        counts, indices, holes = (np.asarray(attribute.Get(code) or [], np.int32) for attribute in topology)
        self._check_faces(mesh, counts, indices, holes, len(points))
        if mesh.GetSubdivisionSchemeAttr().Get() != UsdGeom.Tokens.none:
            self._note(mesh, "is a subdivision surface; its control mesh is read")
        if mesh.GetPrim().HasAttribute("primvars:skel:jointIndices"):
            self._note(mesh, "is moved by a skeleton; its points are read without it")
        if len(holes):
            self._note(mesh, f"has {len(holes)} holes; these faces are left out")
        keeps = np.ones(len(counts), bool)
        keeps[holes] = False
        of_face = np.repeat(np.arange(len(counts)), counts)
        corners = np.arange(len(indices))
        is_left = mesh.GetOrientationAttr().Get() == UsdGeom.Tokens.leftHanded
        if is_left != (transforms.GetLocalToWorldTransform(mesh.GetPrim()).GetDeterminant3() < 0):
            starts = (np.cumsum(counts) - counts)[of_face]  # each polygon backwards, from its first corner
            corners = starts + (starts - corners) % counts[of_face]
        corners = corners[keeps[of_face]]
        uv = self._uv(mesh, code, indices, of_face)
        return _Faces(
            self._world(mesh, points, transforms), counts[keeps], indices[corners], None if uv is None else uv[corners]
        )

    def _check_faces(self, mesh: Any, counts: _Ints, indices: _Ints, holes: _Ints, num_points: int) -> None:
        wrong = holes[(holes < 0) | (holes >= len(counts))]
        if len(wrong):
            raise self._fail(mesh, f"has a hole at face {wrong[0]} of {len(counts)}")
        if len(set(holes.tolist())) == len(counts):
            raise self._fail(mesh, "has no faces")
        if counts.min() < 3:
            raise self._fail(mesh, f"has a face of {counts.min()} corners; expected 3 or more")
        if counts.sum() != len(indices):
            found = f"found {len(indices)}"
            raise self._fail(mesh, f"has faceVertexCounts for {counts.sum()} faceVertexIndices, {found}")
        wrong = indices[(indices < 0) | (indices >= num_points)]
        if len(wrong):
            raise self._fail(mesh, f"has a face with point {wrong[0]} of {num_points}")

    def _uv(self, mesh: Any, code: Any, indices: _Ints, of_face: NDArray[np.int64]) -> _Floats | None:
        """Texture coordinates of all corners: of the primvar "st", else of the first one with their type."""
        primvars = [p for p in UsdGeom.PrimvarsAPI(mesh).FindPrimvarsWithInheritance() if _may_be_uv(p)]
        if not primvars:
            return None
        chosen = min(primvars, key=lambda primvar: primvar.GetPrimvarName() != "st")
        try:
            flat = np.asarray(chosen.ComputeFlattened(code), np.float64)
        except (Tf.ErrorException, TypeError):
            flat = np.empty(0)
        kind, tokens = chosen.GetInterpolation(), UsdGeom.Tokens
        if kind == tokens.constant and len(flat) == 1:
            flat = np.broadcast_to(flat, (len(indices), 2))
        elif kind == tokens.uniform and len(flat) == of_face[-1] + 1:
            flat = flat[of_face]
        elif kind in (tokens.vertex, tokens.varying) and len(flat) > indices.max():
            flat = flat[indices]
        if flat.shape != (len(indices), 2) or not np.isfinite(flat).all():
            self._note(mesh, f"has unusable texture coordinates {chosen.GetPrimvarName()}; they are left out")
            return None
        return flat


def _may_be_uv(primvar: Any) -> bool:
    types = Sdf.ValueTypeNames
    if primvar.GetTypeName() == types.Float2Array:
        return primvar.GetPrimvarName() in ("st", "uv")
    return primvar.GetTypeName() in (types.TexCoord2fArray, types.TexCoord2dArray, types.TexCoord2hArray)


def _motion_samples(mesh: Any) -> list[float]:
    """Times of the samples of points and transforms; none: the mesh is at rest [time codes]."""
    samples: list[float] = []
    if mesh.GetPointsAttr().ValueMightBeTimeVarying():
        samples += mesh.GetPointsAttr().GetTimeSamples()
    prim = mesh.GetPrim()
    while prim and not prim.IsPseudoRoot():
        place = UsdGeom.Xformable(prim)
        if place and place.TransformMightBeTimeVarying():
            samples += place.GetTimeSamples()
        prim = prim.GetParent()
    return samples


def _open(file: Path) -> Any:
    if not file.is_file():
        reason = "this is a folder" if file.is_dir() else "there is no such file"
        raise _core.InputError(f"{file}: {reason}; expected a USD file")
    try:
        return Usd.Stage.Open(str(file))
    except Tf.ErrorException as error:
        raise _core.InputError(f"{file}: cannot be read as USD: {_reason(error)}") from None


def _reason(error: Exception) -> str:
    """USD's first reason, without the place in its source."""
    found = re.search(r" : '(.*?)'\s*(?:\n|$)", str(error), re.DOTALL)
    return " ".join((found[1] if found else str(error)).split())


@contextmanager
def _quiet(notes: list[str]) -> Iterator[None]:
    """USD's own warnings as notes."""
    delegate = UsdUtils.CoalescingDiagnosticDelegate()
    try:
        yield
    finally:
        texts = [one.commentary for item in delegate.TakeCoalescedDiagnostics() for one in item.unsharedItems]
        notes += [re.sub(r" \((instantiating|recomposing) stage.*", "", text) for text in dict.fromkeys(texts)]


def _to_world(points: _Floats, up_is_z: bool, scale: float) -> _Floats:
    """Points of a file with this unit, in metres and with y up."""
    if up_is_z:
        points = np.stack([points[:, 0], points[:, 2], -points[:, 1]], axis=1)
    return points if scale == 1 else scale * points


def _check_size(name: str, points: NDArray[Any], notes: list[str]) -> None:
    size = float(np.ptp(points, axis=0).max())
    if not _SMALLEST <= size <= _LARGEST:
        notes.append(f"{name} is {size:.3g} m large; --scale gives the length of its unit in metres")


# To USD.


def _sync(path: str) -> None:
    """Passes a file or the names of a folder to the disk."""
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _convert_to(file: Path, out: Path, options: Options, notes: list[str]) -> None:
    if file.is_dir():
        if options.mesh is not None:
            raise _core.InputError("mesh: a run has its meshes itself")
        _convert_run(file, out, options, notes)
    elif file.suffix.lower() in (".pc2", ".mdd"):
        if options.mesh is None:
            raise _core.InputError(f"{out}: a point cache has no faces; --mesh names the mesh of its points")
        cache = _Cache(file, options, None, notes)
        with _Writer(out, notes, cache.rate) as writer:
            _write_cache(writer, file.stem, cache, options.mesh, None, notes)
    else:
        if options.mesh is not None:
            raise _core.InputError(f"mesh: {file} is a mesh itself")
        shape = _read_shape(file, notes)
        points = _to_world(shape.faces.points, options.up == "z", options.scale or 1.0)
        _check_size(str(file), points, notes)
        with _Writer(out, notes) as writer:
            writer.add_frame(writer.add_mesh(file.stem, shape, None), None, points.astype(np.float32))


@dataclass
class _Shape:
    """A mesh to be written: its polygons, and the triangles that are cut of them."""

    faces: _Faces
    triangles: _Ints


def _read_shape(file: Path, notes: list[str]) -> _Shape:
    points, triangles, _, (counts, vertices, uv, groups, _lines), warnings = _core.read_mesh(str(file))
    notes += warnings
    _note_groups(str(file), len(groups), notes)
    return _Shape(_Faces(points, counts, vertices, uv if len(uv) else None), triangles)


def _note_groups(name: str, count: int, notes: list[str]) -> None:
    if count:
        notes.append(f"{name} has {count} group{'s' if count > 1 else ''}, which are lost: only .obj holds them")


def _convert_run(folder: Path, out: Path, options: Options, notes: list[str]) -> None:
    run = open_run(folder)
    with _Writer(out, notes, options.fps or run.frames_per_second, run.name) as writer:
        for cloth in run._contents["cloths"]:
            if not cloth["positions"]:
                raise _core.InputError(f"{folder} has no point caches: it was run with --no-pc2")
            if not cloth.get("mesh"):
                raise _core.InputError(
                    f"{folder} has no meshes of its point caches: it is of an earlier version of Weft"
                )
            cache = _Cache(folder / cloth["positions"], options, run.frames_per_second, notes)
            _write_cache(writer, cloth["name"], cache, folder / cloth["mesh"], cloth.get("color"), notes)


class _Cache:
    """The chosen frames of a point cache, in metres and with y up."""

    def __init__(self, file: Path, options: Options, fps_of_run: float | None, notes: list[str]) -> None:
        self.name = str(file)
        self._cache = _core.PointCacheFile(self.name)
        self._up_is_z, self._scale = options.up == "z", options.scale or 1.0
        self._frames = options.range_of(file, self._cache.num_frames)
        times = [] if options.fps else self._cache.times
        self.rate, self._codes = _even_codes(times)
        if not times:
            self.rate = options.fps or fps_of_run or _USUAL_FPS
            self._codes = [float(k) for k in range(self._cache.num_frames)]
            if not options.fps and not fps_of_run:
                notes.append(f"{file} does not say its frames per second: {_USUAL_FPS:g} (--fps)")

    @property
    def num_points(self) -> int:
        return self._cache.num_points

    def __iter__(self) -> Iterator[tuple[float, NDArray[np.float32]]]:
        """Time code and positions of every frame."""
        for k in self._frames:
            points = self._cache.frame(k).astype(np.float64)
            yield self._codes[k], _to_world(points, self._up_is_z, self._scale).astype(np.float32)


def _even_codes(times: Sequence[float]) -> tuple[float, list[float]]:
    """Time codes per second, and the time codes of these times [s]: whole numbers where the times are even."""
    if len(times) > 1 and times[-1] > times[0]:
        mean = (len(times) - 1) / (times[-1] - times[0])
        for rate in (round(mean, 3), round(mean * 1.001) / 1.001):  # 23.976 is short for 24/1.001
            codes = [round(time * rate) for time in times]
            error = max(abs(code / rate - time) for time, code in zip(times, codes, strict=True)) if rate > 0 else 1
            if error <= max(map(abs, times)) * np.finfo(np.float32).eps:
                return rate, [float(code) for code in codes]
    return _USUAL_FPS, [time * _USUAL_FPS for time in times]


def _write_cache(
    writer: _Writer, name: str, cache: _Cache, mesh: Path, color: Sequence[float] | None, notes: list[str]
) -> None:
    shape = _read_shape(mesh, notes)
    count = len(shape.faces.points)
    if count != cache.num_points:
        mistake = f"has {cache.num_points} points, but {mesh} has {count} vertices; expected the mesh of its points"
        raise _core.InputError(f"{cache.name} {mistake}")
    path = writer.add_mesh(name, shape, color)
    is_first = True
    for code, positions in cache:
        if is_first:
            _check_size(cache.name, positions, notes)
        is_first = False
        writer.add_frame(path, code, positions)


class _Writer:
    """A stage of meshes, written frame by frame.

    The layer is saved whenever 16 MiB wait: USD appends them to its file and keeps their places only, so that memory
    does not grow with the number of frames. At the end the file replaces `file`, or is written again as text.
    """

    def __init__(self, file: Path, notes: list[str], rate: float | None = None, title: str | None = None) -> None:
        if file.suffix.lower() not in (".usd", ".usda", ".usdc"):
            raise _core.InputError(f"{file}: USD is written as .usdc, .usda or .usd")
        self._file, self._notes, self._rate = file, notes, rate
        self._root = Sdf.Path("/" + Tf.MakeValidIdentifier(title or file.stem))
        self._names: set[str] = set()
        self._codes: list[float] = []
        self._triangles: dict[Any, _Ints] = {}
        self._waiting = 0

    def __enter__(self) -> _Writer:
        _make_folder(self._file.parent)
        with self._told():
            target = Path(os.path.realpath(self._file))
            self._folder = tempfile.TemporaryDirectory(prefix=".weft-", dir=target.parent, ignore_cleanup_errors=True)
            self._layer = Sdf.Layer.CreateNew(os.path.join(self._folder.name, "stage.usdc"))
            stage = Usd.Stage.Open(self._layer)
            UsdGeom.SetStageMetersPerUnit(stage, 1)
            UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
            stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, self._root).GetPrim())
            stage.SetMetadata("customLayerData", {"creator": f"Weft {_core.version}"})
            if self._rate is not None:
                stage.SetTimeCodesPerSecond(self._rate)
                stage.SetFramesPerSecond(self._rate)
        return self

    def add_mesh(self, name: str, shape: _Shape, color: Sequence[float] | None) -> Any:
        """The path of a new mesh, without positions."""
        stage = Usd.Stage.Open(self._layer)
        mesh = UsdGeom.Mesh.Define(stage, self._root.AppendChild(self._prim_name(name)))
        mesh.GetPrim().SetDisplayName(name)
        mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
        mesh.CreateDoubleSidedAttr(True)
        mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(shape.faces.counts))
        mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(np.ascontiguousarray(shape.faces.vertices)))
        mesh.CreatePointsAttr()
        mesh.CreateNormalsAttr()
        mesh.SetNormalsInterpolation(UsdGeom.Tokens.vertex)
        mesh.CreateExtentAttr()
        if shape.faces.uv is not None:
            self._add_uv(mesh, shape.faces.uv)
        if color is not None:
            mesh.CreateDisplayColorAttr([Gf.Vec3f(*color)])
        self._triangles[mesh.GetPath()] = shape.triangles
        return mesh.GetPath()

    def add_frame(self, path: Any, code: float | None, positions: NDArray[np.float32]) -> None:
        """A mesh at a time code, or at all times."""
        if not np.isfinite(positions).all():
            raise _core.InputError(f"{self._file}: a position of {path} is not finite")
        normals = _core.vertex_normals(self._triangles[path], positions)
        extent = np.stack([positions.min(axis=0), positions.max(axis=0)])
        with self._told():
            for name, array in (("points", positions), ("normals", normals), ("extent", extent)):
                attribute, value = path.AppendProperty(name), Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(array))
                if code is None:
                    self._layer.GetAttributeAtPath(attribute).default = value
                else:
                    self._layer.SetTimeSample(attribute, code, value)
                self._waiting += array.nbytes
            if code is not None:
                self._codes.append(code)
            if self._waiting > _WAITING:
                self._layer.Save()
                self._waiting = 0

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: object) -> None:
        with self._folder:
            layer, self._layer = self._layer, None
            if kind is None:
                with self._told():
                    if self._codes:
                        layer.startTimeCode, layer.endTimeCode = min(self._codes), max(self._codes)
                    layer.Save()
                    self._replace(layer)

    def _replace(self, layer: Any) -> None:
        made, target = layer.realPath, os.path.realpath(self._file)
        if self._file.suffix.lower() == ".usda":
            binary, made = made, os.path.join(self._folder.name, "text.usda")
            layer.Export(made)
            os.unlink(binary)
        if os.path.exists(target):
            shutil.copymode(target, made)
        _sync(made)
        os.replace(made, target)
        _sync(os.path.dirname(target))

    @contextmanager
    def _told(self) -> Iterator[None]:
        """USD's and the system's errors as InputError."""
        try:
            with _quiet(self._notes):
                yield
        except Tf.ErrorException as error:
            raise _core.InputError(f"{self._file} cannot be written: {_reason(error)}") from None
        except OSError as error:
            raise _core.InputError(f"{self._file} cannot be written: {error.strerror}") from None

    def _prim_name(self, name: str) -> str:
        valid: str = Tf.MakeValidIdentifier(name)
        unique, count = valid, 1
        while unique in self._names:
            count += 1
            unique = f"{valid}_{count}"
        self._names.add(unique)
        return unique

    def _add_uv(self, mesh: Any, uv: _Floats) -> None:
        """Equal texture coordinates once, with an index for every corner."""
        flat = uv.astype(np.float32)
        missing = ~np.isfinite(flat).all(axis=1)
        if missing.any():
            self._notes.append(f"{self._file}: {missing.sum()} corners without texture coordinates have (0, 0)")
            flat[missing] = 0
        values, indices = np.unique(flat, axis=0, return_inverse=True)
        kind = Sdf.ValueTypeNames.TexCoord2fArray
        primvar = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("st", kind, UsdGeom.Tokens.faceVarying)
        primvar.Set(Vt.Vec2fArray.FromNumpy(np.ascontiguousarray(values)))
        primvar.SetIndices(Vt.IntArray.FromNumpy(np.ascontiguousarray(indices, np.int32).reshape(-1)))
