"""Worlds, cloths and colliders."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _core
from ._arguments import choose, indices, numbers, output, pairs_of, real, rotation, vector, vectors, whole, whole_numbers
from ._errors import tell
from ._mesh import Mesh, as_mesh

ForceKind = Literal["gravity", "elastic", "damping", "wind", "external", "contact"]
SpringModel = Literal["basic", "simplified", "alternating"]
Material = _core.Fabric | _core.Springs | str
Solid = _core.Sphere | _core.Plane | _core.Capsule | _core.Box

_CONTACT = np.dtype(
    [("position", "f8", 3), ("normal", "f8", 3), ("force", "f8", 3), ("cloth", "i4"), ("particle", "i4"),
     ("other_cloth", "i4"), ("collider", "i4"), ("other_vertex", "i4"), ("_", "i4")]
)  # fmt: skip
_STRAIN = np.dtype([("warp", "f8"), ("weft", "f8"), ("shear", "f8"), ("min_stretch", "f8"), ("max_stretch", "f8")])


def _material(fabric: Material) -> tuple[_core.Fabric | _core.Springs, str]:
    if isinstance(fabric, str):
        return _core.find_fabric(fabric), fabric
    choose(fabric, "fabric", (_core.Fabric, _core.Springs), "a Fabric, Springs or the name of a preset")
    return fabric, "fabric"


def _key_frames(motion: Sequence[_core.KeyFrame]) -> list[_core.KeyFrame]:
    choose(motion, "motion", Sequence, "a list of KeyFrame")
    for key in motion:
        choose(key, "motion", _core.KeyFrame, "a list of KeyFrame")
    return list(motion)


class Cloth:
    """A cloth of a world, from `World.add_cloth` or `World.cloths`. Arrays are by particle.

    After `World.remove`, and for another world, every call raises InputError.
    """

    def __init__(self, world: World, id: _core.ClothId) -> None:
        self._world, self._core, self._id = world, world._core, id

    @property
    def _count(self) -> int:
        return self._core.num_particles(self._id)

    def __repr__(self) -> str:
        return f"<weft.Cloth {self.name!r}, {self._count} particles>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Cloth) and self._core is other._core and self._id == other._id

    def __hash__(self) -> int:
        return hash(self._id)

    def __len__(self) -> int:
        return self._count

    def __reduce__(self) -> tuple[Any, ...]:
        return _cloth_at, (self._world, self._core.cloth_ids().index(self._id))

    @property
    def world(self) -> World:
        """The world that it belongs to."""
        return self._world

    @property
    def name(self) -> str:
        """Its name in reports."""
        return self._core.name(self._id)

    @property
    def num_particles(self) -> int:
        """The number of its particles, also `len(cloth)`; more where it has torn."""
        return self._count

    # Shape.

    @property
    def faces(self) -> NDArray[np.int32]:
        """Particles of each triangle: (num_triangles, 3), read-only; a new array."""
        return _read_only(self._core.faces(self._id))

    @property
    def rest(self) -> NDArray[np.float64]:
        """Positions of the rest shape in the cloth's own coordinates: (n, 3) [m], read-only; a new array."""
        return _read_only(self._core.rest_positions(self._id))

    @property
    def uv(self) -> NDArray[np.float64]:
        """Texture coordinates by corner: (num_triangles, 3, 2), or (0, 3, 2) without; read-only; a new array."""
        return _read_only(self._core.uv(self._id))

    @property
    def grid(self) -> _core.Grid | None:
        """The grid that it was made from; None for a mesh."""
        return self._core.grid(self._id)

    @property
    def corners(self) -> NDArray[np.int32]:
        """Particles at a grid's corners: both ends of the first row along x, then of the last one. A new array.

        Raises InputError for a mesh, which has none.
        """
        grid = self.grid
        if grid is None:
            raise _core.InputError(f'cloth "{self.name}" is a mesh, which has no corners; choose particles by position')
        x, z = grid.cells_x, grid.cells_z
        return np.array([grid.index(0, 0), grid.index(x, 0), grid.index(0, z), grid.index(x, z)], np.int32)

    @property
    def masses(self) -> NDArray[np.float64]:
        """Mass of each particle: (n,) [kg]; a new array."""
        return self._core.masses(self._id)

    @property
    def notes(self) -> list[str]:
        """What was done to its mesh, and its flaws, as sentences."""
        _, flaws, done = self._core.notes(self._id)
        return done + flaws

    @property
    def particle_of_vertex(self) -> NDArray[np.int32]:
        """The particle of each vertex given to `add_cloth`; -1 for dropped ones. A new array."""
        return self._core.notes(self._id)[0]

    # State.

    @property
    def positions(self) -> NDArray[np.float64]:
        """Positions in the world: (n, 3) [m]. A new array, yours to keep and change.

        Set it to move the cloth without a swept motion; velocities stay. Within 2 m of `origin` it is exact to
        1e-7 m, since the engine stores floats relative to that.
        """
        out = np.empty((self._count, 3))
        self._core.copy_positions(self._id, out)
        return out

    @positions.setter
    def positions(self, positions: ArrayLike) -> None:
        self._core.set_positions(self._id, vectors(positions, "positions", self._count))

    @property
    def velocities(self) -> NDArray[np.float64]:
        """Velocities: (n, 3) [m/s]. A new array. Set it to change them; one vector stands for all particles."""
        out = np.empty((self._count, 3))
        self._core.copy_velocities(self._id, out)
        return out

    @velocities.setter
    def velocities(self, velocities: ArrayLike) -> None:
        self._core.set_velocities(self._id, vectors(velocities, "velocities", self._count))

    def copy_positions(self, out: NDArray[Any]) -> None:
        """Copies positions to your own contiguous float32 or float64 array (n, 3) [m]; allocates nothing."""
        self._core.copy_positions(self._id, output(out, self._count))

    def copy_velocities(self, out: NDArray[Any]) -> None:
        """Copies velocities to your own contiguous float32 or float64 array (n, 3) [m/s]; allocates nothing."""
        self._core.copy_velocities(self._id, output(out, self._count))

    @property
    def normals(self) -> NDArray[np.float64]:
        """Normals of unit length: (n, 3). A new array."""
        out = np.empty((self._count, 3))
        self._core.copy_normals(self._id, out)
        return out

    @property
    def offsets(self) -> NDArray[np.float32]:
        """Positions relative to `origin` as the engine stores them: (n, 3) float32 [m]. A read-only view.

        It shows the newest state after every step. It keeps its world alive, and after `World.remove` its memory.
        """
        return self._core.offsets(self._id)

    @property
    def origin(self) -> tuple[float, float, float]:
        """The origin of `offsets`, which follows the cloth [m]."""
        return self._core.origin(self._id)

    @property
    def vertices(self) -> NDArray[np.float64]:
        """Positions of the vertices given to `add_cloth`, in their order: (num_vertices, 3) [m]. A new array.

        Merged vertices coincide; dropped ones stay where they started.
        """
        return self._core.vertex_positions(self._id)

    def teleport(
        self, *, translation: ArrayLike = (0, 0, 0), rotation: Any = None, keeps_velocity: bool = True
    ) -> None:
        """Moves the whole cloth at once by p → rotation p + translation, in the world's coordinates [m].

        Velocities rotate with it, or become zero. `rotation` as in `World.add_cloth`.
        """
        self._core.teleport(self._id, vector(translation, "translation"), _rotation(rotation), bool(keeps_velocity))

    # Pins.

    def pin(
        self,
        particles: ArrayLike,
        *,
        stiffness: float | None = None,
        damping: float = 0.0,
        motion: Sequence[_core.KeyFrame] = (),
        pivot: ArrayLike = (0, 0, 0),
        follow: Collider | None = None,
    ) -> None:
        """Pins particles where they are: indices, negative ones from the end, or a mask.

        `stiffness` [N/m] and `damping` [N·s/m] make them soft: a spring each. `motion` moves them along key frames,
        turning about `pivot` [m]. `follow` binds them to a collider instead: to the nearest triangle of a mesh, to any
        other shape as a rigid body. Raises InputError for particles that are pinned already.
        """
        if follow is not None:
            choose(follow, "follow", Collider, "a Collider")
        self._core.add_pin(
            self._id,
            indices(particles, self._count, "particles"),
            _key_frames(motion),
            vector(pivot, "pivot"),
            None if follow is None else follow._id,
            None if stiffness is None else real(stiffness, "stiffness"),
            real(damping, "damping"),
        )

    def unpin(self, particles: ArrayLike | None = None) -> None:
        """Releases pinned particles; without an argument all. Raises InputError for particles that are not pinned."""
        if particles is None:
            self._core.unpin(self._id, self.pins)
        else:
            self._core.unpin(self._id, indices(particles, self._count, "particles"))

    @property
    def pins(self) -> NDArray[np.int32]:
        """Pinned particles, in the order of pinning. A new array."""
        return self._core.pinned_particles(self._id)

    def set_targets(self, particles: ArrayLike, positions: ArrayLike) -> None:
        """Positions of pinned particles at the end of the next step: (k, 3) [m]; one stands for all.

        During the step they move evenly; without a further call they stay. Replaces motions by key frames.
        """
        chosen = indices(particles, self._count, "particles")
        self._core.move_pins(self._id, chosen, vectors(positions, "positions", len(chosen)))

    # Forces and strains, computed on demand.

    @property
    def forces(self) -> NDArray[np.float64]:
        """Sum of all forces on each particle, but of pins: (n, 3) [N]. A new array."""
        return self._core.forces(self._id, None)

    def force(self, kind: ForceKind) -> NDArray[np.float64]:
        """Force of one kind on each particle: (n, 3) [N]. A new array."""
        choose(kind, "kind", str, "the name of a kind of force")
        return self._core.forces(self._id, kind)

    def set_forces(self, forces: ArrayLike | None) -> None:
        """External forces: (n, 3) [N], constant until the next call; one stands for all particles, None for none."""
        if forces is None:
            self._core.set_forces(self._id, np.empty((0, 3)))
        else:
            self._core.set_forces(self._id, vectors(forces, "forces", self._count))

    def set_pressure(self, pressure: float, *, sealed: bool = False) -> None:
        """Gas inside closed cloth, in excess of the air outside [Pa]; 0: none, unless it is sealed.

        A sealed amount of gas keeps the product of absolute pressure and volume, from `pressure` at the present volume.
        """
        choose(sealed, "sealed", bool, "True or False")
        self._core.set_pressure(self._id, real(pressure, "pressure"), sealed)

    @property
    def pressure(self) -> float:
        """Present excess of the gas inside over the air outside [Pa]."""
        return self._core.pressure(self._id)

    @property
    def volume(self) -> float:
        """Inside closed cloth [m³]. Raises InputError for cloth that is not closed."""
        return self._core.volume(self._id)

    @property
    def pin_forces(self) -> NDArray[np.float64]:
        """Reaction force of each pin: (k, 3) [N], in the order of `pins`. A new array.

        A particle's mass times its acceleration in the last step, less all other forces. Zero before the first step.
        """
        return self._core.pin_forces(self._id)

    @property
    def strain(self) -> NDArray[np.void]:
        """Strain of each triangle: a structured array with the fields warp and weft [1], the shear angle [rad],
        and the extremes over all directions, min_stretch and max_stretch [1]. A new array."""
        return self._core.triangle_strains(self._id).view(_STRAIN).reshape(-1)

    @property
    def stretches(self) -> NDArray[np.float64]:
        """Principal stretches of each triangle: (num_triangles, 2), length over rest length [1]. A new array."""
        return np.ascontiguousarray(self._core.triangle_strains(self._id)[:, 3:])

    @property
    def spring_strains(self) -> NDArray[np.float64]:
        """Length over rest length − 1 of each spring: (num_springs,) [1]. A new array."""
        return self._core.spring_strains(self._id)

    @property
    def momentum(self) -> tuple[float, float, float]:
        """[kg·m/s]"""
        return self._core.momentum(self._id)

    @property
    def center_of_mass(self) -> tuple[float, float, float]:
        """[m]"""
        return self._core.center_of_mass(self._id)

    # Settings.

    @property
    def fabric(self) -> _core.Fabric | _core.Springs:
        """Its material, a copy. Set it to change it, also by a preset's name; the rest shape stays."""
        return self._core.fabric(self._id)

    @fabric.setter
    def fabric(self, fabric: Material) -> None:
        self._core.set_fabric(self._id, _material(fabric)[0])

    def stiffen(self, particles: ArrayLike, factor: float) -> None:
        """Multiplies the stiffness of springs with both ends among the particles; springs only."""
        self._core.stiffen(self._id, indices(particles, self._count, "particles"), real(factor, "factor"))


class Collider:
    """A collider of a world, from `World.add_collider` or `World.colliders`."""

    def __init__(self, world: World, id: _core.ColliderId) -> None:
        self._world, self._core, self._id = world, world._core, id

    def __repr__(self) -> str:
        return f"<weft.Collider {self.name!r}>"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Collider) and self._core is other._core and self._id == other._id

    def __hash__(self) -> int:
        return hash(self._id)

    def __reduce__(self) -> tuple[Any, ...]:
        return _collider_at, (self._world, self._core.collider_ids().index(self._id))

    @property
    def world(self) -> World:
        """The world that it belongs to."""
        return self._world

    @property
    def name(self) -> str:
        """Its name in reports."""
        return self._core.name(self._id)

    @property
    def notes(self) -> list[str]:
        """Flaws of its mesh, as sentences."""
        return self._core.warnings(self._id)

    @property
    def pose(self) -> tuple[tuple[float, float, float], NDArray[np.float64]]:
        """Translation [m] and rotation matrix (3, 3), from its own coordinates to the world's, now."""
        return self._core.pose(self._id)

    def move_to(self, *, translation: ArrayLike = (0, 0, 0), rotation: Any = None) -> None:
        """Its pose at the end of the next step, from its own coordinates to the world's [m].

        During the step it moves evenly, and turns the shorter way. Without a further call it stands still.
        `rotation` as in `World.add_cloth`. Replaces its key frames.
        """
        self._core.move_collider(self._id, vector(translation, "translation"), _rotation(rotation))

    def place_at(self, *, translation: ArrayLike = (0, 0, 0), rotation: Any = None) -> None:
        """Its pose at once, without a swept motion; as `move_to` else."""
        self._core.place_collider(self._id, vector(translation, "translation"), _rotation(rotation))

    def move_vertices(self, positions: ArrayLike) -> None:
        """A mesh's vertices at the end of the next step: (num_vertices, 3) in its own coordinates [m]."""
        self._core.move_vertices(self._id, vectors(positions, "positions"))

    def place_vertices(self, positions: ArrayLike) -> None:
        """A mesh's vertices at once, without a swept motion: (num_vertices, 3) in its own coordinates [m]."""
        self._core.place_vertices(self._id, vectors(positions, "positions"))

    @property
    def friction(self) -> float:
        """Coulomb coefficient of cloth on it, >= 0 [1]. Can be set; then also for sticking contacts."""
        return self._core.friction(self._id)[0]

    @friction.setter
    def friction(self, friction: float) -> None:
        self._core.set_friction(self._id, real(friction, "friction"), 0.0)


class SurfacePoint:
    """A point on a cloth's surface: cloth, triangle, weights of its corners, position [m], distance [m]."""

    def __init__(self, world: World, found: dict[str, Any]) -> None:
        self.cloth = Cloth(world, found["cloth"])
        self.triangle: int = found["triangle"]
        self.weights: tuple[float, float, float] = found["weights"]
        self.position: tuple[float, float, float] = found["position"]
        self.distance: float = found["distance"]

    def __repr__(self) -> str:
        return f"SurfacePoint(cloth={self.cloth.name!r}, triangle={self.triangle}, distance={self.distance:.6g})"


class World:
    """Cloths, colliders, pins and wind, stepped through time. Metres, kilograms, seconds; Y up.

    gravity: [m/s²]. integrator: a name of `integrator_names()`, or IntegratorSettings. threads: they never change
    the result. contact: whether cloth collides with colliders, itself and other cloth.

    Calls release Python's global lock. Different worlds may be used from different threads; a second thread in the
    same world gets a RuntimeError.

    >>> from weft import grid
    >>> world = World()
    >>> sheet = world.add_cloth(grid(cells=(8, 8)), fabric="denim")
    >>> sheet.pin(sheet.corners[:2])
    >>> for frame in range(3):
    ...     report = world.step(1 / 60)
    >>> report.ok, round(world.time, 3)
    (True, 0.05)
    """

    def __init__(
        self,
        *,
        gravity: ArrayLike = (0, -9.81, 0),
        integrator: str | _core.IntegratorSettings = "newton",
        threads: int = 1,
        contact: bool = True,
    ) -> None:
        self._adopt(_core.World())
        self.gravity = vector(gravity, "gravity")
        if integrator != "newton":
            self.integrator = integrator
        self.threads = threads
        self.contact = _core.ContactSettings(enabled=bool(contact), tracks_points=bool(contact))

    def _adopt(self, core: _core.World) -> None:
        self._core = core
        self._told: set[str] = set()

    @classmethod
    def _of(cls, core: _core.World) -> World:
        world = cls.__new__(cls)
        world._adopt(core)
        return world

    def __repr__(self) -> str:
        names = ", ".join([cloth.name for cloth in self.cloths] + [body.name for body in self.colliders])
        return f"<weft.World at {self.time:.4g} s: {names or 'empty'}>"

    # Contents.

    def add_cloth(
        self,
        shape: Any,
        *,
        fabric: Material = "cotton_shirting",
        position: ArrayLike = (0, 0, 0),
        rotation: Any = None,
        velocity: ArrayLike = (0, 0, 0),
        name: str = "",
        membrane: Literal["triangle", "springs"] = "triangle",
        warp: ArrayLike | None = None,
        model: SpringModel = "alternating",
        weld: float | None = None,
        sew: float = 0.0,
        rest: ArrayLike | None = None,
        rest_scales: Sequence[tuple[Sequence[int], float, float]] = (),
        seams: Sequence[tuple[Sequence[int], Sequence[int]]] = (),
        stitches: ArrayLike = (),
        seam_time: float = 1.0,
        seam_stiffness: float | None = None,
        layer: int = 0,
        fits_thickness: bool = True,
    ) -> Cloth:
        """Adds a cloth: a `grid`, a `Mesh`, or any object with `vertices` and `faces`.

        fabric: a preset's name, Fabric or Springs. position [m] and rotation: its pose. A rotation is a (3, 3)
        matrix, a quaternion (w, x, y, z), 3 angles in degrees about fixed x, then y, then z, or SciPy's Rotation.
        velocity: of all particles [m/s]. membrane: elements on triangles, or springs fitted to the fabric. warp: its
        direction in the cloth's own coordinates. model: springs of a grid, and how its cells are cut. weld: merges
        vertices within this distance. sew: joins borders within this distance [m]. rest: another rest shape than the
        mesh, as the corners of each face, (num_faces, 3, 3) [m]; `rest_from_uv` gives that of a pattern. rest_scales:
        (vertices, warp, weft), factors of lengths at rest along warp and weft: elastic, gathers. seams: pairs of
        stretches of border that draw together within seam_time [s], and hold; each stretch is a list of vertices on a
        border, in order, from each to the next the shorter way; the first of one is sewn to the first of the other.
        stitches: pairs of vertices that draw together likewise (n, 2), such as `polygons.lines` of a mesh from a file.
        seam_stiffness: tension per opening [N/m²]; None: that of the cloth's edges. layer: order of garments over
        each other: `untangle` moves a cloth outside of those with lower numbers. fits_thickness: reduces the
        thickness to half of a mean edge where it is larger.

        Raises InputError for an invalid mesh or fabric.
        """
        material, fabric_name = _material(fabric)
        if not isinstance(shape, _core.Grid):
            mesh = as_mesh(shape)
            shape = (mesh.vertices, mesh.faces, mesh.uv)
        id = self._core.add_cloth(
            str(name), shape, "", material, fabric_name, str(membrane),
            None if warp is None else vector(warp, "warp"), str(model), vector(position, "position"),
            _rotation(rotation), vector(velocity, "velocity"), None if weld is None else real(weld, "weld"),
            real(sew, "sew"), None if rest is None else _corners(rest), _rest_scales(rest_scales), _seams(seams),
            pairs_of(stitches, "stitches").tolist(),
            real(seam_time, "seam_time"), None if seam_stiffness is None else real(seam_stiffness, "seam_stiffness"),
            whole(layer, "layer"), bool(fits_thickness),
        )  # fmt: skip
        return Cloth(self, id)

    def add_collider(
        self,
        shape: Any,
        *,
        friction: float = 0.3,
        static_friction: float = 0.0,
        position: ArrayLike = (0, 0, 0),
        rotation: Any = None,
        motion: Sequence[_core.KeyFrame] = (),
        frames: Iterable[tuple[float, ArrayLike]] = (),
        start_time: float | None = None,
        solid: bool | None = None,
        name: str = "",
    ) -> Collider:
        """Adds a collider: Sphere, Plane, Capsule, Box, Mesh, or any object with `vertices` and `faces`.

        position [m] and rotation: its pose, as in `add_cloth`. motion: key frames. frames: (time, vertices) of a
        mesh that deforms, linear between them. start_time: of the `deformation` of a mesh from `read_gltf`, at time 0 of
        the world [s]; by default its start. friction and static_friction: Coulomb coefficients of cloth on it.

        solid: whether the holes of a mesh are filled, so that it has an inside; None: those of shells whose holes are
        at most a twentieth of their area.

        Raises InputError for an invalid shape or motion.
        """
        deformation = None
        if not isinstance(shape, Solid):
            mesh = as_mesh(shape)
            shape, deformation = (mesh.vertices, mesh.faces), mesh.deformation
        if start_time is None:
            start_time = deformation.start if deformation is not None else 0.0
        elif deformation is None:
            raise _core.InputError("start_time: only a mesh with a deformation has it, from read_gltf")
        keys = _key_frames(motion)
        choose(frames, "frames", Iterable, "a list of pairs (time, vertices)")
        poses = []
        for frame in frames:
            choose(frame, "frames", (tuple, list), "pairs (time, vertices)")
            if len(frame) != 2:
                raise _core.InputError(f"frames: expected pairs (time, vertices), found {len(frame)} items")
            poses.append((real(frame[0], "frames"), vectors(frame[1], "frames")))
        id = self._core.add_collider(
            str(name), shape, "", None if solid is None else bool(solid), vector(position, "position"),
            _rotation(rotation), keys, poses,
            deformation, real(start_time, "start_time"), real(friction, "friction"), real(static_friction, "static_friction"),
        )  # fmt: skip
        return Collider(self, id)

    def remove(self, body: Cloth | Collider) -> None:
        """Removes a cloth or a collider; its handles and views remain harmless."""
        choose(body, "body", (Cloth, Collider), "a Cloth or a Collider")
        self._core.remove(body._id)

    def __contains__(self, body: object) -> bool:
        return isinstance(body, (Cloth, Collider)) and self._core.contains(body._id)

    @property
    def cloths(self) -> list[Cloth]:
        """Its cloths, in the order of addition."""
        return [Cloth(self, id) for id in self._core.cloth_ids()]

    @property
    def colliders(self) -> list[Collider]:
        """Its colliders, in the order of addition."""
        return [Collider(self, id) for id in self._core.collider_ids()]

    def __getitem__(self, name: str) -> Cloth | Collider:
        """The first cloth or collider of that name. Raises KeyError with all names."""
        bodies: list[Cloth | Collider] = [*self.cloths, *self.colliders]
        for body in bodies:
            if body.name == name:
                return body
        raise KeyError(f"no cloth or collider is named {name!r}; there are {[body.name for body in bodies]}")

    # Settings.

    @property
    def gravity(self) -> tuple[float, float, float]:
        """[m/s²]; can be set."""
        return self._core.gravity

    @gravity.setter
    def gravity(self, gravity: ArrayLike) -> None:
        self._core.gravity = vector(gravity, "gravity")

    @property
    def wind(self) -> _core.Wind:
        """A copy; set it to change it: `world.wind = weft.Wind(velocity=(5, 0, 0), air=weft.Air(density=1.2))`."""
        return self._core.wind

    @wind.setter
    def wind(self, wind: _core.Wind) -> None:
        choose(wind, "wind", _core.Wind, "a Wind")
        self._core.wind = wind

    @property
    def integrator(self) -> _core.IntegratorSettings:
        """A copy; set it to change it, also by the integrator's name."""
        return self._core.integrator

    @integrator.setter
    def integrator(self, integrator: str | _core.IntegratorSettings) -> None:
        if isinstance(integrator, str):
            integrator = _core.IntegratorSettings(integrator=integrator)
        choose(integrator, "integrator", _core.IntegratorSettings, "a name or IntegratorSettings")
        self._core.integrator = integrator

    @property
    def division(self) -> _core.StepDivision:
        """Whether and how far steps are divided that come out wrong, a copy; set it to change it."""
        return self._core.division

    @division.setter
    def division(self, division: _core.StepDivision) -> None:
        choose(division, "division", _core.StepDivision, "a StepDivision")
        self._core.division = division

    @property
    def contact(self) -> _core.ContactSettings:
        """Contact settings, a copy; set it to change them, `world.contact = False` to switch contact off."""
        return self._core.contact

    @contact.setter
    def contact(self, contact: _core.ContactSettings | bool) -> None:
        if isinstance(contact, bool):
            contact = _core.ContactSettings(enabled=contact, tracks_points=contact)
        choose(contact, "contact", _core.ContactSettings, "a ContactSettings, True or False")
        self._core.contact = contact

    @property
    def threads(self) -> int:
        """Threads of a step, at least 1; they never change the result. Can be set."""
        return self._core.threads

    @threads.setter
    def threads(self, threads: int) -> None:
        self._core.threads = whole(threads, "threads")

    def set_friction(
        self, a: Cloth | Collider, b: Cloth | Collider, friction: float, static_friction: float = 0.0
    ) -> None:
        """Coulomb coefficients of this pair only, one of them a cloth; the same cloth twice: with itself [1]."""
        for body in (a, b):
            choose(body, "body", (Cloth, Collider), "a Cloth or a Collider")
        self._core.set_pair_friction(
            a._id, b._id, real(friction, "friction"), real(static_friction, "static_friction")
        )

    def set_collision(self, a: Cloth | Collider, b: Cloth | Collider, collide: bool) -> None:
        """Whether this pair collides, one of them a cloth; the same cloth twice: with itself."""
        for body in (a, b):
            choose(body, "body", (Cloth, Collider), "a Cloth or a Collider")
        self._core.set_collision(a._id, b._id, bool(collide))

    # Time.

    def step(self, dt: float, *, check: bool = True) -> _core.StepReport:
        """Advances the world by dt > 0 [s].

        A failed step leaves the world as it was, and raises SimulationError; with `check=False` its report says so
        instead. Problems of a step that was made are warned of once per kind, as SimulationWarning.
        """
        report = self._core.step(real(dt, "dt"))
        if not report._is_clean:
            tell(report, self._core.describe, self._told, raises=report if check else None, stacklevel=3)
        return report

    def find_problems(self) -> list[_core.StepWarning]:
        """Problems of the world as it is, for programs that step it themselves.

        yarn_strain beyond 1.25 times the fabric's limit, or 0.15 without one; flat_triangle; open_seam; and, by the
        independent checker, crossings and penetration deeper than 0.1 mm. Takes about as long as a step.
        """
        return self._core.find_problems()

    def describe(self, warning: _core.StepWarning) -> str:
        """A warning of a step, or of find_problems(), as a sentence, with the key to change."""
        choose(warning, "warning", _core.StepWarning, "a StepWarning")
        return self._core.describe(warning)

    @property
    def time(self) -> float:
        """[s]"""
        return self._core.time

    def untangle(self) -> list[str]:
        """Separates cloth that intersects itself, other cloth or colliders, and puts layers in order; takes seconds.

        Returns the remaining intersections as sentences; positions stay if separation fails.
        """
        return self._core.untangle()

    # Measurements.

    @property
    def contacts(self) -> NDArray[np.void]:
        """Contacts of the last step: a structured array with position [m], normal, force on the cloth [N], and the
        indices cloth, particle, other_cloth, collider, other_vertex; -1: none. A new array.

        Raises InputError if they are not tracked (`World.contact`).
        """
        settings = self._core.contact
        if settings.enabled and not settings.tracks_points:
            raise _core.InputError(
                "contacts are not tracked; set world.contact = weft.ContactSettings(tracks_points=True) before the step"
            )
        rows: NDArray[np.void] = self._core.contacts().view(_CONTACT).reshape(-1)
        return rows

    @property
    def energies(self) -> dict[str, float]:
        """kinetic, elastic, bending and gravitational energy of all cloths [J]; the last is zero at the origin."""
        return dict(zip(("kinetic", "elastic", "bending", "gravitational"), self._core.energies(), strict=True))

    def cast_ray(self, origin: ArrayLike, direction: ArrayLike, reach: float = 1e30) -> SurfacePoint | None:
        """First hit of a ray on any cloth within `reach` [m]; None without."""
        found = self._core.cast_ray(vector(origin, "origin"), vector(direction, "direction"), real(reach, "reach"))
        return None if found is None else SurfacePoint(self, found)

    def closest_point(self, point: ArrayLike, reach: float = 1e30) -> SurfacePoint | None:
        """Closest point on any cloth within `reach` [m]; None without."""
        found = self._core.closest_point(vector(point, "point"), real(reach, "reach"))
        return None if found is None else SurfacePoint(self, found)

    # Snapshots and saved worlds.

    def snapshot(self) -> _core.Snapshot:
        """State of all moving parts, for `restore` in this world or a clone of it; cheap next to a step."""
        return self._core.snapshot()

    def restore(self, snapshot: _core.Snapshot) -> None:
        """Returns to a snapshot. Stepping again gives the same bits.

        Raises InputError for a snapshot of another world, or if cloths or colliders have changed.
        """
        choose(snapshot, "snapshot", _core.Snapshot, "a Snapshot")
        self._core.restore(snapshot)

    def clone(self) -> World:
        """A world in the same state, which continues with the same bits; also `copy.deepcopy(world)`."""
        return World._of(self._core.clone())

    def save(self, file: str | os.PathLike[str] | None = None) -> bytes:
        """The whole world as bytes, also written to a file if one is named. Threads are not saved."""
        data = self._core.save()
        if file is not None:
            choose(file, "file", (str, os.PathLike), "a file")
            part = f"{os.fspath(file)}.partial"
            with open(part, "wb") as stream:
                stream.write(data)
            os.replace(part, file)
        return data

    @staticmethod
    def load(source: bytes | str | os.PathLike[str]) -> World:
        """A saved world, from bytes or a file; it continues with the same bits.

        Raises InputError for damaged bytes or another version of the format.
        """
        if not isinstance(source, (bytes, bytearray, memoryview)):
            choose(source, "source", (str, os.PathLike), "bytes or a file")
            with open(source, "rb") as stream:
                source = stream.read()
        return World._of(_core.World.load(bytes(source)))

    def __reduce__(self) -> tuple[Any, ...]:
        return World.load, (self.save(),)

    def __copy__(self) -> World:
        return self.clone()

    def __deepcopy__(self, memo: dict[int, Any]) -> World:
        copy = memo[id(self)] = self.clone()
        return copy

    def state_hash(self) -> str:
        """Hash of time, positions and velocities, bit by bit: 16 hexadecimal digits, as `weft run` prints them."""
        return self._core.state_hash()


_rotation = rotation  # the function, where an argument has its name


def _corners(rest: ArrayLike) -> NDArray[np.float64]:
    array = numbers(rest, "rest")
    if array.ndim != 3 or array.shape[1:] != (3, 3):
        raise _core.InputError(f"rest: expected shape (num_faces, 3, 3), found {array.shape}")
    return np.ascontiguousarray(array.reshape(-1, 3))


def _rest_scales(scales: Any) -> list[tuple[Any, float, float]]:
    choose(scales, "rest_scales", Sequence, "a list of (vertices, warp, weft)")
    found = []
    for scale in scales:
        if not isinstance(scale, Sequence) or len(scale) != 3:
            raise _core.InputError(f"rest_scales: expected (vertices, warp, weft), found {scale!r:.60}")
        vertices, warp, weft = scale
        found.append((whole_numbers(vertices, "rest_scales"), real(warp, "rest_scales"), real(weft, "rest_scales")))
    return found


def _seams(seams: Any) -> list[tuple[Any, Any]]:
    choose(seams, "seams", Sequence, "a list of pairs of lists of vertices")
    pairs = []
    for seam in seams:
        if not isinstance(seam, Sequence) or len(seam) != 2:
            raise _core.InputError(f"seams: expected pairs of lists of vertices, found {seam!r:.60}")
        pairs.append((whole_numbers(seam[0], "seams"), whole_numbers(seam[1], "seams")))
    return pairs


def _read_only(array: NDArray[Any]) -> NDArray[Any]:
    array.flags.writeable = False
    return array


def _cloth_at(world: World, index: int) -> Cloth:
    return world.cloths[index]


def _collider_at(world: World, index: int) -> Collider:
    return world.colliders[index]


__all__ = ["Cloth", "Collider", "ForceKind", "Material", "Mesh", "Solid", "SpringModel", "SurfacePoint", "World"]
