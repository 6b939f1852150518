#include "bench/frontier.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <optional>

#include "bench/bullet.h"
#include "bench/contestant.h"
#include "bench/plot.h"
#include "bench/reference.h"
#include "weft/core/error.h"
#include "weft/core/simd.h"
#include "weft/run/stopwatch.h"
#include "weft/world/measures.h"

namespace weft::bench {
namespace {

/// At which methods are compared: 4 cm in a swing of a metre is hard to see [m].
constexpr double kEqualError = 0.045;

/// Cloth may be where it should and yet show a spike: the largest strain that a spring may have had, as a
/// multiple of the largest in the reference [1].
constexpr double kEqualStrain = 1.5;

constexpr double kLargeError = 10;  // of cloth that has flown apart [m]
constexpr int kMostRuns = 3;        // of which the fastest counts: others may be using the machine …
constexpr double kEnough = 3;       // … but none after so much time [s]

struct Result {
  std::string method, setting;
  double cpu_ms = 0;  // per frame
  double error = 0;   // mean over the frames of the RMS distance [m]
  double strain = 0;  // the largest of all frames [1]
  bool ok = true;     // false: it flew apart
};

std::unique_ptr<Contestant> make_contestant(const Entry& entry, const HungCloth& cloth) {
  if (entry.method == "Bullet") return make_bullet_contestant(entry, cloth);
  return make_integrator_contestant(entry, cloth);
}

/// One run of all frames.
Result run_once(const Entry& entry, const HungCloth& cloth, const Reference& reference) {
  const auto contestant = make_contestant(entry, cloth);
  const auto num_frames = static_cast<double>(reference.frames.size());
  Result result{.method = entry.method, .setting = entry.setting};
  Stopwatch watch;
  for (const auto& frame : reference.frames) {
    watch.start();
    contestant->advance_frame();
    watch.stop();
    const ClothState& state = contestant->state();
    const double distance = distance_from(frame, state);
    result.ok = distance < kLargeError;
    if (!result.ok) return result;
    result.error += distance / num_frames;
    result.strain = std::max(result.strain, compute_strain(*cloth.model, state).max);
  }
  result.cpu_ms = 1000 * watch.cpu_total() / num_frames;
  return result;
}

Result measure(const Entry& entry, const HungCloth& cloth, const Reference& reference) {
  Result best = run_once(entry, cloth, reference);
  const double seconds = best.cpu_ms / 1000 * static_cast<double>(reference.frames.size());
  for (int r = 1; r < kMostRuns && r * seconds < kEnough && best.ok; ++r) {
    best.cpu_ms = std::min(best.cpu_ms, run_once(entry, cloth, reference).cpu_ms);
  }
  return best;
}

std::vector<Entry> choose_entries(const std::vector<std::string>& methods) {
  std::vector<Entry> all = list_integrator_entries();
  const std::vector<Entry> bullet = list_bullet_entries();
  all.insert(all.end(), bullet.begin(), bullet.end());
  if (methods.empty()) return all;
  std::vector<Entry> chosen;
  for (const std::string& method : methods) {
    const std::size_t before = chosen.size();
    std::copy_if(all.begin(), all.end(), std::back_inserter(chosen),
                 [&](const Entry& e) { return e.method == method; });
    if (chosen.size() == before && method == "Bullet")
      throw InputError("this program was built without Bullet; install libbullet-dev and build it again");
    if (chosen.size() == before)
      make_integrator({.integrator = method});  // throws, and names those there are
  }
  return chosen;
}

/// How far a result is from what is asked for: 1 is just as good.
using Misfit = std::function<double(const Result&)>;

/// The results of a method that no cheaper one of it beats, by ascending time.
std::vector<Result> frontier_of(const std::string& method, std::vector<Result> results,
                                const Misfit& misfit) {
  std::erase_if(results, [&](const Result& r) { return r.method != method || !r.ok; });
  std::sort(results.begin(), results.end(),
            [](const Result& a, const Result& b) { return a.cpu_ms < b.cpu_ms; });
  std::vector<Result> front;
  for (const Result& r : results) {
    if (front.empty() || misfit(r) < misfit(front.back())) front.push_back(r);
  }
  return front;
}

/// The processor time at which a method is just as good as asked for, between two settings by straight lines
/// on logarithmic axes; that of its cheapest setting if even this is better; empty if none is as good [ms].
std::optional<double> find_time(const std::string& method, const std::vector<Result>& results,
                                const Misfit& misfit) {
  const std::vector<Result> front = frontier_of(method, results, misfit);
  for (std::size_t i = 0; i < front.size(); ++i) {
    const double now = misfit(front[i]);
    if (now > 1) continue;
    if (i == 0) return front[0].cpu_ms;
    const double before = misfit(front[i - 1]), share = std::log(before) / std::log(before / now);
    return front[i - 1].cpu_ms * std::pow(front[i].cpu_ms / front[i - 1].cpu_ms, share);
  }
  return std::nullopt;
}

void print_head(const HungCloth& cloth, const Reference& reference) {
  fmt::print(
      "{}: {} particles; reference: explicit, off by {:.4f} m with half the substeps; strain {:.1f} %\n\n",
      cloth.name, cloth.model->num_particles(), reference.error, 100 * reference.strain);
  fmt::print("| {:<14} | {:<16} | {:>16} | {:>8} | {:>12} |\n", "method", "setting", "CPU ms per frame",
             "error m", "worst strain");
  fmt::print("|---|---|--:|--:|--:|\n");
}

void print(const Result& r) {
  if (r.ok) {
    fmt::print("| {:<14} | {:<16} | {:>16.2f} | {:>8.4f} | {:>10.1f} % |\n", r.method, r.setting, r.cpu_ms,
               r.error, 100 * r.strain);
  } else {
    fmt::print("| {:<14} | {:<16} | {:>42} |\n", r.method, r.setting, "flies apart");
  }
  std::fflush(stdout);
}

/// CPU time at equal quality: of newton, of xpbd, and how many times as much that is.
void print_comparison(const HungCloth& cloth, const std::string& quality, const std::vector<Result>& results,
                      const Misfit& misfit) {
  const auto newton = find_time("newton", results, misfit), xpbd = find_time("xpbd", results, misfit);
  fmt::print("\n{}, at {}: ", cloth.name, quality);
  if (newton && xpbd) {
    fmt::print("newton {:.2f} ms, xpbd {:.2f} ms, ratio {:.1f}\n", *newton, *xpbd, *xpbd / *newton);
  } else {
    fmt::print("not reached by both newton and xpbd\n");
  }
}

void print_comparisons(const HungCloth& cloth, const Reference& reference,
                       const std::vector<Result>& results) {
  const Misfit by_error = [](const Result& r) { return r.error / kEqualError; };
  const Misfit by_strain_too = [&](const Result& r) {
    return std::max(by_error(r), r.strain / (kEqualStrain * reference.strain));
  };
  print_comparison(cloth, fmt::format("an error of {} m", kEqualError), results, by_error);
  print_comparison(cloth, fmt::format("the same and a strain of {} times the reference's", kEqualStrain),
                   results, by_strain_too);
  fmt::print("\n");
}

PlotPanel make_panel(const HungCloth& cloth, const std::vector<Result>& results) {
  PlotPanel panel{cloth.name, {}};
  for (const Result& r : results) {
    if (!r.ok) continue;
    if (panel.series.empty() || panel.series.back().name != r.method) panel.series.push_back({r.method, {}});
    panel.series.back().points.push_back({r.cpu_ms, r.error, r.method + ", " + r.setting});
  }
  for (PlotSeries& series : panel.series) {
    std::sort(series.points.begin(), series.points.end(),
              [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
  }
  return panel;
}

std::string csv_rows(const HungCloth& cloth, const std::vector<Result>& results) {
  std::string rows;
  for (const Result& r : results) {
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
  const std::vector<Entry> entries = choose_entries(options.methods);
  const auto cache = options.cache.empty() ? default_cache_folder() : options.cache;
  if (!options.out.empty()) std::filesystem::create_directories(options.out);
  fmt::print(
      "SIMD {}, one thread. Processor time of a frame of 1/60 s, mean of {} frames, fastest of up to {} "
      "runs.\n\n",
      to_string(simd_level()), options.frames, kMostRuns);

  std::string csv = "cloth,particles,method,setting,cpu_ms_per_frame,error_m,worst_strain\n";
  Plot plot{"CPU ms per frame", "error, m", kEqualError, {}};
  for (const HungCloth& cloth : make_cloths(options)) {
    const Reference reference = find_reference(cloth, options.frames, cache);
    print_head(cloth, reference);
    std::vector<Result> results;
    for (const Entry& entry : entries) {
      if (cloth.model->num_particles() > entry.most_particles) continue;
      results.push_back(measure(entry, cloth, reference));
      print(results.back());
    }
    print_comparisons(cloth, reference, results);
    csv += csv_rows(cloth, results);
    plot.panels.push_back(make_panel(cloth, results));
  }
  if (options.out.empty()) return;
  write_text(csv, options.out / "frontier.csv");
  write_svg(plot, options.out / "frontier.svg");
}

}  // namespace weft::bench
