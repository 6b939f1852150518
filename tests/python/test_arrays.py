"""Arrays: what is set is what is read, new arrays are the caller's, and views never point to freed memory."""

from __future__ import annotations

import gc
import threading
from collections.abc import Callable

import numpy as np
import pytest
import weft
from worlds import DT, advance, cloth_of, draped, hanging, meshed, sprung


def sheet_of(world: weft.World) -> weft.Cloth:
    return cloth_of(world, "sheet")


def recomposed(cloth: weft.Cloth) -> np.ndarray:
    """Positions from the two parts that the engine stores."""
    return np.array(cloth.origin) + cloth.offsets.astype(np.float64)


def address(array: np.ndarray) -> int:
    return int(array.__array_interface__["data"][0])


def test_positions_are_origin_plus_offsets_bit_by_bit() -> None:
    world = draped()
    advance(world, 10)
    sheet = sheet_of(world)
    assert np.array_equal(sheet.positions, recomposed(sheet))


def test_positions_set_are_positions_read_within_the_rounding_of_float32_offsets() -> None:
    world = hanging()
    sheet = sheet_of(world)
    given = sheet.positions + np.random.default_rng(1).uniform(-0.01, 0.01, (len(sheet), 3)) + (7.3, -2.1, 0.4)
    sheet.positions = given
    origin = np.array(sheet.origin)
    assert np.array_equal(sheet.offsets, (given - origin).astype(np.float32))
    assert np.array_equal(sheet.positions, origin + (given - origin).astype(np.float32))


def test_positions_read_and_set_again_are_the_same_bits() -> None:
    world = draped()
    world.integrator = "implicit_euler"  # type: ignore[assignment]  # the hash of newton has the step before
    advance(world, 10)
    sheet = sheet_of(world)
    positions, velocities, before = sheet.positions, sheet.velocities, world.state_hash()
    for _ in range(2):
        sheet.positions = sheet.positions
        sheet.velocities = sheet.velocities
        assert world.state_hash() == before
    assert np.array_equal(sheet.positions, positions) and np.array_equal(sheet.velocities, velocities)


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_velocities_set_are_velocities_read(kind: type) -> None:
    sheet = sheet_of(hanging())
    given = np.random.default_rng(2).uniform(-1, 1, (len(sheet), 3)).astype(kind)
    sheet.velocities = given
    free = np.ones(len(sheet), bool)
    free[sheet.pins] = False
    assert np.array_equal(sheet.velocities[free], given.astype(np.float32).astype(np.float64)[free])


def test_one_velocity_stands_for_all() -> None:
    world = weft.World()
    sheet = world.add_cloth(weft.grid(cells=(4, 4)))
    sheet.velocities = (0.5, 0.25, -2)
    assert np.array_equal(sheet.velocities, np.tile([0.5, 0.25, -2], (25, 1)))


def test_setting_positions_leaves_velocities() -> None:
    world = hanging()
    advance(world, 5)
    sheet = sheet_of(world)
    before = sheet.velocities
    sheet.positions = sheet.positions + (0, 1, 0)
    assert np.array_equal(sheet.velocities, before)


@pytest.mark.parametrize(
    "given",
    [
        lambda x: x.tolist(),
        lambda x: x.astype(np.float32),
        lambda x: np.asfortranarray(x),
        lambda x: np.ascontiguousarray(x[::-1])[::-1],
        lambda x: x.astype(">f8"),
    ],
    ids=["lists", "float32", "Fortran order", "negative stride", "big endian"],
)
def test_everything_that_asarray_takes_is_taken(given: Callable[[np.ndarray], object]) -> None:
    sheet = sheet_of(hanging())
    target = np.round(sheet.positions * 64) / 64 + (0, 0.25, 0)  # the same number in float32 and float64
    sheet.positions = given(target)  # type: ignore[assignment]
    assert np.array_equal(sheet.positions, target)


SHAPES: dict[str, tuple[Callable[[weft.Cloth], np.ndarray], Callable[[weft.Cloth], tuple[int, ...]], str]] = {
    "positions": (lambda c: c.positions, lambda c: (len(c), 3), "f8"),
    "velocities": (lambda c: c.velocities, lambda c: (len(c), 3), "f8"),
    "normals": (lambda c: c.normals, lambda c: (len(c), 3), "f8"),
    "vertices": (lambda c: c.vertices, lambda c: (81, 3), "f8"),
    "offsets": (lambda c: c.offsets, lambda c: (len(c), 3), "f4"),
    "rest": (lambda c: c.rest, lambda c: (len(c), 3), "f8"),
    "faces": (lambda c: c.faces, lambda c: (128, 3), "i4"),
    "uv": (lambda c: c.uv, lambda c: (128, 3, 2), "f8"),
    "masses": (lambda c: c.masses, lambda c: (len(c),), "f8"),
    "forces": (lambda c: c.forces, lambda c: (len(c), 3), "f8"),
    "force": (lambda c: c.force("gravity"), lambda c: (len(c), 3), "f8"),
    "pins": (lambda c: c.pins, lambda c: (9,), "i4"),
    "pin_forces": (lambda c: c.pin_forces, lambda c: (9, 3), "f8"),
    "stretches": (lambda c: c.stretches, lambda c: (128, 2), "f8"),
    "spring_strains": (lambda c: c.spring_strains, lambda c: c.spring_strains.shape[:1], "f8"),
    "particle_of_vertex": (lambda c: c.particle_of_vertex, lambda c: (81,), "i4"),
}


@pytest.mark.parametrize("name", SHAPES)
def test_shape_and_type(name: str) -> None:
    world = meshed()
    world.step(DT)
    cloth = cloth_of(world)
    read, shape, kind = SHAPES[name]
    array = read(cloth)
    assert isinstance(array, np.ndarray)
    assert (array.shape, array.dtype) == (shape(cloth), np.dtype(kind))


def test_fields_of_strain_and_contacts() -> None:
    world = draped()
    advance(world, 12)
    sheet = sheet_of(world)
    strain, contacts = sheet.strain, world.contacts
    assert strain.shape == (len(sheet.faces),)
    assert strain.dtype.names == ("warp", "weft", "shear", "min_stretch", "max_stretch")
    assert np.array_equal(np.stack([strain["min_stretch"], strain["max_stretch"]], axis=1), sheet.stretches)
    assert (strain["min_stretch"] <= strain["max_stretch"]).all()
    assert len(contacts) > 0
    fields = ("position", "normal", "force", "cloth", "particle", "other_cloth", "collider", "other_vertex")
    assert contacts.dtype.names is not None and contacts.dtype.names[: len(fields)] == fields
    assert contacts["force"].shape == (len(contacts), 3)
    assert set(contacts["cloth"]) == {0} and set(contacts["collider"]) == {0} and set(contacts["other_cloth"]) == {-1}
    assert np.allclose(np.linalg.norm(contacts["normal"], axis=1), 1, atol=1e-6)


def test_springs_have_one_strain_each() -> None:
    world = sprung(4)
    strains = cloth_of(world).spring_strains
    assert strains.ndim == 1 and len(strains) > 0 and abs(strains).max() < 1e-5  # float32 positions at rest


@pytest.mark.parametrize("name", [name for name in SHAPES if name not in ("offsets", "faces", "rest", "uv")])
def test_new_arrays_are_the_callers(name: str) -> None:
    world = meshed()
    world.step(DT)
    cloth, read = cloth_of(world), SHAPES[name][0]
    array, other, before = read(cloth), read(cloth), world.state_hash()
    assert not np.shares_memory(array, other) or array.size == 0
    array += 1
    assert np.array_equal(read(cloth), other)
    assert world.state_hash() == before


@pytest.mark.parametrize("name", ["faces", "rest", "uv", "offsets"])
def test_constant_arrays_and_views_are_read_only(name: str) -> None:
    array = SHAPES[name][0](cloth_of(meshed()))
    with pytest.raises(ValueError, match="read-only"):
        array[0] = 0


def test_a_new_array_stays_after_steps_and_the_worlds_end() -> None:
    world = draped()
    kept = sheet_of(world).positions
    copy = kept.copy()
    advance(world, 5)
    del world
    gc.collect()
    assert np.array_equal(kept, copy)


@pytest.mark.parametrize("kind", [np.float32, np.float64])
def test_copies_into_own_arrays(kind: type) -> None:
    world = draped()
    advance(world, 10)
    sheet = sheet_of(world)
    out = np.full((len(sheet), 3), np.nan, kind)
    sheet.copy_positions(out)
    assert np.array_equal(out, sheet.positions.astype(kind))
    sheet.copy_velocities(out)
    assert np.array_equal(out, sheet.velocities.astype(kind))


def test_copies_into_a_part_of_an_own_array() -> None:
    sheet = sheet_of(hanging())
    frames = np.zeros((3, len(sheet), 3), np.float32)
    sheet.copy_positions(frames[1])
    assert np.array_equal(frames[1], sheet.positions.astype(np.float32))
    assert not frames[0].any() and not frames[2].any()


WRONG_OUTPUTS: dict[str, Callable[[int], object]] = {
    "a list": lambda n: [[0.0, 0.0, 0.0]] * n,
    "integers": lambda n: np.zeros((n, 3), np.int32),
    "float16": lambda n: np.zeros((n, 3), np.float16),
    "big endian": lambda n: np.zeros((n, 3), ">f8"),
    "too few": lambda n: np.zeros((n - 1, 3)),
    "too many": lambda n: np.zeros((n + 1, 3)),
    "flat": lambda n: np.zeros(3 * n),
    "Fortran order": lambda n: np.zeros((3, n)).T,
    "strided": lambda n: np.zeros((n, 6))[:, ::2],
    "read-only": lambda n: np.broadcast_to(np.zeros((1, 3)), (n, 3)),
}


@pytest.mark.parametrize("name", WRONG_OUTPUTS)
def test_wrong_outputs_are_refused_and_stay_as_they_are(name: str) -> None:
    sheet = sheet_of(hanging())
    out = WRONG_OUTPUTS[name](len(sheet))
    for copy in (sheet.copy_positions, sheet.copy_velocities):
        with pytest.raises(weft.InputError, match="^out: expected "):
            copy(out)  # type: ignore[arg-type]
    assert not np.any(out)


# The view.


def test_offsets_are_a_view_of_one_allocation() -> None:
    sheet = sheet_of(hanging())
    view = sheet.offsets
    n = len(sheet)
    assert view.dtype == np.float32 and not view.flags.writeable and not view.flags.owndata
    assert view.strides[0] == 4 and view.strides[1] % 4 == 0 and view.strides[1] >= 4 * n
    assert address(view) == address(sheet.offsets)
    with pytest.raises(ValueError):
        view.flags.writeable = True


def test_offsets_show_the_newest_state_in_place() -> None:
    world = draped()
    sheet = sheet_of(world)
    view = sheet.offsets
    saved, place = world.snapshot(), address(view)

    def check(changes: bool = True) -> None:
        nonlocal last
        assert address(sheet.offsets) == place
        assert np.array_equal(np.array(sheet.origin) + view.astype(np.float64), sheet.positions)
        assert changes != np.array_equal(sheet.positions, last)
        last = sheet.positions

    last = sheet.positions
    for _ in range(5):
        world.step(DT)
        check()
    sheet.positions = sheet.positions + (0, 0.125, 0)
    check()
    sheet.teleport(translation=(4, 0, 0), rotation=(0, 90, 0))
    check()
    sheet.velocities = (0, 1, 0)
    check(changes=False)
    world.restore(saved)
    check()
    other = world.add_cloth(weft.grid(cells=(40, 40)), position=(0, 5, 0), name="other")
    world.step(DT)
    check()
    world.remove(other)
    world.step(DT)
    check()


def test_offsets_stay_readable_after_removal() -> None:
    world = draped()
    advance(world, 10)
    sheet = sheet_of(world)
    view, before = sheet.offsets, sheet.offsets.copy()
    world.remove(sheet)
    others = [world.add_cloth(weft.grid(cells=(12, 12)), position=(0, 2 + k, 0)) for k in range(4)]
    advance(world, 3)
    assert np.array_equal(view, before)
    assert all(np.isfinite(other.offsets).all() for other in others)


def test_offsets_keep_their_world_alive() -> None:
    world = draped()
    advance(world, 10)
    view, before = sheet_of(world).offsets, sheet_of(world).offsets.copy()
    part = view[3:50:2, 1]
    del world
    gc.collect()
    blocks = [np.full_like(before, 7) for _ in range(50)]  # would take freed memory of this size
    assert np.array_equal(view, before)
    del view
    gc.collect()
    assert np.array_equal(part, before[3:50:2, 1])
    assert len(blocks) == 50


def test_offsets_outlive_the_thread_that_made_their_world() -> None:
    found: list[tuple[np.ndarray, np.ndarray]] = []

    def work() -> None:
        world = draped(threads=2)
        advance(world, 5)
        view = sheet_of(world).offsets
        found.append((view, view.copy()))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    gc.collect()
    view, before = found[0]
    assert np.array_equal(view, before)


def test_offsets_of_a_batch_outlive_the_batch() -> None:
    batch = weft.Batch(lambda i: draped(6), 3)
    batch.step(DT)
    view = sheet_of(batch[1]).offsets
    before = view.copy()
    del batch
    gc.collect()
    assert np.array_equal(view, before)


def test_offsets_of_a_clone_are_its_own() -> None:
    world = draped()
    twin = world.clone()
    view, other = sheet_of(world).offsets, sheet_of(twin).offsets
    before = other.copy()
    advance(world, 5)
    assert not np.shares_memory(view, other)
    assert np.array_equal(other, before) and not np.array_equal(view, before)


def test_cloth_at_ten_kilometres_reads_right_in_float64() -> None:
    world = weft.World(gravity=(0, 0, 0))
    far = (10_000.0, 2.5, -10_000.0)
    sheet = world.add_cloth(weft.grid(cells=(7, 9)), position=far)
    expected = sheet.rest + far
    assert abs(sheet.positions - expected).max() < 1e-7
    single = np.empty((len(sheet), 3), np.float32)
    sheet.copy_positions(single)
    lost = abs(single - sheet.positions).max()
    assert 1e-5 < lost <= np.spacing(np.float32(10_000)) / 2  # what float32 loses there: half a millimetre
    sheet.positions = expected + (0.001, 0, 0)
    assert abs(sheet.positions - expected - (0.001, 0, 0)).max() < 1e-7
    assert np.ptp(sheet.offsets, axis=0) == pytest.approx(np.ptp(sheet.rest, axis=0), abs=1e-7)


def test_far_cloth_moves_as_near_cloth() -> None:
    def deform(position: tuple[float, float, float]) -> np.ndarray:
        world = weft.World()
        sheet = world.add_cloth(weft.grid(cells=(8, 8)), position=position)
        sheet.pin(sheet.corners[:2])
        advance(world, 10)
        return sheet.positions - np.array(position)

    assert abs(deform((8192, 0, -8192)) - deform((0, 0, 0))).max() < 1e-5


# Indices and masks.


@pytest.mark.parametrize(
    ("chosen", "expected"),
    [
        (0, [0]),
        (-1, [24]),
        (np.int64(3), [3]),
        ([0, -1], [0, 24]),
        ([-25], [0]),
        (np.array([4, 2], np.uint8), [4, 2]),
        (range(3), [0, 1, 2]),
        (np.arange(25) % 12 == 0, [0, 12, 24]),
        ([index == 7 for index in range(25)], [7]),
        ([], []),
        (np.zeros(25, bool), []),
    ],
    ids=["one", "from the end", "NumPy's integer", "list", "first from the end", "uint8", "range", "mask",
         "list of bools", "none", "empty mask"],
)  # fmt: skip
def test_indices_follow_numpy(chosen: object, expected: list[int]) -> None:
    world = weft.World()
    sheet = world.add_cloth(weft.grid(cells=(4, 4)))
    sheet.pin(chosen)  # type: ignore[arg-type]
    assert sheet.pins.tolist() == expected == np.atleast_1d(np.arange(25)[chosen]).astype(int).tolist()
    sheet.unpin(chosen)  # type: ignore[arg-type]
    assert sheet.pins.tolist() == []


@pytest.mark.parametrize("chosen", [25, -26, [3, 25], [-26], np.uint64(2**64 - 1), np.ones(24, bool), [[1, 2]],
                                    [0.0], ["0"], np.ones((25, 1), bool), None, 2**70])  # fmt: skip
def test_wrong_indices_are_refused(chosen: object) -> None:
    world = weft.World()
    sheet = world.add_cloth(weft.grid(cells=(4, 4)))
    with pytest.raises(weft.InputError, match="^particles: "):
        sheet.pin(chosen)  # type: ignore[arg-type]
    assert sheet.pins.tolist() == []


# DLPack.


def test_new_arrays_and_views_are_given_away_by_dlpack() -> None:
    world = draped()
    advance(world, 4)
    sheet = sheet_of(world)
    own = np.from_dlpack(sheet.positions)
    assert np.array_equal(own, sheet.positions)
    try:
        view = np.from_dlpack(sheet.offsets)
    except BufferError:
        pytest.skip(f"NumPy {np.__version__} exports no read-only arrays by DLPack")
    assert np.shares_memory(view, sheet.offsets) and not view.flags.writeable
    world.step(DT)
    assert np.array_equal(view, sheet.offsets)


def test_arrays_of_dlpack_are_taken() -> None:
    class Tensor:
        """What another library's array shows of itself."""

        def __init__(self, array: np.ndarray) -> None:
            self._array = array

        def __dlpack__(self, **options: object) -> object:
            return self._array.__dlpack__(**options)  # type: ignore[arg-type]

        def __dlpack_device__(self) -> tuple[int, int]:
            return self._array.__dlpack_device__()  # type: ignore[return-value]

    sheet = sheet_of(hanging())
    sheet.positions = np.from_dlpack(Tensor(np.full((len(sheet), 3), 0.5)))
    assert (sheet.positions == 0.5).all()
