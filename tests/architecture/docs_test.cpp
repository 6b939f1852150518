/// Links of README and docs have targets, and every page is in the site's list.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const fs::path kRoot = WEFT_SOURCE_DIR;

std::string read_text(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

std::vector<fs::path> pages() {
  std::vector<fs::path> found = {kRoot / "README.md", kRoot / "ARCHITECTURE.md", kRoot / "CONTRIBUTING.md",
                                 kRoot / "CHANGELOG.md", kRoot / "STYLE.md"};
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "docs")) {
    if (entry.path().extension() == ".md") found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end());
  return found;
}

/// The anchor of a heading on GitHub and in mkdocs: lower case, spaces to hyphens, no punctuation.
std::string anchor_of(const std::string& heading) {
  std::string anchor;
  for (const char c : heading) {
    const auto u = static_cast<unsigned char>(c);
    if (std::isalnum(u) || c == '_' || c == '-' || u >= 128) anchor += static_cast<char>(std::tolower(u));
    if (c == ' ') anchor += '-';
  }
  return anchor;
}

std::set<std::string> anchors_of(const fs::path& page) {
  std::set<std::string> anchors;
  std::istringstream lines(read_text(page));
  static const std::regex kHeading("^#+ (.*)$");
  std::smatch match;
  for (std::string line; std::getline(lines, line);) {
    if (std::regex_match(line, match, kHeading)) anchors.insert(anchor_of(match[1]));
  }
  return anchors;
}

TEST(Docs, LinksLeadSomewhere) {
  static const std::regex kLink(R"link(\]\(([^)\s]+)\)|(?:src|href)="([^"]+)")link");
  int links = 0;
  for (const fs::path& page : pages()) {
    const std::string text = read_text(page);
    for (auto it = std::sregex_iterator(text.begin(), text.end(), kLink); it != std::sregex_iterator();
         ++it) {
      const std::string link = (*it)[1].matched ? (*it)[1] : (*it)[2];
      if (link.find("://") != std::string::npos) continue;
      ++links;
      const auto hash = link.find('#');
      const fs::path target = hash == 0 ? page : page.parent_path() / link.substr(0, hash);
      EXPECT_TRUE(fs::exists(target)) << page << " links to " << link;
      if (hash != std::string::npos && target.extension() == ".md") {
        EXPECT_EQ(anchors_of(target).count(link.substr(hash + 1)), 1) << page << " links to " << link;
      }
    }
  }
  EXPECT_GT(links, 40);
}

TEST(Docs, TheSiteListsEveryPage) {
  const std::string site = read_text(kRoot / "mkdocs.yml");
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "docs")) {
    if (entry.path().extension() != ".md") continue;
    const std::string name = entry.path().lexically_relative(kRoot / "docs").generic_string();
    EXPECT_NE(site.find(": " + name), std::string::npos) << name << " is not in mkdocs.yml";
  }
}

}  // namespace
