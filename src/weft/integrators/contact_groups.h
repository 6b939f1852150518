#pragma once
/// Private to integrators/: groups of cloths that are solved together.

#include <span>
#include <vector>

#include "weft/contact/contact.h"
#include "weft/integrators/integrator.h"

namespace weft::engine {

/// The connected components of cloths under their contacts, in the order of their first cloths. They depend
/// on the contacts only.
class ContactGroups {
 public:
  void find(std::span<const Body> bodies, std::span<const Contact> contacts);

  int size() const { return static_cast<int>(bodies_of_.begin.size()) - 1; }
  std::span<const int> bodies(int group) const { return bodies_of_.part(group); }      // ascending
  std::span<const int> contacts(int group) const { return contacts_of_.part(group); }  // likewise

  /// Particle numbers through all bodies.
  int first_particle(int body) const { return first_particle_[body]; }
  int num_particles() const { return first_particle_.back(); }
  int body_of(int particle) const;

 private:
  struct Parts {
    std::vector<int> begin, items;

    std::span<const int> part(int n) const {
      return std::span(items).subspan(begin[n], begin[n + 1] - begin[n]);
    }
    /// Sorts items by their group.
    void sort(const std::vector<int>& group, int num_groups);
  };

  int root_of(int body) const;

  std::vector<int> first_particle_;  // (bodies + 1)
  std::vector<int> parent_;          // (bodies) union-find forest: the lowest of a group is its root
  std::vector<int> group_of_body_, group_of_contact_;
  Parts bodies_of_, contacts_of_;
};

}  // namespace weft::engine
