#include "weft/run/file_sinks.h"

#include <cstdio>

#include "weft/core/file_name.h"
#include "weft/io/glb_writer.h"
#include "weft/io/obj_reader.h"
#include "weft/run/film.h"
#include "weft/run/scene_run.h"

namespace weft::engine {
namespace {

/// A file name for each cloth, without ending.
std::vector<std::string> file_names(const World& world) {
  FileNames names;
  std::vector<std::string> result;
  for (int c = 0; c < world.num_cloths(); ++c) result.push_back(names.add(world.name(world.cloth(c))));
  return result;
}

constexpr std::size_t kMostFrames = 1000;  // of a .glb without a warning

/// The vertices of the cloth's mesh as it was given: (num_vertices) x, y, z [m].
std::vector<float> vertex_positions(const weft::World& world, int cloth) {
  std::vector<float> numbers;
  for (const weft::Vec3& p : world.vertex_positions(world.cloth(cloth))) {
    for (const double x : {p.x, p.y, p.z}) numbers.push_back(static_cast<float>(x));
  }
  return numbers;
}

}  // namespace

void GlbSink::begin(SceneRun& run, RunReport& report) {
  meshes_ = make_animation(run.scene(), run.world());
  const AnimationFrame start = capture_frame(run.world());
  frames_.emplace(file_, frames_file_, start);
  frames_->append(start);
  const auto num_frames = static_cast<std::size_t>(run.num_frames());
  const std::size_t room = find_room(start);
  const std::string name = file_.filename().string(), count = std::to_string(num_frames);
  if (num_frames >= room)
    report.warnings.push_back(name + " will hold the first " + std::to_string(room - 1) + " of " + count +
                              " frames: a .glb is limited to 4 GiB; point caches (.pc2) and --obj are not");
  else if (num_frames > kMostFrames)
    report.warnings.push_back(
        name + " will have " + count +
        " frames, and its morph weights grow with their square; point caches (.pc2) do not");
}

void GlbSink::resume(SceneRun& run, RunReport&, Reader&) {
  meshes_ = make_animation(run.scene(), run.world());
  frames_.emplace(file_, frames_file_, capture_frame(run.world()), run.frame() + 1);
}

/// Number of frames that one .glb has room for.
std::size_t GlbSink::find_room(const AnimationFrame& frame) const {
  StagedFile file(file_);
  GlbWriter writer(file, meshes_);
  writer.add_frame(frame);
  return writer.max_frames();
}

void GlbSink::add_frame(const SceneRun& run, RunReport&) { frames_->append(capture_frame(run.world())); }

void GlbSink::finish(const SceneRun&, RunReport&) {
  GlbWriter writer(glb_.emplace(file_), meshes_);
  std::size_t count = 0;
  frames_->read([&](const AnimationFrame& frame) {
    if (count == 0 || count < writer.max_frames()) writer.add_frame(frame);
    ++count;
  });
  writer.finish();
}

void Pc2Sink::begin(SceneRun& run, RunReport& report) {
  open(run, 0);
  add_frame(run, report);
}

void Pc2Sink::resume(SceneRun& run, RunReport&, Reader&) {
  for (const std::string& name : file_names(run.world())) {
    const std::string file = name + ".pc2";  // in its results, if the run has already ended once
    if (!std::filesystem::exists(part_ / file)) std::filesystem::copy_file(folder_ / file, part_ / file);
  }
  open(run, run.frame() + 1);
}

void Pc2Sink::open(const SceneRun& run, int num_frames) {
  names_ = file_names(run.world());
  for (std::string& name : names_) {
    name += ".pc2";
    require_writable(folder_ / name);
    const ClothId cloth = run.public_world().cloth(static_cast<int>(files_.size()));
    const std::size_t num_points = run.public_world().notes(cloth).particle_of_vertex.size();
    files_.push_back(
        std::make_unique<File>(folder_ / name, part_ / name, static_cast<int>(num_points), num_frames));
  }
}

void Pc2Sink::add_frame(const SceneRun& run, RunReport&) {
  for (std::size_t c = 0; c < files_.size(); ++c)
    files_[c]->writer.add_frame(vertex_positions(run.public_world(), static_cast<int>(c)));
}

void Pc2Sink::sync() {
  for (const auto& file : files_) file->staged.sync();
}

void Pc2Sink::finish(const SceneRun&, RunReport&) {
  for (const auto& file : files_) file->writer.finish();
}

void Pc2Sink::replace() {
  for (const auto& file : files_) file->staged.replace();
}

void ObjSink::begin(SceneRun& run, RunReport&) {
  names_ = file_names(run.world());
  write(run);
}

void ObjSink::resume(SceneRun& run, RunReport&, Reader&) { names_ = file_names(run.world()); }

void ObjSink::add_frame(const SceneRun& run, RunReport&) { write(run); }

void ObjSink::write(const SceneRun& run) const {
  const World& world = run.world();
  for (int c = 0; c < world.num_cloths(); ++c) {
    const TriangleMesh mesh{.positions = positions_of(world.state(world.cloth(c))),
                            .triangles = world.model(world.cloth(c)).topology->mesh.triangles};
    char number[24];
    std::snprintf(number, sizeof number, "_%04d.obj", run.frame());
    write_obj(folder_ / (names_[c] + number), mesh);
  }
}

}  // namespace weft::engine
