#include "weft/lab/study.h"

#include <cmath>
#include <cstdio>

#include "weft/lab/fabric_studies.h"

namespace weft {
namespace {

std::string row_of(const std::vector<std::string>& cells) {
  std::string row = "|";
  for (const std::string& cell : cells) row += " " + cell + " |";
  return row + "\n";
}

std::string markdown(const StudyTable& table) {
  std::string text = "\n" + table.title + "\n\n" + row_of(table.columns) + "|";
  for (std::size_t c = 0; c < table.columns.size(); ++c) text += c == 0 ? "---|" : "--:|";
  text += "\n";
  for (const std::vector<std::string>& row : table.rows) text += row_of(row);
  return text;
}

/// The figures as one more table.
StudyTable table_of(const std::vector<Figure>& figures) {
  StudyTable table{"Figures", {"figure", "value", "unit", "expected", "tolerance", ""}, {}};
  for (const Figure& f : figures) {
    const auto or_nothing = [&](double value) { return f.expected ? digits(value, 4) : ""; };
    table.rows.push_back({f.name, digits(f.value, 5), f.unit == "1" ? "" : f.unit,
                          or_nothing(f.expected.value_or(0)), or_nothing(f.tolerance),
                          !f.expected ? "" : (f.is_as_expected() ? "met" : "**missed**")});
  }
  return table;
}

}  // namespace

bool Figure::is_as_expected() const { return !expected || std::abs(value - *expected) <= tolerance; }

std::string digits(double value, int significant) {
  char buffer[48];
  std::snprintf(buffer, sizeof buffer, "%.*g", significant, value);
  return buffer;
}

std::string to_markdown(const Study& study, const StudyResult& result) {
  std::string text = "## " + study.name + "\n\n" + study.about + "\n";
  for (const StudyTable& table : result.tables) text += markdown(table);
  if (!result.figures.empty()) text += markdown(table_of(result.figures));
  for (const StudyPlot& plot : result.plots) text += "\n![" + plot.title + "](" + plot.file + ".svg)\n";
  for (const std::string& warning : result.warnings) text += "\nWarning: " + warning + "\n";
  return text;
}

const std::vector<Study>& all_studies() {
  static const std::vector<Study> studies = {
      {"fabric_constants", "fabric",
       "stretch and shear stiffness, given back by laboratory tests on two meshes", study_fabric_constants},
      {"fabric_cantilever", "fabric", "strips that sink under their own weight, against the elastica",
       study_fabric_cantilever},
      {"fabric_drape", "fabric", "drape coefficient over the resolution of the mesh, and of several fabrics",
       study_fabric_drape},
      {"fabric_meshes", "fabric", "one fabric on five meshes: drape, sag and swing", study_fabric_meshes},
      {"fabric_strain_limit", "fabric", "how far cloth with a strain limit stretches, over its resolution",
       study_fabric_strain_limit},
      {"fabric_steps", "fabric", "one fabric at 60, 120 and 240 steps per second", study_fabric_steps},
  };
  return studies;
}

}  // namespace weft
