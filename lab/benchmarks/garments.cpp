#include "lab/benchmarks/garments.h"

#include <fmt/core.h>

#include <algorithm>

#include "tools/wardrobe/wardrobe.h"
#include "weft/error.h"
#include "weft/run/scene_run.h"
#include "weft/scene/scene_reader.h"

namespace weft::engine::lab {
namespace {

bool is_wanted(const std::string& scene, const GarmentBenchOptions& options) {
  const auto any = [](const std::vector<std::string>& parts, const auto& fits) {
    return parts.empty() || std::any_of(parts.begin(), parts.end(), fits);
  };
  return any(options.garments, [&](const std::string& part) { return scene.starts_with(part); }) &&
         any(options.motions, [&](const std::string& part) { return scene.ends_with(part); });
}

double largest(const std::vector<double>& values) {
  return values.empty() ? 1 : *std::max_element(values.begin(), values.end());
}

double least(const std::vector<double>& values) {
  return values.empty() ? 1 : *std::min_element(values.begin(), values.end());
}

double mean(const std::vector<int>& values) {
  double sum = 0;
  for (const int value : values) sum += value;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

/// Returns whether there are no intersections.
bool add_row(const std::string& name, const std::filesystem::path& file, const GarmentBenchOptions& options) {
  RunReport report;
  try {
    report = run_scene(read_scene(file),
                       {.frames = options.frames, .threads = options.threads, .check_passages = false});
  } catch (const InputError& error) {
    std::string why = error.what();
    std::replace(why.begin(), why.end(), '\n', ' ');
    fmt::print("| {} | refused: {} |\n", name, why);
    std::fflush(stdout);
    return false;
  }
  const int crossings = report.intersections.value_or(0);
  fmt::print("| {} | {} | {:.1f} | {} | {:.1f} | {:.1f} | {:.2f} | {} | {:.1f} | {:.0f} | {:.0f} |\n", name,
             report.particles, report.untangle_seconds, crossings, 100 * (largest(report.max_stretch) - 1),
             report.max_stretch.empty() ? 0 : 100 * (report.max_stretch.back() - 1),
             least(report.min_stretch), report.infeasible ? report.infeasible->size() : 0,
             mean(report.divisions), report.cpu_ms_per_frame, report.ms_per_frame_median);
  std::fflush(stdout);
  return crossings == 0;
}

}  // namespace

bool bench_garments(const GarmentBenchOptions& options) {
  const std::filesystem::path folder =
      options.out.empty() ? std::filesystem::temp_directory_path() / "weft_wardrobe" : options.out;
  const std::vector<std::string> scenes = wardrobe::write_wardrobe(folder, options.cell);
  fmt::print(
      "{} frames, {} threads, garments of {:g} mm cells; files in {}\n\n"
      "| scene | particles | repair s | crossings | strain % | at the end | least stretch | infeasible | "
      "parts | CPU ms | wall ms |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n",
      options.frames, options.threads, 1000 * options.cell, folder.string());
  bool is_clean = true;
  for (const std::string& scene : scenes) {
    if (is_wanted(scene, options)) is_clean &= add_row(scene, folder / (scene + ".toml"), options);
  }
  return is_clean;
}

}  // namespace weft::engine::lab
