#pragma once
/// Frame sinks that write files during the run.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "weft/core/staged_file.h"
#include "weft/io/mesh_from_file.h"
#include "weft/io/pc2.h"
#include "weft/run/frame_log.h"
#include "weft/run/frame_sink.h"

namespace weft::engine {

/// Keeps the frames for animation.glb, which is made of them at the end. The frames are on disk: memory does
/// not grow with their number. A run that is too long for one .glb (io/glb_writer.h) gets a warning at its
/// start; the file then has its first frames.
class GlbSink : public FrameSink {
 public:
  /// Frames go to `frames`, the finished animation to `file`.
  GlbSink(std::filesystem::path file, std::filesystem::path frames)
      : file_(std::move(file)), frames_file_(std::move(frames)) {}

  void begin(SceneRun& run, RunReport& report) override;
  void add_frame(const SceneRun& run, RunReport& report) override;
  void finish(const SceneRun& run, RunReport& report) override;
  void sync() override { frames_->sync(); }
  void resume(SceneRun& run, RunReport& report, Reader& saved) override;

  /// StagedFile::replace() of the animation, after finish().
  void replace() { glb_->replace(); }

 private:
  void make_meshes(const SceneRun& run);
  std::size_t find_room(const AnimationFrame& frame) const;

  std::filesystem::path file_, frames_file_;
  Animation meshes_;
  std::optional<FrameLog> frames_;
  std::optional<StagedFile> glb_;
};

/// The number of points that files have of cloth `c`: vertices of its mesh as it was given, or corners of triangles where
/// it tears.
std::size_t count_points(const SceneRun& run, int c);

inline constexpr const char* kCacheEnding = ".pc2";
inline constexpr const char* kMeshEnding = ".mesh.obj";

/// Writes for each cloth a PC2 point cache and the mesh of its points: `FOLDER/sheet.pc2` and
/// `FOLDER/sheet.mesh.obj` of cloth "sheet". Frame 0 is the start, and the mesh is at the start. Points are the
/// vertices of the cloth's mesh as it was given, in their order (World::vertex_positions), in world
/// coordinates [m]. The mesh has the polygons, texture coordinates and groups of its file.
class Pc2Sink : public FrameSink {
 public:
  /// The files are in `part` during the run; replace() moves them into `folder`. Both must exist.
  Pc2Sink(std::filesystem::path folder, std::filesystem::path part)
      : folder_(std::move(folder)), part_(std::move(part)) {}

  void begin(SceneRun& run, RunReport& report) override;
  void add_frame(const SceneRun& run, RunReport& report) override;
  void finish(const SceneRun& run, RunReport& report) override;
  void sync() override;
  void resume(SceneRun& run, RunReport& report, Reader& saved) override;

  /// StagedFile::replace() of every file, after finish().
  void replace();

  /// Of the files of a cloth.
  struct Names {
    std::string cache, mesh;
  };
  const std::vector<Names>& names() const { return names_; }  // (cloths)

 private:
  struct Cache {
    Cache(const std::filesystem::path& path, const std::filesystem::path& part, int num_points,
          int num_frames)
        : staged(path, part, num_frames > 0 ? Pc2Writer::size_of(num_points, num_frames) : 0),
          writer(staged, num_points, num_frames) {}
    StagedFile staged;
    Pc2Writer writer;
  };

  void open(const SceneRun& run, int num_frames);

  std::filesystem::path folder_, part_;
  std::vector<Names> names_;
  std::vector<std::unique_ptr<Cache>> caches_;       // (cloths)
  std::vector<std::unique_ptr<StagedFile>> meshes_;  // (cloths)
};

/// Writes a sequence of OBJ files, one per cloth and frame: `FOLDER/sheet_0000.obj` is the start of cloth
/// "sheet". Each has the vertices of the cloth's mesh as it was given, in their order. Polygons, texture
/// coordinates and groups are those of its file; a grid has its cells. A file is on the disk after sync() or
/// finish().
class ObjSink : public FrameSink {
 public:
  /// The folder must exist.
  explicit ObjSink(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void begin(SceneRun& run, RunReport& report) override;
  void add_frame(const SceneRun& run, RunReport& report) override;
  void finish(const SceneRun& run, RunReport& report) override;
  void sync() override;
  void resume(SceneRun& run, RunReport& report, Reader& saved) override;

 private:
  void open(const SceneRun& run);
  void write(const SceneRun& run);

  std::filesystem::path folder_;
  std::vector<std::string> names_;                 // (cloths) of files
  std::vector<MeshFaces> faces_;                   // (cloths)
  std::vector<std::filesystem::path> not_synced_;  // written since sync()
};

}  // namespace weft::engine
