#include "weft/run/convert_files.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdio>

#include "weft/core/file_name.h"
#include "weft/core/make_folder.h"
#include "weft/core/staged_file.h"
#include "weft/error.h"
#include "weft/io/mdd.h"
#include "weft/io/mesh_files.h"
#include "weft/io/pc2.h"
#include "weft/run/past_run.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

constexpr double kUsualFps = 60;
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
  if (faces.groups.empty() || has_ending(out, ".obj")) return;
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
  done.files.push_back(out);
}

/// Frames of a point cache, in the output's coordinates.
class Frames {
 public:
  Frames(const fs::path& in, const ConvertOptions& options)
      : in_(in), options_(options), cache_(open_point_cache(in)), first_(options.first_frame) {
    const int last = options.last_frame.value_or(cache_->num_frames() - 1);
    if (first_ < 0 || last < first_ || last >= cache_->num_frames())
      throw InputError(in.string() + " has the frames 0 to " + std::to_string(cache_->num_frames() - 1) +
                       "; it has not " + std::to_string(first_) + " to " + std::to_string(last));
    count_ = last - first_ + 1;
  }

  int num_points() const { return cache_->num_points(); }
  int count() const { return count_; }
  int number(int k) const { return first_ + k; }  // in the cache

  std::vector<float> at(int k, std::vector<std::string>& notes) {
    std::vector<float> frame = cache_->frame(first_ + k);
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
    std::vector<float> times;
    const auto* mdd = dynamic_cast<const MddReader*>(cache_.get());
    if (!mdd && !options_.fps && !fps_of_run)
      notes.push_back(in_.string() + " does not say its frames per second: 60 (--fps)");
    const double fps = options_.fps.value_or(fps_of_run.value_or(kUsualFps));
    for (int k = 0; k < count_; ++k)
      times.push_back(mdd && !options_.fps ? mdd->times()[first_ + k]
                                           : static_cast<float>((first_ + k) / fps));
    return times;
  }

 private:
  fs::path in_;
  ConvertOptions options_;
  std::unique_ptr<PointCacheReader> cache_;
  int first_, count_ = 0;
};

void convert_cache(const fs::path& in, const fs::path& out, const ConvertOptions& options,
                   std::optional<double> fps_of_run, Converted& done) {
  Frames frames(in, options);
  StagedFile file(out);
  const auto write = [&](auto& writer) {
    for (int k = 0; k < frames.count(); ++k) writer.add_frame(frames.at(k, done.notes));
    writer.finish();
  };
  if (has_ending(out, ".mdd")) {
    MddWriter writer(file, frames.num_points(), frames.times(done.notes, fps_of_run));
    write(writer);
  } else if (has_ending(out, ".pc2")) {
    Pc2Writer writer(file, frames.num_points());
    write(writer);
  } else {
    throw InputError(out.string() + ": a point cache is written as .pc2 or .mdd");
  }
  file.replace();
  done.files.push_back(out);
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
    done.files.push_back(file);
  }
}

void convert_sequence(const fs::path& in, const fs::path& out, const ConvertOptions& options,
                      Converted& done) {
  if (options.mesh.empty())
    throw InputError(out.string() + ": a point cache has no faces; --mesh names the mesh of its points");
  convert_to_meshes(in, options.mesh, out, options, done);
}

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

}  // namespace

Converted convert_files(const fs::path& in, const fs::path& out, const ConvertOptions& options) {
  Converted done;
  const bool is_cache = has_ending(in, ".pc2") || has_ending(in, ".mdd");
  if (!options.mesh.empty() && !(is_cache && is_mesh(out)))
    throw InputError(options.mesh.string() +
                     ": only a point cache that becomes .obj or .ply needs a mesh (--mesh)");
  if (!out.parent_path().empty()) make_folder(out.parent_path());
  if (fs::is_directory(in))
    convert_run(in, out, options, done);
  else if (is_cache)
    is_mesh(out) ? convert_sequence(in, out, options, done) : convert_cache(in, out, options, {}, done);
  else
    convert_mesh(in, out, options, done);
  return done;
}

}  // namespace weft::engine
