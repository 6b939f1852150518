"""Bakes, as Blender shows them."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import textwrap
import time
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest
import weft
from weft.bake import Job, MotionReader
from scenes import (
    add_ball, add_bending_body, add_cloth, bake, begin, cache_of, crossings, faces, finish, job, pin, shown, uv,
)  # fmt: skip

FIVE = (1, 3, 6, 9, 12)
TOLERANCE = 1e-5  # [m]


def turn(thing: Any, path: str, start: Any, end: Any) -> None:
    """Keys at frames 1 and 12."""
    for frame, value in ((1, start), (12, end)):
        setattr(thing, path, value)
        thing.keyframe_insert(path, frame=frame)


def tilted_scene() -> Any:
    """A cloth in centimetres: moved, scaled, below a turned parent, turning itself during the bake."""
    scene = bpy.context.scene
    scene.unit_settings.scale_length = 0.01
    scene.gravity = (0, 0, -981)
    scene.render.fps, scene.render.fps_base = 30, 1.001
    cloth = add_cloth(size=50, location=(30, -20, 120))
    pin(cloth, 1.0, lambda co: co.y > 24.9)
    cloth.scale = (2.0, 1.5, 1.0)
    cloth.rotation_euler = (0.3, -0.2, 0.5)
    bpy.ops.object.empty_add(location=(200, 100, 50), rotation=(0.2, 0.1, -0.7))
    parent = bpy.context.object
    parent.scale = (0.8, 0.8, 0.8)
    cloth.parent = parent
    turn(cloth, "rotation_euler", (0.3, -0.2, 0.5), (0.3, -0.2, 1.1))
    turn(parent, "location", (200, 100, 50), (210, 100, 55))
    return cloth


def test_a_turning_scaled_parented_cloth_in_centimetres_is_where_the_engine_has_it() -> None:
    cloth = tilted_scene()
    base = np.array([tuple(v.co) for v in cloth.data.vertices])
    pins = [v.index for v in cloth.data.vertices if v.co.y > 24.9]

    def placed(frame: int) -> np.ndarray:
        """The mesh as it is modelled, in the world, in metres: without the engine, and without evaluated meshes."""
        bpy.context.scene.frame_set(frame)
        matrix = np.array(cloth.matrix_world, float)
        return 0.01 * (base @ matrix[:3, :3].T + matrix[:3, 3])

    at = {frame: placed(frame) for frame in range(1, 13)}
    done = bake()
    assert 0 < done.report["strain"]["Sheet"]["most"] < 1

    # The engine is sensitive to the last bits of its input: they are compared, then the same bits are simulated here.
    inputs = Job.read(done.folder)
    given, motion = inputs.cloths[0], MotionReader(done.folder, inputs)
    assert np.abs(given.rest - at[1]).max() < 1e-6 and np.abs(given.start - at[1]).max() < 1e-6
    assert np.array_equal(given.faces, faces(cloth)) and np.array_equal(given.uv, uv(cloth)) and list(given.pins) == pins
    world = weft.World(gravity=(0, 0, -9.81))
    world.gravity = inputs.gravity
    assert np.allclose(world.gravity, (0, 0, -9.81)) and inputs.fps == 30 / np.float32(1.001)
    sheet = world.add_cloth(weft.Mesh(given.rest, faces(cloth), uv(cloth)), fabric="cotton_shirting")
    if not np.array_equal(given.rest, given.start):
        sheet.positions = given.start
    sheet.pin(pins)
    wanted = {1: sheet.vertices}
    for frame in range(2, 13):
        before, after = motion.frame(frame - 2)["pins_0"], motion.frame(frame - 1)["pins_0"]
        assert np.abs(after - at[frame][pins]).max() < 1e-6
        for share in (0.5, 1):  # steps of 1/60 s
            sheet.set_targets(pins, before + share * (after - before))
            world.step(1 / (2 * inputs.fps))
        wanted[frame] = sheet.vertices

    for frame in FIVE:
        assert np.abs(shown(cloth, frame) - wanted[frame]).max() < TOLERANCE
    assert np.abs(shown(cloth, 12) - at[12]).max() > 0.1, "it has moved against its object"


def test_pins_follow_an_armature_from_its_pose_at_the_start() -> None:
    cloth = add_bending_body("CLOTH")
    pin(cloth, 1.0, lambda co: abs(co.y) > 0.49)
    bpy.context.scene.frame_start = 4  # the armature has bent it already
    pins = [v.index for v in cloth.data.vertices if abs(v.co.y) > 0.49]
    posed = {frame: shown(cloth, frame) for frame in range(4, 13)}
    assert np.abs(posed[4] - posed[12]).max() > 0.1
    bake()
    assert [modifier.type for modifier in cloth.modifiers] == ["ARMATURE", "MESH_CACHE"]
    assert np.abs(shown(cloth, 4) - posed[4]).max() < TOLERANCE, "it starts in its pose"
    for frame in (4, 6, 8, 10, 12):
        assert np.abs(shown(cloth, frame)[pins] - posed[frame][pins]).max() < TOLERANCE
    assert np.abs(shown(cloth, 12) - posed[12]).max() > 0.01, "the rest is cloth"


@pytest.mark.parametrize("rest", ["MESH", "START"])
def test_the_rest_shape_is_the_mesh_or_the_start(rest: str) -> None:
    """A shape key stretches the cloth at the start; without gravity it returns to its rest shape, or stays."""
    cloth = add_cloth()
    cloth.shape_key_add(name="Basis")
    key = cloth.shape_key_add(name="wide")
    for point in key.data:
        point.co.x *= 1.2
    key.value = 1
    cloth.weft.rest = rest
    bpy.context.scene.use_gravity = False
    bake()
    width = [np.ptp(shown(cloth, frame)[:, 0]) for frame in (1, 12)]
    assert width[0] == pytest.approx(1.2, abs=1e-5)
    assert abs(width[1] - 1.2) < 1e-3 if rest == "START" else width[1] < 1.15


@pytest.mark.parametrize("sews", [True, False])
def test_edges_without_faces_are_sewn(sews: bool) -> None:
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, 40
    scene.gravity = (0, 0, 0)
    strip = [(0.05 * i, 0.05 * j, 0.0) for j in range(9) for i in range(5)]
    vertices = strip + [(x + 0.3, y, z) for x, y, z in strip]
    quads = [(a, a + 1, a + 6, a + 5) for k in (0, 45) for j in range(8) for i in range(4) for a in [k + 5 * j + i]]
    sewing = [(5 * j + 4, 45 + 5 * j) for j in range(9)]
    mesh = bpy.data.meshes.new("Panels")
    mesh.from_pydata([*vertices, (9, 9, 9)], [*sewing, (0, 90)], quads)  # the last edge goes to a vertex without a face
    mesh.update()
    cloth = bpy.data.objects.new("Panels", mesh)
    scene.collection.objects.link(cloth)
    cloth.weft.role = "CLOTH"
    cloth.weft.sew, cloth.weft.sew_time = sews, 0.3
    bake()
    ends = shown(cloth, 40)
    apart = np.linalg.norm(ends[[a for a, _ in sewing]] - ends[[b for _, b in sewing]], axis=1)
    assert apart.max() < 0.003 if sews else apart.min() > 0.09


def test_keyed_and_skinned_colliders_are_not_crossed() -> None:
    scene = bpy.context.scene
    scene.frame_end = 24
    cloth = add_cloth(cells=16, location=(0, 0, 0.75))
    second = add_cloth("Napkin", cells=8, size=0.4, location=(0, 0, 0.8))
    ball = add_ball(location=(0, 0, 0.4))
    turn(ball, "location", (0, 0, 0.4), (0.1, 0, 0.5))
    turn(ball, "rotation_euler", (0, 0, 0), (0, 0.5, 1))
    bar = add_bending_body()
    bpy.context.scene.weft.colliders = bpy.data.collections.new("Bodies")
    scene.weft.colliders.objects.link(bar)
    bar.weft.role = "NONE"  # it collides by its collection
    done = bake()
    assert done.report["crossings"]["most"] == 0 and "Nothing crosses in any of 24 frames." in done.words
    for frame in (1, 6, 12, 18, 24):
        assert crossings([cloth, second], [ball, bar], frame) == 0
    assert shown(cloth, 24)[:, 2].max() > 0.7, "it lies on the ball"


def test_a_collider_with_a_modifier_that_makes_vertices() -> None:
    cloth = add_cloth(cells=12, location=(0, 0, 0.75))
    bpy.ops.mesh.primitive_cube_add(size=0.6, location=(0, 0, 0.4))
    cube = bpy.context.object
    cube.weft.role = "COLLIDER"
    cube.modifiers.new("Subdivision", "SUBSURF").levels = 2
    cube.scale = (-1, 1, 1)  # mirrored: its triangles face inwards
    done = bake()
    assert not any("inside out" in sentence or "turned" in sentence for sentence in done.words)
    assert shown(cloth, 12)[:, 2].max() > 0.6


def test_a_weight_of_a_half_sags_by_the_formula() -> None:
    scene = bpy.context.scene
    scene.frame_end = 49
    cloth = add_cloth()
    pin(cloth, 0.5, lambda co: True)
    bake()
    assert np.abs(shown(cloth, 49) - shown(cloth, 49, without_weft=True) + (0, 0, 9.81 / 20**2)).max() < 2e-4


def test_numbers_of_a_fabric_are_those_of_its_name_until_changed() -> None:
    scene = bpy.context.scene
    scene.unit_settings.scale_length = 0.01
    cloth = add_cloth(size=100)
    cloth.weft.fabric = "denim"
    assert cloth.weft.thickness * 0.01 == pytest.approx(weft.find_fabric("denim").thickness)
    bake_job = begin()
    assert bake_job._gather.job.cloths[0].fabric == weft.find_fabric("denim")._asdict()
    bake_job.cancel()
    finish(bake_job)
    cloth.weft.c11, cloth.weft.thickness = 500, 0.2
    bake_job = begin()
    fabric = bake_job._gather.job.cloths[0].fabric
    bake_job.cancel()
    finish(bake_job)
    assert (fabric["c11"], fabric["stretch_warp"]) == (500, []) and fabric["stretch_weft"]
    assert fabric["thickness"] == pytest.approx(0.002)


def test_the_cache_is_in_front_of_a_subdivision_and_nothing_else_changes() -> None:
    scene = bpy.context.scene
    cloth = add_cloth()
    pin(cloth, 1.0, lambda co: co.x < -0.49)
    cloth.modifiers.new("Subdivision", "SUBSURF")
    add_ball(location=(2, 0, 0))
    hidden = cloth.modifiers.new("Off", "WAVE")
    hidden.show_viewport = hidden.show_render = False
    scene.frame_set(5, subframe=0.25)

    def state() -> list[Any]:
        return [scene.frame_current, scene.frame_subframe, scene.frame_start, scene.frame_end] + [
            (thing.name, tuple(map(tuple, thing.matrix_world)), thing.mode, thing.select_get(),
             [(m.name, m.show_viewport, m.show_render) for m in thing.modifiers if m.type != "MESH_CACHE"])
            for thing in scene.objects
        ]  # fmt: skip

    before, objects = state(), len(bpy.data.objects)
    bake()
    assert state() == before and len(bpy.data.objects) == objects
    assert [modifier.type for modifier in cloth.modifiers] == ["MESH_CACHE", "SUBSURF", "WAVE"]
    assert len(shown(cloth, 12)) == 21 * 21
    assert shown(cloth, 12)[:, 2].min() < 0.7
    bake()  # again, with the modifier that is there
    assert [modifier.type for modifier in cloth.modifiers] == ["MESH_CACHE", "SUBSURF", "WAVE"]


def test_frames_are_seen_as_they_come_and_a_cancelled_bake_is_resumed(blend: Path) -> None:
    scene = bpy.context.scene
    scene.frame_end = 40
    cloth = add_cloth(cells=12, location=(0, 0, 0.75))
    ball = add_ball(location=(0, 0, 0.4))
    whole = bake()
    assert whole.frames == 40
    unbroken = cache_of(cloth).read_bytes()

    again = begin()
    seen = []
    while again.poll() and again.frames < 8:
        if again.frames > 2 and not seen:
            seen.append(shown(cloth, 3))
        time.sleep(0.002)
    again.cancel()
    finish(again)
    assert again.outcome == "cancelled" and "are baked" in again.words[0], again.words
    frames = weft._core.PointCacheFile(str(cache_of(cloth))).num_frames
    assert frames >= 8 and again.frames == frames
    points = [np.frombuffer(data, "<f4", 3 * 13 * 13, 32 + 2 * 12 * 13 * 13) for data in (unbroken, cache_of(cloth).read_bytes())]
    assert np.array_equal(*points)
    assert len(seen) == 1 and np.array_equal(seen[0], shown(cloth, 3))

    bpy.ops.wm.save_mainfile()
    resumed = finish(begin(resume=True))
    assert resumed.outcome == "done" and cache_of(cloth).read_bytes() == unbroken

    scene.weft.quality = "high"
    with pytest.raises(job.Refused, match="has changed"):
        begin(resume=True)
    scene.weft.quality = "default"
    ball.location.z = 0.45
    with pytest.raises(job.Refused, match='start of "Ball"'):
        begin(resume=True)

    assert bpy.ops.weft.free() == {"FINISHED"}
    assert not cloth.modifiers and not (blend.parent / "weft_cache" / "shot_Scene").exists()
    assert not bpy.ops.weft.resume.poll()
    ball.location.z = 0.4
    bake()
    assert cache_of(cloth).read_bytes() == unbroken


def test_a_bake_that_is_cancelled_at_once_ends() -> None:
    add_cloth()
    cancelled = begin()
    cancelled.cancel()
    finish(cancelled)
    assert cancelled.outcome == "cancelled" and cancelled.words[0].startswith("Cancelled: "), cancelled.words


def test_an_engine_that_is_killed_is_told_and_resumed() -> None:
    bpy.context.scene.frame_end = 40
    cloth = add_cloth(cells=12)
    pin(cloth, 1.0, lambda co: co.x < -0.49)
    bake()
    unbroken = cache_of(cloth).read_bytes()
    killed = begin()
    while killed.poll() and killed.frames < 5:
        time.sleep(0.002)
    os.kill(killed.pid, 9)
    finish(killed)
    assert killed.outcome == "failed" and "Resume goes on" in killed.words[0]
    assert finish(begin(resume=True)).outcome == "done"
    assert cache_of(cloth).read_bytes() == unbroken


def test_a_bake_outlives_blender(tmp_path: Path) -> None:
    bpy.context.scene.frame_end = 30
    cloth = add_cloth(cells=12)
    pin(cloth, 1.0, lambda co: co.x < -0.49)
    bake()
    unbroken = cache_of(cloth).read_bytes()
    bpy.ops.wm.save_mainfile()
    code = textwrap.dedent(f"""
        import importlib, os, sys, time, bpy
        bpy.ops.preferences.addon_enable(module="bl_ext.user_default.weft")
        bpy.ops.wm.open_mainfile(filepath={bpy.data.filepath!r})
        job = importlib.import_module("bl_ext.user_default.weft.job").Job(bpy.context.scene, bpy.context.view_layer)
        while job.poll() and job.frames < 3:
            time.sleep(0.002)
        print(job.pid, flush=True)
        os._exit(9)
    """)
    died = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=100)
    assert died.returncode == 9, died.stderr
    resumed = finish(begin(resume=True))  # takes over from the engine, if that still works
    assert resumed.outcome == "done" and cache_of(cloth).read_bytes() == unbroken


def test_undo_takes_the_modifier_away_and_the_blend_opens_elsewhere(blend: Path, tmp_path: Path) -> None:
    cloth = add_cloth()
    pin(cloth, 1.0, lambda co: co.x < -0.49)
    bpy.ops.ed.undo_push(message="before")
    assert bpy.ops.weft.bake() == {"FINISHED"}
    bpy.ops.ed.undo_push(message="after")
    assert bpy.data.objects["Sheet"].modifiers
    bpy.ops.ed.undo()
    assert not bpy.data.objects["Sheet"].modifiers
    bpy.ops.ed.redo()
    cloth = bpy.data.objects["Sheet"]
    wanted = [shown(cloth, frame) for frame in FIVE]
    bpy.ops.wm.save_mainfile()
    shutil.copytree(blend.parent, tmp_path / "elsewhere", ignore=shutil.ignore_patterns("elsewhere"))
    shutil.rmtree(blend.parent / "weft_cache")
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "elsewhere" / blend.name))
    cloth = bpy.data.objects["Sheet"]
    assert "Nothing crosses" in bpy.context.scene.weft.report
    for frame, points in zip(FIVE, wanted, strict=True):
        assert np.array_equal(shown(cloth, frame), points)


def test_a_frame_range_and_a_gravity_of_its_own() -> None:
    scene = bpy.context.scene
    scene.weft.own_range, scene.weft.first_frame, scene.weft.last_frame = True, -3, 5
    scene.gravity = (3, 0, 0)
    cloth = add_cloth()
    bake()
    fallen = shown(cloth, 5) - shown(cloth, -3)
    time_s = 8 / 24
    assert fallen[:, 0].mean() == pytest.approx(0.5 * 3 * time_s**2, rel=0.1) and abs(fallen[:, 2]).max() < 1e-4
    assert cache_of(cloth).stat().st_size == 32 + 9 * 12 * 121
