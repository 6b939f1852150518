"""A square metre of cotton hangs by its upper edge, and its pins hold its weight."""

import numpy as np

import weft

world = weft.World()
# Turned upright: the first row of particles is the upper edge.
sheet = world.add_cloth(weft.grid(size=(1, 1), cells=(32, 32)), fabric="cotton_shirting", rotation=(90, 0, 0))
sheet.pin(np.arange(33))

held = []  # vertical force of all pins [N]
for _ in range(180):
    world.step(1 / 60)
    held.append(sheet.pin_forces[:, 1].sum())

weight = 9.81 * sheet.masses.sum()
mean = np.mean(held[-60:])
print(f"the pins hold {mean:.4f} N of a weight of {weight:.4f} N")
assert abs(mean - weight) < 0.01 * weight

below = -sheet.positions[:, 1].min()
sag = weight / 2 / 2800  # half the weight is below the middle; 2800 N/m along warp, 1400 N/m along weft
print(f"the lower edge hangs {1000 * (below - 1):.2f} mm lower than at rest length")
assert 0.9 * sag < below - 1 < 2.2 * sag
