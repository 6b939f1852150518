"""Snapshots, pickles, copies and saved worlds: each steps on with the same bits."""

from __future__ import annotations

import copy
import multiprocessing
import pickle
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pytest
import weft
from worlds import DT, FEATURES, advance, cloth_of, draped, hanging, meshed, rubbing

BEFORE, AFTER = 14, 6  # steps up to the middle of contact, and from there on


def go_on(world: weft.World) -> str:
    advance(world, AFTER)
    return world.state_hash()


def at_work(feature: str) -> weft.World:
    world = FEATURES[feature]()
    assert all(report.ok for report in advance(world, BEFORE))
    if feature in ("contact", "two cloths", "pair friction", "key frames"):
        assert len(world.contacts) > 0
    return world


@pytest.fixture(scope="module")
def another_process() -> Iterator[ProcessPoolExecutor]:
    with ProcessPoolExecutor(1, mp_context=multiprocessing.get_context("spawn")) as pool:
        yield pool


@pytest.mark.parametrize("feature", FEATURES)
def test_restored_worlds_repeat_their_bits(feature: str) -> None:
    world = at_work(feature)
    saved, before = world.snapshot(), world.state_hash()
    expected = go_on(world)
    assert expected != before
    for _ in range(2):
        world.restore(saved)
        assert world.state_hash() == before
        assert go_on(world) == expected


@pytest.mark.parametrize("feature", FEATURES)
def test_pickles_go_on_in_another_process(feature: str, another_process: ProcessPoolExecutor) -> None:
    world = at_work(feature)
    there = another_process.submit(go_on, world)
    assert there.result() == go_on(world)


@pytest.mark.parametrize("feature", FEATURES)
def test_deep_copies_go_on_by_themselves(feature: str) -> None:
    world = at_work(feature)
    twin, before = copy.deepcopy(world), world.state_hash()
    expected = go_on(world)
    assert twin.state_hash() == before
    assert go_on(twin) == expected


@pytest.mark.parametrize("feature", FEATURES)
def test_saved_worlds_go_on(feature: str, tmp_path: Path) -> None:
    world = at_work(feature)
    file = tmp_path / "world.weft"
    data = world.save(file)
    assert data == file.read_bytes()
    expected = go_on(world)
    assert go_on(weft.World.load(file)) == expected
    assert go_on(weft.World.load(str(file))) == expected
    assert go_on(weft.World.load(data)) == expected
    assert [entry.name for entry in tmp_path.iterdir()] == ["world.weft"]


def test_saved_bytes_are_the_same_again() -> None:
    world = at_work("contact")
    assert weft.World.load(world.save()).save() == world.save()


def test_a_restored_world_has_its_pins_and_targets_again() -> None:
    world = hanging()
    sheet = cloth_of(world)
    corner = sheet.corners[0]
    goal = sheet.positions[corner] + (0, 0.05, 0)
    sheet.set_targets([corner], goal)
    saved = world.snapshot()
    expected = go_on(world)
    sheet.unpin()
    advance(world, 2)
    world.restore(saved)
    assert sheet.pins.tolist() == sheet.corners[:2].tolist()
    assert go_on(world) == expected
    assert sheet.positions[corner] == pytest.approx(goal, abs=1e-7)


def test_a_restored_world_has_its_colliders_where_they_were() -> None:
    world = draped()
    ball = world.colliders[0]
    ball.move_to(translation=(0, 0.01, 0))
    world.step(DT)
    saved, pose = world.snapshot(), ball.pose
    expected = go_on(world)
    ball.place_at(translation=(3, 0, 0))
    world.restore(saved)
    assert ball.pose[0] == pose[0] and np.array_equal(ball.pose[1], pose[1])
    assert go_on(world) == expected


def test_snapshots_are_valid_in_clones_of_their_world() -> None:
    world = at_work("contact")
    saved = world.snapshot()
    twin = world.clone()
    expected = go_on(world)
    advance(twin, 3)
    twin.restore(saved)
    assert go_on(twin) == expected


def test_threads_change_no_bit_and_are_kept_by_copies() -> None:
    world = at_work("contact")
    twin = world.clone()
    twin.threads = 3
    assert copy.deepcopy(twin).threads == 3
    assert pickle.loads(pickle.dumps(twin)).threads == 1
    assert go_on(twin) == go_on(world)


def test_pickled_handles_belong_to_the_pickled_world() -> None:
    world = at_work("contact")
    parts = (world, cloth_of(world), world.colliders[0])
    for copied, sheet, ball in (pickle.loads(pickle.dumps(parts)), copy.deepcopy(parts)):
        assert sheet.world is copied and ball.world is copied and copied is not world
        assert (sheet.name, ball.name) == ("sheet", "ball")
        assert np.array_equal(sheet.positions, cloth_of(world).positions)
        assert sheet in copied and sheet != cloth_of(world)
    loaded = pickle.loads(pickle.dumps(world))
    assert cloth_of(world) not in loaded  # a loaded world's ids are new,
    assert cloth_of(world) in world.clone()  # and a clone accepts the original's


def test_a_loaded_world_has_the_settings_of_the_saved_one() -> None:
    world = rubbing()
    world.contact = weft.ContactSettings(enabled=True, tracks_points=False)
    world.integrator = weft.IntegratorSettings(newton=weft.NewtonSettings(quality="high"))
    world.division = weft.StepDivision(shortest=1e-4)
    world.wind = weft.Wind(velocity=(1, 2, 3), gusts=weft.Gusts(strength=0.5, seed=9))
    loaded = pickle.loads(pickle.dumps(world))
    for name in ("gravity", "contact", "integrator", "division", "wind", "time"):
        assert getattr(loaded, name) == getattr(world, name), name
    assert [cloth.name for cloth in loaded.cloths] == ["lower", "upper"]
    for ours, theirs in zip(world.cloths, loaded.cloths, strict=True):
        assert ours.fabric == theirs.fabric and ours.grid == theirs.grid
        assert np.array_equal(ours.rest, theirs.rest) and np.array_equal(ours.faces, theirs.faces)
        assert np.array_equal(ours.pins, theirs.pins)


def test_a_loaded_mesh_has_its_texture_coordinates() -> None:
    world = meshed()
    loaded = pickle.loads(pickle.dumps(world))
    assert np.array_equal(cloth_of(loaded).uv, cloth_of(world).uv) and cloth_of(loaded).grid is None


VALUES = [
    weft.Fabric(density=0.31, stretch_warp=[(0.01, 20), (0.02, 60)]),
    weft.Springs(structural=12.5, damping_kind="projected"),
    weft.Wind(velocity=(1, 2, 3), keys=[weft.WindKey(time=1, velocity=(0, 1, 0))]),
    weft.IntegratorSettings(integrator="xpbd", xpbd=weft.XpbdSettings(substeps=7)),
    weft.StepDivision(enabled=False),
    weft.ContactSettings(tracks_points=True),
    weft.KeyFrame(time=2, angles_deg=(0, 90, 0)),
    weft.Sphere(center=(1, 2, 3), radius=0.3),
    weft.Plane(normal=(0, 0, 1)),
    weft.Capsule(a=(0, 0, 0), b=(0, 1, 0), radius=0.1),
    weft.Box(half_size=(1, 2, 3)),
    weft.grid(size=(1, 2), cells=(3, 4)),
    weft.KesSheet(weight=12),
]


@pytest.mark.parametrize("value", VALUES, ids=lambda value: type(value).__name__)
def test_plain_values_are_pickled_copied_and_compared(value: object) -> None:
    for twin in (pickle.loads(pickle.dumps(value)), copy.copy(value), copy.deepcopy(value)):
        assert twin is not value and twin == value and repr(twin) == repr(value)
    assert type(value)() != value
    assert eval(repr(value), vars(weft)) == value
    with pytest.raises(TypeError, match="unhashable"):
        hash(value)


def test_cameras_are_pickled() -> None:
    camera = weft.Camera(position=(1, 2, 3), target=(0, 0.5, 0), fov_deg=40, size=(32, 24))
    for twin in (pickle.loads(pickle.dumps(camera)), copy.copy(camera), copy.deepcopy(camera)):
        assert (twin.position, twin.target, twin.fov_deg, twin.size) == ((1, 2, 3), (0, 0.5, 0), 40, (32, 24))


def test_state_hash_is_sixteen_digits_of_time_positions_and_velocities() -> None:
    world = hanging()
    assert len(world.state_hash()) == 16 and int(world.state_hash(), 16) >= 0
    hashes = {world.state_hash()}
    world.step(DT)
    hashes.add(world.state_hash())
    sheet = cloth_of(world)
    velocities = sheet.velocities
    velocities[5, 1] = np.nextafter(np.float32(velocities[5, 1]), np.float32(9))
    sheet.velocities = velocities
    hashes.add(world.state_hash())
    assert len(hashes) == 3
