/// `weft study paper`, `accuracy`, … and `all`: sections of the study, and their report.

#include <fmt/core.h>

#include <fstream>
#include <iterator>
#include <memory>
#include <optional>

#include "apps/common/command_line.h"
#include "lab/comparisons/peers.h"
#include "lab/program/commands.h"
#include "lab/report/sections.h"
#include "weft/core/make_folder.h"
#include "weft/core/simd.h"
#include "weft/core/staged_file.h"
#include "weft/core/version.h"
#include "weft/error.h"
#include "weft/pictures/painter.h"
#include "weft/render/device.h"
#include "weft/run/stopwatch.h"

namespace weft::engine::lab {
namespace {

using namespace app;

namespace fs = std::filesystem;

struct SectionCommand {
  std::string name, about;
  Section (*study)(const SectionOptions&);
  double usual_seconds, usual_quick_seconds;  // for estimates of the remaining time
};

const std::vector<SectionCommand>& section_commands() {
  static const std::vector<SectionCommand> commands = {
      {"paper", "The paper's claims, and its errata", study_paper, 240, 30},
      {"accuracy", "Error against time of every integrator", study_accuracy, 600, 40},
      {"contact", "Intersections, friction, rest and momentum", study_contact, 900, 60},
      {"fabric", "One fabric on several meshes and with several steps", study_fabric, 600, 40},
      {"peers", "The same cloth in other engines", study_peers, 300, 90},
  };
  return commands;
}

struct ReportOptions {
  fs::path out, cache;
  bool quick = false, json = false, fresh = false;
  std::vector<std::string> only;
};

std::string read_text(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void paint(const fs::path& file, const Animation& animation, const std::vector<int>& frames,
           const std::shared_ptr<const ClothTopology>& springs) {
  PaintSettings settings{.size = {480, 360}};
  if (springs) {
    settings.view.elevation_deg = 70;
    settings.style.springs = {{0, springs}};
  }
  FramesInMemory source(animation);
  Painter painter(source, settings, make_offscreen_device());
  painter.write_pictures(file, frames, static_cast<int>(frames.size()));
}

SectionOptions section_options(const ReportOptions& options) {
  SectionOptions section{.quick = options.quick, .threads = num_processors(), .cache = options.cache};
  section.say = [](const std::string& words) { say("  " + words); };
  if (!options.out.empty()) {
    section.paint = [folder = options.out](const std::string& file, const Animation& animation,
                                           const std::vector<int>& frames, const auto& springs) {
      paint(folder / file, animation, frames, springs);
    };
  }
  return section;
}

/// A general description, without machine names.
std::string describe_machine() {
  return fmt::format("a machine with {} processors and {} instructions", num_processors(),
                     to_string(simd_level()));
}

Report make_report(std::vector<Section> sections) {
  return {.version = kVersion, .machine = describe_machine(), .sections = std::move(sections)};
}

Section run_study(const SectionCommand& command, const ReportOptions& options) {
  Stopwatch watch;
  watch.start();
  Section section = command.study(section_options(options));
  section.version = kVersion;
  section.is_quick = options.quick;
  section.seconds = watch.stop();
  return section;
}

void write_plots(const fs::path& folder, const Section& section) {
  for (const Hypothesis& hypothesis : section.hypotheses) {
    for (const ReportPicture& picture : hypothesis.found.pictures) {
      if (!picture.svg.empty()) write_file(folder / picture.file, picture.svg);
    }
  }
}

/// Writes NAME.json and its plots.
void write_section(const fs::path& folder, const Section& section) {
  write_plots(folder, section);
  write_file(folder / (section.name + ".json"), to_json(section));
}

void write_report(const fs::path& folder, const Report& report) {
  write_file(folder / "study.md", to_markdown(report, "."));
  write_file(folder / "study.html", to_html(report, folder));
}

/// With --json only one object on standard output.
void run_section(const SectionCommand& command, const ReportOptions& options) {
  if (!options.out.empty()) make_folder(options.out);
  const Section section = run_study(command, options);
  const Report report = make_report({section});
  if (!options.out.empty()) {
    write_section(options.out, section);
    write_report(options.out, report);
  }
  fmt::print("{}", options.json ? to_json(section) : to_markdown(report, "."));
}

/// The section from an earlier run in the folder, if version and quick setting are the same.
std::optional<Section> find_section(const SectionCommand& command, const ReportOptions& options) {
  const fs::path file = options.out / (command.name + ".json");
  if (options.fresh || !fs::exists(file)) return std::nullopt;
  Section section = section_from_json(read_text(file), file.string());
  if (section.is_quick != options.quick || section.version != kVersion) return std::nullopt;
  return section;
}

std::vector<SectionCommand> choose_sections(const std::vector<std::string>& only) {
  if (only.empty()) return section_commands();
  std::vector<SectionCommand> chosen;
  for (const SectionCommand& command : section_commands()) {
    if (std::find(only.begin(), only.end(), command.name) != only.end()) chosen.push_back(command);
  }
  return chosen;
}

double usual_seconds(const SectionCommand& command, bool quick) {
  return quick ? command.usual_quick_seconds : command.usual_seconds;
}

void run_all(const ReportOptions& options) {
  make_folder(options.out);
  const std::vector<SectionCommand> commands = choose_sections(options.only);
  double left = 0, usual = 0, spent = 0;
  for (const SectionCommand& command : commands) left += usual_seconds(command, options.quick);
  std::vector<Section> sections;
  for (const SectionCommand& command : commands) {
    const double pace = usual > 0 ? spent / usual : 1;
    if (const auto kept = find_section(command, options)) {
      say(command.name + ": kept from an earlier run (--fresh runs it again)");
      sections.push_back(*kept);
    } else {
      say(fmt::format("{}: section {} of {}, about {:.0f} s left", command.name, sections.size() + 1,
                      commands.size(), pace * left));
      sections.push_back(run_study(command, options));
      write_section(options.out, sections.back());
      usual += usual_seconds(command, options.quick);
      spent += sections.back().seconds;
    }
    left -= usual_seconds(command, options.quick);
  }
  const Report report = make_report(std::move(sections));
  write_report(options.out, report);
  if (options.json) {
    fmt::print("{}", to_json(report));
  } else {
    fmt::print("{}", summary(report));
    fmt::print("\n{} and study.md\n", (options.out / "study.html").string());
  }
}

void add_options(CLI::App& command, const std::shared_ptr<ReportOptions>& options) {
  command.add_flag("--quick", options->quick, "Smaller cloths and fewer settings");
  command.add_flag("--json", options->json, "Print one JSON object");
  command.add_option("--cache", options->cache,
                     "Folder where references are kept (default: $XDG_CACHE_HOME/weft or ~/.cache/weft)");
}

}  // namespace

void add_section_commands(CLI::App& studies) {
  std::vector<std::string> names;
  for (const SectionCommand& section : section_commands()) {
    names.push_back(section.name);
    const auto options = std::make_shared<ReportOptions>();
    CLI::App* command = studies.add_subcommand(section.name, section.about);
    add_options(*command, options);
    command->add_option("--out", options->out, "A folder for study.md, study.html, pictures and results")
        ->type_name("DIR");
    command->callback([&section, options] { run_section(section, *options); });
  }
  const auto options = std::make_shared<ReportOptions>();
  CLI::App* all = studies.add_subcommand("all", "All sections, and their report; resumes an interrupted run");
  add_options(*all, options);
  options->out = "out/study";
  all->add_option("--out", options->out, "Folder of the report")->type_name("DIR")->capture_default_str();
  all->add_option("--only", options->only, "Names of sections")->delimiter(',')->check(CLI::IsMember(names));
  all->add_flag("--fresh", options->fresh, "Repeat the sections of an earlier run");
  all->callback([options] { run_all(*options); });
}

}  // namespace weft::engine::lab
