#pragma once
/// Weft: cloth that moves right, on ordinary hardware. Open this first.
///
/// A World holds cloths, colliders, pins and wind, and steps them through time. Everything is in SI units
/// (metres, kilograms, seconds, newtons, and stiffness of springs in N/m); the world is right-handed with Y
/// up. The same calls give the same bits on every machine. A square metre of cloth, hung by two corners and
/// let go:
///
///     #include <iostream>
///     #include "weft/weft.h"
///
///     int main() {
///       weft::World world;
///       const weft::Grid grid{.size_x = 1, .size_z = 1, .cells_x = 32, .cells_z = 32};
///       const weft::ClothId cloth = world.add_cloth(
///           {.topology = weft::build_grid_topology(grid, weft::SpringModel::alternating)});
///       world.set_pins(cloth, {{.particles = {grid.index(0, 0), grid.index(32, 0)}}});
///       for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60);
///       std::cout << "lowest point: " << weft::compute_lowest_y(world.state(cloth)) << " m\n";
///     }
///
/// Bad input throws InputError; numerical trouble is told by the StepReport that step() returns. The library
/// never prints and never aborts.

// In reading order. Shapes and meshes:
#include "weft/core/error.h"
#include "weft/core/shapes.h"
#include "weft/core/vec.h"
#include "weft/mesh/clean.h"
#include "weft/mesh/grid.h"
#include "weft/mesh/solid.h"
#include "weft/mesh/triangle_mesh.h"
// What cloth is made of:
#include "weft/fabric/fabric.h"
#include "weft/fabric/laboratory.h"
#include "weft/fabric/presets.h"
// What a cloth is, and what of it moves:
#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"
#include "weft/model/fabric_springs.h"
#include "weft/model/springs.h"
// What acts on it:
#include "weft/animation/rigid_motion.h"
#include "weft/contact/collider.h"
#include "weft/forces/wind.h"
// How it moves:
#include "weft/integrators/integrator.h"
#include "weft/world/energy_audit.h"
#include "weft/world/measures.h"
#include "weft/world/world.h"
