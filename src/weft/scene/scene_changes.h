#pragma once
/// Changes of a scene's numbers in a world that runs.

#include <string>
#include <vector>

#include "weft/scene/scene_desc.h"
#include "weft/world.h"

namespace weft::engine {

/// The part of `wanted` that a world of `now` can take between two steps: gravity, wind, solver, contact,
/// fabrics, pressures, colliders, friction, and pins that hold particles still. The rest is that of `now`.
SceneDesc changeable_part(const SceneDesc& now, const SceneDesc& wanted);

/// Keys that differ, whose values need a new world: "cloth[0].grid". Empty: changeable_part() is `wanted`.
std::vector<std::string> find_keys_for_restart(const SceneDesc& now, const SceneDesc& wanted);

/// Whether bodies come or go, or take another shape: snapshots of the world are then of no use any more.
bool changes_bodies(const SceneDesc& now, const SceneDesc& wanted);

/// Makes a world of `now` one of changeable_part(now, wanted). A collider that is only displaced moves there
/// during the next step, and pushes cloth. New pins hold particles where they are. Throws InputError for
/// invalid numbers; the world is then as before.
void apply_changes(const SceneDesc& now, const SceneDesc& wanted, weft::World& world);

inline constexpr double kMaxGlideSpeed = 4;  // of glide_colliders() [m/s]

/// Moves displaced colliders towards the places of the scene in the next step, as a hand does: by a lag of 70 ms,
/// with at most kMaxGlideSpeed and a turn per second. It replaces the single step of apply_changes(). Call it before
/// every step of length `dt` [s].
void glide_colliders(const SceneDesc& scene, double dt, weft::World& world);

}  // namespace weft::engine
