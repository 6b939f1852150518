/// The studies of fabrics as a chapter: each is a claim, which holds if its figures are as expected.

#include "weft/lab/chapters.h"
#include "weft/lab/fabric_studies.h"

namespace weft::engine {
namespace {

struct FabricStudy {
  const char* claim;
  StudyResult (*run)(const StudySettings&);
};

constexpr FabricStudy kStudies[] = {
    {"Laboratory tests give back the stiffness that was put in", study_fabric_constants},
    {"Strips sink as the elastica does", study_fabric_cantilever},
    {"The drape coefficient converges with the mesh", study_fabric_drape},
    {"One fabric is the same cloth on five meshes", study_fabric_meshes},
    {"One fabric is the same cloth at every step", study_fabric_steps},
    {"A strain limit holds at any resolution", study_fabric_strain_limit},
};

std::string words_for(const Figure& figure) {
  if (!figure.expected) return "";
  return digits(*figure.expected, 4) + " ± " + digits(figure.tolerance, 3) +
         (figure.is_as_expected() ? "" : ", **missed**");
}

Verdict judge(const std::vector<Figure>& figures) {
  int expected = 0, met = 0;
  for (const Figure& f : figures) {
    expected += f.expected.has_value();
    met += f.expected && f.is_as_expected();
  }
  if (expected == 0) return Verdict::finding;
  if (met == expected) return Verdict::holds;
  return met == 0 ? Verdict::fails : Verdict::holds_in_part;
}

Claim make_claim(const FabricStudy& study, const StudyResult& result, const ChapterOptions& options) {
  Claim claim{.title = study.claim, .source = "Weft", .verdict = judge(result.figures)};
  for (const std::string& warning : result.warnings) claim.text.push_back("Warning: " + warning + ".");
  for (const Figure& f : result.figures) claim.figures.push_back({f.name, f.value, f.unit, words_for(f), 0});
  for (const StudyTable& t : result.tables) claim.tables.push_back({t.columns, t.rows, t.title});
  for (const StudyPlot& p : result.plots) claim.pictures.push_back({p.file, p.caption, to_svg(p.plot)});
  for (const StudyPicture& p : result.pictures) {
    if (!options.paint) continue;
    const std::string file = "fabric_" + p.file + ".jpg";
    options.paint(file, p.animation, {0}, nullptr);
    claim.pictures.push_back({file, "A specimen.", ""});
  }
  return claim;
}

}  // namespace

Chapter study_fabric(const ChapterOptions& options) {
  Chapter chapter{.name = "fabric",
                  .title = "Fabrics",
                  .introduction =
                      "What is one fabric in SI units on many meshes and at many steps, by a laboratory's "
                      "own tests (`weft study "
                      "cantilever`, `tensile`, `shear`, `drape`, `buckling` run one test on any fabric)."};
  StudySettings settings{.quick = options.quick, .threads = options.threads};
  if (options.say) settings.say = options.say;
  for (const FabricStudy& study : kStudies)
    chapter.claims.push_back(make_claim(study, study.run(settings), options));
  return chapter;
}

}  // namespace weft::engine
