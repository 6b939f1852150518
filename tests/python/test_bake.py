"""Bakes for other programs: `python -m weft.bake`, its caches, kills, cancels and errors."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import weft
from weft import bake
from worlds import triangulated

FPS, FRAMES = 24.0, 13
GRAVITY = (0.0, 0.0, -9.81)


def upright(mesh: weft.Mesh) -> np.ndarray:
    """A mesh of the plane y = 0 in the plane z = 1, z up."""
    return mesh.vertices[:, [0, 2, 1]] * (1, 1, 0) + (0, 0, 1)


def to_world(frame: int) -> np.ndarray:
    """The object's own coordinates turn, move and shrink during the bake."""
    angle = 0.1 * frame
    matrix = np.eye(4)
    matrix[:2, :2] = 0.01 * np.array([(np.cos(angle), -np.sin(angle)), (np.sin(angle), np.cos(angle))])
    matrix[2, 2], matrix[:3, 3] = 0.02, (frame / 10, 3, -2)
    return matrix


def ball(frame: int) -> np.ndarray:
    """An octahedron that rises into the cloth."""
    points = np.array([(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)], float)
    return (0.2 * points + (0.5, 0.5, 0.75 + 0.01 * frame)).astype(np.float32).astype(float)  # as jobs store it


BALL_FACES = np.array([(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)], np.int32)


def make_job(folder: Path, *, weights: tuple[float, float] = (1.0, 1.0), **settings: Any) -> bake.Job:
    mesh = triangulated(10)
    points = upright(mesh)
    pins = np.flatnonzero((points[:, 1] == 0) & ((points[:, 0] == 0) | (points[:, 0] == 1))).astype(np.int32)
    cloth = bake.ClothInput(
        name="sheet", cache=str(folder / "caches" / "sheet.pc2"), fabric=weft.find_fabric("denim")._asdict(),
        rest=points, start=points, faces=mesh.faces[:, ::-1].copy(), uv=points[:, :2][mesh.faces[:, ::-1]],
        pins=pins, weights=np.array(weights),
    )  # fmt: skip
    body = bake.ColliderInput("ball", ball(0), BALL_FACES)
    job = bake.Job(fps=FPS, num_frames=FRAMES, cloths=[cloth], colliders=[body], steps_per_frame=2, threads=1, **settings)
    job.write(folder)
    return job


def pins_at(job: bake.Job, frame: int) -> np.ndarray:
    return job.cloths[0].start[job.cloths[0].pins] + (0, 0, 0.005 * frame)


def write_motion(folder: Path, job: bake.Job, frames: int = FRAMES) -> bake.MotionWriter:
    writer = bake.MotionWriter(folder, job)
    for k in range(writer.num_frames, frames):
        writer.add_frame([to_world(k)], [pins_at(job, k)], [ball(k)])
    return writer


def start(folder: Path, **how: Any) -> subprocess.Popen[str]:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    return subprocess.Popen([sys.executable, "-m", "weft.bake", str(folder)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                            text=True, env=environment, **how)  # fmt: skip


def finish(process: subprocess.Popen[str]) -> tuple[int, dict[str, Any]]:
    out, _ = process.communicate(timeout=200)
    last: dict[str, Any] = json.loads(out.splitlines()[-1])
    assert last["event"] == "end"
    return process.returncode, last


def bake_all(folder: Path) -> tuple[int, dict[str, Any]]:
    return finish(start(folder))


@pytest.fixture
def baked(tmp_path: Path) -> bytes:
    """The cache of an unbroken bake."""
    folder = tmp_path / "unbroken"
    write_motion(folder, make_job(folder))
    code, report = bake_all(folder)
    assert (code, report["outcome"], report["frames"]) == (0, "done", FRAMES)
    return (folder / "caches" / "sheet.pc2").read_bytes()


def test_the_cache_is_the_world_in_the_coordinates_of_the_object(tmp_path: Path) -> None:
    job = make_job(tmp_path)
    write_motion(tmp_path, job)
    code, report = bake_all(tmp_path)
    assert code == 0 and report == {"event": "end", **json.loads((tmp_path / "report.json").read_text())}
    given = job.cloths[0]
    world = weft.World(gravity=GRAVITY)
    world.integrator = weft.IntegratorSettings(newton=weft.NewtonSettings(quality="default"))
    body = world.add_collider(weft.Mesh(ball(0), BALL_FACES), friction=0.3)
    sheet = world.add_cloth(weft.Mesh(given.rest, given.faces, given.uv), fabric="denim")
    sheet.pin(given.pins)
    cache = weft._core.PointCacheFile(given.cache)
    assert (cache.num_points, cache.num_frames) == (len(given.rest), FRAMES)
    for k in range(FRAMES):
        for half in (0.5, 1.0) if k else ():
            sheet.set_targets(given.pins, pins_at(job, k - 1) + half * (pins_at(job, k) - pins_at(job, k - 1)))
            body.move_vertices(ball(k - 1) + half * (ball(k) - ball(k - 1)))
            world.step(1 / (2 * FPS))
        local = np.c_[cache.frame(k), np.ones(cache.num_points)]
        np.testing.assert_allclose((local @ to_world(k).T)[:, :3], sheet.vertices, atol=2e-6)
    assert not len(weft.find_crossings([(sheet.positions, sheet.faces)], colliders=[(ball(FRAMES - 1), BALL_FACES)]))
    assert report["crossings"]["most"] == 0 and "Nothing crosses in any of 13 frames." in report["words"]
    assert report["strain"]["sheet"]["last"] == pytest.approx(sheet.stretches.max() - 1, abs=1e-5)


def test_a_killed_bake_goes_on_to_the_same_bytes(tmp_path: Path, baked: bytes) -> None:
    job = make_job(tmp_path)
    write_motion(tmp_path, job, 6)
    process = start(tmp_path)
    assert process.stdin is not None and process.stdout is not None
    while '"frames": 6' not in process.stdout.readline():
        pass
    process.stdin.close()  # the program has gone: what is there is baked, and kept in a checkpoint
    assert process.wait(100) == 130
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["message"] == "No further frames have come: frames 1 to 6 are baked."
    cache = Path(job.cloths[0].cache)
    assert cache.read_bytes()[:28] == baked[:28] and cache.read_bytes()[32:] == baked[32 : len(cache.read_bytes())]

    write_motion(tmp_path, job, 10)
    process = start(tmp_path)
    assert process.stdout is not None
    while '"frames": 9' not in process.stdout.readline():
        pass
    process.kill()  # after the checkpoint of frame 6, before another one
    process.wait()
    with cache.open("ab") as stream:
        stream.write(b"half a frame")
    write_motion(tmp_path, job)
    code, report = bake_all(tmp_path)
    assert (code, report["frames"], cache.read_bytes()) == (0, FRAMES, baked)
    assert bake_all(tmp_path)[0] == 0 and cache.read_bytes() == baked, "a bake that is done stays done"


def test_a_cancelled_bake_keeps_its_frames_and_goes_on(tmp_path: Path, baked: bytes) -> None:
    job = make_job(tmp_path)
    writer = write_motion(tmp_path, job, 7)
    process = start(tmp_path)
    assert process.stdout is not None
    while '"frames": 7' not in process.stdout.readline():
        pass
    process.send_signal(signal.SIGTERM)  # it waits for frame 8
    code, report = finish(process)
    assert (code, report["message"]) == (130, "Cancelled: frames 1 to 7 are baked.")
    assert weft._core.PointCacheFile(job.cloths[0].cache).num_frames == 7
    writer.close()
    write_motion(tmp_path, job)
    process = start(tmp_path)
    assert process.stdout is not None and "start" in process.stdout.readline()
    process.send_signal(signal.SIGINT)  # wherever it is then
    finish(process)
    assert bake_all(tmp_path)[0] == 0 and Path(job.cloths[0].cache).read_bytes() == baked


def test_a_second_bake_takes_over(tmp_path: Path, baked: bytes) -> None:
    job = make_job(tmp_path)
    write_motion(tmp_path, job)
    first = start(tmp_path)
    assert first.stdout is not None
    while '"frames": 3' not in first.stdout.readline():
        pass
    code, report = bake_all(tmp_path)
    assert (code, Path(job.cloths[0].cache).read_bytes()) == (0, baked)
    finish(first)


def test_weights_between_0_and_1_are_springs_of_the_formula(tmp_path: Path) -> None:
    mesh = triangulated(4)
    points = upright(mesh)
    count = len(points)
    cloth = bake.ClothInput(
        "cloth", str(tmp_path / "cloth.pc2"), weft.find_fabric("denim")._asdict(), points, points, mesh.faces, None,
        (1.0, 0.0, 0.0), np.arange(count, dtype=np.int32), np.full(count, 0.5),
    )  # fmt: skip
    job = bake.Job(fps=FPS, num_frames=49, cloths=[cloth], steps_per_frame=2)
    job.write(tmp_path)
    writer = bake.MotionWriter(tmp_path, job)
    for _ in range(49):
        writer.add_frame([np.eye(4)], [points], [])
    assert bake_all(tmp_path)[0] == 0
    end = weft._core.PointCacheFile(cloth.cache).frame(48)
    np.testing.assert_allclose(end[:, 2], 1 - 9.81 / 400, atol=2e-4)  # all alike: nothing but the springs


def test_the_start_is_a_pose_of_its_own(tmp_path: Path) -> None:
    """Rest shape and start differ, and a vertex without a face stays where the program has it."""
    job = make_job(tmp_path)
    cloth = job.cloths[0]
    cloth.rest = np.r_[cloth.rest, [(9, 9, 9)]]
    cloth.start = cloth.rest * (0.5, 0.5, 1) + (0.25, 0.25, 0.5)
    job.write(tmp_path)
    write_motion(tmp_path, job, 2)
    process = start(tmp_path)
    _, report = finish(process)
    assert report["frames"] == 2
    cache = weft._core.PointCacheFile(cloth.cache)
    for k in (0, 1):
        end = (np.c_[cache.frame(k), np.ones(cache.num_points)] @ to_world(k).T)[:, :3]
        np.testing.assert_allclose(end[-1], cloth.start[-1], atol=1e-5)
        assert k or np.abs(end - cloth.start).max() < 2e-6


@pytest.mark.parametrize(
    "change, sentence",
    [
        (lambda job: (setattr(job.cloths[0], "faces", job.cloths[0].faces[:0]), setattr(job.cloths[0], "uv", None)), "sheet"),
        (lambda job: job.cloths[0].fabric.update(density=-1.0), "density"),
        (lambda job: setattr(job.cloths[0], "cache", "/proc/nowhere/sheet.pc2"), "cannot be written"),
        (lambda job: job.cloths[0].rest.__setitem__((0, 0), np.nan), "sheet"),
    ],
)  # fmt: skip
def test_what_cannot_be_baked_is_refused_in_a_sentence(tmp_path: Path, change: Any, sentence: str) -> None:
    job = make_job(tmp_path)
    change(job)
    job.write(tmp_path)
    write_motion(tmp_path, make_job(tmp_path / "other"), 0)
    process = start(tmp_path)
    code, report = finish(process)
    assert code == 2 and sentence in report["message"], report["message"]


def test_a_folder_without_a_job_is_refused(tmp_path: Path) -> None:
    code, report = bake_all(tmp_path)
    assert code == 2 and report["message"] == f"{tmp_path} holds no job: there is no job.json"
    make_job(tmp_path)
    (tmp_path / "job.json").write_text('{"format": 1}')
    assert bake_all(tmp_path)[0] == 2


def test_jobs_tell_what_differs(tmp_path: Path) -> None:
    one, other = make_job(tmp_path), make_job(tmp_path)
    assert bake.Job.read(tmp_path).difference(one) == ""
    other.fps = 25
    assert one.difference(other) == "fps"
    other = make_job(tmp_path)
    other.cloths[0].start = other.cloths[0].start + 0.1
    assert one.difference(other) == 'start of "sheet"'


@pytest.mark.parametrize(
    ("engine", "program"),
    [
        ("raise solver.max_steps_per_frame or solver.steps_per_frame", "raise the quality"),
        ("raise solver.iterations or solver.steps_per_frame", "raise the quality"),
        ("raise steps_per_frame", "raise the quality"),
        ("solver.steps_per_frame is 4", "the quality is 4"),
    ],
)
def test_keys_of_scenes_are_settings_of_the_program(engine: str, program: str) -> None:
    assert bake._in_words(engine) == program
