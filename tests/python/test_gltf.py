"""Bodies that move by a glTF file, and cloth that holds on to them."""

from __future__ import annotations

import pathlib

import numpy as np
import pytest

import weft
from worlds import write_turning_plate


@pytest.fixture
def plate(tmp_path: pathlib.Path) -> pathlib.Path:
    write_turning_plate(tmp_path / "plate.glb")
    return tmp_path / "plate.glb"


def turned(points: np.ndarray, degrees: float) -> np.ndarray:
    sin, cos = np.sin(np.radians(degrees)), np.cos(np.radians(degrees))
    return points @ np.array([(cos, sin, 0), (-sin, cos, 0), (0, 0, 1)])


def test_a_motion_is_evaluated_at_any_time(plate: pathlib.Path) -> None:
    mesh = weft.read_gltf(plate, node="plate", clip="turn")
    assert mesh.deformation is not None
    assert (mesh.deformation.num_vertices, mesh.deformation.start, mesh.deformation.end) == (15, 0, 2)
    for time, degrees in ((-1, 0), (0, 0), (0.5, 22.5), (1.7, 76.5), (9, 90)):
        np.testing.assert_allclose(mesh.deformation.positions(time), turned(mesh.vertices, degrees), atol=1e-6)


def test_pins_follow_it_at_their_place(plate: pathlib.Path) -> None:
    world = weft.World()
    body = world.add_collider(weft.read_gltf(plate), start_time=0.5)
    sheet = world.add_cloth(weft.grid(size=(0.3, 0.3), cells=(4, 4)), position=(0.3, 0.02, 0.1))
    start = turned(sheet.positions[:5], -22.5)
    sheet.pin(range(5), follow=body)
    for frame in range(90):
        world.step(1 / 60)
        now = turned(start, 22.5 + 45 * (frame + 1) / 60)
        np.testing.assert_allclose(sheet.positions[:5], now, atol=1e-6)
    twin = weft.World.load(world.save())
    world.step(1 / 60)
    twin.step(1 / 60)
    assert world.state_hash() == twin.state_hash()


def test_mistakes_are_named(plate: pathlib.Path) -> None:
    with pytest.raises(weft.InputError, match='no clip is named "walk"'):
        weft.read_gltf(plate, clip="walk")
    with pytest.raises(weft.InputError, match="clip: expected a name, found 3"):
        weft.read_gltf(plate, clip=3)  # type: ignore[arg-type]
    world = weft.World()
    with pytest.raises(weft.InputError, match="start_time: only a mesh with a deformation has it"):
        world.add_collider(weft.Sphere(), start_time=1)
    sheet = world.add_cloth(weft.grid(cells=(4, 4)))
    with pytest.raises(weft.InputError, match="follow: expected a Collider"):
        sheet.pin([0], follow=sheet)  # type: ignore[arg-type]


def test_its_motion_becomes_a_point_cache(plate: pathlib.Path, tmp_path: pathlib.Path) -> None:
    with pytest.warns(weft.FileWarning, match="60 frames per second"):
        weft.convert(plate, tmp_path / "plate.mdd")
    cache = weft._core.PointCacheFile(str(tmp_path / "plate.mdd"))
    assert (cache.num_points, cache.num_frames) == (15, 121)
    mesh = weft.read_gltf(plate)
    np.testing.assert_allclose(cache.frame(100), turned(mesh.vertices, 75), atol=1e-6)
    assert cache.times[100] == np.float32(100 / 60)
    with pytest.raises(weft.InputError, match="a glTF file has its y axis up"):
        weft.convert(plate, tmp_path / "plate.ply", up="z")
    weft.convert(plate, tmp_path / "plate.ply")
    np.testing.assert_array_equal(weft.read_mesh(tmp_path / "plate.ply").vertices, mesh.vertices)
