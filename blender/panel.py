# SPDX-License-Identifier: GPL-3.0-or-later
"""The panel in the physics properties."""

import bpy

from . import job
from .properties import NUMBERS


def _in_words(seconds: float) -> str:
    return f"{seconds:.0f} s" if seconds < 90 else f"{seconds / 60:.0f} min" if seconds < 5400 else f"{seconds / 3600:.1f} h"


def _add_text(layout: bpy.types.UILayout, text: str, width: int) -> None:
    """A sentence, in lines."""
    line, icon = "", "DOT"
    for word in text.split():
        if line and len(line) + len(word) > width:
            layout.label(text=line, icon=icon)
            line, icon = "", "BLANK1"
        line += word + " "
    layout.label(text=line, icon=icon)


class _Panel:
    bl_space_type, bl_region_type, bl_context = "PROPERTIES", "WINDOW", "physics"

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return context.object is not None and context.object.type == "MESH"


class WEFT_PT_object(_Panel, bpy.types.Panel):
    bl_label = "Weft"

    def draw(self, context: bpy.types.Context) -> None:
        layout, thing = self.layout, context.object
        layout.use_property_split = True
        settings = thing.weft
        layout.row().prop(settings, "role", expand=True)
        if settings.role == "COLLIDER":
            layout.prop(settings, "friction")
            layout.prop(settings, "solid")
        if settings.role != "CLOTH":
            return
        layout.prop(settings, "fabric")
        layout.prop(settings, "thickness")
        layout.prop_search(settings, "pin_group", thing, "vertex_groups")
        layout.prop(settings, "rest")
        layout.prop(settings, "layer")
        layout.prop(settings, "sew")
        if settings.sew:
            layout.prop(settings, "sew_time")


class WEFT_PT_fabric(_Panel, bpy.types.Panel):
    bl_label, bl_parent_id, bl_options = "Fabric's numbers", "WEFT_PT_object", {"DEFAULT_CLOSED"}

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        return super().poll(context) and context.object.weft.role == "CLOTH"

    def draw(self, context: bpy.types.Context) -> None:
        self.layout.use_property_split = True
        for name in NUMBERS:
            self.layout.prop(context.object.weft, name)


class WEFT_PT_bake(_Panel, bpy.types.Panel):
    bl_label, bl_parent_id = "Bake", "WEFT_PT_object"

    def draw(self, context: bpy.types.Context) -> None:
        layout, settings = self.layout, context.scene.weft
        layout.use_property_split = True
        layout.prop(settings, "colliders")
        layout.prop(settings, "own_range")
        if settings.own_range:
            column = layout.column(align=True)
            column.prop(settings, "first_frame")
            column.prop(settings, "last_frame")
        layout.prop(settings, "quality")
        layout.prop(settings, "untangle")
        layout.prop(settings, "threads")
        layout.prop(settings, "folder")
        row = layout.row(align=True)
        for operator in ("weft.bake", "weft.resume", "weft.cancel", "weft.free"):
            row.operator(operator)
        bake = job.current
        if bake is not None and bake.is_running:
            left = f", {_in_words(bake.seconds_left)} left" if bake.seconds_left is not None else ""
            layout.progress(factor=bake.frames / bake.num_frames, text=f"Frame {bake.frames} of {bake.num_frames}{left}")
        elif settings.report:
            box = layout.box()
            for sentence in settings.report.split("\n"):
                _add_text(box, sentence, max(20, context.region.width // 8))


_CLASSES = (WEFT_PT_object, WEFT_PT_fabric, WEFT_PT_bake)


def register() -> None:
    for cls in _CLASSES:
        bpy.utils.register_class(cls)


def unregister() -> None:
    for cls in reversed(_CLASSES):
        bpy.utils.unregister_class(cls)
