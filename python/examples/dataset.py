"""A data set of draped napkins in one .npz file: positions, colours, depths and ids from a given camera."""

import sys
import tempfile
from pathlib import Path

import numpy as np

import weft

folder = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp())
camera = weft.Camera(position=(0, 0, 1.4), fov_deg=26, size=(160, 120))  # looks along −z
rng, samples, has_color = np.random.default_rng(7), [], True
for _ in range(6):
    world = weft.World()
    corner = (rng.uniform(-0.3, -0.2), 0.16, rng.uniform(-0.3, -0.2))
    napkin = world.add_cloth(weft.grid(size=(0.5, 0.5), cells=(20, 20)), fabric="silk", position=corner)
    world.add_collider(weft.Sphere(radius=0.15), friction=0.5)
    for _ in range(40):
        world.step(1 / 60)
    try:
        seen = camera.render(world, color=has_color)
    except weft.GraphicsError as error:
        print(f"no colours: {error}")
        has_color = False
        seen = camera.render(world, color=False)
    samples.append((napkin.positions, seen.rgb, seen.depth, seen.ids))

positions, rgb, depth, ids = (np.stack(column) for column in zip(*samples, strict=True))
np.savez_compressed(folder / "napkins.npz", positions=positions, rgb=rgb, depth=depth, ids=ids)
print(f"positions {positions.shape}, rgb {rgb.shape}, depth {depth.shape}, ids {ids.shape}")

# Pixels of the last cloth, turned into points of the world by their depth, are on its surface.
row, column = np.nonzero(ids[-1] == 0)
z, pixel = depth[-1, row, column], np.tan(np.radians(camera.fov_deg / 2)) / 60  # [m], at a distance of 1 m
points = np.stack([(column + 0.5 - 80) * pixel * z, (60 - row - 0.5) * pixel * z, 1.4 - z], axis=1)
far = max(hit.distance for point in points[::50] if (hit := world.closest_point(point)))
print(f"{len(points)} pixels of cloth, at most {1e6 * far:.3f} µm from it")
assert len(points) > 1000 and far < 1e-6
