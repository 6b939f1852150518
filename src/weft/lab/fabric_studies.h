#pragma once
/// What one fabric is on many meshes, at many steps: the studies of the group "fabric".

#include "weft/lab/study.h"

namespace weft::engine {

/// c11, c22, c12 and g of five fabrics, as tensile and shear tests on a grid and on a random mesh give them
/// back.
StudyResult study_fabric_constants(const StudySettings& settings);

/// H/W of cantilevers, over how finely they are meshed, against the elastica.
StudyResult study_fabric_cantilever(const StudySettings& settings);

/// The drape coefficient of denim over the rings of the disc's mesh; that of all presets at one resolution.
StudyResult study_fabric_drape(const StudySettings& settings);

/// Drape, sag and time of swing of one fabric on grids of 33², 65² and 129² particles and on random meshes.
StudyResult study_fabric_meshes(const StudySettings& settings);

/// The largest principal stretch of two fabrics with a strain limit of 1 %, while a sheet swings from two
/// corners, over its resolution.
StudyResult study_fabric_strain_limit(const StudySettings& settings);

/// The shape at rest at 60, 120 and 240 steps per second, and how fast a swing dies away.
StudyResult study_fabric_steps(const StudySettings& settings);

}  // namespace weft::engine
