"""Rest shapes other than the mesh, from Python."""

from __future__ import annotations

import numpy as np
import weft


def size(cloth: weft.Cloth) -> np.ndarray:
    return np.ptp(cloth.positions, axis=0)


def test_elastic_takes_its_own_length() -> None:
    world = weft.World()
    world.gravity = (0, 0, 0)
    everywhere = list(range(25))
    cloth = world.add_cloth(weft.grid(size=(0.2, 0.2), cells=(4, 4)), rest_scales=[(everywhere, 0.75, 0.9)])
    for _ in range(240):
        world.step(1 / 60)
    assert np.allclose(size(cloth)[[0, 2]], (0.15, 0.18), atol=5e-4)


def test_a_pattern_sets_the_size() -> None:
    sheet = np.array([(0.05 * i, 0, 0.05 * j) for j in range(5) for i in range(5)])
    corners = [5 * j + i for j in range(4) for i in range(4)]
    faces = [t for a in corners for t in ((a, a + 5, a + 1), (a + 1, a + 5, a + 6))]
    mesh = weft.Mesh(sheet, faces, uv=sheet[:, [0, 2]] * 7)
    sides = np.diff(weft.rest_from_uv(mesh), axis=1)
    assert np.allclose(np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1), 0.05**2)
    world = weft.World()
    world.gravity = (0, 0, 0)
    cloth = world.add_cloth(mesh, rest=weft.rest_from_uv(mesh, scale=0.9 / 7))
    for _ in range(240):
        world.step(1 / 60)
    assert np.allclose(size(cloth)[[0, 2]], 0.18, atol=1e-3)
