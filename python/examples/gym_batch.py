"""Sixteen worlds as one environment of Gymnasium's form: two hands carry a towel to a goal."""

import numpy as np
from numpy.typing import NDArray

import weft

Array = NDArray[np.floating]
HANDS = [0, 12]  # the particles that they hold
world = weft.World()
world.add_cloth(weft.grid(size=(0.3, 0.4), cells=(12, 16)), name="towel", rotation=(90, 0, 0)).pin(HANDS)


class CarryTowel:
    def __init__(self, num_worlds: int) -> None:
        self.batch, self.steps = weft.Batch(lambda index: world, num_worlds), np.zeros(num_worlds, int)
        self.obs = self.batch.positions["towel"]  # (worlds, 221, 3), filled by every step
        self.goals = np.random.default_rng(1).uniform(-0.4, 0.4, (num_worlds, 3))

    def reset(self, worlds: NDArray[np.bool_]) -> tuple[Array, dict[str, Array]]:
        self.batch.reset(worlds)
        self.steps[worlds] = 0
        return self.obs, {}

    def step(self, action: Array) -> tuple[Array, Array, NDArray[np.bool_], NDArray[np.bool_], dict[str, Array]]:
        self.batch.step(1 / 30, targets={"towel": (HANDS, self.obs[:, HANDS] + np.clip(action, -0.05, 0.05))})
        self.steps += 1
        distance = np.linalg.norm(self.obs.mean(axis=1) - self.goals, axis=1)
        return self.obs, -distance, distance < 0.05, self.steps >= 60, {}


env, arrivals = CarryTowel(16), np.zeros(16, int)
for _ in range(120):
    obs, reward, terminated, truncated, info = env.step(0.1 * (env.goals - env.obs.mean(axis=1))[:, None])
    arrivals += terminated
    env.reset(terminated | truncated)
    assert (obs[terminated] == world.cloths[0].positions.astype(np.float32)).all()  # back at the start, bit by bit
print(f"{arrivals.sum()} arrivals, at least {arrivals.min()} in each world")
assert arrivals.min() >= 1
