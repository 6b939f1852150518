#pragma once
/// Worlds as animations, for files and pictures.

#include "weft/io/animation.h"
#include "weft/run/frame_sink.h"
#include "weft/scene/scene_desc.h"
#include "weft/world/particle_values.h"
#include "weft/world/world.h"

namespace weft::engine {

/// The meshes of a world, without frames; cloth in the default colour of scenes.
Animation make_animation(const World& world);

/// The same of a world that was built from a scene, with the scene's name, frame rate and colours.
Animation make_animation(const SceneDesc& scene, const World& world);

/// The current state of the world.
AnimationFrame capture_frame(const World& world);

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

/// Keeps the values of particles in every frame, with the start.
class ValueSink : public FrameSink {
 public:
  explicit ValueSink(ParticleValue value) : value_(value) {}

  void begin(SceneRun& run, RunReport& report) override;
  void add_frame(const SceneRun& run, RunReport& report) override;

  /// (num_frames) of (num_cloths) of (num_particles).
  std::vector<std::vector<std::vector<float>>> take() { return std::move(frames_); }

 private:
  void add(const World& world);

  ParticleValue value_;
  std::vector<std::vector<std::vector<float>>> frames_;
};

}  // namespace weft::engine
