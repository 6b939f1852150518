"""Bodies that move by a glTF file, and cloth that holds on to them."""

from __future__ import annotations

import json
import pathlib
import struct

import numpy as np
import pytest

import weft


def write_turning_plate(file: pathlib.Path) -> None:
    """A plate of a metre along x and half a metre along z, whose node turns about z by 90 degrees in 2 s."""
    points = np.array([(x / 4, 0, z / 4) for z in range(3) for x in range(5)], np.float32)
    cells = [5 * z + x for z in range(2) for x in range(4)]
    faces = np.array([t for a in cells for t in ((a, a + 5, a + 1), (a + 1, a + 5, a + 6))], np.uint16)
    half = np.sqrt(0.5)
    times, turns = np.array([0, 2], np.float32), np.array([(0, 0, 0, 1), (0, 0, half, half)], np.float32)
    blocks = [block.tobytes() for block in (points, faces, times, turns)]
    views, offset = [], 0
    for block in blocks:
        views.append({"buffer": 0, "byteOffset": offset, "byteLength": len(block)})
        offset += len(block)
    gltf = {
        "asset": {"version": "2.0"},
        "buffers": [{"byteLength": offset}],
        "bufferViews": views,
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3",
             "min": points.min(0).tolist(), "max": points.max(0).tolist()},
            {"bufferView": 1, "componentType": 5123, "count": faces.size, "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [2]},
            {"bufferView": 3, "componentType": 5126, "count": 2, "type": "VEC4"},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "nodes": [{"name": "plate", "mesh": 0}],
        "scenes": [{"nodes": [0]}],
        "scene": 0,
        "animations": [{"name": "turn", "channels": [{"sampler": 0, "target": {"node": 0, "path": "rotation"}}],
                        "samplers": [{"input": 2, "output": 3}]}],
    }  # fmt: skip
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    data = b"".join(blocks)
    data += b"\0" * (-len(data) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(data), b"BIN\0") + data
    file.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks)


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
