#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

#include "pliant/core/stoppable_sort.hpp"

namespace pliant {

/// Numbers from 0 for keys, equal exactly for equal ones, in the order of their first use. By a
/// sort: no keys of a file make it slow, as they can a hash table. Incomplete if `poll` says to
/// end. Internal to the library.
template <class Key>
std::vector<int> numbers_of_equal(const std::vector<Key>& keys, StopPoll& poll) {
  const auto key = [&](int k) -> const Key& { return keys[static_cast<std::size_t>(k)]; };
  std::vector<int> order(keys.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<int> numbers(keys.size());
  if (!sort_unless_stopped(order, poll, [&](int a, int b) { return key(a) < key(b); }) ||
      poll.after(keys.size()))
    return numbers;
  // First the first index with each key, then its number: it comes before the others.
  for (std::size_t k = 0, first = 0; k < order.size(); ++k) {
    if (key(order[first]) < key(order[k])) first = k;
    numbers[static_cast<std::size_t>(order[k])] = order[first];
  }
  int count = 0;
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    int& number = numbers[k];
    number = number == static_cast<int>(k) ? count++ : numbers[static_cast<std::size_t>(number)];
  }
  return numbers;
}

}  // namespace pliant
