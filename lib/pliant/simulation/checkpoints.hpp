#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "pliant/body/body.hpp"

namespace pliant {

/// The states of all bodies at some frames, within a byte budget, so that going back does not mean
/// going back to the start. Frames are kept every `spacing`; when the budget is reached the spacing
/// doubles and every other one goes. What is kept never changes a result, only how soon it is
/// there.
class Checkpoints {
 public:
  /// Frames are counted from `first_frame`. A budget of 0 keeps nothing.
  Checkpoints(int first_frame, std::size_t byte_budget);

  /// Keeps a frame's states if the frame is due.
  void offer(int frame, const std::vector<BodyState>& states);

  /// Whether `offer` would keep the frame.
  bool is_due(int frame) const;

  /// The states at the latest kept frame that is not after `frame`; nullptr when there are none.
  const std::pair<const int, std::vector<BodyState>>* latest_until(int frame) const;

 private:
  int first_frame_;
  std::size_t byte_budget_;
  std::size_t bytes_ = 0;
  int spacing_ = 1;
  std::map<int, std::vector<BodyState>> states_;
};

}  // namespace pliant
