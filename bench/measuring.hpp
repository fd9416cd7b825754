#pragma once

// Shared by the benchmarks: clocks, medians, a folder, and options.

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <variant>
#include <vector>

#include "pliant/core/result.hpp"

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

/// A folder that is removed at the end.
class ScratchFolder {
 public:
  explicit ScratchFolder(const std::filesystem::path& parent) {
    std::string name = parent / "pliant-bench-XXXXXX";
    path_ = mkdtemp(name.data());
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  std::string file(std::string_view name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// The value, or the end of the program with the errors on stderr.
template <class T>
T value_or_abort(pliant::Result<T> result) {
  if (result) return *std::move(result);
  for (const std::string& line : pliant::to_lines(result.error()))
    std::fprintf(stderr, "%s\n", line.c_str());
  std::abort();
}

/// Seconds of all processors since the program began.
inline double processor_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

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
