#!/usr/bin/env python3
"""The hung sheet of `weft study peers` in Newton (the engine on Warp), on the processor, without contact.

newton_sheet.py SIDE CLOTH SOLVER SUBSTEPS ITERATIONS FRAMES FILE

SIDE particles a side of a square metre; CLOTH is springs or membrane; SOLVER is semi_implicit, xpbd, vbd or style3d;
SUBSTEPS per frame of 1/60 s, ITERATIONS per substep (semi_implicit has none). Writes x y z of all particles by turns as
32-bit floats (frame by frame, y up, the row of pins first) to FILE, and prints one line of JSON:
{"engine": "Newton 1.8.0", "cpu_ms_per_frame": 10.4}.

The springs are Weft's, one by one: structural, shear along one diagonal, bend over two cells.

The membrane of vbd: its energy per area is μ/2 (tr FᵀF − 2) + λ'/2 (J − α)² with μ = tri_ke, λ' = tri_ka + μ and
α = 1 + μ/λ'. With F = I + ε its stress is, to first order, 2 μ ε + (λ' − μ) tr ε I = 2 μ ε + tri_ka tr ε I, so that
C12 = tri_ka, G = tri_ke and C11 = tri_ka + 2 tri_ke: 1000 and 1000 N/m make 3000, 1000 and 1000 N/m.

The membrane of style3d: ku/2 (|Fu| − 1)² + kv/2 (|Fv| − 1)² + ks/2 (cos of the angle between Fu and Fv)² per area, so
that C11 = ku, C22 = kv, G = ks. It has no C12. The nearest is then what keeps a thread's pull when the other direction
is free to shrink, Young's modulus times thickness: C11 − C12²/C11 = 8000/3 N/m. Its velocities lose a five-hundredth per
substep, which cannot be turned off.
"""

import sys

import newton
import numpy
import warp
from measure import measure
from newton.solvers import style3d

DENSITY = 0.2  # kg/m²
STRUCTURAL, SHEAR, BEND = 2000.0, 1000.0, 20.0  # N/m
C12, G = 1000.0, 1000.0  # N/m
YOUNG = 8000 / 3  # times thickness, N/m
SOLVERS = {
    "semi_implicit": lambda model, _: newton.solvers.SolverSemiImplicit(model, enable_tri_contact=False),
    "xpbd": lambda model, iterations: newton.solvers.SolverXPBD(model, iterations=iterations),
    "vbd": lambda model, iterations: newton.solvers.SolverVBD(model, iterations=iterations),
    "style3d": lambda model, iterations: newton.solvers.SolverStyle3D(
        model, config=newton.solvers.SolverStyle3D.Config(iterations=iterations)
    ),
}


def make_positions(side):
    row, column = numpy.divmod(numpy.arange(side * side), side)
    return numpy.stack([column, numpy.zeros_like(row), row], axis=-1) / (side - 1)


def make_masses(side):
    """A quarter of the cells around each particle."""
    share = numpy.ones(side)
    share[[0, -1]] = 0.5
    return DENSITY * numpy.outer(share, share).ravel() / (side - 1) ** 2


def add_springs(builder, side):
    zero = [warp.vec3(0.0)] * (side * side)
    builder.add_particles(make_positions(side).tolist(), zero, make_masses(side).tolist())
    kinds = [(1, 0, STRUCTURAL), (0, 1, STRUCTURAL), (1, 1, SHEAR), (2, 0, BEND), (0, 2, BEND)]
    for row in range(side):
        for column in range(side):
            for across, down, stiffness in kinds:
                if column + across < side and row + down < side:
                    here = row * side + column
                    builder.add_spring(here, here + down * side + across, stiffness, 0.0, control=0.0)
    # `color` knows no springs. None of theirs joins two particles with the same column + row modulo 3.
    row, column = numpy.divmod(numpy.arange(side * side), side)
    builder.set_coloring([numpy.flatnonzero((row + column) % 3 == color) for color in range(3)])


def make_triangles(side):
    """Two to a cell, along alternating diagonals."""
    triangles = []
    for row in range(side - 1):
        for column in range(side - 1):
            a = row * side + column
            b, c, d = a + 1, a + side, a + side + 1
            triangles += [a, d, c, a, b, d] if (row + column) % 2 == 0 else [a, b, c, b, d, c]
    return triangles


def add_membrane(builder, side, solver):
    """Given in x and y, and laid flat."""
    lay = warp.quat_from_axis_angle(warp.vec3(1.0, 0.0, 0.0), 0.5 * warp.pi)
    place = {"pos": warp.vec3(0.0), "rot": lay, "vel": warp.vec3(0.0), "scale": 1.0, "density": DENSITY}
    vertices = [warp.vec3(x, z, 0.0) for x, _, z in make_positions(side)]
    mesh = {"vertices": vertices, "indices": make_triangles(side)}
    if solver == "style3d":
        stiffness = {"tri_aniso_ke": warp.vec3(YOUNG, YOUNG, G), "edge_aniso_ke": warp.vec3(0.0)}
        style3d.add_cloth_mesh(builder, **place, **mesh, **stiffness)
    else:
        stiffness = {"tri_ke": G, "tri_ka": C12, "tri_kd": 0.0, "edge_ke": 0.0, "edge_kd": 0.0}
        builder.add_cloth_mesh(**place, **mesh, **stiffness, tri_drag=0.0, tri_lift=0.0)
        builder.color()
    builder.particle_mass = make_masses(side).tolist()


def build_model(side, cloth, solver):
    builder = newton.ModelBuilder(up_axis=newton.Axis.Y, gravity=(0.0, -9.81, 0.0))
    newton.solvers.SolverStyle3D.register_custom_attributes(builder)
    if cloth == "springs":
        add_springs(builder, side)
    else:
        add_membrane(builder, side, solver)
    builder.particle_radius = [0.0] * (side * side)  # no particle touches another
    for pin in (0, side - 1):
        builder.particle_flags[pin] &= ~newton.ParticleFlags.ACTIVE
        builder.particle_mass[pin] = 0.0
    return builder.finalize()


class Sheet:
    def __init__(self, model, solver, iterations, substeps):
        self.solver = SOLVERS[solver](model, iterations)
        self.solver.collision = None  # Style3D would make its own
        self.states = [model.state(), model.state()]
        self.substeps = substeps
        self.graph = None
        # As in Newton's own examples: the launches of a frame are recorded once. Style3D asks for numbers in between,
        # which cannot be, nor can the two states end the other way round.
        if solver != "style3d" and substeps % 2 == 0:
            with warp.ScopedCapture() as capture:
                self.advance_frame()
            self.graph = capture.graph

    def advance_frame(self):
        if self.graph:
            warp.capture_launch(self.graph)
            return
        for _ in range(self.substeps):
            self.states[0].clear_forces()
            self.solver.step(self.states[0], self.states[1], None, None, 1 / 60 / self.substeps)
            self.states.reverse()

    def positions(self):
        return self.states[0].particle_q.numpy()


def main():
    side, cloth, solver = int(sys.argv[1]), sys.argv[2], sys.argv[3]
    substeps, iterations, frames, file = int(sys.argv[4]), int(sys.argv[5]), int(sys.argv[6]), sys.argv[7]
    warp.config.log_level = warp.LOG_WARNING
    warp.set_device("cpu")
    model = build_model(side, cloth, solver)
    Sheet(model, solver, iterations, substeps).advance_frame()  # compiles what it launches
    measure("Newton " + newton.__version__, lambda: Sheet(model, solver, iterations, substeps), frames, file)


main()
