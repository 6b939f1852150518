#pragma once
/// Frame sinks that write files during the run.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "weft/core/staged_file.h"
#include "weft/io/glb_writer.h"
#include "weft/run/frame_sink.h"

namespace weft::engine {

/// Writes a .glb, up to StagedFile::finish(); replace() is left to the caller. A run that is too long for one
/// (io/glb_writer.h) gets a warning at its start; the file then has its first frames.
class GlbSink : public FrameSink {
 public:
  explicit GlbSink(StagedFile& file) : file_(file) {}

  void begin(SceneRun& run, RunReport& report) override;
  void add_frame(const SceneRun& run, RunReport& report) override;
  void finish(const SceneRun& run, RunReport& report) override;

 private:
  StagedFile& file_;
  std::optional<GlbWriter> writer_;
  std::size_t room_ = 0;  // frames that fit, with the start
};

/// Writes a sequence of OBJ files, one per cloth and frame: `FOLDER/sheet_0000.obj` is the start of cloth
/// "sheet". Vertices are the cloth's particles, in their order.
class ObjSink : public FrameSink {
 public:
  /// The folder must exist.
  explicit ObjSink(std::filesystem::path folder) : folder_(std::move(folder)) {}

  void begin(SceneRun& run, RunReport& report) override;
  void add_frame(const SceneRun& run, RunReport& report) override;

 private:
  void write(const SceneRun& run) const;

  std::filesystem::path folder_;
  std::vector<std::string> names_;  // (cloths) of files
};

}  // namespace weft::engine
