#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "pliant/states/state_store.hpp"

namespace pliant::testing {

inline constexpr int shared_states = 60;

/// Writes, reads and discards `shared_states` states of some 10 kB in each of four threads. Every
/// thread that discards a state writes it again. Returns how many the store has at the end; -1 if
/// any that was read was not as written.
inline int share(StateStore& store) {
  const auto key = [](int number) { return hash_of(std::to_string(number)); };
  const auto state = [](int number) {
    return std::string(10'000 + static_cast<std::size_t>(number), static_cast<char>(number));
  };
  std::atomic<bool> is_wrong = false;
  const auto is_there = [&](int number) {
    const auto bytes = store.read(key(number), 1'000'000);
    if (bytes && *bytes != state(number)) is_wrong = true;
    return bytes.has_value();
  };
  std::vector<std::jthread> threads;
  for (int thread = 0; thread < 4; ++thread) {
    threads.emplace_back([&, thread] {
      for (int k = 0; k < shared_states; ++k) {
        const int number = k * (2 * thread + 7) % shared_states;  // in an order of its own
        if (k % 7 == 6) store.discard(key(number));
        is_there(number);
        store.write(key(number), state(number));
        store.holds(key(number));
      }
    });
  }
  threads.clear();
  int there = 0;
  for (int number = 0; number < shared_states; ++number) there += is_there(number) ? 1 : 0;
  return is_wrong ? -1 : there;
}

}  // namespace pliant::testing
