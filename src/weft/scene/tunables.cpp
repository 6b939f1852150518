#include "weft/scene/tunables.h"

#include <algorithm>

namespace weft::engine {
namespace {

constexpr double kDrag = 0.25;  // of wind in scenes without wind [N·s/m³]

class Lister {
 public:
  explicit Lister(SceneDesc& scene) : scene_(scene) {}

  std::vector<TunableGroup> list() {
    begin("solver");
    add("solver", "steps_per_frame", &scene_.steps_per_frame);
    add("solver", "max_steps_per_frame", &scene_.max_steps_per_frame);
    add("solver", "contact", &scene_.contact);
    add_integrator();
    for (std::size_t c = 0; c < scene_.cloths.size(); ++c) add_cloth(static_cast<int>(c));
    for (std::size_t k = 0; k < scene_.colliders.size(); ++k) add_collider(k);
    for (std::size_t k = 0; k < scene_.contacts.size(); ++k) add_contact(k);
    begin("surroundings");
    add("scene", "gravity", &scene_.gravity);
    if (scene_.wind.keys.empty()) return std::move(groups_);
    add("wind", "drag", &scene_.wind.drag);
    if (scene_.wind.keys.size() == 1) add("wind", "velocity", &scene_.wind.keys[0].velocity);
    return std::move(groups_);
  }

 private:
  void begin(std::string title, int cloth = -1) { groups_.push_back({std::move(title), cloth, {}}); }

  /// `path`: with indices, unlike the keys of parameters.
  template <class Value>
  void add(const std::string& path, const std::string& name, Value* value, const std::string& form = "") {
    std::string key;
    bool is_index = false;
    for (const char c : path) {
      is_index = (is_index || c == '[') && c != ']';
      if (!is_index && c != ']') key += c;
    }
    groups_.back().values.push_back({path + '.' + name, &find_parameter(key + '.' + name, form), value});
  }

  void add_integrator() {
    IntegratorSettings& s = scene_.solver;
    if (s.integrator == "newton") {
      add("solver", "iterations", &s.newton.iterations);
      if (s.newton.iterations == 0) add("solver", "quality", &s.newton.quality);
    } else if (s.integrator == "implicit_euler") {
      add("solver", "iterations", &s.implicit_euler.iterations);
      add("solver", "tolerance", &s.implicit_euler.tolerance);
    } else if (s.integrator == "xpbd") {
      add("solver.xpbd", "substeps", &s.xpbd.substeps);
    } else if (s.integrator == "explicit") {
      add("solver.explicit", "substeps", &s.explicit_euler.substeps);
    }
  }

  void add_cloth(int c) {
    ClothSceneDesc& cloth = scene_.cloths[c];
    begin("cloth " + cloth.name, c);
    if (cloth.pressure != 0 || cloth.is_sealed)
      add("cloth[" + std::to_string(c) + "]", "pressure", &cloth.pressure);
    const std::string path = "cloth[" + std::to_string(c) + "].fabric";
    if (cloth.fabric) {
      Fabric& f = cloth.fabric->numbers;
      const std::pair<const char*, double*> numbers[] = {{"density", &f.density},
                                                         {"c11", &f.c11},
                                                         {"c22", &f.c22},
                                                         {"c12", &f.c12},
                                                         {"g", &f.g},
                                                         {"bend_warp", &f.bend_warp},
                                                         {"bend_weft", &f.bend_weft},
                                                         {"bend_bias", &f.bend_bias},
                                                         {"bend_hysteresis_warp", &f.bend_hysteresis_warp},
                                                         {"bend_hysteresis_weft", &f.bend_hysteresis_weft},
                                                         {"bend_set", &f.bend_set},
                                                         {"damping", &f.damping},
                                                         {"thickness", &f.thickness},
                                                         {"friction", &f.friction},
                                                         {"strain_limit", &f.strain_limit},
                                                         {"strength", &f.strength}};
      for (const auto& [name, number] : numbers) add(path, name, number, "fabric");
      return;
    }
    ClothMaterial& m = cloth.material;
    const std::pair<const char*, double*> numbers[] = {
        {"density", &m.density},    {"spring_structural", &m.structural},
        {"spring_shear", &m.shear}, {"spring_bend", &m.bend},
        {"damping", &m.damping},    {"friction", &m.friction}};
    for (const auto& [name, number] : numbers) add(path, name, number, "springs");
    if (cloth.has_own_thickness) add(path, "thickness", &m.thickness, "springs");
  }

  void add_collider(std::size_t k) {
    ColliderSceneDesc& collider = scene_.colliders[k];
    begin("collider " + collider.name);
    const std::string path = "collider[" + std::to_string(k) + "]";
    add(path, "friction", &collider.friction);
    if (Sphere* sphere = std::get_if<Sphere>(&collider.shape)) {
      add(path, "center", &sphere->center, "sphere");
      add(path, "radius", &sphere->radius, "sphere");
    } else if (Plane* plane = std::get_if<Plane>(&collider.shape)) {
      add(path, "point", &plane->point, "plane");
    } else if (Capsule* capsule = std::get_if<Capsule>(&collider.shape)) {
      add(path, "a", &capsule->a, "capsule");
      add(path, "b", &capsule->b, "capsule");
      add(path, "radius", &capsule->radius, "capsule");
    } else if (PlacedBox* box = std::get_if<PlacedBox>(&collider.shape)) {
      add(path, "center", &box->center, "box");
      add(path, "half_size", &box->half_size, "box");
      add(path, "rotation", &box->rotation_deg, "box");
    }
  }

  void add_contact(std::size_t k) {
    ContactDesc& contact = scene_.contacts[k];
    begin("contact " + contact.between[0] + ", " + contact.between[1]);
    const std::string path = "contact[" + std::to_string(k) + "]";
    if (contact.friction) add(path, "friction", &*contact.friction);
    add(path, "collide", &contact.collide);
  }

  SceneDesc& scene_;
  std::vector<TunableGroup> groups_;
};

/// Both integrators share the key; with a number, quality has no effect.
void settle_iterations(IntegratorSettings& solver) {
  const int usual = ImplicitEulerSettings().iterations;
  int &newton = solver.newton.iterations, &implicit = solver.implicit_euler.iterations;
  if (solver.integrator == "implicit_euler")
    newton = implicit == usual ? 0 : implicit;
  else
    implicit = newton > 0 ? newton : usual;
  if (newton > 0) solver.newton.quality = NewtonQuality::normal;
}

}  // namespace

std::vector<TunableGroup> list_tunables(SceneDesc& scene) { return Lister(scene).list(); }

void take_fabric(const FabricPreset& preset, ClothSceneDesc& cloth) {
  if (!cloth.fabric) {
    cloth.fabric.emplace();
    if (std::holds_alternative<Grid>(cloth.shape)) cloth.model = SpringModel::alternating;
    cloth.has_own_thickness = true;
    cloth.stiffened.clear();
    cloth.material = {.structural = 0, .shear = 0, .bend = 0};
  }
  cloth.fabric->name = preset.name;
  cloth.fabric->numbers = preset.fabric;
}

void settle_tunables(SceneDesc& scene) {
  settle_iterations(scene.solver);
  for (ClothSceneDesc& cloth : scene.cloths) {
    if (!cloth.fabric) continue;
    const Fabric& f = cloth.fabric->numbers;
    cloth.material.density = f.density;
    cloth.material.thickness = f.thickness;
    cloth.material.friction = f.friction;
    const auto& presets = fabric_presets();
    const auto named = std::find_if(presets.begin(), presets.end(),
                                    [&](const FabricPreset& p) { return p.name == cloth.fabric->name; });
    if (named != presets.end() && !(named->fabric == f)) cloth.fabric->name += " (tuned)";
  }
}

void set_steady_wind(const Vec3& velocity, SceneDesc& scene) {
  scene.wind.keys = {{0, velocity}};
  if (scene.wind.drag == 0 && scene.wind.air.density == 0) scene.wind.drag = kDrag;
}

}  // namespace weft::engine
