#pragma once
/// The report of a study, and its three formats: JSON, Markdown, and one self-contained HTML page.
///
///     Report ── Section ── Hypothesis ── Findings: metrics, tables, pictures
///
/// A laboratory test of a fabric returns Findings; a hypothesis has Findings and a verdict.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "weft/io/animation.h"

namespace weft::engine::lab {

struct Metric {
  std::string name;  // unique in its section; key in JSON
  double value = 0;
  std::string unit;                     // "1" for a pure number
  std::string aim = {};                 // target as text; empty: none
  double tolerance = 0;                 // for the value of another run, quick or full, in its unit; 0: any
  std::optional<double> expected = {};  // empty: no expected value
  double allowed = 0;                   // maximum of |value − expected|

  bool is_as_expected() const;  // true if there is no expected value
};

/// A metric with an expected value.
Metric expect(std::string name, double value, std::string unit, double expected, double allowed);

struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;  // as many cells as in the head
  std::string title = {};
};

struct ReportPicture {
  std::string file;  // beside the report; .svg or .jpg
  std::string caption;
  std::string svg = {};                                  // the plot itself; empty: a painted file
  std::shared_ptr<const Animation> animation = nullptr;  // one frame to paint; null: a plot, or painted
};

struct Findings {
  std::vector<Metric> metrics;
  std::vector<Table> tables;
  std::vector<ReportPicture> pictures;
  std::vector<std::string> warnings;
};

enum class Verdict {
  holds,
  holds_in_part,
  fails,
  finding,  // reported without a verdict
};

/// A hypothesis of the paper, or of Weft, and its test.
struct Hypothesis {
  std::string title;
  std::string source;  // author and place of the statement
  Verdict verdict = Verdict::finding;
  std::vector<std::string> text;  // paragraphs of Markdown: the test and its outcome
  Findings found;
};

struct Section {
  std::string name;  // of the study: `weft study NAME`
  std::string title;
  std::string introduction;
  std::string version;    // of Weft
  bool is_quick = false;  // smaller cloths, fewer settings
  double seconds = 0;     // run time [s]
  std::vector<Hypothesis> hypotheses;
};

struct Report {
  std::string version;  // of Weft
  std::string machine;  // in general terms
  std::vector<Section> sections;
};

/// Metrics as `"figures": {"name": value, …}`, their units, and hypotheses as `"claims"` with their verdicts.
std::string to_json(const Section& section);

/// Sections as `"chapters": [ … ]`, with version and machine.
std::string to_json(const Report& report);

/// Reads the output of to_json(). Throws InputError for anything else.
Section section_from_json(const std::string& json, const std::string& source);

/// Hypotheses and verdicts, one line each.
std::string summary(const Report& report);

/// Pictures are linked by file name, in the folder `pictures`.
std::string to_markdown(const Report& report, const std::string& pictures);

/// Pictures are read from `folder` and embedded. Throws InputError if one is missing.
std::string to_html(const Report& report, const std::filesystem::path& folder);

/// `holds`, `holds in part`, `does not hold`, `finding`.
std::string to_string(Verdict verdict);

/// A number with so many significant digits.
std::string digits(double value, int significant);

}  // namespace weft::engine::lab
