#include "pliant/simulation/checkpoints.hpp"

#include <limits>

namespace pliant {
namespace {

std::size_t bytes_of(const std::vector<BodyState>& states) {
  std::size_t bytes = 0;
  for (const BodyState& state : states) {
    const auto doubles = static_cast<std::size_t>(state.positions.size() + state.velocities.size());
    bytes += doubles * sizeof(double) + state.unsettled.size();
  }
  return bytes;
}

}  // namespace

Checkpoints::Checkpoints(int first_frame, std::size_t byte_budget)
    : first_frame_(first_frame), byte_budget_(byte_budget) {}

bool Checkpoints::is_due(int frame) const {
  return byte_budget_ > 0 && (frame - first_frame_) % spacing_ == 0 && !states_.contains(frame);
}

void Checkpoints::offer(int frame, const std::vector<BodyState>& states) {
  const std::size_t bytes = bytes_of(states);
  if (bytes > byte_budget_) return;
  while (is_due(frame)) {
    if (bytes_ + bytes <= byte_budget_) {
      states_.emplace(frame, states);
      bytes_ += bytes;
      return;
    }
    if (spacing_ > std::numeric_limits<int>::max() / 2) return;
    spacing_ *= 2;
    std::erase_if(states_, [&](const auto& kept) {
      const bool goes = (kept.first - first_frame_) % spacing_ != 0;
      if (goes) bytes_ -= bytes_of(kept.second);
      return goes;
    });
  }
}

const std::pair<const int, std::vector<BodyState>>* Checkpoints::latest_until(int frame) const {
  auto after = states_.upper_bound(frame);
  return after == states_.begin() ? nullptr : &*std::prev(after);
}

}  // namespace pliant
