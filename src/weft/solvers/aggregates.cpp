#include "weft/solvers/aggregates.h"

#include <algorithm>
#include <utility>

namespace weft::engine {
namespace {

constexpr double kStrong = 0.25;  // of the strongest coupling of a particle

class Aggregation {
 public:
  explicit Aggregation(const SparseMatrix& couplings, const std::vector<double>& diagonal)
      : couplings_(couplings), diagonal_(diagonal), strongest_(couplings.num_rows, 0.0) {
    for (int i = 0; i < couplings.num_rows; ++i) {
      for (int e = couplings.begin[i]; e < couplings.begin[i + 1]; ++e)
        strongest_[i] = std::max(strongest_[i], couplings.value[e]);
    }
    result_.of.assign(couplings.num_rows, -1);
  }

  Aggregates run() {
    start_where_all_are_free();
    join_to_neighbours();
    for (int i = 0; i < couplings_.num_rows; ++i) {
      if (result_.of[i] < 0 && takes_part(i)) gather_around(i);
    }
    return std::move(result_);
  }

 private:
  bool takes_part(int i) const { return diagonal_[i] > 0 && strongest_[i] > 0; }

  bool is_strong(int i, int e) const {
    const int j = couplings_.column[e];
    return couplings_.value[e] >= kStrong * std::min(strongest_[i], strongest_[j]) && takes_part(j);
  }

  /// A particle and its free strong neighbours.
  void gather_around(int i) {
    result_.of[i] = result_.count;
    for (int e = couplings_.begin[i]; e < couplings_.begin[i + 1]; ++e) {
      const int j = couplings_.column[e];
      if (is_strong(i, e) && result_.of[j] < 0) result_.of[j] = result_.count;
    }
    ++result_.count;
  }

  void start_where_all_are_free() {
    for (int i = 0; i < couplings_.num_rows; ++i) {
      if (result_.of[i] >= 0 || !takes_part(i)) continue;
      bool all_free = true;
      for (int e = couplings_.begin[i]; e < couplings_.begin[i + 1] && all_free; ++e)
        all_free = !is_strong(i, e) || result_.of[couplings_.column[e]] < 0;
      if (all_free) gather_around(i);
    }
  }

  /// Adds each remaining particle to the aggregate that it is coupled to most strongly.
  void join_to_neighbours() {
    const std::vector<int> before = result_.of;
    for (int i = 0; i < couplings_.num_rows; ++i) {
      if (before[i] >= 0 || !takes_part(i)) continue;
      double best = 0;
      for (int e = couplings_.begin[i]; e < couplings_.begin[i + 1]; ++e) {
        const int j = couplings_.column[e];
        if (before[j] < 0 || couplings_.value[e] <= best) continue;
        best = couplings_.value[e];
        result_.of[i] = before[j];
      }
    }
  }

  const SparseMatrix& couplings_;
  const std::vector<double>& diagonal_;
  std::vector<double> strongest_;
  Aggregates result_;
};

}  // namespace

Aggregates find_aggregates(const SparseMatrix& couplings, const std::vector<double>& diagonal) {
  return Aggregation(couplings, diagonal).run();
}

}  // namespace weft::engine
