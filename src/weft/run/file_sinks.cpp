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

void require_room(const Animation& meshes, std::size_t num_vertices, std::size_t num_frames,
                  const StagedFile& file) {
  if (glb_size(meshes, num_vertices, num_frames) <= max_glb_size()) return;
  std::size_t fits = 0, beyond = num_frames;
  while (beyond - fits > 1) {
    const std::size_t middle = (fits + beyond) / 2;
    (glb_size(meshes, num_vertices, middle) <= max_glb_size() ? fits : beyond) = middle;
  }
  throw InputError(file.file().string() + ": a .glb holds at most 4 GiB, or " +
                   std::to_string(fits > 0 ? fits - 1 : 0) + " frames of this scene, but the run has " +
                   std::to_string(num_frames - 1) + "; use fewer --frames, or --no-glb and --obj");
}

/// Keeps letters, digits, '-', '_' and '.'; replaces other characters by '_'.
std::string file_name(std::string name) {
  for (char& c : name) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '_' && c != '.') c = '_';
  }
  return name;
}

}  // namespace

void GlbSink::begin(SceneRun& run, RunReport&) {
  const Animation meshes = make_animation(run.scene(), run.world());
  const AnimationFrame start = capture_frame(run.world());
  require_room(meshes, count_vertices(start), static_cast<std::size_t>(run.num_frames()) + 1, file_);
  writer_.emplace(file_, meshes);
  writer_->add_frame(start);
}

void GlbSink::add_frame(const SceneRun& run, RunReport&) { writer_->add_frame(capture_frame(run.world())); }

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
