"""Renders one frame of an animation.glb: how the picture at the top of the README was made.

    blender -b --factory-startup --python docs/images/render_in_blender.py -- ANIMATION.glb PICTURE.png FRAME
"""

import sys

import bpy
import numpy
from mathutils import Vector

numpy.bool = bool  # Blender 3.4's glTF import still uses the name that numpy 1.24 dropped

animation, picture, frame = sys.argv[sys.argv.index("--") + 1:]


def point_at(thing, target):
    thing.rotation_euler = (Vector(target) - thing.location).to_track_quat("-Z", "Y").to_euler()


def add(name, data, location, target):
    thing = bpy.data.objects.new(name, data)
    thing.location = location
    bpy.context.scene.collection.objects.link(thing)
    point_at(thing, target)
    return thing


bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=animation)
scene = bpy.context.scene
scene.render.fps = 60
scene.frame_set(int(frame))

for mesh in [o for o in bpy.data.objects if o.type == "MESH"]:
    for polygon in mesh.data.polygons:
        polygon.use_smooth = True
    surface = mesh.data.materials[0].node_tree.nodes["Principled BSDF"]
    if mesh.name == "ball":
        surface.inputs["Base Color"].default_value = (0.25, 0.27, 0.3, 1)
        surface.inputs["Roughness"].default_value = 0.35
    else:
        surface.inputs["Sheen"].default_value = 0.6
        surface.inputs["Roughness"].default_value = 0.75

bpy.ops.mesh.primitive_plane_add(size=40)
ground = bpy.data.materials.new("ground")
ground.use_nodes = True
ground.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.45, 0.47, 0.5, 1)
bpy.context.object.data.materials.append(ground)

scene.world = bpy.data.worlds.new("sky")
scene.world.use_nodes = True
sky = scene.world.node_tree.nodes["Background"].inputs
sky["Color"].default_value = (0.75, 0.85, 1, 1)
sky["Strength"].default_value = 0.22
lamp = bpy.data.lights.new("lamp", "AREA")
lamp.energy, lamp.size = 140, 1.5
add("lamp", lamp, (1.8, -1.6, 2.6), (0, 0, 0.3))
camera = bpy.data.cameras.new("camera")
camera.lens = 78
scene.camera = add("camera", camera, (1.5, -2.2, 1.15), (0, 0, 0.36))

scene.render.engine = "CYCLES"
scene.cycles.samples = 110
scene.cycles.use_denoising = False
scene.view_settings.look = "High Contrast"
scene.view_settings.exposure = 0.55
scene.render.resolution_x, scene.render.resolution_y = 960, 640
scene.render.filepath = picture
bpy.ops.render.render(write_still=True)
