/// `weft study`: the committed report must stay up to date.

#include <cmath>
#include <map>
#include <regex>
#include <sstream>

#include "tests/app/program.h"

namespace weft::engine {
namespace {

class Study : public App {};

/// The values of rows "| `name` | 0.1235 m | … |" of a report.
std::map<std::string, double> read_figures(const std::string& report) {
  static const std::regex kRow(R"(\| `([a-z0-9_]+)` \| ([-+.e0-9]+)[^|]*\|[^|]*\|)");
  std::map<std::string, double> figures;
  std::istringstream lines(report);
  std::smatch match;
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_match(line, match, kRow)) figures[match[1]] = std::stod(match[2]);
  }
  return figures;
}

TEST_F(Study, QuickFindsWhatTheCommittedReportSays) {
  const Finished done = shell("weft study all --quick --out study --cache cache --json");
  ASSERT_EQ(done.exit_code, 0) << done.err;
  const auto json = nlohmann::json::parse(done.out);
  const std::map<std::string, double> committed =
      read_figures(read_text(fs::path(WEFT_SOURCE_DIR) / "docs/study/study.md"));
  int held = 0;
  for (const auto& chapter : json.at("chapters")) {
    for (const auto& claim : chapter.at("claims")) {
      for (const auto& figure : claim.at("figures")) {
        const std::string name = figure.at("name");
        ASSERT_EQ(committed.count(name), 1)
            << name << " is not in docs/study/study.md; run tools/make_study.sh";
        const double tolerance = figure.at("tolerance");
        if (tolerance == 0) continue;
        ++held;
        const double rounding = 1e-3 * std::abs(committed.at(name));  // of the four printed digits
        EXPECT_NEAR(figure.at("value"), committed.at(name), tolerance + rounding)
            << name << " in " << claim.at("title");
      }
    }
  }
  EXPECT_GE(held, 12);
  const std::string page = read_text("study/study.html");
  for (const auto& chapter : json.at("chapters")) EXPECT_TRUE(contains(page, chapter.at("title")));

  // Stopped and called again, it resumes; on request, it restarts.
  EXPECT_TRUE(contains(shell("weft study all --quick --out study").err, "kept from an earlier run"));
  EXPECT_TRUE(contains(shell("weft study all --quick --out study --only papre").err, "--only"));
}

TEST_F(Study, OfOneChapterPrintsItsReport) {
  std::ofstream(fs::path("notes.json")) << "{}";
  expect_bad_input(
      "mkdir -p out && cp notes.json out/paper.json && weft study all --only paper --quick --out out",
      "out/paper.json: not a section");
}

}  // namespace
}  // namespace weft::engine
