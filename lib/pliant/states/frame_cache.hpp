#pragma once

#include <cstddef>
#include <list>
#include <map>
#include <optional>
#include <vector>

#include "pliant/body/state.hpp"
#include "pliant/core/memory_budget.hpp"

namespace pliant {

/// Keeps the states of all bodies at some frames, within a byte budget, so that an earlier frame
/// need not be solved from the start. It never changes a result, only the time until it is
/// available.
///
/// Every `interval`-th frame is a *checkpoint* and stays. The interval is 1 while there is room for
/// all frames, then a power of two: with room for n states and F frames offered, the least one with
/// at most max(1, n/2) checkpoints, so that interval <= 2F / (n/2 + 1), n/2 rounded down. The rest
/// of the room is for the most recently used frames, for playing backwards. Without room for a
/// state, nothing is kept.
class FrameCache {
 public:
  using States = std::vector<BodyState>;

  /// Frames are counted from `first_frame`, which is never kept. Kept states also count towards
  /// `memory`, as far as some is left; null: no limit.
  FrameCache(int first_frame, std::size_t byte_budget, MemoryBudget* memory = nullptr);

  /// Whether `keep` would store this frame; `wants_checkpoint`: as a checkpoint.
  bool wants_checkpoint(int frame) const;
  bool wants(int frame) const;

  /// Keeps a frame's states, and drops others if it needs room. All states of a run have the same
  /// size.
  void keep(int frame, States states);

  /// The latest kept frame that is not after `frame`; null: none.
  std::optional<int> latest_until(int frame) const;

  /// The states at a kept frame. Requires: the frame is kept; see `latest_until`.
  const States& use(int frame);

  /// Drops all states and releases their memory; from then on uses at most half of it. False:
  /// nothing was kept.
  bool give_way();

  int interval() const { return interval_; }

 private:
  struct Entry {
    States states;
    std::optional<std::list<int>::iterator> turn;  // null for a checkpoint
  };

  bool is_checkpoint(int frame) const { return (frame - first_frame_) % interval_ == 0; }
  void limit_room(std::size_t count);
  void widen();

  int first_frame_;
  std::size_t byte_budget_;
  MemoryShare share_;
  std::optional<std::size_t> room_;  // number of states, once their size is known
  std::size_t bytes_of_one_ = 0;
  int interval_ = 1;
  int frame_count_ = 0;  // offered so far, without the first
  std::map<int, Entry> entries_;
  std::list<int> turns_;  // frames that are not checkpoints, the least recently used first
};

}  // namespace pliant
