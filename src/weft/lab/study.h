#pragma once
/// What comes out of a laboratory's tests and of studies of them: figures, tables, plots, pictures.

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "weft/io/animation.h"
#include "weft/lab/plot.h"

namespace weft::engine {

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

struct StudyPlot {
  std::string file;  // "drape.svg"
  std::string caption;
  Plot plot;
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

/// A number as tables show it: so many significant digits.
std::string digits(double value, int significant);

}  // namespace weft::engine
