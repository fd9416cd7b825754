#pragma once

#include "pliant/exchange/curve_file.hpp"

namespace pliant::exchange {

/// See `parse_curves`.
Result<CurveFile> parse_gltf_curves(std::string_view bytes, const CurveReading& reading,
                                    const ReadCurveReference& read_reference);

/// See `write_curves`. A channel that is a position, a rotation or a scale animates the node of its
/// thing; any other one the translation of a node of its own, a number along x.
Result<CurveText> write_gltf_curves(const std::vector<ChannelCurve>& curves,
                                    const CurveWriting& writing);

/// What of its thing's node a channel animates; empty: a node of its own.
std::string_view path_of_attribute(std::string_view attribute);

}  // namespace pliant::exchange
