/// Worlds and batches of worlds.

#include <nanobind/stl/array.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/tuple.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/variant.h>
#include <memory>

#include "locked_world.h"
#include "weft/scene.h"

namespace weft::python {
namespace {

/// Keeps the memory of a view, and its world.
struct ViewOwner {
  std::shared_ptr<const float> memory;
  nb::object world;
};

nb::ndarray<nb::numpy, const float> view_offsets(nb::handle_t<LockedWorld> self, const ClothId& id) {
  const ClothOffsets view = nb::cast<LockedWorld&>(self).world->offsets(id);
  auto* own = new ViewOwner{view.data, nb::borrow(self)};
  const nb::capsule owner(own, [](void* p) noexcept { delete static_cast<ViewOwner*>(p); });
  return nb::ndarray<nb::numpy, const float>(view.data.get(), {view.num_particles, 3}, owner,
                                             {1, static_cast<std::int64_t>(view.stride)});
}

template <class Number>
using Output = nb::ndarray<Number, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

/// Sizes are checked by the package's Python half, and here again: cloth may have torn since.
template <class Number, class Copy>
void copy_to(const Output<Number>& out, LockedWorld& own, const ClothId& id, const Copy& copy) {
  Number* const data = out.data();
  const std::size_t count = out.shape(0);
  with(own, [&](const World& world) {
    if (std::cmp_not_equal(count, world.num_particles(id))) throw InputError("the cloth has torn meanwhile");
    copy(world, data);
  });
}
template <class Number>
void copy_positions(LockedWorld& own, const ClothId& id, const Output<Number>& out) {
  copy_to(out, own, id, [&](const World& world, Number* data) { world.copy_positions(id, data); });
}
template <class Number>
void copy_velocities(LockedWorld& own, const ClothId& id, const Output<Number>& out) {
  copy_to(out, own, id, [&](const World& world, Number* data) { world.copy_velocities(id, data); });
}
template <class Number>
void copy_normals(LockedWorld& own, const ClothId& id, const Output<Number>& out) {
  copy_to(out, own, id, [&](const World& world, Number* data) { world.copy_normals(id, data); });
}

/// A world as bytes.
nb::bytes to_bytes(const std::vector<std::byte>& bytes) { return nb::bytes(bytes.data(), bytes.size()); }

std::string to_hex(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

BodyId to_body(nb::handle body) {
  if (nb::isinstance<ClothId>(body)) return nb::cast<ClothId>(body);
  return nb::cast<ColliderId>(body);
}

struct StrainRow {
  double warp, weft, shear, min_stretch, max_stretch;
};

/// One row per contact, as NumPy's structured array in the package's Python half.
struct ContactRow {
  double position[3], normal[3], force[3];
  int cloth, particle, other_cloth, collider, other_vertex;
  int padding = 0;
};

std::vector<ContactRow> list_contacts(const World& world) {
  const auto index_of = [](const World& w, const auto& id, int count, auto nth) {
    for (int n = 0; n < count; ++n)
      if (nth(w, n) == id) return n;
    return -1;
  };
  const auto cloth_of = [&](const ClothId& id) {
    return index_of(world, id, world.num_cloths(), [](const World& w, int n) { return w.cloth(n); });
  };
  std::vector<ContactRow> rows;
  for (const ContactPoint& p : world.contact_points()) {
    ContactRow row{.position = {p.position.x, p.position.y, p.position.z},
                   .normal = {p.normal.x, p.normal.y, p.normal.z},
                   .force = {p.force.x, p.force.y, p.force.z},
                   .cloth = cloth_of(p.cloth),
                   .particle = p.particle,
                   .other_cloth = p.other_cloth ? cloth_of(*p.other_cloth) : -1,
                   .collider = -1,
                   .other_vertex = p.other_vertex};
    if (p.collider)
      row.collider = index_of(world, *p.collider, world.num_colliders(),
                              [](const World& w, int n) { return w.collider(n); });
    rows.push_back(row);
  }
  return rows;
}

nb::ndarray<nb::numpy, std::uint8_t> contact_bytes(LockedWorld& own) {
  std::vector<ContactRow> rows = with(own, list_contacts);
  return make_array<std::uint8_t>(std::move(rows), {sizeof(ContactRow)});
}

nb::object to_dict(const std::optional<SurfacePoint>& point) {
  if (!point) return nb::none();
  nb::dict found;
  found["cloth"] = point->cloth;
  found["triangle"] = point->triangle;
  found["weights"] = point->weights;
  found["position"] = point->position;
  found["distance"] = point->distance;
  return found;
}

void bind_ids(nb::module_& m) {
  const auto bind = [&]<class Id>(const char* name, Id) {
    nb::class_<Id>(m, name)
        .def(
            "__eq__", [](const Id& a, nb::handle b) { return nb::isinstance<Id>(b) && a == nb::cast<Id>(b); },
            nb::sig("def __eq__(self, other: object, /) -> bool"))
        .def("__hash__",
             [](const Id& id) { return (static_cast<std::uint64_t>(id.world) << 32) ^ id.number; })
        .def_prop_ro("number", [](const Id& id) { return id.number; })
        .def(
            "__deepcopy__", [](const Id& id, nb::handle) { return id; }, nb::arg("memo"));
  };
  bind("ClothId", ClothId{});
  bind("ColliderId", ColliderId{});
}

ClothId add_cloth(LockedWorld& own, ClothDesc desc) {
  return with(own, [&](World& world) { return world.add_cloth(desc); });
}

std::variant<Fabric, Springs> to_substance(nb::handle fabric) {
  if (nb::isinstance<Springs>(fabric)) return nb::cast<Springs>(fabric);
  return nb::cast<Fabric>(fabric);
}

void bind_bodies(nb::class_<LockedWorld>& c) {
  c.def("add_cloth",
        [](LockedWorld& own, const std::string& name, nb::handle shape, const std::string& source,
           nb::handle fabric, const std::string& fabric_name, const std::string& membrane,
           std::optional<Vec3> warp, const std::string& model, const Vec3& position, const Matrix& rotation,
           const Vec3& velocity, std::optional<double> weld, double sew, const std::optional<Vectors>& rest,
           const std::vector<std::tuple<Indices, double, double>>& rest_scales,
           const std::vector<std::pair<Indices, Indices>>& seams,
           const std::vector<std::array<int, 2>>& stitches, double seam_time,
           std::optional<double> seam_stiffness, int layer, bool fits_thickness) {
          ClothDesc desc{.name = name,
                         .source = source,
                         .fabric = to_substance(fabric),
                         .fabric_name = fabric_name,
                         .membrane = value_of<Membrane>(membrane),
                         .warp = warp,
                         .model = value_of<SpringModel>(model),
                         .pose = to_pose(position, rotation),
                         .velocity = velocity,
                         .weld = weld,
                         .sew = sew,
                         .stitches = stitches,
                         .seam_time = seam_time,
                         .seam_stiffness = seam_stiffness,
                         .layer = layer,
                         .fits_thickness = fits_thickness};
          for (std::size_t c = 0; rest && c < rest->shape(0); c += 3) {
            const auto at = [&](std::size_t k) {
              return Vec3{(*rest)(c + k, 0), (*rest)(c + k, 1), (*rest)(c + k, 2)};
            };
            desc.rest.push_back({at(0), at(1), at(2)});
          }
          for (const auto& [vertices, warp_factor, weft_factor] : rest_scales)
            desc.rest_scales.push_back({to_indices(vertices), warp_factor, weft_factor});
          for (const auto& [a, b] : seams) desc.seams.push_back({to_indices(a), to_indices(b)});
          if (nb::isinstance<Grid>(shape)) {
            desc.shape = nb::cast<Grid>(shape);
          } else {
            desc.shape = to_mesh(nb::cast<Vectors>(shape[0]), nb::cast<Triangles>(shape[1]),
                                 nb::cast<std::optional<CornerUvs>>(shape[2]));
          }
          return add_cloth(own, std::move(desc));
        });
  c.def("add_collider",
        [](LockedWorld& own, const std::string& name, nb::handle shape, const std::string& source,
           std::optional<bool> solid, const Vec3& position, const Matrix& rotation,
           std::vector<KeyFrame> motion, nb::handle frames, std::optional<VertexMotion> deformation,
           double deformation_start, double friction, double static_friction) {
          ColliderDesc desc{.name = name,
                            .source = source,
                            .solid = solid,
                            .pose = to_pose(position, rotation),
                            .motion = std::move(motion),
                            .deformation = deformation.value_or(VertexMotion()),
                            .deformation_start = deformation_start,
                            .friction = friction,
                            .static_friction = static_friction};
          if (nb::isinstance<Sphere>(shape))
            desc.shape = nb::cast<Sphere>(shape);
          else if (nb::isinstance<Plane>(shape))
            desc.shape = nb::cast<Plane>(shape);
          else if (nb::isinstance<Capsule>(shape))
            desc.shape = nb::cast<Capsule>(shape);
          else if (nb::isinstance<OrientedBox>(shape))
            desc.shape = nb::cast<OrientedBox>(shape);
          else
            desc.shape = to_mesh(nb::cast<Vectors>(shape[0]), nb::cast<Triangles>(shape[1]), std::nullopt);
          for (nb::handle frame : frames)
            desc.frames.push_back({nb::cast<double>(frame[0]), to_vectors(nb::cast<Vectors>(frame[1]))});
          return with(own, [&](World& world) { return world.add_collider(desc); });
        });
  c.def("remove", [](LockedWorld& own, const ClothId& id) { with(own, [&](World& w) { w.remove(id); }); });
  c.def("remove", [](LockedWorld& own, const ColliderId& id) { with(own, [&](World& w) { w.remove(id); }); });
  c.def("contains", get<bool, ClothId>(&World::contains));
  c.def("contains", get<bool, ColliderId>(&World::contains));
  c.def("cloth_ids", [](LockedWorld& own) {
    return with(own, [](const World& w) {
      std::vector<ClothId> ids;
      for (int n = 0; n < w.num_cloths(); ++n) ids.push_back(w.cloth(n));
      return ids;
    });
  });
  c.def("collider_ids", [](LockedWorld& own) {
    return with(own, [](const World& w) {
      std::vector<ColliderId> ids;
      for (int n = 0; n < w.num_colliders(); ++n) ids.push_back(w.collider(n));
      return ids;
    });
  });
  c.def("name", get<std::string, ClothId>(&World::name));
  c.def("name", get<std::string, ColliderId>(&World::name));
  c.def(
      "notes",
      [](LockedWorld& own, const ClothId& id) {
        const ClothNotes notes = with(own, [&](const World& w) { return w.notes(id); });
        return nb::make_tuple(make_array<int>(std::vector<int>(notes.particle_of_vertex), {}), notes.warnings,
                              notes.done);
      },
      nb::sig("def notes(self, id: ClothId) -> tuple[NDArray[numpy.int32], list[str], list[str]]"));
  c.def("warnings", [](LockedWorld& own, const ColliderId& id) {
    return with(own, [&](const World& w) { return w.warnings(id); });
  });
  c.def("grid", [](LockedWorld& own, const ClothId& id) -> std::optional<Grid> {
    return with(own, [&](const World& w) {
      const Grid* grid = std::get_if<Grid>(&w.description(id).shape);
      return grid ? std::optional(*grid) : std::nullopt;
    });
  });
  c.def(
      "fabric",
      [](LockedWorld& own, const ClothId& id) {
        return with(own, [&](const World& w) { return w.description(id).fabric; });
      },
      nb::sig("def fabric(self, id: ClothId) -> Fabric | Springs"));
  c.def("friction", [](LockedWorld& own, const ColliderId& id) {
    return with(own, [&](const World& w) {
      const ColliderDesc& desc = w.description(id);
      return std::pair(desc.friction, desc.static_friction);
    });
  });
}

void bind_motion(nb::class_<LockedWorld>& c) {
  c.def("move_collider",
        [](LockedWorld& own, const ColliderId& id, const Vec3& translation, const Matrix& rotation) {
          const Pose pose = to_pose(translation, rotation);
          with(own, [&](World& w) { w.move_collider(id, pose); });
        });
  c.def("place_collider",
        [](LockedWorld& own, const ColliderId& id, const Vec3& translation, const Matrix& rotation) {
          const Pose pose = to_pose(translation, rotation);
          with(own, [&](World& w) { w.place_collider(id, pose); });
        });
  c.def(
      "pose",
      [](LockedWorld& own, const ColliderId& id) {
        const Pose pose = with(own, [&](const World& w) { return w.pose(id); });
        return nb::make_tuple(
            pose.translation,
            make_array(std::vector<Vec3>{pose.rotation.row0, pose.rotation.row1, pose.rotation.row2}));
      },
      nb::sig("def pose(self, id: ColliderId) -> tuple[tuple[float, float, float], NDArray[numpy.float64]]"));
  c.def("move_vertices", [](LockedWorld& own, const ColliderId& id, const Vectors& positions) {
    const std::vector<Vec3> at_end = to_vectors(positions);
    with(own, [&](World& w) { w.move_vertices(id, at_end); });
  });
  c.def("place_vertices", [](LockedWorld& own, const ColliderId& id, const Vectors& positions) {
    const std::vector<Vec3> places = to_vectors(positions);
    with(own, [&](World& w) { w.place_vertices(id, places); });
  });
  c.def("add_pin", [](LockedWorld& own, const ClothId& id, const Indices& particles,
                      std::vector<KeyFrame> motion, const Vec3& pivot, std::optional<ColliderId> follow,
                      std::optional<double> stiffness, double damping) {
    const Pin pin{.particles = to_indices(particles),
                  .motion = std::move(motion),
                  .pivot = pivot,
                  .follow = follow,
                  .stiffness = stiffness,
                  .damping = damping};
    with(own, [&](World& w) { w.add_pin(id, pin); });
  });
  c.def("unpin", [](LockedWorld& own, const ClothId& id, const Indices& particles) {
    const std::vector<int> released = to_indices(particles);
    with(own, [&](World& w) { w.unpin(id, released); });
  });
  c.def("pinned_particles", [](LockedWorld& own, const ClothId& id) {
    return make_array<int>(with(own, [&](const World& w) { return w.pinned_particles(id); }), {});
  });
  c.def("move_pins",
        [](LockedWorld& own, const ClothId& id, const Indices& particles, const Vectors& positions) {
          const std::vector<int> moved = to_indices(particles);
          const std::vector<Vec3> at_end = to_vectors(positions);
          with(own, [&](World& w) { w.move_pins(id, moved, at_end); });
        });
  c.def("set_forces", [](LockedWorld& own, const ClothId& id, const Vectors& forces) {
    const std::vector<Vec3> given = to_vectors(forces);
    with(own, [&](World& w) { w.set_forces(id, given); });
  });
  c.def("set_pressure", [](LockedWorld& own, const ClothId& id, double pressure, bool sealed) {
    with(own, [&](World& w) { w.set_pressure(id, pressure, sealed); });
  });
  c.def("pressure", [](LockedWorld& own, const ClothId& id) {
    return with(own, [&](const World& w) { return w.pressure(id); });
  });
  c.def("volume", [](LockedWorld& own, const ClothId& id) {
    return with(own, [&](const World& w) { return w.volume(id); });
  });
  c.def("set_positions", [](LockedWorld& own, const ClothId& id, const Vectors& positions) {
    const std::vector<Vec3> given = to_vectors(positions);
    with(own, [&](World& w) { w.set_positions(id, given); });
  });
  c.def("set_velocities", [](LockedWorld& own, const ClothId& id, const Vectors& velocities) {
    const std::vector<Vec3> given = to_vectors(velocities);
    with(own, [&](World& w) { w.set_velocities(id, given); });
  });
  c.def("teleport", [](LockedWorld& own, const ClothId& id, const Vec3& translation, const Matrix& rotation,
                       bool keeps_velocity) {
    const Pose pose = to_pose(translation, rotation);
    with(own, [&](World& w) { w.teleport(id, pose, keeps_velocity); });
  });
}

void bind_settings(nb::class_<LockedWorld>& c) {
  c.def("set_fabric", [](LockedWorld& own, const ClothId& id, nb::handle fabric) {
    const std::variant<Fabric, Springs> given = to_substance(fabric);
    with(own, [&](World& w) { w.set_fabric(id, given); });
  });
  c.def("stiffen", [](LockedWorld& own, const ClothId& id, const Indices& particles, double factor) {
    const std::vector<int> chosen = to_indices(particles);
    with(own, [&](World& w) { w.stiffen(id, chosen, factor); });
  });
  c.def("set_friction", [](LockedWorld& own, const ColliderId& id, double friction, double static_friction) {
    with(own, [&](World& w) { w.set_friction(id, friction, static_friction); });
  });
  c.def("set_pair_friction",
        [](LockedWorld& own, nb::handle a, nb::handle b, double friction, double static_friction) {
          const BodyId first = to_body(a), second = to_body(b);
          with(own, [&](World& w) { w.set_friction(first, second, friction, static_friction); });
        });
  c.def("set_collision", [](LockedWorld& own, nb::handle a, nb::handle b, bool collide) {
    const BodyId first = to_body(a), second = to_body(b);
    with(own, [&](World& w) { w.set_collision(first, second, collide); });
  });
  c.def_prop_rw("gravity", get(&World::gravity), [](LockedWorld& own, const Vec3& gravity) {
    with(own, [&](World& w) { w.set_gravity(gravity); });
  });
  c.def_prop_rw("wind", get(&World::wind),
                [](LockedWorld& own, const Wind& wind) { with(own, [&](World& w) { w.set_wind(wind); }); });
  c.def_prop_rw("integrator", get(&World::integrator),
                [](LockedWorld& own, const IntegratorSettings& settings) {
                  with(own, [&](World& w) { w.set_integrator(settings); });
                });
  c.def_prop_rw("division", get(&World::division), [](LockedWorld& own, const StepDivision& division) {
    with(own, [&](World& w) { w.set_division(division); });
  });
  c.def_prop_rw("contact", get(&World::contact), [](LockedWorld& own, const ContactSettings& contact) {
    with(own, [&](World& w) { w.set_contact(contact); });
  });
  c.def_prop_rw(
      "threads", [](LockedWorld& own) { return own.threads; },
      [](LockedWorld& own, int threads) {
        if (own.is_busy) throw std::runtime_error("another thread is using this world");
        own.set_threads(threads);
      });
}

void bind_reading(nb::class_<LockedWorld>& c) {
  c.def("num_particles", get<int, ClothId>(&World::num_particles));
  c.def("faces", [](LockedWorld& own, const ClothId& id) {
    return make_array<int>(with(own, [&](const World& w) { return std::vector<Triangle>(w.triangles(id)); }),
                           {3});
  });
  c.def("uv", [](LockedWorld& own, const ClothId& id) {
    return make_array<double>(with(own, [&](const World& w) { return w.uv(id); }), {3, 2});
  });
  c.def("rest_positions", [](LockedWorld& own, const ClothId& id) {
    return make_array(with(own, [&](const World& w) { return w.rest_positions(id); }));
  });
  c.def("offsets", view_offsets, nb::sig("def offsets(self, id: ClothId) -> NDArray[numpy.float32]"));
  c.def("origin", [](LockedWorld& own, const ClothId& id) {
    return with(own, [&](const World& w) { return w.offsets(id).origin; });
  });
  c.def("copy_positions", copy_positions<double>);
  c.def("copy_positions", copy_positions<float>);
  c.def("copy_velocities", copy_velocities<double>);
  c.def("copy_velocities", copy_velocities<float>);
  c.def("copy_normals", copy_normals<double>);
  c.def("copy_normals", copy_normals<float>);
  c.def("vertex_positions", [](LockedWorld& own, const ClothId& id) {
    return make_array(with(own, [&](const World& w) { return w.vertex_positions(id); }));
  });
  c.def("masses", [](LockedWorld& own, const ClothId& id) {
    return make_array<double>(with(own, [&](const World& w) { return w.masses(id); }), {});
  });
  c.def("forces", [](LockedWorld& own, const ClothId& id, const std::optional<std::string>& kind) {
    const std::optional<ForceKind> one = kind ? std::optional(value_of<ForceKind>(*kind)) : std::nullopt;
    return make_array(with(own, [&](const World& w) { return one ? w.forces(id, *one) : w.forces(id); }));
  });
  c.def("pin_forces", [](LockedWorld& own, const ClothId& id) {
    return make_array(with(own, [&](const World& w) { return w.pin_forces(id); }));
  });
  c.def("spring_strains", [](LockedWorld& own, const ClothId& id) {
    return make_array<double>(with(own, [&](const World& w) { return w.spring_strains(id); }), {});
  });
  c.def("triangle_strains", [](LockedWorld& own, const ClothId& id) {
    static_assert(sizeof(TriangleStrain) == sizeof(StrainRow));
    return make_array<double>(with(own, [&](const World& w) { return w.triangle_strains(id); }), {5});
  });
  c.def("contacts", contact_bytes);
  c.def(
      "energies",
      [](LockedWorld& own) {
        const Energies e = with(own, [](const World& w) { return w.energies(); });
        return nb::make_tuple(e.kinetic, e.elastic, e.bending, e.gravitational);
      },
      nb::sig("def energies(self) -> tuple[float, float, float, float]"));
  c.def("momentum", [](LockedWorld& own, const ClothId& id) {
    return with(own, [&](const World& w) { return w.momentum(id); });
  });
  c.def("center_of_mass", [](LockedWorld& own, const ClothId& id) {
    return with(own, [&](const World& w) { return w.center_of_mass(id); });
  });
  c.def(
      "cast_ray",
      [](LockedWorld& own, const Vec3& origin, const Vec3& direction, double reach) {
        return to_dict(with(own, [&](const World& w) { return w.cast_ray(origin, direction, reach); }));
      },
      nb::sig("def cast_ray(self, origin: tuple[float, float, float], direction: tuple[float, float, float], "
              "reach: float) "
              "-> dict[str, typing.Any] | None"));
  c.def(
      "closest_point",
      [](LockedWorld& own, const Vec3& point, double reach) {
        return to_dict(with(own, [&](const World& w) { return w.closest_point(point, reach); }));
      },
      nb::sig("def closest_point(self, point: tuple[float, float, float], reach: float) -> dict[str, "
              "typing.Any] | None"));
}

/// Worlds of a batch as Python objects, which a step of the batch keeps from other calls.
struct LockedBatch {
  std::shared_ptr<WorldBatch> batch;
  std::vector<std::shared_ptr<LockedWorld>> worlds;
  int threads;
  pid_t process = getpid();

  explicit LockedBatch(int count) : batch(std::make_shared<WorldBatch>(make_jobs(count))), threads(count) {}

  void add(LockedWorld& own) {
    batch->add(with(own, [](const World& w) { return w.clone(); }));
  }

  /// After the last add().
  void make_worlds() {
    for (int w = 0; w < batch->size(); ++w)
      worlds.push_back(std::make_shared<LockedWorld>(std::shared_ptr<World>(batch, &(*batch)[w])));
  }
};

/// Use of all worlds of a batch by a call, without Python's global lock.
class UseBatch {
 public:
  explicit UseBatch(LockedBatch& own) {
    if (own.threads > 1 && own.process != getpid())
      throw std::runtime_error(
          "the threads of this batch did not survive fork(); start processes with multiprocessing's "
          "\"spawn\"");
    for (const auto& world : own.worlds) {
      if (world->is_busy.exchange(true)) {
        release_worlds();
        throw std::runtime_error("another thread is using a world of this batch; use a lock");
      }
      used_.push_back(world.get());
    }
    release_.emplace();
  }
  ~UseBatch() { release_worlds(); }
  UseBatch(const UseBatch&) = delete;
  UseBatch& operator=(const UseBatch&) = delete;

 private:
  void release_worlds() {
    for (LockedWorld* world : used_) world->is_busy = false;
  }

  std::vector<LockedWorld*> used_;
  std::optional<nb::gil_scoped_release> release_;
};

/// Targets of pins for several steps, of the same particles in every world.
struct Targets {
  std::vector<ClothId> cloths;  // (worlds)
  std::vector<int> particles;
  nb::ndarray<const double, nb::shape<-1, -1, -1, 3>, nb::c_contig, nb::device::cpu>
      goals;  // (worlds, steps, …)

  void apply(int w, std::size_t step, World& world) const {
    const double* at = &goals(static_cast<std::size_t>(w), step, 0, 0);
    std::vector<Vec3> targets;
    for (std::size_t k = 0; k < particles.size(); ++k, at += 3) targets.push_back({at[0], at[1], at[2]});
    world.move_pins(cloths[static_cast<std::size_t>(w)], particles, targets);
  }
};

/// An array to fill with positions or velocities after each step.
struct Recording {
  std::vector<ClothId> cloths;  // (worlds)
  bool is_velocity = false;
  nb::ndarray<float, nb::shape<-1, -1, -1, 3>, nb::c_contig, nb::device::cpu>
      out;  // (worlds, steps, particles)

  /// Of cloth that has torn, the particles that it had.
  void copy(int w, std::size_t step, const World& world) const {
    float* const to = &out(static_cast<std::size_t>(w), step, 0, 0);
    const ClothId& cloth = cloths[static_cast<std::size_t>(w)];
    const std::size_t count = out.shape(2), present = static_cast<std::size_t>(world.num_particles(cloth));
    std::vector<float> all(present > count ? 3 * present : 0);
    float* const into = all.empty() ? to : all.data();
    is_velocity ? world.copy_velocities(cloth, into) : world.copy_positions(cloth, into);
    if (!all.empty()) std::copy_n(all.data(), 3 * count, to);
  }
};

/// Several steps of a batch. A failed step of a world ends them, and Ctrl-C between two. Returns of each world the first
/// report that is not clean, else the last one.
std::vector<StepReport> step_batch(LockedBatch& own, double dt, int num_steps,
                                   const std::vector<Targets*>& targets,
                                   const std::vector<Recording*>& recordings) {
  std::vector<StepReport> reports(static_cast<std::size_t>(own.batch->size()));
  const UseBatch use(own);
  std::optional<nb::python_error> raised;
  for (int step = 0; step < num_steps && !raised; ++step) {
    const auto s = static_cast<std::size_t>(step);
    std::vector<StepReport> now = own.batch->step(dt, {.before =
                                                           [&](int w, World& world) {
                                                             for (const Targets* t : targets)
                                                               t->apply(w, s, world);
                                                           },
                                                       .after =
                                                           [&](int w, World& world, const StepReport&) {
                                                             for (const Recording* r : recordings)
                                                               r->copy(w, s, world);
                                                           }});
    bool has_failed = false;
    for (std::size_t w = 0; w < now.size(); ++w) {
      has_failed |= !now[w].ok;
      if (!now[w].ok || reports[w].warnings.empty()) reports[w] = std::move(now[w]);
    }
    if (has_failed || step + 1 == num_steps) break;
    const nb::gil_scoped_acquire hold;
    if (PyErr_CheckSignals() != 0) raised.emplace();
  }
  if (raised) throw std::move(*raised);
  return reports;
}

void bind_batch(nb::module_& m) {
  nb::class_<Targets>(m, "Targets")
      .def("__init__", [](Targets* self, std::vector<ClothId> cloths, const Indices& particles,
                          decltype(Targets::goals) goals) {
        new (self) Targets{std::move(cloths), to_indices(particles), std::move(goals)};
      });
  nb::class_<Recording>(m, "Recording")
      .def("__init__",
           [](Recording* self, std::vector<ClothId> cloths, bool is_velocity, decltype(Recording::out) out) {
             new (self) Recording{std::move(cloths), is_velocity, std::move(out)};
           })
      .def("copy", [](Recording& self, LockedBatch& own) {
        const UseBatch use(own);
        for (int w = 0; w < own.batch->size(); ++w) self.copy(w, 0, (*own.batch)[w]);
      });
  nb::class_<LockedBatch>(m, "Batch")
      .def("__init__", [](LockedBatch* self, int threads) { new (self) LockedBatch(threads); })
      .def("add", &LockedBatch::add)
      .def("make_worlds", &LockedBatch::make_worlds)
      .def("world", [](LockedBatch& own, int w) { return own.worlds.at(static_cast<std::size_t>(w)); })
      .def("step", step_batch)
      .def("reset", [](LockedBatch& own, const Indices& worlds) {
        const std::vector<int> chosen = to_indices(worlds);
        const UseBatch use(own);
        own.batch->reset(chosen);
      });
}

/// Bound before functions that take it.
void bind_vertex_motion(nb::module_& m) {
  nb::class_<VertexMotion>(
      m, "VertexMotion",
      "Vertices of a mesh as a function of time: skins, morph targets and nodes of a glTF "
      "file. From `read_gltf`.")
      .def_prop_ro("num_vertices", &VertexMotion::num_vertices, "The number of vertices.")
      .def_prop_ro("start", &VertexMotion::start, "Time of the first key [s].")
      .def_prop_ro("end", &VertexMotion::end, "Time of the last key [s].")
      .def(
          "positions",
          [](const VertexMotion& motion, double time) { return make_array(motion.positions(time)); },
          nb::arg("time"), nb::sig("def positions(self, time: float) -> NDArray[numpy.float64]"),
          "Positions at a time [s]: (num_vertices, 3), constant before `start` and after `end` [m].");
}

}  // namespace

void bind_world(nb::module_& m) {
  bind_vertex_motion(m);
  bind_ids(m);
  nb::class_<Snapshot>(m, "Snapshot").attr("__doc__") = "State of a world at a time, from `World.snapshot`.";
  nb::class_<LockedWorld> c(m, "World");
  c.def("__init__", [](LockedWorld* self) { new (self) LockedWorld(World()); });
  bind_bodies(c);
  bind_motion(c);
  bind_settings(c);
  bind_reading(c);
  c.def("untangle", [](LockedWorld& own) { return with(own, [](World& w) { return w.untangle(); }); });
  c.def("step", [](LockedWorld& own, double dt) { return with(own, [&](World& w) { return w.step(dt); }); });
  c.def_prop_ro("time", get(&World::time));
  c.def("clone", [](LockedWorld& own) {
    auto copy = std::make_unique<LockedWorld>(with(own, [](const World& w) { return w.clone(); }));
    copy->set_threads(own.threads);
    return copy;
  });
  c.def("snapshot", [](LockedWorld& own) { return with(own, [](const World& w) { return w.snapshot(); }); });
  c.def("restore", [](LockedWorld& own, const Snapshot& s) { with(own, [&](World& w) { w.restore(s); }); });
  c.def(
      "save", [](LockedWorld& own) { return to_bytes(with(own, [](const World& w) { return w.save(); })); },
      nb::sig("def save(self) -> bytes"));
  c.def_static("load", [](const nb::bytes& bytes) {
    const std::span<const std::byte> all(static_cast<const std::byte*>(bytes.data()), bytes.size());
    const nb::gil_scoped_release release;
    return std::make_unique<LockedWorld>(World::load(all));
  });
  c.def("state_hash",
        [](LockedWorld& own) { return to_hex(with(own, [](const World& w) { return w.state_hash(); })); });
  c.def("describe", [](LockedWorld& own, const StepWarning& warning) {
    return with(own, [&](const World& w) { return describe(w, warning); });
  });
  c.def("find_problems",
        [](LockedWorld& own) { return with(own, [](const World& w) { return find_problems(w); }); });
  bind_batch(m);
}

}  // namespace weft::python
