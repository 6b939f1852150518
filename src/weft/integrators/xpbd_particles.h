#pragma once
/// Private to integrators/: the particles of a mesh during a substep of `xpbd`, and graph colouring for
/// parallel updates.

#include <vector>

#include "weft/core/vec.h"

namespace weft::engine {

/// All data that a spring requires of one end, in half a cache line.
struct alignas(32) XpbdParticle {
  float y[4] = {0, 0, 0, 0};  // the last one is 1/m
  float c[4] = {0, 0, 0, 0};  // the last one is unused

  float& inv_mass() { return y[3]; }
  float inv_mass() const { return y[3]; }
};

struct alignas(16) XpbdMotion {
  float by[4] = {0, 0, 0, 0};  // h v [m]
};

struct XpbdParticles {
  std::vector<XpbdParticle> particle;
  std::vector<XpbdMotion> motion;

  int size() const { return static_cast<int>(particle.size()); }

  /// Present position in the substep [m].
  Vec3 position(int i) const {
    const XpbdParticle& p = particle[i];
    return {static_cast<double>(p.y[0]) + p.c[0], static_cast<double>(p.y[1]) + p.c[1],
            static_cast<double>(p.y[2]) + p.c[2]};
  }

  /// Displacement since the start of the substep [m].
  Vec3 moved(int i) const {
    const XpbdParticle& p = particle[i];
    const XpbdMotion& m = motion[i];
    return {static_cast<double>(m.by[0]) + p.c[0], static_cast<double>(m.by[1]) + p.c[1],
            static_cast<double>(m.by[2]) + p.c[2]};
  }

  void move(int i, const Vec3& by) {
    for (int c = 0; c < 3; ++c) particle[i].c[c] += static_cast<float>(by[c]);
  }
};

/// Items in colours: those of a colour share no particle.
struct Colours {
  std::vector<int> begin = {0};  // (colours + 1) into `item`
  std::vector<int> item;         // colour by colour
};

/// Greedy colouring: a colour takes every item, in their order, that shares no particle with an item in it.
/// `particles_of(item)` returns a range of particles.
template <class ParticlesOf>
Colours colour_items(int num_items, int num_particles, const ParticlesOf& particles_of) {
  std::vector<int> left, later, last_colour(num_particles, -1);
  for (int k = 0; k < num_items; ++k) left.push_back(k);
  Colours colours;
  for (int colour = 0; !left.empty(); ++colour) {
    later.clear();
    for (const int k : left) {
      bool is_free = true;
      for (const int p : particles_of(k)) is_free &= last_colour[p] != colour;
      (is_free ? colours.item : later).push_back(k);
      if (!is_free) continue;
      for (const int p : particles_of(k)) last_colour[p] = colour;
    }
    left.swap(later);
    colours.begin.push_back(static_cast<int>(colours.item.size()));
  }
  return colours;
}

}  // namespace weft::engine
