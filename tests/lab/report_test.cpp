/// Reports of studies: nothing may be lost on the way to a file, and nothing break a page.

#include "lab/report/report.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "lab/report/plot.h"
#include "lab/report/report.h"
#include "weft/error.h"

namespace weft::engine::lab {
namespace {

Section example() {
  const Hypothesis hypothesis{
      .title = "Cloth < steel",
      .source = "nobody",
      .verdict = Verdict::holds_in_part,
      .text = {"With `code` and **weight** & <care>."},
      .found = {.metrics = {{"stretch", 0.1234567, "m", "0", 0.01}, {"count", 3, "1", "", 0}},
                .tables = {{{"cloth", "mm"}, {{"silk", "1.5"}, {"denim", "2.5"}}}},
                .pictures = {{"plot.svg", "A plot.", "<svg xmlns=\"http://www.w3.org/2000/svg\"></svg>"},
                             {"photo.jpg", "A picture.", ""}}}};
  return {.name = "example",
          .title = "An example",
          .introduction = "Of a chapter.",
          .version = "1.2.3",
          .is_quick = true,
          .seconds = 4,
          .hypotheses = {hypothesis}};
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(Metric, IsAsExpectedWithinItsTolerance) {
  EXPECT_TRUE(expect("a", 1.5, "%", 0, 2).is_as_expected());
  EXPECT_FALSE(expect("a", -2.5, "%", 0, 2).is_as_expected());
  EXPECT_TRUE((Metric{"a", 7, "%"}.is_as_expected())) << "nothing is expected";
}

TEST(Section, ComesBackFromJsonAsItWas) {
  const Section back = section_from_json(to_json(example()), "example.json");
  EXPECT_EQ(to_json(back), to_json(example()));
  EXPECT_EQ(back.hypotheses.at(0).verdict, Verdict::holds_in_part);
  EXPECT_EQ(back.hypotheses.at(0).found.metrics.at(0).value, 0.1234567);
  EXPECT_EQ(back.hypotheses.at(0).found.tables.at(0).rows.at(1).at(1), "2.5");
}

TEST(Section, RefusesWhatIsNoChapterByItsName) {
  for (const char* text : {"", "{}", "[1, 2]", "{\"study\": 7}"}) {
    try {
      section_from_json(text, "notes.json");
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_TRUE(contains(error.what(), "notes.json")) << error.what();
    }
  }
}

TEST(Section, TellsEveryClaimFigureAndCommandInMarkdown) {
  const std::string text = to_markdown({"1.2.3", "a machine", {example()}}, "study");
  for (const char* part :
       {"| Cloth < steel | nobody | holds in part |", "`weft study example --quick`",
        "| `stretch` | 0.1235 m | 0 |", "| denim | 2.5 |", "![A plot.](study/plot.svg)", "1.2.3"}) {
    EXPECT_TRUE(contains(text, part)) << part << "\n" << text;
  }
}

TEST(Section, IsOnePageWithNothingOutsideIt) {
  const std::filesystem::path folder = std::filesystem::path(WEFT_OUTPUT_DIR) / "page";
  std::filesystem::create_directories(folder);
  std::filesystem::remove(folder / "photo.jpg");
  const Report report{"1.2.3", "a machine", {example()}};
  EXPECT_THROW(to_html(report, folder), InputError) << "the picture is missing";
  std::ofstream(folder / "photo.jpg") << "Man";
  const std::string page = to_html(report, folder);
  EXPECT_TRUE(contains(page, "<h3>Cloth &lt; steel</h3>"));
  EXPECT_TRUE(contains(page, "<code>code</code> and <strong>weight</strong> &amp; &lt;care&gt;"));
  EXPECT_TRUE(contains(page, "data:image/jpeg;base64,TWFu\"")) << "RFC 4648";
  EXPECT_TRUE(contains(page, "<svg xmlns"));
  EXPECT_FALSE(contains(page, "src=\"http"));
  EXPECT_FALSE(contains(page, "<script"));
}

TEST(Plot, DrawsEveryPointAndSafeText) {
  const Plot plot{
      .x_title = "x", .y_title = "y", .panels = {{"a < b", {{"one", {{1, 1}, {2, 3}}}, {"two", {{1, 2}}}}}}};
  const std::string svg = to_svg(plot);
  std::size_t dots = 0;
  for (std::size_t at = 0; (at = svg.find("r=\"3.5\"", at)) != std::string::npos; ++at) ++dots;
  EXPECT_EQ(dots, 3u);
  EXPECT_TRUE(contains(svg, "a &lt; b"));
  EXPECT_FALSE(contains(svg, "nan"));
  const std::string empty = to_svg({.x_title = "x", .y_title = "y", .panels = {{"nothing", {}}}});
  EXPECT_TRUE(contains(empty, "<svg"));
  EXPECT_FALSE(contains(empty, "nan") || contains(empty, "inf")) << "without a point";
}

TEST(Plot, PutsNumbersAtRoundPlacesOfLinearAxes) {
  Plot plot{.x_title = "x", .y_title = "y", .panels = {{"", {{"a", {{0, -3}, {4.3, 17}}}}}}};
  plot.x_scale = plot.y_scale = PlotScale::linear;
  const std::string svg = to_svg(plot);
  for (const char* tick : {">-5<", ">0<", ">15<", ">20<", ">1<", ">5<"})
    EXPECT_TRUE(contains(svg, tick)) << tick;
}

}  // namespace
}  // namespace weft::engine::lab
