/// The public Scene: valid at all times, changed as by --set, and written so that it reads back equal.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>

#include "tests/own_folder.h"
#include "weft/scene.h"
#include "weft/scene/scene_access.h"

namespace weft {
namespace {

namespace fs = std::filesystem;

const std::string kText = R"([scene]
format = 1
fps = 30
duration = 2

[[cloth]]
name = "sheet"
grid = { size = [1, 1], cells = [4, 4] }
fabric = "silk"
pins = ["corner:0,0"]

[solver]
steps_per_frame = 2
)";

SceneError mistakes_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const SceneError& error) {
    return error;
  }
  ADD_FAILURE() << "no SceneError";
  return SceneError(std::vector<Diagnostic>());
}

TEST(PublicScene, HasTheFilesNumbers) {
  const Scene scene = Scene::parse(kText, "folder/curtain.toml");
  EXPECT_EQ(scene.name(), "curtain");
  EXPECT_EQ(scene.frames_per_second(), 30);
  EXPECT_EQ(scene.steps_per_frame(), 2);
  EXPECT_EQ(scene.num_frames(), 60);
  EXPECT_EQ(scene.step(), 1.0 / 60);
}

TEST(PublicScene, LoadsEveryShippedSceneByItsName) {
  const std::vector<std::string> names = scene_names();
  ASSERT_GE(names.size(), 17u);
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
  for (const std::string& name : names) EXPECT_EQ(Scene::load(name).name(), name);
  EXPECT_THROW(Scene::load("no such scene"), InputError);
}

TEST(PublicScene, SetChangesOneValue) {
  Scene scene = Scene::parse(kText);
  scene.set("scene.duration=3");
  scene.set("cloth[0].fabric=leather");
  scene.set("solver.integrator=xpbd");
  EXPECT_EQ(scene.num_frames(), 90);
  const engine::SceneDesc& desc = SceneAccess::desc(scene);
  EXPECT_EQ(desc.cloths[0].fabric->name, "leather");
  EXPECT_EQ(desc.solver.integrator, "xpbd");
}

TEST(PublicScene, RefusedChangeLeavesTheSceneUnchanged) {
  Scene scene = Scene::parse(kText);
  scene.set("scene.duration=3");
  const std::string before = scene.to_json();
  const engine::SceneDesc desc = SceneAccess::desc(scene);
  for (const char* bad : {"scene.duration=-1", "solver.integratr=xpbd", "cloth[3].fabric=denim", "cloth", ""})
    EXPECT_THROW(scene.set(bad), SceneError) << bad;
  EXPECT_EQ(scene.to_json(), before);
  EXPECT_EQ(SceneAccess::desc(scene), desc);
  scene.set("scene.fps=10");
  EXPECT_EQ(scene.num_frames(), 30) << "refused changes are not part of later ones";
}

TEST(PublicScene, CopiesAndMovedFromScenesStayValid) {
  Scene scene = Scene::parse(kText), copy = scene;
  copy.set("scene.duration=3");
  EXPECT_EQ(scene.num_frames(), 60);
  const Scene taken = std::move(scene);
  EXPECT_EQ(taken.num_frames(), 60);
  EXPECT_EQ(scene.num_frames(), 60);  // NOLINT: the fact under test
}

TEST(PublicScene, MistakesHaveFileLineAndColumn) {
  const std::string bad =
      "[scene]\nformat = 1\nfps = -30\n[[cloth]]\ngrid = { size = [1, 1], cells = [4, 4] }\n"
      "fabric = \"slik\"\n";
  const SceneError error = mistakes_of([&] { Scene::parse(bad, "bad.toml"); });
  ASSERT_EQ(error.diagnostics().size(), 2u) << error.what();
  const Diagnostic &fps = error.diagnostics()[0], &fabric = error.diagnostics()[1];
  EXPECT_EQ(fps.file, "bad.toml");
  EXPECT_EQ(fps.line, 3);
  EXPECT_EQ(fps.column, 7);
  EXPECT_EQ(fabric.line, 6);
  EXPECT_EQ(std::string(error.what()), fps.to_string() + "\n" + fabric.to_string());
  EXPECT_TRUE(fps.to_string().starts_with("bad.toml:3:7: "));

  Scene scene = Scene::parse(kText);
  const SceneError change = mistakes_of([&] { scene.set("solver.integratr=xpbd"); });
  ASSERT_EQ(change.diagnostics().size(), 1u);
  EXPECT_EQ(change.diagnostics()[0].file, "--set solver.integratr");
  EXPECT_EQ(change.diagnostics()[0].line, 0);
}

TEST(PublicScene, JsonHasTheGivenKeysWithTheirChanges) {
  Scene scene = Scene::parse(kText);
  scene.set("cloth[0].fabric=denim");
  scene.set("solver.xpbd.substeps=7");
  const nlohmann::json expected = {{"scene", {{"format", 1}, {"fps", 30}, {"duration", 2}}},
                                   {"cloth",
                                    {{{"name", "sheet"},
                                      {"grid", {{"size", {1, 1}}, {"cells", {4, 4}}}},
                                      {"fabric", "denim"},
                                      {"pins", nlohmann::json::array({"corner:0,0"})}}}},
                                   {"solver", {{"steps_per_frame", 2}, {"xpbd", {{"substeps", 7}}}}}};
  EXPECT_EQ(nlohmann::json::parse(scene.to_json()), expected);
}

TEST(PublicScene, JsonKeepsNumbersTruthValuesAndText) {
  const Scene scene =
      Scene::parse(kText + "adaptive = false\n\n[wind]\ndrag = 0.1\nvelocity = [1, 0.3, -2e-3]\n");
  const nlohmann::json json = nlohmann::json::parse(scene.to_json());
  EXPECT_EQ(json["solver"]["adaptive"], false);
  EXPECT_TRUE(json["wind"]["velocity"][0].is_number_integer());
  EXPECT_EQ(json["wind"]["velocity"][1].get<double>(), 0.3);
  EXPECT_EQ(json["wind"]["velocity"][2].get<double>(), -2e-3);
}

TEST(PublicScene, WrittenSceneReadsBackEqual) {
  const fs::path folder = engine::make_own_folder();
  Scene scene = Scene::parse(kText);
  scene.set("cloth[0].grid.cells=[7, 5]");
  scene.set("scene.description=\"A \\\"sheet\\\"\"");
  const std::string file = (folder / "scene.toml").string();
  scene.write(file);
  EXPECT_EQ(SceneAccess::desc(Scene::load(file)), SceneAccess::desc(scene));
  EXPECT_THROW(scene.write((folder / "missing" / "scene.toml").string()), InputError);
}

TEST(PublicScene, BuildsTheSameWorldAsLoadScene) {
  Scene scene = Scene::load("drape_sphere");
  scene.set("cloth[0].fabric=denim");
  LoadedScene built = build_scene(scene, make_jobs(2)),
              loaded = load_scene("drape_sphere", {"cloth[0].fabric=denim"});
  EXPECT_EQ(built.steps_per_frame, scene.steps_per_frame());
  EXPECT_EQ(built.num_frames, scene.num_frames());
  EXPECT_EQ(built.step(), scene.step());
  for (int step = 0; step < 3; ++step) {
    built.world.step(built.step());
    loaded.world.step(loaded.step());
  }
  EXPECT_EQ(built.world.state_hash(), loaded.world.state_hash());
}

TEST(PublicScene, WarningsOfSettlingAreWarningsOfTheWorld) {
  // A ball goes through a sheet held by its corners before frame 0, in steps that may divide once.
  const Scene scene = Scene::parse(R"([scene]
format = 1
settle = 0.0333333333333333
[[cloth]]
grid = { size = [1, 1], cells = [16, 16] }
fabric = "denim"
position = [-0.5, 0, -0.5]
pins = ["corner:0,0", "corner:1,0", "corner:0,1", "corner:1,1"]
[[collider]]
shape = "sphere"
center = [0, -0.3, 0]
radius = 0.2
motion = [{ time = -0.033 }, { time = 0, position = [0, 0.6, 0] }]
[solver]
max_steps_per_frame = 2
)");
  const std::vector<std::string> warnings = build_scene(scene).warnings;
  EXPECT_TRUE(std::any_of(warnings.begin(), warnings.end(),
                          [](const std::string& w) { return w.starts_with("before the start: "); }));
}

}  // namespace
}  // namespace weft
