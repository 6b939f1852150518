#pragma once
/// What a study is and what comes out of it: figures, tables, curves, pictures. `weft study` runs them.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "weft/io/glb_writer.h"

namespace weft {

struct Figure {
  std::string name;  // as standards call it; no other of the study has it
  double value = 0;
  std::string unit;  // "1" for a pure number

  std::optional<double> expected = {};  // empty: there is nothing to compare with
  double tolerance = 0;                 // |value − expected| at most

  bool is_as_expected() const;  // true where nothing is expected
};

/// Rows of text, for people; numbers that programs read are figures.
struct StudyTable {
  std::string title;
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  // as long as `columns` each
};

struct Curve {
  std::string name;
  std::vector<std::pair<double, double>> points;  // by ascending x
};

/// Curves over linear axes.
struct StudyPlot {
  std::string file;                       // "drape": becomes drape.svg
  std::string title, x_title, y_title;    // axes with their units
  std::vector<Curve> curves;              // drawn as lines, with marks
  std::vector<Curve> measured_by_others;  // drawn as marks alone
};

struct StudyPicture {
  std::string file;     // "specimen": becomes specimen.png, and specimen.obj of its first cloth
  Animation animation;  // one frame
};

struct StudyResult {
  std::vector<Figure> figures;
  std::vector<StudyTable> tables;
  std::vector<StudyPlot> plots;
  std::vector<StudyPicture> pictures;
  std::vector<std::string> warnings;
};

struct StudySettings {
  bool quick = false;  // fewer cases and coarser meshes: does it still work, rather than what comes out
  int threads = 1;     // of simulations [1]
  std::function<void(const std::string&)> say = [](const std::string&) {};  // what is being done
};

/// One that needs nothing but to be run: a row of all_studies().
struct Study {
  std::string name;   // "fabric_drape"
  std::string group;  // what `weft study all --only` chooses by
  std::string about;  // one line
  std::function<StudyResult(const StudySettings&)> run;
};

/// Every study of the house, group by group. To add one, add a row.
const std::vector<Study>& all_studies();

/// The study's tables in Markdown, and its figures with what was expected.
std::string to_markdown(const Study& study, const StudyResult& result);

/// The picture of a plot.
std::string to_svg(const StudyPlot& plot);

/// A number as tables show it: so many significant digits.
std::string digits(double value, int significant);

}  // namespace weft
