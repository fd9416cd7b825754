#include "pliant/scene/text/text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/core/text.hpp"

namespace pliant::xml {
namespace {

/// The number of numbers in words: `one number`.
std::string counted_numbers(std::size_t count) {
  static constexpr std::string_view words[] = {"no number", "one number", "two numbers",
                                               "three numbers", "four numbers"};
  return count < std::size(words) ? std::string(words[count]) : fmt::format("{} numbers", count);
}

/// Why from_chars stopped at `rest` instead of the end of `word`.
std::string trailing_complaint(std::string_view word, std::string_view rest,
                               std::string_view what) {
  const std::string_view number = word.substr(0, word.size() - rest.size());
  if (rest == "," || rest == ";")
    return fmt::format("not {}: {} follows {} (separate numbers by blanks alone)", what,
                       in_quotes(rest), number);
  if (rest.front() == ',')
    return fmt::format("not {}: {} follows {} (write the decimal point as \".\")", what,
                       in_quotes(rest), number);
  return fmt::format("not {}: {} follows {}", what, in_quotes(rest), number);
}

/// Reads a whole word by from_chars; `what` names the expected kind.
template <class T>
Checked<T> parse_word(std::string_view word, std::string_view what) {
  if (word.empty()) return refused(fmt::format("is empty; {} is required", what));
  if (word.front() == '+')
    return refused(fmt::format("not {}: write it without the plus sign", what));
  T number = 0;
  const char* const end = word.data() + word.size();
  const auto [stop, failure] = std::from_chars(word.data(), end, number);
  if (failure == std::errc::invalid_argument) return refused(fmt::format("not {}", what));
  if (stop != end) return refused(trailing_complaint(word, word.substr(stop - word.data()), what));
  if (failure == std::errc::result_out_of_range)
    return refused("outside the range of numbers that can be stored");
  return number;
}

/// Several numbers between commas, semicolons or in brackets, as other programs write a vector,
/// with blanks instead; empty: they are not.
std::string between_blanks(std::string_view text, std::size_t count) {
  std::string spaced(text);
  for (char& c : spaced)
    if (std::string_view(",;()[]{}").find(c) != std::string_view::npos) c = ' ';
  const std::vector<std::string_view> words = words_of(spaced);
  const bool are_numbers =
      words.size() == count && std::all_of(words.begin(), words.end(), [](std::string_view word) {
        return parse_word<double>(word, "").has_value();
      });
  return are_numbers && spaced != text ? fmt::format("{}", fmt::join(words, " ")) : "";
}

/// Also rejects `nan` and `inf`, which from_chars accepts.
Checked<double> parse_finite(std::string_view word) {
  Checked<double> number = parse_word<double>(word, "a number");
  if (number && !std::isfinite(*number)) return refused("not a finite number");
  return number;
}

}  // namespace

std::string_view trimmed(std::string_view text) { return trim(text, blanks); }

std::vector<std::string_view> words_of(std::string_view text) {
  return pliant::words_of(text, blanks);
}

Checked<double> parse_number(std::string_view text) {
  double number = 0;
  const Checked<void> read = parse_numbers(text, {&number, 1});
  if (!read) return tl::unexpected(read.error());
  return number;
}

Checked<std::int64_t> parse_integer(std::string_view text, std::int64_t least, std::int64_t most) {
  Checked<std::int64_t> number = parse_word<std::int64_t>(trimmed(text), "a whole number");
  if (!number) return number;
  if (*number < least) return refused(fmt::format("must be at least {}", least));
  if (*number > most) return refused(fmt::format("must be at most {}", most));
  return number;
}

Checked<std::uint64_t> parse_natural(std::string_view text) {
  const std::string_view word = trimmed(text);
  if (word.starts_with('-')) return refused("must be at least 0");
  return parse_word<std::uint64_t>(word, "a whole number");
}

Checked<void> parse_numbers(std::string_view text, std::span<double> numbers) {
  const std::vector<std::string_view> words = words_of(text);
  if (words.empty())
    return refused(fmt::format("is empty; {} {} required", counted_numbers(numbers.size()),
                               numbers.size() == 1 ? "is" : "are"));
  std::vector<double> found;
  for (const std::string_view word : words) {
    const Checked<double> number = parse_finite(word);
    if (!number) {
      const std::string spaced =
          numbers.size() > 1 ? between_blanks(text, numbers.size()) : std::string();
      return refused(!spaced.empty() ? "numbers are separated by blanks alone: " + in_quotes(spaced)
                     : words.size() == 1
                         ? number.error().message
                         : fmt::format("{}: {}", in_quotes(word), number.error().message));
    }
    found.push_back(*number);
  }
  if (found.size() != numbers.size())
    return refused(fmt::format("{} {} required, not {}{}", counted_numbers(numbers.size()),
                               numbers.size() == 1 ? "is" : "are", found.size(),
                               numbers.size() > 1 ? " (separated by spaces)" : ""));
  std::copy(found.begin(), found.end(), numbers.begin());
  return {};
}

Checked<bool> parse_boolean(std::string_view text) {
  const std::string_view word = trimmed(text);
  if (word == "true") return true;
  if (word == "false") return false;
  return refused("must be true or false");
}

Checked<double> parse_rate(std::string_view text) {
  const std::string_view whole = trimmed(text);
  const std::size_t slash = whole.find('/');
  Checked<double> over = parse_finite(whole.substr(0, slash));
  if (!over) return over;
  double rate = *over;
  if (slash != std::string_view::npos) {
    const Checked<double> under = parse_finite(whole.substr(slash + 1));
    if (!under)
      return refused(fmt::format("after the \"/\" of the fraction: {}", under.error().message));
    if (*under <= 0) return refused("the denominator of the fraction must be greater than 0");
    rate /= *under;
  }
  if (!(rate > 0) || !std::isfinite(rate)) return refused("must be greater than 0 and finite");
  return rate;
}

std::string listed(std::span<const std::string_view> words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace pliant::xml
