"""Bending rigidities of a napkin, held in its middle, from a depth picture: 200 runs, by the cross-entropy method."""

import sys

import numpy as np

import weft

folder, num_runs = "".join(sys.argv[1:2]) or "out/drape_fit", int("".join(sys.argv[2:3]) or 200)
camera = weft.Camera(position=(0.4, 0.3, 0.4), target=(0.1, -0.02, 0.1), fov_deg=30, size=(120, 90))


def make_world(case: dict[str, float]) -> weft.World:
    bending = {"bend_warp": case["warp"], "bend_weft": case["weft"], "bend_bias": (case["warp"] * case["weft"]) ** 0.5}
    fabric = weft.find_fabric("cotton_shirting")._replace(**bending)
    world = weft.World(contact=False, integrator="implicit_euler")  # its damping brings the napkin to rest
    napkin = world.add_cloth(weft.grid(size=(0.2, 0.2), cells=(14, 14)), fabric=fabric)
    napkin.pin(np.abs(napkin.positions[:, [0, 2]] - 0.1).max(axis=1) < 0.03)
    return world


world = make_world({"warp": 30e-6, "weft": 12e-6})  # its picture stands for a measured one
for _ in range(30): world.step(1 / 20)  # fmt: skip
photo = camera.render(world, color=False).depth.clip(max=1)
random, mean, deviation = np.random.default_rng(1), np.log([20e-6, 20e-6]), 0.6
with weft.farm.local() as client:
    for _ in range(10):
        tries = mean + deviation * random.standard_normal((num_runs // 10, 2))
        cases = [{"warp": a, "weft": b} for a, b in np.exp(tries)]
        table = weft.farm.run(
            make_world, cases, seconds=1.5, dt=1 / 20, out=folder, client=client, progress=False,
            measure=lambda world: {"miss": np.abs(camera.render(world, color=False).depth.clip(max=1) - photo).mean()},
        )  # fmt: skip
        best = tries[np.argsort(table["miss"])[: max(2, num_runs // 50)]]
        mean, deviation = best.mean(axis=0), best.std(axis=0).max() + 0.001
fit = 1e6 * np.exp(mean)
print(f"bending rigidities: {fit[0]:.2f} and {fit[1]:.2f} µN·m by {num_runs} runs; 30 and 12 in the picture")
assert num_runs < 200 or np.abs(fit / (30, 12) - 1).max() < 0.05
