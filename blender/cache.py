# SPDX-License-Identifier: GPL-3.0-or-later
"""The Mesh Cache modifier that shows a bake, and its place among the others."""

from pathlib import Path

import bpy

from .refused import Refused

NAME = "Weft"

# Modifiers that make or remove vertices, or can; others are found by evaluation.
_MAKERS = {
    "ARRAY", "BEVEL", "BOOLEAN", "BUILD", "DECIMATE", "EDGE_SPLIT", "MASK", "MIRROR", "MULTIRES", "OCEAN", "REMESH", "SCREW",
    "SKIN", "SOLIDIFY", "SUBSURF", "VOLUME_TO_MESH", "WELD", "WIREFRAME",
}  # fmt: skip
_POSES = {"ARMATURE", "LATTICE", "MESH_DEFORM", "SURFACE_DEFORM"}
_OTHER_CLOTH = {"CLOTH", "SOFT_BODY"}


def find_modifier(cloth: bpy.types.Object) -> bpy.types.Modifier | None:
    """Ours."""
    for modifier in cloth.modifiers:
        if modifier.type == "MESH_CACHE" and modifier.name.startswith(NAME):
            return modifier
    return None


def _num_vertices(cloth: bpy.types.Object, layer: bpy.types.ViewLayer) -> int:
    layer.update()
    evaluated = cloth.evaluated_get(layer.depsgraph)
    count = len(evaluated.to_mesh().vertices)
    evaluated.to_mesh_clear()
    return count


def check_modifiers(cloth: bpy.types.Object, layer: bpy.types.ViewLayer) -> int:
    """Where ours is, or will be: behind poses, in front of the first modifier that makes vertices. Raises Refused.

    The modifiers are shown as they were before.
    """
    modifiers, own = list(cloth.modifiers), find_modifier(cloth)
    shown = [modifier.show_viewport for modifier in modifiers]
    for modifier in modifiers:
        if modifier.type in _OTHER_CLOTH:
            raise Refused(f'"{cloth.name}" also has Blender\'s modifier "{modifier.name}"; remove it')
    position = len(modifiers)
    try:
        for modifier in modifiers:
            modifier.show_viewport = False
        for n, modifier in enumerate(modifiers):
            if modifier == own or not (shown[n] or modifier.show_render):
                continue
            modifier.show_viewport = True
            if modifier.type in _MAKERS or _num_vertices(cloth, layer) != len(cloth.data.vertices):
                position = n
                break
    finally:
        for modifier, was_shown in zip(modifiers, shown, strict=True):
            modifier.show_viewport = was_shown
    if own and modifiers.index(own) > position:
        raise Refused(
            f'"{cloth.name}": the modifier "{modifiers[position].name}" above "{own.name}" changes the number of vertices; '
            f'move it below "{own.name}"'
        )
    if own:
        position = modifiers.index(own)
    for modifier in modifiers[position:]:
        if modifier.type in _POSES and (modifier.show_viewport or modifier.show_render):
            above = f'above "{modifiers[position].name}"'
            raise Refused(f'"{cloth.name}": the modifier "{modifier.name}" would move the baked cloth again; move it {above}')
    return position


def show(cloth: bpy.types.Object, position: int, file: Path, first_frame: int) -> None:
    """Adds or renews our modifier."""
    modifier = find_modifier(cloth)
    if modifier is None:
        modifier = cloth.modifiers.new(NAME, "MESH_CACHE")
        cloth.modifiers.move(len(cloth.modifiers) - 1, position)
        modifier = cloth.modifiers[position]
    modifier.cache_format = "PC2"
    modifier.filepath = bpy.path.relpath(str(file)) if bpy.data.filepath else str(file)
    modifier.frame_start = first_frame
    modifier.show_viewport = modifier.show_render = True


class Hidden:
    """Within it, cloths are shown as they are above our modifier's place, and the scene's frame may change."""

    def __init__(self, scene: bpy.types.Scene, cloths: list[bpy.types.Object], positions: list[int]) -> None:
        self._scene, self._places = scene, list(zip(cloths, positions, strict=True))

    def __enter__(self) -> None:
        self._frame = (self._scene.frame_current, self._scene.frame_subframe)
        self._shown = []
        for cloth, position in self._places:
            modifiers, own = list(cloth.modifiers), find_modifier(cloth)
            for modifier in modifiers[modifiers.index(own) if own else position :]:
                self._shown.append((modifier, modifier.show_viewport))
                modifier.show_viewport = False

    def __exit__(self, *_: object) -> None:
        for modifier, shown in self._shown:
            modifier.show_viewport = shown
        self._scene.frame_set(self._frame[0], subframe=self._frame[1])
