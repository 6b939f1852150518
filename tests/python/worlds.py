"""Small worlds, which several tests share."""

from __future__ import annotations

import json
import os
import struct
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import weft

DT = 1 / 60

SQUARE = weft.Mesh([(0, 0, 0), (1, 0, 0), (1, 0, 1), (0, 0, 1)], [(0, 2, 1), (0, 3, 2)])


def hanging(cells: int = 12, *, integrator: str = "newton", threads: int = 1, height: float = 1.0) -> weft.World:
    """A sheet of 1 m that hangs from two corners."""
    world = weft.World(integrator=integrator, threads=threads)
    sheet = world.add_cloth(weft.grid(cells=(cells, cells)), position=(-0.5, height, -0.5), name="sheet")
    sheet.pin(sheet.corners[:2])
    return world


def draped(cells: int = 12, *, threads: int = 1) -> weft.World:
    """A sheet that falls on a ball; both touch within the first steps."""
    world = weft.World(threads=threads)
    world.add_cloth(weft.grid(cells=(cells, cells)), position=(-0.5, 0.51, -0.5), name="sheet")
    world.add_collider(weft.Sphere(center=(0, 0.3, 0), radius=0.2), friction=0.4, name="ball")
    return world


def layered(cells: int = 10) -> weft.World:
    """A cloth that falls on another one, which hangs from its corners."""
    world = weft.World()
    lower = world.add_cloth(weft.grid(cells=(cells, cells)), position=(-0.5, 0.5, -0.5), name="lower")
    lower.pin(lower.corners)
    world.add_cloth(weft.grid(size=(0.5, 0.5), cells=(cells, cells)), position=(-0.2, 0.505, -0.2), name="upper")
    return world


def triangulated(cells: int = 8) -> weft.Mesh:
    """A square of 1 m with irregular vertices, and texture coordinates."""
    across = np.linspace(0, 1, cells + 1)
    x, z = np.meshgrid(across, across)
    inner = (x > 0) & (x < 1) & (z > 0) & (z < 1)
    shift = np.random.default_rng(7).uniform(-0.2, 0.2, (2, *x.shape)) / cells * inner
    vertices = np.stack([x + shift[0], np.zeros_like(x), z + shift[1]], axis=-1).reshape(-1, 3)
    corner = (np.arange(cells)[:, None] * (cells + 1) + np.arange(cells)).reshape(-1)
    right, below, across_both = corner + 1, corner + cells + 1, corner + cells + 2
    faces = np.concatenate([np.stack([corner, below, right], 1), np.stack([right, below, across_both], 1)])
    return weft.Mesh(vertices, faces, uv=vertices[:, [0, 2]])


def meshed(cells: int = 8) -> weft.World:
    """A triangle mesh that hangs from one side."""
    world = weft.World()
    cloth = world.add_cloth(triangulated(cells), fabric="denim", name="cloth")
    cloth.pin(cloth.rest[:, 2] == 0)
    return world


def sprung(cells: int = 10, *, integrator: str = "paper") -> weft.World:
    """A sheet of springs that hangs from two corners."""
    world = weft.World(integrator=integrator)
    springs = weft.Springs(density=0.2, structural=200, shear=100, bend=2, damping=0.01)
    sheet = world.add_cloth(weft.grid(cells=(cells, cells)), fabric=springs, model="simplified", name="sheet")
    sheet.pin(sheet.corners[:2])
    return world


def windy(cells: int = 10) -> weft.World:
    """A hanging sheet in gusts, with aerodynamic drag and lift."""
    world = hanging(cells)
    world.wind = weft.Wind(
        keys=[weft.WindKey(time=0, velocity=(1, 0, 2)), weft.WindKey(time=0.2, velocity=(0, 0, 6))],
        air=weft.Air(density=1.2),
        gusts=weft.Gusts(strength=1, length=0.5, time=0.3, seed=4),
    )
    return world


def keyed(cells: int = 10) -> weft.World:
    """Pins and a ball that move along key frames."""
    world = weft.World()
    sheet = world.add_cloth(weft.grid(cells=(cells, cells)), position=(-0.5, 0.52, -0.5), name="sheet")
    motion = [weft.KeyFrame(time=0), weft.KeyFrame(time=0.5, translation=(0.1, 0.1, 0), angles_deg=(0, 20, 0))]
    sheet.pin(sheet.corners[:2], motion=motion, pivot=(0, 0.5, 0))
    rise = [weft.KeyFrame(time=0), weft.KeyFrame(time=0.5, translation=(0, 0.1, 0), angles_deg=(0, 0, 90))]
    world.add_collider(weft.Box(center=(0, 0.4, 0), half_size=(0.2, 0.1, 0.2)), motion=rise, name="box")
    return world


def rubbing(cells: int = 8) -> weft.World:
    """Two cloths on a tilted plane, with friction of their own for each pair."""
    world = weft.World()
    world.gravity = (2.0, -9.0, 0.0)
    floor = world.add_collider(weft.Plane(), friction=0.9, name="floor")
    lower = world.add_cloth(weft.grid(size=(0.5, 0.5), cells=(cells, cells)), position=(0, 0.002, 0), name="lower")
    upper = world.add_cloth(weft.grid(size=(0.3, 0.3), cells=(cells, cells)), position=(0.1, 0.006, 0.1), name="upper")
    world.set_friction(lower, floor, 0.05)
    world.set_friction(lower, upper, 0.1, 0.2)
    world.set_friction(upper, floor, 0.5)
    return world


FEATURES: dict[str, Callable[[], weft.World]] = {
    "fabric": hanging,
    "mesh": meshed,
    "springs": sprung,
    "contact": draped,
    "two cloths": layered,
    "wind": windy,
    "key frames": keyed,
    "pair friction": rubbing,
}


def advance(world: weft.World, steps: int, dt: float = DT) -> list[weft.StepReport]:
    """Steps, of which none may fail."""
    return [world.step(dt, check=False) for _ in range(steps)]


def cloth_of(world: weft.World, name: str | None = None) -> weft.Cloth:
    """A cloth by its name, or the first one."""
    if name is None:
        return world.cloths[0]
    body = world[name]
    assert isinstance(body, weft.Cloth)
    return body


def python(code: str, *arguments: str, timeout: float = 300) -> subprocess.CompletedProcess[str]:
    """Runs Python code in another process, which imports the same package and these helpers."""
    folder = str(Path(__file__).parent)
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([folder, *filter(None, sys.path)])}
    return subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, text=True, timeout=timeout, env=environment
    )


def program() -> Path:
    """The program `weft`: the environment's WEFT_PROGRAM, else the release build's."""
    default = Path(__file__).parents[2] / "build" / "release" / "bin" / "weft"
    return Path(os.environ.get("WEFT_PROGRAM", default))


def write_turning_plate(file: Path) -> None:
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
