#pragma once
/// The world of an earlier run, which takes the states of its frames.

#include <memory>

#include "weft/io/animation.h"
#include "weft/scene/scene_desc.h"
#include "weft/world.h"
#include "weft/world/particle_values.h"
#include "weft/world/world.h"

namespace weft::engine {

class PastWorld {
 public:
  /// `world`: of the scene, in any state.
  PastWorld(SceneDesc scene, weft::World world) : scene_(std::move(scene)), world_(std::move(world)) {}

  const SceneDesc& scene() const { return scene_; }
  const weft::World& public_world() const { return world_; }
  const World& world() const;

  /// Positions of particles from those of the vertices of a cloth's mesh as it was given (num_vertices x 3) [m]. Cloth
  /// that tears keeps those of its triangles.
  std::vector<float> to_particles(int cloth, const std::vector<float>& vertices) const;

  /// Puts colliders where they are at a time, cloth aside.
  void set_time(double time);

  /// Puts everything where a frame of particles has it, and returns the frame. Velocities are differences from
  /// the frame before.
  AnimationFrame show(FrameSource& frames, int number);

 private:
  SceneDesc scene_;
  weft::World world_;
};

/// Frames of particles with a value of each. Both arguments must outlive this.
class FramesWithValues final : public FrameSource {
 public:
  FramesWithValues(FrameSource& frames, PastWorld& world, ParticleValue value)
      : frames_(frames), world_(world), value_(value) {}

  const Animation& meshes() const override { return frames_.meshes(); }
  int num_frames() override { return frames_.num_frames(); }
  AnimationFrame read(int number) override;

 private:
  FrameSource& frames_;
  PastWorld& world_;
  ParticleValue value_;
};

}  // namespace weft::engine
