"""Conversion of files, by weft.convert and `python -m weft convert`; mesh files by their endings."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import weft
from weft import _core
from worlds import python, triangulated


def write_cache(file: Path, frames: np.ndarray, times: list[float] | None = None) -> Path:
    writer = _core.PointCacheWriter(str(file), frames.shape[1], times or [0.0] * len(frames))
    for frame in frames:
        writer.add_frame(np.ascontiguousarray(frame, np.float32))
    writer.finish()
    return file


def read_cache(file: Path) -> np.ndarray:
    cache = _core.PointCacheFile(str(file))
    return np.stack([cache.frame(k) for k in range(cache.num_frames)])


def some_frames(count: int = 4, points: int = 5) -> np.ndarray:
    return np.random.default_rng(5).normal(size=(count, points, 3)).astype(np.float32)


def command(*arguments: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    """python -m weft convert …"""
    code = "import sys; from weft.__main__ import main; sys.argv[1:] = ['convert', *sys.argv[1:]]; sys.exit(main())"
    return python(f"import os; os.chdir({str(cwd)!r}); {code}", *map(str, arguments))


@pytest.mark.parametrize("ending", [".obj", ".ply"])
def test_a_mesh_is_read_as_it_was_written(ending: str, tmp_path: Path) -> None:
    mesh = triangulated(5)
    weft.write_mesh(tmp_path / f"m{ending}", mesh)
    read = weft.read_mesh(tmp_path / f"m{ending}")
    assert np.array_equal(read.vertices, mesh.vertices) and np.array_equal(read.faces, mesh.faces)
    assert mesh.uv is not None and read.uv is not None and np.array_equal(read.uv, mesh.uv)
    assert read.polygons is not None and np.array_equal(read.polygons.corners, mesh.faces.reshape(-1))
    weft.write_mesh(tmp_path / f"again{ending}", read)
    assert (tmp_path / f"again{ending}").read_bytes() == (tmp_path / f"m{ending}").read_bytes()


def test_corners_without_texture_coordinates_are_nan_and_can_be_used(tmp_path: Path) -> None:
    text = "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 1 1\nf 1/1 3/3 2/2\nf 1 4 3\n"
    (tmp_path / "half.obj").write_text(text)
    mesh = weft.read_obj(tmp_path / "half.obj")
    assert mesh.uv is not None
    assert np.isfinite(mesh.uv[0]).all() and np.isnan(mesh.uv[1]).all()
    weft.World().add_cloth(mesh)


def test_ignored_contents_are_a_warning(tmp_path: Path) -> None:
    (tmp_path / "m.obj").write_text("v 0 0 0\nv 1 0 0\nv 1 0 1\nbevel 3\nf 1 2 3\n")
    with pytest.warns(weft.FileWarning, match="bevel"):
        weft.read_mesh(tmp_path / "m.obj")


def test_a_point_cache_is_read_as_it_was_written(tmp_path: Path) -> None:
    frames = some_frames()
    write_cache(tmp_path / "a.pc2", frames)
    assert weft.convert(tmp_path / "a.pc2", tmp_path / "new" / "b.mdd", fps=24) == [tmp_path / "new" / "b.mdd"]
    assert _core.PointCacheFile(str(tmp_path / "new" / "b.mdd")).times == [np.float32(k / 24) for k in range(4)]
    weft.convert(tmp_path / "new" / "b.mdd", tmp_path / "c.pc2")
    assert read_cache(tmp_path / "c.pc2").tobytes() == frames.tobytes()
    weft.convert(tmp_path / "c.pc2", tmp_path / "d.pc2", frames=(1, 2), up="z", scale=2)
    x, y, z = np.moveaxis(frames[1:3], 2, 0)
    assert np.array_equal(read_cache(tmp_path / "d.pc2"), 2 * np.stack([x, z, -y], axis=2))


def test_what_a_file_cannot_say_is_a_warning(tmp_path: Path) -> None:
    write_cache(tmp_path / "a.pc2", 1000 * some_frames())
    with pytest.warns(weft.FileWarning) as caught:
        weft.convert(tmp_path / "a.pc2", tmp_path / "a.mdd")
    said = sorted(str(warning.message) for warning in caught)
    assert len(said) == 2
    assert said[0].endswith("a.pc2 does not say its frames per second: 60 (--fps)")
    assert re.search(r"a.pc2 is .* m large; --scale gives the length of its unit in metres$", said[1])
    assert caught[0].filename == __file__


def test_the_command_has_the_options_and_names_the_files(tmp_path: Path) -> None:
    write_cache(tmp_path / "a.pc2", some_frames())
    done = command("a.pc2", "b.mdd", "--frames", "1:", "--up", "z", "--scale", "0.5", cwd=tmp_path)
    assert (done.returncode, done.stdout) == (0, "b.mdd\n"), done.stderr
    assert done.stderr == "note: a.pc2 does not say its frames per second: 60 (--fps)\n"
    assert len(read_cache(tmp_path / "b.mdd")) == 3
    for arguments, words in (
        (["a.pc2", "c.pc2", "--frames", "1-2"], "--frames 1-2: expected FIRST:LAST, whole numbers from 0"),
        (["a.pc2", "c.pc2", "--frames", "3:7"], "a.pc2 has the frames 0 to 3; it has not 3 to 7"),
        (["a.pc2", "c.pc2", "--fps", "0"], "fps: expected a number above 0, found 0.0"),
        (["a.pc2", "c.pc2", "--node", "/a"], "node: an option of conversions from USD only"),
        (["a.pc2", "c.obj"], "c.obj: a point cache has no faces; --mesh names the mesh of its points"),
    ):
        done = command(*arguments, cwd=tmp_path)
        assert (done.returncode, done.stdout, done.stderr) == (2, "", words + "\n")
    assert not (tmp_path / "c.pc2").exists()


def test_without_usd_core_one_sentence_names_it(tmp_path: Path) -> None:
    weft.write_obj(tmp_path / "a.obj", triangulated(2))
    absent = f"import os, sys; sys.modules['pxr'] = None; os.chdir({str(tmp_path)!r})\n"
    sentence = "USD files need the Python package usd-core: pip install weft[usd]"
    done = python(absent + "import weft\ntry: weft.convert('a.obj', 'a.usdc')\nexcept ImportError as e: print(e)")
    assert (done.stdout, done.stderr) == (sentence + "\n", "")
    done = python(absent + "sys.argv = ['weft', 'convert', 'a.obj', 'a.usdc']\nimport weft.__main__ as m; m.main()")
    assert (done.stdout, done.stderr) == ("", sentence + "\n")


def test_the_program_names_the_command_for_usd(tmp_path: Path) -> None:
    with pytest.raises(weft.InputError, match="USD files are converted by `python -m weft convert`"):
        _core.convert("a.obj", "a.usdc", None, False, 1.0, 0, None, "")


@pytest.mark.parametrize(
    "call, words",
    [
        (lambda t: weft.convert(t / "no.obj", t / "a.ply"), "no.obj: cannot be read"),
        (lambda t: weft.convert(t / "a.obj", t / "a.fbx"), "a.fbx: a mesh is written as .obj or .ply"),
        (lambda t: weft.convert(t, t / "a.pc2"), "holds no run: there is no run.json"),
        (lambda t: weft.convert(t / "a.obj", t / "a.ply", up="x"), "up: expected \"y\" or \"z\", found 'x'"),
        (lambda t: weft.convert(t / "a.obj", t / "a.ply", scale=-1), "scale: expected a number above 0, found -1"),
        (lambda t: weft.convert(t / "a.obj", t / "a.ply", frames=(-1, 2)), "frames: expected whole numbers from 0"),
        (lambda t: weft.convert(t / "a.obj", t / "a.ply", frames=(1, 2, 3)), "frames: expected the first and the"),
        (lambda t: weft.convert(t / "a.obj", t / "a.ply", mesh="b.obj"), "b.obj: only a point cache that becomes"),
    ],
)
def test_mistakes(call: Callable[[Path], object], words: str, tmp_path: Path) -> None:
    weft.write_obj(tmp_path / "a.obj", triangulated(2))
    with pytest.raises(weft.InputError, match=re.escape(words)):
        call(tmp_path)
    assert [file.name for file in tmp_path.iterdir()] == ["a.obj"]


def test_an_unfinished_point_cache_leaves_the_earlier_file(tmp_path: Path) -> None:
    file = write_cache(tmp_path / "a.mdd", some_frames())
    before = file.read_bytes()
    writer = _core.PointCacheWriter(str(file), 5, [0.0, 1.0])
    writer.add_frame(some_frames()[0])
    with pytest.raises(weft.InputError, match="a.mdd: 1 frames, expected 2"):
        writer.finish()
    with pytest.raises(weft.InputError, match="not finite"):
        writer.add_frame(np.full((5, 3), np.nan, np.float32))
    del writer
    assert file.read_bytes() == before and [f.name for f in tmp_path.iterdir()] == ["a.mdd"]


def test_a_point_cache_becomes_a_sequence_of_meshes(tmp_path: Path) -> None:
    frames = some_frames(3, 9)
    write_cache(tmp_path / "a.pc2", frames)
    weft.write_obj(tmp_path / "m.obj", triangulated(2))
    files = weft.convert(tmp_path / "a.pc2", tmp_path / "walk.ply", mesh=tmp_path / "m.obj", frames=(1, None))
    assert files == [tmp_path / "walk_0001.ply", tmp_path / "walk_0002.ply"]
    for file, frame in zip(files, frames[1:], strict=True):
        assert np.array_equal(weft.read_mesh(file).vertices, frame)
