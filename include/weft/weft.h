#pragma once
/// Weft: accurate cloth simulation on ordinary hardware. Start reading here.
///
/// A World contains cloths, colliders, pins and wind, and steps them through time. Everything is in SI units
/// (metres, kilograms, seconds, newtons); the world is right-handed with y up. The same calls give the same
/// bits on every machine. A square metre of denim, hung by two corners and released:
///
///     #include <iostream>
///     #include "weft/weft.h"
///
///     int main() {
///       weft::World world;
///       const weft::Grid grid{.size_x = 1, .size_z = 1, .cells_x = 32, .cells_z = 32};
///       const weft::ClothId cloth = world.add_cloth({.shape = grid, .fabric = weft::find_fabric("denim")});
///       world.set_pins(cloth, {{.particles = {grid.index(0, 0), grid.index(32, 0)}}});
///       for (int frame = 0; frame < 60; ++frame) world.step(1.0 / 60);
///       std::cout << "center of mass: " << world.center_of_mass(cloth).y << " m\n";
///     }
///
/// Bad input throws InputError; StepReport reports numerical failures. The library never prints and never
/// aborts.

// In reading order. Numbers, shapes, materials:
#include "weft/error.h"
#include "weft/fabric.h"
#include "weft/laboratory.h"
#include "weft/mesh.h"
#include "weft/vec.h"
// Contents of a world:
#include "weft/cloth.h"
#include "weft/collider.h"
#include "weft/ids.h"
#include "weft/wind.h"
// Steps and their results:
#include "weft/jobs.h"
#include "weft/report.h"
#include "weft/solver.h"
#include "weft/world.h"
// Many worlds:
#include "weft/batch.h"
#include "weft/version.h"
