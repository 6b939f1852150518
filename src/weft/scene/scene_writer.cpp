#include "weft/scene/scene_writer.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <map>
#include <random>
#include <span>
#include <sstream>

#include "weft/core/file_name.h"
#include "weft/core/hash.h"
#include "weft/core/staged_file.h"
#include "weft/error.h"
#include "weft/face/convert.h"
#include "weft/io/input_file.h"
#include "weft/io/obj_reader.h"
#include "weft/scene/scene_reader.h"
#include "weft/scene/scene_sections.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;

// ---- Values as TOML text; numbers with as many digits as it takes to read the same doubles back ----

std::string toml(double number) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, number).ptr};
}

std::string toml(int number) { return std::to_string(number); }
std::string toml(bool value) { return value ? "true" : "false"; }

std::string toml(const std::string& value) {
  std::string text = "\"";
  for (const char c : value) {
    if (c == '"' || c == '\\') {
      text += '\\';
      text += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) {
      char escape[8];
      std::snprintf(escape, sizeof escape, "\\u%04X", static_cast<unsigned>(c));
      text += escape;
    } else {
      text += c;
    }
  }
  return text + '"';
}

template <class Numbers>
std::string toml_array(const Numbers& numbers) {
  std::string text = "[";
  for (const auto& number : numbers) text += (text.size() > 1 ? ", " : "") + toml(number);
  return text + ']';
}

std::string toml(const Vec3& v) { return toml_array(v); }

/// Keys and values, as lines of a table or as an inline table.
class Table {
 public:
  template <class Value>
  Table& add(const char* key, const Value& value) {
    return add_text(key, toml(value));
  }

  /// Omits a value equal to the reader's default.
  template <class Value>
  Table& add(const char* key, const Value& value, const Value& usual) {
    return value == usual ? *this : add(key, value);
  }

  Table& add_text(const char* key, const std::string& text) {
    entries_.push_back(std::string(key) + " = " + text);
    return *this;
  }

  std::string lines() const {
    std::string text;
    for (const std::string& entry : entries_) text += entry + '\n';
    return text;
  }

  std::string in_line() const {
    std::string text;
    for (const std::string& entry : entries_) text += (text.empty() ? "{ " : ", ") + entry;
    return text.empty() ? "{}" : text + " }";
  }

 private:
  std::vector<std::string> entries_;
};

std::string toml_array(const std::vector<Table>& tables) {
  std::string text = "[\n";
  for (const Table& table : tables) text += "  " + table.in_line() + ",\n";
  return text + ']';
}

// ---- Meshes ----

/// The names of mesh files in a scene's text.
class MeshNames {
 public:
  virtual ~MeshNames() = default;
  virtual std::string relative(const fs::path& file) const = 0;
  virtual std::string name_of(const MeshSource& source, const std::string& owner) = 0;
  virtual std::string name_of_frames(const PlacedMesh& mesh, const std::string& owner) = 0;
};

/// Faces of a mesh in memory.
MeshFaces faces_of(const MeshSource& source) {
  return make_faces(source.mesh->triangles, to_engine(source.mesh->uv));
}

/// Hashes of contents instead of names; a mesh in memory has that of the file that MeshFiles writes.
class MeshHashes : public MeshNames {
 public:
  std::string relative(const fs::path& file) const override { return hash(read(file)); }

  std::string name_of(const MeshSource& source, const std::string&) override {
    if (!source.mesh) return relative(source.file);
    return hash(obj_text(to_engine(*source.mesh).positions, faces_of(source)));
  }

  std::string name_of_frames(const PlacedMesh& mesh, const std::string&) override {
    std::string all;
    for (const fs::path& file : mesh.frames) all += hash(read(file));
    if (!mesh.frame_positions.empty()) {
      const MeshFaces faces = faces_of(mesh.source);
      for (const std::vector<Vec3>& positions : mesh.frame_positions) all += hash(obj_text(positions, faces));
    }
    return hash(all);
  }

 private:
  static std::string read(const fs::path& file) { return read_bytes(file, "a mesh file"); }

  static std::string hash(const std::string& content) {
    return "hash " + to_hex(hash_of(std::span<const char>(content)));
  }
};

/// Names relative to the scene file's folder; meshes in memory are written there first.
class MeshFiles : public MeshNames {
 public:
  explicit MeshFiles(const fs::path& scene_file)
      : folder_(scene_file.parent_path()), stem_(scene_file.stem().string()) {}

  std::string relative(const fs::path& file) const override {
    const fs::path name =
        fs::absolute(file).lexically_relative(fs::absolute(folder_.empty() ? "." : folder_));
    return (name.empty() ? fs::absolute(file) : name).generic_string();
  }

  std::string name_of(const MeshSource& source, const std::string& owner) override {
    if (!source.mesh) return relative(source.file);
    const std::string name = names_.add(stem_ + "_" + owner) + ".obj";
    write_obj(folder_ / name, to_engine(*source.mesh).positions, faces_of(source));
    return name;
  }

  /// A name with a star.
  std::string name_of_frames(const PlacedMesh& mesh, const std::string& owner) override {
    if (mesh.frame_positions.empty()) return relative(pattern_of(mesh.frames, owner));
    const std::string begin = names_.add(stem_ + "_" + owner) + "_";
    const MeshFaces faces = faces_of(mesh.source);
    for (std::size_t k = 0; k < mesh.frame_positions.size(); ++k) {
      char number[32];
      std::snprintf(number, sizeof number, "%06zu.obj", k);
      write_obj(folder_ / (begin + number), mesh.frame_positions[k], faces);
    }
    return begin + "*.obj";
  }

 private:
  /// The pattern that matches exactly these files.
  static fs::path pattern_of(const std::vector<fs::path>& frames, const std::string& owner) {
    const std::string first = frames.front().filename().string();
    std::size_t begin = first.size(), end = first.size();
    for (const fs::path& frame : frames) {
      const std::string name = frame.filename().string();
      begin = std::min<std::size_t>(
          begin, std::mismatch(first.begin(), first.end(), name.begin(), name.end()).first - first.begin());
      end = std::min<std::size_t>(
          end,
          std::mismatch(first.rbegin(), first.rend(), name.rbegin(), name.rend()).first - first.rbegin());
    }
    end = std::min(end, first.size() - std::min(begin, first.size()));
    const fs::path pattern =
        frames.front().parent_path() / (first.substr(0, begin) + '*' + first.substr(first.size() - end));
    if (find_frame_files(pattern) != frames)
      throw InputError("collider \"" + owner + "\": its frames are not the files of one name with a star");
    return pattern;
  }

  fs::path folder_;
  std::string stem_;
  FileNames names_;
};

void add_mesh_keys(const MeshSource& mesh, Table& table) {
  if (mesh.up_is_z) table.add("up", std::string("z"));
  table.add("scale", mesh.scale, MeshSource().scale);
}

// ---- Parts of a scene ----

std::string motion_text(const std::vector<KeyFrame>& motion) {
  std::vector<Table> keys;
  for (const KeyFrame& key : motion) {
    Table table;
    table.add("time", key.time)
        .add("position", key.translation, KeyFrame().translation)
        .add("rotation", key.angles_deg, KeyFrame().angles_deg);
    keys.push_back(table);
  }
  return toml_array(keys);
}

std::string selection_text(const ParticleSelection& selection) {
  if (const auto* corner = std::get_if<GridCorner>(&selection))
    return toml("corner:" + std::to_string(corner->i) + "," + std::to_string(corner->j));
  if (const auto* indices = std::get_if<ParticleIndices>(&selection))
    return "{ index = " + toml_array(indices->indices) + " }";
  if (const auto* group = std::get_if<GroupName>(&selection)) return "{ group = " + toml(group->name) + " }";
  if (const auto* box = std::get_if<Box>(&selection))
    return "{ box = " + Table().add("min", box->min).add("max", box->max).in_line() + " }";
  const Sphere& ball = std::get<Sphere>(selection);
  return "{ sphere = " + Table().add("center", ball.center).add("radius", ball.radius).in_line() + " }";
}

std::string curve_text(const std::vector<StretchPoint>& curve) {
  std::string text = "[";
  for (const StretchPoint& p : curve)
    text += (text.size() > 1 ? ", " : "") + toml_array(std::array{p.strain, p.tension});
  return text + ']';
}

std::string fabric_text(const FabricDesc& fabric) {
  const auto& presets = fabric_presets();
  const auto preset =
      std::find_if(presets.begin(), presets.end(), [&](const auto& p) { return p.name == fabric.name; });
  const Fabric& f = fabric.numbers;
  if (preset != presets.end() && preset->fabric == f) return toml(fabric.name);
  Table table;
  table.add("name", fabric.name, std::string("fabric"))
      .add("density", f.density)
      .add("c11", f.c11)
      .add("c22", f.c22)
      .add("c12", f.c12)
      .add("g", f.g)
      .add("bend_warp", f.bend_warp)
      .add("bend_weft", f.bend_weft)
      .add("bend_bias", f.bend_bias)
      .add("bend_hysteresis_warp", f.bend_hysteresis_warp, Fabric().bend_hysteresis_warp)
      .add("bend_hysteresis_weft", f.bend_hysteresis_weft, Fabric().bend_hysteresis_weft)
      .add("bend_set", f.bend_set, Fabric().bend_set)
      .add("damping", f.damping)
      .add("thickness", f.thickness)
      .add("friction", f.friction)
      .add("strain_limit", f.strain_limit, Fabric().strain_limit)
      .add("strength", f.strength, Fabric().strength);
  if (!f.stretch_warp.empty()) table.add_text("stretch_warp", curve_text(f.stretch_warp));
  if (!f.stretch_weft.empty()) table.add_text("stretch_weft", curve_text(f.stretch_weft));
  return table.in_line();
}

std::string springs_text(const ClothSceneDesc& cloth) {
  const ClothMaterial& m = cloth.material;
  Table table;
  table.add("density", m.density)
      .add("spring_structural", m.structural)
      .add("spring_shear", m.shear)
      .add("spring_bend", m.bend)
      .add("damping", m.damping, ClothMaterial().damping)
      .add("friction", m.friction, ClothMaterial().friction);
  if (m.damping_kind != ClothMaterial().damping_kind) table.add("damping_kind", std::string("plain"));
  if (cloth.has_own_thickness) table.add("thickness", m.thickness);
  return table.in_line();
}

std::string rest_text(const RestDesc& rest, const std::string& owner, MeshNames& files) {
  Table table;
  if (rest.mesh) {
    table.add("mesh", files.name_of(*rest.mesh, owner + "_rest"));
    add_mesh_keys(*rest.mesh, table);
    return table.in_line();
  }
  return rest.uv_scale ? table.add("uv_scale", *rest.uv_scale).in_line() : toml(std::string("uv"));
}

std::string shape_lines(const ClothSceneDesc& cloth, MeshNames& files) {
  Table table;
  if (const Grid* grid = std::get_if<Grid>(&cloth.shape)) {
    const Table inner = Table()
                            .add_text("size", toml_array(std::array{grid->size_x, grid->size_z}))
                            .add_text("cells", toml_array(std::array{grid->cells_x, grid->cells_z}));
    return table.add_text("grid", inner.in_line()).add("model", std::string(to_string(cloth.model))).lines();
  }
  const MeshSource& mesh = std::get<MeshSource>(cloth.shape);
  table.add("mesh", files.name_of(mesh, cloth.name));
  add_mesh_keys(mesh, table);
  if (mesh.weld && mesh.weld_distance == MeshSource().weld_distance) table.add("weld", true);
  if (mesh.weld && mesh.weld_distance != MeshSource().weld_distance) table.add("weld", mesh.weld_distance);
  table.add("sew", mesh.sew_distance, MeshSource().sew_distance);
  table.add("stitches", cloth.has_stitches, false);
  if (cloth.rest) table.add_text("rest", rest_text(*cloth.rest, cloth.name, files));
  return table.lines();
}

std::string cloth_text(const ClothSceneDesc& cloth, MeshNames& files) {
  Table table;
  table.add_text("fabric", cloth.fabric ? fabric_text(*cloth.fabric) : springs_text(cloth));
  if (cloth.fabric && cloth.fabric->membrane == Membrane::springs)
    table.add("membrane", std::string("springs"));
  if (cloth.fabric && cloth.fabric->warp) table.add("warp", *cloth.fabric->warp);
  table.add("position", cloth.position, ClothSceneDesc().position)
      .add("rotation", cloth.rotation_deg, ClothSceneDesc().rotation_deg)
      .add("velocity", cloth.velocity, ClothSceneDesc().velocity)
      .add("pressure", cloth.pressure, ClothSceneDesc().pressure)
      .add("sealed", cloth.is_sealed, false)
      .add("layer", cloth.layer, ClothSceneDesc().layer)
      .add("seam_time", cloth.seam_time, ClothSceneDesc().seam_time)
      .add_text("color", toml_array(cloth.color));
  if (cloth.seam_stiffness) table.add("seam_stiffness", *cloth.seam_stiffness);
  std::string text =
      "\n[[cloth]]\n" + Table().add("name", cloth.name).lines() + shape_lines(cloth, files) + table.lines();
  for (const PinDesc& pin : cloth.pins) {
    Table own;
    own.add_text("select", selection_text(pin.select));
    if (!pin.motion.empty()) own.add_text("motion", motion_text(pin.motion));
    own.add("pivot", pin.pivot, PinDesc().pivot);
    if (!pin.follow.empty()) own.add("follow", pin.follow);
    if (pin.stiffness) own.add("stiffness", *pin.stiffness).add("damping", pin.damping, PinDesc().damping);
    text += "\n[[cloth.pin]]\n" + own.lines();
  }
  for (const StiffenDesc& part : cloth.stiffened)
    text += "\n[[cloth.stiffen]]\n" +
            Table().add_text("select", selection_text(part.select)).add("factor", part.factor).lines();
  for (const RestScaleDesc& scale : cloth.rest_scales)
    text += "\n[[cloth.rest_scale]]\n" + Table()
                                             .add_text("select", selection_text(scale.select))
                                             .add("warp", scale.warp, RestScaleDesc().warp)
                                             .add("weft", scale.weft, RestScaleDesc().weft)
                                             .lines();
  for (const Seam& seam : cloth.seams)
    text += "\n[[cloth.seam]]\n" +
            Table().add_text("a", toml_array(seam.a)).add_text("b", toml_array(seam.b)).lines();
  return text;
}

/// Shape and keys of a collider.
struct ShapeKeys {
  MeshNames& files;
  const std::string& owner;
  Table& table;

  void operator()(const Sphere& s) const {
    table.add("shape", std::string("sphere")).add("center", s.center).add("radius", s.radius);
  }
  void operator()(const Plane& p) const {
    table.add("shape", std::string("plane")).add("point", p.point).add("normal", p.normal);
  }
  void operator()(const Capsule& c) const {
    table.add("shape", std::string("capsule")).add("a", c.a).add("b", c.b).add("radius", c.radius);
  }
  void operator()(const PlacedBox& b) const {
    table.add("shape", std::string("box"))
        .add("center", b.center)
        .add("half_size", b.half_size)
        .add("rotation", b.rotation_deg, PlacedBox().rotation_deg);
  }
  void operator()(const PlacedMesh& m) const {
    table.add("shape", std::string("mesh"));
    if (m.frames.empty() && m.frame_positions.empty())
      table.add("file", files.name_of(m.source, owner));
    else
      table.add("frames", files.name_of_frames(m, owner)).add("frame_rate", m.frame_rate);
    if (!m.node.empty()) table.add("node", m.node);
    if (!m.clip.empty()) table.add("clip", m.clip);
    if (m.start_time) table.add("start_time", *m.start_time);
    if (!m.rest.empty()) table.add("rest", files.relative(m.rest));
    if (m.solid) table.add("solid", *m.solid);
    add_mesh_keys(m.source, table);
    table.add("position", m.position, PlacedMesh().position)
        .add("rotation", m.rotation_deg, PlacedMesh().rotation_deg);
  }
};

std::string collider_text(const ColliderSceneDesc& collider, MeshNames& files) {
  if (collider.motion.passage())
    throw InputError("collider \"" + collider.name + "\": a scene file has motions by key frames only");
  Table table;
  table.add("name", collider.name);
  std::visit(ShapeKeys{files, collider.name, table}, collider.shape);
  table.add("friction", collider.friction)
      .add("static_friction", collider.static_friction, ColliderSceneDesc().static_friction);
  if (!collider.motion.keys().empty()) table.add_text("motion", motion_text(collider.motion.keys()));
  return "\n[[collider]]\n" + table.lines();
}

std::string contact_text(const ContactDesc& contact) {
  Table table;
  table.add_text("between", toml_array(contact.between)).add("collide", contact.collide, true);
  if (contact.friction) table.add("friction", *contact.friction);
  table.add("static_friction", contact.static_friction, 0.0);
  return "\n[[contact]]\n" + table.lines();
}

std::string wind_text(const WindDesc& wind) {
  if (wind == WindDesc()) return "";
  Table table;
  table.add("drag", wind.drag);
  if (wind.air.density > 0)
    table.add_text("air", Table()
                              .add("density", wind.air.density)
                              .add("drag", wind.air.drag)
                              .add("lift", wind.air.lift)
                              .in_line());
  if (wind.gusts.strength > 0)
    table.add_text("gusts", Table()
                                .add("strength", wind.gusts.strength)
                                .add("length", wind.gusts.length)
                                .add("time", wind.gusts.time)
                                .add("seed", static_cast<int>(wind.gusts.seed))
                                .in_line());
  std::vector<Table> keys;
  for (const WindKey& key : wind.keys)
    keys.push_back(Table().add("time", key.time).add("velocity", key.velocity));
  const bool is_steady = wind.keys.size() == 1 && wind.keys[0].time == 0;
  is_steady ? table.add("velocity", wind.keys[0].velocity) : table.add_text("keys", toml_array(keys));
  return "\n[wind]\n" + table.lines();
}

std::string solver_text(const SceneDesc& scene) {
  const IntegratorSettings& s = scene.solver;
  const IntegratorSettings usual;
  Table table;
  table.add("integrator", s.integrator).add("steps_per_frame", scene.steps_per_frame, 1);
  if (scene.adaptive) table.add("adaptive", *scene.adaptive);
  table.add("max_steps_per_frame", scene.max_steps_per_frame, SceneDesc().max_steps_per_frame);
  const bool is_newton = s.integrator != "implicit_euler";
  const int iterations = is_newton ? s.newton.iterations : s.implicit_euler.iterations;
  table.add("iterations", iterations, is_newton ? usual.newton.iterations : usual.implicit_euler.iterations);
  if (s.newton.quality == NewtonQuality::fast) table.add("quality", std::string("fast"));
  if (s.newton.quality == NewtonQuality::high) table.add("quality", std::string("high"));
  if (s.is_double) table.add("precision", std::string("double"));
  table.add("tolerance", s.implicit_euler.tolerance, usual.implicit_euler.tolerance)
      .add("contact", scene.contact, true)
      .add("untangle", scene.untangle, true);
  if (scene.crossed_start == CrossedStart::allow) table.add("crossed_start", std::string("allow"));
  if (s.explicit_euler.substeps != usual.explicit_euler.substeps)
    table.add_text("explicit", Table().add("substeps", s.explicit_euler.substeps).in_line());
  if (s.paper.printed_damping_sign)
    table.add_text("paper", Table().add("damping_sign", std::string("as_printed")).in_line());
  if (s.xpbd.substeps != usual.xpbd.substeps)
    table.add_text("xpbd", Table().add("substeps", s.xpbd.substeps).in_line());
  return "\n[solver]\n" + table.lines();
}

std::string scene_text(const SceneDesc& scene, MeshNames& files) {
  Table head;
  head.add("format", 1)
      .add("description", scene.description, std::string())
      .add("gravity", scene.gravity)
      .add("fps", scene.fps)
      .add("duration", scene.duration)
      .add("settle", scene.settle, SceneDesc().settle);
  std::string text = "[scene]\n" + head.lines();
  for (const ClothSceneDesc& cloth : scene.cloths) text += cloth_text(cloth, files);
  for (const ColliderSceneDesc& collider : scene.colliders) text += collider_text(collider, files);
  for (const ContactDesc& contact : scene.contacts) text += contact_text(contact);
  return text + wind_text(scene.wind) + solver_text(scene);
}

/// The section of a line of scene_text(), as overrides name it: "scene", "cloth[0]", "cloth[0].pin[1]".
std::string section_at(const std::string& text, int line) {
  std::string section;
  std::map<std::string, int> counts;
  std::istringstream lines(text);
  std::string now, last_owner;
  for (int k = 1; k <= line && std::getline(lines, now); ++k) {
    if (!now.starts_with('[')) continue;
    std::string name = now.substr(now.find_first_not_of('['));
    name.resize(name.find(']'));
    if (!now.starts_with("[[")) {
      section = name;
      continue;
    }
    const std::size_t dot = name.find('.');
    const std::string path = dot == std::string::npos ? name : last_owner + name.substr(dot);
    section = path + '[' + std::to_string(counts[path]++) + ']';
    if (dot == std::string::npos) last_owner = section;
  }
  return section;
}

/// An empty temporary folder, removed by the destructor.
class TemporaryFolder {
 public:
  TemporaryFolder() : path_(fs::temp_directory_path() / ("weft-" + std::to_string(std::random_device()()))) {
    fs::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

void write_scene(const fs::path& file, const SceneDesc& scene) {
  MeshFiles files(file);
  write_file(file, scene_text(scene, files));
}

std::string scene_text_with_hashes(const SceneDesc& scene) {
  MeshHashes hashes;
  return scene_text(scene, hashes);
}

std::vector<std::string> check_scene(const SceneDesc& scene) {
  const TemporaryFolder folder;
  const fs::path file = folder.path() / "scene.toml";
  std::vector<std::string> messages;
  try {
    MeshFiles files(file);
    const std::string text = scene_text(scene, files);
    try {
      parse_scene(text, file);
    } catch (const SceneError& error) {
      for (const Diagnostic& mistake : error.diagnostics())
        messages.push_back(section_at(text, mistake.line) + '.' + mistake.message);
    }
  } catch (const InputError& error) {
    messages.emplace_back(error.what());
  }
  return messages;
}

}  // namespace weft::engine
