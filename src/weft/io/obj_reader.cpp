// Own parser, because tinyobjloader fails on common files. It reads a bad coordinate as 0, only warns of an
// index out of range, and takes the garment keyword `t` for a subdivision tag. Its triangulation depends on
// the distance to the origin: far away, every second concave nonagon is wrong.

#include "weft/io/obj_reader.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string_view>
#include <system_error>
#include <unordered_map>
#include <utility>

#include "weft/core/hash.h"
#include "weft/core/staged_file.h"
#include "weft/error.h"
#include "weft/io/input_file.h"
#include "weft/io/words.h"

namespace weft::engine {
namespace {

// ---- Lines and words ----

/// The text as lines of words. '#' starts a comment; a backslash at the end continues a line.
class LineReader {
 public:
  explicit LineReader(std::string_view text) : rest_(text) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (rest_.starts_with(kByteOrderMark)) rest_.remove_prefix(kByteOrderMark.size());
  }

  /// Advances to the next line; false at the end of the text.
  bool next() {
    if (rest_.empty()) return false;
    words_.clear();
    line_ = lines_taken_ + 1;
    while (take_line()) {
    }
    return true;
  }

  int line() const { return line_; }  // from 1; the first one of a continued line
  const std::vector<std::string_view>& words() const { return words_; }

 private:
  /// Appends the words of one line of the text; true if the next line continues it.
  bool take_line() {
    const auto is_end = [](char c) { return c == '\r' || c == '\n'; };
    const std::size_t length = std::ranges::find_if(rest_, is_end) - rest_.begin();
    const std::string_view line = rest_.substr(0, length);
    append_words(line.substr(0, line.find('#')), words_);
    rest_.remove_prefix(length);
    rest_.remove_prefix(rest_.starts_with("\r\n") ? 2 : rest_.empty() ? 0 : 1);
    ++lines_taken_;
    if (words_.empty() || !words_.back().ends_with('\\')) return false;
    words_.back().remove_suffix(1);
    if (words_.back().empty()) words_.pop_back();
    return !rest_.empty();
  }

  std::string_view rest_;
  std::vector<std::string_view> words_;
  int line_ = 0;
  int lines_taken_ = 0;
};

/// The vertex index of a, a/b, a//c or a/b/c.
std::optional<long long> parse_index(std::string_view word) {
  word = word.substr(0, word.find('/'));
  long long index = 0;
  const auto [end, error] = std::from_chars(word.begin(), word.end(), index);
  if (error != std::errc() || end != word.end() || index == 0) return std::nullopt;
  return index;
}

/// The index of texture coordinates of a/b or a/b/c; 0 if there is none.
long long parse_uv_index(std::string_view word) {
  const std::size_t slash = word.find('/');
  if (slash == word.npos) return 0;
  word = word.substr(slash + 1);
  return parse_index(word).value_or(0);
}

// ---- Groups ----

/// The groups of a file, while its faces are counted. A line costs as much as it is long, whatever the number
/// of faces behind it.
class GroupList {
 public:
  /// g NAME NAME …: the groups of the faces from this one on; no names: none.
  void set_groups(std::span<const std::string_view> names, int face) {
    close(open_groups_, face);
    for (const std::string_view name : names) open(name, false, face, open_groups_);
  }

  /// o NAME: the object of the faces from this one on; "": none.
  void set_object(const std::string& name, int face) {
    close(open_objects_, face);
    if (!name.empty()) open(name, true, face, open_objects_);
  }

  std::vector<MeshGroup> finish(int num_faces) {
    close(open_groups_, num_faces);
    close(open_objects_, num_faces);
    std::erase_if(groups_, [](const MeshGroup& group) { return group.faces.empty(); });
    std::ranges::stable_sort(groups_, {}, [](const MeshGroup& group) {
      return std::pair(group.faces.front().begin, !group.is_object);
    });
    return std::move(groups_);
  }

 private:
  void open(std::string_view name, bool is_object, int face, std::vector<std::size_t>& opened) {
    const auto [found, is_new] = numbers_.try_emplace({is_object, std::string(name)}, groups_.size());
    if (is_new) groups_.push_back({std::string(name), is_object, {}});
    std::vector<FaceRange>& faces = groups_[found->second].faces;
    if (!faces.empty() && faces.back().end == kOpen) return;  // twice on a line
    const bool continues = !faces.empty() && faces.back().end == face;
    continues ? void(faces.back().end = kOpen) : faces.push_back({face, kOpen});
    opened.push_back(found->second);
  }

  void close(std::vector<std::size_t>& opened, int face) {
    for (const std::size_t k : opened) {
      std::vector<FaceRange>& faces = groups_[k].faces;
      faces.back().end = face;
      if (faces.back().begin == face) faces.pop_back();
    }
    opened.clear();
  }

  static constexpr int kOpen = -1;                               // end of a range that goes on
  std::vector<MeshGroup> groups_;                                // in the order of their first lines
  std::map<std::pair<bool, std::string>, std::size_t> numbers_;  // by MeshGroup::is_object and name
  std::vector<std::size_t> open_groups_, open_objects_;
};

/// The words with one blank between them: names of objects may have blanks.
std::string join(std::span<const std::string_view> words) {
  std::string text;
  for (const std::string_view word : words) (text += text.empty() ? "" : " ") += word;
  return text;
}

// ---- The file ----

class ObjParser {
 public:
  ObjParser(std::string_view text, const std::string& name) : name_(name), lines_(text) {}

  MeshFromFile parse() {
    while (lines_.next()) {
      if (!lines_.words().empty()) read_line(lines_.words()[0]);
    }
    if (positions().empty()) throw InputError(name_ + ": there are no vertices; expected lines v X Y Z");
    if (faces_.empty()) throw InputError(name_ + ": there are no faces; expected lines f A B C");
    for (const Face& face : faces_) add_face(face);
    if (!has_uv_) {
      result_.uv.clear();
      result_.faces.uv.clear();
    }
    result_.faces.groups = groups_.finish(num_faces());
    add_lines();
    add_warnings();
    return std::move(result_);
  }

  /// The vertices of a file with these faces.
  std::vector<Vec3> parse_vertices(const MeshFaces& faces) {
    std::size_t num_compared = 0;
    while (lines_.next()) {
      if (lines_.words().empty()) continue;
      if (lines_.words()[0] == "v") read_vertex();
      if (lines_.words()[0] != "f") continue;
      if (num_compared == faces.size() || !has_corners(faces[num_compared]))
        fail(lines_.line(),
             "face " + std::to_string(num_compared + 1) + " is not that of the first file" + kSameFaces);
      ++num_compared;
    }
    if (num_compared < faces.size())
      throw InputError(name_ + ": has " + std::to_string(num_compared) + " faces, the first file " +
                       std::to_string(faces.size()) + kSameFaces);
    return std::move(positions());
  }

 private:
  struct Face {
    int line = 0;
    std::vector<long long> vertices;  // from 0; later lines may define them
    std::vector<long long> uv;        // likewise; -1: none
  };
  struct Unknown {
    int num_lines = 0;
    int first_line = 0;
  };

  std::vector<Vec3>& positions() { return result_.mesh.positions; }
  int num_faces() const { return static_cast<int>(faces_.size()); }

  [[noreturn]] void fail(int line, const std::string& message) const {
    throw InputError(name_ + ":" + std::to_string(line) + ": " + message);
  }

  void read_line(std::string_view keyword) {
    // vv and t occur in the garment files of Berkeley.
    constexpr std::array<std::string_view, 8> kPassedOver = {"vn", "mtllib", "usemtl", "usemap",
                                                             "s",  "p",      "vv",     "t"};
    if (keyword == "v") {
      read_vertex();
    } else if (keyword == "vt") {
      read_uv();
    } else if (keyword == "f") {
      read_face();
    } else if (keyword == "l") {
      read_polyline();
    } else if (keyword == "g") {
      groups_.set_groups({lines_.words().begin() + 1, lines_.words().end()}, num_faces());
    } else if (keyword == "o") {
      groups_.set_object(join({lines_.words().begin() + 1, lines_.words().end()}), num_faces());
    } else if (std::find(kPassedOver.begin(), kPassedOver.end(), keyword) == kPassedOver.end()) {
      Unknown& unknown = unknown_[std::string(keyword)];
      if (unknown.num_lines++ == 0) unknown.first_line = lines_.line();
    }
  }

  /// v X Y Z; a weight or a colour may follow.
  void read_vertex() {
    const auto& words = lines_.words();
    if (words.size() < 4) {
      fail(lines_.line(), "a vertex with " + std::to_string(words.size() - 1) +
                              " coordinates; expected v X Y Z with three numbers");
    }
    Vec3 position;
    for (int k = 0; k < 3; ++k) {
      const std::string_view word = words[k + 1];
      const auto coordinate = parse_finite(word);
      if (!coordinate)
        fail(lines_.line(), in_quotes(word) + " is not a coordinate; expected a finite number");
      position[k] = *coordinate;
    }
    positions().push_back(position);
  }

  /// vt U V; a third one may follow, and V, then 0, be left out. Words that are no numbers count as missing.
  void read_uv() {
    const auto& words = lines_.words();
    const std::optional<double> u = words.size() > 1 ? parse_finite(words[1]) : std::nullopt,
                                v = words.size() > 2 ? parse_finite(words[2]) : 0.0;
    uv_.push_back(u && v ? Eigen::Vector2d(*u, *v) : Eigen::Vector2d(kNotGiven, kNotGiven));
  }

  /// f A B C …; each index counts from 1, or from -1 backwards from the vertex read last.
  void read_face() {
    const auto& words = lines_.words();
    if (words.size() < 4) {
      fail(lines_.line(),
           "a face with " + std::to_string(words.size() - 1) + " vertices; expected three or more");
    }
    Face face{lines_.line(), {}, {}};
    const auto num_uv = static_cast<long long>(uv_.size());
    for (size_t k = 1; k < words.size(); ++k) {
      const auto index = parse_index(words[k]);
      if (!index) {
        fail(lines_.line(), in_quotes(words[k]) +
                                " is not a vertex of a face; expected A, A/B, A//C or A/B/C " +
                                "with a whole number A other than 0");
      }
      const auto num_read = static_cast<long long>(positions().size());
      if (*index < -num_read) {
        fail(lines_.line(), "vertex " + std::to_string(*index) + " does not exist; " +
                                std::to_string(num_read) + " vertices come before this face");
      }
      face.vertices.push_back(*index > 0 ? *index - 1 : num_read + *index);
      const long long uv = parse_uv_index(words[k]);
      face.uv.push_back(uv > 0 ? uv - 1 : uv < 0 ? num_uv + uv : -1);
    }
    faces_.push_back(std::move(face));
  }

  /// l A B C …; one with another word or an index that does not exist is ignored.
  void read_polyline() {
    const auto& words = lines_.words();
    long long before = -1;
    for (std::size_t k = 1; k < words.size(); ++k) {
      const long long index = parse_index(words[k]).value_or(0),
                      num_read = static_cast<long long>(positions().size());
      const long long vertex = index > 0 ? index - 1 : index < 0 ? num_read + index : -1;
      if (before >= 0 && vertex >= 0) pairs_.push_back({before, vertex});
      before = vertex;
    }
  }

  void add_lines() {
    const auto count = static_cast<long long>(positions().size());
    for (const auto& [a, b] : pairs_) {
      if (a < count && b < count && a != b)
        result_.faces.lines.push_back({static_cast<int>(a), static_cast<int>(b)});
    }
  }

  /// Whether the face of this line has these corners.
  bool has_corners(std::span<const int> corners) const {
    const auto& words = lines_.words();
    if (words.size() != corners.size() + 1) return false;
    const auto num_read = static_cast<long long>(result_.mesh.positions.size());
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const long long index = parse_index(words[k + 1]).value_or(0);
      if ((index > 0 ? index - 1 : num_read + index) != corners[k]) return false;
    }
    return true;
  }

  void add_face(const Face& face) {
    const auto num_vertices = static_cast<long long>(positions().size());
    std::vector<int> polygon;
    for (const long long v : face.vertices) {
      if (v >= num_vertices) {
        fail(face.line, "vertex " + std::to_string(v + 1) + " does not exist; expected at most " +
                            std::to_string(num_vertices) + ", the number of vertices");
      }
      polygon.push_back(static_cast<int>(v));
    }
    std::vector<Eigen::Vector2d> uv;
    for (const long long index : face.uv) uv.push_back(uv_at(index));
    append_polygon(polygon, uv, result_);
  }

  Eigen::Vector2d uv_at(long long index) {
    const bool is_there = index >= 0 && index < static_cast<long long>(uv_.size());
    if (!is_there) return {kNotGiven, kNotGiven};
    const Eigen::Vector2d& uv = uv_[static_cast<std::size_t>(index)];
    has_uv_ = has_uv_ || uv.allFinite();
    return uv;
  }

  void add_warnings() {
    constexpr size_t kMaxWarnings = 8;  // a file of another kind may have thousands
    for (const auto& [keyword, unknown] : unknown_) {
      if (result_.warnings.size() == kMaxWarnings) {
        const size_t num_omitted = unknown_.size() - kMaxWarnings;
        result_.warnings.push_back(name_ + ": " + std::to_string(num_omitted) +
                                   " more unknown keywords were ignored");
        return;
      }
      result_.warnings.push_back(name_ + ":" + std::to_string(unknown.first_line) + ": unknown keyword " +
                                 in_quotes(keyword) + " was ignored; it begins " +
                                 std::to_string(unknown.num_lines) + " lines");
    }
  }

  static constexpr double kNotGiven = std::numeric_limits<double>::quiet_NaN();

  std::string name_;
  LineReader lines_;
  std::vector<Eigen::Vector2d> uv_;
  bool has_uv_ = false;  // of any triangle
  std::vector<Face> faces_;
  std::vector<std::array<long long, 2>>
      pairs_;  // vertices that lines join, from 0; later lines may define them
  GroupList groups_;
  std::map<std::string, Unknown> unknown_;
  MeshFromFile result_;
};

// ---- Out ----

/// The shortest digits that read back as the same double.
void append_number(std::string& text, double value) {
  std::array<char, 32> digits;
  const auto [end, error] = std::to_chars(digits.data(), digits.data() + digits.size(), value);
  text.append(digits.data(), end);
}

void append_positions(std::string& text, const std::vector<Vec3>& positions) {
  for (const Vec3& position : positions) {
    text += 'v';
    for (const double coordinate : position) append_number(text += ' ', coordinate);
    text += '\n';
  }
}

struct BitsHash {
  std::size_t operator()(const std::array<std::uint64_t, 2>& bits) const {
    Hash hash;
    hash.add(bits);
    return hash.value();
  }
};

/// Writes each texture coordinate once. The number of each corner's, from 1; 0: none. Empty without any.
std::vector<std::size_t> append_uv(std::string& text, const std::vector<Eigen::Vector2d>& uv) {
  std::vector<std::size_t> numbers;
  std::unordered_map<std::array<std::uint64_t, 2>, std::size_t, BitsHash> known;
  for (const Eigen::Vector2d& corner : uv) {
    if (!corner.allFinite()) {
      numbers.push_back(0);
      continue;
    }
    const auto [found, is_new] = known.try_emplace(bits_of(corner), known.size() + 1);
    numbers.push_back(found->second);
    if (!is_new) continue;
    append_number(text += "vt ", corner.x());
    append_number(text += ' ', corner.y());
    text += '\n';
  }
  return numbers;
}

/// The lines o and g of a file, before the faces at which they change.
class GroupLines {
 public:
  explicit GroupLines(const std::vector<MeshGroup>& groups) : groups_(groups) {
    for (std::size_t k = 0; k < groups.size(); ++k) {
      for (const auto [begin, end] : groups[k].faces) {
        changes_[begin].push_back(k);
        changes_[end].push_back(k);
      }
    }
    next_ = changes_.begin();
  }

  void append(std::string& text, std::size_t face) {
    if (next_ == changes_.end() || next_->first != static_cast<int>(face)) return;
    std::array<bool, 2> has_changed = {};
    for (const std::size_t k : next_->second) {
      std::set<std::size_t>& open = open_[groups_[k].is_object];
      if (open.erase(k) == 0) open.insert(k);
      has_changed[groups_[k].is_object] = true;
    }
    if (has_changed[1]) append_line(text, "o", open_[1]);
    if (has_changed[0]) append_line(text, "g", open_[0]);
    ++next_;
  }

 private:
  void append_line(std::string& text, const char* keyword, const std::set<std::size_t>& open) const {
    text += keyword;
    for (const std::size_t k : open) text += ' ' + groups_[k].name;
    text += '\n';
  }

  const std::vector<MeshGroup>& groups_;
  std::map<int, std::vector<std::size_t>> changes_;  // by face: the groups that begin or end there
  std::map<int, std::vector<std::size_t>>::const_iterator next_;
  std::array<std::set<std::size_t>, 2> open_;  // by MeshGroup::is_object
};

/// Whether the reader returns the name.
bool is_writable(const MeshGroup& group) {
  std::vector<std::string_view> words;
  append_words(group.name, words);
  const bool is_same = !words.empty() && (group.is_object ? join(words) : words[0]) == group.name;
  return is_same && group.name.find_first_of("#\n") == group.name.npos && !group.name.ends_with('\\');
}

void require_writable(const std::filesystem::path& file, const std::vector<MeshGroup>& groups) {
  for (const MeshGroup& group : groups) {
    if (!is_writable(group))
      throw InputError(file.string() + " cannot be written: an OBJ file has no name " +
                       in_quotes(group.name) + "; expected " + (group.is_object ? "words" : "one word") +
                       " without # and \\");
  }
}

}  // namespace

MeshFromFile read_obj(const std::filesystem::path& file) {
  return parse_obj(read_bytes(file, "an OBJ file"), file.string());
}

MeshFromFile parse_obj(const std::string& text, const std::string& name) {
  return ObjParser(text, name).parse();
}

std::vector<Vec3> read_obj_vertices(const std::filesystem::path& file, const MeshFaces& faces) {
  const std::string text = read_bytes(file, "an OBJ file");
  return ObjParser(text, file.string()).parse_vertices(faces);
}

void write_obj(const std::filesystem::path& file, const std::vector<Vec3>& positions,
               const MeshFaces& faces) {
  require_writable(file, faces.groups);
  write_file(file, obj_text(positions, faces));
}

std::string obj_text(const std::vector<Vec3>& positions, const MeshFaces& faces) {
  std::string text;
  append_positions(text, positions);
  const std::vector<std::size_t> uv = append_uv(text, faces.uv);
  GroupLines groups(faces.groups);
  for (std::size_t f = 0; f < faces.size(); ++f) {
    groups.append(text, f);
    text += 'f';
    for (std::size_t c = faces.begin_of(f); c < faces.ends[f]; ++c) {
      text += ' ' + std::to_string(faces.corners[c] + 1);
      if (!uv.empty() && uv[c] > 0) text += '/' + std::to_string(uv[c]);
    }
    text += '\n';
  }
  for (const auto& [a, b] : faces.lines)
    text += "l " + std::to_string(a + 1) + ' ' + std::to_string(b + 1) + '\n';
  return text;
}

void write_obj(const std::filesystem::path& file, const TriangleMesh& mesh, const std::vector<CornerUv>& uv) {
  write_obj(file, mesh.positions, make_faces(mesh.triangles, uv));
}

void write_obj(const std::filesystem::path& file, const std::vector<ObjObject>& objects) {
  std::vector<Vec3> positions;
  MeshFaces faces;
  for (const auto& [name, mesh] : objects) {
    const int first_vertex = static_cast<int>(positions.size()), first_face = static_cast<int>(faces.size());
    positions.insert(positions.end(), mesh.positions.begin(), mesh.positions.end());
    for (const auto& [a, b, c] : mesh.triangles)
      faces.add(std::array{first_vertex + a, first_vertex + b, first_vertex + c});
    faces.groups.push_back({name, true, {{first_face, static_cast<int>(faces.size())}}});
  }
  write_obj(file, positions, faces);
}

}  // namespace weft::engine
