"""A circle skirt of two panels, from an OBJ file, is sewn and dropped over a dress form."""

import sys
import tempfile
from pathlib import Path

import numpy as np

import weft

WAIST, HEM, FORM = 0.1, 0.4, 0.15  # radii [m]; the waist is narrower than the form
folder = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp())

# The pattern: two halves of a ring, (panel, row, column), with a border of 16 vertices at each end.
angle = np.pi * (np.linspace(0, 1, 48) + np.arange(2)[:, None])[:, None]
radius = np.linspace(WAIST, HEM, 16)[:, None]
x, z = (radius * np.cos(angle)).ravel(), (radius * np.sin(angle)).ravel()
a = np.arange(x.size).reshape(2, 16, 48)[:, :-1, :-1].ravel()
faces = np.concatenate([np.stack([a, a + 1, a + 48], 1), np.stack([a + 1, a + 49, a + 48], 1)])
weft.write_obj(folder / "skirt.obj", weft.Mesh(np.stack([x, 0 * x, z], 1), faces, uv=np.stack([x, z], 1)))

world = weft.World()
world.add_collider(weft.Capsule(a=(0, 0, 0), b=(0, 0.8, 0), radius=FORM), friction=0.3)
skirt = world.add_cloth(weft.read_obj(folder / "skirt.obj"), fabric="wool_suiting", position=(0, 0.96, 0), sew=0.002)
print(f"{x.size} vertices of two panels, {skirt.num_particles} particles")
assert skirt.num_particles == x.size - 2 * 16  # two seams
for _ in range(150):
    world.step(1 / 60)

x, y, z = skirt.vertices.T
heights = y.reshape(2, 16, 48).mean(axis=(0, 2))
print(f"waist at {heights[0]:.3f} m, hem at {heights[-1]:.3f} m")
assert 0.85 < heights[0] < 0.95  # where the form is as wide as the waist: 0.912 m
assert 0.2 < heights[0] - heights[-1] < HEM - WAIST
assert np.hypot(np.hypot(x, z), np.maximum(y - 0.8, 0)).min() > FORM
