#pragma once
/// Files and names as something to show in the window.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "view_command.h"
#include "view_side.h"
#include "weft/fabric.h"

namespace weft::engine::app {

struct Opened {
  std::vector<std::unique_ptr<ViewSide>> sides;  // one or two; empty: a fabric
  std::optional<SceneDesc> scene;                // of simulations
  std::vector<std::string> compared;             // (sides) integrators or fabrics, if there are two
  std::filesystem::path file;                    // of the scene, the run or the fabric
  std::optional<FabricPreset> fabric;            // of a fabric file, for the scene that is shown
};

/// A scene or the name of a shipped one, a run or its .glb, a fabric file; a mesh becomes cloth above a floor.
/// Throws InputError with the mistakes of the file.
Opened open_view(const ViewRequest& request);

bool is_integrator(const std::string& name);

/// Gives a scene what is compared: the integrator of this name, or the fabric on all cloths. Throws InputError for
/// other names.
void take_variant(const std::string& name, SceneDesc& scene);

/// The simulations of a scene: one, or one for each name to compare.
std::vector<std::unique_ptr<ViewSide>> make_sides(const ViewRequest& request, SceneDesc scene);

}  // namespace weft::engine::app
