"""Seams of flat panels, from Python."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import weft


def panels(gap: float) -> weft.Mesh:
    """Two strips of 5 × 9 vertices side by side."""
    left = np.array([(0.05 * i, 0, 0.05 * j) for j in range(9) for i in range(5)])
    faces = [
        t for j in range(8) for i in range(4) for a in [5 * j + i] for t in ((a, a + 5, a + 1), (a + 1, a + 5, a + 6))
    ]
    return weft.Mesh(np.vstack([left, left + (0.2 + gap, 0, 0)]), np.vstack([faces, np.add(faces, 45)]))


def test_lines_of_a_file_are_stitches(tmp_path: Path) -> None:
    mesh = panels(0.1)
    mesh.polygons = weft.Polygons(np.full(len(mesh.faces), 3), mesh.faces.ravel(), lines=[(4 + 5 * j, 45 + 5 * j) for j in range(9)])
    weft.write_obj(tmp_path / "panels.obj", mesh)
    read = weft.read_obj(tmp_path / "panels.obj")
    assert read.polygons is not None and np.array_equal(read.polygons.lines, mesh.polygons.lines)
    world = weft.World()
    world.gravity = (0, 0, 0)
    cloth = world.add_cloth(read, warp=(1, 0, 0), stitches=read.polygons.lines, seam_time=0.5)
    for _ in range(60):
        world.step(1 / 60)
    open_by = np.linalg.norm(cloth.positions[4:45:5] - cloth.positions[45:90:5], axis=1)
    assert open_by.max() < 0.002


@pytest.mark.parametrize("integrator", ["newton", "implicit_euler", "xpbd"])
def test_panels_are_sewn(integrator: str) -> None:
    world = weft.World(integrator=integrator)
    world.gravity = (0, 0, 0)
    cloth = world.add_cloth(panels(0.1), warp=(1, 0, 0), seams=[([4, 44], [45, 85])], seam_time=0.5)
    for _ in range(60):
        world.step(1 / 60)
    open_by = np.linalg.norm(cloth.positions[4:45:5] - cloth.positions[45:90:5], axis=1)
    assert open_by.max() < 0.002
