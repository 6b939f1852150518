#!/usr/bin/env python3
"""The picture and the figures of docs/manual/blender.md, by the extension in Blender's module bpy.

WEFT_BLENDER_ZIP=build/blender/weft-VERSION.zip build/blender/venv-3.11/bin/python tools/blender_shot.py picture FILE.jpg
… tools/blender_shot.py measure       120 frames of 65 × 65 particles on a skinned body: time around the simulation
"""

from __future__ import annotations

import importlib
import math
import os
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

FOLDER = tempfile.TemporaryDirectory(prefix="weft_shot_")
os.environ["BLENDER_USER_RESOURCES"] = FOLDER.name

import bpy  # noqa: E402

GARMENTS = Path(__file__).resolve().parents[1] / "scenes" / "garments"


def begin() -> None:
    """An empty scene of 120 frames with the walking figure as a collider."""
    bpy.ops.extensions.package_install_files(
        filepath=os.environ["WEFT_BLENDER_ZIP"], repo="user_default", enable_on_install=True
    )
    bpy.ops.wm.read_homefile(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps, scene.frame_start, scene.frame_end = 24, 1, 120
    bpy.ops.wm.save_as_mainfile(filepath=str(Path(FOLDER.name) / "shot.blend"))
    bpy.ops.import_scene.gltf(filepath=str(GARMENTS / "figure.glb"))
    scene.frame_start, scene.frame_end = 1, 120
    scene.frame_set(1)
    figure().weft.role = "COLLIDER"


def figure() -> Any:
    return next(t for t in bpy.context.scene.objects if t.type == "MESH" and any(m.type == "ARMATURE" for m in t.modifiers))


def add_garment(name: str, fabric: str) -> Any:
    bpy.ops.wm.obj_import(filepath=str(GARMENTS / f"walk_{name}.obj"), import_vertex_groups=True)
    garment = bpy.context.selected_objects[0]
    garment.name = name
    garment.weft.role, garment.weft.fabric = "CLOTH", fabric
    bpy.ops.object.shade_smooth()
    return garment


def follow_body(garment: Any) -> None:
    """The garment's mesh follows the body's skin; its pins then do so in the bake."""
    garment.modifiers.new("Surface Deform", "SURFACE_DEFORM").target = figure()
    bpy.context.view_layer.objects.active = garment
    bpy.ops.object.surfacedeform_bind(modifier="Surface Deform")


def bake() -> Any:
    job = importlib.import_module("bl_ext.user_default.weft.job")
    began = time.perf_counter()
    done = job.Job(bpy.context.scene, bpy.context.view_layer)
    while done.poll():
        time.sleep(0.01)
    seconds, simulated = time.perf_counter() - began, done.report["simulation_seconds"]
    print("\n".join(done.words))
    print(f"{done.frames} frames: {seconds:.1f} s, of it simulation {simulated:.1f} s; the rest is "
          f"{100 * (seconds - simulated) / simulated:.0f} % of it (gathering {done.gathering_seconds:.1f} s)")  # fmt: skip
    return done


def colour(thing: Any, rgb: tuple[float, float, float], roughness: float, sheen: float = 0.0) -> None:
    material = bpy.data.materials.new(thing.name)
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (*rgb, 1)
    shader.inputs["Roughness"].default_value = roughness
    shader.inputs["Sheen Weight"].default_value = sheen
    thing.data.materials.clear()
    thing.data.materials.append(material)


def add_light(location: tuple[float, float, float], watts: float, size: float) -> None:
    bpy.ops.object.light_add(type="AREA", location=location)
    light = bpy.context.object
    light.data.energy, light.data.size = watts, size
    x, y, z = location
    light.rotation_euler = (math.atan2(math.hypot(x, y), z - 0.9), 0, math.atan2(x, -y))


def picture(file: str) -> None:
    begin()
    skirt, shirt = add_garment("skirt", "silk"), add_garment("shirt", "cotton_shirting")
    skirt.weft.pin_group = "waist"
    follow_body(skirt)
    bake()
    scene = bpy.context.scene
    scene.frame_set(84)
    for garment in (skirt, shirt):
        garment.modifiers.new("Subdivision", "SUBSURF").render_levels = 2
        garment.modifiers.new("Thickness", "SOLIDIFY").thickness = 0.002
    colour(figure(), (0.55, 0.42, 0.34), 0.6)
    colour(skirt, (0.03, 0.09, 0.28), 0.8, 0.3)
    colour(shirt, (0.7, 0.62, 0.5), 0.85, 0.3)
    body = figure().evaluated_get(bpy.context.evaluated_depsgraph_get())
    points = [body.matrix_world @ v.co for v in body.data.vertices]
    centre = sum(points, start=body.location * 0) / len(points)
    bpy.ops.mesh.primitive_plane_add(size=40, location=(0, 0, min(point.z for point in points)))
    colour(bpy.context.object, (0.6, 0.6, 0.62), 0.9)
    bpy.ops.object.camera_add(location=(centre.x + 1.9, centre.y - 3.6, 1.3))
    camera = bpy.context.object
    camera.data.lens = 62
    target = bpy.data.objects.new("Target", None)
    target.location = (centre.x, centre.y, 0.88)
    bpy.context.collection.objects.link(target)
    camera.constraints.new("TRACK_TO").target = target
    scene.camera = camera
    add_light((centre.x + 3, centre.y - 2.5, 3.5), 260, 1.5)
    add_light((centre.x - 3, centre.y - 1, 2.5), 90, 3)
    add_light((centre.x - 1, centre.y + 3, 3), 160, 1)
    scene.world = bpy.data.worlds.new("World")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.5, 0.55, 0.62, 1)
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.35
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples, scene.cycles.use_denoising = "CPU", 96, True
    scene.render.resolution_x, scene.render.resolution_y = 900, 900
    scene.render.image_settings.file_format, scene.render.image_settings.quality = "JPEG", 88
    scene.render.filepath = str(Path(file).resolve())
    bpy.ops.render.render(write_still=True)


def measure() -> None:
    begin()
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=64, y_subdivisions=64, size=1.2, location=(0, 0, 2.0))
    bpy.context.object.weft.role = "CLOTH"
    bake()


if __name__ == "__main__":
    {"picture": lambda: picture(sys.argv[2]), "measure": measure}[sys.argv[1]]()
