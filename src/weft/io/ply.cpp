// The reader has two passes: the first one finds the beginning of every element, because faces may precede
// their vertices.

#include "weft/io/ply.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>

#include "weft/core/staged_file.h"
#include "weft/error.h"
#include "weft/io/byte_order.h"
#include "weft/io/input_file.h"
#include "weft/io/words.h"

namespace weft::engine {
namespace {

// ---- The format ----

/// A scalar type, with the names of both naming schemes.
struct Scalar {
  std::string_view name, sized_name;
  std::size_t size;  // [bytes]
  bool is_whole;
  double lowest, highest;
  double (*load)(const char* from, std::endian order);
};

template <class T>
constexpr Scalar make_scalar(std::string_view name, std::string_view sized_name) {
  using Limits = std::numeric_limits<T>;
  return {name,
          sized_name,
          sizeof(T),
          Limits::is_integer,
          static_cast<double>(Limits::lowest()),
          static_cast<double>(Limits::max()),
          [](const char* from, std::endian order) {
            return static_cast<double>(number_from_bytes<T>(from, order));
          }};
}

constexpr std::array kScalars = {
    make_scalar<std::int8_t>("char", "int8"),    make_scalar<std::uint8_t>("uchar", "uint8"),
    make_scalar<std::int16_t>("short", "int16"), make_scalar<std::uint16_t>("ushort", "uint16"),
    make_scalar<std::int32_t>("int", "int32"),   make_scalar<std::uint32_t>("uint", "uint32"),
    make_scalar<float>("float", "float32"),      make_scalar<double>("double", "float64"),
};
constexpr const Scalar& kInt = kScalars[4];

/// The value of a word; nothing for words that are not of the type.
std::optional<double> parse_value(std::string_view word, const Scalar& type) {
  const std::optional<double> value = parse_number(word);
  if (!value || !type.is_whole) return value;
  const bool fits = *value == std::floor(*value) && type.lowest <= *value && *value <= type.highest;
  return fits ? value : std::nullopt;
}

struct Property {
  std::string_view name;
  const Scalar* type = nullptr;
  const Scalar* count_type = nullptr;  // of a list; null: one value
  bool is_wanted = false;              // otherwise values are passed over

  // The row read last.
  std::size_t first_byte = 0;  // of its values
  std::vector<double> values = {};
};

/// Position in the file.
struct Place {
  std::size_t byte = 0;  // the next one
  int line = 0;          // the one read last, from 1
};

struct Element {
  std::string_view name;
  int line = 0;  // in the header
  int num_rows = 0;
  std::vector<Property> properties = {};
  Place begin = {};  // of its data
};

// ---- In ----

constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();

Eigen::Vector2d make_uv(double u, double v) {
  if (std::isfinite(u) && std::isfinite(v)) return {u, v};
  return {kNotGiven, kNotGiven};
}

bool has_any(const CornerUv& uv) {
  return std::any_of(uv.begin(), uv.end(), [](const Eigen::Vector2d& c) { return std::isfinite(c.x()); });
}

class PlyParser {
 public:
  PlyParser(std::string_view bytes, const std::string& name) : name_(name), bytes_(bytes) {}

  MeshFromFile parse() {
    read_header();
    for (Element& element : elements_) {
      element.begin = at_;
      read_rows(element, [] {});
    }
    warn_of_rest();
    read_vertices();
    read_faces();
    if (std::none_of(result_.uv.begin(), result_.uv.end(), has_any)) {
      result_.uv.clear();
      result_.faces.uv.clear();
    }
    return std::move(result_);
  }

 private:
  std::vector<Vec3>& positions() { return result_.mesh.positions; }

  [[noreturn]] void fail_line(int line, const std::string& message) const {
    throw InputError(name_ + ":" + std::to_string(line) + ": " + message);
  }

  /// A mistake in the current line or, in binary data, at this byte.
  [[noreturn]] void fail_row(std::size_t byte, const std::string& message) const {
    const std::string row = "row " + std::to_string(row_) + " of " + in_quotes(element_->name) + message;
    if (!order_) fail_line(at_.line, row);
    throw InputError(name_ + ": byte " + std::to_string(byte) + ": " + row);
  }

  /// A mistake in value `k` of the property.
  [[noreturn]] void fail_value(const Property& property, std::size_t k, const std::string& message) const {
    fail_row(property.first_byte + k * property.type->size,
             ", property " + in_quotes(property.name) + ": " + message);
  }

  /// Advances to the next line; false at the end of the file.
  bool next_line() {
    words_.clear();
    next_word_ = 0;
    if (at_.byte == bytes_.size()) return false;
    append_words(take_line(bytes_, at_.byte), words_);
    ++at_.line;
    return true;
  }

  // ---- The header ----

  void read_header() {
    if (!next_line() || words_ != std::vector<std::string_view>{"ply"})
      fail_line(1, "expected ply, the first line of a PLY file");
    bool has_format = false;
    while (next_line()) {
      const std::string_view keyword = words_.empty() ? "comment" : words_[0];
      if (keyword == "format") {
        read_format();
        has_format = true;
      } else if (keyword == "element") {
        add_element();
      } else if (keyword == "property") {
        add_property();
      } else if (keyword == "end_header") {
        if (!has_format) fail_line(at_.line, "the header ends without a line format KIND 1.0");
        return;
      } else if (keyword != "comment" && keyword != "obj_info") {
        fail_line(at_.line, "unknown keyword " + in_quotes(keyword) +
                                "; expected format, element, property, comment, obj_info or end_header");
      }
    }
    fail_line(at_.line, "the file ends in the header; expected end_header");
  }

  void read_format() {
    if (words_.size() != 3 || words_[2] != "1.0") fail_line(at_.line, "expected format KIND 1.0");
    if (words_[1] == "ascii") {
      order_ = std::nullopt;
    } else if (words_[1] == "binary_little_endian") {
      order_ = std::endian::little;
    } else if (words_[1] == "binary_big_endian") {
      order_ = std::endian::big;
    } else {
      fail_line(at_.line, in_quotes(words_[1]) +
                              " is not a format; expected ascii, binary_little_endian or binary_big_endian");
    }
  }

  void add_element() {
    if (words_.size() != 3) fail_line(at_.line, "expected element NAME COUNT");
    const std::optional<double> count = parse_value(words_[2], kInt);
    if (!count || *count < 0)
      fail_line(at_.line, in_quotes(words_[2]) +
                              " is not a number of rows; expected a whole number from 0 to 2147483647");
    if (find_element(words_[1]))
      fail_line(at_.line, "element " + in_quotes(words_[1]) + " is defined a second time");
    elements_.push_back({.name = words_[1], .line = at_.line, .num_rows = static_cast<int>(*count)});
  }

  void add_property() {
    const bool is_list = words_.size() > 1 && words_[1] == "list";
    if (words_.size() != (is_list ? 5u : 3u))
      fail_line(at_.line, "expected property TYPE NAME or property list COUNT_TYPE TYPE NAME");
    if (elements_.empty()) fail_line(at_.line, "a property before the first element");
    Property property{.name = words_.back(), .type = &find_scalar(words_[is_list ? 3 : 1])};
    if (is_list) {
      property.count_type = &find_scalar(words_[2]);
      if (!property.count_type->is_whole)
        fail_line(at_.line, in_quotes(words_[2]) + " cannot count a list; expected a whole type");
    }
    std::vector<Property>& properties = elements_.back().properties;
    for (const Property& other : properties) {
      if (other.name == property.name)
        fail_line(at_.line, "property " + in_quotes(property.name) + " is defined a second time");
    }
    properties.push_back(std::move(property));
  }

  const Scalar& find_scalar(std::string_view name) const {
    for (const Scalar& scalar : kScalars) {
      if (name == scalar.name || name == scalar.sized_name) return scalar;
    }
    fail_line(
        at_.line,
        in_quotes(name) + " is not a type; expected char, uchar, short, ushort, int, uint, float or double");
  }

  Element* find_element(std::string_view name) {
    for (Element& element : elements_) {
      if (element.name == name) return &element;
    }
    return nullptr;
  }

  // ---- Rows ----

  /// Calls `use` after each row of the element.
  template <class Use>
  void read_rows(Element& element, const Use& use) {
    at_ = element.begin;
    element_ = &element;
    if (element.properties.empty()) return;  // no data
    for (row_ = 0; row_ < element.num_rows; ++row_) {
      if (!order_) start_line();
      for (Property& property : element.properties) read_property(property);
      if (!order_ && next_word_ != words_.size())
        fail_row(
            0, " has " + std::to_string(words_.size()) + " numbers; expected " + std::to_string(next_word_));
      use();
    }
  }

  /// Advances to the next line that is not blank.
  void start_line() {
    while (next_line()) {
      if (!words_.empty()) return;
    }
    fail_row(0, " is missing; expected " + std::to_string(element_->num_rows) + " rows");
  }

  void read_property(Property& property) {
    std::size_t count = 1;
    if (property.count_type) {
      read_values(*property.count_type, 1, true, property);
      if (property.values[0] < 0)
        fail_value(property, 0,
                   "a list of " + std::to_string(static_cast<int>(property.values[0])) +
                       " numbers; expected 0 or more");
      count = static_cast<std::size_t>(property.values[0]);
    }
    read_values(*property.type, count, property.is_wanted, property);
  }

  /// Passes over numbers; stores wanted ones in the property.
  void read_values(const Scalar& type, std::size_t count, bool is_wanted, Property& property) {
    property.first_byte = at_.byte;
    property.values.clear();
    const std::size_t num_left = order_ ? (bytes_.size() - at_.byte) / type.size : words_.size() - next_word_;
    if (count > num_left)
      fail_value(property, 0,
                 "expected " + std::to_string(count) + " numbers, but the " + (order_ ? "file" : "line") +
                     " has " + std::to_string(num_left) + " more");
    for (std::size_t k = 0; is_wanted && k < count; ++k) {
      property.values.push_back(order_ ? type.load(&bytes_[at_.byte + k * type.size], *order_)
                                       : read_word(words_[next_word_ + k], type, property));
    }
    if (order_) {
      at_.byte += count * type.size;
    } else {
      next_word_ += count;
    }
  }

  double read_word(std::string_view word, const Scalar& type, const Property& property) const {
    const std::optional<double> value = parse_value(word, type);
    if (!value)
      fail_value(property, 0, in_quotes(word) + " is not a number of type " + std::string(type.name));
    return *value;
  }

  void warn_of_rest() {
    constexpr std::string_view kBlanks(" \t\v\f\r\n\0", 7);
    if (bytes_.find_first_not_of(kBlanks, at_.byte) == bytes_.npos) return;
    result_.warnings.push_back(name_ + ": " + std::to_string(bytes_.size() - at_.byte) +
                               " bytes behind the last element were ignored");
  }

  // ---- The mesh ----

  /// Null if the element has no such property.
  static Property* want(Element& element, std::string_view name, bool is_list) {
    for (Property& property : element.properties) {
      if (property.name != name || (property.count_type != nullptr) != is_list) continue;
      property.is_wanted = true;
      return &property;
    }
    return nullptr;
  }

  void read_vertices() {
    Element* vertex = find_element("vertex");
    if (!vertex || vertex->num_rows == 0)
      throw InputError(name_ + ": there are no vertices; expected an element vertex");
    std::array<Property*, 3> axes;
    for (std::size_t k = 0; k < 3; ++k) {
      axes[k] = want(*vertex, std::string_view("xyz").substr(k, 1), false);
      if (!axes[k]) fail_line(vertex->line, "a vertex without coordinates; expected properties x, y and z");
    }
    const auto [u, v] = want_uv(*vertex);
    read_rows(*vertex, [&, u = u, v = v] {
      Vec3 position;
      for (int k = 0; k < 3; ++k) {
        position[k] = axes[k]->values[0];
        if (!std::isfinite(position[k])) fail_value(*axes[k], 0, "the coordinate is not a finite number");
      }
      positions().push_back(position);
      if (u) vertex_uv_.push_back(make_uv(u->values[0], v->values[0]));
    });
  }

  /// The first pair that the vertices have; null if they have none.
  static std::array<Property*, 2> want_uv(Element& vertex) {
    using Names = std::array<std::string_view, 2>;
    for (const auto& [u, v] : {Names{"s", "t"}, Names{"u", "v"}, Names{"texture_u", "texture_v"}}) {
      const std::array<Property*, 2> pair = {want(vertex, u, false), want(vertex, v, false)};
      if (pair[0] && pair[1]) return pair;
    }
    return {};
  }

  void read_faces() {
    Element* face = find_element("face");
    if (!face || face->num_rows == 0)
      throw InputError(name_ + ": there are no faces; expected an element face");
    const Property* indices = want(*face, "vertex_indices", true);
    if (!indices) indices = want(*face, "vertex_index", true);
    if (!indices || !indices->type->is_whole)
      fail_line(face->line, "a face without vertices; expected a list vertex_indices of a whole type");
    const Property* texcoord = want(*face, "texcoord", true);
    read_rows(*face, [&] {
      const std::vector<int> polygon = get_polygon(*indices);
      append_polygon(polygon, get_uv(polygon, texcoord), result_);
    });
  }

  std::vector<int> get_polygon(const Property& indices) {
    const std::vector<double>& values = indices.values;
    if (values.size() < 3)
      fail_value(indices, 0,
                 "a face with " + std::to_string(values.size()) + " vertices; expected three or more");
    const int num_vertices = result_.mesh.num_vertices();
    for (std::size_t k = 0; k < values.size(); ++k) {
      if (!(values[k] >= 0 && values[k] < num_vertices))
        fail_value(indices, k,
                   "vertex " + std::to_string(static_cast<std::int64_t>(values[k])) +
                       " does not exist; expected 0 to " + std::to_string(num_vertices - 1));
    }
    return {values.begin(), values.end()};
  }

  /// Texture coordinates of the corners; empty if the file has none.
  std::vector<Eigen::Vector2d> get_uv(const std::vector<int>& polygon, const Property* texcoord) const {
    std::vector<Eigen::Vector2d> uv;
    if (texcoord && !texcoord->values.empty()) {
      const std::vector<double>& values = texcoord->values;
      if (values.size() != 2 * polygon.size())
        fail_value(*texcoord, 0,
                   "a list of " + std::to_string(values.size()) + " numbers; expected " +
                       std::to_string(2 * polygon.size()) + ", two for each vertex of the face");
      for (std::size_t k = 0; k < values.size(); k += 2) uv.push_back(make_uv(values[k], values[k + 1]));
    } else if (!vertex_uv_.empty()) {
      for (const int v : polygon) uv.push_back(vertex_uv_[v]);
    } else if (texcoord) {
      uv.assign(polygon.size(), {kNotGiven, kNotGiven});
    }
    return uv;
  }

  std::string name_;
  std::string_view bytes_;
  std::optional<std::endian> order_;  // nothing: text
  std::vector<Element> elements_;

  Place at_;
  std::vector<std::string_view> words_;  // of the line
  std::size_t next_word_ = 0;
  const Element* element_ = nullptr;
  int row_ = 0;  // of the element, from 0

  std::vector<Eigen::Vector2d> vertex_uv_;  // (num_vertices), or empty
  MeshFromFile result_;
};

// ---- Out ----

/// Texture coordinates of the vertices (num_vertices), if each has the same at all corners; 0 where no face
/// uses it. Empty if some vertex has several, or a corner has none.
std::vector<Eigen::Vector2d> find_vertex_uv(std::size_t num_vertices, const MeshFaces& faces) {
  std::vector<Eigen::Vector2d> result(num_vertices, Eigen::Vector2d::Zero());
  std::vector<char> is_set(num_vertices, 0);
  for (std::size_t c = 0; c < faces.uv.size(); ++c) {
    const Eigen::Vector2d& uv = faces.uv[c];
    Eigen::Vector2d& own = result[faces.corners[c]];
    char& has_own = is_set[faces.corners[c]];
    if (!uv.allFinite() || (has_own && bits_of(own) != bits_of(uv))) return {};
    own = uv;
    has_own = 1;
  }
  return result;
}

template <class Number>
std::string make_bytes(const std::vector<Vec3>& positions, const MeshFaces& faces) {
  std::size_t num_corners = 0;  // of the largest face
  for (std::size_t f = 0; f < faces.size(); ++f) num_corners = std::max(num_corners, faces[f].size());
  const bool is_short = 2 * num_corners <= std::numeric_limits<std::uint8_t>::max();
  const std::string number = std::is_same_v<Number, float> ? "float" : "double";
  const std::string list = std::string("property list ") + (is_short ? "uchar" : "int");
  std::vector<Eigen::Vector2d> vertex_uv;
  if (!faces.uv.empty()) vertex_uv = find_vertex_uv(positions.size(), faces);
  const bool has_face_uv = !faces.uv.empty() && vertex_uv.empty();

  std::string bytes =
      "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(positions.size()) + '\n';
  for (const char* name : {"x", "y", "z", "s", "t"}) {
    if (*name >= 'x' || !vertex_uv.empty()) bytes += "property " + number + ' ' + name + '\n';
  }
  bytes += "element face " + std::to_string(faces.size()) + '\n' + list + " int vertex_indices\n" +
           (has_face_uv ? list + ' ' + number + " texcoord\n" : "") + "end_header\n";
  const auto append = [&](auto value) { append_bytes(value, std::endian::little, bytes); };
  const auto append_numbers = [&](const auto& values) {
    for (const double value : values) append(static_cast<Number>(value));
  };
  const auto append_count = [&](std::size_t count) {
    is_short ? append(static_cast<std::uint8_t>(count)) : append(static_cast<std::int32_t>(count));
  };
  for (std::size_t v = 0; v < positions.size(); ++v) {
    append_numbers(positions[v]);
    if (!vertex_uv.empty()) append_numbers(vertex_uv[v]);
  }
  for (std::size_t f = 0; f < faces.size(); ++f) {
    append_count(faces[f].size());
    for (const std::int32_t v : faces[f]) append(v);
    if (!has_face_uv) continue;
    append_count(2 * faces[f].size());
    for (const Eigen::Vector2d& corner : faces.uv_of(f)) append_numbers(corner);
  }
  return bytes;
}

}  // namespace

MeshFromFile read_ply(const std::filesystem::path& file) {
  return parse_ply(read_bytes(file, "a PLY file"), file.string());
}

MeshFromFile parse_ply(std::string_view bytes, const std::string& name) {
  return PlyParser(bytes, name).parse();
}

void write_ply(const std::filesystem::path& file, const std::vector<Vec3>& positions, const MeshFaces& faces,
               PlyNumbers numbers) {
  write_file(file, numbers == PlyNumbers::floats ? make_bytes<float>(positions, faces)
                                                 : make_bytes<double>(positions, faces));
}

}  // namespace weft::engine
