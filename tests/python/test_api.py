"""Every public name: its docstring, its signature, its types; and what an import loads."""

from __future__ import annotations

import doctest
import importlib
import importlib.util
import inspect
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import weft
from worlds import python

PACKAGE = Path(weft.__file__).parent
TREE = Path(__file__).parents[2]
SOURCES = TREE / "python" / "weft"
MODULES = ["weft", *(f"weft.{file.stem}" for file in sorted(PACKAGE.glob("*.py")) if not file.stem.startswith("__"))]

# Members that the standard library and NumPy give to subclasses.
INHERITED = {weft.Picture, weft.InputError, weft.SceneError, weft.SimulationError, weft.SimulationWarning,
             weft.FileWarning, weft.GraphicsError}  # fmt: skip


def members(kind: type) -> Iterator[tuple[str, Any]]:
    for name in dir(kind):
        if name.startswith("_") or (kind in INHERITED and name not in vars(kind)):
            continue
        yield name, inspect.getattr_static(kind, name)


def public() -> Iterator[tuple[str, Any]]:
    """Names of the package, and below classes their members."""
    for name in weft.__all__:
        if name == "__version__":
            continue
        thing = getattr(weft, name)
        yield name, thing
        if inspect.isclass(thing):
            for member, value in members(thing):
                yield f"{name}.{member}", value


PUBLIC = dict(public())


def docstring(thing: Any) -> str:
    if isinstance(thing, (staticmethod, classmethod)):
        thing = thing.__func__
    return inspect.getdoc(thing) or ""


def test_all_is_what_the_package_shows() -> None:
    shown = {name for name in vars(weft) if not name.startswith("_")}
    modules = {name for name in shown if inspect.ismodule(getattr(weft, name))}
    assert modules <= {"bench", "farm", "usd"}
    assert shown - modules == set(weft.__all__) - {"__version__"}
    assert sorted(weft.__all__) == list(weft.__all__)
    assert re.fullmatch(r"\d+\.\d+\.\d+", weft.__version__)


# Words that say a member's whole meaning: settings whose name is that of a class.
SELF_EXPLAINED = re.compile(r"IntegratorSettings\.(explicit_euler|paper|implicit_euler|newton|xpbd)$")
PRINTED_UNITS = ("KesSheet", "FastSheet", "CloProperties")  # their class explains all members


@pytest.mark.parametrize("name", PUBLIC)
def test_docstring(name: str) -> None:
    text = docstring(PUBLIC[name])
    if SELF_EXPLAINED.search(name) or name.split(".")[0] in PRINTED_UNITS:
        name = name.split(".")[0]
        text = docstring(PUBLIC[name])
    sentences = [line for line in text.splitlines() if not line.startswith(name.split(".")[-1] + "(")]
    assert "".join(sentences).strip(), f"{name} has no docstring"




def returned(thing: property) -> str:
    """The type that a property returns, as it is written."""
    return str(inspect.get_annotations(thing.fget).get("return", ""))  # type: ignore[arg-type]


ARRAYS = [name for name, thing in PUBLIC.items() if isinstance(thing, property) and "NDArray" in returned(thing)]
WITHOUT_SHAPE = {"Cloth.corners", "Cloth.particle_of_vertex", "Cloth.strain", "World.contacts"}  # one row per …
WITHOUT_UNIT = {"Cloth.faces", "Cloth.uv", "Cloth.normals", "Cloth.corners", "Cloth.particle_of_vertex", "Cloth.pins"}


def test_arrays_are_found() -> None:
    assert {"Cloth.positions", "Cloth.offsets", "Cloth.pins", "World.contacts", "Collider.pose",
            "Batch.positions", "Run.positions"} <= set(ARRAYS)  # fmt: skip


@pytest.mark.parametrize("name", ARRAYS)
def test_arrays_say_shape_unit_and_whose_memory_they_are(name: str) -> None:
    docs = docstring(PUBLIC[name])
    if name not in WITHOUT_SHAPE | {"Cloth.pins"}:
        assert re.search(r"\(\w[\w +·]*,[^)]*\)", docs), f"{name} does not say its shape"
    if name not in WITHOUT_UNIT:
        assert re.search(r"\[[^\]]+\]", docs), f"{name} does not say its unit"
    if name.startswith(("Cloth.", "World.")):
        assert re.search(r"\bnew array|\bview\b", docs, re.IGNORECASE), f"{name} does not say whether it is a view"


SCALARS = ["Cloth.momentum", "Cloth.center_of_mass", "Cloth.origin", "World.gravity", "World.time", "World.energies",
           "Scene.dt", "Scene.frames_per_second", "StepDivision.shortest", "Sphere.radius", "Fabric.density",
           "Springs.structural", "Wind.velocity", "Air.density", "KeyFrame.translation"]  # fmt: skip


@pytest.mark.parametrize("name", SCALARS)
def test_numbers_with_units_say_them(name: str) -> None:
    assert re.search(r"\[[^\]]+\]", docstring(PUBLIC[name])), f"{name} does not say its unit"


FUNCTIONS = [
    name for name, thing in PUBLIC.items()
    if inspect.isfunction(thing) or isinstance(thing, (staticmethod, classmethod))
    or (inspect.isclass(thing) and inspect.isfunction(thing.__init__))
]  # fmt: skip
# Arguments with a default that may be given by position: what the call is about, not an option of it.
BY_POSITION = {
    "Batch.reset.worlds", "Cloth.unpin.particles", "Mesh.uv", "Run.picture.frame", "World.save.file",
    "World.cast_ray.reach", "World.closest_point.reach", "World.set_friction.static_friction", "grid.size",
    "grid.cells", "Run.keeper",
}  # fmt: skip


@pytest.mark.parametrize("name", FUNCTIONS)
def test_options_are_keyword_only_and_typed(name: str) -> None:
    thing = PUBLIC[name]
    call = thing.__init__ if inspect.isclass(thing) else inspect.unwrap(getattr(thing, "__func__", thing))
    signature = inspect.signature(call)
    for argument in signature.parameters.values():
        if argument.default is not inspect.Parameter.empty and argument.kind is not inspect.Parameter.KEYWORD_ONLY:
            assert f"{name}.{argument.name}" in BY_POSITION, f"{name}: {argument.name} is an option by position"
        if argument.name not in ("self", "cls"):
            assert argument.annotation is not inspect.Parameter.empty, f"{name}: {argument.name} has no type"
    assert signature.return_annotation is not inspect.Signature.empty


def plain_values() -> list[type]:
    return [thing for name, thing in PUBLIC.items() if inspect.isclass(thing) and hasattr(thing, "_asdict")]


@pytest.mark.parametrize("kind", plain_values(), ids=lambda kind: kind.__name__)
def test_plain_values_take_keywords_and_tell_wrong_ones(kind: type[Any]) -> None:
    value = kind()
    names = list(value._asdict())
    assert set(names) <= {name for name, member in members(kind) if isinstance(member, property)}
    assert kind(**value._asdict()) == value == value._replace()
    with pytest.raises(TypeError):
        kind(1)
    with pytest.raises(TypeError) as caught:
        kind(colour=1)
    assert str(caught.value) == f'unknown argument "colour"; there are {", ".join(names)}'


def test_errors_are_of_the_stated_kinds() -> None:
    assert issubclass(weft.InputError, ValueError)
    assert issubclass(weft.SceneError, weft.InputError)
    assert issubclass(weft.SimulationError, RuntimeError)
    assert issubclass(weft.SimulationWarning, UserWarning)
    assert issubclass(weft.FileWarning, UserWarning)
    assert issubclass(weft.GraphicsError, RuntimeError)


@pytest.mark.parametrize("module", MODULES)
def test_doctests(module: str) -> None:
    if module == "weft.usd":
        pytest.importorskip("pxr", reason="the Python package usd-core is missing")
    results = doctest.testmod(importlib.import_module(module), optionflags=doctest.ELLIPSIS)
    assert results.failed == 0
    if module in ("weft", "weft._batch", "weft._mesh", "weft._pictures", "weft._scene", "weft._world", "weft.usd"):
        assert results.attempted > 0


# What an import loads.


def imported(code: str) -> list[str]:
    done = python(code)
    assert done.returncode == 0, done.stderr
    return done.stdout.split("\n")


def test_an_import_loads_no_graphics_and_no_window_system() -> None:
    files = imported("import weft; print(open('/proc/self/maps').read())")
    assert any("_core" in file for file in files)
    graphics = re.compile(r"lib(GL|EGL|OpenGL|GLX|GLdispatch|glfw|X11|xcb|wayland|cuda|gbm)[\w-]*\.so", re.IGNORECASE)
    assert [file for file in files if graphics.search(file)] == []


def test_an_import_takes_numpy_and_the_standard_library_only() -> None:
    code = """
import sys, numpy
before = set(sys.modules)
import weft
for name in sorted(set(sys.modules) - before): print(name)
"""
    roots = {name.split(".")[0] for name in imported(code) if name}
    assert roots - set(sys.stdlib_module_names) - {"numpy"} == {"weft"}


def test_depth_needs_no_graphics() -> None:
    code = """
import weft
world = weft.World()
world.add_collider(weft.Sphere())
weft.Camera(size=(16, 12)).render(world, color=False)
print(open('/proc/self/maps').read())
"""
    assert not [file for file in imported(code) if re.search(r"libEGL|libOpenGL|libGLX|libgallium", file)]


# Types.


def test_the_package_is_typed() -> None:
    assert (PACKAGE / "py.typed").is_file()
    assert (PACKAGE / "_core.pyi").is_file()


def test_the_stubs_are_those_of_the_module(tmp_path: Path) -> None:
    if importlib.util.find_spec("nanobind") is None:
        pytest.skip("the Python package nanobind is missing")
    code = "import sys; from nanobind.stubgen import main; main(sys.argv[1:])"
    made = tmp_path / "_core.pyi"
    done = python(code, "-P", "-q", "-m", "weft._core", "-o", str(made))
    assert done.returncode == 0, done.stderr
    assert made.read_text() == (PACKAGE / "_core.pyi").read_text(), (
        "python/weft/_core.pyi is not the module's; make it again: "
        "python -m nanobind.stubgen -P -q -m weft._core -o python/weft/_core.pyi"
    )


@pytest.mark.parametrize("folder", ["weft", "examples"])
def test_types_are_right(folder: str, tmp_path: Path) -> None:
    if importlib.util.find_spec("mypy") is None:
        pytest.skip("the Python package mypy is missing")
    path = TREE / "python" / folder
    if not path.is_dir():
        pytest.skip(f"the folder python/{folder} is missing")
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--strict", "--cache-dir", str(tmp_path), str(path)],
        capture_output=True, text=True, timeout=300, cwd=TREE / "python",
    )  # fmt: skip
    assert done.returncode == 0, done.stdout + done.stderr


def test_an_unknown_attribute_is_refused() -> None:
    with pytest.raises(AttributeError):
        weft.Sphere().radios = 1  # type: ignore[attr-defined]
    with pytest.raises(AttributeError):
        weft.World().add_clothes  # type: ignore[attr-defined]
