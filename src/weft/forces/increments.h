#pragma once
/// Fast kernels: all forces of a cloth in one pass, in floats, gathered per particle.
///
/// On grids the springs are stencils without index arrays; on meshes they come from the NeighbourTable.
/// Sums have one fixed order, so the result has the same bits for any number of threads and any vector width.

#include "weft/core/job_system.h"
#include "weft/core/vec3_array.h"
#include "weft/model/cloth_model.h"
#include "weft/model/cloth_state.h"

namespace weft::engine {

/// One 3-vector per particle in the kernels' layout: on grids, rows are padded with zeros between and around
/// them, so that stencils need no special case at the border.
class IncrementField {
 public:
  /// Allocates zeros for the given cloth; a no-op if already laid out for it.
  void fit(const ClothModel& model);

  /// Index of particle i in `values`.
  int index(int i) const { return first_ + (i / row_length_) * stride_ + i % row_length_; }

  int row_length() const { return row_length_; }
  int num_rows() const { return num_rows_; }
  int stride() const { return stride_; }

  Vec3 get(int i) const { return values.get(index(i)); }
  void set(int i, const Vec3& value) { values.set(index(i), value); }

  Vec3Array values;

 private:
  int first_ = 0;       // index of particle 0
  int row_length_ = 1;  // particles per row
  int num_rows_ = 0;
  int stride_ = 1;  // from one row to the next
};

/// Step, damping and external forces.
struct IncrementSettings {
  float step = 0;                    // h [s]
  float damping = 0;                 // b of every spring [N·s/m]; may be negative (the paper's printed sign)
  bool projected = true;             // damping along the springs only
  float stiffness_damping = 0;       // τ: adds τ k_ij (v_j − v_i), the h·H·v of implicit Euler [s]
  Vec3 acceleration = Vec3::Zero();  // uniform: gravity [m/s²]
  float wind_rate = 0;               // c_w / density: wind adds wind_rate (v_wind − v) [1/s]
  Vec3 wind_velocity = Vec3::Zero();  // [m/s]
};

/// u_i = h w_i F_i [m/s] with F_i = Σ_j (elastic + damping) + m_i (acceleration + wind): a velocity
/// increment. `mass` and `weight` (w, in 1/kg) have num_particles + Vec3Array::kPadding elements.
void compute_increments(const ClothModel& model, const ClothState& state, const IncrementSettings& settings,
                        const std::vector<float>& mass, const std::vector<float>& weight, JobSystem& jobs,
                        IncrementField& u);

/// v += u + g_step, then x += h v. The end of an explicit step.
void apply_increments(const IncrementField& u, float step, const Vec3& g_step, JobSystem& jobs,
                      ClothState& state);

/// Velocity changes outside the filter: v becomes drag_factor · v + velocity_gain.
struct Outside {
  float drag_factor = 1;              // [1]
  Vec3 velocity_gain = Vec3::Zero();  // [m/s]
};

/// v_i ← drag_factor v_i + velocity_gain + u_i + h² w_i Σ_j k_ij u_j, then x += h v. The second sweep of the
/// paper's Eq. 16.
void apply_filtered_increments(const ClothModel& model, const IncrementField& u, float step,
                               const std::vector<float>& weight, const Outside& outside, JobSystem& jobs,
                               ClothState& state);

/// A per-particle quantity in the kernels' layout: floats, padded with zeros.
std::vector<float> to_padded_floats(const std::vector<double>& values);

}  // namespace weft::engine
