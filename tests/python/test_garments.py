"""Bodies with holes, and garments over each other, from Python."""

from __future__ import annotations

import numpy as np
import weft

AROUND = 24


def tube(radius: float, length: float, rings: int = 21) -> weft.Mesh:
    """Around x, open at its ends, facing outwards."""
    angles = 2 * np.pi * np.arange(AROUND) / AROUND
    vertices = [
        (length * (i / (rings - 1) - 0.5), radius * np.cos(a), radius * np.sin(a)) for i in range(rings) for a in angles
    ]
    faces = [
        t
        for i in range(rings - 1)
        for k in range(AROUND)
        for a, b in [(i * AROUND + k, i * AROUND + (k + 1) % AROUND)]
        for t in ((a, b, a + AROUND), (b, b + AROUND, a + AROUND))
    ]
    return weft.Mesh(np.array(vertices), np.array(faces))


def dressed(*sleeves: tuple[float, int], solid: bool | None) -> weft.World:
    """An arm of 40 mm whose ends are open, in sleeves of a radius and a layer."""
    world = weft.World()
    world.gravity = (0, 0, 0)
    world.add_collider(tube(0.04, 0.6), solid=solid, name="arm")
    for radius, layer in sleeves:
        world.add_cloth(tube(radius, 0.2), layer=layer)
    return world


def radii(cloth: weft.Cloth) -> np.ndarray:
    """Of its rings but the outer ones [m]."""
    return np.hypot(*cloth.positions.T[1:]).reshape(-1, AROUND)[3:-3]


def test_cloth_leaves_a_body_whose_ends_are_filled() -> None:
    world = dressed((0.035, 0), solid=True)
    assert world["arm"].notes[0].startswith('collider "arm": has 2 holes, up to 79.')
    assert world.untangle() == []
    assert radii(world.cloths[0]).min() > 0.0399


def test_cloth_stays_in_an_open_body() -> None:
    world = dressed((0.035, 0), solid=False)
    assert world["arm"].notes == ['collider "arm": has a border of 48 edges: cloth collides with both sides there']
    assert world.untangle() == []
    assert radii(world.cloths[0]).max() < 0.036


def test_layers_are_put_in_order() -> None:
    world = dressed((0.050, 0), (0.048, 1), solid=True)
    assert world.untangle() == []
    inner, outer = world.cloths
    assert (radii(outer).min(axis=1) > radii(inner).min(axis=1)).all()
    saved = weft.World.load(world.save())
    assert saved.untangle() == []
    assert (saved.cloths[1].positions == outer.positions).all()
