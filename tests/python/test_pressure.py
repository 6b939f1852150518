"""Gas in closed cloth, from Python."""

from __future__ import annotations

import numpy as np
import pytest
import weft

OCTAHEDRON = weft.Mesh(
    0.2 * np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]),
    [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)],
)


def test_gas_is_kept_or_sealed() -> None:
    world = weft.World()
    world.gravity = (0, 0, 0)
    bag = world.add_cloth(OCTAHEDRON, fabric="denim", warp=(1, 0, 0))
    empty = bag.volume
    assert empty == pytest.approx(4 / 3 * 0.2**3) and bag.pressure == 0
    bag.set_pressure(2000, sealed=True)
    product = (bag.pressure + 101325) * bag.volume
    for _ in range(60):
        world.step(1 / 60)
    assert bag.volume > empty and bag.pressure < 2000
    assert (bag.pressure + 101325) * bag.volume == pytest.approx(product, rel=1e-6)
    bag.set_pressure(0)
    assert bag.pressure == 0
    for _ in range(60):
        world.step(1 / 60)
    assert bag.volume == pytest.approx(empty, rel=0.02)


def test_forces_of_gas_are_elastic_and_sum_to_zero() -> None:
    world = weft.World()
    bag = world.add_cloth(OCTAHEDRON, fabric="denim", warp=(1, 0, 0))
    before = bag.force("elastic")
    bag.set_pressure(100)
    push = bag.force("elastic") - before
    assert np.abs(push.sum(axis=0)).max() < 1e-9
    # Each corner has a third of the vector areas of its four triangles: a square of side 0.2 √2, seen from outside.
    assert push[2] == pytest.approx([0, 100 * 2 * 0.2**2 / 3, 0], abs=1e-6)
