"""A napkin drapes over a ball. Contact forces bear its weight, and nothing is inside the ball."""

import numpy as np

import weft

world = weft.World()
napkin = world.add_cloth(
    weft.grid(size=(0.6, 0.6), cells=(32, 32)), fabric="cotton_shirting", position=(-0.3, 0.21, -0.3)
)
ball = world.add_collider(weft.Sphere(radius=0.2), friction=0.5, name="ball")

borne = []  # vertical force of the ball on the napkin [N]
for _ in range(180):
    world.step(1 / 60)
    contacts = world.contacts
    on_ball = contacts["collider"] == world.colliders.index(ball)
    borne.append(contacts["force"][on_ball, 1].sum())

weight = 9.81 * napkin.masses.sum()
mean = np.mean(borne[-60:])
print(f"the ball bears {mean:.4f} N of a weight of {weight:.4f} N")
assert abs(mean - weight) < 0.05 * weight

clearance = np.linalg.norm(napkin.positions, axis=1).min() - 0.2
print(f"the closest particle is {1000 * clearance:.3f} mm above the ball")
assert clearance > 0
