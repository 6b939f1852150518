#include "weft/run/file_sinks.h"

#include <cstdio>

#include "weft/core/file_name.h"
#include "weft/io/obj_reader.h"
#include "weft/run/film.h"
#include "weft/run/scene_run.h"

namespace weft::engine {
void GlbSink::begin(SceneRun& run, RunReport& report) {
  writer_.emplace(file_, make_animation(run.scene(), run.world()));
  writer_->add_frame(capture_frame(run.world()));
  room_ = writer_->max_frames();
  if (static_cast<std::size_t>(run.num_frames()) < room_) return;
  report.warnings.push_back(file_.file().filename().string() + " will hold the first " +
                            std::to_string(room_ - 1) + " of " + std::to_string(run.num_frames()) +
                            " frames: a .glb is limited to 4 GiB; --obj writes all");
}

void GlbSink::add_frame(const SceneRun& run, RunReport&) {
  if (static_cast<std::size_t>(run.frame()) < room_) writer_->add_frame(capture_frame(run.world()));
}

void GlbSink::finish(const SceneRun&, RunReport&) { writer_->finish(); }

void ObjSink::begin(SceneRun& run, RunReport&) {
  FileNames names;
  for (int c = 0; c < run.world().num_cloths(); ++c)
    names_.push_back(names.add(run.world().name(run.world().cloth(c))));
  write(run);
}

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
