# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of objects and scenes."""

import bpy
import weft
from bpy.props import BoolProperty, EnumProperty, FloatProperty, IntProperty, PointerProperty, StringProperty

from .units import metres

# Numbers of a fabric: by the engine's name, with the size of the panel's unit in SI.
NUMBERS = {
    "density": 1.0, "c11": 1.0, "c22": 1.0, "c12": 1.0, "g": 1.0, "bend_warp": 1e-6, "bend_weft": 1e-6, "bend_bias": 1e-6,
    "bend_hysteresis_warp": 1e-3, "bend_hysteresis_weft": 1e-3, "bend_set": 1.0,
    "damping": 1.0, "friction": 1.0, "strain_limit": 1.0,
}  # fmt: skip
_TEXTS = {entry["key"]: entry["description"] for entry in weft.parameters() if entry["form"] == "fabric"}
_FABRICS = [(name, name.replace("_", " ").capitalize(), title) for name, title in weft.fabric_presets()]


def _apply_fabric(settings: "WeftObject", context: bpy.types.Context) -> None:
    fabric = weft.find_fabric(settings.fabric)
    for name, unit in NUMBERS.items():
        setattr(settings, name, getattr(fabric, name) / unit)
    settings.thickness = fabric.thickness / metres(context.scene)


def _choose_role(settings: "WeftObject", context: bpy.types.Context) -> None:
    if settings.role == "CLOTH" and settings.thickness == 0:
        _apply_fabric(settings, context)


def _number(name: str, label: str, shown: str, **options: object) -> FloatProperty:
    meaning = _TEXTS.get(f"cloth.fabric.{name}", "")
    return FloatProperty(name=f"{label} ({shown})" if shown else label, description=meaning.rstrip("."), min=0, **options)


class WeftObject(bpy.types.PropertyGroup):
    role: EnumProperty(
        name="Role",
        description="What the object is to Weft",
        items=[
            ("NONE", "Nothing", "Weft leaves the object alone"),
            ("CLOTH", "Cloth", "The object is simulated"),
            ("COLLIDER", "Collider", "Cloth collides with the object"),
        ],
        update=_choose_role,
    )
    fabric: EnumProperty(
        name="Fabric", description="Fabric whose measured numbers are used", items=_FABRICS,
        default="cotton_shirting", update=_apply_fabric,
    )  # fmt: skip
    density: _number("density", "Density", "kg/m²", precision=3)
    c11: _number("c11", "Stretching along warp", "N/m", precision=0)
    c22: _number("c22", "Stretching along weft", "N/m", precision=0)
    c12: _number("c12", "Coupling", "N/m", precision=0)
    g: _number("g", "Shearing", "N/m", precision=1)
    bend_warp: _number("bend_warp", "Bending along warp", "µN·m", precision=2)
    bend_weft: _number("bend_weft", "Bending along weft", "µN·m", precision=2)
    bend_bias: _number("bend_bias", "Bending at 45°", "µN·m", precision=2)
    bend_hysteresis_warp: _number("bend_hysteresis_warp", "Hysteresis of bending along warp", "mN", precision=2)
    bend_hysteresis_weft: _number("bend_hysteresis_weft", "Hysteresis of bending along weft", "mN", precision=2)
    bend_set: _number("bend_set", "Creases from", "1/m", precision=0)
    damping: _number("damping", "Damping", "s", precision=4)
    friction: _number("friction", "Friction", "", precision=2, default=0.3)
    strain_limit: _number("strain_limit", "Strain limit", "", precision=3)
    thickness: _number("thickness", "Thickness", "", subtype="DISTANCE", unit="LENGTH", precision=5)
    pin_group: StringProperty(
        name="Pins", description="Vertex group of pins: weight 1 is held, less is a spring that follows the mesh"
    )
    layer: IntProperty(
        name="Layer", default=0, min=-100, max=100,
        description="Order of garments over each other: a higher one is put outside of lower ones at the start",
    )  # fmt: skip
    sew: BoolProperty(
        name="Sew", default=True, description="Edges without faces draw together, as the sewing of Blender's cloth"
    )
    sew_time: FloatProperty(
        name="Sewing time", default=0.5, min=0, unit="TIME_ABSOLUTE", description="Time in which sewing edges close (s)"
    )
    solid: EnumProperty(
        name="Inside",
        description="Whether the holes of a mesh are filled, so that it has an inside",
        items=[
            ("AUTO", "Small holes filled", "Holes of up to a twentieth of their shell's area are filled"),
            ("SOLID", "All holes filled", "The mesh is a solid"),
            ("OPEN", "Open", "Only closed shells are solid"),
        ],
    )
    rest: EnumProperty(
        name="Rest shape",
        description="Shape in which the cloth is free of tension",
        items=[
            ("MESH", "Mesh", "The vertices as modelled, in the object's scale at the start"),
            ("START", "Pose at the start", "The evaluated mesh at the first frame"),
        ],
    )


class WeftScene(bpy.types.PropertyGroup):
    colliders: PointerProperty(
        name="Colliders", description="Collection whose meshes are colliders, besides those with that role",
        type=bpy.types.Collection,
    )  # fmt: skip
    own_range: BoolProperty(name="Own frame range", description="Bake other frames than those of the scene")
    first_frame: IntProperty(name="First frame", default=1)
    last_frame: IntProperty(name="Last frame", default=250)
    quality: EnumProperty(
        name="Quality",
        description="Length of steps, and the solver's work in each",
        items=[
            ("fast", "Fast", "Steps of at most 1/48 s, half of the usual work"),
            ("default", "Usual", "Steps of at most 1/60 s"),
            ("high", "High", "Steps of at most 1/120 s, twice the usual work"),
        ],
        default="default",
    )
    untangle: BoolProperty(
        name="Put on at the start", default=True,
        description="Set cloth apart that crosses itself or a collider at the first frame",
    )  # fmt: skip
    threads: IntProperty(name="Threads", description="0: one per core. They never change the result", min=0)
    folder: StringProperty(
        name="Cache", description="Folder of the caches; // is the folder of the .blend", subtype="DIR_PATH",
        default="//weft_cache", **({"options": {"PATH_SUPPORTS_BLEND_RELATIVE"}} if bpy.app.version >= (4, 5, 0) else {}),
    )  # fmt: skip
    report: StringProperty(description="Sentences of the last report")


def register() -> None:
    bpy.utils.register_class(WeftObject)
    bpy.utils.register_class(WeftScene)
    bpy.types.Object.weft = PointerProperty(type=WeftObject)
    bpy.types.Scene.weft = PointerProperty(type=WeftScene)


def unregister() -> None:
    del bpy.types.Object.weft, bpy.types.Scene.weft
    bpy.utils.unregister_class(WeftScene)
    bpy.utils.unregister_class(WeftObject)
