"""Scenes in Blender, and what Blender shows of them."""

from __future__ import annotations

import importlib
import math
import time
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import weft

ADDON = "bl_ext.user_default.weft"
job = importlib.import_module(f"{ADDON}.job")
Refused = importlib.import_module(f"{ADDON}.refused").Refused


def add_grid(name: str, cells: int = 10, *, size: float = 1.0, location: tuple[float, float, float] = (0, 0, 1)) -> Any:
    """A horizontal grid."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=cells, y_subdivisions=cells, size=size, location=location)
    thing = bpy.context.object
    thing.name = name
    return thing


def add_cloth(name: str = "Sheet", cells: int = 10, **where: Any) -> Any:
    cloth = add_grid(name, cells, **where)
    cloth.weft.role = "CLOTH"
    return cloth


def pin(cloth: Any, weight: float, chosen: Any) -> None:
    """A pin group of the vertices for which chosen(co) is true."""
    group = cloth.vertex_groups.new(name="pins")
    group.add([v.index for v in cloth.data.vertices if chosen(v.co)], weight, "REPLACE")
    cloth.weft.pin_group = "pins"


def add_ball(name: str = "Ball", radius: float = 0.3, location: tuple[float, float, float] = (0, 0, 0.6)) -> Any:
    bpy.ops.mesh.primitive_uv_sphere_add(segments=24, ring_count=12, radius=radius, location=location)
    ball = bpy.context.object
    ball.name = name
    ball.weft.role = "COLLIDER"
    return ball


def add_bending_body(role: str = "COLLIDER") -> Any:
    """A bar along x with a skeleton of two bones, whose second one bends up by 60 degrees until frame 12."""
    bar = add_grid("Bar", 12, size=1.0, location=(0, 0, 0))
    bar.weft.role = role
    bpy.ops.object.armature_add(enter_editmode=True, location=(0, 0, 0))
    skeleton = bpy.context.object
    root = skeleton.data.edit_bones[0]
    root.name, root.head, root.tail = "root", (-0.5, 0, 0), (0, 0, 0)
    tip = skeleton.data.edit_bones.new("tip")
    tip.head, tip.tail, tip.parent = (0, 0, 0), (0.5, 0, 0), root
    bpy.ops.object.mode_set(mode="OBJECT")
    for name, share in (("root", lambda x: 0.5 - 2 * x), ("tip", lambda x: 0.5 + 2 * x)):
        group = bar.vertex_groups.new(name=name)
        for v in bar.data.vertices:
            group.add([v.index], min(max(share(v.co.x), 0.0), 1.0), "REPLACE")
    bar.modifiers.new("Armature", "ARMATURE").object = skeleton
    bone = skeleton.pose.bones["tip"]
    bone.rotation_mode = "XYZ"
    for frame, angle in ((1, 0), (12, 60)):
        bone.rotation_euler = (0, 0, math.radians(angle))
        for axis in (0, 2):
            bone.rotation_euler[axis] = math.radians(angle)
        bone.keyframe_insert("rotation_euler", frame=frame)
    return bar


def shown(thing: Any, frame: int, *, without_weft: bool = False) -> np.ndarray:
    """Positions of the mesh that Blender evaluates, in the world [m]."""
    scene = bpy.context.scene
    own = [modifier for modifier in thing.modifiers if modifier.type == "MESH_CACHE"]
    for modifier in own:
        modifier.show_viewport = not without_weft
    scene.frame_set(frame)
    evaluated = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
    mesh = evaluated.to_mesh()
    points = np.empty(3 * len(mesh.vertices), np.float32)
    mesh.vertices.foreach_get("co", points)
    evaluated.to_mesh_clear()
    for modifier in own:
        modifier.show_viewport = True
    matrix = np.array(evaluated.matrix_world, float)
    return (points.reshape(-1, 3) @ matrix[:3, :3].T + matrix[:3, 3]) * scene.unit_settings.scale_length


def faces(thing: Any) -> np.ndarray:
    thing.data.calc_loop_triangles()
    return np.array([list(t.vertices) for t in thing.data.loop_triangles], np.int32)


def uv(thing: Any) -> np.ndarray:
    layer = thing.data.uv_layers.active.data
    return np.array([[list(layer[n].uv) for n in t.loops] for t in thing.data.loop_triangles], float)


def begin(**how: Any) -> Any:
    return job.Job(bpy.context.scene, bpy.context.view_layer, **how)


def finish(bake: Any, seconds: float = 100) -> Any:
    end = time.monotonic() + seconds
    while bake.poll():
        assert time.monotonic() < end, "the bake hangs"
        time.sleep(0.005)
    return bake


def bake() -> Any:
    done = finish(begin())
    assert done.outcome == "done", done.words
    return done


def cache_of(cloth: Any) -> Path:
    file = next(modifier.filepath for modifier in cloth.modifiers if modifier.type == "MESH_CACHE")
    assert file.startswith("//"), "the path is relative to the .blend"
    return Path(bpy.path.abspath(file))


def crossings(cloths: list[Any], colliders: list[Any], frame: int) -> int:
    """Of the positions that Blender evaluates."""
    dressed, bodies = ([(shown(thing, frame), faces(thing)) for thing in things] for things in (cloths, colliders))
    return len(weft.find_crossings(dressed, colliders=bodies))
