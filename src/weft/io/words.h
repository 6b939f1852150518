#pragma once
/// Words and numbers of text files.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace weft::engine {

/// The line of the text that begins at byte `at`, without its end; advances `at` to the next line.
std::string_view take_line(std::string_view text, std::size_t& at);

/// Appends the words of a line, which blanks separate.
void append_words(std::string_view line, std::vector<std::string_view>& words);

/// The number that the whole word is, a leading + included; 0 for one that is too small for a double. Nothing
/// for other words, and for a number that is too large.
std::optional<double> parse_number(std::string_view word);

/// The same for finite numbers only.
std::optional<double> parse_finite(std::string_view word);

/// The word with lower-case ASCII letters.
std::string to_lower(std::string_view word);

/// The word for a message, shortened if it is long; ? for each byte that is not a printable ASCII character.
std::string in_quotes(std::string_view word);

}  // namespace weft::engine
