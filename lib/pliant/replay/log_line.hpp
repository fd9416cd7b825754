#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/replay/log.hpp"

namespace pliant::replay {

// Conversion between values and the lines of a log. Internal to replay. A line is a JSON object
// whose last member is its seal: the hash of the previous seal and of all text before the seal. So
// a line that was changed, lost, repeated or moved is detected, and its place is known.

/// The beginning of every log, for all format versions.
inline constexpr std::string_view first_member = "{\"pliant_replay\":";

std::string to_json(const ReplayHeader& header);
std::string to_json(const ReplayFrame& frame);
std::string to_json_end(long frame_count);

/// Adds the seal. `seal` is the previous line's, empty for the first line, and becomes this line's.
std::string sealed(std::string json, std::string& seal);

/// Whether a line has the seal that follows `seal`; `seal` then becomes this line's.
bool is_sound(std::string_view line, std::string& seal);

/// The format version in a line that begins with `first_member`; nullopt if it is not a number.
std::optional<int> format_of(std::string_view line);

/// The content of a sound line; nullopt if it has another form. A header has at least one frame.
std::optional<ReplayHeader> read_header(std::string_view line);
std::optional<ReplayFrame> read_frame(std::string_view line, const ReplayHeader& header);
std::optional<long> read_end(std::string_view line);

}  // namespace pliant::replay
