/// Section "fabric": a hypothesis holds if its metrics are as expected.

#include "lab/report/sections.h"
#include "lab/textile/fabric_hypotheses.h"

namespace weft::engine::lab {
namespace {

struct FabricHypothesis {
  const char* title;
  Findings (*test)(const SectionOptions&);
};

constexpr FabricHypothesis kHypotheses[] = {
    {"Laboratory tests measure the given stiffness", fabric_constants},
    {"Strips bend like the elastica", fabric_cantilever},
    {"The drape coefficient converges with the mesh", fabric_drape},
    {"The presets in the drape test", fabric_drapes},
    {"Stiff membranes do not lock", fabric_locking},
    {"One fabric behaves the same on five meshes", fabric_meshes},
    {"One fabric behaves the same at every step length", fabric_steps},
    {"A strain limit holds at any resolution", fabric_strain_limit},
};

std::string words_for(const Metric& metric) {
  if (!metric.expected) return "";
  return digits(*metric.expected, 4) + " ± " + digits(metric.allowed, 3) +
         (metric.is_as_expected() ? "" : ", **missed**");
}

Verdict verdict_of(const std::vector<Metric>& metrics) {
  int expected = 0, met = 0;
  for (const Metric& m : metrics) {
    expected += m.expected.has_value();
    met += m.expected && m.is_as_expected();
  }
  if (expected == 0) return Verdict::finding;
  if (met == expected) return Verdict::holds;
  return met == 0 ? Verdict::fails : Verdict::holds_in_part;
}

/// Draws the specimens; without a painter they are omitted.
std::vector<ReportPicture> paint(std::vector<ReportPicture> pictures, const SectionOptions& options) {
  std::vector<ReportPicture> painted;
  for (ReportPicture& picture : pictures) {
    if (picture.animation) {
      if (!options.paint) continue;
      const std::string file = "fabric_" + picture.file + ".jpg";
      options.paint(file, *picture.animation, {0}, nullptr);
      picture = {file, "A specimen."};
    }
    painted.push_back(std::move(picture));
  }
  return painted;
}

Hypothesis test(const FabricHypothesis& tested, const SectionOptions& options) {
  Hypothesis hypothesis{.title = tested.title, .source = "Weft", .found = tested.test(options)};
  Findings& found = hypothesis.found;
  hypothesis.verdict = verdict_of(found.metrics);
  for (const std::string& warning : found.warnings) hypothesis.text.push_back("Warning: " + warning + ".");
  for (Metric& metric : found.metrics) metric.aim = words_for(metric);
  found.pictures = paint(std::move(found.pictures), options);
  return hypothesis;
}

}  // namespace

Section study_fabric(const SectionOptions& options) {
  Section section{.name = "fabric",
                  .title = "Fabrics",
                  .introduction =
                      "A fabric in SI units on several meshes and with several step lengths, measured by "
                      "standard laboratory tests. `weft study cantilever`, `tensile`, `shear`, `drape` and "
                      "`buckling` run one test on any fabric."};
  for (const FabricHypothesis& hypothesis : kHypotheses)
    section.hypotheses.push_back(test(hypothesis, options));
  return section;
}

}  // namespace weft::engine::lab
