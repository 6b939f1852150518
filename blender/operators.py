# SPDX-License-Identifier: GPL-3.0-or-later
"""Bake, Resume, Cancel and Free."""

import time

import bpy
from bpy.app.handlers import persistent

from . import job
from .refused import Refused

_TICK = 0.05  # [s]


def _tick() -> float | None:
    """The timer of a bake."""
    if job.current is None:
        return None
    running = job.current.poll()
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "PROPERTIES":
                area.tag_redraw()
    return _TICK if running else None


class _Bake:
    bl_options = {"REGISTER", "UNDO"}
    resumes = False

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return job.current is None or not job.current.is_running

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            job.current = job.Job(context.scene, context.view_layer, resume=self.resumes)
        except Refused as error:
            context.scene.weft.report = f"{error}."
            self.report({"ERROR"}, f"{error}.")
            return {"CANCELLED"}
        if not bpy.app.background:
            bpy.app.timers.register(_tick, persistent=True)
            return {"FINISHED"}
        while job.current.poll():  # a script has nothing else to do
            time.sleep(_TICK)
        if job.current.outcome != "done":
            self.report({"ERROR"}, " ".join(job.current.words))
        return {"FINISHED"}


class WEFT_OT_bake(_Bake, bpy.types.Operator):
    """Simulate the cloths of the scene, beside Blender"""

    bl_idname, bl_label = "weft.bake", "Bake"


class WEFT_OT_resume(_Bake, bpy.types.Operator):
    """Go on with a bake that was cancelled or cut off, from its last checkpoint"""

    bl_idname, bl_label = "weft.resume", "Resume"
    resumes = True

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return super().poll(context) and job.can_resume(context.scene)


class WEFT_OT_cancel(bpy.types.Operator):
    """End the bake; the frames that are there stay"""

    bl_idname, bl_label = "weft.cancel", "Cancel"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return job.current is not None and job.current.is_running

    def execute(self, context: bpy.types.Context) -> set[str]:
        job.current.cancel()
        return {"FINISHED"}


class WEFT_OT_free(bpy.types.Operator):
    """Remove the modifiers and delete the caches"""

    bl_idname, bl_label = "weft.free", "Free"
    bl_options = {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return job.current is None or not job.current.is_running

    def execute(self, context: bpy.types.Context) -> set[str]:
        try:
            job.free(context.scene)
        except (Refused, OSError) as error:
            self.report({"ERROR"}, f"{error}.")
            return {"CANCELLED"}
        return {"FINISHED"}


@persistent
def _end_bake(*_: object) -> None:
    """Before another .blend is loaded."""
    if job.current is not None and job.current.is_running:
        job.current.cancel()
    job.current = None


_CLASSES = (WEFT_OT_bake, WEFT_OT_resume, WEFT_OT_cancel, WEFT_OT_free)


def register() -> None:
    for cls in _CLASSES:
        bpy.utils.register_class(cls)
    bpy.app.handlers.load_pre.append(_end_bake)


def unregister() -> None:
    _end_bake()
    bpy.app.handlers.load_pre.remove(_end_bake)
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
