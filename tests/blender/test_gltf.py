"""Skins of glTF files that Blender writes, as Weft moves them and as Blender evaluates them."""

from __future__ import annotations

from pathlib import Path

import bpy
import numpy as np
import weft
from scenes import add_bending_body, shown


def test_a_skin_moves_as_in_blender(tmp_path: Path) -> None:
    body = add_bending_body()
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 0, 12
    file = tmp_path / "body.glb"
    bpy.ops.export_scene.gltf(
        filepath=str(file), export_normals=False, export_texcoords=False, export_materials="NONE", export_animations=True
    )
    mesh = weft.read_gltf(file)
    assert mesh.deformation is not None

    def z_up(points: np.ndarray) -> np.ndarray:
        return points[:, [0, 2, 1]] * (1, -1, 1)

    start = z_up(mesh.deformation.positions(1 / 24))
    of_vertex = np.abs(start[None] - shown(body, 1)[:, None]).sum(-1).argmin(1)
    for frame in (1, 3, 6, 9, 12):
        moved = z_up(mesh.deformation.positions(frame / 24))[of_vertex]
        assert np.abs(moved - shown(body, frame)).max() < 1e-5
    assert np.abs(shown(body, 12) - shown(body, 1)).max() > 0.2
