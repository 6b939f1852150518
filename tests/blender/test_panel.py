"""The panel, drawn without a window: every setting and operator that it names is there."""

from __future__ import annotations

import importlib
from types import SimpleNamespace
from typing import Any

import bpy
from scenes import ADDON, add_ball, add_cloth, finish, job

panel = importlib.import_module(f"{ADDON}.panel")
operators = importlib.import_module(f"{ADDON}.operators")


class Layout:
    """Keeps what is drawn, as words."""

    def __init__(self) -> None:
        self.drawn: list[str] = []

    def row(self, **_: Any) -> Layout:
        return self

    column = box = row

    def prop(self, data: Any, name: str, **_: Any) -> None:
        assert name in data.bl_rna.properties, name
        self.drawn.append(data.bl_rna.properties[name].name)

    def prop_search(self, data: Any, name: str, among: Any, names: str) -> None:
        assert names in among.bl_rna.properties
        self.prop(data, name)

    def operator(self, name: str) -> None:
        group, short = name.split(".")
        self.drawn.append(getattr(getattr(bpy.ops, group), short).get_rna_type().name)

    def label(self, *, text: str, icon: str) -> None:
        self.drawn.append(text.strip())

    def progress(self, *, factor: float, text: str) -> None:
        assert 0 <= factor <= 1
        self.drawn.append(text)


def drawn() -> list[str]:
    layout = Layout()
    context = SimpleNamespace(object=bpy.context.object, scene=bpy.context.scene, region=SimpleNamespace(width=320))
    for cls in (panel.WEFT_PT_object, panel.WEFT_PT_fabric, panel.WEFT_PT_bake):
        if cls.poll(context):
            cls.draw(SimpleNamespace(layout=layout), context)
    return layout.drawn


def test_it_has_the_settings_of_the_object_and_of_the_bake() -> None:
    add_cloth()
    bake = ["Colliders", "Own frame range", "Quality", "Put on at the start", "Threads", "Cache", "Bake", "Resume", "Cancel", "Free"]
    names = drawn()
    assert names[:8] == ["Role", "Fabric", "Thickness", "Pins", "Rest shape", "Layer", "Sew", "Sewing time"] and names[-10:] == bake
    assert "Bending along warp (µN·m)" in names
    add_ball()
    assert drawn() == ["Role", "Friction", "Inside", *bake]


def test_it_shows_the_progress_and_then_the_report() -> None:
    add_cloth()
    job.current = job.Job(bpy.context.scene, bpy.context.view_layer)
    while job.current.frames < 3:
        assert operators._tick() is not None
    assert drawn()[-1].startswith("Frame ") and " of 12, " in drawn()[-1]
    assert bpy.ops.weft.cancel.poll() and not bpy.ops.weft.bake.poll()
    finish(job.current)
    assert operators._tick() is None
    assert " ".join(drawn()).endswith("Nothing crosses in any of 12 frames.")


def test_a_bake_ends_before_another_blend_is_opened() -> None:
    bpy.context.scene.frame_end = 500
    add_cloth()
    running = job.current = job.Job(bpy.context.scene, bpy.context.view_layer)
    bpy.ops.wm.read_homefile(use_empty=True)
    assert job.current is None
    running._process.wait(60)
