#include "weft/scene/parameter_texts.h"

namespace weft::engine {
namespace {

// Sentences of at most 25 words: the meaning first, then typical values, then the effect of larger values.
// Each exists only here; the tests search pages and sources for a second copy.
constexpr ParameterText kTexts[] = {
    {"scene", "", "Format, gravity and times of the scene."},
    {"cloth", "", "The cloths, each with its shape, fabric and pins."},
    {"collider", "", "The solid bodies that cloth collides with."},
    {"contact", "", "Settings of pairs of bodies, instead of the settings of each body."},
    {"wind", "", "Motion of the air. Without this table there is neither wind nor air drag."},
    {"solver", "", "Integrator, length of the steps and contact handling."},

    {"scene.format", "", "Version of the file format."},
    {"scene.description", "", "The scene in one line, for lists and reports."},
    {"scene.gravity", "",
     "Acceleration of free fall. Larger: cloth falls faster and stretches more under its weight."},
    {"scene.fps", "",
     "Frames per second of the result. Higher: shorter steps, which are more accurate and take longer in "
     "total."},
    {"scene.duration", "", "Simulated time after frame 0."},
    {"scene.settle", "",
     "Time simulated before frame 0, while colliders stand still; cloth is at rest afterwards. Longer: less "
     "motion is left from the start."},

    {"cloth.name", "",
     "Name of the cloth in reports and contact settings. A further cloth without one is \"cloth 2\"."},
    {"cloth.fabric", "",
     "The material: the name of a fabric, a fabric file, SI values, or stiffnesses of springs."},
    {"cloth.membrane", "",
     "Discretisation of a fabric's stretching and shearing: elements on triangles, or fitted springs. "
     "Springs "
     "are cheaper and less accurate."},
    {"cloth.warp", "",
     "Warp direction of a fabric in the cloth's coordinates before its rotation. Default: a grid's first "
     "axis, or "
     "the texture coordinate u of a mesh."},
    {"cloth.position", "", "Displacement of the cloth at the start, after its rotation."},
    {"cloth.rotation", "", "Rotation of the cloth at the start: angles about fixed x, then y, then z."},
    {"cloth.velocity", "", "Velocity of all particles at the start."},
    {"cloth.pressure", "",
     "What the gas inside presses more than the air outside. Requires cloth without a border, and newton, "
     "implicit_euler or xpbd. Higher: rounder and stiffer. A cushion has 100 to 1000 Pa, a toy balloon "
     "2000."},
    {"cloth.sealed", "",
     "Whether the gas keeps its amount: `pressure` is then that at the start, and falls as the volume grows. "
     "Not "
     "given: the pressure is kept."},
    {"cloth.color", "", "Linear red, green and blue of the cloth in pictures and files."},
    {"cloth.pins", "",
     "Particles that are held still, as in [\"corner:0,0\", \"index:12\", \"group:waist\"]. Only grids have "
     "corners, only meshes groups."},
    {"cloth.pin", "", "Regions of particles that are held still or moved along key frames."},
    {"cloth.stiffen", "", "Regions of stiffer or softer springs. Factors multiply where regions overlap."},
    {"cloth.rest_scale", "",
     "Regions of a fabric that are shorter or longer at rest: elastic, gathers. Overlapping ones multiply."},
    {"cloth.layer", "",
     "Order of garments over each other at the start. Where solver.untangle is on, a higher one is moved "
     "outside of lower ones, away from the body. Equal: no order."},
    {"cloth.seam", "",
     "Seams of panels: stretches of border that draw together, and hold. Not on grids of springs."},
    {"cloth.seam_time", "", "Time in which the seams close. Longer: gentler."},
    {"cloth.seam_stiffness", "",
     "Tension of the seams per opening. Default: that of the cloth's edges beside them. Higher: less open "
     "where it is "
     "pulled."},
    {"cloth.grid", "grid", "A rectangle of square or rectangular cells, horizontal before its rotation."},
    {"cloth.model", "grid",
     "Springs of a grid: two shear springs per cell, one, or one of alternating direction. A fabric's "
     "default "
     "is \"alternating\"."},
    {"cloth.mesh", "mesh",
     "OBJ, PLY or STL file of the cloth: its shape at the start, and at rest without `rest`."},
    {"cloth.up", "mesh", "Axis of the file of the cloth that points upwards."},
    {"cloth.scale", "mesh",
     "Length of the unit of the cloth's file. Larger: a larger garment; 0.01 for a file in cm."},
    {"cloth.weld", "mesh",
     "Merging of coincident vertices, or of vertices within a distance. Larger: closes wider gaps and "
     "removes "
     "finer detail."},
    {"cloth.sew", "mesh",
     "Distance within which borders of pieces are joined, on vertices or between them. Larger: wider seams "
     "are "
     "closed; layers stay apart."},

    {"cloth.stitches", "mesh",
     "Whether the lines of the file, l of an OBJ file, draw together like seams: the sewing of Blender."},
    {"cloth.rest", "mesh",
     "Rest shape, where it is not the mesh: \"uv\", the pattern in its texture coordinates, with the area of "
     "the mesh; or a table."},
    {"cloth.rest.uv_scale", "", "Length of a unit of the texture coordinates. Larger: a larger pattern."},
    {"cloth.rest.mesh", "", "File with the same faces, whose triangles are those at rest."},
    {"cloth.rest.up", "", "Axis of that file that points upwards."},
    {"cloth.rest.scale", "", "Length of that file's unit."},

    {"cloth.grid.size", "", "Lengths of the two sides of the grid."},
    {"cloth.grid.cells", "",
     "Cells along the two sides of the grid. More: finer folds, and a cost that grows faster than their "
     "number."},

    {"cloth.fabric.base", "fabric",
     "Fabric whose values replace those that are not given: a name or a file. Without it: cotton_shirting."},
    {"cloth.fabric.name", "fabric", "Name of the fabric in messages."},
    {"cloth.fabric.density", "fabric",
     "Mass per area of the fabric. Typical: 0.03 (chiffon) to 0.5 (coating). Higher: hangs straighter and "
     "moves "
     "less in wind."},
    {"cloth.fabric.c11", "fabric",
     "Stretching stiffness along warp. Typical: 25 (jumper) to 10000 (canvas). Higher: sags and stretches "
     "less."},
    {"cloth.fabric.c22", "fabric",
     "Stretching stiffness along weft. Typical values as along warp. Higher: stretches less across warp."},
    {"cloth.fabric.c12", "fabric",
     "Coupling of warp and weft; 0 for most woven fabric. Higher: narrows more when pulled. Its square is "
     "below "
     "c11 times c22."},
    {"cloth.fabric.g", "fabric",
     "Shearing stiffness. Typical: 14 (silk) to 120 (denim), 700 (leather). Higher: resists skewing, and "
     "drapes "
     "in fewer, stiffer folds."},
    {"cloth.fabric.bend_warp", "fabric",
     "Bending rigidity along warp. Typical: 1e-6 (silk) to 1e-4 (coating). Higher: larger and fewer folds."},
    {"cloth.fabric.bend_weft", "fabric",
     "Bending rigidity along weft. Typical values as along warp. Higher: larger folds across weft."},
    {"cloth.fabric.bend_bias", "fabric",
     "Bending rigidity at 45° to warp, at least (√bend_warp − √bend_weft)²/4. Higher: larger diagonal "
     "folds."},
    {"cloth.fabric.bend_hysteresis_warp", "fabric",
     "Hysteresis of bending along warp by friction between threads, 2HB of KES-F. Typical: 1e-4 (silk) to "
     "5e-3 "
     "(coating); 0: none. Higher: fewer folds, which stay."},
    {"cloth.fabric.bend_hysteresis_weft", "fabric",
     "Hysteresis of bending along weft. Typical values as along warp. Higher: folds across weft stay."},
    {"cloth.fabric.bend_set", "fabric",
     "Curvature of threads beyond which bending stays, as in creases. Typical: 500 to 2000; 0: none. Lower: "
     "creases "
     "sooner."},
    {"cloth.fabric.damping", "fabric",
     "Time constant of internal damping, in stretching, shearing and bending. Typical: 0.001 to 0.03. "
     "Higher: "
     "small, quick wrinkles decay sooner."},
    {"cloth.fabric.thickness", "fabric",
     "Minimum distance between two layers of the fabric. Typical: 0.0001 to 0.002. Higher: thicker stacks, "
     "earlier contact."},
    {"cloth.fabric.friction", "fabric",
     "Coulomb coefficient of the fabric on cloth. Typical: 0.2 (silk) to 0.6 (wool). Higher: slides later."},
    {"cloth.fabric.strain_limit", "fabric",
     "Greatest strain in any direction; 0: no limit, 0.01: 1 %. Higher: more rubbery, and less work for the "
     "solver."},
    {"cloth.fabric.strength", "fabric",
     "Tension at which the fabric tears. Typical: 3000 (chiffon) to 40000 (denim), less for an effect; 0: "
     "never. "
     "Higher: tears later."},
    {"cloth.fabric.stretch_warp", "fabric",
     "Measured curve along warp, instead of c11: points of strain [1] and tension [N/m], both rising."},
    {"cloth.fabric.stretch_weft", "fabric",
     "Measured curve along weft, instead of c22, of the same form. At most 8 points each."},
    {"cloth.fabric.spring_structural", "springs",
     "Stiffness of the springs along the edges of the mesh. Higher: stretches less, and needs more work."},
    {"cloth.fabric.spring_shear", "springs",
     "Stiffness of the diagonal springs of a grid's cells. Higher: skews less. Not used on meshes."},
    {"cloth.fabric.spring_bend", "springs",
     "Stiffness of the springs that resist bending. Higher: larger and stiffer folds."},
    {"cloth.fabric.density", "springs",
     "Mass per area of a cloth of springs. Higher: heavier, so that it stretches more."},
    {"cloth.fabric.damping", "springs",
     "Damping coefficient of every spring. Higher: vibration decays sooner; explicit integrators need "
     "shorter "
     "steps."},
    {"cloth.fabric.damping_kind", "springs",
     "Damped part of the relative velocity of two ends: all (the paper's), or along the spring. Only the "
     "first "
     "also brakes rotation."},
    {"cloth.fabric.thickness", "springs",
     "Minimum distance between layers, half of it to colliders. Higher: thicker stacks. Not given: at most "
     "half "
     "of a mean edge."},
    {"cloth.fabric.friction", "springs",
     "Coulomb coefficient of a cloth of springs on cloth. Higher: layers stick sooner."},

    {"cloth.pin.select", "",
     "The particles: a corner, index or group as in `pins`, or a table with indices, a group, a box or a "
     "sphere."},
    {"cloth.pin.motion", "",
     "Key frames of the pinned particles: displacement from the start, linear between keys."},
    {"cloth.pin.pivot", "", "Centre of the rotation of the pins' motion, in the world."},
    {"cloth.pin.group", "", "Short for `select = { group = … }`."},
    {"cloth.pin.follow", "",
     "Name of a collider that the particles follow, as if glued to its surface where they are at the start. "
     "A "
     "waistband stays on a walking body."},
    {"cloth.pin.stiffness", "",
     "Stiffness of a spring per particle that holds it. Not given: held exactly. Higher: it follows more "
     "closely."},
    {"cloth.pin.damping", "",
     "Damping coefficient of that spring, on the particle's own velocity. Higher: it lags more."},
    {"cloth.pin.select.index", "",
     "Indices of particles: on a grid j (cells_x + 1) + i, on a mesh the file's vertices from 0."},
    {"cloth.pin.select.group", "",
     "Name of a group (`g`) or an object (`o`) of the mesh's OBJ file: all vertices of its faces."},
    {"cloth.pin.select.box", "", "All particles in a box of the world at the start."},
    {"cloth.pin.select.sphere", "", "All particles in a sphere of the world at the start."},
    {"cloth.pin.select.box.min", "", "Corner of the box with the smallest coordinates."},
    {"cloth.pin.select.box.max", "", "Corner of the box with the largest coordinates."},
    {"cloth.pin.select.sphere.center", "", "Centre of the sphere of pinned particles."},
    {"cloth.pin.select.sphere.radius", "", "Radius of the sphere of pinned particles. Larger: more of them."},
    {"cloth.pin.motion.time", "", "Time of the pins' key frame, later than that of the key before."},
    {"cloth.pin.motion.position", "", "Displacement of the pins from the start."},
    {"cloth.pin.motion.rotation", "",
     "Rotation of the pins about `pivot`: angles about fixed x, then y, then z."},
    {"cloth.stiffen.select", "",
     "Region of the springs, as for pins. It has the springs with both ends inside."},
    {"cloth.stiffen.factor", "",
     "Multiplier of the stiffness of these springs. Above 1: stiffer, as in seams."},
    {"cloth.rest_scale.select", "",
     "Region of the cloth, as for pins. Triangles have the mean factor of their corners."},
    {"cloth.rest_scale.warp", "", "Factor of lengths along warp at rest. Below 1: shorter."},
    {"cloth.rest_scale.weft", "", "Factor of lengths along weft at rest. Elastic of a waist: 0.7."},
    {"cloth.seam.a", "",
     "Vertices on a border, in order, two or more; from each to the next the shorter way along the border."},
    {"cloth.seam.b", "",
     "The same of the border it is sewn to: first to first, last to last, evenly between."},

    {"collider.shape", "", "Shape of the body. Its other keys depend on it."},
    {"collider.name", "",
     "Name of the body in reports and contact settings. A further one is \"collider 2\"."},
    {"collider.friction", "", "Coulomb coefficient of cloth on this body. Higher: cloth slides off later."},
    {"collider.static_friction", "",
     "Coulomb coefficient while cloth on this body sticks, at least `friction`; not given: the same. Higher: "
     "it "
     "starts to slide later."},
    {"collider.motion", "", "Key frames of the body: displacement from the start, linear between keys."},
    {"collider.center", "sphere", "Centre of the sphere, the point about which it rotates."},
    {"collider.radius", "sphere", "Radius of the sphere. Larger: a larger and flatter body."},
    {"collider.point", "plane", "A point of the plane."},
    {"collider.normal", "plane", "Direction out of the solid half space; any length."},
    {"collider.a", "capsule", "First end of the capsule's axis."},
    {"collider.b", "capsule", "Second end of the capsule's axis."},
    {"collider.radius", "capsule", "Distance from the axis to the surface. Larger: a thicker capsule."},
    {"collider.center", "box", "Centre of the box, the point about which it rotates."},
    {"collider.half_size", "box", "Half of the edge lengths, along the box's own axes."},
    {"collider.rotation", "box", "Rotation of the box at the start: angles about fixed x, then y, then z."},
    {"collider.file", "mesh",
     "OBJ, PLY or STL file of a rigid body, closed and facing outwards, or a glTF file (.glb, .gltf), whose "
     "animation moves it. Coincident vertices are merged."},
    {"collider.node", "mesh",
     "Node of a glTF file: its meshes and those below it are the body. Not given: all of the scene."},
    {"collider.clip", "mesh", "Animation of a glTF file that moves the body. Not given: the first one."},
    {"collider.start_time", "mesh",
     "Time of the clip at time 0 of the scene. Not given: its first key. Before and after its keys the body "
     "stands still."},
    {"collider.up", "mesh", "Axis of the file of the body that points upwards."},
    {"collider.scale", "mesh", "Length of the unit of the body's file. Larger: a larger body."},
    {"collider.frame_rate", "mesh", "Frames per second of a deforming body. Higher: it moves faster."},
    {"collider.frames", "mesh",
     "OBJ, PLY or STL files of a deforming body, named with one star, in the order of their names. All have "
     "the same faces."},
    {"collider.rest", "mesh",
     "OBJ, PLY or STL file of the pose from which the body moves to its first one during `settle`."},
    {"collider.solid", "mesh",
     "Whether holes of the body are filled, so that it has an inside. Not given: those of shells whose holes "
     "are at most a twentieth of their area."},
    {"collider.position", "mesh", "Displacement of the body at the start, after its rotation."},
    {"collider.rotation", "mesh",
     "Rotation of the mesh at the start about its own origin: angles about fixed x, y, z."},

    {"collider.motion.time", "", "Time of the body's key frame, later than that of the key before."},
    {"collider.motion.position", "", "Displacement of the body from the start."},
    {"collider.motion.rotation", "",
     "Rotation of the body about its own point: angles about fixed x, then y, then z."},

    {"contact.collide", "",
     "Whether the two collide. If false, the checker ignores their intersections too."},
    {"contact.friction", "",
     "Coulomb coefficient of the pair. Not given: the collider's, or the geometric mean of both cloths. "
     "Higher: "
     "they slide later."},
    {"contact.static_friction", "",
     "Coulomb coefficient while the pair sticks, at least its `friction`, which must be given. Higher: they "
     "start "
     "to slide later."},
    {"contact.between", "",
     "Names of the two bodies, one of them a cloth. The same cloth twice: its contact with itself."},

    {"wind.drag", "",
     "Drag per area and relative velocity, the same for every orientation of the cloth. Higher: follows the "
     "wind more closely."},
    {"wind.velocity", "", "Velocity of a steady wind. Higher: pushes harder."},
    {"wind.keys", "", "Key frames of a changing wind, linear between keys and constant outside."},
    {"wind.air", "", "Aerodynamic drag and lift of each triangle. Requires newton or implicit_euler."},
    {"wind.gusts", "", "Random velocity in addition to the wind, smooth in space and time. Requires `air`."},
    {"wind.air.density", "", "Density of the air. Higher: stronger drag and lift."},
    {"wind.air.drag", "", "Drag coefficient of a triangle face-on. Higher: falls and swings slower."},
    {"wind.air.lift", "",
     "Lift coefficient of a slanted triangle, at most the drag coefficient. Higher: glides sideways in "
     "falling "
     "and flutters."},
    {"wind.gusts.strength", "", "Root mean square of the gusts along each axis. Higher: stronger gusts."},
    {"wind.gusts.length", "", "Correlation length of the gusts. Longer: broader gusts."},
    {"wind.gusts.time", "", "Correlation time of the gusts. Longer: slower gusts."},
    {"wind.gusts.seed", "", "Seed of the gusts. Equal seeds give equal gusts."},
    {"wind.keys.time", "", "Time of the wind's key, later than that of the key before."},
    {"wind.keys.velocity", "", "Velocity of the wind at this time."},

    {"solver.integrator", "", "Method of time integration. Fabrics need newton, implicit_euler or xpbd."},
    {"solver.steps_per_frame", "",
     "Equal steps in each frame. More: shorter steps, which are more accurate, at a higher cost."},
    {"solver.adaptive", "",
     "Whether steps in contact with poor results are divided. Default: with newton only; also available with "
     "implicit_euler."},
    {"solver.max_steps_per_frame", "",
     "Limit of that division, in steps per frame. More: slower, and accurate in harder impacts."},
    {"solver.iterations", "",
     "Iterations: conjugate gradients per Newton step of newton, Newton steps of implicit_euler. More: "
     "slower "
     "and more accurate."},
    {"solver.quality", "",
     "Solver budget of newton with automatic iterations: half, one or two times the usual. High: slower and "
     "more "
     "accurate."},
    {"solver.precision", "",
     "Floating-point precision of states. \"double\": slow reference solutions with newton and "
     "implicit_euler."},
    {"solver.tolerance", "",
     "Largest velocity change at which the Newton steps of implicit_euler end. Higher: faster and less "
     "accurate."},
    {"solver.contact", "",
     "Whether cloth collides with colliders, itself and other cloth. Off: cheaper steps."},
    {"solver.untangle", "", "Whether intersections at the start are repaired before the first step."},
    {"solver.crossed_start", "",
     "Response to intersections that remain at the start: an error, or a warning."},
    {"solver.explicit", "", "Settings of the explicit integrator."},
    {"solver.paper", "", "Settings of the integrators of the paper."},
    {"solver.xpbd", "", "Settings of xpbd."},
    {"solver.explicit.substeps", "",
     "Substeps per step of the explicit integrator; 0: as many as stability requires. More: slower and more "
     "stable."},
    {"solver.paper.damping_sign", "",
     "Sign of the damping force. The sign printed in the paper amplifies motion."},
    {"solver.xpbd.substeps", "", "Substeps per step of xpbd. More: slower, and cloth stretches less."},
};

}  // namespace

std::span<const ParameterText> parameter_texts() { return kTexts; }

}  // namespace weft::engine
