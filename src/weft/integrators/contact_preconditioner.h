#pragma once
/// Private to integrators/: contacts in a preconditioner that is the same for x, y and z.

#include <array>
#include <memory>
#include <vector>

#include "weft/core/job_system.h"
#include "weft/core/vec3_array.h"

namespace weft::engine {

/// Contacts are a thousand times stiffer than inertia, but only along their normals. A scalar matrix stiff
/// enough for them also blocks sliding along the surface. The preconditioner therefore combines two:
///
///     P⁻¹ = V_stiff + S V_free S,     S = I − Σ n nᵀ
///
/// The first has contacts in its diagonal, the second only their friction, for motion along the surface. n
/// are, for each particle, up to three orthonormal contact normals. Symmetric and positive definite if the
/// first is.
class ContactPreconditioner {
 public:
  void clear();

  bool empty() const { return held_.empty(); }

  /// Adds a contact on the particle at this index, along this unit vector; `size` is that of the arrays.
  void add_normal(int at, const Vec3& normal, std::size_t size);

  /// z = P⁻¹ r; stiff(r, jobs, z) and free(r, jobs, z) compute V r and return r·V r. Returns r·z. With few
  /// threads the two run in parallel on one thread each: inside, threads would mostly wait.
  template <class Stiff, class Free>
  double apply(const Stiff& stiff, const Free& free, const Vec3Array& r, JobSystem& jobs, Vec3Array& z) {
    if (held_.empty()) return free(r, jobs, z);
    along_surface_ = r;
    remove_normal_components(along_surface_);
    if (slid_.size() != r.size()) slid_ = Vec3Array(r.size());
    double dots[2];
    const bool is_parallel = jobs.num_threads() > 1 && jobs.num_threads() <= kFewThreads;
    const auto run = [&](int cycle) {
      JobSystem& below = is_parallel ? *serial_ : jobs;
      dots[cycle] = cycle == 0 ? stiff(r, below, z) : free(along_surface_, below, slid_);
    };
    if (is_parallel) {
      jobs.run(2, run);
    } else {
      run(0);
      run(1);
    }
    remove_normal_components(slid_);
    add_slid(z);
    return dots[0] + dots[1];
  }

 private:
  struct Held {
    int at = 0;  // index into the rows
    int num_normals = 0;
    std::array<Vec3, 3> normal;
  };

  static constexpr int kFewThreads = 3;

  void remove_normal_components(Vec3Array& field) const;
  void add_slid(Vec3Array& z) const;

  std::vector<Held> held_;
  std::vector<int> index_;          // (rows) index into held_, -1: none
  Vec3Array along_surface_, slid_;  // S r, S V_free S r
  std::unique_ptr<JobSystem> serial_ = make_serial_jobs();
};

}  // namespace weft::engine
