#include "weft/io/stl.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <unordered_map>

#include "weft/core/hash.h"
#include "weft/error.h"
#include "weft/io/byte_order.h"
#include "weft/io/input_file.h"
#include "weft/io/words.h"

namespace weft::engine {
namespace {

// ---- The mesh ----

using Point = std::array<float, 3>;

struct PointHash {
  std::size_t operator()(const Point& point) const {
    Hash hash;
    hash.add(point);
    return hash.value();
  }
};

Vec3 to_vec(const Point& p) { return Eigen::Map<const Eigen::Vector3f>(p.data()).cast<double>(); }

/// Facets joined to a mesh.
class FacetMesh {
 public:
  void add(const std::array<Point, 3>& corners) {
    const Vec3 a = to_vec(corners[0]), b = to_vec(corners[1]), c = to_vec(corners[2]);
    if ((b - a).cross(c - a) == Vec3::Zero()) {
      if (num_flat_++ == 0) first_flat_ = num_facets_;
    } else {
      result_.mesh.triangles.push_back({vertex(corners[0]), vertex(corners[1]), vertex(corners[2])});
    }
    ++num_facets_;
  }

  MeshFromFile finish(const std::string& name) {
    if (result_.mesh.triangles.empty()) throw InputError(name + ": there are no facets with area");
    if (num_flat_ > 0)
      result_.warnings.push_back(name + ": " + std::to_string(num_flat_) +
                                 " facets without area were dropped; the first is facet " +
                                 std::to_string(first_flat_));
    result_.faces = make_faces(result_.mesh.triangles);
    return std::move(result_);
  }

 private:
  /// Index of the vertex at the point; a new one at a new point.
  int vertex(Point point) {
    for (float& coordinate : point) coordinate += 0.0F;  // -0 becomes 0
    const auto [found, is_new] = vertices_.try_emplace(point, result_.mesh.num_vertices());
    if (is_new) result_.mesh.positions.push_back(to_vec(point));
    return found->second;
  }

  std::unordered_map<Point, int, PointHash> vertices_;
  std::size_t num_facets_ = 0, num_flat_ = 0, first_flat_ = 0;
  MeshFromFile result_;
};

// ---- Binary ----

constexpr std::size_t kCountAt = 80, kHeader = 84, kNormal = 12, kFacet = 50;

std::uint64_t count_at(std::string_view bytes) {
  return number_from_bytes<std::uint32_t>(&bytes[kCountAt], std::endian::little);
}

/// Size of a file with the count of this one [bytes].
std::uint64_t binary_size(std::string_view bytes) { return kHeader + kFacet * count_at(bytes); }

MeshFromFile parse_binary(std::string_view bytes, const std::string& name) {
  const auto fail = [&](std::size_t byte, const std::string& message) {
    throw InputError(name + ": byte " + std::to_string(byte) + ": " + message);
  };
  if (bytes.size() < kHeader)
    fail(bytes.size(), "the file ends; expected the word solid, or a binary header of 84 bytes");
  const std::uint64_t size = binary_size(bytes);
  if (bytes.size() < size)
    fail(kCountAt, std::to_string(count_at(bytes)) + " facets, but the file holds " +
                       std::to_string((bytes.size() - kHeader) / kFacet));
  FacetMesh mesh;
  for (std::size_t facet = kHeader; facet < size; facet += kFacet) {
    std::array<Point, 3> corners;
    std::size_t at = facet + kNormal;
    for (Point& corner : corners) {
      for (float& coordinate : corner) {
        coordinate = number_from_bytes<float>(&bytes[at], std::endian::little);
        if (!std::isfinite(coordinate)) fail(at, "the coordinate is not a finite number");
        at += sizeof coordinate;
      }
    }
    mesh.add(corners);
  }
  MeshFromFile result = mesh.finish(name);
  if (bytes.size() > size)
    result.warnings.push_back(name + ": " + std::to_string(bytes.size() - size) +
                              " bytes behind the last facet were ignored");
  return result;
}

// ---- Text ----

class TextParser {
 public:
  TextParser(std::string_view text, const std::string& name) : name_(name), text_(text) {}

  MeshFromFile parse() {
    while (at_ < text_.size()) {
      words_.clear();
      append_words(take_line(text_, at_), words_);
      ++line_;
      if (!words_.empty()) read_line(to_lower(words_[0]));
    }
    if (is_in_solid_) fail("the file ends in a solid; expected endsolid");
    return mesh_.finish(name_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(name_ + ":" + std::to_string(line_) + ": " + message);
  }

  void require_order(bool is_in_order) const {
    if (!is_in_order)
      fail(in_quotes(words_[0]) +
           " is out of order; expected solid, then for each facet the lines facet, outer loop, three lines "
           "vertex X Y Z, endloop, endfacet, then endsolid");
  }

  void read_line(const std::string& keyword) {
    if (keyword == "vertex") {
      require_order(is_in_facet_);
      read_vertex();
    } else if (keyword == "facet") {
      require_order(is_in_solid_ && !is_in_facet_);
      is_in_facet_ = true;
    } else if (keyword == "endfacet") {
      require_order(is_in_facet_);
      add_facet();
      is_in_facet_ = false;
    } else if (keyword == "solid") {
      require_order(!is_in_solid_);
      is_in_solid_ = true;
    } else if (keyword == "endsolid") {
      require_order(is_in_solid_ && !is_in_facet_);
      is_in_solid_ = false;
    } else if (keyword == "outer" || keyword == "endloop") {
      require_order(is_in_facet_);
    } else {
      fail("unknown word " + in_quotes(words_[0]) +
           "; expected solid, facet, outer loop, vertex, endloop, endfacet or endsolid");
    }
  }

  void read_vertex() {
    if (words_.size() != 4)
      fail("a vertex with " + std::to_string(words_.size() - 1) +
           " coordinates; expected vertex X Y Z with three numbers");
    constexpr double kFloatMax = std::numeric_limits<float>::max();
    Point& corner = corners_.emplace_back();
    for (std::size_t k = 0; k < 3; ++k) {
      const std::optional<double> value = parse_finite(words_[k + 1]);
      if (!value || std::abs(*value) > kFloatMax)
        fail(in_quotes(words_[k + 1]) + " is not a coordinate; expected a finite float");
      corner[k] = static_cast<float>(*value);
    }
  }

  void add_facet() {
    if (corners_.size() != 3)
      fail("a facet with " + std::to_string(corners_.size()) + " vertices; expected three");
    mesh_.add({corners_[0], corners_[1], corners_[2]});
    corners_.clear();
  }

  std::string name_;
  std::string_view text_;
  std::size_t at_ = 0;  // next byte
  int line_ = 0;        // from 1
  std::vector<std::string_view> words_;

  bool is_in_solid_ = false, is_in_facet_ = false;
  std::vector<Point> corners_;  // of the facet
  FacetMesh mesh_;
};

bool is_text(std::string_view bytes) {
  constexpr std::string_view kSolid = "solid";
  if (bytes.size() >= kHeader && bytes.size() == binary_size(bytes)) return false;
  bytes.remove_prefix(std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size()));
  return to_lower(bytes.substr(0, kSolid.size())) == kSolid;
}

}  // namespace

MeshFromFile read_stl(const std::filesystem::path& file) {
  return parse_stl(read_bytes(file, "an STL file"), file.string());
}

MeshFromFile parse_stl(std::string_view bytes, const std::string& name) {
  return is_text(bytes) ? TextParser(bytes, name).parse() : parse_binary(bytes, name);
}

}  // namespace weft::engine
