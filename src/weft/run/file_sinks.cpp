#include "weft/run/file_sinks.h"

#include "weft/core/file_name.h"
#include "weft/face/convert.h"
#include "weft/face/world_impl.h"
#include "weft/io/glb_writer.h"
#include "weft/io/obj_reader.h"
#include "weft/mesh/soup.h"
#include "weft/run/film.h"
#include "weft/run/scene_run.h"
#include "weft/run/shown_vertices.h"
#include "weft/scene/cloth_faces.h"

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

bool can_tear(const SceneRun& run, std::size_t c) {
  return run.world().can_tear(run.world().cloth(static_cast<int>(c)));
}

/// The vertices of cloth `c`'s mesh as it was given (num_vertices), or of its soup [m].
std::vector<Vec3> vertices_of(const SceneRun& run, std::size_t c) {
  const weft::World& world = run.public_world();
  const ClothId id = world.cloth(static_cast<int>(c));
  if (!can_tear(run, c)) return to_engine(world.vertex_positions(id));
  std::vector<Vec3> corners;
  for (const Triangle& t : world.triangles(id)) {
    for (const int i : t) corners.push_back(run.world().state(id).position(i));
  }
  return corners;
}

/// The faces of cloth `c` as they were given, or those of its soup.
MeshFaces faces_of(const SceneRun& run, std::size_t c) {
  if (!can_tear(run, c)) return read_faces(run.scene().cloths[c]);
  const RestShape& rest = WorldAccess::rest(run.public_world(), run.world().cloth(static_cast<int>(c)));
  return make_faces(make_soup(rest.topology->mesh.num_triangles()), rest.uv);
}

/// x, y, z of each point.
std::vector<float> to_floats(const std::vector<Vec3>& points) {
  std::vector<float> numbers;
  numbers.reserve(3 * points.size());
  for (const Vec3& p : points) {
    for (const double x : p) numbers.push_back(static_cast<float>(x));
  }
  return numbers;
}

}  // namespace

std::size_t count_points(const SceneRun& run, int c) {
  const ClothId cloth = run.public_world().cloth(c);
  if (can_tear(run, static_cast<std::size_t>(c))) return 3 * run.public_world().triangles(cloth).size();
  return run.public_world().notes(cloth).particle_of_vertex.size();
}

/// With the vertices of the cloths' files.
void GlbSink::make_meshes(const SceneRun& run) {
  meshes_ = make_animation(run.scene(), run.world());
  const weft::World& world = run.public_world();
  for (std::size_t c = 0; c < meshes_.cloths.size(); ++c)
    meshes_.cloths[c].shown = show_vertices(world, world.cloth(static_cast<int>(c)));
}

void GlbSink::begin(SceneRun& run, RunReport& report) {
  make_meshes(run);
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
  make_meshes(run);
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
  for (std::size_t c = 0; c < meshes_.size(); ++c) {
    meshes_[c]->out() << obj_text(vertices_of(run, c), faces_of(run, c));
    meshes_[c]->finish();
  }
  add_frame(run, report);
}

void Pc2Sink::resume(SceneRun& run, RunReport&, Reader&) {
  for (const std::string& name : file_names(run.world())) {
    for (const std::string& file : {name + kCacheEnding, name + kMeshEnding}) {
      // In its results, if the run has already ended once.
      if (!std::filesystem::exists(part_ / file)) std::filesystem::copy_file(folder_ / file, part_ / file);
    }
  }
  open(run, run.frame() + 1);
}

/// `num_frames` are there: 0 in a new run.
void Pc2Sink::open(const SceneRun& run, int num_frames) {
  for (const std::string& name : file_names(run.world())) {
    const Names& own = names_.emplace_back(Names{name + kCacheEnding, name + kMeshEnding});
    for (const std::string& file : {own.cache, own.mesh}) require_writable(folder_ / file);
    const std::size_t num_points = count_points(run, static_cast<int>(caches_.size()));
    caches_.push_back(std::make_unique<Cache>(folder_ / own.cache, part_ / own.cache,
                                              static_cast<int>(num_points), num_frames));
    const std::uintmax_t kept = num_frames > 0 ? std::filesystem::file_size(part_ / own.mesh) : 0;
    meshes_.push_back(std::make_unique<StagedFile>(folder_ / own.mesh, part_ / own.mesh, kept));
  }
}

void Pc2Sink::add_frame(const SceneRun& run, RunReport&) {
  for (std::size_t c = 0; c < caches_.size(); ++c)
    caches_[c]->writer.add_frame(to_floats(vertices_of(run, c)));
}

void Pc2Sink::sync() {
  for (const auto& cache : caches_) cache->staged.sync();
}

void Pc2Sink::finish(const SceneRun&, RunReport&) {
  for (const auto& cache : caches_) cache->writer.finish();
}

void Pc2Sink::replace() {
  for (const auto& cache : caches_) cache->staged.replace();
  for (const auto& mesh : meshes_) mesh->replace();
}

void ObjSink::begin(SceneRun& run, RunReport&) {
  open(run);
  write(run);
}

void ObjSink::resume(SceneRun& run, RunReport&, Reader&) { open(run); }

void ObjSink::open(const SceneRun& run) {
  names_ = file_names(run.world());
  for (std::size_t c = 0; c < names_.size(); ++c) faces_.push_back(faces_of(run, c));
}

void ObjSink::add_frame(const SceneRun& run, RunReport&) { write(run); }

void ObjSink::write(const SceneRun& run) {
  for (std::size_t c = 0; c < names_.size(); ++c) {
    const std::filesystem::path file = folder_ / (names_[c] + frame_ending(run.frame()) + ".obj");
    StagedFile staged(file, file);  // in place: the frames after the last sync() do not count
    staged.out() << obj_text(vertices_of(run, c), faces_[c]);
    staged.flush();
    not_synced_.push_back(file);
  }
}

void ObjSink::sync() {
  if (not_synced_.empty()) return;
  for (const std::filesystem::path& file : not_synced_) sync_file(file);
  sync_folder(folder_);
  not_synced_.clear();
}

void ObjSink::finish(const SceneRun&, RunReport&) { sync(); }

}  // namespace weft::engine
