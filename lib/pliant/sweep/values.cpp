#include "pliant/sweep/values.hpp"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/elementary.hpp"
#include "pliant/core/text.hpp"

namespace pliant {
namespace {

std::string_view trimmed(std::string_view text) { return trim(text, ascii_blanks); }

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0;;) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(trimmed(text.substr(begin, end - begin)));
    if (end == std::string_view::npos) return parts;
    begin = end + 1;
  }
}

std::optional<std::int64_t> integer_of(std::string_view text) {
  std::int64_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || stop != end) return {};
  return number;
}

Result<std::size_t> count_of(std::string_view text) {
  const auto count = integer_of(text);
  if (count && *count >= 1 && static_cast<std::uint64_t>(*count) <= most_takes)
    return static_cast<std::size_t>(*count);
  return fail(ErrorCode::InvalidInput,
              fmt::format("\"{}\" is not a count of values; it must be an integer from 1 to {}",
                          printable(text), most_takes));
}

// A..B
Result<AxisValues> integers(std::int64_t first, std::int64_t last, const StopRequest& should_stop) {
  if (last < first)
    return fail(
        ErrorCode::InvalidInput,
        fmt::format("{}..{} falls; the last integer must not be less than the first", first, last));
  const auto count = static_cast<std::uint64_t>(last) - static_cast<std::uint64_t>(first);
  if (count >= most_takes)
    return fail(ErrorCode::InvalidInput,
                fmt::format("{}..{} are more than {} values", first, last, most_takes));
  AxisValues values;
  for (std::int64_t k = first; k < last; ++k) {
    if (is_stopped(should_stop, values.texts.size())) return interrupted();
    values.texts.push_back(fmt::format("{}", k));
  }
  values.texts.push_back(fmt::format("{}", last));
  return values;
}

// docs/sweeps.md: from left to right, in double.
Result<AxisValues> evenly(double a, double b, std::size_t count, const StopRequest& should_stop) {
  AxisValues values;
  for (std::size_t k = 0; k < count; ++k) {
    if (is_stopped(should_stop, k)) return interrupted();
    const double value =
        count == 1       ? a
        : k + 1 == count ? b
                         : a + (b - a) * static_cast<double>(k) / static_cast<double>(count - 1);
    if (!std::isfinite(value))
      return fail(ErrorCode::InvalidInput,
                  fmt::format("the numbers from {} to {} are not all finite", a, b));
    values.texts.push_back(fmt::format("{}", value));
  }
  return values;
}

Result<AxisValues> evenly_in_logarithm(double a, double b, std::size_t count,
                                       const StopRequest& should_stop) {
  if (a == 0 || b == 0 || (a > 0) != (b > 0))
    return fail(ErrorCode::InvalidInput,
                fmt::format("{} and {} must have one sign, and neither may be 0, to be divided in "
                            "the logarithm",
                            a, b));
  const double sign = a > 0 ? 1 : -1;
  const double from = log_of(std::abs(a)), to = log_of(std::abs(b));
  AxisValues values;
  for (std::size_t k = 0; k < count; ++k) {
    if (is_stopped(should_stop, k)) return interrupted();
    const bool is_last = k + 1 == count && count > 1;
    const double value = k == 0    ? a
                         : is_last ? b
                                   : sign * exp_of(from + (to - from) * static_cast<double>(k) /
                                                              static_cast<double>(count - 1));
    values.texts.push_back(fmt::format("{}", value));
  }
  return values;
}

}  // namespace

Result<AxisValues> parse_axis_values(std::string_view text, const StopRequest& should_stop) {
  if (const std::size_t dots = text.find(".."); dots != std::string_view::npos) {
    const auto first = integer_of(trimmed(text.substr(0, dots)));
    const auto last = integer_of(trimmed(text.substr(dots + 2)));
    if (first && last) return integers(*first, *last, should_stop);
  }
  const std::vector<std::string_view> parts = split(text, ':');
  if (parts.size() >= 2 && parts.size() <= 4) {
    const auto a = to_number(parts[0]), b = to_number(parts[1]);
    if (a && b) {
      if (parts.size() == 2) return AxisValues{{}, *a, *b};
      const auto count = count_of(parts[2]);
      if (!count) return fail(count.error());
      if (parts.size() == 3) return evenly(*a, *b, *count, should_stop);
      if (parts[3] == "log") return evenly_in_logarithm(*a, *b, *count, should_stop);
      return fail(ErrorCode::InvalidInput,
                  fmt::format("\"{}\" is no way to divide an interval; write log or nothing",
                              printable(parts[3])));
    }
  }
  AxisValues values;
  for (const std::string_view part : split(text, ',')) {
    if (part.empty())
      return fail(ErrorCode::InvalidInput,
                  fmt::format("value {} of the list is empty", values.texts.size() + 1));
    values.texts.emplace_back(part);
  }
  if (values.texts.size() > most_takes)
    return fail(ErrorCode::InvalidInput,
                fmt::format("{} values are too many; at most {} are allowed", values.texts.size(),
                            most_takes));
  return values;
}

}  // namespace pliant
