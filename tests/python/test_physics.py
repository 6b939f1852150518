"""Forces, momentum, weight and friction as numbers, read from Python."""

from __future__ import annotations

import numpy as np
import pytest
import weft
from worlds import DT, advance, cloth_of, draped, sprung

GRAVITY = 9.81
KINDS: tuple[weft._world.ForceKind, ...] = ("gravity", "elastic", "damping", "wind", "external", "contact")


def weight(cloth: weft.Cloth) -> float:
    return float(cloth.masses.sum()) * GRAVITY


def one_step(world: weft.World, h: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Forces before a step of `explicit`, m Δv/h of it, and what rounding of float32 velocities does to that."""
    cloth = cloth_of(world)
    forces, before, masses = cloth.forces, cloth.velocities, cloth.masses[:, None]
    world.step(h)
    after = cloth.velocities
    rounding = masses * np.spacing(np.maximum(abs(before), abs(after)).astype(np.float32)) / h
    return forces, masses * (after - before) / h, rounding


@pytest.mark.parametrize("feature", ["springs", "wind", "external"])
def test_explicit_forces_are_mass_times_change_of_velocity(feature: str) -> None:
    world = sprung(10, integrator="explicit")
    world.integrator = weft.IntegratorSettings(
        integrator="explicit", explicit_euler=weft.ExplicitSettings(substeps=1)
    )
    cloth = cloth_of(world)
    random = np.random.default_rng(3)
    if feature == "wind":
        world.wind = weft.Wind(velocity=(1, 0, 2), drag=0.3)
    if feature == "external":
        cloth.set_forces(random.uniform(-0.01, 0.01, (len(cloth), 3)))
    h = 1e-4
    advance(world, 300, h)
    cloth.velocities = cloth.velocities + random.uniform(-0.1, 0.1, (len(cloth), 3))
    forces, changes, rounding = one_step(world, h)
    free = np.ones(len(cloth), bool)
    free[cloth.pins] = False
    # Elastic forces are differences of float32 positions, times a stiffness of 300 N/m per particle.
    tolerance = 2 * rounding + 4 * 300 * np.spacing(np.float32(1))
    assert (abs(forces - changes)[free] <= tolerance[free]).all()
    assert abs(forces[free]).max() > 50 * tolerance.max()
    # Internal forces cancel: the sum over a cloth without pins is that of gravity, wind and the given forces.
    outside = sum(cloth.force(kind) for kind in KINDS if kind not in ("elastic", "damping"))
    assert abs(cloth.forces.sum(0) - np.sum(outside, axis=0)).max() < 1e-9


def test_forces_of_all_kinds_sum_to_forces() -> None:
    world = sprung(8)
    cloth = cloth_of(world)
    world.wind = weft.Wind(velocity=(1, 0, 2), drag=0.3)
    cloth.set_forces((0, 0, 0.01))
    world.add_collider(weft.Sphere(center=(0.5, -0.12, 0.5), radius=0.1))
    advance(world, 10, 1 / 600)
    parts = [cloth.force(kind) for kind in KINDS]
    assert abs(np.sum(parts, axis=0) - cloth.forces).max() < 1e-12
    assert np.array_equal(parts[KINDS.index("external")], np.tile([0, 0, 0.01], (len(cloth), 1)))
    assert np.allclose(parts[0], cloth.masses[:, None] * (0, -GRAVITY, 0))


def test_momentum_of_free_fall() -> None:
    world = weft.World()
    sheet = world.add_cloth(weft.grid(cells=(8, 8)))
    advance(world, 30)
    assert world.time == pytest.approx(0.5)
    assert sheet.momentum == pytest.approx((0, -weight(sheet) * 0.5, 0), abs=1e-6)
    assert sheet.center_of_mass == pytest.approx((0.5, -GRAVITY * 0.5**2 / 2, 0.5), abs=1e-5)  # second order


@pytest.mark.parametrize("integrator", ["newton", "implicit_euler"])
def test_pins_of_a_sheet_at_rest_hold_its_weight(integrator: str) -> None:
    world = weft.World(integrator=integrator)
    sheet = world.add_cloth(weft.grid(cells=(12, 12)), rotation=(90, 0, 0))
    sheet.pin(sheet.corners[:2])
    world.wind = weft.Wind(drag=0.5)
    advance(world, 120)
    world.wind = weft.Wind()
    advance(world, 60)
    second = []
    for _ in range(60):
        world.step(DT)
        second.append(sheet.pin_forces)
    held = np.mean(second, axis=0)
    assert held.sum(0) == pytest.approx((0, weight(sheet), 0), abs=0.01 * weight(sheet))
    assert held[:, 1] == pytest.approx(weight(sheet) / 2, rel=0.01)  # each corner half
    assert held[0, 0] == pytest.approx(-held[1, 0], rel=0.01) and held[0, 0] < 0  # they pull outwards


def slide(share: float) -> tuple[float, float, float]:
    """Ways of a board, accelerated at this share of µg, of a cloth on it, and of a body that slips throughout [m]."""
    friction, h, steps = 0.5, 1 / 120, 60
    world = weft.World()
    sheet = world.add_cloth(weft.grid(size=(0.3, 0.3), cells=(10, 10)), position=(-0.15, 0.0015, -0.15))
    board = world.add_collider(weft.Box(center=(0, -0.1, 0), half_size=(3, 0.1, 0.5)), friction=friction)
    advance(world, 30, h)
    start, limit = sheet.center_of_mass[0], friction * GRAVITY
    for k in range(1, steps + 1):
        board.move_to(translation=(share * limit * (k * h) ** 2 / 2, 0, 0))
        world.step(h)
    half_of_square = (steps * h) ** 2 / 2
    return share * limit * half_of_square, sheet.center_of_mass[0] - start, limit * half_of_square


@pytest.mark.parametrize("share", [0.5, 0.8])
def test_a_board_below_the_limit_of_friction_carries_cloth_along(share: float) -> None:
    board, cloth, _ = slide(share)
    assert cloth == pytest.approx(board, rel=0.01)


@pytest.mark.parametrize("share", [1.5, 3.0])
def test_cloth_slips_on_a_board_above_the_limit_of_friction(share: float) -> None:
    board, cloth, slipping = slide(share)
    assert cloth < 0.8 * board
    assert cloth == pytest.approx(slipping, rel=0.02)


def test_contact_forces_of_cloth_at_rest_on_a_plane_sum_to_its_weight() -> None:
    world = weft.World()
    sheet = world.add_cloth(weft.grid(size=(0.4, 0.4), cells=(10, 10)), position=(0, 0.0015, 0))
    world.add_collider(weft.Plane())
    advance(world, 120)
    sums = []
    for _ in range(60):
        world.step(DT)
        contacts = world.contacts
        sums.append(contacts["force"].sum(0))
        assert sheet.force("contact").sum(0) == pytest.approx(contacts["force"].sum(0), abs=1e-5 * weight(sheet))
    assert np.mean(sums, axis=0) == pytest.approx((0, weight(sheet), 0), abs=0.01 * weight(sheet))
    assert len(contacts) == len(sheet)  # every particle lies on it
    assert contacts["normal"] == pytest.approx(np.tile([0, 1, 0], (len(sheet), 1)))


def test_energies_of_a_falling_sheet() -> None:
    world = weft.World()
    sheet = world.add_cloth(weft.grid(cells=(8, 8)), position=(0, 2, 0))
    mass = sheet.masses.sum()
    assert world.energies["gravitational"] == pytest.approx(mass * GRAVITY * 2)
    advance(world, 30)
    assert world.energies["kinetic"] == pytest.approx(mass * (GRAVITY * 0.5) ** 2 / 2, rel=1e-5)


def test_masses_are_density_times_area() -> None:
    world = weft.World()
    sheet = world.add_cloth(weft.grid(size=(2, 0.5), cells=(8, 4)), fabric=weft.Fabric(density=0.3))
    assert sheet.masses.sum() == pytest.approx(0.3)
    assert sheet.masses[sheet.corners] == pytest.approx(0.3 / 32 / 4, rel=0.5)


def test_forces_from_outside_accelerate() -> None:
    world = weft.World(gravity=(0, 0, 0), integrator="implicit_euler")
    sheet = world.add_cloth(weft.grid(cells=(6, 6)))
    sheet.set_forces(sheet.masses[:, None] * (0.0, 0.0, 2.0))
    advance(world, 60)
    assert sheet.velocities == pytest.approx(np.tile([0, 0, 2], (len(sheet), 1)), abs=1e-4)
    sheet.set_forces(None)
    advance(world, 10)
    assert sheet.velocities == pytest.approx(np.tile([0, 0, 2], (len(sheet), 1)), abs=1e-4)


def test_soft_pins_sag_by_weight_over_stiffness() -> None:
    world = weft.World()
    sheet = world.add_cloth(weft.grid(size=(0.3, 0.3), cells=(4, 4)))
    sheet.pin(np.ones(len(sheet), bool), stiffness=20, damping=0.5)
    advance(world, 120)
    sag = sheet.rest[:, 1].mean() - sheet.positions[:, 1].mean()
    assert sag == pytest.approx(weight(sheet) / (20 * len(sheet)), rel=0.02)


def test_targets_of_pins_are_reached_at_the_end_of_the_step() -> None:
    world = weft.World()
    sheet = world.add_cloth(weft.grid(cells=(8, 8)))
    sheet.pin(sheet.corners[:2])
    goals = sheet.positions[sheet.corners[:2]] + [(0.01, 0.02, 0), (0, 0.02, 0.01)]
    sheet.set_targets(sheet.corners[:2], goals)
    world.step(DT)
    assert sheet.positions[sheet.corners[:2]] == pytest.approx(goals, abs=1e-7)
    world.step(DT)
    assert sheet.positions[sheet.corners[:2]] == pytest.approx(goals, abs=1e-7)


def test_a_moved_collider_is_at_its_pose_at_the_end_of_the_step() -> None:
    world = weft.World()
    ball = world.add_collider(weft.Sphere(radius=0.2), name="ball")
    ball.move_to(translation=(0, 0.1, 0), rotation=(0, 0, 90))
    assert ball.pose[0] == (0, 0, 0)
    world.step(DT)
    translation, rotation = ball.pose
    assert translation == pytest.approx((0, 0.1, 0))
    assert rotation == pytest.approx(np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]), abs=1e-12)


def test_rays_and_closest_points_find_the_cloth() -> None:
    world = weft.World()
    sheet = world.add_cloth(weft.grid(cells=(8, 8)), name="sheet")
    hit = world.cast_ray((0.3, 1, 0.4), (0, -2, 0))
    assert hit is not None and hit.cloth == sheet
    assert hit.position == pytest.approx((0.3, 0, 0.4)) and hit.distance == pytest.approx(1)
    corners = sheet.positions[sheet.faces[hit.triangle]]
    assert np.asarray(hit.weights) @ corners == pytest.approx(hit.position)
    assert world.cast_ray((0.3, 1, 0.4), (0, 1, 0)) is None
    near = world.closest_point((1.5, 0, 0.5))
    assert near is not None and near.distance == pytest.approx(0.5) and near.position == pytest.approx((1, 0, 0.5))
    assert world.closest_point((1.5, 0, 0.5), 0.4) is None


def test_problems_of_a_world_as_it_is() -> None:
    world = draped()
    world.contact = False
    assert world.find_problems() == []
    advance(world, 15)
    (inside,) = (p for p in world.find_problems() if p.code == "penetration")
    assert inside.collider == 0
    assert inside.value > 1e-3
    assert 'inside collider "ball"' in world.describe(inside)
    assert world.describe(inside).endswith("set solver.contact = true")
