"""Installs the extension's zip, WEFT_BLENDER_ZIP, into a user folder of the tests' own, before Blender reads it."""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

_user = tempfile.TemporaryDirectory(prefix="weft_blender_")
os.environ["BLENDER_USER_RESOURCES"] = _user.name
sys.path.insert(0, str(Path(__file__).parent))

import bpy  # noqa: E402

_done = bpy.ops.extensions.package_install_files(
    filepath=os.environ["WEFT_BLENDER_ZIP"], repo="user_default", enable_on_install=True
)
assert _done == {"FINISHED"}, _done


@pytest.fixture(autouse=True)
def blend(tmp_path: Path) -> Iterator[Path]:
    """An empty scene of 24 frames per second, frames 1 to 12, saved in a folder of the test's own."""
    bpy.ops.wm.read_homefile(use_empty=True, use_factory_startup=False)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 12
    scene.weft.threads = 1
    file = tmp_path / "shot.blend"
    bpy.ops.wm.save_as_mainfile(filepath=str(file))
    yield file
    bpy.ops.wm.read_homefile(use_empty=True)
