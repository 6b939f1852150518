"""The script of docs/manual/blender.md."""

from __future__ import annotations

import re
from pathlib import Path

import bpy
import pytest
from scenes import add_ball, add_cloth, pin, shown

PAGE = Path(__file__).parents[2] / "docs" / "manual" / "blender.md"


def test_the_script_of_the_page_has_ten_lines_and_bakes(blend: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (script,) = re.findall(r"^```python\n(.*?)^```$", PAGE.read_text(encoding="utf-8"), re.DOTALL | re.MULTILINE)
    assert len(script.splitlines()) == 10
    shirt = add_cloth("Shirt", location=(0, 0, 0.35))
    pin(shirt, 0.5, lambda co: co.x < -0.49)
    shirt.vertex_groups["pins"].name = "collar"
    add_ball("Figure", location=(0, 0, 0))
    for thing in bpy.data.objects:
        thing.weft.role, thing.weft.pin_group = "NONE", ""
    bpy.ops.wm.save_mainfile()
    monkeypatch.chdir(blend.parent)
    exec(script, {"__name__": "page"})
    assert "Nothing crosses in any of 12 frames." in bpy.context.scene.weft.report
    assert shown(bpy.data.objects["Shirt"], 12)[:, 2].min() < 0.3
