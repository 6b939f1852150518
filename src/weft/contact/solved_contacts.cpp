#include "weft/contact/solved_contacts.h"

#include <algorithm>

namespace weft::engine {

void SolvedContacts::read(std::span<const Contact> contacts, const Numbering& numbering, bool is_predicted) {
  is_separated_.assign(numbering.num_cloths(), is_predicted);
  for (const Contact& c : contacts) {
    for (const int v : {c.particle[0], c.particle[c.num_particles - 1]})
      is_separated_[numbering.cloth_of(v)] = c.is_solved;
  }
}

bool SolvedContacts::are_all_separated() const {
  return std::all_of(is_separated_.begin(), is_separated_.end(), [](char is) { return is != 0; });
}

bool SolvedContacts::is_separated(const Constraint& c, const Numbering& numbering) const {
  for (int k = 0; k < c.num_vertices; ++k) {
    const int v = c.vertex[k];
    if (numbering.is_of_cloth(v) && !is_separated_[numbering.cloth_of(v)]) return false;
  }
  return true;
}

/// Marks the constraint's cloths as not separated. Returns whether this changed any of them.
bool SolvedContacts::mark_near(const Constraint& c, const Numbering& numbering) {
  bool has_changed = false;
  for (int k = 0; k < c.num_vertices; ++k) {
    if (!numbering.is_of_cloth(c.vertex[k])) continue;
    char& is = is_separated_[numbering.cloth_of(c.vertex[k])];
    has_changed |= is != 0;
    is = 0;
  }
  return has_changed;
}

void SolvedContacts::leave_out_separated(const StepBodies& bodies, std::vector<Constraint>& constraints) {
  const Numbering& numbering = bodies.numbering;
  for (const Constraint& c : constraints) {
    if (bodies.depth_at_end(c) > kMaxShortfall * bodies.gap_of(c, Purpose::after_solve))
      mark_near(c, numbering);
  }
  for (bool is_spreading = true; is_spreading;) {
    is_spreading = false;
    for (const Constraint& c : constraints) {
      if (!is_separated(c, numbering)) is_spreading |= mark_near(c, numbering);
    }
  }
  std::erase_if(constraints, [&](const Constraint& c) { return is_separated(c, numbering); });
}

SolvedContacts::FeatureKey SolvedContacts::key_of(const Constraint& c) {
  FeatureKey key{c.shape, -1, -1, -1, -1};
  std::copy_n(c.vertex.begin(), c.num_vertices, key.begin() + 1);
  return key;
}

void SolvedContacts::sort_known() {
  known_.clear();
  for (const Constraint& c : constraints_) known_.push_back(key_of(c));
  std::sort(known_.begin(), known_.end());
}

bool SolvedContacts::is_known(const Constraint& c) const {
  return std::binary_search(known_.begin(), known_.end(), key_of(c));
}

}  // namespace weft::engine
