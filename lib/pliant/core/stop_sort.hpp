#pragma once

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "pliant/core/stop_request.hpp"

namespace pliant {

/// Sorts as std::stable_sort does, but ends early, with the items in any order, if `poll` says so.
template <class Item, class Less>
void sort_until_stopped(std::vector<Item>& items, const Less& less, StopPoll& poll) {
  constexpr std::size_t block = 4096, parts_of_item = 16;
  const std::size_t count = items.size();
  const auto place = [&](std::size_t k) {
    return items.begin() + static_cast<std::ptrdiff_t>(std::min(k, count));
  };
  for (std::size_t first = 0; first < count; first += block) {
    std::stable_sort(place(first), place(first + block), less);
    if (poll.after(parts_of_item * block)) return;
  }
  std::vector<Item> merged(count > block ? count : 0);
  for (std::size_t width = block; width < count; width *= 2) {
    for (std::size_t first = 0; first < count; first += 2 * width) {
      const std::size_t half = std::min(first + width, count);
      const std::size_t end = std::min(half + width, count);
      std::size_t a = first, b = half;
      for (std::size_t to = first; to < end; ++to) {
        const bool is_a = b == end || (a < half && !less(items[b], items[a]));
        merged[to] = std::move(items[is_a ? a++ : b++]);
        if (poll.after(parts_of_item)) return;
      }
    }
    std::swap(items, merged);
  }
}

}  // namespace pliant
