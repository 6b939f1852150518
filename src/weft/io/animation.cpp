#include "weft/io/animation.h"

#include <algorithm>

namespace weft::engine {

Animation without_frames(const Animation& animation) {
  Animation meshes{.title = animation.title,
                   .frames_per_second = animation.frames_per_second,
                   .cloths = {},
                   .bodies = {},
                   .passing = animation.passing};
  for (const AnimatedCloth& cloth : animation.cloths)
    meshes.cloths.push_back({.name = cloth.name,
                             .triangles = cloth.triangles,
                             .color = cloth.color,
                             .frames = {},
                             .fabric_coordinates = cloth.fabric_coordinates,
                             .shown = cloth.shown,
                             .fabric = cloth.fabric});
  for (const AnimatedBody& body : animation.bodies)
    meshes.bodies.push_back({.name = body.name,
                             .mesh = body.mesh,
                             .color = body.color,
                             .poses = {},
                             .frames = {},
                             .shape = body.shape});
  return meshes;
}

std::size_t count_frames(const Animation& animation) {
  std::size_t count = 1;
  for (const AnimatedCloth& cloth : animation.cloths) count = std::max(count, cloth.frames.size());
  for (const AnimatedBody& body : animation.bodies)
    count = std::max({count, body.poses.size(), body.frames.size()});
  return count;
}

AnimationFrame get_frame(const Animation& animation, std::size_t k) {
  AnimationFrame frame;
  for (const AnimatedCloth& cloth : animation.cloths) frame.cloths.push_back(cloth.frames[k]);
  for (const AnimatedBody& body : animation.bodies) {
    frame.poses.push_back(body.poses[body.poses.size() > 1 ? k : 0]);
    frame.body_vertices.push_back(body.frames.empty() ? std::vector<float>() : body.frames[k]);
  }
  return frame;
}

void append_frame(AnimationFrame frame, Animation& animation) {
  std::size_t num_before = 0;
  for (const AnimatedCloth& cloth : animation.cloths) num_before = std::max(num_before, cloth.frames.size());
  for (std::size_t c = 0; c < animation.cloths.size(); ++c)
    animation.cloths[c].frames.push_back(std::move(frame.cloths[c]));
  for (std::size_t b = 0; b < animation.bodies.size(); ++b) {
    AnimatedBody& body = animation.bodies[b];
    if (!frame.body_vertices[b].empty()) body.frames.push_back(std::move(frame.body_vertices[b]));
    if (body.poses.size() == 1 && body.poses[0] == frame.poses[b]) continue;
    if (!body.poses.empty()) body.poses.resize(num_before, body.poses[0]);
    body.poses.push_back(frame.poses[b]);
  }
}

FramesInMemory::FramesInMemory(const Animation& animation)
    : animation_(animation), meshes_(without_frames(animation)) {}

int FramesInMemory::num_frames() { return static_cast<int>(count_frames(animation_)); }

AnimationFrame FramesInMemory::read(int frame) {
  return get_frame(animation_, static_cast<std::size_t>(frame));
}

Animation read_all(FrameSource& source) {
  Animation animation = source.meshes();
  const int count = source.num_frames();
  for (int k = 0; k < count; ++k) {
    AnimationFrame frame = source.read(k);
    for (std::size_t c = 0; c < animation.cloths.size(); ++c)
      animation.cloths[c].frames.push_back(std::move(frame.cloths[c]));
    for (std::size_t b = 0; b < animation.bodies.size(); ++b) {
      animation.bodies[b].poses.push_back(frame.poses[b]);
      if (!frame.body_vertices[b].empty())
        animation.bodies[b].frames.push_back(std::move(frame.body_vertices[b]));
    }
  }
  for (AnimatedBody& body : animation.bodies) {
    const bool is_at_rest = std::all_of(body.poses.begin(), body.poses.end(),
                                        [&](const auto& pose) { return pose == body.poses[0]; });
    if (is_at_rest) body.poses.resize(1);
  }
  return animation;
}

}  // namespace weft::engine
