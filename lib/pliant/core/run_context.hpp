#pragma once

#include <functional>
#include <limits>
#include <string>

#include "pliant/core/stop_request.hpp"

namespace pliant {

class MemoryBudget;
class Shelf;
class ThreadPool;
struct Profile;

/// As wide as the vectors of the machine.
inline constexpr int widest_lanes = std::numeric_limits<int>::max();

/// Called from time to time during long work: what is worked at, and how much of it is done.
using ProgressReport = std::function<void(const std::string& work, int done, int count)>;

/// What a run lets each of its parts use: a part gets it once, when it is made, and keeps a copy.
/// No bit of a result depends on it. What it points to must outlive the part.
struct RunContext {
  MemoryBudget* memory = nullptr;  ///< from which large parts reserve theirs; null: no limit
  ThreadPool* threads = nullptr;   ///< null: the calling thread only
  int most_lanes = widest_lanes;   ///< doubles per vector; the fewest there are if all have more
  Shelf* shelf = nullptr;          ///< what is shared with other runs; null: nothing is
  Profile* profile = nullptr;      ///< receives the times, from one thread; null: no profiling
  StopRequest should_stop = {};    ///< called from any thread; empty: never stops
  ProgressReport progressed = {};  ///< called from the thread that works; empty: not called

  bool is_stopped() const { return pliant::is_stopped(should_stop); }
};

}  // namespace pliant
