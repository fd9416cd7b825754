#pragma once

#include <span>
#include <string>

#include "pliant/core/stop_request.hpp"
#include "pliant/scene/channels.hpp"

namespace pliant::cli {

/// A plot of channels over frames first to last as an SVG picture: one panel per channel, with its
/// curve, keys, handles and the ends of its axes. Colours follow the reader's light or dark scheme.
/// Not all of it if the caller wants it to stop. Requires: first < last.
std::string curve_plot(std::span<const NamedChannel> channels, double first, double last,
                       const std::string& title, const StopRequest& should_stop = {});

}  // namespace pliant::cli
