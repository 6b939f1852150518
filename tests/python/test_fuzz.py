"""Wrong arguments of every kind for every public call: Python exceptions only, and the world still steps."""

from __future__ import annotations

import faulthandler
import inspect
import json
import os
import random
import signal
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import weft
from worlds import DT, FEATURES, SQUARE, advance, draped, hanging, python

ROUNDS = 30
ALLOWED = (ValueError, TypeError, KeyError, IndexError, AttributeError, OverflowError, OSError, MemoryError,
           weft.SimulationError, weft.GraphicsError)  # fmt: skip

# Not called: those that end, wait, or fill memory or the disk by right.
LEFT_OUT = {"Run.video", "Picture", "weft.run", "Rendering"}
CALLED_BY_PYTHON = {"__getitem__", "__contains__", "__eq__", "__setstate__", "__len__", "__hash__", "__deepcopy__",
                    "__reduce__", "__iter__", "__init__"}  # fmt: skip


def awkward(rng: random.Random) -> Any:
    """A value that few calls expect."""
    number = rng.choice([0, -1, 1, 2, 3, 7, 24, 25, -26, 2**31 - 1, 2**31, -(2**31), 2**63, 2**70, 0.5, -0.0, 1e-300,
                         1e300, -1e300, float("nan"), float("inf"), True])  # fmt: skip
    shape = rng.choice([(), (0,), (1,), (3,), (4,), (25,), (25, 3), (3, 3), (4, 3), (0, 3), (25, 2), (2, 25, 3),
                        (3, 0, 2, 3), (3, 1, 2, 3), (25, 25)])  # fmt: skip
    kind = rng.choice(["f8", "f4", "f2", ">f8", "i4", "i8", "u8", "u1", "?", "c16", "O", "U3", "M8[s]"])
    return rng.choice([
        lambda: number,
        lambda: (number, number, number),
        lambda: [number],
        lambda: np.full(shape, 1).astype(kind, copy=False),
        lambda: np.full(shape, number if abs(number) < 2**60 else 5, "f8"),
        lambda: np.zeros((6, 50))[::2, ::2],
        lambda: np.zeros((3, 25)).T,
        lambda: rng.choice([None, "", "x", "denim", "newton", "ünï\0code", "a" * 5000, b"", b"bytes", 1j, object(),
                            object, [], {}, (), set(), [[]], [[1], [1, 2]], range(3), slice(1), iter([1]),
                            NotImplemented]),
        lambda: rng.choice([weft.Sphere(), weft.Plane(), weft.Box(), weft.Fabric(), weft.Springs(), weft.Wind(),
                            weft.KeyFrame(time=1), weft.grid(cells=(2, 2)), SQUARE, weft.World(), weft.KesSheet(),
                            weft.StepDivision(), weft.ContactSettings(), weft.IntegratorSettings(), weft.Camera()]),
        lambda: hanging(2).cloths[0],
        lambda: draped(2).colliders[0],
        lambda: hanging(2).snapshot(),
        lambda: {"sheet": rng.choice([([0], np.zeros((2, 1, 3))), 5, ([0, 99], 3), None])},
        lambda: [weft.KeyFrame(time=rng.choice([0, 1, float("nan")])) for _ in range(rng.randint(0, 3))],
        lambda: [(rng.choice([0, "x", 1]), SQUARE.vertices)],
    ])()  # fmt: skip


PINS, GOALS = [0, 4], np.zeros((2, 2, 3))
# Right arguments, of which the fuzzer changes one.
RIGHT: dict[str, tuple[list[Any], dict[str, Any]]] = {
    "World.add_cloth": ([SQUARE], dict(
        fabric="denim", position=(0, 2, 0), rotation=(0, 10, 0), velocity=(0, 0, 0), name="new", membrane="springs",
        warp=(1, 0, 0), model="basic", weld=0.001, sew=0.01,
        rest=np.ones((len(SQUARE.faces), 3, 3)), rest_scales=[([0, 1], 0.7, 1.2)],
        seams=[([0, 4], [20, 24])], stitches=[(0, 24)], seam_time=0.5, seam_stiffness=1e4, layer=2, fits_thickness=True)),
    "World.add_collider": ([SQUARE], dict(
        friction=0.2, static_friction=0.3, position=(0, -1, 0), rotation=(1, 0, 0, 0), motion=[weft.KeyFrame(time=1)],
        solid=True, name="floor")),
    "World.step": ([DT], dict(check=False)),
    "World.cast_ray": ([(0, 1, 0), (0, -1, 0), 5.0], {}),
    "World.closest_point": ([(0, 1, 0), 5.0], {}),
    "Cloth.pin": ([[1]], dict(stiffness=5.0, damping=0.1, pivot=(0, 0, 0))),
    "Cloth.unpin": ([[0]], {}),
    "Cloth.set_targets": ([[0], (0, 0, 0)], {}),
    "Cloth.set_forces": ([(0, 0, 0)], {}),
    "Cloth.set_pressure": ([0], dict(sealed=False)),
    "Cloth.copy_positions": ([np.zeros((25, 3))], {}),
    "Cloth.copy_velocities": ([np.zeros((25, 3), np.float32)], {}),
    "Cloth.teleport": ([], dict(translation=(0, 1, 0), rotation=(0, 0, 5), keeps_velocity=False)),
    "Cloth.stiffen": ([[0, 1], 2.0], {}),
    "Cloth.force": (["gravity"], {}),
    "Collider.move_to": ([], dict(translation=(0, 0.1, 0), rotation=(0, 0, 5))),
    "Collider.place_at": ([], dict(translation=(0, 0.1, 0), rotation=(0, 0, 5))),
    "Batch.step": ([DT], dict(targets={"sheet": (PINS, GOALS)}, check=False)),
    "Batch.reset": ([[0]], {}),
    "Batch.rollout": ([GOALS[:, None], DT], dict(cloth="sheet", particles=PINS)),
    "weft.Mesh": ([SQUARE.vertices, SQUARE.faces], dict(uv=SQUARE.vertices[:, [0, 2]])),
    "weft.Polygons": ([[4], [0, 1, 2, 3]], dict(uv=np.zeros((4, 2)), groups={"hem": [0]}, objects={"shirt": [0]})),
    "Polygons": ([[4], [0, 1, 2, 3]], {}),
    "weft.grid": ([], dict(size=(1, 2), cells=(3, 4))),
    "weft.Camera": ([], dict(position=(1, 1, 1), target=(0, 0, 0), fov_deg=40.0, size=(8, 6))),
    "weft.fabric_from": ([weft.CloProperties(density=100)], {}),
    "weft.load_scene": (["drape_box"], dict(set={"scene.fps": 30})),
    "Scene.set": (["scene.fps = 30"], {}),
    "Mesh": ([SQUARE.vertices, SQUARE.faces], {}),
}  # fmt: skip


def one_wrong(rng: random.Random, right: tuple[list[Any], dict[str, Any]]) -> tuple[list[Any], dict[str, Any]]:
    """Right arguments but for one."""
    arguments, options = list(right[0]), dict(right[1])
    place = rng.randrange(len(arguments) + len(options))
    if place < len(arguments):
        arguments[place] = awkward(rng)
    else:
        options[list(options)[place - len(arguments)]] = awkward(rng)
    return arguments, options


def is_modest(name: str, arguments: list[Any], options: dict[str, Any]) -> bool:
    """Whether a call, if it succeeds, needs little time and memory."""
    values = [*arguments, *options.values()]
    if name in ("World.threads", "World", "Batch", "weft.grid", "Grid", "Scene.world", "Camera"):
        return not any(isinstance(v, (int, float)) and abs(v) > 100 for v in values)
    return True


def parameters_of(call: Callable[..., Any]) -> tuple[int, list[str]]:
    """How many arguments it takes by position, and its options by name."""
    try:
        signature = inspect.signature(call)
    except (TypeError, ValueError):
        return 2, []
    kinds = [p.kind for p in signature.parameters.values()]
    names = [p.name for p in signature.parameters.values() if p.kind is p.KEYWORD_ONLY]
    placed = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    return sum(kind in placed for kind in kinds), names


def objects(folder: Path) -> dict[str, Any]:
    """One of everything, new."""
    world = draped(4)
    advance(world, 3)
    sheet = world.cloths[0]
    sheet.pin([0])
    scene = weft.load_scene("paper/fig6_ball")
    values = {name: getattr(weft, name)() for name in weft.__all__ if hasattr(getattr(weft, name), "_asdict")}
    return {
        "World": world, "Cloth": sheet, "Collider": world.colliders[0],
        "Mesh": weft.Mesh(SQUARE.vertices, SQUARE.faces), "Polygons": weft.Polygons([4], [0, 1, 2, 3]),
        "Batch": weft.Batch(lambda i: hanging(4), 2), "Scene": scene, "Section": scene.cloths[0],
        "Run": weft.open_run(folder / "run"), "Camera": weft.Camera(size=(16, 12)), "StepReport": world.step(DT),
        "Snapshot": world.snapshot(), "weft": weft, **values,
    }  # fmt: skip


def targets(folder: Path) -> Iterator[tuple[str, Callable[[dict[str, Any]], Callable[..., Any]]]]:
    """Calls by name: methods, constructors, functions, and setting of attributes."""
    things = objects(folder)
    for owner, thing in things.items():
        for name in sorted(weft.__all__ if owner == "weft" else dir(type(thing))):
            full = f"{owner}.{name}"
            is_private = name.startswith("_") and name not in CALLED_BY_PYTHON
            if is_private or full in LEFT_OUT or name in LEFT_OUT or name == "__version__":
                continue
            if owner != "weft" and name == "__init__" and owner in weft.__all__:
                continue  # a class of weft, called below
            static = inspect.getattr_static(type(thing) if owner != "weft" else thing, name, None)
            if owner != "weft" and not callable(static) and not isinstance(static, (staticmethod, classmethod)):
                yield f"{full} =", lambda all, o=owner, n=name: lambda value=None: setattr(all[o], n, value)
                yield f"{full} read", lambda all, o=owner, n=name: lambda: getattr(all[o], n)
            else:
                yield full, lambda all, o=owner, n=name: getattr(all[o], n)


def fuzz(seed: int, folder: Path) -> Counter[str]:
    """Calls everything with wrong arguments; the outcomes by kind."""
    rng, outcomes = random.Random(seed), Counter[str]()
    calls = list(targets(folder))
    log = open(folder / "last_call", "w", buffering=1)
    for turn in range(ROUNDS):
        everything = objects(folder)
        for name, find in calls:
            call = find(everything)
            by_position, names = parameters_of(call)
            count = min(max(0, by_position + rng.choice([0, 0, 0, 0, 1, -1])), 4)
            arguments = [awkward(rng) for _ in range(count)]
            options = {key: awkward(rng) for key in rng.sample(names, min(len(names), rng.choice([0, 0, 1, 2])))}
            if rng.random() < 0.03:
                options["nonsense"] = awkward(rng)
            if name in RIGHT and rng.random() < 0.8:
                arguments, options = one_wrong(rng, RIGHT[name])
            if not is_modest(name.removesuffix(" ="), arguments, options):
                continue
            log.seek(0)
            log.write(f"seed {seed}, turn {turn}: {name}({arguments!r:.300}, {options!r:.300})\n")
            log.truncate()
            try:
                call(*arguments, **options)
                outcomes["no exception"] += 1
            except ALLOWED as error:
                outcomes[type(error).__name__] += 1
            except RuntimeError as error:
                raise AssertionError(f"{name}: RuntimeError: {error}") from error
        everything["World"].step(DT, check=False)
        everything["Batch"].step(DT, check=False)
    return outcomes


def main(seed: int, folder: Path) -> None:
    faulthandler.enable()
    warnings.simplefilter("ignore")
    np.seterr(all="ignore")
    os.chdir(folder)
    for feature in FEATURES.values():
        world = feature()
        advance(world, 2)
    outcomes = fuzz(seed, folder)
    checks = draped(4)
    advance(checks, 5)
    print(json.dumps({"outcomes": outcomes, "hash": checks.state_hash()}))


@pytest.mark.parametrize("seed", [1, 2])
def test_wrong_arguments_are_exceptions_and_never_crash(seed: int, tmp_path: Path) -> None:
    weft.run("paper/fig6_ball", frames=1, out=tmp_path / "run")
    code = "import sys, pathlib, test_fuzz; test_fuzz.main(int(sys.argv[1]), pathlib.Path(sys.argv[2]))"
    done = python(code, str(seed), str(tmp_path), timeout=600)
    last = (tmp_path / "last_call").read_text() if (tmp_path / "last_call").exists() else "none"
    ended = signal.Signals(-done.returncode).name if done.returncode < 0 else f"status {done.returncode}"
    assert done.returncode == 0, f"{ended} after {last}\n{done.stderr[-3000:]}"
    result = json.loads(done.stdout.splitlines()[-1])
    outcomes = result["outcomes"]
    assert outcomes["InputError"] > 1000 and outcomes["TypeError"] > 1000 and outcomes["no exception"] > 1000
    expected = draped(4)
    advance(expected, 5)
    assert result["hash"] == expected.state_hash()
