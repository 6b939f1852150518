#include "tools/wardrobe/wardrobe.h"

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "tools/wardrobe/figure.h"
#include "tools/wardrobe/garments.h"
#include "weft/error.h"
#include "weft/io/obj_reader.h"

namespace weft::engine::wardrobe {
namespace {

constexpr double kFigureCell = 0.0115;  // [m]
constexpr int kFrameRate = 30, kNumFrames = 31;

std::string numbered(const std::string& motion, int frame) {
  char name[64];
  std::snprintf(name, sizeof name, "figure_%s_%02d.obj", motion.c_str(), frame);
  return name;
}

/// The hair faces inwards, a common defect of meshes.
void write_figure(const std::filesystem::path& folder) {
  Figure figure = make_figure(kFigureCell);
  const int num_skin = figure.num_skin_triangles;
  std::for_each(figure.mesh.triangles.begin() + num_skin, figure.mesh.triangles.end(),
                [](Triangle& t) { std::swap(t[1], t[2]); });
  for (const std::string& motion : motion_names()) {
    for (int frame = 0; frame < kNumFrames; ++frame) {
      TriangleMesh posed = figure.mesh;
      posed.positions = pose_figure(figure, pose_at(motion, static_cast<double>(frame) / kFrameRate));
      write_obj(folder / numbered(motion, frame), posed);
    }
  }
}

/// A garment, with its entries in a scene file.
struct Piece {
  std::string name;
  TriangleMesh mesh;
  std::string fabric, keys;
};

std::vector<Piece> make_pieces(double cell) {
  TriangleMesh shirt = make_shirt(cell, 4);
  for (Vec3& p : shirt.positions) p *= 100;
  TriangleMesh trousers = make_trousers(cell);
  for (Vec3& p : trousers.positions) p = Vec3(p.x(), -p.z(), p.y());
  return {{"tshirt", make_tshirt(cell), "gray_interlock", ""},
          {"shirt", std::move(shirt), "cotton_shirting", "scale = 0.01\n"},
          {"trousers", std::move(trousers), "denim", "up = \"z\"\n"},
          {"skirt", make_skirt(cell), "wool_suiting", ""},
          {"coat", make_coat(1.5 * cell), "wool_suiting", ""},
          {"scarf", make_scarf(cell), "silk", ""},
          {"dress", make_pleated_dress(cell), "silk", "sew = 0.003\n"},
          {"sheet", make_sheet(1.5, static_cast<int>(0.9 / cell)), "silk", ""}};
}

const std::vector<std::vector<std::string>>& outfits() {
  static const std::vector<std::vector<std::string>> all = {
      {"tshirt"}, {"shirt"}, {"trousers"},
      {"skirt"},  {"coat"},  {"scarf"},
      {"dress"},  {"sheet"}, {"trousers", "tshirt", "coat"}};
  return all;
}

void write_scene(const std::filesystem::path& file, const std::vector<const Piece*>& pieces,
                 const std::string& motion) {
  std::ofstream out(file);
  out << "[scene]\nformat = 1\nduration = 1\n";
  for (const Piece* piece : pieces) {
    out << "\n[[cloth]]\nname = \"" << piece->name << "\"\nmesh = \"" << piece->name << ".obj\"\nfabric = \""
        << piece->fabric << "\"\n"
        << piece->keys;
  }
  out << "\n[[collider]]\nname = \"figure\"\nshape = \"mesh\"\nframes = \"figure_" << motion
      << "_*.obj\"\nframe_rate = " << kFrameRate << '\n';
  if (!out.flush()) throw InputError(file.string() + ": cannot be written");
}

}  // namespace

std::vector<std::string> motion_names() { return {"stand", "walk", "kick", "fold", "sit"}; }

std::vector<std::string> write_wardrobe(const std::filesystem::path& folder, double cell) {
  std::filesystem::create_directories(folder);
  write_figure(folder);
  const std::vector<Piece> pieces = make_pieces(cell);
  for (const Piece& piece : pieces) write_obj(folder / (piece.name + ".obj"), piece.mesh);
  std::vector<std::string> scenes;
  for (const std::vector<std::string>& outfit : outfits()) {
    std::vector<const Piece*> worn;
    for (const std::string& name : outfit)
      worn.push_back(
          &*std::find_if(pieces.begin(), pieces.end(), [&](const Piece& p) { return p.name == name; }));
    for (const std::string& motion : motion_names()) {
      scenes.push_back((outfit.size() > 1 ? "outfit" : outfit[0]) + "_" + motion);
      write_scene(folder / (scenes.back() + ".toml"), worn, motion);
    }
  }
  return scenes;
}

}  // namespace weft::engine::wardrobe
