#include <algorithm>
#include <optional>

#include "weft/scene/toml_document.h"

namespace weft::engine {
namespace {

constexpr int kMaxDepth = 32;  // of brackets, and of dots in a key

/// Scanner for nesting depth: distinguishes brackets and dots from those in strings and comments. In text
/// that is not TOML the count may be wrong, but there toml++ stops too.
class DepthScanner {
 public:
  explicit DepthScanner(std::string_view text) : text_(text) {}

  /// The first offset with too deep nesting.
  std::optional<std::size_t> find_too_deep() {
    for (; at_ < text_.size(); skip()) {
      count(text_[at_]);
      if (brackets_ > kMaxDepth || dots_ > kMaxDepth) return at_;
    }
    return {};
  }

 private:
  void count(char c) {
    if (c == '[' || c == '{') ++brackets_;
    if (c == ']' || c == '}') brackets_ = std::max(0, brackets_ - 1);
    const bool ends_key = std::string_view("[]{}=,\n").find(c) != std::string_view::npos;
    dots_ = ends_key ? 0 : dots_ + (c == '.');
  }

  /// To the next character outside strings and comments.
  void skip() {
    const char c = text_[at_];
    if (c == '#') {
      at_ = std::min(text_.find('\n', at_), text_.size());
    } else if (c == '"' || c == '\'') {
      skip_string(c);
    } else {
      ++at_;
    }
  }

  void skip_string(char delimiter) {
    const std::string triple(3, delimiter);
    const bool is_long = text_.substr(at_, 3) == triple;
    at_ += is_long ? 3 : 1;
    while (at_ < text_.size() && !ends_string(is_long ? triple : triple.substr(2), is_long)) {
      at_ += delimiter == '"' && text_[at_] == '\\' ? 2 : 1;
    }
    at_ = std::min(at_, text_.size());
  }

  bool ends_string(const std::string& end, bool is_long) {
    if (!is_long && text_[at_] == '\n') return true;
    if (text_.substr(at_, end.size()) != end) return false;
    at_ += end.size();
    // Up to two more quotes belong to a long string.
    for (int i = 0; is_long && i < 2 && at_ < text_.size() && text_[at_] == end[0]; ++i) ++at_;
    return true;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  int brackets_ = 0, dots_ = 0;
};

/// Lines and columns as in toml++: columns are code points.
SceneError make_error(std::string_view text, std::size_t at, const std::string& source, std::string message) {
  Diagnostic d = {source, 1, 1, std::move(message)};
  for (const char c : text.substr(0, at)) {
    const bool continues = (static_cast<unsigned char>(c) & 0xC0) == 0x80;
    if (!continues) ++d.column;
    if (c == '\n') ++d.line, d.column = 1;
  }
  return SceneError({std::move(d)});
}

/// Whether parsing breaks a precondition of toml++.
bool trips_toml(std::string_view text) {
  try {
    static_cast<void>(toml::parse(text));
  } catch (const toml::parse_error&) {
  } catch (const std::logic_error&) {
    return true;
  }
  return false;
}

/// The character that breaks the precondition, which toml++ does not report: the last one of the shortest
/// prefix that breaks it.
std::size_t find_tripping(std::string_view text) {
  std::size_t good = 0, bad = text.size();
  while (bad - good > 1) {
    const std::size_t middle = good + (bad - good) / 2;
    (trips_toml(text.substr(0, middle)) ? bad : good) = middle;
  }
  return good;
}

std::string explain(const std::string& description) {
  const bool is_bare_word = description.find("could not determine value type") != std::string::npos;
  return description + (is_bare_word ? "; text must be in quotes" : "");
}

}  // namespace

toml::table parse_toml(std::string_view text, const std::string& source) {
  if (const auto at = DepthScanner(text).find_too_deep()) {
    throw make_error(text, *at, source, "nested more than " + std::to_string(kMaxDepth) + " levels deep");
  }
  try {
    return toml::parse(text, source);
  } catch (const toml::parse_error& error) {
    const toml::source_position& place = error.source().begin;
    throw SceneError({{source, static_cast<int>(place.line), static_cast<int>(place.column),
                       "not TOML: " + explain(std::string(error.description()))}});
  } catch (const std::logic_error&) {
    throw make_error(text, find_tripping(text), source, "not TOML: unexpected character");
  }
}

}  // namespace weft::engine
