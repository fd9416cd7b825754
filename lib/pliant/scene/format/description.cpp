#include "pliant/scene/format/description.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pliant {

std::optional<std::string> Range::broken_rule(std::span<const double> numbers) const {
  const std::string_view each = numbers.size() > 1 ? "each number must" : "must";
  const auto any = [&](auto&& fails) { return std::any_of(numbers.begin(), numbers.end(), fails); };
  const bool is_low = any([&](double x) { return excludes_least ? x <= least : x < least; });
  const bool is_high = any([&](double x) { return x > most; });
  if ((is_low || is_high) && !excludes_least && std::isfinite(least) && std::isfinite(most))
    return fmt::format("{} be from {} to {}", each, least, most);
  if (is_low)
    return fmt::format("{} be {} {}", each, excludes_least ? "greater than" : "at least", least);
  if (is_high) return fmt::format("{} be at most {}", each, most);
  if (excludes_zero && any([](double x) { return x == 0; }))
    return fmt::format("{} differ from 0", each);
  return {};
}

std::string Range::to_text() const {
  if (excludes_zero) return "≠ 0";
  std::string text;
  if (std::isfinite(least) && std::isfinite(most) && !excludes_least)
    return fmt::format("{:.17g} to {:.17g}", least, most);
  if (std::isfinite(least)) text = fmt::format("{} {}", excludes_least ? ">" : "≥", least);
  if (std::isfinite(most)) text += fmt::format("{}≤ {}", text.empty() ? "" : ", ", most);
  return text;
}

std::string name_of(MapChannel channel) {
  return "map." + std::string(map_channel_words[static_cast<std::size_t>(channel)]);
}

std::string name_of_hold(std::size_t number) { return fmt::format("hold.{}", number); }

}  // namespace pliant
