"""Errors: C++'s sentences letter by letter, Python's own ones, mistakes of scenes, and failed steps."""

from __future__ import annotations

import os
import re
import warnings
from collections.abc import Callable
from errno import EISDIR, ENOENT
from pathlib import Path

import numpy as np
import pytest
import weft
from worlds import DT, SQUARE, cloth_of, draped, hanging, triangulated, write_turning_plate

TREE = Path(__file__).parents[2]
NAN = np.nan
MIRROR = np.diag([1.0, 1.0, -1.0])
ROTATION = "its rotation is invalid: columns must be perpendicular unit vectors, right-handed"


def empty(**settings: str) -> weft.World:
    return weft.World(**settings)  # type: ignore[arg-type]


def cloth(shape: object = None, **options: object) -> weft.Cloth:
    return weft.World().add_cloth(shape or weft.grid(cells=(2, 2)), **options)  # type: ignore[arg-type]


def collider(shape: object = None, **options: object) -> weft.Collider:
    return weft.World().add_collider(shape or weft.Sphere(), **options)  # type: ignore[arg-type]


def sprung(**values: object) -> weft.Cloth:
    return cloth(fabric=weft.Springs(**values))  # type: ignore[arg-type]


def woven(**values: object) -> weft.Cloth:
    return cloth(fabric=weft.Fabric(**values))  # type: ignore[arg-type]


def bag(fabric: object = "denim", **settings: str) -> weft.Cloth:
    """A tetrahedron."""
    vertices = [(0, 0, 0), (1, 0, 0), (0, 0, 1), (0.3, 0.1, 0.3)]
    mesh = weft.Mesh(vertices, [(0, 1, 2), (0, 3, 1), (1, 3, 2), (2, 3, 0)])
    return empty(**settings).add_cloth(mesh, fabric=fabric, warp=(1, 0, 0))  # type: ignore[arg-type]


def put(thing: object, name: str, value: object) -> None:
    setattr(thing, name, value)


def solve(**settings: object) -> None:
    weft.World().integrator = weft.IntegratorSettings(**settings)  # type: ignore[arg-type]


def removed() -> weft.Cloth:
    world = hanging(2)
    sheet = cloth_of(world)
    world.remove(sheet)
    return sheet


def two_planes() -> tuple[weft.World, weft.Collider, weft.Collider]:
    world = weft.World()
    return world, world.add_collider(weft.Plane(), name="a"), world.add_collider(weft.Plane(), name="b")


def plate(folder: Path, shape: weft.Mesh | None = None) -> weft.Mesh:
    """A plate that turns; with a shape: this one, with the plate's motion."""
    write_turning_plate(folder / "plate.glb")
    mesh = weft.read_gltf(folder / "plate.glb")
    if shape is None:
        return mesh
    other = weft.Mesh(shape.vertices, shape.faces)
    other.deformation = mesh.deformation
    return other


def pins_with_targets() -> weft.Cloth:
    sheet = cloth()
    sheet.pin([0])
    sheet.set_targets([0], (0, 0, 0))
    return sheet


def snapshot_before(change: Callable[[weft.World], object]) -> None:
    world = draped(2)
    saved = world.snapshot()
    change(world)
    world.restore(saved)


def of_version(number: int) -> bytes:
    data = bytearray(weft.World().save())
    data[4] = number
    return bytes(data)


def damaged() -> bytes:
    data = bytearray(hanging(2).save())
    data[len(data) // 2] ^= 1
    return bytes(data)


def keys(*times: float) -> list[weft.KeyFrame]:
    return [weft.KeyFrame(time=time) for time in times]


PRESETS = ", ".join(name for name, _ in weft.fabric_presets())
NAMES = sorted(weft.integrator_names(), key="newton".__ne__)  # the default first
INTEGRATORS = f"{', '.join(NAMES[:-1])} or {NAMES[-1]}"
CALLS: list[tuple[Callable[[], object], str]] = [
    # Colliders.
    (lambda: collider(weft.Sphere(center=(NAN, NAN, NAN)), rotation=(0, 0, 30)),
     'collider "collider": its centre must be finite, not (nan, nan, nan)'),
    (lambda: collider(weft.Sphere(radius=-1), name="ball"),
     'collider "ball": its radius must be more than 0 m, not -1'),
    (lambda: collider(weft.Plane(point=(NAN, NAN, NAN))),
     'collider "collider": its point must be finite, not (nan, nan, nan)'),
    (lambda: collider(weft.Plane(normal=(0, 2, 0))),
     'collider "collider": its normal must have length 1, but is (0, 2, 0)'),
    (lambda: collider(weft.Capsule(a=(NAN, NAN, NAN))),
     'collider "collider": its end a must be finite, not (nan, nan, nan)'),
    (lambda: collider(weft.Capsule(b=(NAN, NAN, NAN))),
     'collider "collider": its end b must be finite, not (nan, nan, nan)'),
    (lambda: collider(weft.Capsule(b=(0, 1, 0), radius=0)),
     'collider "collider": its radius must be more than 0 m, not 0'),
    (lambda: collider(weft.Box(center=(NAN, NAN, NAN))),
     'collider "collider": its centre must be finite, not (nan, nan, nan)'),
    (lambda: collider(weft.Box(half_size=(1, 0, 1))),
     'collider "collider": its half size must be more than 0 m, not 0'),
    (lambda: collider(weft.Box(), rotation=MIRROR), f'collider "collider": {ROTATION}'),
    (lambda: collider(SQUARE, rotation=2 * np.eye(3)), f'collider "collider": {ROTATION}'),
    (lambda: collider(weft.Sphere(), rotation=2 * np.eye(3)), f'collider "collider": {ROTATION}'),
    (lambda: collider(weft.Capsule(), rotation=MIRROR), f'collider "collider": {ROTATION}'),
    (lambda: collider(weft.Plane(), rotation=MIRROR), f'collider "collider": {ROTATION}'),
    (lambda: collider().move_to(rotation=MIRROR), f'collider "collider", moved: {ROTATION}'),
    (lambda: collider().place_at(rotation=MIRROR), f'collider "collider", moved: {ROTATION}'),
    (lambda: collider(friction=-1), 'collider "collider": friction must be 0 or more'),
    (lambda: collider(static_friction=-1), 'collider "collider": friction must be 0 or more'),
    (lambda: collider(frames=[(0, SQUARE.vertices)]),
     'collider "collider": only a mesh can have frames or a deformation'),
    (lambda: collider(SQUARE, frames=[(0, SQUARE.vertices), (0, SQUARE.vertices)]),
     'collider "collider": key 1 of the mesh sequence is not later than the previous one'),
    (lambda: collider(SQUARE, frames=[(0, SQUARE.vertices[:3])]), 'collider "collider": expected 4 vertices, got 3'),
    (lambda: collider().move_vertices(SQUARE.vertices),
     'collider "collider": it is not a mesh and has no vertices'),
    (lambda: collider().place_vertices(SQUARE.vertices),
     'collider "collider": it is not a mesh and has no vertices'),
    (lambda: collider(SQUARE).move_vertices(SQUARE.vertices[:2]), 'collider "collider": expected 4 vertices, got 2'),
    (lambda: collider(SQUARE).place_vertices(SQUARE.vertices[:2]), 'collider "collider": expected 4 vertices, got 2'),
    (lambda: collider(motion=keys(NAN)), 'collider "collider": key frame 0 has a non-finite number'),
    (lambda: collider(motion=keys(1, 1)), 'collider "collider": key frame 1 is not later than the previous one'),
    (lambda: collider(weft.Mesh(SQUARE.vertices, np.empty((0, 3), int))),
     'collider "collider": the mesh has no triangles'),
    (lambda: collider(weft.Mesh(SQUARE.vertices, [(0, 0, 1)])),
     'collider "collider": all triangles of the mesh are degenerate'),
    # Fabrics.
    (lambda: cloth(fabric="silkk"), 'unknown fabric "silkk"; did you mean "silk"?'),
    (lambda: cloth(fabric="xyzzyqqq"), f'unknown fabric "xyzzyqqq"; available: {PRESETS}'),
    (lambda: weft.find_fabric("denimm"), 'unknown fabric "denimm"; did you mean "denim"?'),
    (lambda: weft.fabric_sources("qqq"), f'unknown fabric "qqq"; available: {PRESETS}'),
    (lambda: put(cloth(), "fabric", "silkk"), 'unknown fabric "silkk"; did you mean "silk"?'),
    (lambda: woven(density=-1), 'fabric "fabric": density must be above 0 kg/m², is -1'),
    (lambda: woven(c11=0, c22=NAN, g=-2),
     'fabric "fabric": c11 must be above 0 N/m, is 0; c22 must be above 0 N/m, is nan; g must be above 0 N/m, is -2'),
    (lambda: woven(c12=np.inf), 'fabric "fabric": c12 must be a finite number in N/m, is inf'),
    (lambda: woven(bend_warp=-1, bend_weft=-1, bend_bias=-1),
     'fabric "fabric": bend_warp must be 0 N·m or above, is -1; bend_weft must be 0 N·m or above, is -1; '
     "bend_bias must be 0 N·m or above, is -1"),
    (lambda: woven(thickness=1), 'fabric "fabric": thickness must be from 1e-6 to 0.05 m, is 1'),
    (lambda: woven(c12=9999), 'fabric "fabric": c12 must be less than √(c11 c22) = 1980 N/m in magnitude, is 9999: the '
     "membrane is not positive definite, so some stretching would release energy"),
    (lambda: woven(bend_warp=1, bend_bias=0),
     'fabric "fabric": bend_bias must be at least (√bend_warp − √bend_weft)²/4 = 0.2488 N·m, is 0: some bending would '
     "release energy"),
    (lambda: woven(density=50),
     'fabric "fabric": density must be at most 5.67 kg/m², is 50: heavier than sheet lead of the fabric\'s thickness, '
     "0.0005 m"),
    (lambda: woven(stretch_warp=[(0.1, 5), (0.1, 6)]),
     'fabric "fabric": stretch_warp must increase from the origin, does not at strain 0.1'),
    (lambda: woven(stretch_weft=[(0.01 * k, 10 * k) for k in range(1, 11)]),
     'fabric "fabric": stretch_weft must have at most 8 points, has 10'),
    (lambda: woven(stretch_warp=[(0.1, 50), (0.2, 51)], c12=500),
     'fabric "fabric": stretch_warp is too flat: tension over stretch must increase everywhere, and the product of the '
     "minimum slopes of warp and weft, -25.69 and 1400 N/m, must exceed c12²"),
    (lambda: weft.Fabric(stretch_warp=[(0.1, 50, 3)]),  # type: ignore[list-item]
     "a point of a stretch curve is a pair of strain and tension"),
    (lambda: put(cloth(), "fabric", weft.Fabric(density=-1)),
     'fabric "cotton_shirting": density must be above 0 kg/m², is -1'),
    (lambda: cloth(membrane="springs", fabric=weft.Fabric(strength=9)),
     'cloth "cloth": springs do not tear; use membrane = "triangle", or strength = 0'),
    (lambda: woven(strength=9, bend_set=500),
     'cloth "cloth": cloth with hysteresis or set of bending does not tear; set bend_hysteresis_warp, '
     "bend_hysteresis_weft and bend_set to 0, or strength"),
    (lambda: put(woven(), "fabric", weft.Fabric(strength=9)),
     'cloth "cloth": a grid that was added without strength does not tear; add it with one'),
    (lambda: put(woven(strength=9), "fabric", weft.Fabric()),
     'cloth "cloth": it was added with a strength; give it a large one in place of 0'),
    (lambda: woven(strength=-9), 'fabric "fabric": strength must be 0 N/m (never tears) or above, is -9'),
    (lambda: cloth(membrane="springs", fabric=weft.Fabric(g=9999)),
     'fabric "fabric": springs cannot represent it: c11 = 2800 N/m must exceed g = 9999 N/m; use membrane = '
     '"triangle", a smaller g, or a larger c11'),
    (lambda: cloth(membrane="springs", warp=(1, 0, 1)),
     'cloth "cloth": springs require warp along one of the grid\'s axes, [1, 0, 0] or [0, 0, 1]; use membrane = '
     '"triangle" for other directions'),
    (lambda: weft.fabric_from(weft.KesSheet()), "KES-F sheet: extension_warp (EMT) must be above 0"),
    (lambda: weft.fabric_from(weft.KesSheet(extension_warp=1, extension_weft=1, linearity_warp=2)),
     "KES-F sheet: linearity (LT) must be from 0.3 to 1"),
    (lambda: weft.fabric_from(weft.FastSheet()),
     "FAST sheet: extension_20_warp - extension_5_warp (E20-1 - E5-1) must be above 0"),
    (lambda: weft.fabric_from(weft.CloProperties()),
     'fabric "CLO properties": density must be above 0 kg/m², is 0; c11 must be above 0 N/m, is 0; c22 must be above 0 '
     "N/m, is 0; g must be above 0 N/m, is 0; thickness must be from 1e-6 to 0.05 m, is 0"),
    # Springs.
    (lambda: sprung(density=0), 'cloth "cloth": density must be more than 0 kg/m²'),
    (lambda: sprung(structural=-1), 'cloth "cloth": structural stiffness must be 0 or more'),
    (lambda: sprung(shear=NAN), 'cloth "cloth": shear stiffness must be 0 or more'),
    (lambda: sprung(bend=-1), 'cloth "cloth": bending stiffness must be 0 or more'),
    (lambda: sprung(damping=-1), 'cloth "cloth": damping must be 0 or more'),
    (lambda: sprung(thickness=-1), 'cloth "cloth": thickness must be 0 or more'),
    (lambda: sprung(friction=-1), 'cloth "cloth": friction must be 0 or more'),
    (lambda: put(sprung(), "fabric", weft.Springs(density=-1)), 'cloth "cloth": density must be more than 0 kg/m²'),
    (lambda: sprung().stiffen([0, 1], -1), 'cloth "cloth": the factor must be 0 or more'),
    (lambda: cloth().stiffen([0, 1], 2),
     'cloth "cloth": its membrane has no springs to stiffen; add it with springs, or change its fabric'),
    # Cloths.
    (lambda: cloth(weft.grid(size=(0, 1))), 'cloth "cloth": a grid\'s size must be more than 0 m'),
    (lambda: cloth(weft.Grid(cells_x=0)), 'cloth "cloth": a grid requires at least one cell along each side'),
    (lambda: cloth(weft.Grid(cells_x=20000, cells_z=20000)),
     'cloth "cloth": a grid may have at most 100 million particles'),
    (lambda: cloth(weft.Mesh(SQUARE.vertices, np.empty((0, 3), int)), name="flag"),
     'cloth "flag": the mesh has no triangles'),
    (lambda: cloth(weft.Mesh(SQUARE.vertices, [(0, 0, 1)])),
     'cloth "cloth": all triangles of the mesh are degenerate'),
    (lambda: cloth(velocity=(1e300, 0, 0)), 'cloth "cloth" has a non-finite position or velocity'),
    (lambda: cloth(rotation=MIRROR), f'cloth "cloth": {ROTATION}'),
    (lambda: cloth(SQUARE, weld=-1), 'cloth "cloth": weld must be 0 m or more'),
    (lambda: cloth(SQUARE, sew=-1), 'cloth "cloth": sew must be 0 m or more'),
    (lambda: cloth(SQUARE, seam_time=-1), 'cloth "cloth": seam_time must be 0 s or more'),
    (lambda: cloth(SQUARE, seams=[([0], [1, 2])]),
     'cloth "cloth": seam 0: a stretch of border has at least two vertices'),
    (lambda: cloth(seams=[([0, 2], [6, 9])]), 'cloth "cloth": seam 0: vertex 9 is not one of the shape\'s 9'),
    (lambda: cloth(weft.Mesh([*SQUARE.vertices, (9, 9, 9)], SQUARE.faces), seams=[([0, 4], [0, 1])]),
     'cloth "cloth": seam 0: vertex 4 was dropped with the triangles around it'),
    (lambda: cloth(seams=[([0, 2], [0, 2])]), 'cloth "cloth": seam 0: its two stretches of border are the same'),
    (lambda: cloth(seams=[([0, 2], [6, 8])], fabric=weft.Springs()),
     'cloth "cloth": a grid of springs has no seams; give it a fabric'),
    (lambda: cloth(rest=np.zeros((8, 3, 3))), 'cloth "cloth": only the triangles of a mesh have another rest shape'),
    (lambda: cloth(SQUARE, rest=np.zeros((1, 3, 3))),
     'cloth "cloth": its rest shape has 1 triangles, but the mesh has 2'),
    (lambda: cloth(SQUARE, rest=np.zeros((2, 3))), "rest: expected shape (num_faces, 3, 3), found (2, 3)"),
    (lambda: cloth(rest_scales=[([0], 0.5)]), "rest_scales: expected (vertices, warp, weft), found ([0], 0.5)"),
    (lambda: cloth(rest_scales=[([0], 0, 1)]), 'cloth "cloth": rest scale 0: its factors must be above 0'),
    (lambda: cloth(rest_scales=[([9], 1, 1)]),
     'cloth "cloth": rest scale 0: vertex 9 is not one of the shape\'s 9'),
    (lambda: cloth(rest_scales=[([0], 1, 1)], fabric=weft.Springs()),
     'cloth "cloth": rest_scales follow warp and weft, which springs do not have; give it a fabric'),
    (lambda: weft.rest_from_uv(SQUARE),
     "a rest shape from texture coordinates requires them for each triangle; the mesh has 2 triangles, 0 with "
     "texture coordinates"),
    (lambda: weft.rest_from_uv(weft.Mesh(SQUARE.vertices, SQUARE.faces, uv=np.zeros((4, 2)))),
     "the texture coordinates of the mesh have no area"),
    (lambda: weft.rest_from_uv(weft.Mesh(SQUARE.vertices, SQUARE.faces, uv=np.zeros((4, 2))), scale=0),
     "the scale of texture coordinates must be above 0 m"),
    (lambda: cloth(stitches=[(0, 9)]), 'cloth "cloth": stitch 0: vertex 9 is not one of the shape\'s 9'),
    (lambda: cloth(stitches=[0, 8]), "stitches: expected shape (n, 2), found (2,)"),
    (lambda: cloth(SQUARE, seams=[[0, 1, 2]]), "seams: expected pairs of lists of vertices, found [0, 1, 2]"),
    (lambda: cloth(warp=(0, 0, 0)), 'cloth "cloth": warp must be a direction, finite and not zero'),
    (lambda: cloth().set_forces((1e300, 0, 0)), 'cloth "cloth": external forces must be finite, and at most 1e38'),
    (lambda: cloth().set_pressure(100),
     'cloth "cloth" is not closed: pressure requires a surface without a border, but 8 of its edges have one triangle, '
     "and 0 others join triangles that face opposite ways; join pieces with sew or weld"),
    (lambda: bag().set_pressure(np.inf), "pressure: expected a finite number, found inf"),
    (lambda: bag().set_pressure(-101325, sealed=True),
     'cloth "cloth": sealed gas requires a volume, and a pressure above -101325 Pa'),
    (lambda: bag(integrator="xpbd"),
     'cloth "cloth" has a bend_hysteresis or bend_set, but xpbd does not support it; use newton or implicit_euler, or '
     "set bend_hysteresis_warp, bend_hysteresis_weft and bend_set to 0"),
    (lambda: empty(integrator="paper").add_cloth(SQUARE, fabric=weft.Springs(), stitches=[(0, 2)]),
     'cloth "cloth" has seams, but paper does not support them; use newton, implicit_euler or xpbd'),
    (lambda: bag(weft.Springs(), integrator="paper").set_pressure(5),
     'cloth "cloth" has a pressure, but paper does not support it; use newton, implicit_euler or xpbd'),
    (lambda: put(cloth(), "velocities", (0, 0, -1e39)), 'cloth "cloth": velocities must be finite, and at most 1e38'),
    (lambda: put(cloth(), "positions", (0, 1e39, 0)), 'cloth "cloth": positions must be finite, and at most 1e38'),
    (lambda: cloth_of(hanging(2)).set_targets([0], (1e39, 0, 0)),
     'cloth "sheet": targets of pins must be finite, and at most 1e38'),
    (lambda: cloth(rotation=(0, 0, 0, 0)), "a quaternion must be finite and nonzero"),
    (lambda: cloth(membrane="x"), 'membrane: expected one of "triangle", "springs", found "x"'),
    (lambda: cloth(model="x"), 'model: expected one of "basic", "simplified", "alternating", found "x"'),
    (lambda: cloth().teleport(rotation=MIRROR), f'cloth "cloth", moved: {ROTATION}'),
    (lambda: cloth().force("x"),  # type: ignore[arg-type]
     'kind: expected one of "gravity", "elastic", "damping", "wind", "external", "contact", found "x"'),
    (lambda: removed().positions, "this ClothId (number 1) refers to a removed body"),
    (lambda: weft.World().remove(cloth_of(hanging(2))), "this ClothId belongs to another world"),
    (lambda: weft.World().remove(collider()), "this ColliderId belongs to another world"),
    # Pins.
    (lambda: cloth_of(hanging(2)).pin([0]), 'cloth "sheet": particle 0 is pinned twice'),
    (lambda: cloth().pin([1, 1]), 'cloth "cloth": particle 1 is pinned twice'),
    (lambda: cloth().pin([0], stiffness=-1), 'cloth "cloth": a pin\'s stiffness and damping must be 0 or more'),
    (lambda: cloth().pin([0], stiffness=1, damping=-1),
     'cloth "cloth": a pin\'s stiffness and damping must be 0 or more'),
    (lambda: cloth().pin([0], stiffness=1, motion=keys(0)),
     'cloth "cloth": a pin with stiffness does not support motion; set targets before each step'),
    (lambda: pins_with_targets().pin([1], motion=keys(0)),
     'cloth "cloth": its pins have targets, which a pin with a motion or a collider cannot join'),
    (lambda: cloth().pin([0], follow=collider(), motion=keys(0)),
     'cloth "cloth": a pin that follows a collider has no motion of its own'),
    (lambda: cloth().pin([0], motion=keys(1, 0)), 'cloth "cloth": key frame 1 is not later than the previous one'),
    (lambda: cloth().unpin([0]), 'cloth "cloth": particle 0 is not pinned'),
    (lambda: cloth().set_targets([0], (0, 0, 0)), 'cloth "cloth": particle 0 is not pinned'),
    # Settings.
    (lambda: empty(integrator="x"), f'unknown integrator "x"; available: {INTEGRATORS}'),
    (lambda: put(empty(), "integrator", weft.IntegratorSettings(integrator="xpbd", is_double=True)),
     'integrator "xpbd" does not support double precision; use newton or implicit_euler'),
    (lambda: solve(explicit_euler=weft.ExplicitSettings(substeps=-1)), "explicit: substeps must be 0 or more"),
    (lambda: solve(implicit_euler=weft.ImplicitEulerSettings(tolerance=NAN)),
     "implicit_euler: tolerance must be above 0 m/s"),
    (lambda: solve(implicit_euler=weft.ImplicitEulerSettings(iterations=0)),
     "implicit_euler: iterations must be at least 1"),
    (lambda: solve(newton=weft.NewtonSettings(iterations=-1)), "newton: iterations must be 0 or more"),
    (lambda: solve(xpbd=weft.XpbdSettings(substeps=0)), "xpbd: substeps must be at least 1"),
    (lambda: put(hanging(2), "integrator", "paper"),
     'cloth "sheet" is made of a fabric, but paper supports springs only; use newton, implicit_euler or xpbd, or set '
     "spring_structural, spring_shear and spring_bend instead of the fabric"),
    (lambda: empty(integrator="explicit").add_cloth(weft.grid(cells=(2, 2))),
     'cloth "cloth" is made of a fabric, but explicit supports springs only; use newton, implicit_euler or xpbd, or '
     "set spring_structural, spring_shear and spring_bend instead of the fabric"),
    (lambda: put(empty(), "division", weft.StepDivision(shortest=0)),
     "the shortest part of a step must be more than 0 s"),
    (lambda: put(empty(integrator="xpbd"), "division", weft.StepDivision(enabled=True)),
     "xpbd does not support step division; use newton or implicit_euler"),
    (lambda: put(empty(), "threads", 0), "threads: expected at least 1, found 0"),
    (lambda: put(empty(), "wind", weft.Wind(velocity=(NAN, 0, 0))),
     "the wind's velocity must be finite, and its drag 0 or more"),
    (lambda: put(empty(), "wind", weft.Wind(drag=-1)), "the wind's velocity must be finite, and its drag 0 or more"),
    (lambda: put(empty(), "wind", weft.Wind(air=weft.Air(density=1, drag=1, lift=2))),
     "the air's density and drag must be above 0, and its lift from 0 to its drag"),
    (lambda: put(empty(), "wind", weft.Wind(air=weft.Air(density=1), gusts=weft.Gusts(length=0))),
     "gusts require a strength of 0 or more, and a length and a time above 0"),
    (lambda: put(empty(integrator="xpbd"), "wind", weft.Wind(air=weft.Air(density=1))),
     "xpbd does not support aerodynamic drag and lift; use newton or implicit_euler, or only the wind's drag"),
    (lambda: put(empty(), "wind", weft.Wind(keys=[weft.WindKey(time=1), weft.WindKey(time=1)])),
     "the wind's keys must be finite, at increasing times"),
    (lambda: two_planes()[0].set_friction(*two_planes()[1:], 1), "this ColliderId belongs to another world"),
    (lambda: (lambda w, a, b: w.set_friction(a, b, 1))(*two_planes()),
     'collider "b" and collider "a" are both colliders, which do not collide with each other; one of the two must be '
     "a cloth"),
    (lambda: (lambda w, a, b: w.set_collision(a, b, True))(*two_planes()),
     'collider "b" and collider "a" are both colliders, which do not collide with each other; one of the two must be '
     "a cloth"),
    (lambda: (lambda s: s.world.set_friction(s, s, -1))(cloth()),
     'the friction of cloth "cloth" and cloth "cloth" must be 0 or more'),
    (lambda: weft.NewtonSettings(quality="best"),  # type: ignore[arg-type]
     'quality: expected one of "fast", "default", "high", found "best"'),
    (lambda: weft.Springs(damping_kind="x"),  # type: ignore[arg-type]
     'damping_kind: expected one of "plain", "projected", found "x"'),
    # Steps, queries and saved worlds.
    (lambda: empty().step(0), "the time step must be a finite number of seconds above 0"),
    (lambda: empty().step(-1), "the time step must be a finite number of seconds above 0"),
    (lambda: empty().cast_ray((0, 0, 0), (0, 0, 0)),
     "a ray requires a finite origin and a direction with a length above 0"),
    (lambda: empty().cast_ray((0, 0, 0), (0, 0, 1), -1), "reach must be 0 m or more"),
    (lambda: empty().closest_point((0, 0, 0), -1), "reach must be 0 m or more"),
    (lambda: hanging(2).restore(hanging(2).snapshot()), "this snapshot is empty or belongs to another world"),
    (lambda: snapshot_before(lambda w: w.add_cloth(SQUARE)),
     "the snapshot and the world have different numbers of cloths"),
    (lambda: snapshot_before(lambda w: w.add_collider(weft.Plane())),
     "the snapshot and the world have different numbers of colliders"),
    (lambda: snapshot_before(lambda w: (w.remove(w.cloths[0]), w.add_cloth(SQUARE, name="sheet"))),
     'the snapshot\'s cloth "sheet" has a different number of particles'),
    (lambda: weft.World.load(b""), "not a saved world, or a damaged one"),
    (lambda: weft.World.load(b"x" * 1000), "not a saved world, or a damaged one"),
    (lambda: weft.World.load(hanging(2).save()[:-1]), "not a saved world, or a damaged one"),
    (lambda: weft.World.load(damaged()), "not a saved world, or a damaged one"),
    (lambda: weft.World.load(of_version(99)),
     "the saved world has format version 99; this library reads version 11"),
    # Pictures.
    (lambda: weft.Camera(position=(0, 0, 0)).render(empty(), color=False),
     "a camera's position and target: expected two different points"),
    (lambda: weft.Camera(fov_deg=180).render(empty(), color=False),
     "a camera's field of view: expected more than 0 and less than 180 degrees"),
    (lambda: weft.Camera(size=(0, 9)).render(empty(), color=False),
     "a camera's width and height: expected 1 to 16384 pixels, not 0"),
    (lambda: weft.Camera().render(empty(), color=False, samples=0),
     "samples of a picture: expected 1 to 16, not 0"),
    (lambda: weft.Camera().render(empty(), color=False, smooth=3),
     "subdivisions of a picture: expected 0 to 2, not 3"),
    (lambda: weft.Camera().render(empty(), color=False, cloth_colors=[(0, 0, 0)]),
     "there are 1 colours for 0 cloths"),
    (lambda: weft.Camera().render(hanging(2), color=False, cloth_colors=[(0, 0, 2)]),
     "a cloth's colour: expected red, green and blue from 0 to 1"),
    (lambda: np.zeros((2, 2, 3), np.uint8).view(weft.Picture).save("a.bmp"),
     "a.bmp: expected a file name ending in .png or .jpg"),
    (lambda: np.zeros((0, 0, 3), np.uint8).view(weft.Picture).save("a.png"),
     "a.png: the picture has no rgb of its width and height"),
]  # fmt: skip


def numbered(calls: list[tuple[Callable[[], object], str]]) -> list[str]:
    return [f"{n}: {sentence[:60]}" for n, (_, sentence) in enumerate(calls)]


@pytest.mark.parametrize(("call", "sentence"), CALLS, ids=numbered(CALLS))
def test_sentences_of_cpp(call: Callable[[], object], sentence: str) -> None:
    with pytest.raises(weft.InputError) as caught:
        call()
    assert type(caught.value) is weft.InputError and isinstance(caught.value, ValueError)
    assert str(caught.value) == sentence and caught.value.args == (sentence,)


# Files. {} stands for the test's folder.

OBJ = {
    "": "{}/m.obj: there are no vertices; expected lines v X Y Z",
    "v 0 0 0\n": "{}/m.obj: there are no faces; expected lines f A B C",
    "v 0 0\n": "{}/m.obj:1: a vertex with 2 coordinates; expected v X Y Z with three numbers",
    "v 0 0 x\n": "{}/m.obj:1: 'x' is not a coordinate; expected a finite number",
    "v 0 0 0\nf 1 2\n": "{}/m.obj:2: a face with 2 vertices; expected three or more",
    "v 0 0 0\nf 1 2 3\n": "{}/m.obj:2: vertex 2 does not exist; expected at most 1, the number of vertices",
    "v 0 0 0\n\nf -2 1 1\n": "{}/m.obj:3: vertex -2 does not exist; 1 vertices come before this face",
    "v 0 0 0\nf a 2 3\n": "{}/m.obj:2: 'a' is not a vertex of a face; expected A, A/B, A//C or A/B/C with a whole "
                          "number A other than 0",
}  # fmt: skip


@pytest.mark.parametrize("text", OBJ)
def test_sentences_of_obj_files(text: str, tmp_path: Path) -> None:
    (tmp_path / "m.obj").write_text(text)
    with pytest.raises(weft.InputError) as caught:
        weft.read_obj(tmp_path / "m.obj")
    assert str(caught.value) == OBJ[text].format(tmp_path)


GRID = "[scene]\nformat = 1\n[[cloth]]\n"
GRID_OF_FOUR = GRID + "grid = { size = [1, 1], cells = [4, 4] }\n"
SHIPPED = ", ".join(weft.scenes())
NO_ENTRY = os.strerror(ENOENT)


def write_red(file: Path) -> None:
    np.zeros((2, 2, 3), np.uint8).view(weft.Picture).save(file)


def world_of(text: str, folder: Path) -> weft.World:
    (folder / "s.toml").write_text(text)
    return weft.load_scene(folder / "s.toml").world()


def run_of(text: str, **options: object) -> weft.Run:
    return weft.run(weft.load_scene(text), frames=1, **options)  # type: ignore[arg-type]


def run_into(folder: Path) -> Path:
    return run_of(GRID_OF_FOUR, out=folder / "old").folder


def unused_vertex(folder: Path) -> str:
    weft.write_obj(folder / "m.obj", weft.Mesh([*SQUARE.vertices, (9, 9, 9)], SQUARE.faces))
    return GRID + 'mesh = "m.obj"\n'


def with_groups(folder: Path) -> str:
    (folder / "m.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 0 1\nv 2 0 0\ng all\nf 1 3 2\ng flat\nf 4 4 4\n")
    return GRID + 'mesh = "m.obj"\n'


def two_meshes(folder: Path) -> str:
    weft.write_obj(folder / "m_0.obj", SQUARE)
    weft.write_obj(folder / "m_1.obj", triangulated(2))
    return GRID_OF_FOUR + '[[collider]]\nshape = "mesh"\nname = "body"\nframes = "m_*.obj"\nframe_rate = 30\n'


CROSSED = GRID_OF_FOUR + (
    '[[cloth]]\nname = "upright"\ngrid = { size = [1, 1], cells = [4, 4] }\nrotation = [90, 0, 0]\n'
    "position = [0.1, 0.5, 0.45]\n"
    "[solver]\nuntangle = false\n"
)

FILES: list[tuple[Callable[[Path], object], str]] = [
    (lambda t: collider(plate(t), frames=[(0, plate(t).vertices)]),
     'collider "collider": has both frames and a deformation; expected one of them'),
    (lambda t: collider(plate(t, SQUARE)), 'collider "collider": its deformation has 15 vertices, the mesh 4'),
    (lambda t: world_of(GRID_OF_FOUR + 'pins = [{ select = "corner:0,0", follow = "body" }]\n', t),
     'cloth "cloth": a pin follows "body", but there is no collider of this name'),
    (lambda t: weft.read_obj(t), "{}: this is a folder; expected an OBJ file"),
    (lambda t: weft.read_obj(t / "no.obj"), f"{{}}/no.obj: cannot be read: {NO_ENTRY}"),
    (lambda t: weft.write_obj(t / "no" / "m.obj", SQUARE), f"{{}}/no/m.obj cannot be written: {NO_ENTRY}"),
    (lambda t: weft.write_obj(t, SQUARE), f"{{}} cannot be written: {os.strerror(EISDIR)}"),
    (lambda t: write_red(t / "no" / "a.png"), f"{{}}/no/a.png cannot be written: {NO_ENTRY}"),
    (lambda t: weft.load_scene("drape_box").write(t / "no" / "s.toml"),
     f"{{}}/no/s.toml cannot be written: {NO_ENTRY}"),
    (lambda t: weft.open_run(t), "{} holds no run: there is no run.json"),
    (lambda t: weft.load_scene("nope"), f'no scene file or shipped scene is named "nope"; available: {SHIPPED}'),
    (lambda t: weft.load_scene("drape_spher"),
     'no scene file or shipped scene is named "drape_spher"; did you mean "drape_sphere"?'),
    (lambda t: world_of(unused_vertex(t) + 'pins = ["index:99"]\n', t),
     'cloth "cloth": there is no index 99 to select; the last one is 4'),
    (lambda t: world_of(unused_vertex(t) + 'pins = ["index:4"]\n', t),
     'cloth "cloth": vertex 4 cannot be selected: no triangle uses it'),
    (lambda t: world_of(with_groups(t) + 'pins = ["group:flat"]\n', t),
     'cloth "cloth": group "flat" cannot be selected: its faces have no area'),
    (lambda t: world_of(with_groups(t) + 'pins = ["group:hem"]\n', t),
     'cloth "cloth" (m.obj): there is no group "hem"; there are "all", "flat"'),
    (lambda t: world_of(GRID_OF_FOUR + "pin = [{ select = { sphere = { center = [5, 5, 5], radius = 1 } } }]\n", t),
     'cloth "cloth": a pin\'s region contains no particle; regions are in world coordinates [m], after position and '
     "rotation"),
    (lambda t: world_of(two_meshes(t), t),
     'collider "body": frame 1: {}/m_1.obj:19: face 1 is not that of the first file; all files of a sequence must '
     "have the same vertices and faces, in the same order"),
    (lambda t: run_of(GRID_OF_FOUR, out="/dev/null/x"),
     "cannot create folder /dev/null/x: Not a directory"),
    (lambda t: run_of(GRID_OF_FOUR, glb=False).picture(), "the run has no animation.glb; run it with glb=True"),
    (lambda t: run_of(GRID_OF_FOUR, start_from=t), "{} holds no run: there is no run.json"),
    (lambda t: run_of(GRID_OF_FOUR, start_from=f"{t}@x"),
     'start_from {}@x: expected DIR@FRAME, with a number or "last" as FRAME'),
    (lambda t: run_of(GRID_OF_FOUR, start_from=f"{run_into(t)}@2"),
     "{}/old has the frames 0 to 1; a scene cannot start from frame 2"),
    (lambda t: run_of(GRID_OF_FOUR, start_from=run_into(t), out=t / "old"),
     "start_from {}/old: the results would replace the run that they start from; give them another folder"),
    (lambda t: run_of(GRID_OF_FOUR.replace("[4, 4]", "[4, 5]"), start_from=run_into(t)),
     'cloth "cloth" has 30 vertices in the scene, but 25 in frame 1 of {}/old; a start requires the same mesh'),
    (lambda t: run_of(GRID_OF_FOUR.replace("[[cloth]]", '[[cloth]]\nname = "cape"'), start_from=run_into(t)),
     'no cloth starts from frame 1 of {}/old: the scene has "cape", the run has "cloth"; cloths are matched by name'),
    (lambda t: run_of(GRID_OF_FOUR).video(t / "a.avi"), "{}/a.avi: expected a file name ending in .mp4, .webp or .gif"),
    (lambda t: run_of(GRID_OF_FOUR).video(t / "a.gif", every=0),
     "{}/a.gif: expected every 1st or a later frame, not 0"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "sentence"), FILES, ids=[f"{n}: {s[:60]}" for n, (_, s) in enumerate(FILES)])
def test_sentences_of_files(call: Callable[[Path], object], sentence: str, tmp_path: Path) -> None:
    with pytest.raises(weft.InputError) as caught:
        call(tmp_path)
    assert str(caught.value) == sentence.format(tmp_path)


def test_a_frame_that_is_not_there() -> None:
    result = run_of(GRID_OF_FOUR)
    for frame in (2, -3):
        with pytest.raises(weft.InputError) as caught:
            try:
                result.picture(frame=frame)
            except weft.GraphicsError as error:
                pytest.skip(f"there is no OpenGL: {error}")
        assert str(caught.value) == f"there is no frame {frame if frame > 0 else frame + 2}; the last one is 1"


def test_a_damaged_animation(tmp_path: Path) -> None:
    run_of(GRID_OF_FOUR, out=tmp_path)
    (tmp_path / "animation.glb").write_bytes(b"glTF")
    with pytest.raises(weft.InputError, match=f"^{re.escape(str(tmp_path))}/animation.glb: "):
        weft.open_run(tmp_path).picture()


def test_a_folder_of_scenes_that_is_none(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("WEFT_SCENES", str(tmp_path / "none"))
    with pytest.raises(weft.InputError) as caught:
        weft.scenes()
    assert str(caught.value) == f'WEFT_SCENES is "{tmp_path}/none", expected a folder with scenes'


def test_cloth_that_starts_crossed() -> None:
    with pytest.raises(weft.InputError) as caught:
        run_of(CROSSED)
    first, *_, last = str(caught.value).split("\n")
    assert first == "intersections at the start, which solver.untangle = false does not repair:"
    assert last == 'move them apart, or set solver.crossed_start = "allow" to run anyway'


# Every sentence of C++ is caused above, or cannot be caused from Python.

CHECKED, WINDOW, BUILT, NAMED = "checked in Python", "grabs belong to the window", "the library builds it", "C++ only"
UNREACHABLE = {
    "a batch requires a job system; make_serial_jobs() makes one without threads": BUILT,
    "a world requires a job system; make_serial_jobs() makes one without threads": BUILT,
    "RunOptions::checkpoint_seconds: expected 0 or more": NAMED,
    "there is no world ": CHECKED,
    "its texture coordinates are of ": CHECKED,
    "there is no particle ": CHECKED,
    " pinned particles, got ": CHECKED,
    "expected a target for each of ": CHECKED,
    "a point must be finite": CHECKED,
    "gravity must be finite": CHECKED,
    " has a non-finite coordinate": CHECKED,
    '": its pressure must be finite': CHECKED,
    "the height of the ground is not finite": CHECKED,
    ": expected 1 or more, found ": CHECKED,
    "; all must have the same number": "each frame is compared with the mesh first",
    "a stride must be at least the size of three numbers": "own arrays are contiguous",
    "an axis must be finite and nonzero": NAMED,
    " is empty: it refers to nothing": "handles are never empty",
    " is out of range; the world has ": NAMED,
    'no cloth or collider is named "': NAMED,
    '"; names must be unique': NAMED,
    '" has no topology': BUILT,
    " particles but ": BUILT,
    '" has no particle ': BUILT,
    "it has no mesh": BUILT,
    "its motion and its mesh have different numbers of vertices": BUILT,
    "the start of its deformation is not finite": CHECKED,
    "its deformation has a vertex that is not finite at the start": "the mesh is refused first",
    '": a pin follows a collider of the world, without a motion of its own': BUILT,
    "a grab follows a collider that is not in the world": WINDOW,
    "its topology has ": BUILT,
    " has no area: is it in no triangle? clean_mesh() removes such vertices": "meshes are cleaned",
    "a spring joins particles ": BUILT,
    " spring factors; expected one per spring, or none": BUILT,
    "; expected a finite number not below 0": "stiffen() refuses such factors first",
    '" has no grab ': WINDOW,
    "a grab's target must be finite": WINDOW,
    "a grab requires one share and one offset per particle": WINDOW,
    "a grab's stiffness and damping must be 0 or more": WINDOW,
    "a mesh sequence requires at least one key": BUILT,
    "there is no frame ": "test_a_frame_that_is_not_there",
    ": a video needs colours": "the package asks for colours",
    '", expected a folder with scenes': "test_a_folder_of_scenes_that_is_none",
    "the shipped scenes are not found; set WEFT_SCENES to their folder": "they are there",
    " has no frame yet": "a run writes its start first",
    "scene.settle: the simulation failed in step ": "no known scene diverges while it settles",
}
SEARCHED = ["face/*.cpp", "core/archive.h", "world/world.cpp", "world/world_input.cpp", "fabric/laboratory.cpp",
            "fabric/grid_springs.cpp", "mesh/triangle_mesh.cpp", "mesh/grid.cpp", "mesh/clean.cpp", "animation/*.cpp",
            "model/cloth_model.cpp", "integrators/integrator.cpp", "pictures/public_camera.cpp",
            "pictures/pictures.cpp",
            "run/run.cpp", "run/start_from.cpp", "scene/scene_start.cpp", "scene/scene_library.cpp", "scene/scene_world.cpp"]  # fmt: skip


THROWN = re.compile(r"(?:throw InputError|\brequire)\(((?:[^;\"]|\"(?:[^\"\\]|\\.)*\")*);")


def thrown_sentences() -> list[tuple[str, str]]:
    """File and longest piece of text of each sentence in C++."""
    found = []
    for pattern in SEARCHED:
        for file in sorted((TREE / "src" / "weft").glob(pattern)):
            for statement in THROWN.findall(file.read_text()):
                joined = re.sub(r'"\s*\n\s*"', "", statement)
                pieces = [piece.replace('\\"', '"') for piece in re.findall(r'"((?:[^"\\]|\\.)*)"', joined)]
                if pieces:
                    found.append((file.name, max(pieces, key=len)))
    return found


def test_every_sentence_of_cpp_is_tested_or_out_of_reach() -> None:
    if not (TREE / "src" / "weft").is_dir():
        pytest.skip("the sources of C++ are not beside the tests")
    tested = [sentence for _, sentence in CALLS] + [sentence for _, sentence in FILES]
    sentences = thrown_sentences()
    assert len(sentences) > 80
    untested = [(file, text) for file, text in sentences if not any(text in sentence for sentence in tested)]
    assert [(file, text) for file, text in untested if text not in UNREACHABLE] == []
    assert set(UNREACHABLE) <= {text for _, text in untested}


# Python's own sentences: the argument, what it is, and what it has to be.


def untracked_contacts() -> object:
    world = weft.World()
    world.contact = weft.ContactSettings(tracks_points=False)
    return world.contacts


OWN: list[tuple[Callable[[], object], str]] = [
    (lambda: put(cloth(), "positions", np.zeros((8, 3))), "positions: expected shape (9, 3), found (8, 3)"),
    (lambda: put(cloth(), "positions", np.zeros(9)), "positions: expected shape (9, 3), found (9,)"),
    (lambda: put(cloth(), "velocities", np.zeros((9, 2))), "velocities: expected shape (9, 3), found (9, 2)"),
    (lambda: put(cloth(), "velocities", "fast"), "velocities: expected an array of numbers, found 'fast'"),
    (lambda: put(cloth(), "velocities", np.zeros((9, 3), complex)),
     "velocities: expected an array of numbers, found an array of complex128"),
    (lambda: put(cloth(), "positions", [[0, 0, 0], [0, 0]]),
     "positions: expected an array of numbers, found [[0, 0, 0], [0, 0]]"),
    (lambda: put(cloth(), "positions", np.where(np.arange(27).reshape(9, 3) == 7, NAN, 0)),
     "positions: expected finite numbers, found nan at positions[2, 1]"),
    (lambda: cloth().set_forces((0, np.inf, 0)), "forces: expected finite numbers, found inf at forces[1]"),
    (lambda: cloth().set_forces(np.zeros((2, 3))), "forces: expected shape (9, 3), found (2, 3)"),
    (lambda: pins_with_targets().set_targets([0], np.zeros((2, 3))),
     "positions: expected shape (1, 3), found (2, 3)"),
    (lambda: cloth().copy_positions(np.zeros((9, 2))),
     "out: expected a writable, contiguous array of shape (9, 3), found (9, 2)"),
    (lambda: cloth().copy_positions(np.zeros((3, 9)).T),
     "out: expected a writable, contiguous array of shape (9, 3), found (9, 3), which is not contiguous or read-only"),
    (lambda: cloth().copy_positions(np.zeros((9, 3), int)),
     "out: expected an array of float32 or float64, found an array of int64"),
    (lambda: cloth().copy_velocities([1, 2, 3]),  # type: ignore[arg-type]
     "out: expected an array of float32 or float64, found [1, 2, 3]"),
    (lambda: cloth().pin([9]), "particles: index 9 is out of range for 9 particles"),
    (lambda: cloth().pin([-10]), "particles: index -10 is out of range for 9 particles"),
    (lambda: cloth().pin(np.ones(4, bool)), "particles: expected a mask of shape (9,), found (4,)"),
    (lambda: cloth().pin([[1, 2]]), "particles: expected a list of indices, found shape (1, 2)"),
    (lambda: cloth().pin([0.5]), "particles: expected integers or a mask, found [0.5]"),
    (lambda: cloth().pin([0], motion=5), "motion: expected a list of KeyFrame, found 5"),  # type: ignore[arg-type]
    (lambda: cloth().pin([0], motion=[5]), "motion: expected a list of KeyFrame, found 5"),  # type: ignore[list-item]
    (lambda: cloth().pin([0], pivot=(1, 2)), "pivot: expected 3 numbers, found shape (2,)"),
    (lambda: cloth().pin([0], stiffness="x"), "stiffness: expected a number, found 'x'"),  # type: ignore[arg-type]
    (lambda: cloth().pin([0], stiffness=1, damping=NAN), "damping: expected a finite number, found nan"),
    (lambda: cloth(rotation=(1, 2)),
     "rotation: expected a (3, 3) matrix, a quaternion (w, x, y, z) or 3 angles in degrees, found shape (2,)"),
    (lambda: cloth(position=NAN), "position: expected finite numbers, found nan at position"),
    (lambda: cloth(position=3), "position: expected 3 numbers, found shape ()"),
    (lambda: cloth(weld="x"), "weld: expected a number, found 'x'"),
    (lambda: cloth(fabric=3), "fabric: expected a Fabric, Springs or the name of a preset, found 3"),
    (lambda: cloth("x"), "shape: expected a grid, a solid or a mesh with vertices and faces, found 'x'"),
    (lambda: cloth(SQUARE).corners, 'cloth "cloth" is a mesh, which has no corners; choose particles by position'),
    (lambda: collider("x"), "shape: expected a grid, a solid or a mesh with vertices and faces, found 'x'"),
    (lambda: collider(SQUARE, frames=5), "frames: expected a list of pairs (time, vertices), found 5"),
    (lambda: collider(SQUARE, frames=[5]), "frames: expected pairs (time, vertices), found 5"),
    (lambda: collider(SQUARE, frames=[(1, 2, 3)]), "frames: expected pairs (time, vertices), found 3 items"),
    (lambda: collider(SQUARE, frames=[("x", SQUARE.vertices)]), "frames: expected a number, found 'x'"),
    (lambda: collider(friction="x"), "friction: expected a number, found 'x'"),
    (lambda: weft.Polygons([2], [0, 1]), "sizes: expected 3 or more corners of each, found 2"),
    (lambda: weft.Polygons([3], [0, 1, 2, 3]), "corners: expected 3, the sum of sizes, found 4"),
    (lambda: weft.Polygons([3.5], [0]), "sizes: expected a list of integers of 32 bits, found [3.5]"),
    (lambda: weft.Polygons([3], [0, 1, 2], uv=[(0, 0)]), "uv: expected shape (3, 2), found (1, 2)"),
    (lambda: weft.Polygons([3], [0, 1, 2], groups={"hem": [1]}),
     "groups['hem']: polygon 1 is out of range for 1 polygons"),
    (lambda: weft.Polygons([3], [0, 1, 2], groups=[0]),  # type: ignore[arg-type]
     "groups: expected polygons by name, found [0]"),
    (lambda: weft.Polygons([3], [0, 1, 2], groups={"hem": [0]}).vertices_of("hme"),
     'there is no group "hme"; there are "hem"'),
    (lambda: weft.Mesh(5, 5), "vertices: expected shape (n, 3), found ()"),
    (lambda: weft.Mesh([(0, 0)], [(0, 1, 2)]), "vertices: expected shape (n, 3), found (1, 2)"),
    (lambda: weft.Mesh(SQUARE.vertices, [(0, 1, 4)]), "faces: vertex 4 is out of range for 4 vertices"),
    (lambda: weft.Mesh(SQUARE.vertices, [(0, 1, -1)]), "faces: vertex -1 is out of range for 4 vertices"),
    (lambda: weft.Mesh(SQUARE.vertices, [(0, 1, 2, 3)]),
     "faces: expected shape (num_triangles, 3), found (1, 4); cut quads into triangles first"),
    (lambda: weft.Mesh(SQUARE.vertices, [(0, 1, 1.5)]), "faces: expected integers, found [(0, 1, 1.5)]"),
    (lambda: weft.Mesh(SQUARE.vertices, [(0, 1, 2), (0, 1)]),
     "faces: expected an array of integers, found [(0, 1, 2), (0, 1)]"),
    (lambda: weft.Mesh(SQUARE.vertices, SQUARE.faces, uv=[1]),
     "uv: expected shape (4, 2) by vertex or (2, 3, 2) by corner, found (1,)"),
    (lambda: weft.grid(size=1), "size: expected 2 lengths, found shape ()"),  # type: ignore[arg-type]
    (lambda: weft.grid(cells=1), "cells: expected 2 integers, found 1"),  # type: ignore[arg-type]
    (lambda: weft.grid(cells=(0, 1)), "cells: expected from 1 to 4096, found (0, 1)"),
    (lambda: empty().step("x"), "dt: expected a number, found 'x'"),  # type: ignore[arg-type]
    (lambda: empty().step(NAN), "dt: expected a finite number, found nan"),
    (lambda: weft.World(gravity=3), "gravity: expected 3 numbers, found shape ()"),
    (lambda: weft.World(integrator=3),  # type: ignore[arg-type]
     "integrator: expected a name or IntegratorSettings, found 3"),
    (lambda: weft.World(threads=1.5), "threads: expected a whole number, found 1.5"),  # type: ignore[arg-type]
    (lambda: weft.World(threads=2**40),
     "threads: expected a whole number of at most 32 bits, found 1099511627776"),
    (lambda: put(empty(), "contact", "x"), "contact: expected a ContactSettings, True or False, found 'x'"),
    (lambda: put(empty(), "wind", (1, 0, 0)), "wind: expected a Wind, found (1, 0, 0)"),
    (lambda: put(empty(), "division", 3), "division: expected a StepDivision, found 3"),
    (lambda: empty().remove(5), "body: expected a Cloth or a Collider, found 5"),  # type: ignore[arg-type]
    (lambda: empty().restore(5), "snapshot: expected a Snapshot, found 5"),  # type: ignore[arg-type]
    (lambda: empty().describe(5), "warning: expected a StepWarning, found 5"),  # type: ignore[arg-type]
    (lambda: weft.World.load(0), "source: expected bytes or a file, found 0"),  # type: ignore[arg-type]
    (lambda: empty().set_friction(1, 2, 3), "body: expected a Cloth or a Collider, found 1"),  # type: ignore[arg-type]
    (untracked_contacts,
     "contacts are not tracked; set world.contact = weft.ContactSettings(tracks_points=True) before the step"),
    (lambda: weft.load_scene(5),  # type: ignore[arg-type]
     "source: expected a file, a scene's name or TOML text, found 5"),
    (lambda: weft.load_scene(GRID_OF_FOUR).set(5),  # type: ignore[arg-type]
     'assignment: expected text such as "cloth[0].fabric=denim", found 5'),
    (lambda: put(weft.load_scene(GRID_OF_FOUR), "fps", NAN), "fps: expected a finite number, found nan"),
    (lambda: run_of(GRID_OF_FOUR, threads=0), "threads and frames: expected at least 1"),
    (lambda: weft.run("drape_box", frames=0), "threads and frames: expected at least 1"),
    (lambda: weft.run("drape_box", frames=1.5), "frames: expected a whole number, found 1.5"),  # type: ignore[arg-type]
    (lambda: weft.Camera(size=3), "size: expected width and height, found 3"),  # type: ignore[arg-type]
    (lambda: weft.Camera(size=(1, 2, 3)),  # type: ignore[arg-type]
     "size: expected width and height, found 3 items"),
    (lambda: weft.Camera(size=(1.5, 2)), "size: expected a whole number, found 1.5"),  # type: ignore[arg-type]
    (lambda: weft.Camera(fov_deg="wide"), "fov_deg: expected a number, found 'wide'"),  # type: ignore[arg-type]
    (lambda: weft.Camera().render(5), "world: expected a World, found 5"),  # type: ignore[arg-type]
    (lambda: weft.Camera().render(empty(), color=False, ground=NAN), "ground: expected a finite number, found nan"),
    (lambda: np.zeros((2, 2, 4), np.uint8).view(weft.Picture).save("a.png"),
     "picture: expected shape (height, width, 3) of uint8, found (2, 2, 4) of uint8"),
]  # fmt: skip


@pytest.mark.parametrize(("call", "sentence"), OWN, ids=numbered(OWN))
def test_sentences_of_python(call: Callable[[], object], sentence: str) -> None:
    with pytest.raises(weft.InputError) as caught:
        call()
    assert type(caught.value) is weft.InputError and caught.value.args == (sentence,)


def test_a_missing_name_is_a_key_error_with_all_names() -> None:
    with pytest.raises(KeyError) as caught:
        draped(2)["bal"]
    assert caught.value.args == ("no cloth or collider is named 'bal'; there are ['sheet', 'ball']",)


def test_a_wrong_type_of_a_value_names_it() -> None:
    with pytest.raises(TypeError) as caught:
        weft.Sphere(radius="x")  # type: ignore[arg-type]
    assert str(caught.value) == "radius: expected float, found 'x'"


# Scenes.

BROKEN = sorted((TREE / "tests" / "scene" / "broken").glob("*.toml"))
BROKEN_WITHOUT_CHANGES = [file for file in BROKEN if "\n# set: " not in file.read_text()]


@pytest.mark.parametrize("file", BROKEN_WITHOUT_CHANGES, ids=lambda file: file.stem)
def test_mistakes_of_scenes_have_file_line_column_and_message(file: Path) -> None:
    lines = file.read_text().splitlines()
    expected = [line.removeprefix("# error: ") for line in lines if line.startswith("# error: ")]
    with pytest.raises(weft.SceneError) as caught:
        weft.load_scene(file.read_text())
    found: list[weft.Diagnostic] = caught.value.diagnostics  # type: ignore[attr-defined]
    assert isinstance(caught.value, weft.InputError) and len(found) == len(expected) > 0
    for mistake, line in zip(found, expected, strict=True):
        assert mistake.file == "scene.toml"
        assert line in f"{mistake.line}:{mistake.column}: {mistake.message}"
        assert str(mistake) == f"{mistake.file}:{mistake.line}:{mistake.column}: {mistake.message}"
    assert str(caught.value) == "\n".join(map(str, found))


def test_mistakes_of_a_file_name_it(tmp_path: Path) -> None:
    file = tmp_path / "wrong.toml"
    file.write_text(GRID_OF_FOUR + 'modle = "basic"\n')
    with pytest.raises(weft.SceneError) as caught:
        weft.load_scene(file)
    (mistake,) = caught.value.diagnostics  # type: ignore[attr-defined]
    assert (mistake.file, mistake.line, mistake.column) == (str(file), 5, 1)
    assert mistake.message == 'unknown key "modle"; did you mean "model"?'


def test_mistakes_of_changes() -> None:
    scene = weft.load_scene(GRID_OF_FOUR)
    before = scene.to_dict()
    with pytest.raises(weft.SceneError) as caught:
        scene.fps = "many"
    (mistake,) = caught.value.diagnostics  # type: ignore[attr-defined]
    message = 'fps: expected a number above 0 in frames per second, found the string "many"'
    assert (mistake.file, mistake.line, mistake.column, mistake.message) == ("--set scene.fps", 0, 0, message)
    assert str(caught.value) == f"--set scene.fps: {message}"
    assert scene.to_dict() == before
    with pytest.raises(AttributeError, match="^cloth has no key 'colour'; there are name, fabric, "):
        scene.cloths[0].colour


# Steps.


def failing() -> weft.World:
    world = hanging(6)
    world.contact = False
    world.step(DT)
    cloth_of(world).set_forces((0, 1e38, 0))
    return world


SENTENCE = (
    'cloth "sheet": the motion of particle 1 became non-finite; raise solver.max_steps_per_frame or '
    "solver.steps_per_frame"
)


def test_a_failed_step_leaves_the_world_as_it_was() -> None:
    world = failing()
    before, time = world.state_hash(), world.time
    with pytest.raises(weft.SimulationError) as caught:
        world.step(DT)
    assert str(caught.value) == SENTENCE
    report = caught.value.report
    assert isinstance(report, weft.StepReport) and not report.ok
    assert [warning.code for warning in report.warnings] == ["non_finite"]
    assert (report.warnings[0].cloth, report.warnings[0].particle) == (0, 1)
    assert world.describe(report.warnings[0]) == SENTENCE
    assert (world.state_hash(), world.time) == (before, time)
    cloth_of(world).set_forces(None)
    assert world.step(DT).ok


def test_an_unchecked_step_returns_its_report() -> None:
    world = failing()
    before = world.state_hash()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        report = world.step(DT, check=False)
    assert not report.ok and world.state_hash() == before


def test_troubles_of_a_step_are_warned_of_once_per_kind_and_world() -> None:
    def trouble(world: weft.World) -> set[str]:
        saved = world.snapshot()
        cloth_of(world).velocities = (0, 1e10, 0)
        report = world.step(DT)
        world.restore(saved)
        return {warning.code for warning in report.warnings}

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        first, second = hanging(4), hanging(4)
        kinds = trouble(first)
        assert len(kinds) > 0 and len(caught) == len(kinds)
        assert trouble(first) == kinds and len(caught) == len(kinds)
        assert trouble(second) == kinds and len(caught) == 2 * len(kinds)
    assert {warning.category for warning in caught} == {weft.SimulationWarning}
    assert {warning.filename for warning in caught} == {__file__}
    assert all(str(warning.message).startswith('cloth "sheet": ') for warning in caught)


def test_sizes_of_absurd_grids_are_exact() -> None:
    grid = weft.Grid(cells_x=2**31 - 1, cells_z=2**31 - 1)
    assert grid.num_particles == 2**62
    assert grid.index(2**31 - 1, 2**31 - 1) == 2**62 - 1
