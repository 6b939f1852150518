#include "lab/accuracy/frontier.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <optional>

#include "lab/accuracy/measure_method.h"
#include "lab/comparisons/bullet.h"
#include "lab/report/plot.h"
#include "weft/core/simd.h"
#include "weft/error.h"

namespace weft::engine::lab {
namespace {

/// Second criterion of equal quality: maximum spring strain, as a multiple of the reference's [1]. Cloth with
/// a small mean error may still have a spike.
constexpr double kEqualStrain = 1.5;

std::unique_ptr<Method> make_contestant(const MethodSettings& entry, const HungCloth& cloth) {
  if (entry.method == "Bullet") return make_bullet_method(entry, cloth);
  return make_integrator_method(entry, cloth);
}

std::vector<MethodSettings> choose_entries(const std::vector<std::string>& methods) {
  std::vector<MethodSettings> all = list_integrator_entries();
  const std::vector<MethodSettings> bullet = list_bullet_entries();
  all.insert(all.end(), bullet.begin(), bullet.end());
  if (methods.empty()) return all;
  std::vector<MethodSettings> chosen;
  for (const std::string& method : methods) {
    const std::size_t before = chosen.size();
    std::copy_if(all.begin(), all.end(), std::back_inserter(chosen),
                 [&](const MethodSettings& e) { return e.method == method; });
    if (chosen.size() == before && method == "Bullet")
      throw InputError("this program was built without Bullet; install libbullet-dev and build it again");
    if (chosen.size() == before)
      make_integrator({.integrator = method});  // throws, with the list of integrators
  }
  return chosen;
}

void print_head(const HungCloth& cloth, const Reference& reference) {
  fmt::print(
      "{}: {} particles; reference: explicit, off by {:.4f} m with half the substeps; strain {:.1f} %\n\n",
      cloth.name, cloth.model->num_particles(), reference.error, 100 * reference.strain);
  fmt::print("| {:<14} | {:<16} | {:>16} | {:>8} | {:>12} |\n", "method", "setting", "CPU ms per frame",
             "error m", "worst strain");
  fmt::print("|---|---|--:|--:|--:|\n");
}

void print(const MethodResult& r) {
  if (r.ok) {
    fmt::print("| {:<14} | {:<16} | {:>16.2f} | {:>8.4f} | {:>10.1f} % |\n", r.method, r.setting, r.cpu_ms,
               r.error, 100 * r.strain);
  } else {
    fmt::print("| {:<14} | {:<16} | {:>42} |\n", r.method, r.setting, "diverges");
  }
  std::fflush(stdout);
}

/// CPU time at equal quality of newton and xpbd, and the ratio.
void print_comparison(const HungCloth& cloth, const std::string& quality,
                      const std::vector<MethodResult>& results, const Objective& objective) {
  const auto newton = find_time("newton", results, objective), xpbd = find_time("xpbd", results, objective);
  fmt::print("\n{}, at {}: ", cloth.name, quality);
  if (newton && xpbd) {
    fmt::print("newton {:.2f} ms, xpbd {:.2f} ms, ratio {:.1f}\n", *newton, *xpbd, *xpbd / *newton);
  } else {
    fmt::print("not reached by both newton and xpbd\n");
  }
}

void print_comparisons(const HungCloth& cloth, const Reference& reference,
                       const std::vector<MethodResult>& results) {
  const Objective by_error = [](const MethodResult& r) { return r.error / kEqualError; };
  const Objective by_strain_too = [&](const MethodResult& r) {
    return std::max(by_error(r), r.strain / (kEqualStrain * reference.strain));
  };
  print_comparison(cloth, fmt::format("an error of {} m", kEqualError), results, by_error);
  print_comparison(cloth, fmt::format("the same and a strain of {} times the reference's", kEqualStrain),
                   results, by_strain_too);
  fmt::print("\n");
}

std::string csv_rows(const HungCloth& cloth, const std::vector<MethodResult>& results) {
  std::string rows;
  for (const MethodResult& r : results) {
    rows += fmt::format("{},{},{},\"{}\",", cloth.name, cloth.model->num_particles(), r.method, r.setting);
    rows += r.ok ? fmt::format("{:.4f},{:.5f},{:.4f}\n", r.cpu_ms, r.error, r.strain) : ",,\n";
  }
  return rows;
}

void write_text(const std::string& text, const std::filesystem::path& file) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw InputError("cannot write " + file.string());
}

std::vector<HungCloth> make_cloths(const FrontierOptions& options) {
  std::vector<HungCloth> cloths;
  for (const int size : options.sizes) cloths.push_back(make_hung_sheet(size, "simplified", {}));
  if (options.rings > 0) cloths.push_back(make_hung_disc(options.rings, {}));
  return cloths;
}

}  // namespace

void bench_frontier(const FrontierOptions& options) {
  const std::vector<MethodSettings> entries = choose_entries(options.methods);
  const auto cache = options.cache.empty() ? default_cache_folder() : options.cache;
  if (!options.out.empty()) std::filesystem::create_directories(options.out);
  fmt::print(
      "SIMD {}, one thread. Processor time of a frame of 1/60 s, mean of {} frames, fastest of a few "
      "runs.\n\n",
      to_string(simd_level()), options.frames);

  std::string csv = "cloth,particles,method,setting,cpu_ms_per_frame,error_m,worst_strain\n";
  Plot plot{"CPU ms per frame", "error, m", kEqualError, {}};
  for (const HungCloth& cloth : make_cloths(options)) {
    const Reference reference = find_reference(
        cloth, options.frames, cache, [](const std::string& words) { fmt::print(stderr, "{}\n", words); });
    print_head(cloth, reference);
    std::vector<MethodResult> results;
    for (const MethodSettings& entry : entries) {
      if (cloth.model->num_particles() > entry.most_particles) continue;
      results.push_back(
          measure_method([&] { return make_contestant(entry, cloth); }, entry, cloth, reference));
      print(results.back());
    }
    print_comparisons(cloth, reference, results);
    csv += csv_rows(cloth, results);
    plot.panels.push_back(make_panel(cloth.name, results));
  }
  if (options.out.empty()) return;
  write_text(csv, options.out / "frontier.csv");
  write_svg(plot, options.out / "frontier.svg");
}

}  // namespace weft::engine::lab
