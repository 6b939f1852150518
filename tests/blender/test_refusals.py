"""What cannot be baked is refused in a sentence with the object's name, and leaves nothing behind."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import bmesh
import bpy
import pytest
from scenes import add_ball, add_bending_body, add_cloth, bake, begin, finish, job


def no_cloth() -> None:
    bpy.data.objects["Sheet"].weft.role = "NONE"


def missing_group() -> None:
    bpy.data.objects["Sheet"].weft.pin_group = "waist"


def no_faces() -> None:
    mesh = bpy.data.objects["Sheet"].data
    made = bmesh.new()
    made.from_mesh(mesh)
    bmesh.ops.delete(made, geom=made.faces[:], context="FACES_ONLY")
    made.to_mesh(mesh)
    made.free()


def subdivision_above() -> None:
    cloth = bpy.data.objects["Sheet"]
    cloth.modifiers.new("Smooth it", "SUBSURF")
    cloth.modifiers.new("Weft", "MESH_CACHE")


def armature_below() -> None:
    cloth = bpy.data.objects["Sheet"]
    cloth.modifiers.new("Thick", "SOLIDIFY")
    cloth.modifiers.new("Bones", "ARMATURE")


def own_cloth() -> None:
    bpy.data.objects["Sheet"].modifiers.new("Old", "CLOTH")


def growing_collider() -> None:
    body = add_ball("Grower")
    modifier = body.modifiers.new("Build", "BUILD")
    modifier.frame_start, modifier.frame_duration = 0, 30


def hidden_collider() -> None:
    add_ball("Ghost").hide_viewport = True


def no_mesh() -> None:
    bpy.ops.curve.primitive_bezier_circle_add()
    bpy.context.object.name = "Ring"
    bpy.context.object.weft.role = "COLLIDER"


def instances() -> None:
    collection = bpy.data.collections.new("Bodies")
    bpy.context.scene.weft.colliders = collection
    empty = bpy.data.objects.new("Copies", None)
    empty.instance_type, empty.instance_collection = "COLLECTION", bpy.data.collections.new("Original")
    collection.objects.link(empty)
    bpy.context.collection.objects.link(empty)


def scaled_to_nothing() -> None:
    bpy.data.objects["Sheet"].scale = (0, 1, 1)


def empty_range() -> None:
    bpy.context.scene.frame_end = 1


def folder_that_is_a_file() -> None:
    file = Path(bpy.path.abspath("//taken"))
    file.write_text("")
    bpy.context.scene.weft.folder = "//taken"


def no_name() -> None:
    bpy.ops.wm.read_homefile(use_empty=True)
    add_cloth()


@pytest.mark.parametrize(
    "change, sentence",
    [
        (no_cloth, "No object has the role Cloth"),
        (missing_group, '"Sheet" has no vertex group "waist" for its pins; there are none'),
        (no_faces, '"Sheet" has no faces'),
        (subdivision_above, '"Sheet": the modifier "Smooth it" above "Weft" changes the number of vertices'),
        (armature_below, 'the modifier "Bones" would move the baked cloth again; move it above "Thick"'),
        (own_cloth, '"Sheet" also has Blender\'s modifier "Old"'),
        (hidden_collider, '"Ghost" is hidden'),
        (no_mesh, '"Ring" is no mesh'),
        (instances, '"Copies" makes instances'),
        (scaled_to_nothing, '"Sheet" is scaled to nothing'),
        (empty_range, "change the frame range"),
        (folder_that_is_a_file, "choose another cache folder"),
        (no_name, "save it first"),
    ],
)  # fmt: skip
def test_it_is_refused(change: Any, sentence: str) -> None:
    add_cloth()
    change()
    before = [(m.name, m.show_viewport) for m in bpy.data.objects["Sheet"].modifiers]
    with pytest.raises(job.Refused) as refused:
        begin()
    assert sentence in str(refused.value), str(refused.value)
    cloth = bpy.data.objects["Sheet"]
    assert [(m.name, m.show_viewport) for m in cloth.modifiers] == before
    with pytest.raises(RuntimeError, match="Error: "):
        bpy.ops.weft.bake()
    assert sentence in bpy.context.scene.weft.report


def test_a_linked_object_is_refused(blend: Path) -> None:
    add_cloth("Source")
    bpy.ops.wm.save_mainfile()
    bpy.ops.wm.read_homefile(use_empty=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(blend.parent / "other.blend"))
    with bpy.data.libraries.load(str(blend), link=True) as (there, here):
        here.objects = ["Source"]
    bpy.context.collection.objects.link(here.objects[0])
    with pytest.raises(job.Refused, match='"Source" is linked from a library; make it local'):
        begin()


def test_a_number_of_vertices_that_changes_ends_the_bake_and_keeps_its_frames() -> None:
    add_cloth()
    growing_collider()
    done = finish(begin())
    assert done.outcome == "failed" and '"Grower": the number of its vertices changes' in done.words[0]


def test_a_mesh_that_is_not_manifold_is_baked_with_a_word() -> None:
    cloth = add_cloth()
    made = bmesh.new()
    made.from_mesh(cloth.data)
    made.edges.ensure_lookup_table()
    inner = next(edge for edge in made.edges if len(edge.link_faces) == 2)
    tip = made.verts.new((0.05, 0.05, 0.1))
    made.faces.new((*inner.verts, tip))
    made.to_mesh(cloth.data)
    made.free()
    done = bake()
    assert any("non-manifold" in sentence for sentence in done.words), done.words


def test_a_cloth_that_goes_away_during_the_bake_is_named() -> None:
    bpy.context.scene.frame_end = 2000
    cloth = add_cloth()
    add_bending_body()
    gone = begin()
    while gone.poll() and gone.frames < 2:
        pass
    bpy.data.objects.remove(cloth)
    finish(gone)
    assert gone.outcome == "failed" and '"Sheet" is no longer there' in gone.words[0], gone.words


def test_a_cloth_that_goes_away_after_the_gathering_is_named_with_its_frames() -> None:
    bpy.context.scene.frame_end = 12
    cloth = add_cloth(cells=40)
    gone = begin()
    while gone.poll() and not gone._process.stdin.closed:
        pass
    bpy.data.objects.remove(cloth)
    finish(gone)
    assert gone.outcome == "failed" and gone.words[0].startswith('"Sheet" is no longer there; its frames are in '), gone.words
