"""The bending rigidity of a fabric from its measured droop, by SciPy, and by Peirce's formula.

A strip that overhangs an edge droops by its weight. Where the line from the edge to its end slopes by 41.5°, the bending
rigidity is the weight per area times the cube of half the overhang (Peirce 1930).
"""

import numpy as np
from scipy.optimize import brentq  # type: ignore[import-untyped,unused-ignore]

import weft

OVERHANG, SLOPE = 0.102, 41.5  # measured [m], [degrees]
CELL = 0.004  # [m]; the edge is in the middle of the first cell, both ends of which are held


def slope(rigidity: float) -> float:
    """The slope of a strip at rest [degrees], for a bending rigidity [N·m]."""
    fabric = weft.find_fabric("cotton_shirting")._replace(bend_warp=rigidity, bend_weft=rigidity, bend_bias=rigidity)
    world = weft.World(contact=False, integrator="implicit_euler")  # its damping brings the strip to rest
    strip = world.add_cloth(weft.grid(size=(OVERHANG + CELL / 2, 0.02), cells=(26, 5)), fabric=fabric, warp=(1, 0, 0))
    column = np.arange(strip.num_particles) % 27
    strip.pin(column < 2)
    for _ in range(60):
        world.step(1 / 20)
    assert np.abs(strip.velocities).max() < 1e-3
    x, y, _ = strip.positions[column == 26].mean(axis=0)
    return float(np.degrees(np.arctan2(-y, x - CELL / 2)))


fitted = brentq(lambda rigidity: slope(rigidity) - SLOPE, 1e-5, 1e-3, xtol=1e-6)
peirce = 9.81 * weft.find_fabric("cotton_shirting").density * (OVERHANG / 2) ** 3
print(f"bending rigidity: {1e6 * fitted:.1f} µN·m by the fit, {1e6 * peirce:.1f} µN·m by Peirce's formula")
assert abs(fitted / peirce - 1) < 0.05
