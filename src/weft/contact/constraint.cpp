#include "weft/contact/constraint.h"

#include <algorithm>
#include <cmath>

namespace weft::engine {
namespace {

constexpr double kPositionTolerance = 1e-6;  // corrections below need no further pass [m]
constexpr double kNear = 2;  // skip constraints with this much room, in largest corrections of the first pass

}  // namespace

void mark_alone(std::vector<Constraint>& constraints, std::size_t num_vertices, std::vector<int>& count) {
  count.assign(num_vertices, 0);
  for (const Constraint& c : constraints) {
    for (int k = 0; k < c.num_vertices; ++k) ++count[c.vertex[k]];
  }
  for (Constraint& c : constraints) c.is_alone = c.num_vertices == 1 && count[c.vertex[0]] == 1;
}

double project_positions(const std::vector<double>& inverse_masses, int passes,
                         std::vector<Constraint>& constraints, std::vector<Vec3>& positions,
                         std::vector<int>& near) {
  double first = 0, largest = 0;
  const auto project = [&](Constraint& c, double shortfall) {
    const double push = std::max(0.0, c.push + shortfall / c.inverse_mass);
    const double change = push - c.push;
    if (change == 0) return;
    c.push = push;
    c.is_active |= push > 0;
    c.apply(change * c.normal, inverse_masses, positions);
    largest = std::max(largest, std::abs(change) * c.inverse_mass);
  };
  const auto shortfall_of = [&](const Constraint& c) { return c.target - c.normal.dot(c.sum(positions)); };
  near.clear();
  for (int pass = 0; pass < passes; ++pass) {
    largest = 0;
    if (pass < 2) {
      for (int n = 0; n < static_cast<int>(constraints.size()); ++n) {
        Constraint& c = constraints[n];
        if (c.inverse_mass == 0 || (pass == 1 && c.is_alone)) continue;
        const double shortfall = shortfall_of(c);
        if (pass == 1 && (c.push > 0 || shortfall > -kNear * first)) near.push_back(n);
        project(c, shortfall);
      }
    } else {
      for (const int n : near) project(constraints[n], shortfall_of(constraints[n]));
    }
    if (pass == 0) first = largest;
    if (largest < kPositionTolerance) break;
  }
  return first;
}

}  // namespace weft::engine
