#pragma once
/// What the frontier compares: something that moves a hung cloth, frame by frame.

#include <memory>
#include <string>
#include <vector>

#include "lab/accuracy/hung_cloth.h"

namespace weft::engine::lab {

class Method {
 public:
  virtual ~Method() = default;

  /// Moves by a sixtieth of a second: this is what is timed.
  virtual void advance_frame() = 0;

  /// Where the cloth is.
  virtual const ClothState& state() = 0;
};

/// A method with one of its settings.
struct MethodSettings {
  std::string method;   // an integrator's name, or another engine's
  std::string setting;  // what was chosen, in words
  IntegratorSettings settings;
  int steps_per_frame = 1;
  int most_particles = 1 << 20;  // larger cloth would take hours
};

/// Every integrator at several settings, from cheap to good.
std::vector<MethodSettings> list_integrator_entries();

/// On one thread.
std::unique_ptr<Method> make_integrator_method(const MethodSettings& entry,
                                                       const HungCloth& cloth);

}  // namespace weft::engine::lab
