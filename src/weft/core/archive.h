#pragma once
/// Binary serialisation, with one description of each type.
///
/// describe(archive, value) lists a type's members; a Writer appends them, a Reader fills them in. Numbers
/// are little-endian, as on every supported machine. A Reader never reserves more memory than a small
/// multiple of the remaining bytes: any input ends with a value or with an InputError.

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "weft/error.h"

namespace weft::engine {

static_assert(std::endian::native == std::endian::little);

template <class T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

class Writer {
 public:
  static constexpr bool kReads = false;
  std::vector<std::byte> bytes;

  template <Plain T>
  void plain(const T& value) {
    plain(&value, 1);
  }

  template <Plain T>
  void plain(const T* values, std::size_t count) {
    const auto* from = reinterpret_cast<const std::byte*>(values);
    bytes.insert(bytes.end(), from, from + count * sizeof(T));
  }
};

class Reader {
 public:
  static constexpr bool kReads = true;

  /// `what` the bytes are, for messages: "a saved world".
  Reader(std::span<const std::byte> bytes, std::string_view what) : left_(bytes), what_(what) {}

  template <Plain T>
  void plain(T& value) {
    if (left_.size() < sizeof value) fail();
    if constexpr (std::is_same_v<T, bool>) {
      value = left_[0] != std::byte{0};
    } else {
      std::memcpy(&value, left_.data(), sizeof value);
    }
    left_ = left_.subspan(sizeof value);
  }

  template <Plain T>
  void plain(T* values, std::size_t count) {
    if (left_.size() / sizeof(T) < count) fail();
    if (count > 0) std::memcpy(values, left_.data(), count * sizeof(T));
    left_ = left_.subspan(count * sizeof(T));
  }

  std::size_t left() const { return left_.size(); }
  [[noreturn]] void fail() const { throw InputError("not " + std::string(what_) + ", or a damaged one"); }

 private:
  std::span<const std::byte> left_;
  std::string_view what_;
};

template <class Archive, Plain T>
void describe(Archive& archive, T& value) {
  archive.plain(value);
}

/// Several members, one after the other.
template <class Archive, class... Members>
void members(Archive& archive, Members&... member) {
  (describe(archive, member), ...);
}

/// Number of elements of a list; each takes at least one byte.
template <class Archive>
std::size_t describe_size(Archive& archive, std::size_t size) {
  auto count = static_cast<std::uint64_t>(size);
  archive.plain(count);
  if constexpr (Archive::kReads) {
    if (count > archive.left()) archive.fail();
  }
  return static_cast<std::size_t>(count);
}

template <class Archive, class T>
void describe(Archive& archive, std::vector<T>& values) {
  const std::size_t count = describe_size(archive, values.size());
  if constexpr (Plain<T> && !std::is_same_v<T, bool>) {
    if constexpr (Archive::kReads) {
      if (count > archive.left() / sizeof(T)) archive.fail();
      values.resize(count);
    }
    archive.plain(values.data(), count);
  } else if constexpr (Archive::kReads) {
    values.clear();
    for (std::size_t i = 0; i < count; ++i) describe(archive, values.emplace_back());
  } else {
    for (T& value : values) describe(archive, value);
  }
}

template <class Archive>
void describe(Archive& archive, std::string& text) {
  text.resize(describe_size(archive, text.size()));
  archive.plain(text.data(), text.size());
}

template <class Archive, class T, std::size_t N>
void describe(Archive& archive, std::array<T, N>& values) {
  for (T& value : values) describe(archive, value);
}

template <class Archive, class T>
void describe(Archive& archive, std::optional<T>& value) {
  bool is_set = value.has_value();
  archive.plain(is_set);
  if constexpr (Archive::kReads) {
    value.reset();
    if (is_set) value.emplace();
  }
  if (value) describe(archive, *value);
}

template <class Archive, class Key, class Value>
void describe(Archive& archive, std::map<Key, Value>& values) {
  std::vector<std::pair<Key, Value>> list(values.begin(), values.end());
  const std::size_t count = describe_size(archive, list.size());
  list.resize(count);
  for (auto& [key, value] : list) members(archive, key, value);
  if constexpr (Archive::kReads) values = {list.begin(), list.end()};
}

template <class Archive, class... Types>
void describe(Archive& archive, std::variant<Types...>& value) {
  auto index = static_cast<std::uint32_t>(value.index());
  archive.plain(index);
  if constexpr (Archive::kReads) {
    if (index >= sizeof...(Types)) archive.fail();
    std::uint32_t type = 0;
    ((index == type++ ? void(value.template emplace<Types>()) : void()), ...);
  }
  std::visit([&](auto& held) { describe(archive, held); }, value);
}

}  // namespace weft::engine
