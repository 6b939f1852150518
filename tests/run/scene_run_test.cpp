#include "weft/run/scene_run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "tests/own_folder.h"
#include "tests/run/shipped.h"
#include "weft/error.h"
#include "weft/io/obj_reader.h"
#include "weft/run/film.h"
#include "weft/run/recorder.h"
#include "weft/scene/scene_library.h"
#include "weft/scene/scene_world.h"

namespace weft::engine {
namespace {

bool warns(const RunReport& report, const std::string& words) {
  for (const std::string& warning : report.warnings) {
    if (warning.find(words) != std::string::npos) return true;
  }
  return false;
}

/// State hashes after half a second of the paper's scenes: the same bits on every machine, for any
/// number of threads, debug and release. A changed hash means a changed motion of existing scenes: note it in
/// CHANGELOG.md.
const std::map<std::string, std::string> kHashes = {
    {"paper/fig3_horizontal", "3d813bc4f911725d"},
    {"paper/fig4_vertical", "86d15ba11c648be0"},
    {"paper/fig5_falling", "4850df5bbcd652d1"},
    {"paper/fig6_ball", "42e86deee4a73724"},
};

TEST(PaperScenes, HaveTheSameBitsEverywhere) {
  for (const auto& [name, hash] : kHashes) {
    for (const int threads : {1, 2}) {
      const RunReport report = run_scene(shipped(name), {.frames = 30, .threads = threads});
      EXPECT_EQ(report.state_hash, hash) << name << ", " << threads << " threads";
    }
  }
}

TEST(PaperScenes, TwinsHaveTheSameBitsEverywhere) {
  // Smaller and shorter, for debug builds, because only the arithmetic is tested.
  const SceneDesc scene = shipped("paper/fig6_ball_real", {"cloth[0].grid.cells=[15, 15]"});
  for (const int threads : {1, 2}) {
    const RunReport report = run_scene(scene, {.frames = 20, .threads = threads});
    EXPECT_EQ(report.state_hash, "70c87eeb3f85267a") << threads;
  }
}

TEST(PaperScenes, KeepTheStiffnessNumberAtOneOrBelow) {
  for (const auto& [name, hash] : kHashes) {
    const RunReport report = run_scene(shipped(name), {.frames = 1});
    EXPECT_FALSE(warns(report, "too stiff")) << name;
  }
}

/// Checks every frame: no intersections, and no depth of more than 0.1 mm inside a collider.
void expect_clean(const SceneDesc& scene, int frames) {
  const RunReport report = run_scene(scene, {.frames = frames});
  EXPECT_EQ(report.outcome, RunOutcome::done);
  EXPECT_EQ(report.frames, frames);
  EXPECT_EQ(report.intersections, 0) << scene.name;
  EXPECT_EQ(report.passages, 0) << scene.name << ", " << report.first_passage;
  EXPECT_LT(report.penetration_max.value_or(1), 1e-4) << scene.name;
}

TEST(PaperScenes, BallKeepsTheWholeClothOutside) { expect_clean(shipped("paper/fig6_ball"), 180); }

// At their shipped sizes these take minutes: `make scenes`.
TEST(PaperScenes, BallKeepsTheTwinOutside) {
  expect_clean(shipped("paper/fig6_ball_real", {"cloth[0].grid.cells=[31, 31]"}), 60);
}

TEST(ContactScenes, BoxKeepsTheClothOutside) {
  expect_clean(shipped("drape_box", {"cloth[0].grid.cells=[20, 20]"}), 90);
}

TEST(ContactScenes, FoldedClothDoesNotCrossItself) {
  expect_clean(shipped("self_fold", {"cloth[0].grid.cells=[20, 20]"}), 180);
}

TEST(ContactScenes, LayersDoNotCross) {
  expect_clean(shipped("two_layers", {"cloth[0].grid.cells=[16, 16]", "cloth[1].grid.cells=[16, 16]"}), 60);
}

TEST(PaperScenes, FallFreelyForTheFirstSixtyCentimetres) {
  // The tilted sheet falls from its lowest corner with the gravity of Eq. 16: between the factor for a =
  // a_max and the factor 1.
  const SceneDesc scene = shipped("paper/fig5_falling");
  const RunReport report = run_scene(scene, {.frames = 20});
  const std::vector<double>& y = report.lowest_y;
  const double t = 19.0 / 60, fallen = y[0] - y[19];
  EXPECT_GT(fallen, 0.5);
  const double v0 = 9.81 / 60;
  EXPECT_NEAR(fallen, v0 * t + 0.5 * 9.81 * t * t, 0.06 * fallen);
}

TEST(SceneRun, WarnsOfThePapersFrozenClothWithTheEffectiveGravity) {
  const RunReport report =
      run_scene(shipped("paper/fig3_horizontal_real", {"solver.integrator=paper"}), {.frames = 1});
  EXPECT_TRUE(warns(report, "too stiff for the paper's Eq. 16"));
  EXPECT_TRUE(warns(report, "of gravity"));
}

TEST(SceneRun, RecordsTheStartAndEveryFrame) {
  FilmSink film;
  const RunReport report = run_scene(shipped("paper/fig6_ball"), {.frames = 5}, {&film});
  ASSERT_EQ(film.animation().cloths.size(), 1u);
  EXPECT_EQ(film.animation().cloths[0].frames.size(), 6u);
  EXPECT_EQ(film.animation().cloths[0].frames[0].size(), 3u * 33 * 33);
  ASSERT_EQ(film.animation().bodies.size(), 1u);
  EXPECT_EQ(report.lowest_y.size(), 5u);
  EXPECT_EQ(report.kinetic_energy.size(), 5u);
}

/// A body's vertices at a frame, in world coordinates.
std::vector<Vec3> vertices(const AnimatedBody& body, std::size_t frame) {
  const AnimatedBody::Pose& pose = body.poses.at(std::min(frame, body.poses.size() - 1));
  std::vector<Vec3> placed;
  for (const Vec3& p : body.mesh.positions) placed.push_back(pose.rotation * p + pose.translation);
  return placed;
}

TEST(SceneRun, ShowsEveryColliderWhereItIs) {
  const std::filesystem::path folder = make_own_folder();
  write_obj(folder / "body.obj", make_sphere_mesh({0.1, 0, 0}, 0.2, 8));
  const std::string scene = R"([scene]
format = 1
[[cloth]]
grid = { size = [1, 1], cells = [4, 4] }
position = [0, 5, 0]
[[collider]]
shape = "capsule"
a = [0, 1, 0]
b = [1, 2, 0.5]
radius = 0.1
motion = [{ time = 0 }, { time = 0.05, position = [0.3, 0, 0], rotation = [0, 90, 0] }]
[[collider]]
shape = "box"
center = [3, 1, 2]
half_size = [0.1, 0.2, 0.3]
rotation = [10, 20, 30]
[[collider]]
shape = "mesh"
file = "body.obj"
rotation = [0, 0, 90]
position = [2, 0, 0]
motion = [{ time = 0 }, { time = 0.05, rotation = [90, 0, 0] }]
)";
  const SceneDesc desc = parse_scene(scene, folder / "scene.toml");
  const SceneWorld built = build_world(desc, make_serial_jobs());
  FilmSink film;
  run_scene(desc, {.frames = 3}, {&film});
  ASSERT_EQ(film.animation().bodies.size(), 3u);
  for (const int frame : {0, 3}) {
    for (const int b : {0, 1}) {
      const ColliderShape shape = shape_at(built.world.colliders()[b], frame / 60.0);
      for (const Vec3& p : vertices(film.animation().bodies[b], static_cast<std::size_t>(frame))) {
        // Rounding of rotation and translation.
        EXPECT_NEAR(signed_distance(shape, p).distance, 0, 1e-12) << "collider " << b << ", frame " << frame;
      }
    }
  }
  // The mesh's middle, (0.1, 0, 0) in the file, is first rotated to y, then by its motion to z.
  const auto middle = [&](std::size_t frame) {
    Vec3 sum = Vec3::Zero();
    const std::vector<Vec3> placed = vertices(film.animation().bodies[2], frame);
    for (const Vec3& p : placed) sum += p / static_cast<double>(placed.size());
    return sum;
  };
  EXPECT_LT((middle(0) - Vec3(2, 0.1, 0)).norm(), 1e-12);
  EXPECT_LT((middle(3) - Vec3(2, 0, 0.1)).norm(), 1e-12);
  std::filesystem::remove_all(folder);
}

TEST(SceneRun, KeepsWhatWasDoneWhenInterrupted) {
  FilmSink film;
  const RunReport report = run_scene(shipped("paper/fig6_ball"), {.frames = 50}, {&film},
                                     [](const Progress& p) { return p.frame < 7; });
  EXPECT_EQ(report.outcome, RunOutcome::interrupted);
  EXPECT_EQ(report.frames, 7);
  EXPECT_EQ(film.animation().cloths[0].frames.size(), 8u);
}

TEST(SceneRun, TellsWhichClothFailedWhenAndWhatToDo) {
  const RunReport report =
      run_scene(shipped("paper/fig3_horizontal_real",
                        {"solver.integrator=explicit", "solver.explicit.substeps=1", "cloth[0].name=sail"}),
                {.frames = 200});
  EXPECT_EQ(report.outcome, RunOutcome::failed);
  EXPECT_NE(report.failure.find("frame "), std::string::npos);
  EXPECT_NE(report.failure.find("sail"), std::string::npos);
  EXPECT_NE(report.failure.find("substeps"), std::string::npos);
}

TEST(Report, HasThePrincipalStretchesOfMembranesPerFrame) {
  const RunReport report = run_scene(
      shipped("paper/fig3_horizontal_real", {"cloth[0].grid.cells=[8, 8]", "cloth[0].fabric=gray_interlock"}),
      {.frames = 30});
  const nlohmann::json json = nlohmann::json::parse(to_json(report));
  ASSERT_EQ(json["max_stretch"].size(), 30u);
  EXPECT_GT(json["max_stretch"][29], 1.05) << "jersey";
  EXPECT_LT(json["max_stretch"][29], 2);
  EXPECT_LT(json["min_stretch"][29], json["max_stretch"][29]);
  EXPECT_GT(json["min_stretch"][29], 0.2);
}

TEST(Report, HasEveryNameThatOthersRelyOnAndNullForWhatIsNotMeasured) {
  const RunReport report = run_scene(shipped("paper/fig3_horizontal"), {.frames = 3});
  const nlohmann::json json = nlohmann::json::parse(to_json(report));
  for (const char* key : {"scene",
                          "integrator",
                          "particles",
                          "triangles",
                          "springs",
                          "frames",
                          "seconds_simulated",
                          "threads",
                          "version",
                          "ms_per_frame",
                          "cpu_ms_per_frame",
                          "max_strain",
                          "min_strain",
                          "mean_strain",
                          "kinetic_energy",
                          "potential_energy",
                          "lowest_y",
                          "penetration_max",
                          "intersections",
                          "infeasible",
                          "guard_events",
                          "state_hash",
                          "warnings",
                          "work",
                          "passages",
                          "first_passage",
                          "problems",
                          "divisions",
                          "untangle_seconds",
                          "notes"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_GT(json["ms_per_frame"]["median"], 0);
  EXPECT_GE(json["ms_per_frame"]["p95"], json["ms_per_frame"]["median"]);
  EXPECT_TRUE(json["guard_events"].is_null()) << "the paper's integrator has no guard";
  EXPECT_EQ(json["infeasible"], nlohmann::json::array());
  EXPECT_EQ(json["contact_hits"], 0);
  EXPECT_TRUE(json["max_stretch"].is_null()) << "springs have none";
  EXPECT_EQ(json["intersections"], 0);
  EXPECT_EQ(json["passages"], 0);
  EXPECT_TRUE(json["first_passage"].is_null());
  EXPECT_TRUE(json["penetration_max"].is_null()) << "there is no collider in this scene";
  EXPECT_EQ(json["particles"], 33 * 33);
  EXPECT_EQ(json["triangles"], 2 * 32 * 32);
  EXPECT_EQ(json["springs"], 2 * 33 * 32 + 32 * 32 + 2 * 33 * 31);
  EXPECT_NEAR(json["seconds_simulated"], 0.05, 1e-12);
}

TEST(Report, TellsWhereTheTimeOfTheStepsWent) {
  const SceneDesc scene = shipped("paper/fig6_ball_real", {"cloth[0].grid.cells=[15, 15]"});
  double spent = 0;
  const RunReport report = run_scene(scene, {.frames = 30}, {}, [&](const Progress& progress) {
    spent = progress.seconds_spent;
    return true;
  });
  const nlohmann::json work = nlohmann::json::parse(to_json(report))["work"];
  const nlohmann::json& seconds = work["seconds"];
  double kinds = 0;
  for (const auto& [kind, value] : seconds.items()) {
    EXPECT_GE(value, 0) << kind;
    if (kind != "total" && kind != "retries") kinds += value.get<double>();
  }
  EXPECT_NEAR(kinds, report.work.kinds(), 1e-9 * kinds) << "the report has every kind";
  EXPECT_LE(kinds, seconds["total"]);
  EXPECT_LE(seconds["total"], spent);
  EXPECT_GT(seconds["lists"], 0);
  EXPECT_NEAR(work["per_frame"]["looks"].get<double>() * 30, static_cast<double>(report.work.looks), 1e-6);
}

TEST(Report, CountsWhatStillCrossesAndWarnsOfAStartThatDoes) {
  // A second sheet stands upright through the falling one, and both fall with it.
  SceneDesc scene = shipped("paper/fig5_falling", {"cloth[0].name=sheet"});
  scene.colliders.clear();
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].name = "blade";
  scene.cloths[1].rotation_deg.x() += 90;
  scene.cloths[1].position = {-0.5, 2.1, 0};
  scene.untangle = false;
  scene.crossed_start = CrossedStart::allow;
  const RunReport report = run_scene(scene, {.frames = 2});
  ASSERT_TRUE(report.intersections.has_value());
  EXPECT_GT(*report.intersections, 20);
  EXPECT_TRUE(warns(report, "at the start cloth \"sheet\" triangle "));
  EXPECT_TRUE(warns(report, " intersects cloth \"blade\" triangle "));
  EXPECT_FALSE(report.penetration_max.has_value());
}

/// Two ribbons that are pulled through each other: no frame has intersections.
SceneDesc swapped_ribbons(const Overrides& overrides) {
  Overrides all = {"solver.contact=false", "cloth[0].grid.cells=[40, 8]", "cloth[1].grid.cells=[8, 40]"};
  all.insert(all.end(), overrides.begin(), overrides.end());
  return shipped("contact/crossed_strips", all);
}

TEST(Report, CountsWhatPassesThroughWithinAStepThoughNothingCrossesAtAnyFrame) {
  const RunReport report = run_scene(swapped_ribbons({}), {.frames = 30});
  EXPECT_EQ(report.intersections, 0);
  ASSERT_TRUE(report.passages.has_value());
  EXPECT_GT(*report.passages, 100);
  EXPECT_NE(report.first_passage.find("frame "), std::string::npos);
  EXPECT_NE(report.first_passage.find("cloth \"upper ribbon\""), std::string::npos) << report.first_passage;
  const auto tells = [](const RunProblem& p) { return p.code == WarningCode::passages; };
  EXPECT_TRUE(std::any_of(report.problems.begin(), report.problems.end(), tells));
}

TEST(Report, OfPassagesIsNullWhereTheyAreNotChecked) {
  const RunReport report = run_scene(swapped_ribbons({}), {.frames = 2, .check_passages = false});
  EXPECT_FALSE(report.passages.has_value());
  EXPECT_TRUE(nlohmann::json::parse(to_json(report))["passages"].is_null());
}

TEST(Report, CountsPassagesWithinSubstepsAndSteps) {
  // A ball shoots through the sheet and back between two frames.
  SceneDesc scene = shipped("contact/bullet", {"collider[0].radius=0.005", "solver.contact=false",
                                               "solver.steps_per_frame=10", "solver.integrator=xpbd"});
  const double start = 0.5, there = start + 0.4 / scene.fps, back = start + 0.8 / scene.fps;
  scene.colliders.at(0).motion =
      RigidMotion({{.time = start}, {.time = there, .translation = {0, 0, 11.25}}, {.time = back}});
  EXPECT_EQ(*run_scene(scene, {.frames = 29}).passages, 0);
  EXPECT_GE(*run_scene(scene, {.frames = 32}).passages, 2)
      << "there and back: the ball's middle, and the particle in its way";
}

/// Two sheets; the lowest tenth of the second one is below the first one.
SceneDesc crossed_sheets() {
  SceneDesc scene = shipped("two_layers", {"cloth[0].name=sheet", "cloth[0].grid.cells=[16, 16]"});
  scene.colliders.clear();
  scene.cloths.resize(1);
  scene.cloths[0].pins.clear();
  scene.cloths.push_back(scene.cloths[0]);
  scene.cloths[1].name = "blade";
  const double size = std::get<Grid>(scene.cloths[0].shape).size_z;
  scene.cloths[1].rotation_deg = scene.cloths[0].rotation_deg + Vec3(90, 0, 0);
  scene.cloths[1].position += Vec3(0.013, 0.9 * size, 0.5 * size);
  return scene;
}

TEST(Report, OfAStartThatIsUntangledHasNoCrossings) {
  SceneDesc scene = crossed_sheets();
  const RunReport report = run_scene(scene, {.frames = 20});
  EXPECT_EQ(report.intersections, 0);
  EXPECT_TRUE(warns(report, "moved apart in "));
  EXPECT_TRUE(warns(report, "cloth \"blade\""));
}

TEST(Report, OfACrossedStartThatIsRefusedNamesClothsTrianglesAndCounts) {
  SceneDesc scene = crossed_sheets();
  scene.untangle = false;
  try {
    run_scene(scene, {.frames = 1});
    FAIL();
  } catch (const InputError& error) {
    const std::string message = error.what();
    EXPECT_NE(message.find("cloth \"sheet\" triangle "), std::string::npos) << message;
    EXPECT_NE(message.find(" intersects cloth \"blade\" triangle "), std::string::npos) << message;
    EXPECT_NE(message.find(" intersecting pairs"), std::string::npos) << message;
    EXPECT_NE(message.find("solver.untangle = false"), std::string::npos) << message;
    EXPECT_NE(message.find("solver.crossed_start = \"allow\""), std::string::npos) << message;
  }
}

TEST(Report, OfAPoleThroughAHeldSheetThatNothingCanSetApartIsRefused) {
  SceneDesc scene = shipped("paper/fig6_ball", {"cloth[0].grid.cells=[8, 8]"});
  scene.colliders[0].shape = Capsule{{0, -100, 0}, {0, 100, 0}, 0.1};  // its ends are out of reach
  scene.cloths[0].pins.push_back({.select = Sphere{.center = {0, 0, 0}, .radius = 9}});
  EXPECT_THROW(run_scene(scene, {.frames = 1}), InputError);
}

TEST(Report, OfACrossedStartThatIsAllowedWarns) {
  SceneDesc scene = crossed_sheets();
  scene.untangle = false;
  scene.crossed_start = CrossedStart::allow;
  const RunReport report = run_scene(scene, {.frames = 1});
  EXPECT_EQ(report.outcome, RunOutcome::done);
  EXPECT_TRUE(warns(report, " intersecting pairs"));
}

TEST(Report, MeasuresHowDeepTrianglesAreAndWarnsOfAStartInsideACollider) {
  // The particles are outside of a ball that pokes through the one triangle between them.
  const SceneDesc scene = shipped(
      "paper/fig6_ball", {"cloth[0].grid.cells=[1, 1]", "cloth[0].position=[-0.5, 0.6, -0.5]",
                          "scene.gravity=[0, 0, 0]", "solver.steps_per_frame=1", "solver.contact=false"});
  const RunReport report = run_scene(scene, {.frames = 1});
  ASSERT_TRUE(report.penetration_max.has_value());
  EXPECT_NEAR(*report.penetration_max, 0.1, 1e-6) << "the ball's top is at 0.7 m";
  EXPECT_TRUE(warns(report, "at the start cloth \"cloth\" triangle "));
  EXPECT_TRUE(warns(report, "in collider \"ball\" is 100 mm deep"));
}

TEST(Report, EnergyOfFallingClothIsThatOfItsWeight) {
  const RunReport report =
      run_scene(shipped("paper/fig5_falling", {"solver.integrator=explicit"}), {.frames = 20});
  const auto& k = report.kinetic_energy;
  const auto& p = report.potential_energy;
  EXPECT_NEAR(k[19] + p[19], k[0] + p[0], 2e-3 * p[0]) << "nothing but gravity works on it";
  const double v = 9.81 / 3;  // after a third of a second
  EXPECT_NEAR(k[19], 0.5 * 0.2 * v * v, 1e-3);
}

TEST(Report, QuantilesAreNearestRanks) {
  EXPECT_EQ(quantile({}, 0.5), 0);
  EXPECT_EQ(quantile({3}, 0.95), 3);
  EXPECT_EQ(quantile({4, 1, 3, 2}, 0.5), 2);
  EXPECT_EQ(quantile({4, 1, 3, 2}, 0.95), 4);
}

TEST(Report, HasTheEnergiesOfEveryFrameAndTheirSumIsTheTwoItAlwaysHad) {
  const RunReport report =
      run_scene(shipped("paper/fig6_ball_real", {"cloth[0].grid.cells=[15, 15]"}), {.frames = 40});
  const EnergySeries& e = report.energy;
  ASSERT_EQ(e.bending.size(), 40u);
  for (int f = 0; f < 40; ++f) {
    EXPECT_EQ(e.kinetic[f], report.kinetic_energy[f]);
    const double potential = report.potential_energy[f];
    EXPECT_NEAR(e.elastic[f] + e.bending[f] + e.gravitational[f], potential, 1e-12 * std::abs(potential));
  }
  EXPECT_GT(e.bending[39], 0);
  const nlohmann::json json = nlohmann::json::parse(to_json(report))["energy"];
  EXPECT_EQ(json["elastic"].size(), 40u);
  for (const char* key : {"work_pins", "work_shapes", "work_wind", "work_hands", "left_over"})
    EXPECT_TRUE(json.at(key).is_null()) << key << " is not measured without an audit";
}

TEST(Report, OfAnAuditBalancesAndTheMotionIsTheSame) {
  // A ball that rotates under a sheet.
  const SceneDesc scene =
      shipped("contact/rotating_ball", {"cloth[0].grid.cells=[12, 12]", "solver.steps_per_frame=2"});
  RunReport reports[2];
  for (const bool audit : {false, true}) reports[audit] = run_scene(scene, {.frames = 90, .audit = audit});
  EXPECT_EQ(reports[0].state_hash, reports[1].state_hash);
  const EnergySeries& e = reports[1].energy;
  ASSERT_EQ(e.left_over.size(), 90u);
  double work_of_the_ball = 0;
  for (int f = 1; f < 90; ++f) {
    const double gain = e.kinetic[f] + e.elastic[f] + e.bending[f] + e.gravitational[f] - e.kinetic[f - 1] -
                        e.elastic[f - 1] - e.bending[f - 1] - e.gravitational[f - 1];
    EXPECT_NEAR(e.work_pins[f] + e.work_shapes[f] + e.work_wind[f] + e.work_hands[f] + e.left_over[f], gain,
                1e-9);
    work_of_the_ball += e.work_shapes[f];
  }
  EXPECT_GT(work_of_the_ball, 1e-4) << "it takes the sheet along";
}

TEST(Report, CannotBeWrittenIntoAMissingFolder) {
  EXPECT_THROW(write_report("/nonexistent/folder/report.json", {}), InputError);
}

TEST(Report, HasTheProblemsOfSettling) {
  // A ball goes through a sheet held by its corners within two steps before frame 0, in steps that may divide once.
  const std::string scene = R"([scene]
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
)";
  Recorder recorder;
  SceneRun run(parse_scene(scene, "scene.toml"), make_serial_jobs(), {&recorder});
  const RunReport report = run.finish();  // without a frame
  const bool is_reported =
      std::any_of(report.problems.begin(), report.problems.end(),
                  [](const RunProblem& p) { return p.code == WarningCode::cap_reached; });
  EXPECT_TRUE(is_reported);
}

}  // namespace
}  // namespace weft::engine
