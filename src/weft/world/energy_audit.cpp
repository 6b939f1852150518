#include "weft/world/energy_audit.h"

#include "weft/contact/moving_shape.h"
#include "weft/forces/gravity.h"
#include "weft/forces/seam_springs.h"
#include "weft/world/cloth_forces.h"
#include "weft/world/measures.h"

namespace weft::engine {
namespace {

using Forces = std::vector<Vec3>;  // (num_particles) [N]

/// A cloth's step.
struct ClothStep {
  const ClothModel& model;
  const ClothState &before, &after;
  double step = 0;  // [s]

  int num_particles() const { return model.num_particles(); }
  Vec3 displacement(int i) const { return after.position(i) - before.position(i); }
  Vec3 acceleration(int i) const { return (after.v.get(i) - before.v.get(i)) / step; }
};

double compute_work(const Forces& force, const ClothStep& cloth) {
  double work = 0;
  for (int i = 0; i < cloth.num_particles(); ++i) work += force[i].dot(cloth.displacement(i));
  return work;
}

std::vector<int> find_moved_pins(const std::vector<Pin>& pins, const ClothStep& cloth) {
  std::vector<int> moved;
  for (const Pin& pin : pins) {
    for (const int i : pin.particles) {
      if (!cloth.displacement(i).isZero(0)) moved.push_back(i);
    }
  }
  return moved;
}

/// `outside`: the forces of wind and contacts.
double compute_pin_work(const std::vector<int>& moved, const Vec3& gravity, const Forces& outside,
                        const ClothStep& cloth) {
  if (moved.empty()) return 0;
  const Forces elastic = compute_elastic_forces(cloth.model, cloth.after),
               damping = compute_damping_forces(cloth.model, cloth.after);
  double work = 0;
  for (const int i : moved) {
    const Vec3 force = gravity_force(cloth.model.mass[i], gravity) + elastic[i] + damping[i] + outside[i];
    work += (cloth.model.mass[i] * cloth.acceleration(i) - force).dot(cloth.displacement(i));
  }
  return work;
}

/// Adds the contact forces on a cloth, each to the nearest particle.
void add_contact_forces(int cloth, const std::vector<ContactPoint>& contacts, Forces& force) {
  for (const ContactPoint& contact : contacts) {
    if (contact.cloth == cloth) force[contact.particle] += contact.force;
    if (contact.other_cloth == cloth) force[contact.other_vertex] -= contact.force;
  }
}

double compute_attachment_work(const std::vector<Attachment>& attachments, const std::vector<Pin>& pins,
                               const ClothStep& cloth) {
  if (attachments.empty()) return 0;
  std::vector<char> is_pinned(cloth.num_particles(), 0);
  for (const Pin& pin : pins) {
    for (const int i : pin.particles) is_pinned[i] = 1;
  }
  double work = 0;
  for (const Attachment& attachment : attachments) {
    for (std::size_t p = 0; p < attachment.particles.size(); ++p) {
      const int i = attachment.particles[p];
      if (is_pinned[i]) continue;
      const Vec3 pull = attachment.target + attachment.offsets[p] - cloth.after.position(i);
      const Vec3 force =
          attachment.shares[p] * (attachment.stiffness * pull - attachment.damping * cloth.after.v.get(i));
      work += force.dot(cloth.displacement(i));
    }
  }
  return work;
}

/// Displacement in the step of the shape's point at a contact; for a deforming mesh that of the nearest
/// vertex.
Vec3 displacement_at(const ContactPoint& contact, const MovingShape& shape) {
  const MeshShape* mesh = std::get_if<MeshShape>(&shape.after);
  if (mesh && mesh->source)
    return mesh->vertex(contact.other_vertex) -
           std::get<MeshShape>(shape.before).vertex(contact.other_vertex);
  return contact.position - shape.at_start(contact.position);
}

double compute_shape_work(const std::vector<Collider>& colliders, const std::vector<ContactPoint>& contacts,
                          double start, double end) {
  std::vector<MovingShape> shapes;
  for (const Collider& c : colliders)
    shapes.push_back(
        {&c, shape_at(c, start), shape_at(c, end), c.motion.at(start), c.motion.at(end), pivot(c.shape)});
  double work = 0;
  for (const ContactPoint& contact : contacts) {
    if (contact.collider >= 0) work += contact.force.dot(displacement_at(contact, shapes[contact.collider]));
  }
  return work;
}

}  // namespace

EnergyAudit& EnergyAudit::operator+=(const EnergyAudit& next) {
  energy = next.energy;
  work_pins += next.work_pins;
  work_shapes += next.work_shapes;
  work_wind += next.work_wind;
  work_hands += next.work_hands;
  left_over += next.left_over;
  return *this;
}

WorldEnergy compute_energy(const World& world) {
  WorldEnergy energy;
  for (int c = 0; c < world.num_cloths(); ++c) {
    const ClothModel& model = world.model(world.cloth(c));
    const ClothState& state = world.state(world.cloth(c));
    const ElasticParts elastic = compute_elastic_parts(model, state);
    energy.kinetic += compute_kinetic_energy(model, state);
    energy.elastic += elastic.stretch;
    energy.bending += elastic.bending;
    energy.gravitational += compute_gravity_energy(model, state, world.gravity());
  }
  return energy;
}

AuditStart begin_energy_audit(const World& world) { return {world.snapshot(), compute_energy(world)}; }

EnergyAudit finish_energy_audit(const AuditStart& start, const World& world) {
  EnergyAudit audit{.energy = compute_energy(world)};
  const double step = world.time() - start.state.time;
  if (step == 0) return audit;  // failed step: contact forces may be infinite
  const std::vector<ContactPoint> contacts = world.contact_points();
  audit.work_shapes = compute_shape_work(world.colliders(), contacts, start.state.time, world.time());
  for (int c = 0; c < world.num_cloths(); ++c) {
    const ClothState before = world.split(world.cloth(c), start.state.states.at(c));
    const ClothStep cloth{world.model(world.cloth(c)), before, world.state(world.cloth(c)), step};
    Forces outside = compute_wind_forces(cloth.model, cloth.before, cloth.after, world.wind(), world.time());
    audit.work_wind += compute_work(outside, cloth);
    add_contact_forces(c, contacts, outside);
    const std::vector<Pin>& pins = world.pins(world.cloth(c));
    audit.work_pins += compute_pin_work(find_moved_pins(pins, cloth), world.gravity(), outside, cloth);
    audit.work_hands += compute_attachment_work(world.attachments(world.cloth(c)), pins, cloth) +
                        seam_work(cloth.model, cloth.before, cloth.after);
  }
  audit.left_over = audit.energy.total() - start.energy.total() - audit.work();
  return audit;
}

}  // namespace weft::engine
