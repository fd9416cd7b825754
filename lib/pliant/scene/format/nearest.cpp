#include "pliant/scene/format/nearest.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <fmt/format.h>

#include "pliant/scene/text/text.hpp"

namespace pliant::xml {
namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

/// Typing errors between two words: Damerau's distance in its "optimal string alignment" form, in
/// which a swapped pair is not edited again. Three rows of the usual table: i-2, i-1, i.
std::size_t slips(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1);
  std::vector<std::size_t> above(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) above[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const bool same = lower(a[i - 1]) == lower(b[j - 1]);
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (same ? 0 : 1)});
      const bool swapped = i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
                           lower(a[i - 2]) == lower(b[j - 1]);
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before.swap(above);
    above.swap(row);
  }
  return above[b.size()];
}

}  // namespace

std::optional<std::string_view> nearest_word(std::string_view word,
                                             std::span<const std::string_view> candidates) {
  constexpr std::size_t longest = 64;  // no word of the format is near a longer word
  if (word.size() > longest) return std::nullopt;
  std::optional<std::string_view> best;
  std::size_t fewest = longest;
  for (const std::string_view candidate : candidates) {
    const std::size_t longer = std::max(word.size(), candidate.size());
    const std::size_t shorter = std::min(word.size(), candidate.size());
    if (longer > longest || (longer - shorter) * 3 > longer) continue;
    const std::size_t count = slips(word, candidate);
    if (count * 3 > longer || count >= fewest) continue;
    best = candidate;
    fewest = count;
  }
  return best;
}

std::string hint(std::string_view word, std::span<const std::string_view> candidates) {
  constexpr std::size_t most_compared = 1000;  // limits the names of a scene; the format has fewer
                                               // words
  constexpr std::size_t most_listed = 24;
  candidates = candidates.first(std::min(candidates.size(), most_compared));
  const std::optional<std::string_view> near = nearest_word(word, candidates);
  const bool all = candidates.size() <= most_listed;
  return fmt::format(
      "; {}allowed: {}{}", near ? fmt::format("did you mean \"{}\"? ", *near) : "",
      candidates.empty() ? "none" : listed(all ? candidates : candidates.first(most_listed)),
      all ? "" : ", …");
}

}  // namespace pliant::xml
