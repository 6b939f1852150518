/// Rules of sources: includes only point down, and a source begins with its own header. Motion uses no function whose
/// bits depend on the C library.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>

namespace {

namespace fs = std::filesystem;

/// Allowed includes of each folder of src/weft, besides itself.
const std::map<std::string, std::set<std::string>> kMayInclude = {
    {"core", {}},
    {"geometry", {"core"}},
    {"mesh", {"core", "geometry"}},
    {"fabric", {"core", "mesh"}},
    {"model", {"core", "mesh", "fabric"}},
    {"forces", {"core", "geometry", "mesh", "fabric", "model"}},
    {"solvers", {"core"}},
    {"animation", {"core", "mesh"}},
    {"contact", {"core", "geometry", "mesh", "model", "animation"}},
    {"integrators", {"core", "model", "forces", "solvers", "contact"}},
    {"world",
     {"core", "geometry", "mesh", "fabric", "model", "forces", "solvers", "animation", "contact",
      "integrators"}},
    {"face",
     {"core", "geometry", "mesh", "fabric", "model", "forces", "solvers", "animation", "contact",
      "integrators", "world"}},
    {"verify", {"core", "mesh"}},
    {"io", {"core", "mesh", "animation"}},
    {"scene",
     {"core", "geometry", "mesh", "fabric", "model", "forces", "solvers", "animation", "contact",
      "integrators", "world", "face", "io"}},
    {"run",
     {"core", "geometry", "mesh", "fabric", "model", "forces", "solvers", "animation", "contact",
      "integrators", "world", "face", "verify", "io", "scene"}},
    {"render", {"core", "geometry", "mesh"}},
    {"window", {"core", "geometry", "mesh", "render"}},
    {"pictures",
     {"core", "geometry", "mesh", "fabric", "model", "forces", "solvers", "animation", "contact",
      "integrators", "world", "face", "verify", "io", "scene", "run", "render"}},
};

/// Folders of src/weft from which a file includes.
std::set<std::string> included_folders(const fs::path& file) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*[<"]weft/([a-z_]+)/)");
  std::set<std::string> folders;
  std::ifstream in(file);
  std::smatch match;
  for (std::string line; std::getline(in, line);) {
    if (std::regex_search(line, match, kInclude)) folders.insert(match[1]);
  }
  return folders;
}

TEST(Includes, OnlyPointDown) {
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(WEFT_SOURCE_DIR) / "src/weft")) {
    if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
    const std::string folder = entry.path().parent_path().filename().string();
    ++files;
    ASSERT_TRUE(kMayInclude.contains(folder))
        << "a new folder: give it its place in ARCHITECTURE.md and here";
    for (const std::string& target : included_folders(entry.path())) {
      EXPECT_TRUE(target == folder || kMayInclude.at(folder).contains(target))
          << entry.path() << " includes from " << target << "/, which is not below " << folder << "/";
    }
  }
  EXPECT_GT(files, 40) << "the test must have looked at the sources";
}

/// So a header that needs something it does not include fails to compile there.
TEST(Includes, BeginWithTheSourcesOwnHeader) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*[<"](.*)[>"])");
  const fs::path source_dir = fs::path(WEFT_SOURCE_DIR) / "src";
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(source_dir / "weft")) {
    const fs::path header = fs::path(entry.path()).replace_extension(".h");
    if (entry.path().extension() != ".cpp" || !fs::exists(header)) continue;
    ++files;
    std::ifstream in(entry.path());
    std::smatch match;
    std::string line;
    while (std::getline(in, line) && !std::regex_search(line, match, kInclude)) {
    }
    ASSERT_FALSE(match.empty()) << entry.path();
    EXPECT_EQ(match[1], fs::relative(header, source_dir).string()) << entry.path();
  }
  EXPECT_GT(files, 40) << "the test must have looked at the sources";
}

TEST(Includes, HaveNoCycleInTheRuleItself) {
  // Topological order: repeatedly remove a folder whose allowed includes are all removed.
  auto rest = kMayInclude;
  while (!rest.empty()) {
    const auto bottom = std::find_if(rest.begin(), rest.end(), [&](const auto& folder) {
      return std::none_of(folder.second.begin(), folder.second.end(),
                          [&](const auto& f) { return rest.contains(f); });
    });
    ASSERT_NE(bottom, rest.end());
    rest.erase(bottom);
  }
}

/// Square roots, remainders and the like are exact; those below are not, and C libraries differ in their last bits.
TEST(Arithmetic, OfMotionUsesNoInexactFunctionOfTheCLibrary) {
  static const std::regex kInexact(
      R"(\b(a?sinh?|a?cosh?|a?tanh?|atan2|exp[2m1]*|log(2|10|1p)?|pow|cbrt|hypot|erfc?|[lt]gamma)[fl]?\(|AngleAxis)");
  const std::set<std::string> not_motion = {
      "world/particle_values.cpp", "face/reading.cpp"  // angles for readers
  };
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(WEFT_SOURCE_DIR) / "src/weft")) {
    const std::string folder = entry.path().parent_path().filename().string();
    if (!entry.is_regular_file() || (folder != "face" && !kMayInclude.at("face").contains(folder))) continue;
    if (not_motion.contains(folder + '/' + entry.path().filename().string())) continue;
    ++files;
    std::ifstream in(entry.path());
    for (std::string line; std::getline(in, line);)
      EXPECT_FALSE(std::regex_search(line.substr(0, line.find("//")), kInexact))
          << entry.path() << ": " << line;
  }
  EXPECT_GT(files, 40) << "the test must have looked at the sources";
}

}  // namespace
