#pragma once

// Shared by the benchmarks: a clock, medians, and options.

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <initializer_list>
#include <string>
#include <string_view>
#include <system_error>
#include <variant>
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

/// Whether the whole text is a number of at least 0.
template <class Number>
bool read_value(std::string_view text, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() && number >= 0;
}

inline bool read_value(std::string_view text, std::string& value) {
  value = text;
  return true;
}

inline bool read_value(std::string_view text, bool& flag) { return flag = text.empty(); }

/// "51,101": nodes on each side of a square, 3 or more.
inline bool read_value(std::string_view text, std::vector<int>& sides) {
  sides.clear();
  while (!text.empty()) {
    const std::size_t comma = std::min(text.find(','), text.size());
    if (!read_value(text.substr(0, comma), sides.emplace_back()) || sides.back() < 3) return false;
    text.remove_prefix(std::min(comma + 1, text.size()));
  }
  return true;
}

/// An option of a command line and what it sets: a number, sides, a text, or a flag, which has no
/// value.
struct Option {
  std::string_view name;
  std::variant<bool*, int*, std::size_t*, double*, std::vector<int>*, std::string*> value;
};

/// Reads a command line. False, with the usage on stderr: it has something else.
inline bool read_options(int count, char* words[], std::initializer_list<Option> options,
                         const char* usage) {
  const auto read = [&](int& k) {
    const auto option = std::ranges::find(options, std::string_view(words[k]), &Option::name);
    if (option == options.end()) return false;
    const bool is_flag = std::holds_alternative<bool*>(option->value);
    if (!is_flag && ++k == count) return false;
    const std::string_view text = is_flag ? "" : words[k];
    return std::visit([&](auto* value) { return read_value(text, *value); }, option->value);
  };
  for (int k = 1; k < count; ++k) {
    if (read(k)) continue;
    std::fprintf(stderr, "usage: %s\n", usage);
    return false;
  }
  return true;
}
