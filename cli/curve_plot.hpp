#pragma once

#include <span>
#include <string>

#include "pliant/scene/channels.hpp"

namespace pliant::cli {

/// A plot of channels over frames first to last as an SVG picture: one panel per channel, with its
/// curve, keys, handles and a grid of frames. Colours follow the reader's light or dark scheme.
/// Requires: first < last.
std::string curve_plot(std::span<const NamedChannel> channels, double first, double last,
                       const std::string& title);

}  // namespace pliant::cli
