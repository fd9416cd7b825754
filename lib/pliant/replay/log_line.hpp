#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/replay/log.hpp"

namespace pliant::replay {

// Between values and the lines of a log; not for other rooms. A line is a JSON object whose last
// member is its seal: the hash of the seal before it and of all that stands ahead of it. So a line
// that was changed, lost, repeated or moved shows at once, and where.

/// How every log begins, of whatever format.
inline constexpr std::string_view first_member = "{\"pliant_replay\":";

std::string to_json(const ReplayHeader& header);
std::string to_json(const ReplayFrame& frame);
std::string to_json_end(long frame_count);

/// Adds the seal. `seal` is the last line's, empty ahead of the first, and becomes this line's.
std::string sealed(std::string json, std::string& seal);

/// Whether a line bears the seal that follows `seal`, which becomes this line's.
bool is_sound(std::string_view line, std::string& seal);

/// The format's version in a line that begins with `first_member`; none where it is no number.
std::optional<int> format_of(std::string_view line);

/// What a sound line says; none when it says something else. A header has at least one frame.
std::optional<ReplayHeader> read_header(std::string_view line);
std::optional<ReplayFrame> read_frame(std::string_view line, const ReplayHeader& header);
std::optional<long> read_end(std::string_view line);

}  // namespace pliant::replay
