// nlohmann::json instead of tinygltf: tinygltf reads every picture that a file names, and refuses the file if a
// picture is of an unknown kind. It refuses buffers that are longer than their byteLength. It leaves out
// primitives and channels with mistakes without an error.

#include "weft/io/gltf_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <system_error>
#include <utility>

#include "weft/error.h"

namespace weft::engine {
namespace {

namespace fs = std::filesystem;
using Json = GltfFile::Json;

const Json& member(const Json& object, const char* key) {
  static const Json kMissing;
  const auto found = object.find(key);
  return found == object.end() ? kMissing : *found;
}

/// A whole number, 0 or more; a decimal point is allowed.
std::optional<std::uint64_t> as_whole(const Json& value) {
  if (value.is_number_unsigned()) return value.get<std::uint64_t>();
  if (!value.is_number_float()) return std::nullopt;
  const double number = value.get<double>();
  constexpr double kLargest = 9007199254740992;  // 2^53
  if (!(number >= 0 && number <= kLargest && number == std::floor(number))) return std::nullopt;
  return static_cast<std::uint64_t>(number);
}

std::string in_quotes(const std::string& text) {
  constexpr std::size_t kLongest = 80;
  return "\"" + text.substr(0, kLongest) + (text.size() > kLongest ? "…\"" : "\"");
}

std::size_t width_of(std::string_view type) {
  constexpr std::array<std::pair<std::string_view, std::size_t>, 5> kWidths = {
      {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}}};
  return std::ranges::find(kWidths, type, &std::pair<std::string_view, std::size_t>::first)->second;
}

template <class Number>
double load(const unsigned char* bytes) {
  Number number;
  std::memcpy(&number, bytes, sizeof number);
  return static_cast<double>(number);
}

// ---- URIs ----

/// Empty if the text is not base64.
std::optional<std::vector<unsigned char>> decode_base64(std::string_view text) {
  static const std::array<int, 256> kValues = [] {
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::array<int, 256> values;
    values.fill(-1);
    for (std::size_t k = 0; k < kDigits.size(); ++k)
      values[static_cast<unsigned char>(kDigits[k])] = static_cast<int>(k);
    return values;
  }();
  for (int padding = 0; padding < 2 && text.ends_with('='); ++padding) text.remove_suffix(1);
  std::vector<unsigned char> bytes;
  bytes.reserve(text.size() / 4 * 3 + 2);
  unsigned bits = 0;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const int value = kValues[static_cast<unsigned char>(text[k])];
    if (value < 0) return std::nullopt;
    bits = bits << 6 | static_cast<unsigned>(value);
    if (k % 4 > 0) bytes.push_back(static_cast<unsigned char>(bits >> (6 - 2 * (k % 4)) & 0xff));
  }
  return bytes;
}

/// Decodes %20 and the like. Empty for a '%' without two hexadecimal digits.
std::optional<std::string> decode_percent(const std::string& uri) {
  std::string text;
  for (std::size_t k = 0; k < uri.size(); ++k) {
    if (uri[k] != '%') {
      text += uri[k];
      continue;
    }
    const char* const digits = uri.data() + k + 1;  // the text ends in a zero, which is none
    unsigned char code = 0;
    if (std::from_chars(digits, std::min(digits + 2, uri.data() + uri.size()), code, 16).ptr != digits + 2)
      return std::nullopt;
    text += static_cast<char>(code);
    k += 2;
  }
  return text;
}

/// Whether the path leads to a file in its folder or below.
bool stays_below(const std::string& path) {
  const fs::path parts(path);
  constexpr std::string_view kRefused(":\\\0", 3);  // schemes, drives, and the end of C strings
  return !path.empty() && path.find_first_of(kRefused) == path.npos && parts.is_relative() &&
         std::find(parts.begin(), parts.end(), "..") == parts.end();
}

}  // namespace

std::vector<unsigned char> read_file_bytes(const fs::path& file) {
  const auto fail = [&](const std::string& reason) {
    throw InputError(file.string() + ": cannot be read: " + reason);
  };
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (fs::is_directory(status)) fail("it is a folder");
  if (fs::exists(status) && !fs::is_regular_file(status)) fail("it is not a regular file");
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  std::vector<unsigned char> bytes(in ? fs::file_size(file, error) : 0);
  in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!in) fail(std::generic_category().message(errno != 0 ? errno : EIO));
  return bytes;
}

// ---- Component types and accessors ----

struct GltfFile::ComponentType {
  GltfType type;
  std::size_t size;  // [bytes]
  const char* name;
  double (*load)(const unsigned char*);
  double largest;  // the value of a fraction that is 1
};

/// Numbers of an accessor.
struct GltfFile::Shape {
  std::uint64_t count = 0;  // of elements
  std::size_t width = 1;    // numbers of an element
  const ComponentType* type = nullptr;
  bool is_normalized = false;

  std::size_t size() const { return width * type->size; }  // of an element [bytes]

  void read(const unsigned char* element, double* numbers) const {
    for (std::size_t k = 0; k < width; ++k) {
      const double number = type->load(element + k * type->size);
      numbers[k] = is_normalized ? std::max(number / type->largest, -1.0) : number;
    }
  }
};

/// The elements of an accessor in a buffer.
struct GltfFile::Rows {
  const unsigned char* first = nullptr;
  std::size_t stride = 0;  // [bytes]
  const unsigned char* operator[](std::uint64_t row) const { return first + row * stride; }
};

const GltfFile::ComponentType* GltfFile::find_type(GltfType type) {
  static constexpr std::array<ComponentType, 6> kTypes = {
      {{GltfType::int8, 1, "BYTE", load<std::int8_t>, 127},
       {GltfType::uint8, 1, "UNSIGNED_BYTE", load<std::uint8_t>, 255},
       {GltfType::int16, 2, "SHORT", load<std::int16_t>, 32767},
       {GltfType::uint16, 2, "UNSIGNED_SHORT", load<std::uint16_t>, 65535},
       {GltfType::uint32, 4, "UNSIGNED_INT", load<std::uint32_t>, 4294967295},
       {GltfType::float32, 4, "FLOAT", load<float>, 1}}};
  const auto found = std::ranges::find(kTypes, type, &ComponentType::type);
  return found == kTypes.end() ? nullptr : &*found;
}

std::string GltfFile::describe(GltfComponent component) {
  const ComponentType* type = find_type(component.type);
  return (type ? type->name : std::to_string(static_cast<int>(component.type))) +
         std::string(component.is_normalized ? " normalized" : "");
}

const GltfFile::ComponentType* GltfFile::read_type(const Json& object, bool is_normalized,
                                                   std::span<const GltfComponent> allowed,
                                                   const std::string& place) const {
  const std::uint64_t code = get_whole(object, "componentType", std::nullopt, place);
  const GltfComponent component{static_cast<GltfType>(std::min<std::uint64_t>(code, 99999)), is_normalized};
  if (std::ranges::find(allowed, component) != allowed.end()) return find_type(component.type);
  std::string expected;
  for (const GltfComponent& one : allowed)
    expected += (expected.empty() ? "" : one == allowed.back() ? " or " : ", ") + describe(one);
  fail(place, "component type " + describe(component) + ", expected " + expected);
}

GltfFile::Shape GltfFile::read_shape(const Json& accessor, const GltfFormat& format,
                                     const std::string& place) const {
  const std::string type = find_text(accessor, "type", place);
  if (type != format.type) fail(place, "type is " + in_quotes(type) + ", expected " + in_quotes(format.type));
  const Json& normalized = member(accessor, "normalized");
  if (!normalized.is_null() && !normalized.is_boolean()) fail(place, "normalized: expected true or false");
  const bool is_normalized = normalized == true;
  const ComponentType* component = read_type(accessor, is_normalized, format.components, place);
  const std::uint64_t count = get_whole(accessor, "count", std::nullopt, place);
  if (count == 0) fail(place, "count is 0, expected 1 or more");
  return {count, width_of(type), component, is_normalized};
}

/// `source` has the members bufferView and byteOffset.
GltfFile::Rows GltfFile::find_rows(const Json& source, const Shape& shape, const std::string& place) const {
  const int index = find_index(source, "bufferView", count("bufferViews"), place);
  if (index < 0) fail(place, "bufferView is missing");
  const Json& view = list("bufferViews")[index];
  const std::string view_name = "bufferView " + std::to_string(index), at = place + ": " + view_name;
  const int buffer = find_index(view, "buffer", buffers_.size(), at);
  if (buffer < 0) fail(at, "buffer is missing");
  const std::uint64_t begin = get_whole(view, "byteOffset", 0, at);
  const std::uint64_t length = get_whole(view, "byteLength", std::nullopt, at);
  const std::uint64_t in_buffer = buffers_[buffer].size();
  if (begin > in_buffer || length > in_buffer - begin)
    fail(at, "byteOffset " + std::to_string(begin) + " and byteLength " + std::to_string(length) +
                 " exceed the " + std::to_string(in_buffer) + " bytes of buffer " + std::to_string(buffer));
  const std::uint64_t stride = get_whole(view, "byteStride", shape.size(), at);
  constexpr std::uint64_t kLongest = 252;
  if (stride < shape.size() || (stride > kLongest && stride != shape.size()))
    fail(at, "byteStride is " + std::to_string(stride) + ", expected " + std::to_string(shape.size()) +
                 " to " + std::to_string(kLongest));
  const std::uint64_t offset = get_whole(source, "byteOffset", 0, place);
  if (offset > length || shape.size() > length - offset ||
      shape.count - 1 > (length - offset - shape.size()) / stride)
    fail(place, std::to_string(shape.count) + " elements of " + std::to_string(shape.size()) +
                    " bytes at byteOffset " + std::to_string(offset) + " exceed the " +
                    std::to_string(length) + " bytes of " + view_name);
  return {buffers_[buffer].data() + begin + offset, static_cast<std::size_t>(stride)};
}

/// Section 3.6.2.3 of the specification.
void GltfFile::replace_sparse(const Json& sparse, const Shape& shape, const std::string& place,
                              std::vector<double>& numbers) const {
  Shape values = shape;
  values.count = get_whole(sparse, "count", std::nullopt, place);
  if (values.count == 0 || values.count > shape.count)
    fail(place,
         "count is " + std::to_string(values.count) + ", expected 1 to " + std::to_string(shape.count));
  constexpr std::array<GltfComponent, 3> kIndices = {
      {{GltfType::uint8}, {GltfType::uint16}, {GltfType::uint32}}};
  const Json& index_source = get_object(sparse, "indices", place);
  const std::string index_place = place + ": indices";
  const Shape indices{values.count, 1, read_type(index_source, false, kIndices, index_place)};
  const Rows index_rows = find_rows(index_source, indices, index_place);
  const Rows value_rows = find_rows(get_object(sparse, "values", place), values, place + ": values");
  double last = -1;
  for (std::uint64_t k = 0; k < values.count; ++k) {
    double index = 0;
    indices.read(index_rows[k], &index);
    if (!(index > last && index < static_cast<double>(shape.count)))
      fail(index_place, "index " + std::to_string(k) + " is " + std::to_string(std::llround(index)) +
                            ", expected increasing ones below " + std::to_string(shape.count));
    values.read(value_rows[k], &numbers[static_cast<std::size_t>(index) * shape.width]);
    last = index;
  }
}

std::vector<double> GltfFile::read_numbers(int index, const GltfFormat& format, const std::string& place) {
  const Json& accessor = list("accessors")[index];
  const std::string at = place + ": accessor " + std::to_string(index);
  const Shape shape = read_shape(accessor, format, at);
  const bool has_view = accessor.contains("bufferView"), is_sparse = accessor.contains("sparse");
  if (!has_view && !is_sparse && !format.may_be_empty) fail(at, "bufferView is missing");
  const Rows rows = has_view ? find_rows(accessor, shape, at) : Rows{};
  charge(std::min(shape.count, left_to_charge_ + 1) * shape.width, place);
  std::vector<double> numbers(shape.count * shape.width, 0.0);
  for (std::uint64_t k = 0; has_view && k < shape.count; ++k) shape.read(rows[k], &numbers[k * shape.width]);
  if (is_sparse) replace_sparse(get_object(accessor, "sparse", at), shape, at + ": sparse", numbers);
  const auto bad = std::ranges::find_if_not(numbers, [](double x) { return std::isfinite(x); });
  if (bad != numbers.end())
    fail(at, "element " + std::to_string(static_cast<std::size_t>(bad - numbers.begin()) / shape.width) +
                 " has a number that is not finite");
  return numbers;
}

void GltfFile::charge(std::uint64_t count, const std::string& place) {
  if (count > left_to_charge_)
    fail(place, "the file repeats its data: it stands for more numbers than the limit for its size, " +
                    std::to_string(charge_limit_));
  left_to_charge_ -= count;
}

// ---- The file ----

GltfFile::GltfFile(std::vector<unsigned char> bytes, std::string name, const std::optional<fs::path>& folder)
    : bytes_(std::move(bytes)), name_(std::move(name)) {
  parse(read_chunks());
  require_supported();
  read_buffers(folder);
  std::uint64_t num_bytes = bytes_.size();
  for (const auto& [key, other] : other_bytes_) num_bytes += other.size();
  charge_limit_ = std::max(std::uint64_t{1} << 24, 16 * num_bytes);
  left_to_charge_ = charge_limit_;
}

void GltfFile::fail(const std::string& place, const std::string& mistake) const {
  throw InputError(name_ + ": " + place + (place.empty() ? "" : ": ") + mistake);
}

/// The JSON text; sets `binary_chunk_`. Section 4.4 of the specification.
std::string_view GltfFile::read_chunks() {
  const std::string_view file(reinterpret_cast<const char*>(bytes_.data()), bytes_.size());
  if (!file.starts_with("glTF")) return file;
  const auto fail_at = [&](std::size_t at, const std::string& what) {
    fail("byte " + std::to_string(at), what);
  };
  const auto word = [&](std::size_t at) {
    return static_cast<std::size_t>(load<std::uint32_t>(&bytes_[at]));
  };
  constexpr std::size_t kHeader = 12, kChunkHeader = 8, kJson = 0x4E4F534A, kBinary = 0x004E4942;
  if (file.size() < kHeader) fail_at(file.size(), "the file ends, expected a .glb header of 12 bytes");
  if (word(4) != 2) fail_at(4, "version " + std::to_string(word(4)) + ", expected 2");
  const std::size_t end = word(8);
  if (end < kHeader || end > file.size())
    fail_at(8, "length is " + std::to_string(end) + ", but the file has " + std::to_string(file.size()) +
                   " bytes");
  std::string_view text;
  std::size_t at = kHeader;
  do {
    if (end - at < kChunkHeader) fail_at(at, "the file ends, expected a chunk header of 8 bytes");
    const std::size_t length = word(at), kind = word(at + 4), data = at + kChunkHeader;
    if (length > end - data)
      fail_at(at, "a chunk of " + std::to_string(length) + " bytes, but " + std::to_string(end - data) +
                      " follow");
    if (at == kHeader && kind != kJson) fail_at(at + 4, "expected the JSON chunk");
    if (at == kHeader) text = file.substr(data, length);
    if (kind == kBinary && binary_chunk_.empty()) binary_chunk_ = std::span(bytes_).subspan(data, length);
    at = data + length;
  } while (at < end);
  return text;
}

void GltfFile::parse(std::string_view text) {
  const auto begin = static_cast<std::size_t>(text.data() - reinterpret_cast<const char*>(bytes_.data()));
  try {
    json_ = Json::parse(text);
  } catch (const Json::parse_error& error) {
    const std::string expected = "this is not JSON; expected a glTF 2.0 file";
    const std::size_t at = std::min(text.size(), std::max<std::size_t>(error.byte, 1) - 1);
    if (begin > 0) fail("byte " + std::to_string(begin + at), expected);
    throw InputError(name_ + ":" + std::to_string(1 + std::ranges::count(text.substr(0, at), '\n')) + ": " +
                     expected);
  } catch (const Json::exception&) {
    fail("", "a number in its JSON text is too large");
  }
  if (!json_.is_object()) fail("", "its JSON text is not an object; expected a glTF 2.0 file");
  const std::string version = find_text(get_object(json_, "asset", ""), "version", "asset");
  if (!version.starts_with("2.")) fail("asset", "version is " + in_quotes(version) + ", expected \"2.0\"");
  for (const char* key :
       {"accessors", "animations", "buffers", "bufferViews", "meshes", "nodes", "scenes", "skins"})
    find_list(json_, key, "");
}

void GltfFile::require_supported() const {
  // Materials and the like, which are not read; and integers as coordinates.
  constexpr std::array<std::string_view, 6> kSupported = {"KHR_materials_", "KHR_texture_",
                                                          "EXT_texture_",   "MSFT_texture_",
                                                          "KHR_lights_",    "KHR_mesh_quantization"};
  for (const Json& entry : member(json_, "extensionsRequired")) {
    const std::string name = entry.is_string() ? entry.get<std::string>() : "";
    if (std::ranges::any_of(kSupported, [&](std::string_view start) { return name.starts_with(start); }))
      continue;
    fail("extensionsRequired", in_quotes(name) + " is not supported; expected a file " +
                                   (name.ends_with("_compression") ? "without compression" : "without it"));
  }
}

bool GltfFile::uses(const char* extension) const {
  const Json& used = member(json_, "extensionsUsed");
  return std::find(used.begin(), used.end(), extension) != used.end();
}

/// The first byteLength bytes of each buffer. A buffer without data is empty, and therefore accessors that use
/// it are refused.
void GltfFile::read_buffers(const std::optional<fs::path>& folder) {
  for (const Json& buffer : list("buffers")) {
    const std::string place = "buffer " + std::to_string(buffers_.size());
    const std::uint64_t length = get_whole(buffer, "byteLength", std::nullopt, place);
    const std::string uri = find_text(buffer, "uri", place);
    const bool has_data = !uri.empty() || (buffers_.empty() && !binary_chunk_.empty());
    const std::span<const unsigned char> bytes = uri.empty() ? binary_chunk_ : read_uri(uri, folder, place);
    if (has_data && bytes.size() < length)
      fail(place, "byteLength is " + std::to_string(length) + ", but it has " + std::to_string(bytes.size()) +
                      " bytes");
    buffers_.push_back(has_data ? bytes.first(length) : bytes.first(0));
  }
}

/// The bytes of a data URI, or of a file, which is read once.
std::span<const unsigned char> GltfFile::read_uri(const std::string& uri,
                                                  const std::optional<fs::path>& folder,
                                                  const std::string& place) {
  if (uri.starts_with("data:")) {
    const std::string_view data(uri);
    const std::size_t comma = std::min(data.find(','), data.size() - 1);
    auto bytes =
        data.substr(0, comma).ends_with(";base64") ? decode_base64(data.substr(comma + 1)) : std::nullopt;
    if (!bytes) fail(place, "its data URI is not base64");
    return other_bytes_["data:" + place] = std::move(*bytes);  // no path: it has a colon, and no slash
  }
  const std::optional<std::string> path = decode_percent(uri);
  if (!folder || !path || !stays_below(*path))
    fail(place, "uri is " + in_quotes(uri) + ", expected a file in the folder of the .gltf file or below");
  const fs::path file = (*folder / *path).lexically_normal();
  const auto [found, is_new] = other_bytes_.try_emplace(file.string());
  if (!is_new) return found->second;
  try {
    return found->second = read_file_bytes(file);
  } catch (const InputError& error) {
    fail(place, error.what());
  }
}

// ---- Members ----

const Json& GltfFile::list(const char* key) const {
  static const Json kEmpty = Json::array();
  const Json& found = member(json_, key);
  return found.is_null() ? kEmpty : found;
}

std::uint64_t GltfFile::get_whole(const Json& object, const char* key, std::optional<std::uint64_t> otherwise,
                                  const std::string& place) const {
  const Json& value = member(object, key);
  if (value.is_null() && otherwise) return *otherwise;
  const std::optional<std::uint64_t> number = as_whole(value);
  if (!number) fail(place, std::string(key) + ": expected a whole number, 0 or more");
  return *number;
}

const Json& GltfFile::get_object(const Json& object, const char* key, const std::string& place) const {
  const Json& value = member(object, key);
  if (!value.is_object()) fail(place, std::string(key) + ": expected an object {…}");
  return value;
}

const Json& GltfFile::find_list(const Json& object, const char* key, const std::string& place) const {
  static const Json kEmpty = Json::array();
  const Json& value = member(object, key);
  if (value.is_null()) return kEmpty;
  if (!value.is_array() || !std::ranges::all_of(value, [](const Json& item) { return item.is_object(); }))
    fail(place, std::string(key) + ": expected a list of objects");
  return value;
}

int GltfFile::find_index(const Json& object, const char* key, std::size_t count,
                         const std::string& place) const {
  const Json& value = member(object, key);
  return value.is_null() ? -1 : get_index(value, key, count, place);
}

std::vector<int> GltfFile::find_indices(const Json& object, const char* key, std::size_t count,
                                        const std::string& place) const {
  const Json& value = member(object, key);
  if (!value.is_null() && !value.is_array())
    fail(place, std::string(key) + ": expected a list of whole numbers");
  std::vector<int> indices;
  for (const Json& entry : value) indices.push_back(get_index(entry, key, count, place));
  return indices;
}

int GltfFile::get_index(const Json& value, const char* key, std::size_t count,
                        const std::string& place) const {
  const std::optional<std::uint64_t> index = as_whole(value);
  if (!index) fail(place, std::string(key) + ": expected a whole number, 0 or more");
  if (*index >= count)
    fail(place, std::string(key) + ": " + std::to_string(*index) + " does not exist; there are " +
                    std::to_string(count) + ", from 0");
  return static_cast<int>(*index);
}

std::vector<double> GltfFile::find_numbers(const Json& object, const char* key, std::size_t count,
                                           const std::string& place) const {
  const Json& value = member(object, key);
  if (value.is_null()) return {};
  const bool is_good = value.is_array() && value.size() == count &&
                       std::ranges::all_of(value, [](const Json& x) { return x.is_number(); });
  if (!is_good) fail(place, std::string(key) + ": expected " + std::to_string(count) + " numbers");
  return value.get<std::vector<double>>();
}

std::string GltfFile::find_text(const Json& object, const char* key, const std::string& place) const {
  const Json& value = member(object, key);
  if (!value.is_null() && !value.is_string()) fail(place, std::string(key) + ": expected a text in quotes");
  return value.is_null() ? "" : value.get<std::string>();
}

}  // namespace weft::engine
