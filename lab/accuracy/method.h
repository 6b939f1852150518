#pragma once
/// A method of the comparisons: simulates a hung cloth frame by frame.

#include <memory>
#include <string>
#include <vector>

#include "lab/accuracy/hung_cloth.h"

namespace weft::engine::lab {

class Method {
 public:
  virtual ~Method() = default;

  /// Advances by a sixtieth of a second; only this is timed.
  virtual void advance_frame() = 0;

  /// The current state of the cloth.
  virtual const ClothState& state() = 0;
};

/// A method with one of its settings.
struct MethodSettings {
  std::string method;   // name of an integrator or another engine
  std::string setting;  // as text
  IntegratorSettings settings;
  int steps_per_frame = 1;
  int most_particles = 1 << 20;  // larger cloth takes hours
};

/// Every integrator at several settings, from cheap to accurate.
std::vector<MethodSettings> list_integrator_entries();

/// On one thread.
std::unique_ptr<Method> make_integrator_method(const MethodSettings& entry, const HungCloth& cloth);

}  // namespace weft::engine::lab
