/// Fabrics in scenes: by name, by file and in SI values, as triangles and as springs.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "tests/own_folder.h"
#include "weft/error.h"
#include "weft/fabric.h"
#include "weft/scene/scene_reader.h"
#include "weft/scene/scene_world.h"

namespace weft::engine {
namespace {

SceneDesc scene_with(const std::string& keys, const Overrides& overrides = {},
                     const std::filesystem::path& folder = {}) {
  return parse_scene("[scene]\nformat = 1\n[[cloth]]\ngrid = { size = [1, 0.8], cells = [10, 8] }\n" + keys,
                     folder / "scene.toml", overrides);
}

SceneWorld built(const std::string& keys, const Overrides& overrides = {}) {
  return build_world(scene_with(keys, overrides), make_serial_jobs());
}

TEST(FabricScenes, TakeAFabricByName) {
  const Fabric& denim = find_fabric("denim");
  const SceneWorld scene = built("fabric = \"denim\"\n");
  const ClothModel& model = scene.world.model(scene.world.cloth(0));
  ASSERT_NE(model.elements, nullptr);
  EXPECT_EQ(model.elements->stiffness, membrane_stiffness(denim));
  EXPECT_EQ(model.elements->damping, denim.damping);
  EXPECT_EQ(model.material.density, denim.density);
  EXPECT_EQ(model.material.thickness, denim.thickness);
  EXPECT_EQ(model.material.friction, denim.friction);
  EXPECT_EQ(model.material.structural, 0);
  EXPECT_EQ(model.topology->spring_model, SpringModel::alternating) << "hangs symmetrically";
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(FabricScenes, ChangeTheirFabricByAnOverride) {
  const SceneWorld scene = built("fabric = \"denim\"\n", {"cloth[0].fabric=silk"});
  EXPECT_EQ(scene.world.model(scene.world.cloth(0)).material.density, find_fabric("silk").density);
  const SceneWorld other = built("", {"cloth[0].fabric=silk", "cloth[0].membrane=springs"});
  EXPECT_TRUE(other.world.model(other.world.cloth(0)).material.structural_z.has_value());
}

TEST(FabricScenes, TakeAFabricFileFromTheSceneFolder) {
  const std::filesystem::path folder = make_own_folder();
  std::ofstream(folder / "mine.toml") << "density = 0.3\nc11 = 100\nc22 = 200\nc12 = 5\ng = 20\n"
                                         "bend_warp = 1e-5\nbend_weft = 1e-5\nbend_bias = 1e-5\n";
  const SceneDesc scene = scene_with("fabric = \"mine.toml\"\n", {}, folder);
  EXPECT_EQ(scene.cloths[0].fabric->numbers.c22, 200);
  EXPECT_EQ(scene.cloths[0].material.density, 0.3);
}

TEST(FabricScenes, TakeSiValuesWithTheDefaultsOfCottonShirting) {
  const SceneDesc scene = scene_with("fabric = { c11 = 500, damping = 0.01 }\n");
  EXPECT_EQ(scene.cloths[0].fabric->numbers.c11, 500);
  EXPECT_EQ(scene.cloths[0].fabric->numbers.damping, 0.01);
  EXPECT_EQ(scene.cloths[0].fabric->numbers.c22, Fabric().c22);
  EXPECT_EQ(scene.cloths[0].material.damping, 0) << "of springs, in other units";
}

TEST(FabricScenes, HaveWarpAlongEitherAxisOfTheGridOrAcross) {
  const auto warp = [](const std::string& direction) {
    const SceneWorld scene = built("fabric = \"denim\"\nwarp = " + direction + "\n");
    return scene.world.model(scene.world.cloth(0)).elements->grid_warp;
  };
  EXPECT_EQ(warp("[2, 0, 0]"), GridWarp::first_axis);
  EXPECT_EQ(warp("[0, 0, -1]"), GridWarp::second_axis);
  EXPECT_EQ(warp("[1, 0, 1]"), std::nullopt) << "then it is a mesh, whose particles are the grid's";
  const SceneWorld skew = built("fabric = \"denim\"\nwarp = [1, 0, 1]\npins = [\"corner:1,1\"]\n");
  EXPECT_EQ(skew.world.pins(skew.world.cloth(0)).at(0).particles, std::vector<int>{98});
}

TEST(FabricScenes, MakeSpringsThatStretchAsTheFabricDoes) {
  // A homogeneous stretch of the grid stores ½ A C ε² along either axis, for any cells. The tolerance is 2 %,
  // because springs are not linear in Green's strain.
  const Fabric& fabric = find_fabric("denim");
  for (const char* spring_model : {"basic", "alternating"}) {
    const SceneWorld scene =
        built("fabric = \"denim\"\nmembrane = \"springs\"\nmodel = \"" + std::string(spring_model) + "\"\n");
    const ClothModel& model = scene.world.model(scene.world.cloth(0));
    const auto is_reported = [](const std::string& w) { return w.find("c12 = g") != std::string::npos; };
    EXPECT_TRUE(std::any_of(scene.warnings.begin(), scene.warnings.end(), is_reported));
    for (const bool along_x : {true, false}) {
      const double e = 0.001;
      double energy = 0;
      for (int k = 0; k < static_cast<int>(model.topology->springs.size()); ++k) {
        const Spring& s = model.topology->springs[k];
        Vec3 d = model.topology->mesh.positions[s.j] - model.topology->mesh.positions[s.i];
        (along_x ? d.x() : d.z()) *= 1 + e;
        const double stretch = d.norm() - s.rest_length;
        energy += 0.5 * model.stiffness(k) * stretch * stretch;
      }
      const double c = along_x ? fabric.c11 : fabric.c22;
      EXPECT_NEAR(energy / (0.5 * 0.8 * c * e * e), 1, 0.02) << spring_model;
    }
  }
}

TEST(FabricScenes, SaySoWhereSpringsCannotBeTheFabric) {
  const auto failure = [](const std::string& keys) -> std::string {
    try {
      built(keys + "membrane = \"springs\"\n");
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_NE(failure("fabric = { c11 = 50, g = 60 }\n").find("springs cannot represent it: c11"),
            std::string::npos);
  EXPECT_NE(failure("fabric = \"silk\"\nwarp = [1, 0, 1]\n").find("membrane = \"triangle\""),
            std::string::npos);
}

TEST(FabricScenes, AreRefusedByIntegratorsOfSpringsAlone) {
  for (const char* name : {"explicit", "paper", "paper_fixed", "desbrun"}) {
    SceneDesc scene = scene_with("fabric = \"denim\"\n");
    scene.solver.integrator = name;
    try {
      build_world(scene, make_serial_jobs());
      FAIL() << name;
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("use newton, implicit_euler or xpbd"), std::string::npos)
          << error.what();
    }
  }
  SceneWorld scene = built("fabric = \"denim\"\n");
  EXPECT_THROW(scene.world.set_integrator({.integrator = "paper"}), InputError);
}

/// A square of two triangles with u along the direction (c, s) of its plane, and v sheared against it.
SceneWorld built_with_uv(double c, double s, double shear, const std::string& keys = "") {
  const std::filesystem::path folder = make_own_folder();
  std::ofstream obj(folder / "square.obj");
  const double corners[4][2] = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  for (const auto& [x, z] : corners) obj << "v " << x << " 0 " << z << "\n";
  for (const auto& [x, z] : corners) {
    const double u = c * x + s * z, v = -s * x + c * z;
    obj << "vt " << u + shear * v << " " << v << "\n";
  }
  obj << (keys == "no uv" ? "f 1 2 3\nf 1 3 4\n" : "f 1/1 2/2 3/3\nf 1/-4 3/-2 4/-1\n");
  obj.close();
  return build_world(
      parse_scene("[scene]\nformat = 1\n[[cloth]]\nmesh = \"square.obj\"\nfabric = \"denim\"\n" +
                      (keys == "no uv" ? "" : keys),
                  folder / "scene.toml"),
      make_serial_jobs());
}

/// Direction of warp in the plane of the square: ∂x/∂(axis 1).
Vec3 warp_of(const SceneWorld& scene, int triangle) {
  const ClothModel& model = scene.world.model(scene.world.cloth(0));
  const auto& [v, rest] = model.elements->membranes[triangle];
  Vec3 warp = Vec3::Zero();
  for (int c = 0; c < 3; ++c) warp += rest.gradient[c].x() * model.topology->mesh.positions[v[c]];
  return warp;
}

TEST(FabricScenes, LayWarpAlongUOnAMeshTurnedOrSheared) {
  for (const double shear : {0.0, 0.7}) {
    const SceneWorld scene = built_with_uv(0.6, 0.8, shear);
    for (const int triangle : {0, 1}) {
      // Along warp u grows and v is constant, for any shear.
      EXPECT_LT((warp_of(scene, triangle) - Vec3(0.6, 0, 0.8)).norm(), 1e-9) << shear;
    }
    EXPECT_TRUE(scene.warnings.empty());
  }
  const SceneWorld given = built_with_uv(0.6, 0.8, 0, "warp = [0, 0, 1]\n");
  EXPECT_LT((warp_of(given, 0) - Vec3::UnitZ()).norm(), 1e-9) << "a direction goes before";
}

TEST(FabricScenes, MakeSpringsOfAMeshsEdges) {
  const SceneWorld scene = built_with_uv(1, 0, 0, "membrane = \"springs\"\n");
  const ClothModel& model = scene.world.model(scene.world.cloth(0));
  EXPECT_TRUE(model.elements->membranes.empty());
  EXPECT_EQ(model.material.damping_time, find_fabric("denim").damping);
  for (std::size_t s = 0; s < model.topology->springs.size(); ++s) {
    if (model.topology->springs[s].kind == SpringKind::structural) continue;
    EXPECT_EQ(model.stiffness(static_cast<int>(s)), 0) << "bending is the fabric's own";
  }
  EXPECT_GT(model.stiffness_sum[0], 100) << "[N/m], of a fabric of 2000";
  const auto is_reported = [](const std::string& w) { return w.find("on average") != std::string::npos; };
  EXPECT_TRUE(std::any_of(scene.warnings.begin(), scene.warnings.end(), is_reported));
  // Regions multiply the stiffness of edges.
  const SceneWorld stiffer = built_with_uv(1, 0, 0,
                                           "membrane = \"springs\"\nstiffen = [{ select = { sphere = { "
                                           "center = [0, 0, 0], radius = 9 } }, factor = 3 }]\n");
  EXPECT_NEAR(stiffer.world.model(stiffer.world.cloth(0)).stiffness_sum[0], 3 * model.stiffness_sum[0], 1e-6);
}

TEST(FabricScenes, SayWhereWarpGoesIfAMeshHasNoTextureCoordinates) {
  const SceneWorld built = built_with_uv(1, 0, 0, "no uv");
  ASSERT_EQ(built.warnings.size(), 1u);
  EXPECT_NE(built.warnings[0].find("warp = [1, 0, 0]"), std::string::npos) << built.warnings[0];
}

}  // namespace
}  // namespace weft::engine
