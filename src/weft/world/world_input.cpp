#include "weft/world/world_input.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "weft/integrators/integrator.h"
#include "weft/mesh/solid.h"

namespace weft::engine {
namespace {

constexpr double kRounding = 1e-6;  // tolerance of unit vectors and rotations [1]

std::string in_words(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

std::string in_words(const Vec3& v) {
  return '(' + in_words(v.x()) + ", " + in_words(v.y()) + ", " + in_words(v.z()) + ')';
}

bool is_rotation(const Mat3& r) {
  return r.allFinite() && (r.transpose() * r - Mat3::Identity()).cwiseAbs().maxCoeff() < kRounding &&
         r.determinant() > 0;
}

/// Validates a collider's shape.
struct ShapeChecker {
  std::string who;

  void finite(const Vec3& p, const char* what) const {
    require(p.allFinite(), who + what + " must be finite, not " + in_words(p));
  }
  void positive(double value, const char* what) const {
    require(std::isfinite(value) && value > 0, who + what + " must be more than 0 m, not " + in_words(value));
  }
  void rotation(const Mat3& r) const {
    require(is_rotation(r), who +
                                "its rotation is invalid: columns must be perpendicular unit vectors, "
                                "right-handed");
  }

  void operator()(const Sphere& s) const {
    finite(s.center, "its centre");
    positive(s.radius, "its radius");
  }
  void operator()(const Plane& p) const {
    finite(p.point, "its point");
    require(std::abs(p.normal.norm() - 1) < kRounding,
            who + "its normal must have length 1, but is " + in_words(p.normal));
  }
  void operator()(const Capsule& c) const {
    finite(c.a, "its end a");
    finite(c.b, "its end b");
    positive(c.radius, "its radius");
  }
  void operator()(const OrientedBox& b) const {
    finite(b.center, "its centre");
    for (int axis = 0; axis < 3; ++axis) positive(b.half_size[axis], "its half size");
    rotation(b.rotation);
  }
  void operator()(const MeshShape& m) const {
    require(m.mesh != nullptr, who + "it has no mesh");
    try {
      require_valid(*m.mesh);
    } catch (const InputError& error) {
      throw InputError(who + error.what());
    }
    rotation(m.rotation);
    finite(m.translation, "its translation");
    require(!m.source || m.source->num_vertices() == m.mesh->num_vertices(),
            who + "its motion and its mesh have different numbers of vertices");
  }
};

}  // namespace

void require_valid(const ClothMaterial& m, const std::string& cloth) {
  const auto at_least_zero = [&](double value, const char* name) {
    require(std::isfinite(value) && value >= 0, "cloth \"" + cloth + "\": " + name + " must be 0 or more");
  };
  require(std::isfinite(m.density) && m.density > 0,
          "cloth \"" + cloth + "\": density must be more than 0 kg/m²");
  at_least_zero(m.structural, "structural stiffness");
  at_least_zero(m.structural_z.value_or(0), "structural stiffness along z");
  at_least_zero(m.shear, "shear stiffness");
  at_least_zero(m.bend, "bending stiffness");
  at_least_zero(m.damping, "damping");
  at_least_zero(m.damping_time, "damping time");
  at_least_zero(m.thickness, "thickness");
  at_least_zero(m.friction, "friction");
}

void require_valid(const ClothTopology& topology, const std::string& cloth) {
  const std::string who = "cloth \"" + cloth + "\": ";
  try {
    if (!topology.mesh.triangles.empty()) require_valid(topology.mesh);  // chains have no triangles
  } catch (const InputError& error) {
    throw InputError(who + error.what());
  }
  const int n = topology.num_particles();
  require(static_cast<int>(topology.area.size()) == n, who + "its topology has " +
                                                           std::to_string(topology.area.size()) +
                                                           " areas for " + std::to_string(n) + " particles");
  for (int i = 0; i < n; ++i) {
    require(std::isfinite(topology.area[i]) && topology.area[i] > 0,
            who + "particle " + std::to_string(i) +
                " has no area: is it in no triangle? clean_mesh() removes such vertices");
  }
  for (const Spring& s : topology.springs) {
    require(s.i >= 0 && s.i < n && s.j >= 0 && s.j < n && s.i != s.j,
            who + "a spring joins particles " + std::to_string(s.i) + " and " + std::to_string(s.j) +
                ", but there are " + std::to_string(n));
  }
}

void require_valid(const Collider& collider) {
  const std::string who = "collider \"" + collider.name + "\": ";
  std::visit(ShapeChecker{who}, collider.shape);
  for (const double friction : {collider.friction, collider.static_friction})
    require(std::isfinite(friction) && friction >= 0, who + "friction must be 0 or more");
}

void require_finite(const std::vector<Vec3>& values, const std::string& what) {
  constexpr double kMost = 1e38;  // of floats, with room for a difference
  const auto is_in_range = [](const Vec3& p) { return p.allFinite() && p.cwiseAbs().maxCoeff() <= kMost; };
  require(std::ranges::all_of(values, is_in_range), what + " must be finite, and at most 1e38");
}

void require_valid(const Pose& pose, const std::string& who) {
  const ShapeChecker checker{who};
  checker.finite(pose.translation, "its translation");
  checker.rotation(pose.rotation);
}

void require_valid(const Wind& wind, const std::string& integrator) {
  require(wind.velocity.allFinite() && std::isfinite(wind.drag) && wind.drag >= 0,
          "the wind's velocity must be finite, and its drag 0 or more");
  const auto above_zero = [](double value) { return std::isfinite(value) && value > 0; };
  require(std::isfinite(wind.gusts.strength) && wind.gusts.strength >= 0 && above_zero(wind.gusts.length) &&
              above_zero(wind.gusts.time),
          "gusts require a strength of 0 or more, and a length and a time above 0");
  if (wind.air.density == 0) return;
  require(above_zero(wind.air.density) && above_zero(wind.air.drag) && wind.air.lift >= 0 &&
              wind.air.lift <= wind.air.drag,
          "the air's density and drag must be above 0, and its lift from 0 to its drag");
  require(find_integrator(integrator).supports.aerodynamics,
          integrator + " does not support aerodynamic drag and lift; use " +
              list_supporting(&Support::aerodynamics) + ", or only the wind's drag");
}

void require_valid(const IntegratorSettings& s) {
  require(s.explicit_euler.substeps >= 0, "explicit: substeps must be 0 or more");
  require(std::isfinite(s.implicit_euler.tolerance) && s.implicit_euler.tolerance > 0,
          "implicit_euler: tolerance must be above 0 m/s");
  require(s.implicit_euler.iterations >= 1, "implicit_euler: iterations must be at least 1");
  require(s.newton.iterations >= 0, "newton: iterations must be 0 or more");
  require(s.xpbd.substeps >= 1, "xpbd: substeps must be at least 1");
}

void require_elements_supported(const std::string& integrator, const ClothElements& elements,
                                const std::string& cloth) {
  const Support& supports = find_integrator(integrator).supports;
  require(supports.elements,
          "cloth \"" + cloth + "\" is made of a fabric, but " + integrator + " supports springs only; use " +
              list_supporting(&Support::elements) +
              ", or set spring_structural, spring_shear and spring_bend instead of the fabric");
  require(elements.thread_bends.empty() || supports.bending_memory,
          "cloth \"" + cloth + "\" has a bend_hysteresis or bend_set, but " + integrator +
              " does not support it; use " + list_supporting(&Support::bending_memory) +
              ", or set bend_hysteresis_warp, bend_hysteresis_weft and bend_set to 0");
}

void require_seams_supported(const std::string& integrator, const Seams& seams, const std::string& cloth) {
  require(seams.springs.empty() || find_integrator(integrator).supports.seams,
          "cloth \"" + cloth + "\" has seams, but " + integrator + " does not support them; use " +
              list_supporting(&Support::seams));
}

void require_pressure_supported(const std::string& integrator, const std::string& cloth) {
  require(find_integrator(integrator).supports.pressure, "cloth \"" + cloth + "\" has a pressure, but " +
                                                             integrator + " does not support it; use " +
                                                             list_supporting(&Support::pressure));
}

void require_closed(const TriangleMesh& mesh, const std::string& cloth) {
  const SurfaceEdges edges = count_surface_edges(mesh);
  require(is_closed(edges),
          "cloth \"" + cloth + "\" is not closed: pressure requires a surface without a border, but " +
              std::to_string(edges.border) + " of its edges have one triangle, and " +
              std::to_string(edges.unbalanced - edges.border) +
              " others join triangles that face opposite ways; join pieces with sew or weld");
}

}  // namespace weft::engine
