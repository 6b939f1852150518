#include "weft/io/words.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

namespace weft::engine {
namespace {

/// Whether a decimal number other than 0 has a magnitude below 1. from_chars has one error for numbers too small
/// and too large.
bool is_below_one(std::string_view number) {
  const std::size_t e = std::min(number.find_first_of("eE"), number.size());
  const std::string_view digits = number.substr(0, e);
  const auto point = static_cast<long long>(std::min(digits.find('.'), digits.size()));
  const auto first = static_cast<long long>(digits.find_first_of("123456789"));
  const long long power = first < point ? point - first - 1 : point - first;  // of ten, without the exponent
  std::string_view exponent = number.substr(std::min(e + 1, number.size()));
  if (exponent.starts_with('+')) exponent.remove_prefix(1);
  long long value = 0;
  const auto [end, error] = std::from_chars(exponent.begin(), exponent.end(), value);
  if (error == std::errc::result_out_of_range) return exponent.starts_with('-');
  return power + value < 0;
}

}  // namespace

std::string_view take_line(std::string_view text, std::size_t& at) {
  const std::size_t begin = at, end = std::min(text.find('\n', at), text.size());
  at = std::min(end + 1, text.size());
  return text.substr(begin, end - begin);
}

void append_words(std::string_view line, std::vector<std::string_view>& words) {
  // The searches of std::string_view for one of several characters call memchr for each character.
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\r'; };
  for (auto begin = line.begin(); (begin = std::find_if_not(begin, line.end(), is_blank)) != line.end();) {
    const auto end = std::find_if(begin, line.end(), is_blank);
    words.emplace_back(begin, end);
    begin = end;
  }
}

std::optional<double> parse_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.begin(), word.end(), value);
  if (end != word.end()) return std::nullopt;
  if (error == std::errc::result_out_of_range && is_below_one(word))
    return word.starts_with('-') ? -0.0 : 0.0;
  if (error != std::errc()) return std::nullopt;
  return value;
}

std::optional<double> parse_finite(std::string_view word) {
  const std::optional<double> value = parse_number(word);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::string to_lower(std::string_view word) {
  std::string lower(word);
  for (char& c : lower) {
    if ('A' <= c && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower;
}

std::string in_quotes(std::string_view word) {
  constexpr std::size_t kLongest = 40;
  const bool is_long = word.size() > kLongest;
  std::string shown(word.substr(0, kLongest));
  for (char& c : shown) {
    if (c < ' ' || c > '~') c = '?';
  }
  return "'" + shown + (is_long ? "…'" : "'");
}

}  // namespace weft::engine
