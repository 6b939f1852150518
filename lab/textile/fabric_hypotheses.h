#pragma once
/// Tests of one fabric on many meshes and at many steps.

#include "lab/report/sections.h"

namespace weft::engine::lab {

/// c11, c22, c12 and g of five fabrics, as tensile and shear tests on a grid and on a random mesh give them
/// back.
Findings fabric_constants(const SectionOptions& options);

/// H/W of cantilevers, over how finely they are meshed, against the elastica.
Findings fabric_cantilever(const SectionOptions& options);

/// The drape coefficient of denim over the rings of the disc's mesh; that of all presets at one resolution.
Findings fabric_drape(const SectionOptions& options);

/// Drape, sag and time of swing of one fabric on grids of 33², 65² and 129² particles and on random meshes.
Findings fabric_meshes(const SectionOptions& options);

/// The largest principal stretch of two fabrics with a strain limit of 1 %, while a sheet swings from two
/// corners, over its resolution.
Findings fabric_strain_limit(const SectionOptions& options);

/// The shape at rest at 60, 120 and 240 steps per second, and how fast a swing dies away.
Findings fabric_steps(const SectionOptions& options);

}  // namespace weft::engine::lab
