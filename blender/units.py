# SPDX-License-Identifier: GPL-3.0-or-later
"""Lengths and times of a scene in SI units."""

import math

import bpy

STEP = {"fast": 1 / 48, "default": 1 / 60, "high": 1 / 120}  # longest, by quality [s]


def metres(scene: bpy.types.Scene) -> float:
    """Length of the scene's unit [m]."""
    return 1.0 if scene.unit_settings.system == "NONE" else scene.unit_settings.scale_length


def frame_rate(scene: bpy.types.Scene) -> float:
    """[1/s]"""
    return scene.render.fps / scene.render.fps_base


def gravity(scene: bpy.types.Scene) -> tuple[float, float, float]:
    """As Blender shows it [m/s²]."""
    if not scene.use_gravity:
        return (0.0, 0.0, 0.0)
    x, y, z = (metres(scene) * number for number in scene.gravity)
    return (x, y, z)


def frame_range(scene: bpy.types.Scene) -> tuple[int, int]:
    """First and last frame."""
    if scene.weft.own_range:
        return scene.weft.first_frame, scene.weft.last_frame
    return scene.frame_start, scene.frame_end


def steps_per_frame(scene: bpy.types.Scene) -> int:
    """29.97 frames per second are taken as 30."""
    return max(1, math.ceil(1 / (STEP[scene.weft.quality] * frame_rate(scene)) - 0.05))
