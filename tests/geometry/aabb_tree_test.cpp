#include "weft/geometry/aabb_tree.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support.h"
#include "weft/core/simd.h"

namespace weft::engine {
namespace {

using Boxes = std::vector<Aabb>;

Aabb box_around(const Vec3& center, double size) {
  return make_aabb(center - Vec3::Constant(size), center + Vec3::Constant(size));
}

/// Query inputs, by name.
std::vector<std::pair<std::string, Boxes>> inputs() {
  Random random(7);
  std::vector<std::pair<std::string, Boxes>> all;
  for (const int n : {0, 1, 7, 8, 9, 64, 65, 700}) {
    Boxes boxes;
    for (int i = 0; i < n; ++i) {
      boxes.push_back(box_around(test::random_vector(random, 1), random.uniform(0, 0.15)));
    }
    all.emplace_back(std::to_string(n) + " random", boxes);
  }
  all.emplace_back("points in one place", Boxes(50, box_around(Vec3(1, 2, 3), 0)));
  all.emplace_back("the same box", Boxes(50, box_around(Vec3::Zero(), 1)));
  all.emplace_back("empty boxes", Boxes(20, Aabb()));
  Boxes plane, line, touching, huge, mixed;
  for (int i = 0; i < 300; ++i) {
    plane.push_back(box_around({random.uniform(0, 1), 0, random.uniform(0, 1)}, 0.02));
    line.push_back(box_around({0.1 * i, 0, 0}, 0.07));
    touching.push_back(make_aabb(Vec3(i, 0, 0), Vec3(i + 1, 1, 1)));
    huge.push_back(box_around(test::random_vector(random, 1e37), random.uniform(0, 2e36)));
    mixed.push_back(box_around(test::random_vector(random, 1), std::pow(10.0, random.uniform(-9, 9))));
  }
  mixed.push_back(make_aabb(Vec3::Constant(-1e300), Vec3::Constant(1e300)));
  all.emplace_back("in a plane", plane);
  all.emplace_back("on a line", line);
  all.emplace_back("touching", touching);
  all.emplace_back("huge", huge);
  all.emplace_back("of all sizes", mixed);
  return all;
}

/// Every third item shares a key with the next one.
std::vector<AabbTree::Keys> some_keys(std::size_t n) {
  std::vector<AabbTree::Keys> keys;
  for (int i = 0; i < static_cast<int>(n); ++i) {
    keys.push_back(i % 7 == 0 ? AabbTree::kNoKeys : AabbTree::Keys{i / 3, 1000 + i, 2000 + i / 5});
  }
  return keys;
}

bool share_key(const AabbTree::Keys& a, const AabbTree::Keys& b) {
  if (a == AabbTree::kNoKeys || b == AabbTree::kNoKeys) return false;
  return std::any_of(a.begin(), a.end(), [&](int k) { return std::find(b.begin(), b.end(), k) != b.end(); });
}

std::vector<ItemPair> brute_self_pairs(const Boxes& boxes, const std::vector<AabbTree::Keys>& keys) {
  std::vector<ItemPair> pairs;
  for (int a = 0; a < static_cast<int>(boxes.size()); ++a) {
    for (int b = a + 1; b < static_cast<int>(boxes.size()); ++b) {
      if (boxes[a].overlaps(boxes[b]) && (keys.empty() || !share_key(keys[a], keys[b])))
        pairs.push_back({a, b});
    }
  }
  return pairs;
}

std::vector<ItemPair> sorted(std::vector<ItemPair> pairs) {
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

class EveryLevelAndThread : public testing::TestWithParam<std::tuple<SimdLevel, int>> {
 protected:
  void SetUp() override {
    if (std::get<0>(GetParam()) > best_simd_level()) GTEST_SKIP() << "this machine has no such instructions";
    limit_simd_level(std::get<0>(GetParam()));
  }
  void TearDown() override { limit_simd_level(best_simd_level()); }

  std::unique_ptr<JobSystem> jobs_ = make_jobs(std::get<1>(GetParam()));
};

TEST_P(EveryLevelAndThread, SelfPairsEqualBruteForce) {
  for (const auto& [name, boxes] : inputs()) {
    for (const auto& keys : {std::vector<AabbTree::Keys>(), some_keys(boxes.size())}) {
      AabbTree tree;
      tree.build(boxes, keys, *jobs_);
      PairSearch search;
      tree.find_self_pairs(*jobs_, search);
      EXPECT_TRUE(sorted(search.pairs) == brute_self_pairs(boxes, keys)) << name;
    }
  }
}

TEST_P(EveryLevelAndThread, PairsOfTwoTreesEqualBruteForce) {
  const auto all = inputs();
  for (const auto& [name_a, a] : all) {
    for (const auto& [name_b, b] : all) {
      AabbTree tree_a, tree_b;
      tree_a.build(a, some_keys(a.size()), *jobs_);
      tree_b.build(b, some_keys(b.size()), *jobs_);
      PairSearch search;
      tree_a.find_pairs(tree_b, *jobs_, search);
      std::vector<ItemPair> expected;
      for (int i = 0; i < static_cast<int>(a.size()); ++i) {
        for (int j = 0; j < static_cast<int>(b.size()); ++j) {
          if (a[i].overlaps(b[j])) expected.push_back({i, j});
        }
      }
      ASSERT_TRUE(sorted(search.pairs) == expected) << name_a << " with " << name_b;
    }
  }
}

TEST_P(EveryLevelAndThread, RefittedTreeEqualsBruteForce) {
  Random random(3);
  Boxes boxes = inputs()[7].second;
  AabbTree tree;
  tree.build(boxes, {}, *jobs_);
  EXPECT_EQ(tree.looseness(), 1.0);
  PairSearch search;
  for (int round = 0; round < 5; ++round) {
    for (Aabb& box : boxes) box = box_around(test::random_vector(random, 1 + round), 0.1);
    tree.refit([&](int item) { return boxes[item]; }, *jobs_);
    tree.find_self_pairs(*jobs_, search);
    EXPECT_TRUE(sorted(search.pairs) == brute_self_pairs(boxes, {}));
  }
  EXPECT_GT(tree.looseness(), 2.0) << "items that have changed places make a tree loose";
}

TEST_P(EveryLevelAndThread, PairsThatMayMeetEqualBruteForce) {
  // Half of them move together, as cloth does; the result must not depend on the common part.
  for (const auto& [name, boxes] : inputs()) {
    if (name == "huge" || name == "of all sizes" || name == "empty boxes") continue;
    Random random(5);
    std::vector<MovingAabb> moving;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Vec3 way = (i % 2 ? Vec3(3, -2, 1) : Vec3::Zero()) + test::random_vector(random, 0.05);
      moving.push_back({boxes[i], box_around(way, 0.01)});
    }
    AabbTree tree, other;
    tree.build(boxes, {}, *jobs_);
    tree.refit([&](int i) { return moving[i]; }, *jobs_);
    other.build(boxes, {}, *jobs_);
    other.refit([&](int i) { return moving[i]; }, *jobs_);
    std::vector<ItemPair> self_pairs, all_pairs;
    for (int a = 0; a < static_cast<int>(boxes.size()); ++a) {
      for (int b = 0; b < static_cast<int>(boxes.size()); ++b) {
        if (!moving[a].may_meet(moving[b])) continue;
        all_pairs.push_back({a, b});
        if (a < b) self_pairs.push_back({a, b});
      }
    }
    PairSearch search;
    tree.find_self_pairs(*jobs_, search);
    EXPECT_EQ(sorted(search.pairs), self_pairs) << name;
    tree.find_pairs(other, *jobs_, search);
    EXPECT_EQ(sorted(search.pairs), all_pairs) << name;
    tree.refit([&](int i) { return boxes[i]; }, *jobs_);
    tree.find_self_pairs(*jobs_, search);
    EXPECT_EQ(sorted(search.pairs), brute_self_pairs(boxes, {})) << name << ", at rest again";
  }
}

TEST_P(EveryLevelAndThread, OfMarkedItemsThatHaveMovedNoPairIsMissed) {
  Random random(8);
  Boxes boxes = inputs()[7].second;
  std::vector<MovingAabb> moving;
  for (const Aabb& box : boxes) moving.push_back({box, box_around(Vec3::Zero(), 0.01)});
  const auto box_of = [&](int i) { return moving[i]; };
  AabbTree tree, other;
  for (AabbTree* t : {&tree, &other}) {
    t->build(boxes, {}, *jobs_);
    t->refit(box_of, *jobs_);
  }
  std::vector<char> is_marked(boxes.size());
  for (int round = 0; round < 4; ++round) {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      is_marked[i] = random.uniform(0, 1) < 0.1;
      if (is_marked[i]) moving[i].box = box_around(test::random_vector(random, 1), 0.1);
    }
    for (AabbTree* t : {&tree, &other}) {
      t->mark(is_marked);
      t->refit(box_of, *jobs_, AabbTree::Extent::marked);
    }
    std::vector<ItemPair> self_pairs, all_pairs;
    for (int a = 0; a < static_cast<int>(boxes.size()); ++a) {
      for (int b = 0; b < static_cast<int>(boxes.size()); ++b) {
        if (!(is_marked[a] || is_marked[b]) || !moving[a].may_meet(moving[b])) continue;
        all_pairs.push_back({a, b});
        if (a < b) self_pairs.push_back({a, b});
      }
    }
    const auto includes = [](const std::vector<ItemPair>& found, const std::vector<ItemPair>& wanted) {
      return std::includes(found.begin(), found.end(), wanted.begin(), wanted.end());
    };
    PairSearch search;
    tree.find_self_pairs(*jobs_, search, AabbTree::Extent::marked);
    EXPECT_FALSE(self_pairs.empty());
    EXPECT_TRUE(includes(sorted(search.pairs), self_pairs)) << round;
    tree.find_pairs(other, *jobs_, search, AabbTree::Extent::marked);
    EXPECT_TRUE(includes(sorted(search.pairs), all_pairs)) << round;
    // Unmarked items have not moved: all pairs still equal those of brute force.
    tree.find_self_pairs(*jobs_, search);
    std::vector<ItemPair> every;
    for (int a = 0; a < static_cast<int>(boxes.size()); ++a) {
      for (int b = a + 1; b < static_cast<int>(boxes.size()); ++b) {
        if (moving[a].may_meet(moving[b])) every.push_back({a, b});
      }
    }
    EXPECT_EQ(sorted(search.pairs), every) << round;
  }
}

TEST_P(EveryLevelAndThread, OrderOfPairsDoesNotDependOnThreadsOrVectors) {
  const Boxes boxes = inputs()[7].second;
  const auto serial = make_serial_jobs();
  AabbTree tree, same;
  PairSearch search, expected;
  tree.build(boxes, {}, *jobs_);
  tree.find_self_pairs(*jobs_, search);
  limit_simd_level(SimdLevel::baseline);
  same.build(boxes, {}, *serial);
  same.find_self_pairs(*serial, expected);
  EXPECT_EQ(search.pairs, expected.pairs);
}

INSTANTIATE_TEST_SUITE_P(AabbTree, EveryLevelAndThread,
                         testing::Combine(testing::Values(SimdLevel::baseline, SimdLevel::avx2,
                                                          SimdLevel::avx512),
                                          testing::Values(1, 3)));

TEST(MovingAabb, MeetsWhateverAWalkThroughTheStepFindsOverlapping) {
  Random random(9);
  int met = 0, apart = 0;
  for (int i = 0; i < 20000; ++i) {
    MovingAabb a, b;
    for (MovingAabb* m : {&a, &b}) {
      const Vec3 at = test::random_vector(random, 1), way = test::random_vector(random, 1);
      *m = {box_around(at, 0.1), box_around(way, 0)};
    }
    bool walk_meets = false;
    for (int s = 0; s <= 50 && !walk_meets; ++s) {
      const float t = static_cast<float>(s) / 50;
      bool overlap = true;
      for (int k = 0; k < 3; ++k) {
        const float shift = t * (b.way.min[k] - a.way.min[k]);
        overlap &= a.box.min[k] <= b.box.max[k] + shift && b.box.min[k] + shift <= a.box.max[k];
      }
      walk_meets = overlap;
    }
    EXPECT_TRUE(!walk_meets || a.may_meet(b)) << i;
    EXPECT_EQ(a.may_meet(b), b.may_meet(a)) << i;
    walk_meets ? ++met : ++apart;
  }
  EXPECT_GT(met, 100);
  EXPECT_GT(apart, 100);
}

TEST(AabbTree, BoxQueryVisitsWhatOverlaps) {
  Random random(11);
  const auto jobs = make_serial_jobs();
  for (const auto& [name, boxes] : inputs()) {
    AabbTree tree;
    tree.build(boxes, {}, *jobs);
    for (int q = 0; q < 50; ++q) {
      const Aabb query = box_around(test::random_vector(random, 1), 0.2);
      std::vector<int> visited, expected;
      tree.for_each_overlapping(query, [&](int item) { visited.push_back(item); });
      for (int i = 0; i < static_cast<int>(boxes.size()); ++i) {
        if (boxes[i].overlaps(query)) expected.push_back(i);
      }
      std::sort(visited.begin(), visited.end());
      EXPECT_EQ(visited, expected) << name;
    }
  }
}

/// Balls of different sizes, so that the nearest one is not the one with the nearest box.
TEST(AabbTree, NearestItemIsThatOfBruteForce) {
  Random random(5);
  const auto jobs = make_serial_jobs();
  std::vector<Vec3> centers;
  std::vector<double> radii;
  Boxes boxes;
  for (int i = 0; i < 500; ++i) {
    centers.push_back(test::random_vector(random, 1));
    radii.push_back(random.uniform(0, 0.1));
    boxes.push_back(box_around(centers[i], radii[i]));
  }
  centers[17] = centers[300];  // two equally near items: the lower one wins
  radii[17] = radii[300];
  boxes[17] = boxes[300];
  AabbTree tree;
  tree.build(boxes, {}, *jobs);
  for (int q = 0; q < 500; ++q) {
    const Vec3 p = q == 0 ? centers[300] : test::random_vector(random, 2);
    const auto distance_sq = [&](int i) {
      const double d = std::max(0.0, (p - centers[i]).norm() - radii[i]);
      return d * d;
    };
    for (const double reach : {1e9, 0.01}) {
      int expected = -1;
      for (int i = 0; i < 500; ++i) {
        if (distance_sq(i) < (expected < 0 ? reach : distance_sq(expected))) expected = i;
      }
      EXPECT_EQ(tree.find_nearest(p, reach, distance_sq), expected);
    }
  }
  EXPECT_EQ(AabbTree().find_nearest(Vec3::Zero(), 1, [](int) { return 0.0; }), -1);
}

TEST(AabbTree, RayMeetsTheFirstBallOfBruteForce) {
  Random random(9);
  const auto jobs = make_serial_jobs();
  std::vector<Vec3> centers;
  Boxes boxes;
  constexpr double kRadius = 0.05;
  for (int i = 0; i < 400; ++i) {
    centers.push_back(test::random_vector(random, 1));
    boxes.push_back(box_around(centers[i], kRadius));
  }
  AabbTree tree;
  tree.build(boxes, {}, *jobs);
  int hits = 0;
  for (int q = 0; q < 1000; ++q) {
    const Vec3 origin = test::random_vector(random, 2);
    Vec3 direction = test::random_vector(random, 1);
    if (q % 5 == 0) direction[q % 3] = 0;  // parallel to a side
    const auto hit = [&](int i) {
      const Vec3 o = origin - centers[i];
      const double a = direction.squaredNorm(), b = o.dot(direction);
      const double root_sq = b * b - a * (o.squaredNorm() - kRadius * kRadius);
      const double t = root_sq < 0 ? -1 : (-b - std::sqrt(root_sq)) / a;
      return t < 0 ? std::numeric_limits<double>::infinity() : t;
    };
    double expected = 3, found = 3;
    for (int i = 0; i < 400; ++i) expected = std::min(expected, hit(i));
    tree.for_each_along_ray(origin, direction, 3, [&](int i) { return found = std::min(found, hit(i)); });
    EXPECT_EQ(found, expected);
    hits += found < 3;
  }
  EXPECT_GT(hits, 50);
}

TEST(AabbTree, ComparesFewBoxesWhereFewAreNear) {
  // Cost grows with the close pairs, not quadratically: four times the boxes, about four times the work.
  const auto jobs = make_serial_jobs();
  const auto count = [&](int side) {
    Boxes boxes;
    for (int i = 0; i < side * side; ++i) boxes.push_back(box_around(Vec3(i % side, 0, i / side), 0.3));
    AabbTree tree;
    tree.build(boxes, {}, *jobs);
    PairSearch search;
    tree.find_self_pairs(*jobs, search);
    return static_cast<double>(search.num_box_pairs);
  };
  EXPECT_LT(count(128) / count(64), 4.5);
}

TEST(Aabb, InFloatsHoldsTheDoublesItWasMadeOf) {
  Random random(1);
  for (int i = 0; i < 100000; ++i) {
    const Vec3 p = test::random_vector(random, std::pow(10.0, random.uniform(-30, 30)));
    const Aabb box = make_aabb(p, p);
    for (int k = 0; k < 3; ++k) {
      EXPECT_LE(double{box.min[k]}, p[k]);
      EXPECT_GE(double{box.max[k]}, p[k]);
    }
  }
}

}  // namespace
}  // namespace weft::engine
