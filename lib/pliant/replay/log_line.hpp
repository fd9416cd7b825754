#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
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

/// The most bytes and values of a line that is read; the writer keeps to them. A scene of the most
/// bytes fits, and so do the states of ten million nodes.
inline constexpr std::size_t longest_line = std::size_t{1} << 29U;
inline constexpr std::size_t most_values = 64'000'000;

/// Adds the seal. `seal` is the previous line's, empty for the first line, and becomes this line's.
std::string sealed(std::string json, std::string& seal);

/// Whether a line has the seal that follows `seal`; `seal` then becomes this line's. Errors:
/// Interrupted.
Result<bool> is_sound(std::string_view line, std::string& seal,
                      const StopRequest& should_stop = {});

/// The format version in a line that begins with `first_member`; nullopt if it is not a number.
std::optional<int> format_of(std::string_view line);

/// Whether a line is the last one.
bool is_end(std::string_view line);

/// The content of a sound line. A header has at least one frame. Errors: InvalidInput: it has
/// another form; Interrupted.
Result<ReplayHeader> read_header(std::string_view line, const StopRequest& should_stop = {});
Result<ReplayFrame> read_frame(std::string_view line, const ReplayHeader& header,
                               const StopRequest& should_stop = {});
Result<long> read_end(std::string_view line);

}  // namespace pliant::replay
