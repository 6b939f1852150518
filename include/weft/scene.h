#pragma once
/// Scene files: reading, changing and writing them, and their worlds. Link weft::scene. run.h simulates them.

#include <memory>
#include <string>
#include <vector>

#include "weft/error.h"
#include "weft/export.h"
#include "weft/jobs.h"
#include "weft/world.h"

namespace weft {

/// One mistake in a scene.
struct Diagnostic {
  std::string file = {};     // of a changed value "--set path.to.key"
  int line = 0, column = 0;  // from 1; 0: not in a file
  std::string message = {};  // a sentence

  WEFT_API std::string to_string() const;  // "FILE:LINE:COLUMN: mistake, expected value"
};

/// A scene with mistakes; what() lists all of them, one per line.
class WEFT_API SceneError : public InputError {
 public:
  explicit SceneError(std::vector<Diagnostic> diagnostics);
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

/// A scene file with its changes; always valid. Copies are cheap and independent.
class WEFT_API Scene {
 public:
  /// Reads a scene file, or a shipped scene by its name ("drape_sphere"). `overrides` are changes as in set(),
  /// validated together. Throws SceneError with every mistake, and InputError if there is no such scene.
  static Scene load(const std::string& file_or_name, const std::vector<std::string>& overrides = {});

  /// The same from text. `file` is used in messages, names the scene, and gives the folder of mesh files.
  static Scene parse(const std::string& toml, const std::string& file = "scene.toml");

  // A moved-from scene would not be valid: these are also the moves.
  Scene(const Scene&) = default;
  Scene& operator=(const Scene&) = default;

  /// Changes or adds a value, as `weft run --set` does: "cloth[0].fabric=denim", "scene.duration=2". A value
  /// that is not TOML is a string. Throws SceneError, without change, if the scene would not be valid.
  void set(const std::string& assignment);

  /// The document with its changes, as a JSON object with the keys of scene files. It has the given keys only,
  /// without defaults.
  std::string to_json() const;

  std::string name() const;  // the file's name without ending, with its folders below one called "scenes"
  double frames_per_second() const;
  int steps_per_frame() const;
  int num_frames() const;  // duration times frames per second, at least 1 [1]
  double step() const;     // length of a step [s]

  /// Writes a scene file that load() reads as the same scene, without comments. Mesh files are named relative
  /// to its folder. Throws InputError if it cannot be written.
  void write(const std::string& file) const;

 private:
  friend struct SceneAccess;
  struct State;
  explicit Scene(std::shared_ptr<const State> state) : state_(std::move(state)) {}

  std::shared_ptr<const State> state_;  // shared by copies; set() replaces it
};

/// Names of the shipped scenes, sorted. Throws InputError if their folder is not found.
WEFT_API std::vector<std::string> scene_names();

/// A world built from a scene, ready for its first step.
struct LoadedScene {
  World world = {};
  double frames_per_second = 60;
  int steps_per_frame = 1;
  int num_frames = 0;
  std::vector<std::string> warnings = {};  // on meshes, pins, colliders, start and settling, as sentences

  double step() const { return 1 / (frames_per_second * steps_per_frame); }  // length of a step [s]
};

/// Builds the world of a scene. Intersections at the start are repaired unless the scene says otherwise. Throws
/// InputError if a mesh cannot be used or a pin selects nothing.
WEFT_API LoadedScene build_scene(const Scene& scene, std::shared_ptr<JobSystem> jobs = make_serial_jobs());

/// build_scene() of Scene::load().
WEFT_API LoadedScene load_scene(const std::string& file_or_name,
                                const std::vector<std::string>& overrides = {});

/// Problems of the world as it is, in the order of cloths: yarn_strain beyond 1.25 times the fabric's limit, or
/// 0.15 if it has none; flat_triangle; open_seam; then, by the independent checker, crossings and penetration
/// deeper than 0.1 mm. Single frames of fast motion may have the first two. Takes about as long as a step.
WEFT_API std::vector<StepWarning> find_problems(const World& world);

/// A warning as a sentence, with the scene file key that helps: `cloth "sheet": …; raise solver.…`.
WEFT_API std::string describe(const World& world, const StepWarning& warning);

}  // namespace weft
