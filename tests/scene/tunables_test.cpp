#include "weft/scene/tunables.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "tests/own_folder.h"
#include "weft/scene/scene_library.h"
#include "weft/scene/scene_reader.h"
#include "weft/scene/scene_writer.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

/// Another valid value.
struct Turn {
  const Parameter& parameter;
  void operator()(double* v) const {
    *v = *v == 0 ? 0.01 : *v * 1.03;
    if (parameter.max && *v > *parameter.max) *v = *parameter.max;
  }
  void operator()(int* v) const { *v = *v + 1; }
  void operator()(bool* v) const { *v = !*v; }
  void operator()(Vec3* v) const { *v = 1.03 * *v + Vec3(0.01, 0.02, 0.03); }
  void operator()(NewtonQuality* v) const { *v = NewtonQuality::high; }
};

/// Files by one name each.
SceneDesc canonical(SceneDesc scene) {
  for (ClothSceneDesc& cloth : scene.cloths) {
    if (MeshSource* mesh = std::get_if<MeshSource>(&cloth.shape)) mesh->file = fs::canonical(mesh->file);
  }
  for (ColliderSceneDesc& collider : scene.colliders) {
    if (PlacedMesh* mesh = std::get_if<PlacedMesh>(&collider.shape))
      mesh->source.file = fs::canonical(mesh->source.file);
  }
  return scene;
}

SceneDesc shipped(const std::string& name, const Overrides& overrides = {}) {
  return canonical(read_scene(fs::path(WEFT_SOURCE_DIR) / "scenes" / (name + ".toml"), overrides));
}

SceneDesc reread(const SceneDesc& scene) {
  const fs::path file = make_own_folder() / "tuned.toml";
  write_scene(file, scene);
  SceneDesc back = canonical(read_scene(file));
  back.name = scene.name;
  return back;
}

TEST(Tunables, AreInTheTableOfParametersAndEachKeyIsThatOfOverrides) {
  for (const char* name : {"flag", "drape_sphere", "contact/stack", "garment_hung", "paper/fig6_ball"}) {
    SceneDesc scene = shipped(name);
    std::set<std::string> keys;
    for (const TunableGroup& group : list_tunables(scene)) {
      for (const Tunable& t : group.values) {
        EXPECT_FALSE(t.parameter->description.empty()) << t.key;
        EXPECT_TRUE(keys.insert(t.key).second) << t.key;
      }
    }
    EXPECT_GT(keys.size(), 8u) << name;
  }
}

TEST(Tunables, ATunedSceneIsReadBackEqual) {
  for (const char* name :
       {"flag", "drape_sphere", "contact/ball_and_floor", "garment_hung", "paper/fig6_ball"}) {
    SceneDesc scene = shipped(name);
    for (const TunableGroup& group : list_tunables(scene)) {
      for (const Tunable& t : group.values) std::visit(Turn{*t.parameter}, t.value);
    }
    settle_tunables(scene);
    EXPECT_EQ(scene_text_with_hashes(reread(scene)), scene_text_with_hashes(scene)) << name;
    EXPECT_TRUE(reread(scene) == scene) << name;
  }
}

TEST(Tunables, EveryPresetFitsAClothOfFabricAndOfSprings) {
  for (const char* name : {"drape_sphere", "paper/fig6_ball"}) {
    SceneDesc scene = shipped(name, {"solver.integrator=newton"});
    for (const FabricPreset& preset : fabric_presets()) {
      take_fabric(preset, scene.cloths[0]);
      settle_tunables(scene);
      EXPECT_TRUE(reread(scene) == scene) << name << ' ' << preset.name;
      EXPECT_EQ(scene.cloths[0].fabric->name, preset.name);
    }
  }
}

TEST(Tunables, AFabricWithOtherNumbersThanItsPresetSaysSo) {
  SceneDesc scene = shipped("drape_sphere", {"cloth[0].fabric=denim"});
  scene.cloths[0].fabric->numbers.c11 *= 2;
  settle_tunables(scene);
  settle_tunables(scene);
  EXPECT_EQ(scene.cloths[0].fabric->name, "denim (tuned)");
}

TEST(Tunables, SteadyWindOfASceneWithoutWindHasDrag) {
  SceneDesc scene = shipped("drape_sphere");
  set_steady_wind({1, 2, 3}, scene);
  EXPECT_GT(scene.wind.drag, 0);
  EXPECT_TRUE(reread(scene) == scene);
}

}  // namespace
}  // namespace weft::engine
