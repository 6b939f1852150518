#include "weft/world/world.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "weft/core/error.h"
#include "weft/core/hash.h"

namespace weft {
namespace {

void require(bool condition, const std::string& sentence) {
  if (!condition) throw InputError(sentence);
}

void validate(const ClothMaterial& m, const std::string& cloth) {
  const auto at_least_zero = [&](double value, const char* name) {
    require(std::isfinite(value) && value >= 0, "cloth \"" + cloth + "\": " + name + " must be 0 or more");
  };
  require(std::isfinite(m.density) && m.density > 0,
          "cloth \"" + cloth + "\": density must be more than 0 kg/m²");
  at_least_zero(m.structural, "structural stiffness");
  at_least_zero(m.shear, "shear stiffness");
  at_least_zero(m.bend, "bending stiffness");
  at_least_zero(m.damping, "damping");
  at_least_zero(m.damping_time, "damping time");
  at_least_zero(m.thickness, "thickness");
  at_least_zero(m.friction, "friction");
}

void require_elements_move(const std::string& integrator, const std::string& cloth) {
  require(moves_elements(integrator),
          "cloth \"" + cloth + "\" is of a fabric, which " + integrator +
              " cannot move, for it knows springs alone; use newton, "
              "implicit_euler or xpbd, or give spring_structural, spring_shear and "
              "spring_bend instead of the fabric");
}

void require_air(const Wind& wind, const std::string& integrator) {
  if (wind.air.density == 0) return;
  require(wind.air.density > 0 && wind.air.drag > 0 && wind.air.lift >= 0 && wind.air.lift <= wind.air.drag,
          "the air's density and drag must be above 0, and its lift from 0 to its drag");
  require(wind.gusts.length > 0 && wind.gusts.time > 0, "gusts need a length and a time above 0");
  require(feels_air(integrator), integrator + " does not feel the air's drag and lift; use newton or " +
                                     "implicit_euler, or the wind's drag alone");
}

/// A sum of products with zero: 0 if all values are finite, else not a number.
float finite_check(const float* values, std::size_t count) {
  constexpr std::size_t kLanes = 16;
  float sums[kLanes] = {};
  for (std::size_t i = 0; i + kLanes <= count; i += kLanes) {
    for (std::size_t lane = 0; lane < kLanes; ++lane) sums[lane] += 0.0f * values[i + lane];
  }
  float sum = 0;
  for (const float s : sums) sum += s;
  for (std::size_t i = count - count % kLanes; i < count; ++i) sum += 0.0f * values[i];
  return sum;
}

bool is_finite(const Vec3Array& a) {
  return finite_check(a.x(), a.size()) == 0 && finite_check(a.y(), a.size()) == 0 &&
         finite_check(a.z(), a.size()) == 0;
}

/// Index of the first particle whose position or velocity is not finite, -1 if all are.
int find_non_finite(const ClothState& state) {
  if (is_finite(state.x) && is_finite(state.v)) return -1;
  for (std::size_t i = 0; i < state.x.size(); ++i) {
    if (!state.x.get(i).allFinite() || !state.v.get(i).allFinite()) return static_cast<int>(i);
  }
  return -1;
}

constexpr double kForever = std::numeric_limits<double>::infinity();
constexpr int kMaxParts = 1 << 12;  // of one step [1]
constexpr int kCalmParts = 4;       // in a row, before parts become longer
constexpr double kFarTooLong = 4;   // severity of a part that is cut in four [1]
constexpr double kCalm = 0.5;       // severity of a part that could have been longer [1]

}  // namespace

World::World() : integrator_(make_integrator({})), jobs_(make_serial_jobs()) {}

World::Cloth& World::at(ClothId id) { return cloths_.at(static_cast<std::size_t>(id.index)); }
const World::Cloth& World::at(ClothId id) const { return cloths_.at(static_cast<std::size_t>(id.index)); }

ClothId World::add_cloth(const ClothDesc& desc) {
  require(desc.topology != nullptr, "cloth \"" + desc.name + "\" has no topology");
  validate(desc.material, desc.name);
  const std::vector<Vec3>& positions =
      desc.positions.empty() ? desc.topology->mesh.positions : desc.positions;
  require(static_cast<int>(positions.size()) == desc.topology->num_particles(),
          "cloth \"" + desc.name + "\" has " + std::to_string(desc.topology->num_particles()) +
              " particles but " + std::to_string(positions.size()) + " positions");
  Cloth cloth;
  cloth.name = desc.name;
  if (desc.elements) require_elements_move(integrator_settings_.integrator, desc.name);
  cloth.model = build_cloth_model(desc.topology, desc.material, desc.elements);
  cloth.state = make_state(positions);
  for (std::size_t i = 0; i < positions.size(); ++i) cloth.state.v.set(i, desc.velocity);
  require(find_non_finite(cloth.state) < 0,
          "cloth \"" + desc.name + "\" has a position that is not a finite number");
  cloth.is_pinned.assign(positions.size(), 0);
  cloths_.push_back(std::move(cloth));
  return {num_cloths() - 1};
}

void World::set_pins(ClothId id, std::vector<Pin> pins) {
  Cloth& cloth = at(id);
  std::vector<char> is_pinned(cloth.state.x.size(), 0);
  std::vector<PinnedParticle> pinned;
  for (int p = 0; p < static_cast<int>(pins.size()); ++p) {
    for (const int i : pins[p].particles) {
      require(i >= 0 && i < cloth.model->num_particles(), "cloth \"" + cloth.name + "\" has no particle " +
                                                              std::to_string(i) + " to pin; it has " +
                                                              std::to_string(cloth.model->num_particles()));
      require(!is_pinned[i],
              "cloth \"" + cloth.name + "\": particle " + std::to_string(i) + " is pinned twice");
      is_pinned[i] = 1;
      pinned.push_back({i, p, cloth.state.position(i)});
    }
  }
  std::sort(pinned.begin(), pinned.end(),
            [](const auto& a, const auto& b) { return a.particle < b.particle; });
  cloth.pins = std::move(pins);
  cloth.pinned = std::move(pinned);
  cloth.is_pinned = std::move(is_pinned);
}

void World::set_grabs(ClothId id, std::vector<Grab> grabs) {
  Cloth& cloth = at(id);
  for (const Grab& grab : grabs) {
    for (const int i : grab.particles) {
      require(i >= 0 && i < cloth.model->num_particles(),
              "cloth \"" + cloth.name + "\" has no particle " + std::to_string(i) + " to grab");
    }
    require(grab.shares.size() == grab.particles.size() && grab.offsets.size() == grab.particles.size(),
            "a grab needs a share and an offset for each particle");
    require(std::isfinite(grab.stiffness) && grab.stiffness >= 0 && std::isfinite(grab.damping) &&
                grab.damping >= 0,
            "a grab's stiffness and damping must be 0 or more");
  }
  cloth.hands.set(std::move(grabs));
}

void World::set_material(ClothId id, const ClothMaterial& material) {
  Cloth& cloth = at(id);
  validate(material, cloth.name);
  cloth.model = build_cloth_model(cloth.model->topology, material, cloth.model->elements);
}

void World::set_wind(const Wind& wind) {
  require_air(wind, integrator_settings_.integrator);
  wind_ = wind;
}

ContactSystem::Place World::find_place(const std::string& name) const {
  for (int c = 0; c < num_cloths(); ++c) {
    if (cloths_[c].name == name) return {c, -1, 0};
  }
  for (int c = 0; c < static_cast<int>(colliders_.size()); ++c) {
    if (colliders_[c].name == name) return {-1, c, 0};
  }
  throw InputError("there is neither a cloth nor a collider \"" + name + "\"");
}

ContactRule& World::rule_for(const std::string& a, const std::string& b) {
  ContactSystem::Place cloth = find_place(a), other = find_place(b);
  if (cloth.cloth < 0) std::swap(cloth, other);
  require(cloth.cloth >= 0,
          "\"" + a + "\" and \"" + b +
              "\" are both colliders, which do not touch each other; one of the two must be a cloth");
  if (other.cloth > cloth.cloth) std::swap(cloth, other);
  const auto is_theirs = [&](const ContactRule& r) {
    return r.cloth == cloth.cloth && r.other_cloth == other.cloth && r.collider == other.collider;
  };
  const auto known = std::find_if(rules_.begin(), rules_.end(), is_theirs);
  if (known != rules_.end()) return *known;
  return rules_.emplace_back(ContactRule{cloth.cloth, other.cloth, other.collider, {}, {}, true});
}

void World::set_friction(const std::string& a, const std::string& b, double friction,
                         double static_friction) {
  for (const double number : {friction, static_friction})
    require(std::isfinite(number) && number >= 0,
            "the friction of \"" + a + "\" and \"" + b + "\" must be 0 or more");
  ContactRule& rule = rule_for(a, b);
  rule.friction = friction;
  rule.static_friction = static_friction;
}

void World::set_collision(const std::string& a, const std::string& b, bool collide) {
  rule_for(a, b).collide = collide;
}

std::vector<std::array<std::string, 2>> World::passing_pairs() const {
  std::vector<std::array<std::string, 2>> pairs;
  for (const ContactRule& r : rules_) {
    if (r.collide) continue;
    pairs.push_back({cloths_[r.cloth].name,
                     r.other_cloth >= 0 ? cloths_[r.other_cloth].name : colliders_[r.collider].name});
  }
  return pairs;
}

void World::set_integrator(const IntegratorSettings& settings) {
  std::unique_ptr<Integrator> integrator = make_integrator(settings);  // throws before anything has changed
  for (const Cloth& cloth : cloths_) {
    if (cloth.model->elements) require_elements_move(settings.integrator, cloth.name);
  }
  require_air(wind_, settings.integrator);
  integrator_settings_ = settings;
  integrator_ = std::move(integrator);
  for (Cloth& cloth : cloths_) cloth.state.history.step = 0;
}

void World::set_environment(Cloth& cloth, double time) {
  Environment& environment = cloth.environment;
  environment.gravity = gravity_;
  environment.time = time;
  environment.wind = wind_;
  environment.pins.particle.clear();
  environment.pins.position.clear();
  poses_.clear();
  for (const Pin& pin : cloth.pins) poses_.push_back(pin.motion.at(time));
  for (const PinnedParticle& p : cloth.pinned) {
    environment.pins.particle.push_back(p.particle);
    environment.pins.position.push_back(apply(poses_[p.pin], cloth.pins[p.pin].pivot, p.anchor));
  }
}

/// As many as the cloth that needs most: they meet at the end of every one.
int World::num_substeps(double dt) const {
  int substeps = 1;
  const Environment environment{.gravity = gravity_, .wind = wind_};
  for (const Cloth& cloth : cloths_)
    substeps = std::max(substeps, integrator_->num_substeps(*cloth.model, environment, dt));
  return substeps;
}

void World::show_contact_cloths() {
  contact_cloths_.clear();
  for (Cloth& cloth : cloths_) contact_cloths_.push_back({cloth.model.get(), &cloth.state, &cloth.is_pinned});
}

void World::begin_contact(double time, double dt) {
  show_contact_cloths();
  contact_system_.begin_step(
      contact_cloths_, colliders_,
      {.time = time, .step = dt, .tracks = tracks_contacts_, .rules = rules_, .clock = &clock_});
  if (!integrator_->resolves_contacts()) return;
  pin_positions_.clear();
  for (const Cloth& cloth : cloths_) {
    const std::vector<Vec3>& pins = cloth.environment.pins.position;
    pin_positions_.insert(pin_positions_.end(), pins.begin(), pins.end());
  }
  contact_system_.predict(gravity_, pin_positions_, *jobs_);
  contact_system_.find_contacts(contacts_);
}

/// One substep of all cloths, to `time`.
void World::advance(double time, double dt, StepReport& report) {
  // Kinematics.
  for (Cloth& cloth : cloths_) set_environment(cloth, time);
  // Attachments.
  for (Cloth& cloth : cloths_) {
    cloth.held_model = &cloth.hands.begin(cloth.model, cloth.is_pinned, gravity_, dt, cloth.state);
    if (!cloth.hands.are_empty()) cloth.state.history.step = 0;  // its past does not know of the hands
  }
  // Contact candidates.
  contacts_.clear();
  if (contact_) begin_contact(time, dt);
  // The solve.
  solve(dt, report);
  if (!contact_) return;
  contact_system_.take_solved(contacts_);
  // Contact projection.
  contact_system_.hold_off(*jobs_);
  // Continuous collision detection: the fail-safe.
  stop_crossings(report);
  const int wild = contact_system_.wild_cloth();
  if (wild >= 0) is_wild_[wild] = 1;
}

/// Solves for all cloths together.
void World::solve(double dt, StepReport& report) {
  bodies_.clear();
  for (Cloth& cloth : cloths_) bodies_.push_back({cloth.held_model, &cloth.environment, &cloth.state});
  const SystemStep step{.step = dt, .tells_contact_forces = tracks_contacts_, .clock = &clock_};
  const IntegratorReport done = integrator_->advance(bodies_, contacts_, step, *jobs_);
  for (Cloth& cloth : cloths_) cloth.grab_impulse += cloth.hands.impulse(cloth.is_pinned, dt, cloth.state);
  report.iterations += done.iterations;
  add_count(done.linear_iterations, report.linear_iterations);
  add_count(done.guard_events, report.guard_events);
  if (!done.converged) report.warnings.push_back({WarningCode::not_converged, done.unconverged});
}

void World::stop_crossings(StepReport& report) {
  const LastLineReport stopped = contact_system_.stop_crossings(*jobs_);
  report.hits += stopped.hits;
  report.zones += stopped.zones;
  for (const Infeasible& pair : stopped.infeasible) add_once(describe(pair), report.infeasible);
}

std::string World::name_of(const ContactSystem::Place& place) const {
  if (place.cloth < 0) return "collider \"" + colliders_[place.collider].name + '"';
  return "cloth \"" + cloths_[place.cloth].name + '"';
}

InfeasiblePair World::describe(const Infeasible& pair) const {
  ContactSystem::Place a = contact_system_.place_of(pair.vertex), b{.collider = pair.shape};
  if (pair.shape < 0) b = contact_system_.place_of(pair.other);
  if (a.cloth < 0) std::swap(a, b);
  return {.cloth = a.cloth,
          .particle = a.cloth < 0 ? -1 : a.index,
          .other_cloth = b.cloth,
          .other_particle = b.cloth < 0 ? -1 : b.index,
          .collider = b.collider};
}

/// One sentence for every two things that cross.
std::vector<std::string> World::describe(const Knots& knots) const {
  std::vector<std::pair<std::string, int>> counts;  // what, how often; in order of the first
  const auto add = [&](const std::string& what, const auto& first) {
    const auto known = std::find_if(counts.begin(), counts.end(), [&](const auto& c) {
      return c.first.compare(0, what.size(), what) == 0;
    });
    if (known != counts.end()) return void(++known->second);
    counts.emplace_back(what + first(), 1);
  };
  for (const Pierced& p : knots.pierced) {
    const auto [i, j] = contact_system_.surface().edges[p.edge];
    const ContactSystem::Place edge = contact_system_.place_of(i), other = contact_system_.place_of(j),
                               triangle = contact_system_.place_of_triangle(p.triangle);
    add("edges of " + name_of(edge) + " run through triangles of " + name_of(triangle), [&] {
      return ", the first one between " + std::to_string(edge.index) + " and " + std::to_string(other.index) +
             " through triangle " + std::to_string(triangle.index);
    });
  }
  for (const Inside& inside : knots.inside) {
    const ContactSystem::Place place = contact_system_.place_of(inside.vertex);
    add("particles of " + name_of(place) + " are inside " + name_of({-1, inside.collider, 0}),
        [&] { return ", the first one " + std::to_string(place.index); });
  }
  std::vector<std::string> sentences;
  for (const auto& [what, count] : counts) sentences.push_back(std::to_string(count) + ' ' + what);
  return sentences;
}

std::vector<ContactPoint> World::contact_points() const {
  if (!contact_ || !tracks_contacts_) return {};
  return contact_system_.contact_points();
}

void World::set_division(const StepDivision& division) {
  require(std::isfinite(division.shortest) && division.shortest > 0,
          "the shortest part of a step must be more than 0 s");
  require(!division.enabled.value_or(false) || can_divide_steps(integrator_settings_.integrator),
          integrator_settings_.integrator + " keeps its steps; only newton and implicit_euler divide theirs");
  division_ = division;
}

bool World::divides() const {
  if (!contact_ || integrator_settings_.is_double) return false;
  const std::string& integrator = integrator_settings_.integrator;
  return can_divide_steps(integrator) && division_.enabled.value_or(integrator == "newton");
}

bool World::is_driven() const {
  const auto moves = [](const auto& thing) { return !thing.motion.is_still(); };
  if (wind_.drag > 0 || wind_.air.density > 0) return true;
  const auto is_deforming = [](const Collider& c) {
    const auto* mesh = std::get_if<MeshShape>(&c.shape);
    return mesh && mesh->sequence;
  };
  return std::any_of(colliders_.begin(), colliders_.end(), moves) ||
         std::any_of(colliders_.begin(), colliders_.end(), is_deforming) ||
         std::any_of(cloths_.begin(), cloths_.end(), [&](const Cloth& cloth) {
           return !cloth.hands.are_empty() || std::any_of(cloth.pins.begin(), cloth.pins.end(), moves);
         });
}

/// A power of two.
int World::num_parts_at_most(double dt) const {
  if (!divides()) return 1;
  constexpr double kRounding = 1e-9;
  int parts = 1;
  while (parts < kMaxParts && dt / (2 * parts) >= division_.shortest * (1 - kRounding)) parts *= 2;
  return parts;
}

/// Takes all cloths from `before` to `time` in a step of dt, and says how good it was.
StepCheck World::try_part(const Snapshot& before, double time, double dt, StepReport& report) {
  is_wild_.assign(cloths_.size(), 0);
  advance(time, dt, report);
  for (int c = 0; c < num_cloths(); ++c) {
    const int broken = find_non_finite(cloths_[c].state);
    if (broken >= 0) return {StepFault::non_finite, kForever, 0, c, broken};
  }
  for (int c = 0; c < num_cloths(); ++c) {
    if (is_wild_[c]) report.warnings.push_back({WarningCode::contact_skipped, c});
  }
  if (!divides()) return {};
  checked_.clear();
  for (int c = 0; c < num_cloths(); ++c)
    checked_.push_back({*cloths_[c].model, before.states[c], cloths_[c].state});
  StepCheck check = check_step(checked_, gravity_, dt, is_driven());
  for (int c = 0; c < num_cloths(); ++c) {
    if (is_wild_[c]) check.include({StepFault::skipped, 1, 0, c, -1});
  }
  if (!report.infeasible.empty())
    check.include({StepFault::infeasible, 1, 0, report.infeasible[0].cloth, report.infeasible[0].particle});
  return check;
}

void World::accept(const StepReport& part, StepReport& report) {
  report.substeps = std::max(report.substeps, part.substeps);
  report.iterations += part.iterations;
  add_count(part.linear_iterations, report.linear_iterations);
  add_count(part.guard_events, report.guard_events);
  report.hits += part.hits;
  report.zones += part.zones;
  for (const StepWarning& warning : part.warnings) {
    const auto is_same = [&](const StepWarning& w) {
      return w.code == warning.code && w.cloth == warning.cloth && w.fault == warning.fault;
    };
    const auto known = std::find_if(report.warnings.begin(), report.warnings.end(), is_same);
    if (known == report.warnings.end())
      report.warnings.push_back(warning);
    else if (warning.value > known->value)
      *known = warning;
  }
  for (const InfeasiblePair& pair : part.infeasible) add_once(pair, report.infeasible);
}

/// As if the step had not been made.
StepReport World::fail(const StepCheck& check, StepReport report) {
  report.ok = false;
  report.warnings.push_back({WarningCode::non_finite, check.cloth, check.particle});
  restore(before_step_);
  report.work = clock_.stop();
  return report;
}

StepReport World::step(double dt) {
  if (!std::isfinite(dt) || dt <= 0)
    throw InputError("the time step must be a finite number of seconds above 0");
  StepReport report;
  clock_.start();
  save(before_step_);
  for (Cloth& cloth : cloths_) cloth.grab_impulse.setZero();
  const int most = num_parts_at_most(dt);  // the step's units
  int parts = 1;                           // that it would have at the present length
  while (most > 1 && part_ > 0 && parts < most && dt / parts > 1.5 * part_) parts *= 2;
  report.divisions = 0;
  StepCheck worst;
  const double start = time_;
  for (int done = 0; done < most;) {
    const int size = most / parts;
    const double began = clock_.seconds();
    StepReport part;
    if (done > 0) save(before_part_);
    const Snapshot& before = done > 0 ? before_part_ : before_step_;
    grab_impulses_.clear();
    for (const Cloth& cloth : cloths_) grab_impulses_.push_back(cloth.grab_impulse);
    part.substeps = num_substeps(dt * size / most);
    StepCheck check;
    bool stands = true;
    for (int s = 1; s <= part.substeps && stands; ++s) {
      const double length = dt * size / most, end = start + dt * done / most + length * s / part.substeps;
      check = try_part(before, end, length / part.substeps, part);
      stands = check.severity < 1 || (parts == most && check.fault != StepFault::non_finite);
      if (stands && observer_) clock_.leave_out([&] { observer_(end); });
    }
    if (!stands && parts == most) return fail(check, std::move(report));
    if (!stands) {
      restore_motion(before);
      for (std::size_t c = 0; c < cloths_.size(); ++c) cloths_[c].grab_impulse = grab_impulses_[c];
      parts = std::min(most, check.severity > kFarTooLong ? 4 * parts : 2 * parts);
      calm_ = 0;
      ++report.retries;
      worst.include(check);
      clock_.times.retries += clock_.seconds() - began;
      continue;
    }
    if (check.severity >= 1 && most > 1)
      part.warnings.push_back(
          {WarningCode::cap_reached, check.cloth, check.particle, check.value, check.fault});
    accept(part, report);
    ++report.divisions;
    done += size;
    calm_ = check.severity < kCalm ? std::min(calm_ + 1, kCalmParts) : 0;
    if (parts > 1 && calm_ >= kCalmParts && done % (2 * size) == 0) {
      parts /= 2;
      calm_ = 0;
    }
    for (Cloth& cloth : cloths_) follow_cloth(cloth.state);
  }
  if (report.retries > 0) report.fault = worst.fault;
  part_ = parts > 1 ? dt / parts : 0;
  time_ = start + dt;
  report.work = clock_.stop();
  return report;
}

void World::save(Snapshot& snapshot) const {
  snapshot.time = time_;
  snapshot.part = part_;
  snapshot.calm = calm_;
  snapshot.states.resize(cloths_.size());
  for (std::size_t c = 0; c < cloths_.size(); ++c) snapshot.states[c] = cloths_[c].state;
}

World::Snapshot World::snapshot() const {
  Snapshot snapshot;
  save(snapshot);
  return snapshot;
}

void World::restore(const Snapshot& snapshot) {
  require(snapshot.states.size() == cloths_.size(),
          "the snapshot has another number of cloths than the world");
  for (std::size_t c = 0; c < cloths_.size(); ++c) {
    require(snapshot.states[c].x.size() == cloths_[c].state.x.size(),
            "the snapshot's cloth \"" + cloths_[c].name + "\" has another number of particles");
  }
  time_ = snapshot.time;
  part_ = snapshot.part;
  calm_ = snapshot.calm;
  restore_motion(snapshot);
}

void World::restore_motion(const Snapshot& snapshot) {
  for (std::size_t c = 0; c < cloths_.size(); ++c) cloths_[c].state = snapshot.states[c];
}

std::uint64_t World::state_hash() const {
  Hash hash;
  hash.add(time_);
  for (const Cloth& cloth : cloths_) add_to_hash(cloth.state, hash);
  return hash.value();
}

}  // namespace weft
