/// Public functions: conversion of files.

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "weft/core/file_name.h"
#include "weft/core/make_folder.h"
#include "weft/error.h"
#include "weft/io.h"
#include "weft/io/gltf_body.h"
#include "weft/io/mesh_files.h"
#include "weft/run/past_run.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

constexpr double kUsualFps = 60;
constexpr double kMaxFrames = 1'000'000, kRounding = 1e-9;
constexpr double kLargest = 100, kSmallest = 0.01;  // of cloth and bodies, without a note [m]

/// A sentence for a size that is none of cloth or of a body.
void check_size(const fs::path& in, const Eigen::AlignedBox3d& box, std::vector<std::string>& notes) {
  const double size = box.sizes().maxCoeff();
  if (size <= kLargest && size >= kSmallest) return;
  char text[160];
  std::snprintf(text, sizeof text, " is %.3g m large; --scale gives the length of its unit in metres", size);
  notes.push_back(in.string() + text);
}

/// A sentence for groups, which only OBJ files have.
void note_groups(const fs::path& in, const MeshFaces& faces, const fs::path& out,
                 std::vector<std::string>& notes) {
  if (has_ending(out, ".obj")) return;
  if (!faces.lines.empty())
    notes.push_back(in.string() + " has lines between vertices, which are lost: only .obj holds them");
  if (faces.groups.empty()) return;
  notes.push_back(in.string() + " has " + std::to_string(faces.groups.size()) +
                  (faces.groups.size() == 1 ? " group" : " groups") +
                  ", which are lost: only .obj holds them");
}

void convert_mesh(const fs::path& in, const fs::path& out, const ConvertOptions& options, Converted& done) {
  MeshFromFile read = read_mesh(in);
  done.notes = read.warnings;
  Eigen::AlignedBox3d box;
  for (Vec3& p : read.mesh.positions) {
    p = to_world(p, options.up_is_z, options.scale);
    box.extend(p);
  }
  check_size(in, box, done.notes);
  note_groups(in, read.faces, out, done.notes);
  write_mesh(out, read.mesh.positions, read.faces);
  done.files.push_back(out.string());
}

struct FrameSpan {
  int first = 0, count = 0;
};

/// The frames to be converted, of `count`.
FrameSpan choose_frames(const fs::path& in, int count, const ConvertOptions& options) {
  const int first = options.first_frame, last = options.last_frame.value_or(count - 1);
  if (first < 0 || last < first || last >= count)
    throw InputError(in.string() + " has the frames 0 to " + std::to_string(count - 1) + "; it has not " +
                     std::to_string(first) + " to " + std::to_string(last));
  return {first, last - first + 1};
}

/// Frames of a point cache, in the output's coordinates.
class Frames {
 public:
  Frames(const fs::path& in, const ConvertOptions& options)
      : in_(in),
        options_(options),
        cache_(in.string()),
        span_(choose_frames(in, cache_.num_frames(), options)) {}

  int num_points() const { return cache_.num_points(); }
  int count() const { return span_.count; }
  int number(int k) const { return span_.first + k; }  // in the cache

  std::vector<float> at(int k, std::vector<std::string>& notes) {
    std::vector<float> frame = cache_.frame(number(k));
    Eigen::AlignedBox3d box;
    for (std::size_t i = 0; i < frame.size(); i += 3) {
      const Vec3 p = to_world(Vec3(frame[i], frame[i + 1], frame[i + 2]), options_.up_is_z, options_.scale);
      box.extend(p);
      for (int axis = 0; axis < 3; ++axis) frame[i + axis] = static_cast<float>(p[axis]);
    }
    if (k == 0) check_size(in_, box, notes);
    return frame;
  }

  /// Times of the frames: the file's own, else by the number of frames per second [s].
  std::vector<float> times(std::vector<std::string>& notes, std::optional<double> fps_of_run) const {
    const std::vector<float> own = options_.fps ? std::vector<float>() : cache_.times();
    if (own.empty() && !options_.fps && !fps_of_run)
      notes.push_back(in_.string() + " does not say its frames per second: 60 (--fps)");
    const double fps = options_.fps.value_or(fps_of_run.value_or(kUsualFps));
    std::vector<float> times;
    for (int k = number(0); k < number(count()); ++k)
      times.push_back(own.empty() ? static_cast<float>(k / fps) : own[k]);
    return times;
  }

 private:
  fs::path in_;
  ConvertOptions options_;
  PointCacheFile cache_;
  FrameSpan span_;
};

void convert_cache(const fs::path& in, const fs::path& out, const ConvertOptions& options,
                   std::optional<double> fps_of_run, Converted& done) {
  Frames frames(in, options);
  const bool has_times = has_ending(out, ".mdd");
  PointCacheWriter writer(
      out.string(), frames.num_points(),
      has_times ? frames.times(done.notes, fps_of_run) : std::vector<float>(frames.count()));
  for (int k = 0; k < frames.count(); ++k) writer.add_frame(frames.at(k, done.notes));
  writer.finish();
  done.files.push_back(out.string());
}

/// A sequence of meshes with the positions of a point cache.
void convert_to_meshes(const fs::path& in, const fs::path& mesh, const fs::path& out,
                       const ConvertOptions& options, Converted& done) {
  const MeshFromFile read = read_mesh(mesh);
  done.notes.insert(done.notes.end(), read.warnings.begin(), read.warnings.end());
  Frames frames(in, options);
  if (frames.num_points() != read.mesh.num_vertices())
    throw InputError(in.string() + " has " + std::to_string(frames.num_points()) + " points, but " +
                     mesh.string() + " has " + std::to_string(read.mesh.num_vertices()) +
                     " vertices; expected the mesh of its points");
  note_groups(mesh, read.faces, out, done.notes);
  for (int k = 0; k < frames.count(); ++k) {
    const std::vector<float> frame = frames.at(k, done.notes);
    std::vector<Vec3> positions;
    for (std::size_t i = 0; i < frame.size(); i += 3)
      positions.emplace_back(frame[i], frame[i + 1], frame[i + 2]);
    fs::path file = out;
    file.replace_filename(out.stem().string() + frame_ending(frames.number(k)) + out.extension().string());
    write_mesh(file, positions, read.faces);
    done.files.push_back(file.string());
  }
}

void convert_sequence(const fs::path& in, const fs::path& out, const ConvertOptions& options,
                      Converted& done) {
  if (options.mesh.empty())
    throw InputError(out.string() + ": a point cache has no faces; --mesh names the mesh of its points");
  convert_to_meshes(in, options.mesh, out, options, done);
}

/// The moving vertices of a glTF file's meshes, from the first key of its first animation to the last.
void convert_motion(const fs::path& in, const fs::path& out, const ConvertOptions& options, Converted& done) {
  const GltfBody body = read_gltf_body(in, {.scale = options.scale});
  done.notes = body.warnings;
  const double fps = options.fps.value_or(kUsualFps);
  if (!options.fps)
    done.notes.push_back(in.string() + " has no frames, but keys: 60 frames per second (--fps)");
  const double seconds = body.vertices.end() - body.vertices.start();
  const double num_frames = std::floor(seconds * fps + kRounding) + 1;
  if (num_frames > kMaxFrames)
    throw InputError(in.string() + " has more than a million frames; --fps makes fewer of them");
  const auto [first, count] = choose_frames(in, static_cast<int>(num_frames), options);
  std::vector<float> times;
  for (int k = first; k < first + count; ++k) times.push_back(static_cast<float>(k / fps));
  PointCacheWriter writer(out.string(), body.vertices.num_vertices(), times);
  std::vector<Vec3> positions;
  for (int k = first; k < first + count; ++k) {
    body.vertices.evaluate(body.vertices.start() + k / fps, positions);
    std::vector<float> frame;
    Eigen::AlignedBox3d box;
    for (const Vec3& p : positions) {
      box.extend(p);
      for (const double c : p) frame.push_back(static_cast<float>(c));
    }
    if (k == first) check_size(in, box, done.notes);
    writer.add_frame(frame);
  }
  writer.finish();
  done.files.push_back(out.string());
}

bool is_cache(const fs::path& file) { return has_ending(file, ".pc2") || has_ending(file, ".mdd"); }

bool is_mesh(const fs::path& file) { return has_ending(file, ".obj") || has_ending(file, ".ply"); }

void convert_run(const fs::path& in, const fs::path& out, const ConvertOptions& options, Converted& done) {
  const PastRun run = read_past_run(in);
  FileNames names;
  for (const PastCloth& cloth : run.cloths) {
    open_cache(run, cloth);
    fs::path own = out;
    if (run.cloths.size() > 1)
      own.replace_filename(out.stem().string() + '_' + names.add(cloth.name) + out.extension().string());
    if (is_mesh(out) && cloth.mesh.empty())
      throw InputError(in.string() +
                       " has no meshes of its point caches: it is of an earlier version of Weft");
    is_mesh(out) ? convert_to_meshes(cloth.cache, cloth.mesh, own, options, done)
                 : convert_cache(cloth.cache, own, options, run.fps, done);
  }
}

void require_positive(const char* option, double value) {
  if (!(value > 0) || !std::isfinite(value))
    throw InputError(std::string("ConvertOptions::") + option + ": expected a number above 0, found " +
                     nlohmann::json(value).dump());
}

void refuse_usd(const fs::path& file) {
  for (const char* ending : {".usd", ".usda", ".usdc", ".usdz"}) {
    if (has_ending(file, ending))
      throw InputError(file.string() + ": USD files are converted by `python -m weft convert`");
  }
}

void convert_file(const fs::path& in, const fs::path& out, const ConvertOptions& options, Converted& done) {
  if (!options.mesh.empty() && !(is_cache(in) && is_mesh(out)))
    throw InputError(options.mesh + ": only a point cache that becomes .obj or .ply needs a mesh (--mesh)");
  if (is_gltf(in) && options.up_is_z) throw InputError(in.string() + ": a glTF file has its y axis up");
  if (!out.parent_path().empty()) make_folder(out.parent_path());
  if (fs::is_directory(in))
    convert_run(in, out, options, done);
  else if (is_cache(in))
    is_mesh(out) ? convert_sequence(in, out, options, done) : convert_cache(in, out, options, {}, done);
  else if (is_gltf(in) && is_cache(out))
    convert_motion(in, out, options, done);
  else
    convert_mesh(in, out, options, done);
}

}  // namespace
}  // namespace weft::engine

namespace weft {

Converted convert(const std::string& in, const std::string& out, const ConvertOptions& options) {
  engine::require_positive("fps", options.fps.value_or(1));
  engine::require_positive("scale", options.scale);
  engine::refuse_usd(in);
  engine::refuse_usd(out);
  Converted done;
  engine::convert_file(in, out, options, done);
  return done;
}

}  // namespace weft
