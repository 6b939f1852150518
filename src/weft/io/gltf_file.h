#pragma once
/// Private to io/: a glTF 2.0 file as JSON and buffers, with checked access.

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace weft::engine {

/// Component types of accessors, by their numbers in glTF.
enum class GltfType {
  int8 = 5120,
  uint8 = 5121,
  int16 = 5122,
  uint16 = 5123,
  uint32 = 5125,
  float32 = 5126,
};

struct GltfComponent {
  GltfType type = GltfType::float32;
  bool is_normalized = false;  // integers are fractions of the largest one
  bool operator==(const GltfComponent&) const = default;
};

/// The expected format of an accessor.
struct GltfFormat {
  std::string type;                       // "SCALAR", "VEC2", "VEC3", "VEC4" or "MAT4"
  std::vector<GltfComponent> components;  // the allowed ones
  bool may_be_empty = false;              // an accessor without data has zeros
};

/// A glTF file. Every function throws InputError, "FILE: PLACE: mistake", for a mistake in the file. `place` is
/// part of that message: "mesh 2, primitive 0: POSITION".
class GltfFile {
 public:
  using Json = nlohmann::json;

  /// From the bytes of a .glb file or the text of a .gltf file; `name` is the file name in messages. Buffers in
  /// other files are read from `folder` and below; without it they are mistakes.
  GltfFile(std::vector<unsigned char> bytes, std::string name,
           const std::optional<std::filesystem::path>& folder);

  const std::string& name() const { return name_; }
  [[noreturn]] void fail(const std::string& place, const std::string& mistake) const;

  /// The objects of a list at the top, as "nodes"; empty if it is missing.
  const Json& list(const char* key) const;
  std::size_t count(const char* key) const { return list(key).size(); }
  const Json& top() const { return json_; }
  bool uses(const char* extension) const;

  // Members of an object. The find_ functions return −1 or an empty value if it is missing. Indices are below
  // `count`.
  std::uint64_t get_whole(const Json& object, const char* key, std::optional<std::uint64_t> otherwise,
                          const std::string& place) const;
  const Json& get_object(const Json& object, const char* key, const std::string& place) const;
  const Json& find_list(const Json& object, const char* key, const std::string& place) const;  // of objects
  int find_index(const Json& object, const char* key, std::size_t count, const std::string& place) const;
  std::vector<int> find_indices(const Json& object, const char* key, std::size_t count,
                                const std::string& place) const;
  std::vector<double> find_numbers(const Json& object, const char* key, std::size_t count,
                                   const std::string& place) const;
  std::string find_text(const Json& object, const char* key, const std::string& place) const;

  /// All numbers of an accessor, which are finite.
  std::vector<double> read_numbers(int accessor, const GltfFormat& format, const std::string& place);

  /// Counts numbers to be stored or visited, because a file may refer to its data any number of times. Their
  /// sum is limited to 16 for each byte of the file and its buffers, but not below 2^24.
  void charge(std::uint64_t count, const std::string& place);

 private:
  struct ComponentType;
  struct Shape;
  struct Rows;

  std::string_view read_chunks();
  void parse(std::string_view text);
  void require_supported() const;
  void read_buffers(const std::optional<std::filesystem::path>& folder);
  std::span<const unsigned char> read_uri(const std::string& uri,
                                          const std::optional<std::filesystem::path>& folder,
                                          const std::string& place);
  int get_index(const Json& value, const char* key, std::size_t count, const std::string& place) const;
  const ComponentType* read_type(const Json& object, bool is_normalized,
                                 std::span<const GltfComponent> allowed, const std::string& place) const;
  Shape read_shape(const Json& accessor, const GltfFormat& format, const std::string& place) const;
  Rows find_rows(const Json& source, const Shape& shape, const std::string& place) const;
  void replace_sparse(const Json& sparse, const Shape& shape, const std::string& place,
                      std::vector<double>& numbers) const;

  static const ComponentType* find_type(GltfType type);
  static std::string describe(GltfComponent component);

  std::vector<unsigned char> bytes_;
  std::string name_;
  std::span<const unsigned char> binary_chunk_;  // of a .glb file
  Json json_;
  std::map<std::string, std::vector<unsigned char>> other_bytes_;  // of buffers outside `bytes_`, by path
  std::vector<std::span<const unsigned char>> buffers_;
  std::uint64_t charge_limit_ = 0, left_to_charge_ = 0;
};

/// The file's bytes. Throws InputError, naming the file, if it cannot be read.
std::vector<unsigned char> read_file_bytes(const std::filesystem::path& file);

}  // namespace weft::engine
