#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "pliant/feedback/frame_ranges.hpp"
#include "pliant/scene/channels.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

// What warnings ask of a scene.

/// What of a curve's keys counts for them.
struct KeySpan {
  double first = 0, last = 0;
  std::size_t count = 0;
  bool holds_before = false, holds_after = false;  ///< the end values beyond the keys

  /// Whether all are before or after the frames, and held there.
  bool is_outside(const FrameSpan& played) const;

  /// "at frames 3 to 7"
  std::string text() const;
};

/// None: it has no keys.
std::optional<KeySpan> keys_of(const Channel<1>& channel);
std::optional<KeySpan> keys_of(const Switch& channel);
std::optional<KeySpan> keys_of(const NamedChannel& channel);

/// The frames whose solves show something: each leads to the next one.
FrameSpan solved_frames(const FrameSpan& played);

FrameRanges ranges_of(const FrameSpan& frames);

/// Whether it is on at some frame, as far as one value tells.
bool is_on(const Switch& enabled);

bool is_solved(const Surface& surface);

bool is_inertia(const Force& force);

/// Whether a surface stands still over the frames, so that it has no inertia.
bool stands_still(const Surface& surface, const FrameSpan& frames);

/// `"a"`, `"a" and "b"`
std::string names_text(const std::vector<const Surface*>& surfaces);

}  // namespace pliant
