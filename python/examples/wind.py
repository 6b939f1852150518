"""A banner in the wind: the drag of a plate at first; then it streams, and its pins hold it against the wind."""

import numpy as np

import weft

SPEED, AIR, DRAG = 3.0, 1.2, 1.2  # [m/s], [kg/m³], [1]
world = weft.World(contact=False)
world.wind = weft.Wind(velocity=(0, 0, SPEED), air=weft.Air(density=AIR, drag=DRAG))
banner = world.add_cloth(weft.grid(size=(0.6, 1), cells=(24, 40)), fabric="silk", rotation=(90, 0, 0))
banner.pin(np.arange(25))

push = banner.force("wind").sum(axis=0)[2]
plate = 0.5 * AIR * DRAG * 0.6 * SPEED**2
print(f"the wind pushes with {push:.4f} N; half of density, drag, area and speed squared is {plate:.4f} N")
assert abs(push - plate) < 1e-4 * plate

wind, pins = [], []  # horizontal forces [N]
for step in range(960):  # short steps: silk in wind is light for the forces on it
    world.step(1 / 240)
    if step >= 480:
        wind.append(banner.force("wind")[:, 2].sum())
        pins.append(banner.pin_forces[:, 2].sum())

_, y, z = banner.center_of_mass
angle = np.degrees(np.arctan2(z, -y))
print(f"it streams at {angle:.0f}° from the vertical; wind {np.mean(wind):.3f} N, pins {np.mean(pins):.3f} N")
assert 60 < angle < 90
assert abs(np.mean(wind) + np.mean(pins)) < 0.05 * np.mean(wind)
