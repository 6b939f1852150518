"""Weft: accurate cloth simulation on ordinary hardware. Metres, kilograms, seconds, newtons; Y up.

>>> import weft
>>> world = weft.World()
>>> sheet = world.add_cloth(weft.grid(size=(1, 1), cells=(16, 16)), fabric="cotton_shirting")
>>> sheet.pin(sheet.corners[:2])
>>> report = world.step(1 / 60)
>>> sheet.positions.shape
(289, 3)
"""

import typing as _typing

from ._batch import Batch
from ._core import (
    Air,
    Box,
    Capsule,
    CloProperties,
    ContactSettings,
    Diagnostic,
    ExplicitSettings,
    Fabric,
    FastSheet,
    GraphicsError,
    Grid,
    Gusts,
    ImplicitEulerSettings,
    InputError,
    IntegratorSettings,
    KesSheet,
    KeyFrame,
    NewtonSettings,
    PaperSettings,
    Plane,
    SceneError,
    Snapshot,
    Sphere,
    Springs,
    StepDivision,
    StepReport,
    StepWarning,
    Wind,
    WindKey,
    XpbdSettings,
    fabric_from,
    fabric_presets,
    fabric_sources,
    find_fabric,
    integrator_names,
    parameters,
)
from ._core import version as __version__
from ._convert import convert
from ._errors import FileWarning, SimulationError, SimulationWarning
from ._mesh import Mesh, Polygons, find_crossings, grid, read_gltf, read_mesh, read_obj, rest_from_uv, write_mesh, write_obj
from ._pictures import Camera, Picture, Rendering
from ._scene import Run, Scene, Section, load_scene, open_run, run, scenes
from ._world import Cloth, Collider, SurfacePoint, World

if _typing.TYPE_CHECKING:
    from . import farm as farm
else:

    def __getattr__(name: str) -> object:
        """`weft.farm`, imported when it is used: it takes a third of the time of `import weft`."""
        if name != "farm":
            raise AttributeError(f"module 'weft' has no attribute {name!r}")
        import importlib

        return importlib.import_module("weft.farm")


__all__ = [
    "Air", "Batch", "Box", "Camera", "Capsule", "CloProperties", "Cloth", "Collider", "ContactSettings", "Diagnostic",
    "ExplicitSettings", "Fabric", "FastSheet", "FileWarning", "GraphicsError", "Grid", "Gusts",
    "ImplicitEulerSettings", "InputError", "IntegratorSettings", "KesSheet", "KeyFrame", "Mesh", "NewtonSettings",
    "PaperSettings", "Picture", "Plane", "Polygons", "Rendering", "Run", "Scene", "SceneError", "Section",
    "SimulationError", "SimulationWarning", "Snapshot", "Sphere", "Springs", "StepDivision", "StepReport",
    "StepWarning", "SurfacePoint", "Wind", "WindKey", "World", "XpbdSettings", "__version__", "convert", "fabric_from",
    "fabric_presets", "fabric_sources", "find_crossings", "find_fabric", "grid", "integrator_names", "load_scene", "open_run",
    "parameters", "read_gltf", "read_mesh", "read_obj", "rest_from_uv", "run", "scenes", "write_mesh", "write_obj",
]  # fmt: skip
