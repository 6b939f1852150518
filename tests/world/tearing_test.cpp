/// Cloth that tears: at the load of its strength, at its notch, and in every other part of the library.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>

#include "tests/message_of.h"
#include "tests/same_continuation.h"
#include "weft/face/world_impl.h"
#include "weft/forces/cuts.h"
#include "weft/weft.h"

namespace weft {
namespace {

constexpr double kStep = 1.0 / 60;
constexpr double kStrength = 150;  // [N/m]

Fabric weak() {
  return {.density = 0.15,
          .c11 = 1500,
          .c22 = 1500,
          .c12 = 0,
          .g = 60,
          .bend_warp = 1e-6,
          .bend_weft = 1e-6,
          .bend_bias = 1e-6,
          .strength = kStrength};
}

constexpr int kCellsX = 32, kCellsZ = 8;
constexpr double kLength = 0.16, kWidth = 0.04;

/// A strip along x. `notch`: cells cut out of each long side in its middle.
TriangleMesh make_strip(int notch) {
  const Grid grid{.size_x = kLength, .size_z = kWidth, .cells_x = kCellsX, .cells_z = kCellsZ};
  TriangleMesh mesh;
  for (int j = 0; j <= kCellsZ; ++j) {
    for (int i = 0; i <= kCellsX; ++i)
      mesh.positions.push_back({grid.spacing_x() * i, 0, grid.spacing_z() * j});
  }
  for (int j = 0; j < kCellsZ; ++j) {
    for (int i = 0; i < kCellsX; ++i) {
      if (i == kCellsX / 2 && (j < notch || j >= kCellsZ - notch)) continue;
      const int a = grid.index(i, j), b = grid.index(i, j + 1);
      const bool is_main = (i + j) % 2 == 0;
      mesh.triangles.push_back(is_main ? Triangle{a, b, b + 1} : Triangle{a, b, a + 1});
      mesh.triangles.push_back(is_main ? Triangle{a, b + 1, a + 1} : Triangle{a + 1, b, b + 1});
    }
  }
  return mesh;
}

/// A strip between two clamps, of which the one at x = kLength moves.
struct TensileTest {
  World world;
  ClothId strip;
  std::vector<Vec3> held;
  std::size_t num_fixed = 0, num_clamped = 0;

  explicit TensileTest(int notch, const Fabric& fabric = weak()) {
    world.set_gravity({});
    strip = world.add_cloth({.shape = make_strip(notch), .fabric = fabric, .warp = Vec3{1, 0, 0}});
    const std::vector<Vec3> positions = world.positions(strip);
    Pin fixed, moving;
    for (int i = 0; i < static_cast<int>(positions.size()); ++i) {
      if (positions[i].x < 1e-6) fixed.particles.push_back(i);
      if (positions[i].x > kLength - 1e-6) moving.particles.push_back(i);
    }
    num_fixed = fixed.particles.size();
    world.set_pins(strip, {fixed, moving});
    for (const int i : world.pinned_particles(strip)) held.push_back(positions[i]);
    num_clamped = held.size();
  }

  StepReport try_pull(double speed) {
    for (std::size_t k = num_fixed; k < num_clamped; ++k) held[k].x += speed * kStep;
    world.move_pins(strip, held);
    return world.step(kStep);
  }

  StepReport pull(double speed) {
    const StepReport report = try_pull(speed);
    EXPECT_TRUE(report.ok);
    return report;
  }

  double load() const {
    double sum = 0;
    const std::vector<Vec3> forces = world.pin_forces(strip);
    for (std::size_t k = num_fixed; k < num_clamped; ++k) sum += forces[k].x;
    return sum;
  }

  /// The greatest tension across a cut [N/m].
  double tension() const {
    const engine::World& inside = WorldAccess::engine(world);
    std::vector<char> holds(inside.state(strip).x.size(), 0);
    for (const int i : world.pinned_particles(strip)) holds[i] = 1;
    double most = 0;
    for (const engine::Cut& cut : find_cuts(inside.model(strip), inside.state(strip), holds, 1e-3))
      most = std::max(most, cut.tension);
    return most;
  }
};

/// The number of pieces of a cloth that share no particle.
int count_pieces(const World& world, ClothId cloth) {
  std::vector<int> piece(static_cast<std::size_t>(world.num_particles(cloth)));
  std::iota(piece.begin(), piece.end(), 0);
  for (bool changes = true; changes;) {
    changes = false;
    for (const Triangle& t : world.triangles(cloth)) {
      const int least = std::min({piece[t[0]], piece[t[1]], piece[t[2]]});
      for (const int v : t) {
        changes |= piece[v] != least;
        piece[v] = least;
      }
    }
  }
  return static_cast<int>(std::set<int>(piece.begin(), piece.end()).size());
}

constexpr double kSpeed = 0.01;  // [m/s]

TEST(Tearing, AStripTearsAtItsStrengthTimesItsWidth) {
  TensileTest test(0);
  double load = 0;
  for (int n = 0; n < 200; ++n) {
    const double before = test.load();
    if (test.pull(kSpeed).torn > 0) {
      load = before;
      break;
    }
  }
  EXPECT_NEAR(load, kStrength * kWidth, 0.05 * kStrength * kWidth);
}

TEST(Tearing, UnderUniformTensionOneTearCrossesTheStrip) {
  TensileTest test(0);
  const int before = test.world.num_particles(test.strip);
  for (int n = 0; n < 200; ++n) test.pull(2 * kSpeed);
  EXPECT_EQ(count_pieces(test.world, test.strip), 2);
  EXPECT_LT(test.world.num_particles(test.strip), before + 3 * (kCellsZ + 1));
}

TEST(Tearing, ANotchedStripTearsAtTheNotchAtTheLoadOfItsStrength) {
  constexpr int kNotch = 2;
  TensileTest test(kNotch);
  double lower_load = 0, lower_tension = 0, load = 0;
  std::vector<Vec3> before;
  for (int n = 0; n < 800; ++n) {
    if (lower_load == 0 && test.tension() > 0.7 * kStrength) {
      lower_load = test.load();
      lower_tension = test.tension();
    }
    before = test.world.positions(test.strip);
    load = test.load();
    if (test.pull(kSpeed / 4).torn > 0) break;
  }
  // Tension rises with the load: from 0.7 of the strength follows the load that tears.
  const double expected = lower_load * kStrength / lower_tension;
  ASSERT_GT(lower_load, 0);
  EXPECT_NEAR(load, expected, 0.05 * expected);
  EXPECT_LT(load,
            0.9 * kStrength * kWidth * (kCellsZ - 2 * kNotch) / kCellsZ);  // tension is higher at the notch
  // New particles are where the strip tore: beside the corners of the notch.
  ASSERT_GT(test.world.num_particles(test.strip), static_cast<int>(before.size()));
  const std::vector<Vec3> now = test.world.positions(test.strip);
  for (std::size_t i = before.size(); i < now.size(); ++i) {
    const double from_side = std::min(now[i].z, kWidth - now[i].z);
    EXPECT_NEAR(from_side, kWidth * kNotch / kCellsZ, 1.5 * kWidth / kCellsZ);
    EXPECT_NEAR(now[i].x, kLength / 2, 0.12 * kLength);
  }
}

TEST(Tearing, EndsInTwoPiecesWithoutIntersectionsAndWithoutLoad) {
  TensileTest test(2);
  int torn = 0;
  for (int n = 0; n < 400; ++n) torn += test.pull(2 * kSpeed).torn;
  EXPECT_GE(torn, 4);
  EXPECT_EQ(count_pieces(test.world, test.strip), 2);
  EXPECT_LT(std::abs(test.load()), 0.02 * kStrength * kWidth);
  EXPECT_TRUE(test.world.untangle().empty());
  // Mass is that of the strip: of its cells without those that are cut out.
  const std::vector<double> masses = test.world.masses(test.strip);
  const double cell = kLength / kCellsX * kWidth / kCellsZ;
  EXPECT_NEAR(std::accumulate(masses.begin(), masses.end(), 0.0), 0.15 * cell * (kCellsX * kCellsZ - 4),
              1e-9);
}

TEST(Tearing, HasTheSameBitsForAnyNumberOfThreads) {
  std::set<std::uint64_t> hashes;
  for (const int threads : {1, 2, 3}) {
    TensileTest test(2);
    test.world.set_jobs(make_jobs(threads));
    int torn = 0;
    for (int n = 0; n < 120; ++n) torn += test.pull(4 * kSpeed).torn;
    EXPECT_GT(torn, 0);
    hashes.insert(test.world.state_hash());
  }
  EXPECT_EQ(hashes.size(), 1U);
}

/// Pulls until the strip has torn, at a corner at least.
void tear(TensileTest& test) {
  int torn = 0;
  for (int n = 0; n < 200 && torn == 0; ++n) torn += test.pull(4 * kSpeed).torn;
  ASSERT_GT(torn, 0);
}

TEST(Tearing, SnapshotsAndSavedWorldsHoldIt) {
  TensileTest test(2);
  tear(test);
  expect_same_continuation(test.world, 20, kStep);
}

/// The first step that would tear in one of its parts but the last, and fails in the next.
TEST(Tearing, AStepThatFailsLeavesTheClothAsItWas) {
  TensileTest test(2);
  engine::World& inside = WorldAccess::engine(test.world);
  bool has_failed = false;
  for (int n = 0; n < 200 && !has_failed; ++n) {
    const Snapshot before = test.world.snapshot();
    const std::uint64_t hash = test.world.state_hash();
    const int num_particles = test.world.num_particles(test.strip);
    const std::vector<Vec3> held = test.held;
    inside.set_observer([&](double) {
      const int now = inside.model(test.strip).num_particles();
      if (now > num_particles) inside.set_forces(test.strip, std::vector<engine::Vec3>(now, {1e38, 0, 0}));
    });
    const StepReport report = test.try_pull(4 * kSpeed);
    inside.set_observer({});
    if (!report.ok) {
      has_failed = true;
      EXPECT_EQ(report.torn, 0);
      EXPECT_EQ(test.world.num_particles(test.strip), num_particles);
      EXPECT_EQ(test.world.state_hash(), hash);
    }
    if (report.ok && report.torn == 0) continue;
    const auto tear_from_there = [&] {
      test.held = held;
      EXPECT_GT(test.pull(4 * kSpeed).torn, 0);
      return test.world.state_hash();
    };
    const std::uint64_t after_failure = report.ok ? 0 : tear_from_there();
    test.world.restore(before);
    const std::uint64_t after_restore = tear_from_there();
    if (!report.ok) {
      EXPECT_EQ(after_failure, after_restore);
    }
  }
  EXPECT_TRUE(has_failed);
}

TEST(Tearing, ASnapshotOfTheWholeClothMakesItWhole) {
  TensileTest test(2);
  const Snapshot whole = test.world.snapshot();
  const int num_particles = test.world.num_particles(test.strip);
  const std::vector<Vec3> held = test.held;
  tear(test);
  const Snapshot torn = test.world.snapshot();
  const std::uint64_t hash = test.world.state_hash();
  World copy = test.world.clone();
  test.world.restore(whole);
  EXPECT_EQ(test.world.num_particles(test.strip), num_particles);
  test.held = held;
  tear(test);
  EXPECT_EQ(test.world.state_hash(), hash);
  test.world.restore(whole);
  test.world.restore(torn);
  EXPECT_EQ(test.world.state_hash(), hash);
  EXPECT_TRUE(test.world.step(kStep).ok);
  EXPECT_TRUE(copy.step(kStep).ok);
  EXPECT_EQ(test.world.state_hash(), copy.state_hash());
}

TEST(Tearing, KeepsPinsGrabsAndForcesOnTheirParticles) {
  TensileTest test(2);
  const int free = kCellsX / 4;  // on a border
  std::vector<Vec3> forces(static_cast<std::size_t>(test.world.num_particles(test.strip)));
  forces[free] = {0, 0, 1e-3};
  test.world.set_forces(test.strip, forces);
  const int grabbed = kCellsX / 4 + kCellsZ * (kCellsX + 1);  // on the other border
  const Vec3 place = test.world.positions(test.strip)[grabbed];
  test.world.add_pin(test.strip, {.particles = {grabbed}, .stiffness = 1e4, .damping = 1});
  test.held.push_back(place);
  tear(test);
  EXPECT_EQ(test.world.pinned_particles(test.strip).size(), test.held.size());
  EXPECT_LT(length(test.world.positions(test.strip)[grabbed] - place), 1e-3);
  const std::vector<Vec3> now = test.world.forces(test.strip, ForceKind::external);
  ASSERT_EQ(now.size(), static_cast<std::size_t>(test.world.num_particles(test.strip)));
  Vec3 sum;
  for (const Vec3& f : now) sum = sum + f;
  EXPECT_EQ(sum, Vec3({0, 0, 1e-3}));
  EXPECT_EQ(now[free], Vec3({0, 0, 1e-3}));
}

TEST(Tearing, EndsBeforeParticlesThatArePinned) {
  // A third clamp along one side, which the tear would divide.
  TensileTest test(0);
  const std::vector<Vec3> start = test.world.positions(test.strip);
  std::vector<int> side;
  for (int i = 0; i < static_cast<int>(start.size()); ++i) {
    if (start[i].z < 1e-6 && start[i].x > 1e-6 && start[i].x < kLength - 1e-6) side.push_back(i);
  }
  test.world.add_pin(test.strip, {.particles = side});
  int torn = 0;
  std::vector<Vec3> goal;
  for (const int i : test.world.pinned_particles(test.strip)) goal.push_back(start[i]);
  for (int n = 0; n < 120; ++n) {
    for (Vec3& p : goal) p.x *= 1.003;
    test.world.move_pins(test.strip, goal);
    torn += test.world.step(kStep).torn;
  }
  EXPECT_GT(torn, 5);
  const std::vector<Vec3> now = test.world.positions(test.strip);
  const std::vector<int> pinned = test.world.pinned_particles(test.strip);
  std::vector<int> num_triangles(now.size(), 0), before(now.size(), 0);
  for (const Triangle& t : test.world.triangles(test.strip)) {
    for (const int v : t) ++num_triangles[v];
  }
  for (const Triangle& t : make_strip(0).triangles) {
    for (const int v : t) ++before[v];
  }
  for (const int i : pinned) EXPECT_EQ(num_triangles[i], before[i]) << i;  // no part has left it
}

TEST(Tearing, ContactForcesAreThoseOfThePresentParticles) {
  World world;
  world.set_contact({.tracks_points = true});
  Fabric weaker = weak();
  weaker.strength = 40;
  const Grid grid{0.4, 0.4, 16, 16};
  const ClothId sheet = world.add_cloth({.shape = grid, .fabric = weaker, .pose = {{-0.2, 0, -0.2}, {}}});
  Pin pin;
  for (int k = 0; k <= 16; ++k) {
    pin.particles.push_back(grid.index(0, k));
    pin.particles.push_back(grid.index(16, k));
  }
  world.set_pins(sheet, {pin});
  const ColliderId ball = world.add_collider({.shape = Sphere{.center = {0, 0.09, 0}, .radius = 0.08}});
  const Snapshot whole = world.snapshot();
  int torn = 0;
  for (int n = 0; n < 40; ++n) {
    world.move_collider(ball, {{0, 0.09 - 0.008 * n, 0}, {}});
    torn += world.step(kStep).torn;
    EXPECT_EQ(world.forces(sheet, ForceKind::contact).size(),
              static_cast<std::size_t>(world.num_particles(sheet)));
  }
  ASSERT_GT(torn, 0);
  world.restore(whole);
  EXPECT_TRUE(world.contact_points().empty());
  EXPECT_EQ(world.forces(sheet, ForceKind::contact).size(), static_cast<std::size_t>(grid.num_particles()));
}

TEST(Tearing, StrongerClothAndClothWithoutStrengthStaysWhole) {
  Fabric strong = weak();
  strong.strength = 1e5;
  TensileTest test(2, strong);
  for (int n = 0; n < 60; ++n) EXPECT_EQ(test.pull(4 * kSpeed).torn, 0);
  // Its bits are those of a cloth that cannot tear.
  Fabric whole = weak();
  whole.strength = 0;
  TensileTest other(2, whole);
  for (int n = 0; n < 60; ++n) EXPECT_EQ(other.pull(4 * kSpeed).torn, 0);
  EXPECT_EQ(test.world.state_hash(), other.world.state_hash());
  test.world.set_fabric(test.strip, weak());
  EXPECT_GT(test.pull(0).torn, 0);
}

TEST(Tearing, GasEscapesFromTornCloth) {
  // A cushion of two sheets.
  const int n = 12;
  TriangleMesh mesh;
  for (const double side : {-1.0, 1.0}) {
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        const bool is_border = i == 0 || j == 0 || i == n || j == n;
        mesh.positions.push_back({0.3 * i / n, is_border ? 0 : 0.01 * side, 0.3 * j / n});
      }
    }
  }
  for (int s = 0; s < 2; ++s) {
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const int a = s * (n + 1) * (n + 1) + j * (n + 1) + i, b = a + n + 1;
        // The diagonals of both sides differ at two corners, so that no triangle is there twice.
        const bool is_main = (i < n / 2) == (j < n / 2);
        const std::array<Triangle, 2> up = is_main
                                               ? std::array{Triangle{a, b, b + 1}, Triangle{a, b + 1, a + 1}}
                                               : std::array{Triangle{a, b, a + 1}, Triangle{a + 1, b, b + 1}};
        for (const auto& [u, v, w] : up)
          mesh.triangles.push_back(s == 1 ? Triangle{u, v, w} : Triangle{u, w, v});
      }
    }
  }
  World world;
  world.set_gravity({});
  const ClothId cushion =
      world.add_cloth({.shape = mesh, .fabric = weak(), .warp = Vec3{1, 0, 0}, .weld = 0});
  int torn = 0;
  for (int step = 0; step < 300 && torn == 0; ++step) {
    world.set_pressure(cushion, 20.0 * step);
    torn = world.step(kStep).torn;
  }
  ASSERT_GT(torn, 0);
  EXPECT_EQ(world.pressure(cushion), 0);
  EXPECT_NE(message_of([&] { world.volume(cushion); }), "no error");
  for (int step = 0; step < 30; ++step) EXPECT_TRUE(world.step(kStep).ok);
  EXPECT_TRUE(world.untangle().empty());
}

TEST(Tearing, AGridWithAStrengthIsAMesh) {
  World world;
  const Grid grid{0.4, 0.4, 10, 10};
  const ClothId sheet = world.add_cloth({.shape = grid, .fabric = weak()});
  EXPECT_EQ(world.num_particles(sheet), grid.num_particles());
  world.set_pins(sheet, {{.particles = {grid.index(0, 0), grid.index(10, 0)}}});
  for (int n = 0; n < 5; ++n) EXPECT_TRUE(world.step(kStep).ok);
}

TEST(Tearing, RefusesWhatDoesNotTear) {
  const Grid grid{0.4, 0.4, 4, 4};
  const auto add = [&](const ClothDesc& desc) { return [=] { World().add_cloth(desc); }; };
  EXPECT_EQ(message_of(add({.shape = grid, .fabric = weak(), .membrane = Membrane::springs})),
            "cloth \"cloth\": springs do not tear; use membrane = \"triangle\", or strength = 0");
  Fabric creases = weak();
  creases.bend_set = 500;
  EXPECT_EQ(message_of(add({.shape = grid, .fabric = creases})),
            "cloth \"cloth\": cloth with hysteresis or set of bending does not tear; set "
            "bend_hysteresis_warp, bend_hysteresis_weft and bend_set to 0, or strength");
  World world;
  Fabric whole = weak();
  whole.strength = 0;
  const ClothId sheet = world.add_cloth({.shape = grid, .fabric = whole}),
                tearing = world.add_cloth({.shape = grid, .fabric = weak()});
  EXPECT_EQ(message_of([&] { world.set_fabric(sheet, weak()); }),
            "cloth \"cloth\": a grid that was added without strength does not tear; add it with one");
  EXPECT_EQ(message_of([&] { world.set_fabric(tearing, whole); }),
            "cloth \"cloth 2\": it was added with a strength; give it a large one in place of 0");
}

}  // namespace
}  // namespace weft
