#pragma once
/// Worlds as animations, for files and pictures.

#include <filesystem>
#include <optional>

#include "weft/io/animation.h"
#include "weft/run/frame_log.h"
#include "weft/run/frame_sink.h"
#include "weft/scene/scene_desc.h"
#include "weft/world/particle_values.h"
#include "weft/world/world.h"

namespace weft::engine {

/// How cloth that tears is shown: as a triangle soup (mesh/soup.h), the same in all frames, or as its present mesh.
enum class TornCloth { soup, present };

/// The meshes of a world, without frames; cloth in the default colour of scenes.
Animation make_animation(const World& world, TornCloth torn = TornCloth::soup);

/// The same of a world that was built from a scene, with the scene's name, frame rate and colours.
Animation make_animation(const SceneDesc& scene, const World& world, TornCloth torn = TornCloth::soup);

/// The current state of the world.
AnimationFrame capture_frame(const World& world, TornCloth torn = TornCloth::soup);

/// Coordinates of the particles at rest (num_particles x 2): along a grid's axes, or the two along which a mesh is
/// longest [m].
std::vector<float> make_fabric_coordinates(const ClothTopology& topology);

/// Numbers of a cloth's particles, `width` each, as those of its vertices where torn cloth is a soup.
std::vector<float> show(const World& world, ClothId cloth, int width, std::vector<float> of_particles);

/// Keeps every frame in memory, with the start, for pictures of short runs.
class FilmSink : public FrameSink {
 public:
  void begin(SceneRun& run, RunReport& report) override;
  void add_frame(const SceneRun& run, RunReport& report) override;

  const Animation& animation() const { return animation_; }
  Animation take() { return std::move(animation_); }

 private:
  Animation animation_;
};

/// Keeps every frame in a temporary file, with the start, and reads them back.
class FilmSpool final : public FrameSink, public FrameSource {
 public:
  /// For pictures in `target` (FrameSpool); with these values of particles, or without.
  FilmSpool(const std::filesystem::path& target, std::optional<ParticleValue> value);

  void begin(SceneRun& run, RunReport& report) override;
  void add_frame(const SceneRun& run, RunReport& report) override;

  const Animation& meshes() const override { return meshes_; }
  int num_frames() override { return frames_.num_frames(); }
  AnimationFrame read(int frame) override { return frames_.read(frame); }

 private:
  std::optional<ParticleValue> value_;
  Animation meshes_;
  FrameSpool frames_;
};

}  // namespace weft::engine
