#include "weft/run/file_sinks.h"

#include <algorithm>
#include <cctype>
#include <cstdio>

#include "weft/error.h"
#include "weft/io/obj_reader.h"
#include "weft/run/film.h"
#include "weft/run/scene_run.h"

namespace weft::engine {
namespace {

std::size_t count_vertices(const AnimationFrame& frame) {
  std::size_t count = 0;
  for (const auto* meshes : {&frame.cloths, &frame.body_vertices}) {
    for (const std::vector<float>& mesh : *meshes) count += mesh.size() / 3;
  }
  return count;
}

/// How many frames a .glb of these meshes can hold.
std::size_t count_fitting(const Animation& meshes, std::size_t num_vertices) {
  std::size_t fits = 0, beyond = std::size_t{1} << 31;
  while (beyond - fits > 1) {
    const std::size_t middle = (fits + beyond) / 2;
    (glb_size(meshes, num_vertices, middle) <= max_glb_size() ? fits : beyond) = middle;
  }
  return fits;
}

/// Keeps letters, digits, '-', '_' and '.'; replaces other characters by '_'.
std::string file_name(std::string name) {
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_' && c != '.') c = '_';
  }
  return name;
}

}  // namespace

void GlbSink::begin(SceneRun& run, RunReport& report) {
  const Animation meshes = make_animation(run.scene(), run.world());
  const AnimationFrame start = capture_frame(run.world());
  room_ = static_cast<int>(count_fitting(meshes, count_vertices(start)));
  if (run.num_frames() + 1 > room_)
    report.warnings.push_back(file_.file().filename().string() + " will hold the first " +
                              std::to_string(room_ - 1) + " of " + std::to_string(run.num_frames()) +
                              " frames: a .glb is limited to 4 GiB; --obj writes all");
  writer_.emplace(file_, meshes);
  writer_->add_frame(start);
}

void GlbSink::add_frame(const SceneRun& run, RunReport&) {
  if (run.frame() < room_) writer_->add_frame(capture_frame(run.world()));
}

void GlbSink::finish(const SceneRun&, RunReport&) { writer_->finish(); }

void ObjSink::begin(SceneRun& run, RunReport&) {
  for (int c = 0; c < run.world().num_cloths(); ++c) {
    std::string name = file_name(run.world().name(run.world().cloth(c)));
    if (std::find(names_.begin(), names_.end(), name) != names_.end()) name += '_' + std::to_string(c + 1);
    names_.push_back(std::move(name));
  }
  write(run);
}

void ObjSink::add_frame(const SceneRun& run, RunReport&) { write(run); }

void ObjSink::write(const SceneRun& run) const {
  const World& world = run.world();
  for (int c = 0; c < world.num_cloths(); ++c) {
    TriangleMesh mesh{.positions = {}, .triangles = world.model(world.cloth(c)).topology->mesh.triangles};
    const ClothState& state = world.state(world.cloth(c));
    for (std::size_t i = 0; i < state.x.size(); ++i) mesh.positions.push_back(state.position(i));
    char number[24];
    std::snprintf(number, sizeof number, "_%04d.obj", run.frame());
    write_obj(folder_ / (names_[c] + number), mesh);
  }
}

}  // namespace weft::engine
