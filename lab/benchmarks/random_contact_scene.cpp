#include "lab/benchmarks/random_contact_scene.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string>

#include "weft/core/random.h"
#include "weft/core/staged_file.h"
#include "weft/core/vec.h"
#include "weft/io/obj_reader.h"
#include "weft/mesh/sample_meshes.h"

namespace weft::engine::lab {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kBodiesBelow = 0.75;  // all bodies start below this height [m]
constexpr double kCloudBegins = 0.95;  // all cloths start above this one [m]
constexpr const char* kFabrics[] = {"silk", "cotton_shirting", "denim", "wool_suiting", "ivory_rib_knit"};

std::string text_of(const Vec3& v) { return fmt::format("[{:.6g}, {:.6g}, {:.6g}]", v.x(), v.y(), v.z()); }

class Writer {
 public:
  Writer(const std::filesystem::path& folder, std::uint64_t seed)
      : folder_(folder), name_(fmt::format("seed_{}", seed)), seed_(seed), random_(seed) {}

  std::filesystem::path write() {
    text_ = fmt::format(
        "[scene]\nformat = 1\ndescription = \"Random contact, seed {}\"\nfps = 60\nduration = 1\n", seed_);
    const int cloths = count(1, 6);
    double height = kCloudBegins;
    for (int c = 0; c < cloths; ++c) height = add_cloth(c, height);
    if (chance(0.7)) add_floor();
    const int bodies = count(1, 4);
    for (int b = 0; b < bodies; ++b) add_body(b);
    if (chance(0.2))
      text_ += fmt::format("\n[wind]\nair = {{}}\nvelocity = {}\n", text_of(within({4, 2, 4})));
    const std::filesystem::path file = folder_ / (name_ + ".toml");
    write_file(file, text_);
    return file;
  }

 private:
  double between(double low, double high) { return random_.uniform(low, high); }
  double between_logs(double low, double high) { return low * std::pow(high / low, between(0, 1)); }
  bool chance(double share) { return between(0, 1) < share; }
  int count(int least, int most) { return std::min(most, static_cast<int>(between(least, most + 1))); }
  Vec3 within(const Vec3& most) {
    Vec3 v;
    for (int k = 0; k < 3; ++k) v[k] = between(-most[k], most[k]);
    return v;
  }

  std::string write_mesh(const std::string& of, const TriangleMesh& mesh) {
    const std::string file = fmt::format("{}_{}.obj", name_, of);
    write_obj(folder_ / file, mesh);
    return file;
  }

  /// In a layer of its own above the height; returns the height above it.
  double add_cloth(int number, double height) {
    const double edge = between_logs(0.02, 0.08);
    const std::array<double, 2> size = {between(0.25, 1), between(0.25, 1)};
    std::array<int, 2> cells;
    for (int k = 0; k < 2; ++k) cells[k] = std::clamp(static_cast<int>(size[k] / edge), 3, 28);
    const double thickness = std::min(between_logs(3e-4, 4e-3), 0.2 * edge);
    const double layer = between(0.02, 0.2);
    const int kind = count(0, 2);  // grid, irregular rectangle, disc
    const double depth = kind == 2 ? size[0] : size[1];
    const double tilt = std::asin(std::min(0.9, 0.9 * layer / depth)) * between(-1, 1);
    const double turn = between(-180, 180) * kDegree;
    const Mat3 rotation =
        (Eigen::AngleAxisd(turn, Vec3::UnitY()) * Eigen::AngleAxisd(tilt, Vec3::UnitX())).toRotationMatrix();
    const Vec3 middle = kind == 2 ? Vec3(0, 0, 0) : Vec3(size[0] / 2, 0, size[1] / 2);
    const Vec3 place = within({0.2, 0, 0.2}) + Vec3(0, height + layer / 2, 0) - rotation * middle;
    text_ += fmt::format("\n[[cloth]]\nname = \"cloth {}\"\n", number);
    const Grid grid{.size_x = size[0], .size_z = size[1], .cells_x = cells[0], .cells_z = cells[1]};
    const auto file = [&](const TriangleMesh& mesh) {
      return fmt::format("mesh = \"{}\"\n", write_mesh(fmt::format("cloth_{}", number), mesh));
    };
    if (kind == 0)
      text_ += fmt::format("grid = {{ size = [{:.6g}, {:.6g}], cells = [{}, {}] }}\n", size[0], size[1],
                           cells[0], cells[1]);
    else if (kind == 1)
      text_ += file(build_random_mesh(grid, random_.next()));
    else
      text_ += file(build_disc_mesh(size[0] / 2, std::clamp(cells[0] / 2, 2, 12)));
    add_fabric(thickness);
    text_ += fmt::format("rotation = [{:.6g}, {:.6g}, 0]\nposition = {}\n", tilt / kDegree, turn / kDegree,
                         text_of(place));
    if (chance(0.5)) text_ += fmt::format("velocity = {}\n", text_of(within({3, 3, 3})));
    if (kind == 0 && chance(0.3)) add_pins(cells);
    return height + layer + 0.01;
  }

  void add_fabric(double thickness) {
    if (chance(0.5)) {
      text_ += fmt::format("fabric = {{ base = \"{}\", thickness = {:.4g} }}\n",
                           kFabrics[count(0, std::size(kFabrics) - 1)], thickness);
      return;
    }
    const double stiffness = between_logs(50, 2e4), density = between_logs(0.05, 0.5),
                 softer = between_logs(50, 2000), friction = between(0, 1);
    text_ += fmt::format(
        "fabric = {{ density = {:.4g}, spring_structural = {:.4g}, spring_shear = {:.4g}, spring_bend = "
        "{:.4g}, "
        "thickness = {:.4g}, friction = {:.3g} }}\n",
        density, stiffness, stiffness / 2, stiffness / softer, thickness, friction);
  }

  void add_pins(const std::array<int, 2>& cells) {
    std::string pin = fmt::format("select = \"corner:{},0\"", chance(0.5) ? 0 : 1);
    if (chance(0.5)) pin = fmt::format("select = {{ index = [0, {}] }}", cells[0]);
    text_ += fmt::format("\n[[cloth.pin]]\n{}\n", pin);
    if (chance(0.5)) text_ += "motion = " + motion(0.4, 0) + "\n";
  }

  /// Key frames over a second: displacements [m], angles [degrees].
  std::string motion(double way, double angle) {
    std::string keys = "[{ time = 0 }";
    for (const double time : {between(0.1, 0.5), between(0.6, 1.0)}) {
      const Vec3 place = within({way, way, way}), turn = within({angle, angle, angle});
      keys += fmt::format(", {{ time = {:.4g}, position = {}, rotation = {} }}", time, text_of(place),
                          text_of(turn));
    }
    return keys + "]";
  }

  void add_floor() {
    const char* normal = chance(0.5) ? "[0, 1, 0]" : "[0.2, 1, 0.1]";
    text_ += fmt::format("\n[[collider]]\nname = \"floor\"\nshape = \"plane\"\npoint = [0, 0, 0]\n");
    text_ += fmt::format("normal = {}\nfriction = {:.3g}\n", normal, between(0, 1));
  }

  void add_body(int number) {
    const double reach = between(0.05, 0.3);  // no point is farther from the centre [m]
    Vec3 centre = within({0.4, 0, 0.4});
    centre.y() = kBodiesBelow - reach - between(0, 0.3);
    const Vec3 angles = within({180, 180, 180});
    text_ += fmt::format("\n[[collider]]\nname = \"body {}\"\nfriction = {:.3g}\n", number, between(0, 1));
    switch (count(0, 4)) {
      case 0:
        text_ += fmt::format("shape = \"sphere\"\ncenter = {}\nradius = {:.6g}\n", text_of(centre), reach);
        break;
      case 1: {
        const double radius = reach * between(0.1, 0.6);
        const Vec3 axis = (reach - radius) * within({1, 1, 1}).normalized();
        text_ += fmt::format("shape = \"capsule\"\na = {}\nb = {}\nradius = {:.6g}\n", text_of(centre - axis),
                             text_of(centre + axis), radius);
        break;
      }
      case 2: {
        const Vec3 half = reach * (Vec3::Constant(0.3) + within({0.25, 0.25, 0.25}));
        text_ += fmt::format("shape = \"box\"\ncenter = {}\nhalf_size = {}\nrotation = {}\n", text_of(centre),
                             text_of(half), text_of(angles));
        break;
      }
      case 3:
        text_ += fmt::format("shape = \"mesh\"\nfile = \"{}\"\nposition = {}\nrotation = {}\n",
                             write_mesh(fmt::format("body_{}", number), bumpy_ball(reach, 0)),
                             text_of(centre), text_of(angles));
        break;
      default: {
        constexpr int kFrames = 12;
        const std::string of = fmt::format("body_{}_", number);
        for (int f = 0; f < kFrames; ++f)
          write_mesh(of + fmt::format("{:02}", f), bumpy_ball(reach, 0.5 * f));
        text_ += fmt::format("shape = \"mesh\"\nframes = \"{}_{}*.obj\"\nposition = {}\n", name_, of,
                             text_of(centre));
      }
    }
    const double way = chance(0.3) ? 1.5 : 0.4, angle = chance(0.5) ? 180 : 0;
    if (chance(0.7)) text_ += "motion = " + motion(way, angle) + "\n";
  }

  /// With spikes and dents, which move with the phase.
  TriangleMesh bumpy_ball(double reach, double phase) {
    TriangleMesh mesh = build_geodesic_mesh(1, 3);
    for (Vec3& p : mesh.positions) {
      const double bump = std::sin(5 * p.x() + phase) * std::sin(4 * p.y() - phase) * std::sin(6 * p.z() + 1);
      p *= reach / 1.4 * (1 + 0.4 * bump);
    }
    return mesh;
  }

  std::filesystem::path folder_;
  std::string name_;
  std::uint64_t seed_;
  Random random_;
  std::string text_;
};

}  // namespace

std::filesystem::path write_random_contact_scene(const std::filesystem::path& folder, std::uint64_t seed) {
  return Writer(folder, seed).write();
}

}  // namespace weft::engine::lab
