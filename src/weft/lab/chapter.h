#pragma once
/// What a study has found, and its three forms: JSON, Markdown, and one page that needs no other file.

#include <filesystem>
#include <string>
#include <vector>

namespace weft::engine {

struct KeyFigure {
  std::string name;  // unique in its chapter, as JSON calls it
  double value = 0;
  std::string unit;      // "1" for a pure number
  std::string aim;       // what it is held against, in words; empty: told for its own sake
  double tolerance = 0;  // by how much another run, quick or full, may differ, in its unit; 0: any
};

struct Table {
  std::vector<std::string> head;
  std::vector<std::vector<std::string>> rows;  // of as many cells as the head
  std::string title = {};
};

struct Figure2d {
  std::string file;  // beside the report; .svg or .jpg
  std::string caption;
  std::string svg;  // the plot itself; empty: the file is painted by whoever runs the study
};

enum class Verdict {
  holds,
  holds_in_part,
  fails,
  finding,  // no claim was made: it is told as it is
};

/// One claim of the paper, or of Weft, and what became of it.
struct Claim {
  std::string title;
  std::string source;  // who says so, and where
  Verdict verdict = Verdict::finding;
  std::vector<std::string> text;  // paragraphs of Markdown: how it was tested, and what came out
  std::vector<KeyFigure> figures;
  std::vector<Table> tables;
  std::vector<Figure2d> pictures;
};

struct Chapter {
  std::string name;  // of the study: `weft study NAME`
  std::string title;
  std::string introduction;
  std::string version;    // of Weft
  bool is_quick = false;  // smaller cloths, fewer settings
  double seconds = 0;     // that it took [s]
  std::vector<Claim> claims;
};

/// A report: chapters, and where they were made.
struct StudyReport {
  std::string version;  // of Weft
  std::string machine;  // in general terms
  std::vector<Chapter> chapters;
};

/// As `"figures": {"name": value, …}`, their units, and every claim with its verdict.
std::string to_json(const Chapter& chapter);

/// As `"chapters": [ … ]`, and where they were made.
std::string to_json(const StudyReport& report);

/// The way back: what to_json() wrote. Throws InputError for anything else.
Chapter chapter_from_json(const std::string& json, const std::string& source);

/// Claims and verdicts, as plain lines.
std::string summary(const StudyReport& report);

/// Pictures are linked by their file names, in the folder `pictures`.
std::string to_markdown(const StudyReport& report, const std::string& pictures);

/// Pictures are read from `folder` and put into the page. Throws InputError if one is missing.
std::string to_html(const StudyReport& report, const std::filesystem::path& folder);

/// `holds`, `holds in part`, `does not hold`, `finding`.
std::string to_string(Verdict verdict);

}  // namespace weft::engine
