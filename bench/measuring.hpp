#pragma once

// Shared by the benchmarks: a clock, medians, and numbers from the command line.

#include <algorithm>
#include <charconv>
#include <chrono>
#include <string_view>
#include <system_error>
#include <vector>

/// The duration of some work. [s]
template <class Work>
double seconds(const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// The median of many times, or the minimum.
inline double typical(std::vector<double> times, bool is_least) {
  const auto middle = times.begin() + static_cast<long>(is_least ? 0 : times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  return *middle;
}

/// Whether the whole text is a number.
template <class Number>
bool read_number(std::string_view text, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size();
}

/// "51,101": nodes on each side of a square, 3 or more.
inline bool read_sides(std::string_view text, std::vector<int>& sides) {
  sides.clear();
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    int side = 0;
    if (!read_number(text.substr(0, comma), side) || side < 3) return false;
    sides.push_back(side);
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return true;
}
