"""Scenes and runs: the same hash by the program, weft.run, steps of a world, batches and hand-written calls."""

from __future__ import annotations

import copy
import gc
import json
import subprocess
import sys
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
import weft
from worlds import program, python

FRAMES = 3
FEWER = {"contact/stack": 1}  # the largest one


@cache
def report_of_program(name: str, frames: int | None, *options: str) -> dict[str, Any]:
    """The report of `weft run`."""
    if not program().exists():
        pytest.skip(f"there is no program {program()}; WEFT_PROGRAM names it")
    with TemporaryDirectory() as folder:
        length = [] if frames is None else ["--frames", str(frames)]
        command = [program(), "run", name, *length, "--out", folder, "--no-glb", "--no-pc2", "--threads", "1", *options]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300)
        assert done.returncode == 0, done.stdout + done.stderr
        report: dict[str, Any] = json.loads((Path(folder) / "report.json").read_text())
        assert report["state_hash"] in done.stdout
        return report


def hash_of_program(name: str, frames: int | None) -> str:
    digits: str = report_of_program(name, frames, "--no-passages")["state_hash"]
    return digits


def advanced(world: weft.World, scene: weft.Scene, frames: int) -> weft.World:
    for _ in range(frames * scene.steps_per_frame):
        world.step(scene.dt)
    return world


def test_all_scenes_are_here() -> None:
    folder = Path(__file__).parents[2] / "scenes"
    if not folder.is_dir():
        pytest.skip("the folder of scenes is not beside the tests")
    assert weft.scenes() == sorted(str(file.relative_to(folder).with_suffix("")) for file in folder.rglob("*.toml"))


@pytest.mark.filterwarnings("ignore::weft.SimulationWarning")
@pytest.mark.parametrize("name", weft.scenes())
def test_every_way_to_run_a_scene_has_the_hash_of_the_program(name: str) -> None:
    frames = FEWER.get(name, FRAMES)
    expected = hash_of_program(name, frames)
    scene = weft.load_scene(name)
    assert weft.run(scene, frames=frames, glb=False, check_passages=False).report["state_hash"] == expected
    start = scene.world()
    hashes = {"world": advanced(start.clone(), scene, frames).state_hash()}
    for threads in (1, 3):
        batch = weft.Batch(lambda i: start, threads, threads=threads)
        for _ in range(frames * scene.steps_per_frame):
            batch.step(scene.dt)
        for i in range(threads):
            hashes[f"batch of {threads}, world {i}"] = batch[i].state_hash()
    assert hashes == dict.fromkeys(hashes, expected)


@pytest.mark.filterwarnings("ignore::weft.SimulationWarning")
@pytest.mark.parametrize("name", ["flag", "paper/fig6_ball_real"])  # wind with keys; contact
def test_scenes_to_their_ends(name: str) -> None:
    scene = weft.load_scene(name)
    assert advanced(scene.world(), scene, scene.num_frames).state_hash() == hash_of_program(name, None)


def ball_by_hand() -> weft.World:
    world = weft.World(integrator="paper")
    springs = weft.Springs(density=0.2, structural=200, shear=100, bend=2, damping=0.01, damping_kind="plain")
    world.add_cloth(weft.grid(size=(1, 1), cells=(32, 32)), fabric=springs, model="simplified",
                    position=(-0.5, 0.8, -0.5))  # fmt: skip
    world.add_collider(weft.Sphere(center=(0, 0.4, 0), radius=0.3), friction=0.3, name="ball")
    return world


def test_the_papers_ball_by_hand_has_the_hash_of_its_scene() -> None:
    frames = 30
    world = ball_by_hand()
    for _ in range(frames * 100):
        world.step(1 / 6000)
    assert len(world.contacts) > 0
    assert world.state_hash() == hash_of_program("paper/fig6_ball", frames)


# Runs.


@pytest.fixture(scope="module")
def ball(tmp_path_factory: pytest.TempPathFactory) -> weft.Run:
    return weft.run("paper/fig6_ball", frames=12, out=tmp_path_factory.mktemp("run"))


def test_positions_are_mapped_from_disk(ball: weft.Run) -> None:
    positions = ball.positions["cloth"]
    assert isinstance(positions, np.memmap)
    assert positions.shape == (13, 1089, 3) and positions.dtype == np.dtype("<f4")
    assert not positions.flags.writeable and positions.offset == 32
    assert list(ball.positions) == ["cloth"] and len(ball.positions) == 1
    scene = weft.load_scene("paper/fig6_ball")
    world = scene.world()
    for frame in range(13):
        assert np.array_equal(positions[frame], world.cloths[0].positions.astype(np.float32)), frame
        advanced(world, scene, 1)


def test_a_run_is_a_folder_and_is_opened_again(ball: weft.Run) -> None:
    again = weft.open_run(ball.folder)
    assert again.report == ball.report and again.name == ball.name == "paper/fig6_ball"
    assert (again.num_frames, again.outcome, again.problems) == (12, "done", [])
    assert np.array_equal(again.positions["cloth"], ball.positions["cloth"])
    assert repr(again) == f"<weft.Run of 'paper/fig6_ball': 12 frames, done, in {str(ball.folder)!r}>"


def test_run_json_names_the_files(ball: weft.Run) -> None:
    contents = json.loads((ball.folder / "run.json").read_text())
    cloth = {"name": "cloth", "positions": "cloth.pc2", "mesh": "cloth.mesh.obj", "color": [0.58, 0.06, 0.05],
             "vertices": 1089, "particles": 1089}  # fmt: skip
    assert len(contents.pop("scene_hash")) == 16
    assert contents == {"format": 1, "weft": weft.__version__, "scene": "paper/fig6_ball", "fps": 60, "frames": 12,
                        "cloths": [cloth], "animation": "animation.glb", "report": "report.json"}  # fmt: skip
    assert sorted(file.name for file in ball.folder.iterdir()) == [
        "animation.glb", "as_run", "cloth.mesh.obj", "cloth.pc2", "report.json", "run.json"
    ]  # fmt: skip


def test_the_report_is_that_of_the_program(ball: weft.Run) -> None:
    theirs = report_of_program("paper/fig6_ball", 12)
    measured = {"ms_per_frame", "cpu_ms_per_frame", "work", "untangle_seconds"}
    assert set(ball.report) == set(theirs)
    for key in set(theirs) - measured:
        assert ball.report[key] == theirs[key], key


def test_a_run_with_another_number_of_threads_is_the_same(ball: weft.Run) -> None:
    other = weft.run("paper/fig6_ball", frames=12, threads=2, glb=False)
    assert other.report["state_hash"] == ball.report["state_hash"]
    assert np.array_equal(other.positions["cloth"], ball.positions["cloth"])


def test_results_without_a_folder_go_with_their_object() -> None:
    run = weft.run("drape_box", frames=1, glb=False)
    folder, positions = run.folder, run.positions["cloth"]
    before = positions.copy()
    assert folder.is_dir()
    del run
    gc.collect()
    assert not folder.exists()
    assert np.array_equal(positions, before)  # a mapped file stays readable


def test_obj_files_are_written(tmp_path: Path) -> None:
    run = weft.run("paper/fig6_ball", frames=1, out=tmp_path, glb=False, obj=True)
    files = sorted((tmp_path / "obj").iterdir())
    assert len(files) == 2
    for frame, file in enumerate(files):
        mesh = weft.read_obj(file)
        assert abs(mesh.vertices - run.positions["cloth"][frame]).max() < 1e-5
        assert len(mesh.faces) == 2 * 32 * 32


def test_an_audit_adds_the_energy_balance() -> None:
    plain, audited = (weft.run("drape_box", frames=2, glb=False, audit=audit) for audit in (False, True))
    assert plain.report["energy"]["left_over"] is None
    left_over, kinetic = np.array(audited.report["energy"]["left_over"]), np.array(audited.report["energy"]["kinetic"])
    assert left_over.shape == (2,) and (abs(left_over) < 1e-4 * kinetic).all()  # of a free fall
    assert audited.report["state_hash"] == plain.report["state_hash"]


def test_a_second_run_replaces_the_first(tmp_path: Path) -> None:
    weft.run("paper/fig6_ball", frames=2, out=tmp_path)
    second = weft.run("drape_box", frames=1, out=tmp_path, glb=False)
    opened = weft.open_run(tmp_path)
    assert opened.name == "drape_box" and opened.report == second.report
    with pytest.raises(weft.InputError, match="glb=True"):
        opened.picture()


def test_a_killed_run_goes_on(tmp_path: Path) -> None:
    whole = weft.run("paper/fig6_ball", frames=8, out=tmp_path / "whole")
    kill = "lambda frame, *rest: os.kill(os.getpid(), 9) if frame == 6 else None"
    program = (
        f"import os, weft; weft.run('paper/fig6_ball', frames=8, out={str(tmp_path / 'cut')!r}, "
        f"checkpoint_every=2, progress={kill})"
    )
    assert subprocess.run([sys.executable, "-c", program], check=False).returncode == -9
    with pytest.raises(weft.InputError, match="up to frame 4 of 8"):
        weft.run("paper/fig6_ball", frames=8, out=tmp_path / "cut")
    frames: list[int] = []
    cut = weft.run(
        "paper/fig6_ball", frames=8, out=tmp_path / "cut", unfinished="resume",
        progress=lambda frame, *rest: frames.append(frame),
    )  # fmt: skip
    assert frames == [5, 6, 7, 8]
    assert cut.report["state_hash"] == whole.report["state_hash"]
    assert np.array_equal(cut.positions["cloth"], whole.positions["cloth"])
    with pytest.raises(weft.InputError, match='unfinished: expected one of "refuse", "resume", "discard"'):
        weft.run("paper/fig6_ball", frames=1, unfinished="maybe")  # type: ignore[arg-type]


def test_a_scene_starts_from_a_frame_of_a_run(tmp_path: Path) -> None:
    old = weft.run("paper/fig6_ball", frames=4, out=tmp_path / "old")
    frame = old.positions["cloth"]
    for start_from, number in ((f"{tmp_path}/old@2", 2), (tmp_path / "old", 4), (old, 4)):
        new = weft.run("paper/fig6_ball", frames=1, start_from=start_from)
        assert new.num_frames == 1
        assert np.allclose(new.positions["cloth"][0], frame[number], rtol=0, atol=2e-7)  # floats below 2 m
        assert new.report["notes"] == [f'cloth "cloth" starts from frame {number} of {tmp_path}/old']


@pytest.mark.parametrize("has_tqdm", [False, True])
def test_progress_is_shown(has_tqdm: bool) -> None:
    if has_tqdm:
        pytest.importorskip("tqdm", reason="the Python package tqdm is missing")
    hide = "" if has_tqdm else "sys.modules['tqdm'] = sys.modules['tqdm.auto'] = None; "
    done = python(f"import sys; {hide}import weft; weft.run('drape_box', frames=2, glb=False, progress=True)")
    assert done.returncode == 0 and done.stdout == ""
    shown = done.stderr.replace("\r", "\n")
    assert "drape_box" in shown and ("2/2" in shown if has_tqdm else "frame 2 of 2" in shown)


def test_pictures_of_frames(ball: weft.Run, tmp_path: Path) -> None:
    try:
        last = ball.picture(size=(160, 120))
    except weft.GraphicsError as error:
        pytest.skip(f"there is no OpenGL: {error}")
    first = ball.picture(frame=0, size=(160, 120))
    assert isinstance(last, weft.Picture) and last.shape == (120, 160, 3) and last.dtype == np.uint8
    assert len(np.unique(last.reshape(-1, 3), axis=0)) > 20  # cloth and ball, shaded
    assert (first != last).any() and np.array_equal(last, ball.picture(frame=12, size=(160, 120)))
    seen = ball.picture(frame=3, camera=weft.Camera(position=(0, 1, 3), target=(0, 0.5, 0), size=(64, 48)))
    assert seen.shape == (48, 64, 3)
    png = last._repr_png_()
    assert png is not None and png.startswith(b"\x89PNG")
    last.save(tmp_path / "last.png")
    assert (tmp_path / "last.png").read_bytes() == png


def test_depth_and_ids_of_a_world_need_no_opengl() -> None:
    world = ball_by_hand()
    camera = weft.Camera(position=(0, 0.4, 3), target=(0, 0.4, 0), fov_deg=30, size=(65, 65))
    seen = camera.render(world, color=False)
    assert seen.depth.shape == seen.ids.shape == (65, 65) and seen.rgb.size == 0
    assert (seen.depth.dtype, seen.ids.dtype) == (np.float32, np.int32)
    assert seen.ids[32, 32] == 1 and seen.depth[32, 32] == pytest.approx(2.7, abs=1e-3)  # the ball, in front
    assert set(np.unique(seen.ids)) <= {-1, 0, 1}
    assert np.array_equal(np.isinf(seen.depth), seen.ids == -1)
    focal = 65 / (2 * np.tan(np.radians(15)))
    radius = np.sqrt((seen.ids == 1).sum() / np.pi)  # of the ball's disc [pixels]
    assert radius == pytest.approx(focal * np.tan(np.arcsin(0.3 / 3)), rel=0.03)


# Scenes as objects.


def test_attributes_are_the_keys_of_scene_files() -> None:
    scene = weft.load_scene("paper/fig6_ball")
    assert (scene.name, scene.fps, scene.num_frames, scene.steps_per_frame) == ("paper/fig6_ball", 60, 180, 100)
    assert scene.dt == 1 / 6000 and scene.frames_per_second == 60
    (cloth,), (collider,) = scene.cloths, scene.colliders
    assert cloth.fabric.spring_structural == 200 and cloth.grid.cells == [32, 32] and cloth.model == "simplified"
    assert collider.name == "ball" and collider.shape == "sphere" and collider.center == [0, 0.4, 0]
    assert scene.solver.integrator == "paper" and scene.gravity == [0, -9.81, 0]  # a default
    assert "fabric" in dir(cloth) and "duration" in dir(scene)


def test_changes_are_those_of_the_programs_set() -> None:
    scene = weft.load_scene("drape_sphere")
    scene.cloths[0].fabric = "denim"
    scene.cloths[0].grid.cells = (20, 24)
    scene.solver.steps_per_frame = 2
    scene.duration = np.float64(0.05)
    options = ("cloth[0].fabric=denim", "cloth[0].grid.cells=[20, 24]", "solver.steps_per_frame=2",
               "scene.duration=0.05")  # fmt: skip
    theirs = report_of_program("drape_sphere", None, *(part for option in options for part in ("--set", option)))
    assert weft.run(scene, glb=False).report["state_hash"] == theirs["state_hash"]
    together = weft.load_scene("drape_sphere", set={"cloth[0].fabric": "denim", "cloth[0].grid.cells": [20, 24],
                                                    "solver.steps_per_frame": 2, "scene.duration": 0.05})  # fmt: skip
    assert together.to_dict() == scene.to_dict()


@pytest.mark.parametrize(
    "fabric", [weft.find_fabric("silk"), weft.Springs(structural=300), {"density": 0.1, "c11": 900}]
)
def test_fabrics_are_values_of_scenes(fabric: object) -> None:
    scene = weft.load_scene("drape_sphere")
    scene.cloths[0].fabric = fabric
    found = scene.world().cloths[0].fabric
    if isinstance(fabric, dict):
        assert isinstance(found, weft.Fabric) and (found.density, found.c11) == (0.1, 900)
    else:
        assert found == fabric


def test_scenes_are_written_and_read_back(tmp_path: Path) -> None:
    scene = weft.load_scene("drape_sphere")
    scene.duration = 0.05
    scene.write(tmp_path / "mine.toml")
    again = weft.load_scene(tmp_path / "mine.toml")
    assert again.num_frames == 3 and again.cloths[0].fabric.density == 0.2
    again.write(tmp_path / "again.toml")
    assert (tmp_path / "again.toml").read_text() == (tmp_path / "mine.toml").read_text()
    assert again.world().state_hash() == scene.world().state_hash()


def test_copies_of_scenes_are_independent() -> None:
    scene = weft.load_scene("drape_sphere")
    for twin in (scene.copy(), copy.copy(scene), copy.deepcopy(scene)):
        twin.duration = 1
        assert (twin.num_frames, scene.num_frames) == (60, 180)


def test_text_is_a_scene() -> None:
    text = "[scene]\nformat = 1\n[[cloth]]\ngrid = { size = [1, 1], cells = [4, 4] }\n"
    world = weft.load_scene(text).world(threads=2)
    assert world.threads == 2 and [cloth.num_particles for cloth in world.cloths] == [25]


def test_a_folder_of_scenes_is_found_anywhere() -> None:
    done = python("import os, weft; os.chdir('/'); print(len(weft.scenes()))")
    assert done.stdout.strip() == str(len(weft.scenes()))


SHIRT = (
    "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nv 2 0 0.1\nvt 0 0\nvt 0.5 0\nvt 0.5 1\n"
    "o shirt\ng front\nf 1/1 2/2 3/3 4/1\ng back hem\nf 2/1 5/2 3/3\n"
)


def test_polygons_of_a_file_come_back(tmp_path: Path) -> None:
    (tmp_path / "shirt.obj").write_text(SHIRT)
    mesh = weft.read_obj(tmp_path / "shirt.obj")
    polygons = mesh.polygons
    assert polygons is not None
    assert polygons.sizes.tolist() == [4, 3] and polygons.corners.tolist() == [0, 1, 2, 3, 1, 4, 2]
    assert polygons.uv is not None and polygons.uv[2].tolist() == [0.5, 1]
    assert {name: of.tolist() for name, of in polygons.groups.items()} == {"front": [0], "back": [1], "hem": [1]}
    assert polygons.vertices_of("hem").tolist() == [1, 2, 4]
    assert polygons.vertices_of("shirt").tolist() == [0, 1, 2, 3, 4]
    weft.write_obj(tmp_path / "again.obj", mesh)
    assert (tmp_path / "again.obj").read_text() == SHIRT


def test_a_simulated_mesh_is_written_with_the_faces_of_its_file(tmp_path: Path) -> None:
    (tmp_path / "shirt.obj").write_text(SHIRT)
    mesh = weft.read_obj(tmp_path / "shirt.obj")
    assert mesh.polygons is not None
    world = weft.World()
    cloth = world.add_cloth(mesh, fabric="denim")
    cloth.pin(cloth.particle_of_vertex[mesh.polygons.vertices_of("hem")])
    world.step(1 / 60)
    mesh.vertices = cloth.vertices
    weft.write_obj(tmp_path / "moved.obj", mesh)
    moved = weft.read_obj(tmp_path / "moved.obj")
    assert np.array_equal(moved.vertices, cloth.vertices) and not np.array_equal(moved.vertices[0], (0, 0, 0))
    faces = [line for line in SHIRT.splitlines() if line[:2] != "v "]
    assert [line for line in (tmp_path / "moved.obj").read_text().splitlines() if line[:2] != "v "] == faces
