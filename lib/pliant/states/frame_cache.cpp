#include "pliant/states/frame_cache.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "pliant/core/expects.hpp"

namespace pliant {
namespace {

std::size_t bytes_of(const FrameCache::States& states) {
  std::size_t bytes = 0;
  for (const BodyState& state : states) {
    const auto doubles = static_cast<std::size_t>(state.positions.size() + state.velocities.size() +
                                                  state.last.loads.size() + state.plastic.size());
    bytes += doubles * sizeof(double) + state.unsettled.size() + state.last.unknowns.size();
  }
  return bytes;
}

}  // namespace

FrameCache::FrameCache(int first_frame, std::size_t byte_budget, MemoryBudget* memory)
    : first_frame_(first_frame), byte_budget_(byte_budget), share_(memory) {
  if (byte_budget_ == 0) room_ = 0;
}

bool FrameCache::wants(int frame) const {
  return frame > first_frame_ && room_ != std::size_t{0} && !entries_.contains(frame);
}

bool FrameCache::wants_checkpoint(int frame) const { return wants(frame) && is_checkpoint(frame); }

void FrameCache::keep(int frame, States states) {
  if (!wants(frame)) return;
  if (!room_) {
    bytes_of_one_ = bytes_of(states);
    room_ = byte_budget_ / std::max<std::size_t>(bytes_of_one_, 1);
  }
  frame_count_ = std::max(frame_count_, frame - first_frame_);
  widen();
  while (entries_.size() >= *room_ || !share_.try_resize((entries_.size() + 1) * bytes_of_one_)) {
    // If memory is short, the room is limited to the present use.
    limit_room(entries_.size());
    if (*room_ == 0) return;
    if (turns_.empty()) return;  // only checkpoints are left, and this frame is not one
    entries_.erase(turns_.front());
    turns_.pop_front();
  }
  Entry entry{std::move(states), {}};
  if (!is_checkpoint(frame)) entry.turn = turns_.insert(turns_.end(), frame);
  entries_.emplace(frame, std::move(entry));
}

std::optional<int> FrameCache::latest_until(int frame) const {
  const auto after = entries_.upper_bound(frame);
  if (after == entries_.begin()) return {};
  return std::prev(after)->first;
}

const FrameCache::States& FrameCache::use(int frame) {
  const auto found = entries_.find(frame);
  PLIANT_EXPECTS(found != entries_.end());
  if (found->second.turn) turns_.splice(turns_.end(), turns_, *found->second.turn);
  return found->second.states;
}

bool FrameCache::give_way() {
  if (entries_.empty()) return false;
  const std::size_t count = entries_.size();
  turns_.clear();
  entries_.clear();
  [[maybe_unused]] const bool is_given_back = share_.try_resize(0);
  limit_room(count / 2);
  return true;
}

void FrameCache::limit_room(std::size_t count) {
  room_ = std::min(*room_, count);
  if (*room_ > 0) widen();
}

// Widens the interval until it fits the room. Frames that are no longer checkpoints are queued as
// the most recently used.
void FrameCache::widen() {
  const auto frames = static_cast<std::size_t>(frame_count_);
  if (frames <= *room_ || *room_ == 0) return;
  const std::size_t checkpoints = std::max<std::size_t>(1, *room_ / 2);
  const int before = interval_;
  while (frames / static_cast<std::size_t>(interval_) > checkpoints &&
         interval_ <= std::numeric_limits<int>::max() / 2) {
    interval_ *= 2;
  }
  if (interval_ == before) return;
  for (auto& [frame, entry] : entries_) {
    if (entry.turn || is_checkpoint(frame)) continue;
    entry.turn = turns_.insert(turns_.end(), frame);
  }
}

}  // namespace pliant
