/// The list of studies, and how what comes out of them is shown.

#include "weft/lab/study.h"

#include <gtest/gtest.h>

#include <set>

namespace weft {
namespace {

TEST(Study, EveryOneHasANameOfItsOwnAGroupAndOneLine) {
  std::set<std::string> names;
  for (const Study& study : all_studies()) {
    EXPECT_TRUE(names.insert(study.name).second) << study.name << " comes twice";
    EXPECT_FALSE(study.group.empty());
    EXPECT_FALSE(study.about.empty());
    EXPECT_EQ(study.about.find('\n'), std::string::npos);
  }
}

TEST(Study, FigureIsAsExpectedWithinItsTolerance) {
  EXPECT_TRUE((Figure{"a", 1.5, "%", 0, 2}.is_as_expected()));
  EXPECT_FALSE((Figure{"a", -2.5, "%", 0, 2}.is_as_expected()));
  EXPECT_TRUE((Figure{"a", 7, "%"}.is_as_expected())) << "nothing is expected";
}

TEST(Study, ShowsTablesAndWhatWasMissedInMarkdown) {
  StudyResult result;
  result.tables = {{"Sags", {"mesh", "sag"}, {{"grid", "0.3"}}}};
  result.figures = {{"sag", 0.3, "m", 0.2, 0.05}, {"period", 1.7, "s", 1.7, 0.01}};
  const std::string text = to_markdown({"hung", "fabric", "how far it sags", {}}, result);
  EXPECT_NE(text.find("| mesh | sag |\n|---|--:|\n| grid | 0.3 |\n"), std::string::npos) << text;
  EXPECT_NE(text.find("| sag | 0.3 | m | 0.2 | 0.05 | **missed** |"), std::string::npos) << text;
  EXPECT_NE(text.find("| period | 1.7 | s | 1.7 | 0.01 | met |"), std::string::npos) << text;
}

TEST(Study, DrawsEveryPointOfItsCurvesAndSafeText) {
  StudyPlot plot{"p", "a < b", "x", "y", {{"one", {{0, 1}, {2, 3}}}}, {{"two", {{1, 2}}}}};
  const std::string svg = to_svg(plot);
  std::size_t marks = 0;
  for (std::size_t at = 0; (at = svg.find("r=\"3\"", at)) != std::string::npos; ++at) ++marks;
  EXPECT_EQ(marks, 3u);
  EXPECT_NE(svg.find("a &lt; b"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_NE(to_svg(StudyPlot{}).find("<svg"), std::string::npos) << "without a point";
}

}  // namespace
}  // namespace weft
