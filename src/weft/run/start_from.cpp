#include "weft/run/start_from.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "weft/core/hash.h"
#include "weft/error.h"
#include "weft/run/past_run.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

constexpr const char* kLast = "last";
constexpr std::size_t kMaxDigits = 9;  // of a frame's number

std::vector<Vec3> read_positions(PointCacheReader& cache, int frame) {
  const std::vector<float> numbers = cache.frame(frame);
  std::vector<Vec3> positions;
  for (std::size_t k = 0; k < numbers.size(); k += 3)
    positions.emplace_back(numbers[k], numbers[k + 1], numbers[k + 2]);
  return positions;
}

/// See read_start().
std::vector<Vec3> find_velocities(PointCacheReader& cache, int frame, double fps) {
  const int back = frame > 0 ? 1 : -1, num_frames = cache.num_frames();
  const auto is_there = [&](int k) { return k >= 0 && k < num_frames; };
  const std::vector<Vec3> now = read_positions(cache, frame);
  std::vector<Vec3> velocities(now.size(), Vec3::Zero());
  if (!is_there(frame - back)) return velocities;
  const std::vector<Vec3> one = read_positions(cache, frame - back),
                          two = is_there(frame - 2 * back) ? read_positions(cache, frame - 2 * back)
                                                           : std::vector<Vec3>();
  const double rate = back * fps;
  for (std::size_t v = 0; v < now.size(); ++v) {
    velocities[v] = rate * (now[v] - one[v]);
    if (two.empty()) continue;
    Vec3 change = 0.5 * (velocities[v] - rate * (one[v] - two[v]));
    const double most = velocities[v].norm(), length = change.norm();
    if (length > most) change *= most / length;
    velocities[v] += change;
  }
  return velocities;
}

int find_last_frame(const PastRun& run, std::vector<std::unique_ptr<PointCacheReader>>& caches) {
  int count = std::numeric_limits<int>::max();
  for (const PastCloth& cloth : run.cloths) {
    caches.push_back(open_cache(run, cloth));
    count = std::min(count, caches.back()->num_frames());
  }
  if (count == 0) throw InputError(run.folder.string() + " has no frame yet");
  return count - 1;
}

}  // namespace

StartFrom parse_start_from(const std::string& text) {
  const std::size_t at = text.rfind('@'), slash = text.rfind('/');
  const bool has_frame = at != std::string::npos && (slash == std::string::npos || slash < at);
  if (!has_frame || fs::is_directory(text)) return {text, {}};
  const std::string frame = text.substr(at + 1);
  const bool is_number = !frame.empty() && frame.size() <= kMaxDigits &&
                         frame.find_first_not_of("0123456789") == std::string::npos;
  if (at == 0 || (!is_number && frame != kLast))
    throw InputError("start_from " + text + ": expected DIR@FRAME, with a number or \"last\" as FRAME");
  return {text.substr(0, at), is_number ? std::optional(std::stoi(frame)) : std::nullopt};
}

std::string to_text(const StartFrom& from) {
  fs::path folder = fs::absolute(from.folder).lexically_normal();
  if (!folder.has_filename()) folder = folder.parent_path();
  return folder.string() + '@' + (from.frame ? std::to_string(*from.frame) : kLast);
}

SceneStart read_start(const StartFrom& from) {
  const PastRun run = read_past_run(from.folder);
  std::vector<std::unique_ptr<PointCacheReader>> caches;
  const int last = find_last_frame(run, caches), frame = from.frame.value_or(last);
  if (frame > last)
    throw InputError(from.folder.string() + " has the frames 0 to " + std::to_string(last) +
                     "; a scene cannot start from frame " + std::to_string(frame));
  SceneStart start{.source = "frame " + std::to_string(frame) + " of " + from.folder.string(), .cloths = {}};
  for (std::size_t c = 0; c < caches.size(); ++c)
    start.cloths.push_back(
        {run.cloths[c].name, read_positions(*caches[c], frame), find_velocities(*caches[c], frame, run.fps)});
  return start;
}

std::uint64_t hash_of(const SceneStart& start) {
  Hash hash;
  for (const ClothStart& cloth : start.cloths) {
    hash.add(std::span<const char>(cloth.cloth));
    for (const auto* vectors : {&cloth.positions, &cloth.velocities}) {
      for (const Vec3& vector : *vectors) {
        for (const double number : vector) hash.add(number);
      }
    }
  }
  return hash.value();
}

}  // namespace weft::engine
