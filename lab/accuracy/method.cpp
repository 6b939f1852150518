#include "lab/accuracy/method.h"

#include "lab/accuracy/reference.h"

namespace weft::engine::lab {
namespace {

class IntegratorContestant final : public Method {
 public:
  IntegratorContestant(const MethodSettings& entry, const HungCloth& cloth)
      : cloth_(cloth),
        integrator_(make_integrator(entry.settings)),
        jobs_(make_serial_jobs()),
        num_steps_(entry.steps_per_frame) {
    num_steps_ *= integrator_->num_substeps(*cloth.model, cloth.environment, kReferenceFrame / num_steps_);
  }

  void advance_frame() override {
    for (int s = 0; s < num_steps_; ++s)
      integrator_->advance(*cloth_.model, cloth_.environment, kReferenceFrame / num_steps_, *jobs_,
                           cloth_.state);
  }

  const ClothState& state() override { return cloth_.state; }

 private:
  HungCloth cloth_;
  std::unique_ptr<Integrator> integrator_;
  std::unique_ptr<JobSystem> jobs_;
  int num_steps_;
};

}  // namespace

std::vector<MethodSettings> list_integrator_entries() {
  constexpr int kMedium = 130 * 130, kSmall = 65 * 65;
  std::vector<MethodSettings> entries;
  const auto add = [&](const std::string& name, const std::string& setting, int steps, int most = 1 << 20) {
    entries.push_back({name, setting, {.integrator = name}, steps, most});
    return &entries.back().settings;
  };
  const auto words = [](int n, const char* what) { return std::to_string(n) + " " + what; };

  for (const int n : {5, 10, 20, 40}) add("newton", words(n, "CG"), 1)->newton.iterations = n;
  add("newton", "fast", 1)->newton.quality = NewtonQuality::fast;
  add("newton", "default", 1);
  add("newton", "default, 2 steps", 2);
  add("newton", "high", 1)->newton.quality = NewtonQuality::high;
  add("newton", "high, 4 steps", 4)->newton.quality = NewtonQuality::high;
  for (const int n : {25, 50, 100, 200, 400, 800}) add("xpbd", words(n, "substeps"), 1)->xpbd.substeps = n;
  add("explicit", "half the limit", 1);
  for (const int n : {10, 100, 300, 1000}) add("paper", words(n, "steps"), n);
  for (const int n : {30, 100, 300, 1000}) add("paper_fixed", words(n, "steps"), n);
  for (const int n : {1, 4}) add("desbrun", words(n, n == 1 ? "step" : "steps"), n, kMedium);
  for (const int n : {1, 4}) add("implicit_euler", words(n, n == 1 ? "step" : "steps"), n, kSmall);
  return entries;
}

std::unique_ptr<Method> make_integrator_method(const MethodSettings& entry, const HungCloth& cloth) {
  return std::make_unique<IntegratorContestant>(entry, cloth);
}

}  // namespace weft::engine::lab
