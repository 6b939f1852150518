#include "weft/integrators/contact_groups.h"

#include <algorithm>
#include <numeric>

namespace weft::engine {

void ContactGroups::find(std::span<const Body> bodies, std::span<const Contact> contacts) {
  first_particle_.assign(1, 0);
  for (const Body& body : bodies)
    first_particle_.push_back(first_particle_.back() + body.model->num_particles());
  parent_.resize(bodies.size());
  std::iota(parent_.begin(), parent_.end(), 0);
  for (const Contact& c : contacts) {
    const int first = root_of(body_of(c.particle[0]));
    const int last = root_of(body_of(c.particle[c.num_particles - 1]));
    parent_[std::max(first, last)] = std::min(first, last);
  }
  group_of_body_.clear();
  int num_groups = 0;
  for (int b = 0; b < static_cast<int>(bodies.size()); ++b) {
    const int root = root_of(b);
    group_of_body_.push_back(root == b ? num_groups++ : group_of_body_[root]);
  }
  group_of_contact_.clear();
  for (const Contact& c : contacts) group_of_contact_.push_back(group_of_body_[body_of(c.particle[0])]);
  bodies_of_.sort(group_of_body_, num_groups);
  contacts_of_.sort(group_of_contact_, num_groups);
}

int ContactGroups::body_of(int particle) const {
  return static_cast<int>(std::upper_bound(first_particle_.begin(), first_particle_.end(), particle) -
                          first_particle_.begin()) -
         1;
}

int ContactGroups::root_of(int body) const {
  while (parent_[body] != body) body = parent_[body];
  return body;
}

void ContactGroups::Parts::sort(const std::vector<int>& group, int num_groups) {
  begin.assign(num_groups + 1, 0);
  for (const int g : group) ++begin[g + 1];
  for (int g = 0; g < num_groups; ++g) begin[g + 1] += begin[g];
  items.resize(group.size());
  std::vector<int>& next = begin;
  for (std::size_t i = 0; i < group.size(); ++i) items[next[group[i]]++] = static_cast<int>(i);
  for (int g = num_groups; g > 0; --g) begin[g] = begin[g - 1];  // now next[g] is the end of g
  begin[0] = 0;
}

}  // namespace weft::engine
