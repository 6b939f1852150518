#pragma once
/// The folder of a run's results:
///
///     run.json        list of the others: scene, frames, cloths with their files
///     CLOTH.pc2       positions of a cloth's vertices at every frame         io/pc2.h
///     CLOTH.mesh.obj  the mesh of these vertices, as its file has it         io/obj_reader.h
///     animation.glb   cloths and colliders                                   io/glb_writer.h
///     obj/            an OBJ file per cloth and frame
///     report.json     the report                                             report.h
///     as_run/         scene.toml: the scene with all changes, and its meshes that are in no file
///     unfinished/     during a run: its files so far, its scene, its checkpoint (checkpoint.h), its lock;
///                     what an interrupted run needs to be resumed

#include <filesystem>
#include <vector>

#include "weft/run.h"
#include "weft/run/scene_run.h"
#include "weft/scene/scene_desc.h"

namespace weft::engine {

inline constexpr const char* kAnimationName = "animation.glb";
inline constexpr const char* kReportName = "report.json";
inline constexpr const char* kRunName = "run.json";
inline constexpr const char* kCheckpointName = "checkpoint";
inline constexpr const char* kAsRunName = "as_run";
inline constexpr const char* kUnfinishedName = "unfinished";
inline constexpr const char* kFramesName = "animation.frames";  // in it
inline constexpr const char* kSceneName = "scene.toml";         // in both

struct FinishedRun {
  RunReport report;
  std::vector<std::filesystem::path> files;  // written ones, run.json last
};

/// run_scene(), and the results in options.folder; without a folder no files. `sinks` receive the frames too.
/// Files of an earlier run stay until all new ones are complete; those that the new run does not have are then
/// removed. Throws InputError for bad input and unwritable files, if possible before the simulation.
FinishedRun run_to_folder(const SceneDesc& scene, const RunOptions& options,
                          const std::vector<FrameSink*>& sinks = {}, const OnFrame& on_frame = {});

/// An unfinished or interrupted run, to be resumed.
struct UnfinishedRun {
  SceneDesc scene;
  RunOptions options;  // of the result only; `folder` and `unfinished` are set
};

/// That of the folder. Throws InputError if there is none.
UnfinishedRun read_unfinished_run(const std::filesystem::path& folder);

}  // namespace weft::engine
