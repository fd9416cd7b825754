#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <iterator>
#include <utility>
#include <vector>

#include "pliant/core/stop_request.hpp"

namespace pliant {

/// Sorts as `std::stable_sort` does, and asks meanwhile. False: it was stopped, and the order is
/// any. Takes as much memory again.
template <class Item, class Less = std::less<>>
bool sort_unless_stopped(std::vector<Item>& items, StopPoll& poll, const Less& is_less = {}) {
  constexpr std::size_t block = std::size_t{1} << 13U;  // a sort of so few takes a millisecond
  constexpr std::size_t parts_of_item = 16;
  const std::size_t count = items.size();
  const auto at = [&](std::size_t place) {
    return items.begin() + static_cast<std::ptrdiff_t>(std::min(place, count));
  };
  for (std::size_t first = 0; first < count; first += block) {
    if (poll.after(parts_of_item * block)) return false;
    std::stable_sort(at(first), at(first + block), is_less);
  }
  if (count <= block) return true;
  std::vector<Item> merged;
  merged.reserve(count);
  for (std::size_t width = block; width < count; width *= 2) {
    for (std::size_t first = 0; first < count; first += 2 * width) {
      const auto middle = at(first + width), end = at(first + 2 * width);
      auto left = at(first), right = middle;
      while (left != middle || right != end) {
        if (poll.after()) return false;
        const bool is_right = left == middle || (right != end && is_less(*right, *left));
        merged.push_back(std::move(is_right ? *right++ : *left++));
      }
    }
    items.swap(merged);
    merged.clear();
  }
  return true;
}

/// Puts the item of rank `nth` in its place, smaller ones before it and larger ones behind it, and
/// asks meanwhile; if the items are chosen to make that slow, the last part is done at once. False:
/// it was stopped. Requires: random access; no two items are equal.
template <class Iterator, class Less>
bool select_unless_stopped(Iterator begin, Iterator nth, Iterator end, StopPoll& poll,
                           const Less& is_less) {
  constexpr std::ptrdiff_t block = std::ptrdiff_t{1} << 13;
  constexpr int most_rounds = 64;  // each halves what is left, nearly
  for (int round = 0; end - begin > block && round < most_rounds; ++round) {
    // The middle of five, evenly spaced.
    const std::ptrdiff_t step = (end - begin) / 5;
    typename std::iterator_traits<Iterator>::value_type sample[5];
    for (int k = 0; k < 5; ++k) sample[k] = begin[step / 2 + k * step];
    std::sort(std::begin(sample), std::end(sample), is_less);
    const auto pivot = sample[2];
    Iterator low = begin, high = end;
    while (true) {
      for (; is_less(*low, pivot); ++low) {
        if (poll.after()) return false;
      }
      for (--high; is_less(pivot, *high); --high) {
        if (poll.after()) return false;
      }
      if (!(low < high)) break;
      std::iter_swap(low++, high);
    }
    // All before `low` are at most the pivot, and all from it on at least.
    (nth < low ? end : begin) = low;
  }
  if (poll.after(static_cast<std::size_t>(end - begin))) return false;
  std::nth_element(begin, nth, end, is_less);
  return true;
}

}  // namespace pliant
