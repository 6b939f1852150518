# SPDX-License-Identifier: GPL-3.0-or-later
"""From a scene to a job of weft.bake."""

from pathlib import Path
from typing import Any

import bpy
import numpy as np
import weft
from numpy.typing import NDArray
from weft.bake import ClothInput, ColliderInput, Job

from . import cache, units
from .properties import NUMBERS
from .refused import Refused

_SOLID = {"AUTO": None, "SOLID": True, "OPEN": False}
_NO_SHAPE = {"ARMATURE", "CAMERA", "EMPTY", "LATTICE", "LIGHT", "LIGHT_PROBE", "SPEAKER"}  # never collide


def folder_of(scene: bpy.types.Scene) -> Path:
    """The folder of a scene's caches. Raises Refused."""
    folder = scene.weft.folder or "//"
    if folder.startswith("//") and not bpy.data.filepath:
        raise Refused("The cache folder is beside the .blend, which has no name yet; save it first")
    stem = bpy.path.clean_name(Path(bpy.data.filepath).stem or "untitled")
    return Path(bpy.path.abspath(folder)) / f"{stem}_{bpy.path.clean_name(scene.name)}"


def _objects(scene: bpy.types.Scene, layer: bpy.types.ViewLayer) -> tuple[list[Any], list[Any]]:
    """Cloths and colliders. Raises Refused for what cannot be either."""
    layer.update()  # objects that a script has just linked
    cloths = [thing for thing in layer.objects if thing.weft.role == "CLOTH"]
    colliders = [thing for thing in layer.objects if thing.weft.role == "COLLIDER"]
    if scene.weft.colliders:
        for thing in scene.weft.colliders.all_objects:
            if thing.instance_type != "NONE":
                raise Refused(f'"{thing.name}" makes instances; make them real, or take it out of the colliders')
            if thing.type not in _NO_SHAPE and thing not in cloths and thing not in colliders:
                colliders.append(thing)
    if not cloths:
        raise Refused("No object has the role Cloth; choose it under Physics, Weft")
    for thing in cloths + colliders:
        if thing.library or thing.override_library or (thing.data and thing.data.library):
            raise Refused(f'"{thing.name}" is linked from a library; make it local')
        if thing.instance_type != "NONE":
            raise Refused(f'"{thing.name}" makes instances; make them real')
        if thing.type != "MESH":
            raise Refused(f'"{thing.name}" is no mesh; convert it to a mesh')
        if thing.name not in layer.objects:
            raise Refused(f'"{thing.name}" is not in the view layer "{layer.name}"; add it, or take it out of the colliders')
        if thing.hide_viewport or not thing.visible_get(view_layer=layer):
            raise Refused(f'"{thing.name}" is hidden, and Blender does not evaluate it; show it')
    return cloths, colliders


class Gather:
    """Takes what a bake needs from a scene, frame by frame. Keeps names only: undo replaces objects."""

    def __init__(self, scene: bpy.types.Scene, layer: bpy.types.ViewLayer) -> None:
        self._scene, self._layer = scene.name, layer.name
        self.first_frame, last = units.frame_range(scene)
        if last <= self.first_frame:
            raise Refused(f"The last frame, {last}, is not after the first one, {self.first_frame}; change the frame range")
        self.num_frames = last - self.first_frame + 1
        self.folder = folder_of(scene)
        cloths, colliders = _objects(scene, layer)
        self._cloths, self._colliders = [thing.name for thing in cloths], [thing.name for thing in colliders]
        for thing in cloths + colliders:
            if thing.mode == "EDIT":
                thing.update_from_editmode()
        self.positions = [cache.check_modifiers(cloth, layer) for cloth in cloths]
        with cache.Hidden(scene, cloths, self.positions):
            self._set_frame(self.first_frame)
            scale = units.metres(scene)
            self.job = Job(
                fps=units.frame_rate(scene), num_frames=self.num_frames, first_frame=self.first_frame,
                steps_per_frame=units.steps_per_frame(scene), quality=scene.weft.quality, threads=scene.weft.threads,
                gravity=units.gravity(scene), untangle=scene.weft.untangle,
                cloths=[self._cloth_input(thing, scale, n) for n, thing in enumerate(cloths)],
                colliders=[self._collider_input(thing, scale) for thing in colliders],
            )  # fmt: skip

    # What stays the same.

    def _cloth_input(self, cloth: bpy.types.Object, scale: float, number: int) -> ClothInput:
        mesh, settings = cloth.data, cloth.weft
        if not len(mesh.polygons):
            raise Refused(f'"{cloth.name}" has no faces')
        matrix = self._matrix(cloth) * scale
        if abs(np.linalg.det(matrix[:3, :3])) < 1e-30:
            raise Refused(f'"{cloth.name}" is scaled to nothing; change its scale')
        start = self._vertices(cloth, scale, len(mesh.vertices))
        faces, loops = _triangles(mesh)
        uv = None
        if mesh.uv_layers.active:
            flat = np.empty(2 * len(mesh.loops), np.float32)
            mesh.uv_layers.active.data.foreach_get("uv", flat)
            uv = flat.reshape(-1, 2)[loops].astype(float)
        rest = start
        if settings.rest == "MESH":
            keys = mesh.shape_keys
            own = np.empty(3 * len(mesh.vertices), np.float32)
            (keys.reference_key.data if keys else mesh.vertices).foreach_get("co", own)
            rest = own.reshape(-1, 3).astype(float) @ matrix[:3, :3].T + scale * self._matrix(cloth)[:3, 3]
        size = np.ptp(rest, axis=0)
        pins, weights = _pins(cloth)
        file = self.folder / f"{number}_{bpy.path.clean_name(cloth.name)}.pc2"
        return ClothInput(
            cloth.name, str(file), _fabric(settings, scale), rest, start, faces, uv,
            None if uv is not None else ((0.0, 0.0, 1.0) if size[2] > 0.5 * size[:2].max() else (1.0, 0.0, 0.0)), pins, weights,
            _sewing(mesh) if settings.sew else np.empty((0, 2), np.int32), settings.sew_time, settings.layer,
        )  # fmt: skip

    def _collider_input(self, body: bpy.types.Object, scale: float) -> ColliderInput:
        evaluated = body.evaluated_get(self._depsgraph)
        mesh = evaluated.to_mesh()
        faces, _ = _triangles(mesh)
        evaluated.to_mesh_clear()
        if not len(faces):
            raise Refused(f'"{body.name}" has no faces')
        if np.linalg.det(self._matrix(body)[:3, :3]) < 0:  # mirrored
            faces = np.ascontiguousarray(faces[:, ::-1])
        return ColliderInput(body.name, self._vertices(body, scale), faces, body.weft.friction, _SOLID[body.weft.solid])

    # What moves.

    def frames(self, numbers: range) -> Any:
        """Matrices of cloths, their pinned vertices and the colliders' vertices at each frame, counted from 0 [m]."""
        scene = bpy.data.scenes[self._scene]
        try:
            cloths = [bpy.data.objects[name] for name in self._cloths]
            colliders = [bpy.data.objects[name] for name in self._colliders]
        except KeyError as error:
            raise Refused(f"{str(error).split('key ')[-1].split(' not')[0]} is no longer there; bake again") from None
        scale = units.metres(scene)
        with cache.Hidden(scene, cloths, self.positions):
            for number in numbers:
                self._set_frame(self.first_frame + number)
                matrices = [self._matrix(cloth) * scale for cloth in cloths]
                for matrix in matrices:
                    matrix[3, 3] = 1
                pins = []
                for cloth, given in zip(cloths, self.job.cloths, strict=True):
                    points = self._vertices(cloth, scale, len(given.rest))[given.pins] if len(given.pins) else np.empty((0, 3))
                    pins.append(points)
                bodies = [
                    self._vertices(body, scale, len(given.start))
                    for body, given in zip(colliders, self.job.colliders, strict=True)
                ]
                yield matrices, pins, bodies

    def _set_frame(self, frame: int) -> None:
        bpy.data.scenes[self._scene].frame_set(frame)
        self._frame, self._depsgraph = frame, bpy.data.scenes[self._scene].view_layers[self._layer].depsgraph

    def _matrix(self, thing: bpy.types.Object) -> NDArray[np.float64]:
        return np.array(thing.evaluated_get(self._depsgraph).matrix_world, float)

    def _vertices(self, thing: bpy.types.Object, scale: float, count: int | None = None) -> NDArray[np.float64]:
        """Evaluated, in the world [m]. Raises Refused for another number than `count`."""
        evaluated = thing.evaluated_get(self._depsgraph)
        mesh = evaluated.to_mesh()
        own = np.empty(3 * len(mesh.vertices), np.float32)
        mesh.vertices.foreach_get("co", own)
        evaluated.to_mesh_clear()
        if count is not None and len(own) != 3 * count:
            raise Refused(
                f'"{thing.name}": the number of its vertices changes from {count} to {len(own) // 3} at frame {self._frame}; '
                "remove the modifier that makes them"
            )
        matrix = self._matrix(thing)
        return scale * (own.reshape(-1, 3).astype(float) @ matrix[:3, :3].T + matrix[:3, 3])


def _triangles(mesh: bpy.types.Mesh) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    """Vertices and loops of the triangles: (t, 3) each."""
    mesh.calc_loop_triangles()
    arrays = []
    for name in ("vertices", "loops"):
        flat = np.empty(3 * len(mesh.loop_triangles), np.int32)
        mesh.loop_triangles.foreach_get(name, flat)
        arrays.append(flat.reshape(-1, 3))
    return arrays[0], arrays[1]


def _sewing(mesh: bpy.types.Mesh) -> NDArray[np.int32]:
    """Edges without faces between vertices of faces: (k, 2)."""
    edges = np.empty(2 * len(mesh.edges), np.int32)
    mesh.edges.foreach_get("vertices", edges)
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    of_faces = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("edge_index", of_faces)
    is_loose = np.ones(len(mesh.edges), bool)
    is_loose[of_faces] = False
    has_face = np.zeros(len(mesh.vertices), bool)
    has_face[corners] = True
    edges = edges.reshape(-1, 2)
    return edges[is_loose & has_face[edges].all(axis=1)]


def _pins(cloth: bpy.types.Object) -> tuple[NDArray[np.int32], NDArray[np.float64]]:
    """Vertices of the pin group, and their weights."""
    name = cloth.weft.pin_group
    if not name:
        return np.empty(0, np.int32), np.empty(0)
    group = cloth.vertex_groups.get(name)
    if group is None:
        known = ", ".join(f'"{group.name}"' for group in cloth.vertex_groups) or "none"
        raise Refused(f'"{cloth.name}" has no vertex group "{name}" for its pins; there are {known}')
    pairs = [
        (vertex.index, entry.weight)
        for vertex in cloth.data.vertices
        for entry in vertex.groups
        if entry.group == group.index and entry.weight > 0
    ]
    return np.array([pair[0] for pair in pairs], np.int32), np.array([pair[1] for pair in pairs], float)


def _fabric(settings: Any, scale: float) -> dict[str, Any]:
    """The fabric by its name, with the numbers that were changed. A measured curve goes with the number that it replaces."""
    fabric: dict[str, Any] = weft.find_fabric(settings.fabric)._asdict()
    numbers = {name: getattr(settings, name) * unit for name, unit in NUMBERS.items()}
    for name, value in {**numbers, "thickness": settings.thickness * scale}.items():
        if not np.isclose(value, fabric[name], rtol=1e-5, atol=0):
            fabric[name] = value
            if name in ("c11", "c22"):
                fabric["stretch_warp" if name == "c11" else "stretch_weft"] = []
    return fabric
