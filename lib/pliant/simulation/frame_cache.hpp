#pragma once

#include <cstddef>
#include <list>
#include <map>
#include <optional>
#include <vector>

#include "pliant/body/state.hpp"
#include "pliant/core/memory_budget.hpp"

namespace pliant {

/// The states of all bodies at some frames, within a byte budget, so that going back does not mean
/// going back to the start. What is kept never changes a result, only how soon it is there.
///
/// Every `interval`-th frame is a *checkpoint* and stays. The interval is 1 while there is room for
/// all frames, and a power of two from then on: with room for n states and F frames offered, the
/// least one that gives at most max(1, n/2) checkpoints, so that interval <= 2F / (n/2 + 1), n/2
/// rounded down. The rest of the room goes to the frames used last, for playing backwards. With
/// room for no state nothing is kept.
class FrameCache {
 public:
  using States = std::vector<BodyState>;

  /// Frames are counted from `first_frame`, which needs no keeping. What is kept takes its share of
  /// `memory` too, as far as there is some left; none means no limit.
  FrameCache(int first_frame, std::size_t byte_budget, MemoryBudget* memory = nullptr);

  /// Whether `keep` would take a checkpoint at this frame, or any frame.
  bool wants_checkpoint(int frame) const;
  bool wants(int frame) const;

  /// Keeps a frame's states, and lets others go where that needs room. All states of a run are of
  /// one size.
  void keep(int frame, States states);

  /// The frame kept last that is not after `frame`.
  std::optional<int> latest_until(int frame) const;

  /// The states at a kept frame. Requires: `latest_until` told of it.
  const States& use(int frame);

  /// Gives all memory back, and takes at most half of it again. False: there was none.
  bool give_way();

  int interval() const { return interval_; }

 private:
  struct Kept {
    States states;
    std::optional<std::list<int>::iterator> turn;  // none for a checkpoint
  };

  bool is_checkpoint(int frame) const { return (frame - first_frame_) % interval_ == 0; }
  bool make_room(std::size_t bytes);
  void limit_room(std::size_t count);
  void widen();

  int first_frame_;
  std::size_t byte_budget_;
  MemoryShare share_;
  std::optional<std::size_t> room_;  // number of states, once their size is known
  std::size_t bytes_of_one_ = 0;
  int interval_ = 1;
  int frame_count_ = 0;  // offered, the first not counted
  std::map<int, Kept> kept_;
  std::list<int> turns_;  // frames that are no checkpoints, the one used longest ago first
};

}  // namespace pliant
