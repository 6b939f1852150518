#include "weft/scene/unsupported.h"

#include "weft/fabric/bending_rows.h"
#include "weft/integrators/integrator.h"

namespace weft::engine {

std::vector<Unsupported> find_unsupported(const SceneDesc& scene, std::string_view integrator) {
  const IntegratorRow& row = find_integrator(integrator);
  const Support& supports = row.supports;
  std::vector<Unsupported> found;
  const auto add = [&](const std::string& what, bool Support::*by, const std::string& or_else = "",
                       const char* key = "integrator") {
    found.push_back({key, "does not support " + what + "; use " + list_supporting(by, "\"") + or_else});
  };
  if (scene.wind.air.density > 0 && !supports.aerodynamics)
    add("wind.air", &Support::aerodynamics, ", or only wind.drag");
  for (const ClothSceneDesc& cloth : scene.cloths) {
    const std::string name = " of cloth \"" + cloth.name + '"';
    if ((cloth.pressure != 0 || cloth.is_sealed) && !supports.pressure)
      add("the pressure" + name, &Support::pressure);
    if ((!cloth.seams.empty() || cloth.has_stitches) && !supports.seams)
      add("the seams" + name, &Support::seams);
    if (cloth.fabric && has_bending_memory(cloth.fabric->numbers) && supports.elements &&
        !supports.bending_memory)
      add("bend_hysteresis and bend_set" + name, &Support::bending_memory,
          ", or set bend_hysteresis_warp, bend_hysteresis_weft and bend_set to 0");
  }
  for (const ClothSceneDesc& cloth : scene.cloths) {
    if (!cloth.fabric || supports.elements) continue;
    found.push_back(
        {"integrator", "supports springs only, but cloth \"" + cloth.name + "\" is made of a fabric; use " +
                           list_supporting(&Support::elements, "\"") +
                           ", or set spring_structural, spring_shear and spring_bend instead of the fabric"});
    break;
  }
  if (scene.adaptive.value_or(false) && !supports.step_division)
    add("step division", &Support::step_division, "", "adaptive");
  if (scene.solver.is_double && !row.make_in_double)
    found.push_back({"precision", "does not support \"double\"; use " + list_in_double("\"")});
  return found;
}

}  // namespace weft::engine
