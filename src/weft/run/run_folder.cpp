#include "weft/run/run_folder.h"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <regex>
#include <utility>

#include "weft/core/folder_lock.h"
#include "weft/core/make_folder.h"
#include "weft/core/staged_file.h"
#include "weft/error.h"
#include "weft/run/checkpoint.h"
#include "weft/run/file_sinks.h"
#include "weft/run/frame_checker.h"
#include "weft/run/past_run.h"
#include "weft/run/recorder.h"
#include "weft/run/start_from.h"
#include "weft/scene/scene_reader.h"
#include "weft/scene/scene_writer.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

using Json = nlohmann::ordered_json;

/// Number of the frame that ObjSink wrote into a file: `sheet_0012.obj`; empty: it is another file.
std::optional<int> obj_frame(const fs::path& file) {
  static const std::regex kName(".+_([0-9]{4,9})\\.obj");
  std::smatch match;
  const std::string name = file.filename().string();
  if (!std::regex_match(name, match, kName)) return std::nullopt;
  return std::stoi(match[1]);
}

/// Files of the cloths of an earlier run: the names in its run.json that are files of this folder.
std::vector<std::string> find_cloth_files(const fs::path& folder) {
  std::vector<std::string> names;
  std::ifstream in(folder / kRunName);
  const Json run = Json::parse(in, nullptr, false);
  if (!run.is_object() || !run.contains("cloths")) return names;
  for (const Json& cloth : run["cloths"]) {
    if (!cloth.is_object()) continue;
    for (const auto& [key, ending] : {std::pair("positions", kCacheEnding), std::pair("mesh", kMeshEnding)}) {
      if (!cloth.contains(key) || !cloth[key].is_string()) continue;
      const fs::path name = cloth[key].get<std::string>();
      if (name == name.filename() && name.string().ends_with(ending)) names.push_back(name.string());
    }
  }
  return names;
}

constexpr const char* kLockName = "lock";

/// The folder of a run while it goes on: its lock, its scene, its checkpoint, its files so far.
class WorkFolder {
 public:
  /// Throws InputError for a folder that is in use or cannot be written, and for an unfinished run that
  /// `options` neither resume nor discard.
  /// `start`: what `options.start_from` names; null: nothing, or it is not there any more.
  WorkFolder(const SceneDesc& scene, const RunOptions& options, const SceneStart* start)
      : folder_(fs::path(options.folder) / kUnfinishedName),
        is_killed_(fs::exists(folder_ / kLockName)),
        lock_(folder_),
        num_frames_(options.frames.value_or(scene.num_frames())),
        seconds_(options.checkpoint_seconds),
        every_(options.checkpoint_every.value_or(0)) {
    checkpoint_ = {.scene_name = scene.name,
                   .description = describe_run(scene, num_frames_, options),
                   .num_frames = num_frames_,
                   .check_passages = options.check_passages,
                   .audit = options.audit,
                   .pc2 = options.pc2,
                   .glb = options.glb,
                   .obj = options.obj,
                   .start_from = full_start_from(options),
                   .start = start ? hash_of(*start) : 0};
    try {
      begin(scene, options.unfinished);
    } catch (const InputError&) {
      if (!is_killed_) fs::remove(folder_ / kLockName);
      throw;
    }
  }

  /// Removes the folder, unless it has frames to continue from.
  ~WorkFolder() {
    if (checkpoint_.frame > 0) return;
    std::error_code ignored;
    fs::remove(file(), ignored);  // first: what remains after a kill is no unfinished run
    fs::remove_all(folder_, ignored);
  }

  WorkFolder(const WorkFolder&) = delete;
  WorkFolder& operator=(const WorkFolder&) = delete;

  const fs::path& path() const { return folder_; }
  const std::vector<std::byte>& resumed() const { return resumed_; }  // SceneRun::save(); empty: a new run

  /// `is_last`: the run ends with this frame.
  void save(SceneRun& run, bool is_last) {
    const auto now = std::chrono::steady_clock::now();
    const bool is_due = every_ > 0 ? run.frame() % every_ == 0
                                   : std::chrono::duration<double>(now - saved_).count() >= seconds_;
    if (!is_due && !is_last) return;
    Checkpoint next = checkpoint_;
    next.frame = run.frame();
    next.run = run.save();
    write_checkpoint(file(), std::move(next));
    checkpoint_.frame = run.frame();
    saved_ = now;
  }

  /// Of a run that ended as it should. An interrupted one can still be continued.
  void finish(RunOutcome outcome) {
    if (outcome == RunOutcome::interrupted && checkpoint_.frame > 0)
      fs::remove(folder_ / kLockName);
    else
      checkpoint_.frame = 0;
  }

 private:
  fs::path file() const { return folder_ / kCheckpointName; }

  void begin(const SceneDesc& scene, Unfinished unfinished) {
    if (fs::exists(file()) && unfinished == Unfinished::resume) return resume();
    if (fs::exists(file()) && unfinished == Unfinished::refuse && is_killed_) refuse();
    for (const auto& entry : fs::directory_iterator(folder_)) {
      if (entry.path().filename() != kLockName) fs::remove_all(entry.path());
    }
    write_scene(folder_ / kSceneName, scene);
  }

  void resume() {
    Checkpoint there = read_checkpoint(file());
    const std::string difference = find_difference(there.description, checkpoint_.description);
    if (!difference.empty())
      throw InputError(folder_.string() + " is of another run: " + difference +
                       "; discard it (weft run --fresh) to begin again");
    if (checkpoint_.start != 0 && checkpoint_.start != there.start)
      throw InputError(folder_.string() + " is of another run: " + there.start_from +
                       " is another state now; discard it (weft run --fresh) to begin again");
    checkpoint_.start = there.start;
    resumed_ = std::move(there.run);
    checkpoint_.frame = there.frame;
  }

  [[noreturn]] void refuse() const {
    const Checkpoint there = read_checkpoint(file());
    throw InputError(folder_.parent_path().string() + " has an unfinished run, up to frame " +
                     std::to_string(there.frame) + " of " + std::to_string(there.num_frames) +
                     ": resume it (weft run --resume), or discard it (--fresh)");
  }

  fs::path folder_;
  bool is_killed_;
  FolderLock lock_;
  int num_frames_;
  double seconds_;
  int every_;
  Checkpoint checkpoint_;  // the last one, without `run`
  std::vector<std::byte> resumed_;
  std::chrono::steady_clock::time_point saved_ = std::chrono::steady_clock::now();
};

/// Files for the frames of a run, in its work folder until replace(). Those of an earlier run stay until then.
class RunFiles : public FrameSink {
 public:
  /// Checks that the files are writable, or throws InputError.
  RunFiles(const RunOptions& options, const WorkFolder& work) : folder_(options.folder), part_(work.path()) {
    for (const char* name : {kAnimationName, kReportName, kRunName}) require_writable(folder_ / name);
    if (options.glb) sinks_.push_back(&glb_.emplace(folder_ / kAnimationName, part_ / kFramesName));
    if (options.pc2) sinks_.push_back(&pc2_.emplace(folder_, part_));
    if (!options.obj) return;
    make_folder(obj_part());
    sinks_.push_back(&obj_.emplace(obj_part()));
  }

  void begin(SceneRun& run, RunReport& report) override {
    for (FrameSink* sink : sinks_) sink->begin(run, report);
    list_cloths(run);
  }

  void sync() override {
    for (FrameSink* sink : sinks_) sink->sync();
  }

  void resume(SceneRun& run, RunReport& report, Reader& saved) override {
    if (obj_) copy_missing_obj_frames(run.frame());
    for (FrameSink* sink : sinks_) sink->resume(run, report, saved);
    list_cloths(run);
  }

  void add_frame(const SceneRun& run, RunReport& report) override {
    for (FrameSink* sink : sinks_) sink->add_frame(run, report);
  }

  void finish(const SceneRun& run, RunReport& report) override {
    for (FrameSink* sink : sinks_) sink->finish(run, report);
  }

  /// Replaces the files of an earlier run; removes those that would not belong to this report.
  void replace(const RunReport& report) {
    StagedFile report_file(folder_ / kReportName), run_file(folder_ / kRunName);
    report_file.out() << to_json(report);
    report_file.finish();
    const fs::path scene = copy_scene();
    run_file.out() << list_of(report).dump(2, ' ', false, Json::error_handler_t::replace) << '\n';
    run_file.finish();
    std::error_code ignored;
    glb_ ? glb_->replace() : void(fs::remove(folder_ / kAnimationName, ignored));
    replace_cloth_files();
    if (obj_) replace_obj_frames();
    fs::remove_all(folder_ / kAsRunName, ignored);
    fs::rename(scene, folder_ / kAsRunName);
    report_file.replace();
    run_file.replace();
  }

  std::vector<fs::path> files() const {
    std::vector<fs::path> files;
    if (glb_) files.push_back(folder_ / kAnimationName);
    for (const std::string& name : cloth_files()) files.push_back(folder_ / name);
    if (obj_) files.push_back(folder_ / "obj");
    files.insert(files.end(), {folder_ / kAsRunName, folder_ / kReportName, folder_ / kRunName});
    return files;
  }

 private:
  void list_cloths(const SceneRun& run) {
    const weft::World& world = run.public_world();
    for (int c = 0; c < world.num_cloths(); ++c) {
      const ClothId cloth = world.cloth(c);
      cloths_.push_back({{"name", world.name(cloth)},
                         {"positions", pc2_ ? Json(pc2_->names()[c].cache) : Json(nullptr)},
                         {"mesh", pc2_ ? Json(pc2_->names()[c].mesh) : Json(nullptr)},
                         {"color", run.scene().cloths[c].color},
                         {"vertices", count_points(run, c)},
                         {"particles", run.world().whole_topology(cloth).num_particles()}});
    }
    fps_ = run.scene().fps;
    scene_hash_ = hash_of_scene(run.scene());
  }

  /// The scene and its meshes that are in no file, from the work folder: names in it are relative to a folder
  /// as deep.
  fs::path copy_scene() const {
    const fs::path copy = folder_ / (std::string(kAsRunName) + ".part");
    fs::remove_all(copy);
    make_folder(copy);
    for (const auto& entry : fs::directory_iterator(part_)) {
      const std::string name = entry.path().filename().string();
      if (name == kSceneName ||
          (name.ends_with(".obj") && !name.ends_with(kMeshEnding) && entry.is_regular_file()))
        fs::copy_file(entry.path(), copy / name);
    }
    return copy;
  }

  /// Those that the run has already moved to its results.
  void copy_missing_obj_frames(int last) {
    if (!fs::exists(folder_ / "obj")) return;
    for (const auto& entry : fs::directory_iterator(folder_ / "obj")) {
      const std::optional<int> frame = obj_frame(entry.path());
      const fs::path part = obj_part() / entry.path().filename();
      if (frame && *frame <= last && !fs::exists(part)) fs::copy_file(entry.path(), part);
    }
  }

  Json list_of(const RunReport& report) const {
    return {{"format", 1},           {"weft", report.version},
            {"scene", report.scene}, {"scene_hash", scene_hash_},
            {"fps", fps_},           {"frames", report.frames},
            {"cloths", cloths_},     {"animation", glb_ ? Json(kAnimationName) : Json(nullptr)},
            {"report", kReportName}};
  }

  std::vector<std::string> cloth_files() const {
    std::vector<std::string> names;
    if (!pc2_) return names;
    for (const auto& [cache, mesh] : pc2_->names()) names.insert(names.end(), {cache, mesh});
    return names;
  }

  void replace_cloth_files() {
    const std::vector<std::string> old = find_cloth_files(folder_), now = cloth_files();
    if (pc2_) pc2_->replace();
    std::error_code ignored;
    for (const std::string& name : old) {
      if (std::find(now.begin(), now.end(), name) == now.end()) fs::remove(folder_ / name, ignored);
    }
  }

  void replace_obj_frames() {
    std::error_code ignored;
    const fs::path obj = folder_ / "obj";
    make_folder(obj);
    for (const auto& entry : fs::directory_iterator(obj)) {
      if (obj_frame(entry.path())) fs::remove(entry.path(), ignored);
    }
    for (const auto& entry : fs::directory_iterator(obj_part()))
      fs::rename(entry.path(), obj / entry.path().filename());
  }

  fs::path obj_part() const { return part_ / "obj"; }

  fs::path folder_, part_;
  std::optional<GlbSink> glb_;
  std::optional<Pc2Sink> pc2_;
  std::optional<ObjSink> obj_;
  std::vector<FrameSink*> sinks_;  // of these
  Json cloths_ = Json::array();
  double fps_ = 0;
  std::string scene_hash_;
};

/// What `options.start_from` names; for a run to be resumed nothing, if it is not there any more.
std::optional<SceneStart> find_start(const RunOptions& options) {
  if (options.start_from.empty()) return std::nullopt;
  const StartFrom from = parse_start_from(options.start_from);
  if (fs::weakly_canonical(from.folder) == fs::weakly_canonical(options.folder))
    throw InputError("start_from " + options.start_from +
                     ": the results would replace the run that they start from; give them another folder");
  const bool is_resumed = options.unfinished == Unfinished::resume &&
                          fs::exists(fs::path(options.folder) / kUnfinishedName / kCheckpointName);
  try {
    return read_start(from);
  } catch (const InputError&) {
    if (!is_resumed) throw;
    return std::nullopt;
  }
}

}  // namespace

FinishedRun run_to_folder(const SceneDesc& scene, const RunOptions& options,
                          const std::vector<FrameSink*>& sinks, const OnFrame& on_frame) {
  if (options.folder.empty()) return {run_scene(scene, options, sinks, on_frame), {}};
  const std::optional<SceneStart> start = find_start(options);
  make_folder(options.folder);
  WorkFolder work(scene, options, start ? &*start : nullptr);
  RunFiles files(options, work);
  Recorder recorder(options.audit);
  FrameChecker checker(options.check_passages);
  std::vector<FrameSink*> all = {&recorder, &checker};
  all.insert(all.end(), sinks.begin(), sinks.end());
  all.push_back(&files);
  const int num_frames = options.frames.value_or(scene.num_frames());
  const std::shared_ptr<JobSystem> jobs = make_jobs(options.threads);
  const bool is_new = work.resumed().empty();
  SceneRun run =
      is_new ? SceneRun(scene, jobs, all, num_frames, start ? &*start : nullptr, options.on_preparation)
             : SceneRun(scene, jobs, all, num_frames, work.resumed());
  if (is_new) work.save(run, true);
  const auto save_and_tell = [&](const Progress& progress) {
    const bool goes_on = !on_frame || on_frame(progress);
    work.save(run, !goes_on);
    return goes_on;
  };
  const RunReport report = play(run, options, save_and_tell);
  files.replace(report);
  work.finish(report.outcome);
  return {report, files.files()};
}

UnfinishedRun read_unfinished_run(const fs::path& folder) {
  const fs::path unfinished = folder / kUnfinishedName;
  if (!fs::exists(unfinished / kCheckpointName))
    throw InputError(folder.string() + " has no unfinished run to resume");
  const Checkpoint checkpoint = read_checkpoint(unfinished / kCheckpointName);
  UnfinishedRun run{.scene = read_scene(unfinished / kSceneName),
                    .options = {.frames = checkpoint.num_frames,
                                .audit = checkpoint.audit,
                                .check_passages = checkpoint.check_passages,
                                .folder = folder.string(),
                                .pc2 = checkpoint.pc2,
                                .glb = checkpoint.glb,
                                .obj = checkpoint.obj,
                                .start_from = checkpoint.start_from,
                                .unfinished = Unfinished::resume}};
  run.scene.name = checkpoint.scene_name;
  return run;
}

}  // namespace weft::engine
