#include "cli/sweep/slurm_script.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "cli/terminal/shell_word.hpp"

namespace pliant::cli {
namespace {

constexpr std::string_view letters_and_digits =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";
constexpr double memory_margin = 1.25;
constexpr double time_margin = 4;
constexpr double least_minutes = 30, most_minutes = 365 * 24 * 60;

bool is_plain(std::string_view text, std::string_view signs) {
  return !text.empty() && std::ranges::all_of(text, [&](char c) {
    return letters_and_digits.find(c) != std::string_view::npos ||
           signs.find(c) != std::string_view::npos;
  });
}

std::string replaced(std::string_view text, char old, std::string_view by) {
  std::string result;
  for (const char c : text) {
    if (c == old) {
      result += by;
    } else {
      result += c;
    }
  }
  return result;
}

// The value of an option in an #SBATCH line. Its quotes are not bash's: a backslash is special in
// both kinds, but outside of them it does not hold words together.
std::string sbatch_value(std::string_view text) {
  if (is_plain(text, "_@%+=:,./-")) return std::string(text);
  return '"' + replaced(text, '"', "\\\"") + '"';
}

std::string job_name(std::string_view sweep) {
  constexpr std::size_t longest = 64;
  std::string name(sweep.substr(0, longest));
  for (char& c : name)
    if (!is_plain({&c, 1}, "_.-")) c = '_';
  return "pliant-" + name;
}

// A list of ranges, of numbers that are at most so far from the one before.
std::string ranges_of(std::span<const std::size_t> numbers, std::size_t gap) {
  std::string list;
  for (std::size_t k = 0; k < numbers.size();) {
    std::size_t last = k;
    while (last + 1 < numbers.size() && numbers[last + 1] - numbers[last] <= gap) ++last;
    if (!list.empty()) list += ',';
    list += std::to_string(numbers[k]);
    if (last > k) list += '-' + std::to_string(numbers[last]);
    k = last + 1;
  }
  return list;
}

// Reads a number off the front.
std::optional<std::size_t> take_number(std::string_view& text) {
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc()) return {};
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return number;
}

}  // namespace

std::string array_list(std::span<const std::size_t> numbers, std::size_t most) {
  std::vector<std::size_t> gaps = {1};  // between neighbours
  for (std::size_t k = 1; k < numbers.size(); ++k) gaps.push_back(numbers[k] - numbers[k - 1]);
  std::ranges::sort(gaps);
  gaps.erase(std::unique(gaps.begin(), gaps.end()), gaps.end());
  const auto is_too_long = [&](std::size_t gap) { return ranges_of(numbers, gap).size() > most; };
  const auto least = std::ranges::partition_point(gaps, is_too_long);
  return ranges_of(numbers, least == gaps.end() ? gaps.back() : *least);
}

std::optional<std::vector<std::size_t>> read_array_list(std::string_view list, std::size_t end) {
  if (const std::size_t limit = list.find('%'); limit != std::string_view::npos)
    list = list.substr(0, limit);
  std::set<std::size_t> numbers;
  for (;;) {
    const auto first = take_number(list);
    if (!first) return {};
    std::size_t last = *first, step = 1;
    if (list.starts_with('-')) {
      list.remove_prefix(1);
      const auto read = take_number(list);
      if (!read || *read < *first) return {};
      last = *read;
      if (list.starts_with(':')) {
        list.remove_prefix(1);
        const auto stride = take_number(list);
        if (!stride || *stride < 1) return {};
        step = std::min(*stride, end + 1);
      }
    }
    for (std::size_t number = *first; number <= last && number < end; number += step)
      numbers.insert(number);
    if (list.empty()) return std::vector<std::size_t>(numbers.begin(), numbers.end());
    if (!list.starts_with(',')) return {};
    list.remove_prefix(1);
  }
}

std::string_view wrong_slurm_folder(std::string_view folder) {
  if (std::ranges::any_of(folder, [](char c) { return (c >= 0 && c < ' ') || c == '\x7f'; }))
    return "a folder for --engine slurm has no control characters in its name";
  if (folder.find('\\') != std::string_view::npos)
    return "a folder for --engine slurm has no backslash in its name: in the name of a log, Slurm "
           "then puts no numbers";
  return {};
}

std::string job_script(const SlurmScript& script) {
  std::string text = "#!/bin/bash\n";
  const auto add = [&](std::string_view option) { text += fmt::format("#SBATCH {}\n", option); };
  add("--job-name=" + job_name(script.name));
  add("--requeue");
  add("--open-mode=append");
  add("--output=" + sbatch_value(replaced(script.folder, '%', "%%") + "/slurm/%A_%a.log"));
  add(fmt::format("--cpus-per-task={}", script.threads));
  if (script.memory)
    add(fmt::format("--mem={:.0f}M",
                    std::ceil(static_cast<double>(*script.memory) * memory_margin / (1 << 20U))));
  if (script.seconds)
    add(fmt::format("--time={:.0f}", std::clamp(std::ceil(*script.seconds * time_margin / 60),
                                                least_minutes, most_minutes)));
  text += fmt::format(
      "exec {} sweep run {} --part $SLURM_ARRAY_TASK_ID/{} --threads $SLURM_CPUS_PER_TASK "
      "--quiet{}{}{}\n",
      shell_word(script.executable), shell_word(script.folder), script.parts,
      script.max_memory > 0 ? fmt::format(" --max-memory {}", script.max_memory) : "",
      script.root.empty() ? "" : " --root " + shell_word(script.root),
      script.retries ? " --retry" : "");
  return text;
}

}  // namespace pliant::cli
