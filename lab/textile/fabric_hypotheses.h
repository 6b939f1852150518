#pragma once
/// Tests of one fabric on several meshes and with several step lengths.

#include "lab/report/sections.h"

namespace weft::engine::lab {

/// c11, c22, c12 and g of five fabrics, measured by tensile and shear tests on a grid and a random mesh.
Findings fabric_constants(const SectionOptions& options);

/// H/W of cantilevers without hysteresis against mesh resolution, compared with the elastica.
Findings fabric_cantilever(const SectionOptions& options);

/// The drape coefficient of denim without hysteresis against the number of rings of the disc's mesh.
Findings fabric_drape(const SectionOptions& options);

/// Drape coefficient and folds of every preset.
Findings fabric_drapes(const SectionOptions& options);

/// The drape of a soft, stiffly woven fabric against the mesh, the stiffness of its threads and their direction:
/// membranes that lock hold it up.
Findings fabric_locking(const SectionOptions& options);

/// Drape, sag and period of one fabric on grids of 33², 65² and 129² particles and on random meshes.
Findings fabric_meshes(const SectionOptions& options);

/// Maximum principal stretch of two fabrics with a strain limit of 1 %, for a sheet that swings from two
/// corners, against resolution.
Findings fabric_strain_limit(const SectionOptions& options);

/// Sag and period of one fabric at 60, 120 and 240 steps per second.
Findings fabric_steps(const SectionOptions& options);

}  // namespace weft::engine::lab
