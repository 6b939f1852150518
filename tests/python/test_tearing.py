"""Cloth that tears: arrays of its particles grow."""

from pathlib import Path

import numpy as np
import pytest

import weft


def make_world(index: int = 0) -> weft.World:
    world = weft.World(gravity=(0, 0, 0))
    fabric = weft.Fabric(c11=1500, c22=1500, g=60, strength=100 + 20 * index)
    strip = world.add_cloth(weft.grid((0.1, 0.04), cells=(20, 8)), fabric=fabric, name="strip")
    x = strip.positions[:, 0]
    strip.pin(np.flatnonzero((x < x.min() + 1e-6) | (x > x.max() - 1e-6)))
    return world


def goals(strip: weft.Cloth, by: float) -> np.ndarray:
    at = strip.positions[strip.pins].astype(float)
    at[at[:, 0] > at[:, 0].mean(), 0] += by
    return at


def test_arrays_of_torn_cloth_are_longer() -> None:
    world = make_world()
    strip = world["strip"]
    count, faces = strip.num_particles, strip.faces.copy()
    torn = 0
    for _ in range(120):
        strip.set_targets(strip.pins, goals(strip, 5e-4))
        torn += world.step(1 / 60, check=False).torn
    assert torn > 0
    assert strip.num_particles > count
    assert strip.positions.shape == strip.velocities.shape == (strip.num_particles, 3)
    assert strip.faces.shape == faces.shape and not np.array_equal(strip.faces, faces)
    assert strip.faces.max() == strip.num_particles - 1
    assert strip.masses.sum() == pytest.approx(0.12 * 0.1 * 0.04)
    again = weft.World.load(world.save())
    assert again["strip"].num_particles == strip.num_particles
    assert again.state_hash() == world.state_hash()


def test_arrays_of_a_batch_keep_their_particles() -> None:
    batch = weft.Batch(make_world, 3, threads=2)
    count = batch[0]["strip"].num_particles
    positions = batch.positions["strip"]
    at = np.stack([goals(batch[w]["strip"], 0) for w in range(3)])
    right = at[:, :, 0] > at[:, :, 0].mean()
    torn = np.zeros(3, int)
    for _ in range(120):
        at[:, :, 0] += 5e-4 * right
        pins = batch[0]["strip"].pins
        torn += [r.torn for r in batch.step(1 / 60, targets={"strip": (pins, at)}, check=False)]
    assert torn.min() > 0
    assert positions.shape == (3, count, 3)
    for w in range(3):
        np.testing.assert_array_equal(positions[w], batch[w]["strip"].positions[:count].astype(np.float32))
    batch.reset()
    assert all(batch[w]["strip"].num_particles == count for w in range(3))


def test_a_run_shows_the_corners_of_triangles(tmp_path: Path) -> None:
    scene = weft.load_scene("tearing/ball")
    scene.set("cloth[0].grid.cells=[12, 12]")
    scene.set("cloth[0].fabric.strength=60")
    run = weft.run(scene, frames=45, out=tmp_path / "torn")
    positions = run.positions["sheet"]
    assert positions.shape == (46, 3 * 288, 3)
    count = [len(np.unique(frame, axis=0)) for frame in positions]
    assert count[0] == 169 < count[-1]
