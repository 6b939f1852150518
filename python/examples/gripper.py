"""A gripper of two jaws takes a towel off a rail. Only friction holds the towel."""

import numpy as np

import weft

JAW = 0.01  # half the thickness of a jaw [m]
world = weft.World()
rail = world.add_collider(weft.Capsule(a=(0, 0.5, -0.3), b=(0, 0.5, 0.3), radius=0.01), name="rail")
towel = world.add_cloth(weft.grid(size=(0.5, 0.3), cells=(40, 24)), position=(-0.25, 0.512, -0.15))
jaw = weft.Box(half_size=(JAW, 0.03, 0.1))
left = world.add_collider(jaw, position=(-0.3, 0.4, 0), friction=1)
right = world.add_collider(jaw, position=(0.3, 0.4, 0), friction=1)

borne = []  # vertical force of the jaws on the towel [N]
for frame in range(1, 271):
    time = frame / 60
    gap = JAW + np.interp(time, [1, 2], [0.29, 0.0005])  # closed, less than two layers of the towel
    height = 0.4 + np.interp(time, [2.5, 3.5], [0, 0.3])
    left.move_to(translation=(-gap, height, 0))
    right.move_to(translation=(gap, height, 0))
    rail.move_to(translation=(0, 0, np.interp(time, [2, 2.5], [0, 0.8])))  # pulled out sideways
    world.step(1 / 60)
    contacts = world.contacts
    borne.append(contacts["force"][contacts["collider"] >= 0, 1].sum())  # its layers also press each other

weight = 9.81 * towel.masses.sum()
mean = np.mean(borne[-60:])  # of the last second: single steps vary by a quarter
print(f"the towel hangs at {towel.center_of_mass[1]:.3f} m; the jaws bear {mean:.3f} N of its {weight:.3f} N")
assert towel.center_of_mass[1] > 0.6
assert abs(mean - weight) < 0.1 * weight
