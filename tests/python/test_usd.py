"""USD files: round trips bit by bit, transforms with exact answers, units, mistakes, and usd-core's validators."""

from __future__ import annotations

import json
import re
import resource
import warnings
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import weft
from test_convert import command, read_cache, some_frames, write_cache
from weft import _core
from worlds import python, triangulated

pytest.importorskip("pxr", reason="the Python package usd-core is missing")
from pxr import Sdf, Tf, Usd, UsdGeom
from weft import usd

ONE_FACE = "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0, 1, 2]\n"
TRIANGLE = f"{ONE_FACE}point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n"
METRES = 'metersPerUnit = 1\nupAxis = "Y"\n'
ENDINGS = [".usdc", ".usda", ".usd"]


def stage(folder: Path, body: str, *, head: str = METRES, name: str = "in.usda") -> Path:
    file = folder / name
    file.write_text(f"#usda 1.0\n(\n{head})\n{body}")
    return file


def mesh_of(body: str, name: str = "m") -> str:
    return f'def Mesh "{name}"\n{{\nuniform token subdivisionScheme = "none"\n{body}}}\n'


def notes_of(recorded: Any) -> list[str]:
    assert all(warning.category is weft.FileWarning for warning in recorded)
    return [str(warning.message) for warning in recorded]


def read(file: Path, **options: Any) -> tuple[weft.Mesh, list[str]]:
    with warnings.catch_warnings(record=True) as recorded:
        warnings.simplefilter("always")
        mesh = usd.read_mesh(file, **options)
    return mesh, notes_of(recorded)


def read_quietly(file: Path, **options: Any) -> weft.Mesh:
    mesh, notes = read(file, **options)
    assert notes == []
    return mesh


@cache
def validators() -> list[Any]:
    """All of usd-core's; none in versions before 25.11 or so, whose wheels lack their plugins."""
    try:
        from pxr import UsdValidation

        registry = UsdValidation.ValidationRegistry()
        names = [data.name for data in registry.GetAllValidatorMetadata()]
        return [registry.GetOrLoadValidatorByName(name) for name in names]
    except (ImportError, Tf.ErrorException):
        return []


def test_the_validators_are_there() -> None:
    if not validators():
        pytest.skip("this version of usd-core has no validators")
    assert len(validators()) > 20


def mistakes_of(file: Path) -> list[str]:
    """The complaints of the validators."""
    if not validators():
        return []
    from pxr import UsdValidation

    context = UsdValidation.ValidationContext(validators())
    return [error.GetMessage() for error in context.Validate(Usd.Stage.Open(str(file)))]


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> weft.Run:
    changes = {"cloth[0].grid.cells": [6, 6], "cloth[1].grid.cells": [8, 6]}
    return weft.run(weft.load_scene("two_layers", set=changes), frames=3, out=tmp_path_factory.mktemp("run"))


# To USD and back.


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_run_is_read_back_bit_by_bit(run: weft.Run, ending: str, tmp_path: Path) -> None:
    file = tmp_path / f"run{ending}"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert weft.convert(run.folder, file) == [file]
        weft.convert(file, tmp_path / "upper.pc2", node="/two_layers/upper_sheet")
        weft.convert(file, tmp_path / "all.mdd")
    assert mistakes_of(file) == []
    assert (tmp_path / "upper.pc2").read_bytes() == (run.folder / "upper_sheet.pc2").read_bytes()
    both = np.concatenate([run.positions["lower sheet"], run.positions["upper sheet"]], axis=1)
    assert read_cache(tmp_path / "all.mdd").tobytes() == both.tobytes()
    assert _core.PointCacheFile(str(tmp_path / "all.mdd")).times == [np.float32(k / 60) for k in range(4)]
    assert sorted(f.name for f in tmp_path.iterdir()) == sorted(["all.mdd", file.name, "upper.pc2"])


def test_the_stage_of_a_run_says_everything(run: weft.Run, tmp_path: Path) -> None:
    weft.convert(run.folder, tmp_path / "run.usdc")
    made = Usd.Stage.Open(str(tmp_path / "run.usdc"))
    assert UsdGeom.GetStageMetersPerUnit(made) == 1 and UsdGeom.GetStageUpAxis(made) == "Y"
    assert (made.GetStartTimeCode(), made.GetEndTimeCode()) == (0, 3)
    assert (made.GetTimeCodesPerSecond(), made.GetFramesPerSecond()) == (60, 60)
    assert made.GetDefaultPrim().GetPath() == "/two_layers"
    assert [str(prim.GetPath()) for prim in made.GetDefaultPrim().GetChildren()] == [
        "/two_layers/lower_sheet", "/two_layers/upper_sheet"
    ]  # fmt: skip
    mesh = UsdGeom.Mesh(made.GetPrimAtPath("/two_layers/upper_sheet"))
    source = weft.read_obj(run.folder / "upper_sheet.mesh.obj")
    assert source.polygons is not None
    assert mesh.GetPrim().GetDisplayName() == "upper sheet"
    assert mesh.GetSubdivisionSchemeAttr().Get() == "none" and mesh.GetDoubleSidedAttr().Get() is True
    assert np.array_equal(mesh.GetFaceVertexCountsAttr().Get(), [4] * 48)  # the grid's cells
    assert np.array_equal(mesh.GetFaceVertexIndicesAttr().Get(), source.polygons.corners)
    color = json.loads((run.folder / "run.json").read_text())["cloths"][1]["color"]
    assert np.array_equal(mesh.GetDisplayColorAttr().Get(), np.float32([color]))
    for k, positions in enumerate(run.positions["upper sheet"]):
        assert np.array_equal(mesh.GetPointsAttr().Get(k), positions)
        assert np.array_equal(mesh.GetExtentAttr().Get(k), [positions.min(axis=0), positions.max(axis=0)])
        normals = np.asarray(mesh.GetNormalsAttr().Get(k))
        a, b, c = (positions[source.faces[:, n]].astype(np.float64) for n in range(3))
        sums = np.zeros(positions.shape)
        np.add.at(sums, source.faces.reshape(-1), np.repeat(np.cross(b - a, c - a), 3, axis=0))
        expected = sums / np.linalg.norm(sums, axis=1, keepdims=True)
        assert np.abs(normals - expected).max() < 2e-7  # float32 of unit numbers
    assert mesh.GetNormalsInterpolation() == "vertex"


def test_frames_of_a_run_keep_their_numbers(run: weft.Run, tmp_path: Path) -> None:
    weft.convert(run.folder, tmp_path / "part.usdc", frames=(1, 2), up="z", scale=0.5)
    made = Usd.Stage.Open(str(tmp_path / "part.usdc"))
    assert (made.GetStartTimeCode(), made.GetEndTimeCode()) == (1, 2)
    x, y, z = run.positions["lower sheet"][2].T
    points = UsdGeom.Mesh(made.GetPrimAtPath("/two_layers/lower_sheet")).GetPointsAttr().Get(2)
    assert np.array_equal(points, np.float32(0.5) * np.stack([x, z, -y], axis=1))
    weft.convert(tmp_path / "part.usdc", tmp_path / "part.mdd")
    assert _core.PointCacheFile(str(tmp_path / "part.mdd")).times == [np.float32(1 / 60), np.float32(2 / 60)]


def test_frames_go_to_the_file_while_it_is_written(
    run: weft.Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    weft.convert(run.folder, tmp_path / "once.usdc")
    saves = []
    save = Sdf.Layer.Save
    monkeypatch.setattr(Sdf.Layer, "Save", lambda layer, *rest: saves.append(layer) or save(layer, *rest))
    monkeypatch.setattr(usd, "_WAITING", 0)
    weft.convert(run.folder, tmp_path / "often.usdc")
    assert len(saves) == 9  # after every frame of both cloths, and at the end
    for name in ("once", "often"):
        weft.convert(tmp_path / f"{name}.usdc", tmp_path / f"{name}.pc2")
    assert (tmp_path / "once.pc2").read_bytes() == (tmp_path / "often.pc2").read_bytes()
    assert mistakes_of(tmp_path / "often.usdc") == []


@pytest.mark.parametrize("ending", ENDINGS)
@pytest.mark.parametrize("kind", [".obj", ".ply"])
def test_a_mesh_is_read_back_in_floats(ending: str, kind: str, tmp_path: Path) -> None:
    mesh = triangulated(5)
    assert mesh.uv is not None
    weft.write_mesh(tmp_path / f"m{kind}", mesh)
    weft.convert(tmp_path / f"m{kind}", tmp_path / f"m{ending}")
    assert mistakes_of(tmp_path / f"m{ending}") == []
    weft.convert(tmp_path / f"m{ending}", tmp_path / f"again{kind}")
    for back in (weft.read_mesh(tmp_path / f"again{kind}"), read_quietly(tmp_path / f"m{ending}")):
        assert np.array_equal(back.vertices, mesh.vertices.astype(np.float32))
        assert np.array_equal(back.faces, mesh.faces)
        assert back.uv is not None and np.array_equal(back.uv, mesh.uv.astype(np.float32))
    made = Usd.Stage.Open(str(tmp_path / f"m{ending}"))
    assert not made.HasAuthoredTimeCodeRange()


def test_polygons_and_texture_coordinates_of_a_file_stay(tmp_path: Path) -> None:
    shirt = (
        "v 0 0 0\nv 1 0 0\nv 1 1 0.125\nv 0 1 0\nv 2 0 0\nvt 0 0\nvt 0.5 0\nvt 0.5 1\nvt 0.125 0.25\n"
        "f 1/1 2/2 3/3 4/4\nf 2/1 5/2 3/3\n"
    )
    (tmp_path / "shirt.obj").write_text(shirt)
    weft.convert(tmp_path / "shirt.obj", tmp_path / "shirt.usda")
    assert mistakes_of(tmp_path / "shirt.usda") == []
    made = Usd.Stage.Open(str(tmp_path / "shirt.usda"))
    mesh = UsdGeom.Mesh(made.GetPrimAtPath("/shirt/shirt"))
    assert list(mesh.GetFaceVertexCountsAttr().Get()) == [4, 3]
    st = UsdGeom.PrimvarsAPI(mesh).GetPrimvar("st")
    assert st.GetInterpolation() == "faceVarying" and len(st.Get()) == 4
    coordinates = [(0, 0), (0.5, 0), (0.5, 1), (0.125, 0.25), (0, 0), (0.5, 0), (0.5, 1)]
    assert np.array_equal(st.ComputeFlattened(), coordinates)
    weft.convert(tmp_path / "shirt.usda", tmp_path / "again.obj")
    assert (tmp_path / "again.obj").read_text() == shirt
    read = read_quietly(tmp_path / "shirt.usda")
    assert read.polygons is not None and read.polygons.sizes.tolist() == [4, 3] and len(read.faces) == 3
    usd.write_mesh(tmp_path / "third.usda", read)
    weft.write_mesh(tmp_path / "third.obj", read_quietly(tmp_path / "third.usda"))
    assert (tmp_path / "third.obj").read_text() == shirt
    (tmp_path / "shirt.obj").write_text("o shirt\n" + shirt)
    with pytest.warns(weft.FileWarning, match="shirt.obj has 1 group, which are lost: only .obj holds them"):
        weft.convert(tmp_path / "shirt.obj", tmp_path / "shirt.usda")


def test_polygons_of_a_mesh_have_to_fit_it(tmp_path: Path) -> None:
    mesh = triangulated(2)
    mesh.polygons = weft.Polygons([3], [0, 1, 9])
    with pytest.raises(weft.InputError, match="polygons: vertex 9 is out of range for 9 vertices"):
        usd.write_mesh(tmp_path / "m.usda", mesh)
    assert list(tmp_path.iterdir()) == []
    mesh.polygons = weft.Polygons([3], [0, 1, 8], groups={"hem": [0]})
    with pytest.warns(weft.FileWarning, match="the mesh has 1 group, which are lost"):
        usd.write_mesh(tmp_path / "m.usda", mesh)


def test_write_mesh_names_and_colours_the_prim(tmp_path: Path) -> None:
    usd.write_mesh(tmp_path / "flag.usda", triangulated(2), name="die Flagge", color=(0.5, 0, 1))
    made = Usd.Stage.Open(str(tmp_path / "flag.usda"))
    flag = UsdGeom.Mesh(made.GetPrimAtPath("/flag/die_Flagge"))
    assert list(flag.GetDisplayColorAttr().Get()) == [(0.5, 0, 1)]
    assert mistakes_of(tmp_path / "flag.usda") == []


@pytest.mark.parametrize("fps", [24.0, 60.0, 24 / 1.001, 23.976, 30000 / 1001])
def test_a_point_cache_with_its_mesh_is_read_back_bit_by_bit(fps: float, tmp_path: Path) -> None:
    weft.write_obj(tmp_path / "cloth.obj", triangulated(2))
    frames = some_frames(40, 9)
    frames[3, 2] = -0.0
    times = [float(np.float32(k / fps)) for k in range(3, 43)]
    write_cache(tmp_path / "cloth.mdd", frames, times)
    weft.convert(tmp_path / "cloth.mdd", tmp_path / "cloth.usdc", mesh=tmp_path / "cloth.obj")
    assert mistakes_of(tmp_path / "cloth.usdc") == []
    weft.convert(tmp_path / "cloth.usdc", tmp_path / "again.mdd")
    assert (tmp_path / "again.mdd").read_bytes() == (tmp_path / "cloth.mdd").read_bytes()
    made = Usd.Stage.Open(str(tmp_path / "cloth.usdc"))
    assert (made.GetStartTimeCode(), made.GetEndTimeCode()) == (3, 42)


def test_uneven_times_stay_and_a_cache_without_times_says_so(tmp_path: Path) -> None:
    weft.write_obj(tmp_path / "m.obj", triangulated(2))
    write_cache(tmp_path / "a.mdd", some_frames(3, 9), [0.0, 0.25, 1.0])
    weft.convert(tmp_path / "a.mdd", tmp_path / "a.usda", mesh=tmp_path / "m.obj")
    made = Usd.Stage.Open(str(tmp_path / "a.usda"))
    assert UsdGeom.Mesh(made.GetPrimAtPath("/a/a")).GetPointsAttr().GetTimeSamples() == [0, 15, 60]
    write_cache(tmp_path / "b.pc2", some_frames(3, 9))
    with pytest.warns(weft.FileWarning, match=r"b.pc2 does not say its frames per second: 60 \(--fps\)"):
        weft.convert(tmp_path / "b.pc2", tmp_path / "b.usda", mesh=tmp_path / "m.obj")
    weft.convert(tmp_path / "b.pc2", tmp_path / "b.usda", mesh=tmp_path / "m.obj", fps=25)
    assert Usd.Stage.Open(str(tmp_path / "b.usda")).GetTimeCodesPerSecond() == 25


def test_corners_without_texture_coordinates_are_named(tmp_path: Path) -> None:
    text = "v 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\nvt 0.5 0.5\nf 1/1 3/1 2/1\nf 1 4 3\n"
    (tmp_path / "half.obj").write_text(text)
    with pytest.warns(weft.FileWarning, match=r"half.usda: 3 corners without texture coordinates have \(0, 0\)"):
        weft.convert(tmp_path / "half.obj", tmp_path / "half.usda")
    back = read_quietly(tmp_path / "half.usda").uv
    assert back is not None and np.array_equal(back, [[[0.5, 0.5]] * 3, [[0, 0]] * 3])


# Transforms.


def test_nested_transforms_have_exact_answers(tmp_path: Path) -> None:
    file = stage(
        tmp_path,
        'def Xform "a"\n{\ndouble3 xformOp:translate = (10, 20, 30)\ndouble3 xformOp:scale = (2, 4, 8)\n'
        'uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]\n'
        'def Xform "b"\n{\nmatrix4d xformOp:transform = ((0, 1, 0, 0), (0, 0, 1, 0), (1, 0, 0, 0), (0.5, 0, 0, 1))\n'
        f'uniform token[] xformOpOrder = ["xformOp:transform"]\n{mesh_of(TRIANGLE)}}}\n}}\n',
    )
    vertices = read_quietly(file).vertices  # (x, y, z) ↦ (z + 0.5, x, y), times (2, 4, 8), plus (10, 20, 30)
    assert np.array_equal(vertices, [(11, 20, 30), (11, 24, 30), (11, 20, 38)])


def test_moving_transforms_and_points_are_linear_between_samples(tmp_path: Path) -> None:
    file = stage(
        tmp_path,
        'def Xform "a"\n{\ndouble3 xformOp:translate.timeSamples = { 0: (0, 0, 0), 4: (8, 0, 0) }\n'
        'uniform token[] xformOpOrder = ["xformOp:translate"]\n'
        + mesh_of(
            f"{ONE_FACE}point3f[] points.timeSamples = "
            "{ 0: [(0, 0, 0), (1, 0, 0), (0, 1, 0)], 2: [(0, 0, 1), (1, 0, 1), (0, 1, 1)] }\n"
        )
        + "}\n",
        head=METRES + "timeCodesPerSecond = 24\nframesPerSecond = 24\n",
    )
    weft.convert(file, tmp_path / "a.mdd")
    frames = read_cache(tmp_path / "a.mdd")
    triangle = np.float32([(0, 0, 0), (1, 0, 0), (0, 1, 0)])
    for k, z in enumerate((0, 0.5, 1, 1, 1)):
        assert np.array_equal(frames[k], triangle + np.float32([2 * k, 0, z])), k
    assert _core.PointCacheFile(str(tmp_path / "a.mdd")).times == [np.float32(k / 24) for k in range(5)]
    assert np.array_equal(read_quietly(file, frame=3).vertices, frames[3])
    weft.convert(file, tmp_path / "b.mdd", fps=48, frames=(1, 3))  # at half time codes
    assert np.array_equal(read_cache(tmp_path / "b.mdd")[:, 0, 0], [1, 2, 3])
    assert _core.PointCacheFile(str(tmp_path / "b.mdd")).times == [np.float32(k / 48) for k in range(1, 4)]
    with pytest.warns(weft.FileWarning, match=r"in.usda is animated; .*c.obj has its first frame \(--frames\)"):
        weft.convert(file, tmp_path / "c.obj")
    weft.convert(file, tmp_path / "c.obj", frames=(2, 2))
    assert np.array_equal(weft.read_obj(tmp_path / "c.obj").vertices, frames[2])


def test_the_range_and_rate_of_the_stage_are_used(tmp_path: Path) -> None:
    samples = "{ 1: [(0, 0, 0), (1, 0, 0), (0, 1, 0)], 9: [(8, 0, 0), (9, 0, 0), (8, 1, 0)] }"
    body = mesh_of(f"{ONE_FACE}point3f[] points.timeSamples = {samples}\n")
    head = METRES + "startTimeCode = 3\nendTimeCode = 7\ntimeCodesPerSecond = 48\nframesPerSecond = 24\n"
    weft.convert(stage(tmp_path, body, head=head), tmp_path / "a.mdd")
    assert np.array_equal(read_cache(tmp_path / "a.mdd")[:, 0, 0], [2, 4, 6])
    assert _core.PointCacheFile(str(tmp_path / "a.mdd")).times == [np.float32(t / 48) for t in (3, 5, 7)]
    with pytest.warns(weft.FileWarning, match=r"does not say its frames per second: 24, USD's default \(--fps\)"):
        weft.convert(stage(tmp_path, body), tmp_path / "b.mdd")
    assert len(read_cache(tmp_path / "b.mdd")) == 9
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        weft.convert(stage(tmp_path, body), tmp_path / "b.mdd", fps=10)
    assert _core.PointCacheFile(str(tmp_path / "b.mdd")).times == [np.float32(t / 10) for t in range(1, 10)]


# Units and axes.


@pytest.mark.parametrize(
    "head, options, expected, notes",
    [
        ('metersPerUnit = 0.25\nupAxis = "Z"\n', {}, [(1, 2, 3), (0.25, 0.5, -0.75)], []),
        ('metersPerUnit = 0.25\nupAxis = "Z"\n', {"scale": 2, "up": "y"}, [(8, -24, 16), (2, 6, 4)], []),
        (
            'upAxis = "Y"\n', {}, [(0.04, -0.12, 0.08), (0.01, 0.03, 0.02)],
            ["in.usda does not say its unit: 0.01 m, USD's default (--scale)"],
        ),
        ('upAxis = "Y"\n', {"scale": 1}, [(4, -12, 8), (1, 3, 2)], []),
        ("metersPerUnit = 1\n", {}, [(4, -12, 8), (1, 3, 2)], ["its vertical axis: y, USD's default (--up)"]),
        ("metersPerUnit = 1\n", {"up": "y"}, [(4, -12, 8), (1, 3, 2)], []),
        (
            'metersPerUnit = 1000\nupAxis = "Y"\n', {}, [(4000, -12000, 8000), (1000, 3000, 2000)],
            ["in.usda is 1.5e+04 m large; --scale gives the length of its unit in metres"],
        ),
    ],
)  # fmt: skip
def test_units_and_axes(
    head: str, options: dict[str, Any], expected: list[Any], notes: list[str], tmp_path: Path
) -> None:
    points = "point3f[] points = [(4, -12, 8), (1, 3, 2), (0, 0, 0)]\n"
    file = stage(tmp_path, mesh_of(ONE_FACE + points), head=head)
    mesh, said = read(file, **options)
    assert np.array_equal(mesh.vertices, [*expected, (0, 0, 0)])
    assert len(said) == len(notes) and all(map(str.endswith, said, notes)), said


# Faces.


def areas(mesh: weft.Mesh) -> np.ndarray:
    a, b, c = (mesh.vertices[mesh.faces[:, n]] for n in range(3))
    return np.cross(b - a, c - a) / 2


# An arrow with a dent, area 0.5: triangles around its first corner would leave it.
DENT = "point3f[] points = [(0, 0, 0), (1, 1, 0), (0, 0.5, 0), (-1, 1, 0)]\n"
QUAD = f"int[] faceVertexCounts = [4]\nint[] faceVertexIndices = [0, 1, 2, 3]\n{DENT}"
FLIPPED = 'def Xform "x"\n{\ndouble3 xformOp:scale = (-1, 1, 1)\nuniform token[] xformOpOrder = ["xformOp:scale"]\n'
LEFT = 'uniform token orientation = "leftHanded"\n'


@pytest.mark.parametrize(
    "body, z",
    [
        (mesh_of(QUAD), 0.5),
        (mesh_of(LEFT + QUAD), -0.5),
        (FLIPPED + mesh_of(QUAD) + "}\n", 0.5),
        (FLIPPED + mesh_of(LEFT + QUAD) + "}\n", -0.5),
    ],
    ids=["right", "left", "mirrored right", "mirrored left"],
)
def test_polygons_are_cut_and_keep_their_front(body: str, z: float, tmp_path: Path) -> None:
    mesh = read_quietly(stage(tmp_path, body))
    assert mesh.faces.shape == (2, 3)
    assert np.allclose(areas(mesh), [(0, 0, z / 2)] * 2, rtol=0, atol=1e-15)  # and not 0.75 and -0.25


def test_holes_are_left_out(tmp_path: Path) -> None:
    body = (
        "int[] faceVertexCounts = [3, 3, 3]\nint[] faceVertexIndices = [0, 1, 2, 0, 2, 3, 0, 3, 4]\n"
        "int[] holeIndices = [1]\n"
        "point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (-1, 0, 0)]\n"
        'texCoord2f[] primvars:st = [(1, 1), (2, 2), (3, 3)] (interpolation = "uniform")\n'
    )
    mesh, notes = read(stage(tmp_path, mesh_of(body)))
    assert np.array_equal(mesh.faces, [(0, 1, 2), (0, 3, 4)])
    assert mesh.uv is not None and np.array_equal(mesh.uv[:, :, 0], [(1, 1, 1), (3, 3, 3)])
    assert notes == [f"{tmp_path}/in.usda: /m has 1 holes; these faces are left out"]


FOUR = [(0, 1), (2, 3), (4, 5), (6, 7)]


@pytest.mark.parametrize(
    "primvar, expected",
    [
        (f'texCoord2f[] primvars:st = {FOUR} (interpolation = "vertex")', FOUR),
        (f'texCoord2f[] primvars:map = {FOUR} (interpolation = "varying")', FOUR),
        (
            'float2[] primvars:st = [(8, 9), (2, 3)] (interpolation = "faceVarying")\n'
            "int[] primvars:st:indices = [1, 0, 0, 1]", [(2, 3), (8, 9), (8, 9), (2, 3)],
        ),
        ('texCoord2d[] primvars:st = [(0.1, 9)] (interpolation = "constant")', [(0.1, 9)] * 4),
    ],
    ids=["vertex", "varying", "faceVarying", "constant"],
)  # fmt: skip
def test_texture_coordinates(primvar: str, expected: list[Any], tmp_path: Path) -> None:
    mesh = read_quietly(stage(tmp_path, mesh_of(QUAD + primvar + "\n")))
    assert mesh.uv is not None
    assert np.array_equal(mesh.uv, np.array(expected, np.float64)[mesh.faces])  # corner n is vertex n


@pytest.mark.parametrize(
    "primvar",
    [
        'texCoord2f[] primvars:st = [(0, 1)] (interpolation = "vertex")',
        'texCoord2f[] primvars:st = [(0, 1)] (interpolation = "faceVarying")\nint[] primvars:st:indices = [0, 0, 7, 0]',
        'texCoord2f[] primvars:st = [(0, 1), (2, 3), (4, inf), (6, 7)] (interpolation = "vertex")',
    ],
)
def test_unusable_texture_coordinates_are_left_out(primvar: str, tmp_path: Path) -> None:
    mesh, notes = read(stage(tmp_path, mesh_of(QUAD + primvar + "\n")))
    assert mesh.uv is None
    assert notes[0] == f"{tmp_path}/in.usda: /m has unusable texture coordinates st; they are left out"


# Choice of meshes.

SCENE = (
    'class "_shape"\n{\n' + mesh_of(TRIANGLE) + "}\n"
    'def Xform "group"\n{\n'
    + mesh_of(TRIANGLE + 'texCoord2f[] primvars:st = [(0, 0), (1, 0), (0, 1)] (interpolation = "vertex")\n', "a")
    + mesh_of(TRIANGLE + 'token visibility = "invisible"\n', "hidden")
    + mesh_of(TRIANGLE + 'uniform token purpose = "proxy"\n', "proxy")
    + mesh_of(TRIANGLE + 'uniform token purpose = "render"\n', "b")
    + 'def Sphere "ball"\n{\n}\n}\n'
    'def "copy" (\ninstanceable = true\ninherits = </_shape>\n)\n{\n}\n'
    'def PointInstancer "many"\n{\nrel prototypes = </many/p>\n' + mesh_of(TRIANGLE, "p") + "}\n"
)  # fmt: skip


def test_instances_are_read_and_what_is_left_out_is_named(tmp_path: Path) -> None:
    mesh, notes = read(stage(tmp_path, SCENE))
    assert mesh.faces.tolist() == [[0, 1, 2], [3, 4, 5], [6, 7, 8]]  # a, b, the instance
    assert mesh.uv is not None and np.isnan(mesh.uv[1:]).all() and np.isfinite(mesh.uv[0]).all()
    assert notes == [
        f"{tmp_path}/in.usda: left out are invisible meshes (1), point instancers (1), proxies and guides (1), "
        "shapes that are not meshes (1)"
    ]
    with pytest.warns(weft.FileWarning, match="left out"):
        weft.convert(tmp_path / "in.usda", tmp_path / "out.obj")
    back = weft.read_obj(tmp_path / "out.obj")
    assert back.uv is not None and np.array_equal(back.uv, mesh.uv, equal_nan=True)


@pytest.mark.parametrize("node", ["/group/hidden", "/group/proxy", "/copy", "/copy/m"])
def test_a_node_is_read_by_its_path(node: str, tmp_path: Path) -> None:
    assert len(read_quietly(stage(tmp_path, SCENE), node=node).faces) == 1


def test_what_weft_does_not_evaluate_is_named(tmp_path: Path) -> None:
    body = f'def Mesh "m"\n{{\n{TRIANGLE}int[] primvars:skel:jointIndices = [0]\n}}\n'
    body += 'def "gone" (references = @missing.usda@)\n{\n}\n'
    _, notes = read(stage(tmp_path, body))
    assert notes[:2] == [
        f"{tmp_path}/in.usda: /m is a subdivision surface; its control mesh is read",
        f"{tmp_path}/in.usda: /m is moved by a skeleton; its points are read without it",
    ]
    assert re.fullmatch(r"In </gone>: Could not open asset @.*missing.usda@ for reference .*>\.", notes[2]), notes[2]


# Mistakes.


def faces(counts: str, indices: str) -> str:
    points = "[(0, 0, 0), (1, 0, 0), (0, 1, 0)]"
    return f"int[] faceVertexCounts = {counts}\nint[] faceVertexIndices = {indices}\npoint3f[] points = {points}\n"


@pytest.mark.parametrize(
    "body, words",
    [
        (mesh_of(""), "/m has no points at frame 0"),
        (mesh_of(faces("[]", "[]")), "/m has no faces"),
        (mesh_of(faces("[2]", "[0, 1]")), "/m has a face of 2 corners; expected 3 or more"),
        (mesh_of(faces("[4]", "[0, 1, 2]")), "/m has faceVertexCounts for 4 faceVertexIndices, found 3"),
        (mesh_of(faces("[3]", "[0, 1, 3]")), "/m has a face with point 3 of 3"),
        (mesh_of(faces("[3]", "[0, 1, -1]")), "/m has a face with point -1 of 3"),
        (mesh_of(ONE_FACE + "point3f[] points = [(0, 0, 0), (1, nan, 0), (0, 1, 0)]\n"), "has a point at frame 0"),
        (mesh_of(TRIANGLE + "int[] holeIndices = [1]\n"), "/m has a hole at face 1 of 1"),
        (mesh_of(TRIANGLE + "int[] holeIndices = [0]\n"), "/m has no faces"),
        ('def Sphere "s"\n{\n}\n', " has no mesh to read"),
        ("", " has no mesh to read"),
        ("def Mesh {", ": cannot be read as USD: "),
    ],
)  # fmt: skip
def test_mistakes_of_stages_are_one_sentence_with_the_prim(body: str, words: str, tmp_path: Path) -> None:
    file = stage(tmp_path, body)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with pytest.raises(weft.InputError) as caught:
            usd.read_mesh(file)
    assert str(caught.value).startswith(f"{file}") and words in str(caught.value)
    assert "\n" not in str(caught.value) and "/opt" not in str(caught.value)


@pytest.mark.parametrize(
    "head, words",
    [
        ('metersPerUnit = 0\nupAxis = "Y"\n', "metersPerUnit is 0; expected a number above 0 (--scale)"),
        ('metersPerUnit = 1\nupAxis = "X"\n', "upAxis is 'x'; expected Y or Z (--up)"),
        (METRES + "timeCodesPerSecond = 0\n", "timeCodesPerSecond is 0; expected a number above 0"),
    ],
)
def test_mistakes_of_metadata(head: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(weft.InputError, match=re.escape(words)):
        usd.read_mesh(stage(tmp_path, mesh_of(TRIANGLE), head=head))


def test_mistakes_of_calls(run: weft.Run, tmp_path: Path) -> None:
    file = stage(tmp_path, SCENE)
    weft.write_obj(tmp_path / "m.obj", triangulated(2))
    write_cache(tmp_path / "c.pc2", some_frames(2, 5))
    older = tmp_path / "older"
    older.mkdir()
    listed = json.loads((run.folder / "run.json").read_text())
    for cloth in listed["cloths"]:
        del cloth["mesh"]
    (older / "run.json").write_text(json.dumps(listed))
    (older / "report.json").write_text("{}")
    for call, words in (
        (lambda: usd.read_mesh(tmp_path / "no.usda"), "no.usda: there is no such file; expected a USD file"),
        (lambda: usd.read_mesh(file, node="/group/c"), "has no prim /group/c (--node); its meshes are /group/a"),
        (lambda: usd.read_mesh(file, node="no path"), "in.usda has no prim no path (--node)"),
        (lambda: usd.read_mesh(file, node="/many"), "in.usda has no mesh below /many to read"),
        (lambda: usd.read_mesh(file, frame=2), "in.usda has the frames 0 to 0; it has not 2 to 2"),
        (lambda: usd.write_mesh(tmp_path / "m.usdz", triangulated(2)), "USD is written as .usdc, .usda or .usd"),
        (lambda: weft.convert(file, tmp_path / "b.obj", mesh="m.obj"), "mesh: USD has its faces itself"),
        (lambda: weft.convert(file, tmp_path / "b.usdc"), "b.usdc: USD is converted to .obj, .ply, .pc2 or .mdd"),
        (lambda: weft.convert(file, tmp_path / "b.fbx"), "b.fbx: a mesh is written as .obj or .ply"),
        (lambda: weft.convert(tmp_path / "c.pc2", tmp_path / "c.usdc"), "c.usdc: a point cache has no faces; --mesh"),
        (lambda: weft.convert(tmp_path / "c.pc2", tmp_path / "c.usdc", mesh=tmp_path / "m.obj"),
         "c.pc2 has 5 points, but "),
        (lambda: weft.convert(tmp_path / "m.obj", tmp_path / "c.usdc", node="/a"), "m.obj is not USD and has no"),
        (lambda: weft.convert(tmp_path / "m.obj", tmp_path / "c.usdc", mesh="m.obj"), "m.obj is a mesh itself"),
        (lambda: weft.convert(run.folder, tmp_path / "c.usdc", frames=(2, 4)), "frames 0 to 3; it has not 2 to 4"),
        (lambda: weft.convert(older, tmp_path / "c.usdc"), "has no meshes of its point caches: it is of an earlier"),
        (lambda: weft.convert(tmp_path, tmp_path / "c.usdc"), "holds no run"),
        (lambda: weft.convert(tmp_path / "m.obj", tmp_path / "m.obj" / "c.usdc"), "cannot create folder "),
    ):  # fmt: skip
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            with pytest.raises(weft.InputError, match=re.escape(words)):
                call()
    assert sorted(f.name for f in tmp_path.iterdir()) == ["c.pc2", "in.usda", "m.obj", "older"]


def test_points_that_come_and_go_are_no_point_cache(tmp_path: Path) -> None:
    three = "(0, 0, 0), (1, 0, 0), (0, 1, 0)"
    samples = f"point3f[] points.timeSamples = {{ 0: [{three}], 1: [{three}, (1, 1, 0)] }}\n"
    file = stage(tmp_path, mesh_of(ONE_FACE + samples), head=METRES + "timeCodesPerSecond = 24\n")
    with pytest.raises(weft.InputError, match="in.usda has 4 points at frame 1, 3 at frame 0; a point cache has"):
        weft.convert(file, tmp_path / "a.pc2")
    assert [f.name for f in tmp_path.iterdir()] == ["in.usda"]


@pytest.mark.parametrize("ending", ENDINGS)
def test_a_full_disk_keeps_the_earlier_file(run: weft.Run, ending: str, tmp_path: Path) -> None:
    file = tmp_path / f"run{ending}"
    file.write_text("the earlier one")
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2000, hard))
    try:
        with pytest.raises(weft.InputError, match=f"run{ending} cannot be written: .*File too large"):
            weft.convert(run.folder, file)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert file.read_text() == "the earlier one" and [f.name for f in tmp_path.iterdir()] == [file.name]


def test_the_command_converts_usd(run: weft.Run, tmp_path: Path) -> None:
    done = command(run.folder, "walk.usdc", cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "walk.usdc\n", "")
    options = ["--node", "/two_layers/lower_sheet", "--frames", "1:2"]
    done = command("walk.usdc", "walk.pc2", *options, cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "walk.pc2\n", "")
    assert np.array_equal(read_cache(tmp_path / "walk.pc2"), run.positions["lower sheet"][1:3])
    stage(tmp_path, mesh_of(TRIANGLE), head='upAxis = "Y"\n')
    done = command("in.usda", "out.ply", cwd=tmp_path)
    assert done.stderr == "note: in.usda does not say its unit: 0.01 m, USD's default (--scale)\n"
    done = command("in.usda", "out.ply", "--node", "/x", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (2, "in.usda has no prim /x (--node); its meshes are /m\n")


def test_the_validators_find_mistakes(tmp_path: Path) -> None:
    assert not validators() or mistakes_of(stage(tmp_path, mesh_of(TRIANGLE), head=""))


def test_an_import_of_weft_loads_no_usd() -> None:
    assert python("import sys, weft; print('pxr' in sys.modules, 'weft.usd' in sys.modules)").stdout == "False False\n"
