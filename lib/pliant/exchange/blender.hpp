#pragma once

#include "pliant/exchange/curve_file.hpp"

namespace pliant::exchange {

// F-curves of Blender as JSON (docs/interchange.md, "Keys"), as script/blender_curves.py writes and
// reads them. What Blender shows between and beside keys: evaluate_fcurve in
// blenkernel/intern/fcurve.c, fcm_cycles_time in fmodifier.c, and blenlib/intern/easing.c.

/// See `parse_curves`.
Result<CurveFile> parse_blender(std::string_view text, const CurveReading& reading);

/// See `write_curves`.
Result<CurveText> write_blender(const std::vector<ChannelCurve>& curves,
                                const CurveWriting& writing);

/// Whether Blender's easing has the shape of pliant's. It turns the phase of an elastic round that
/// falls by less than its amplitude.
bool has_blender_easing(const Interpolation& easing, double change);

}  // namespace pliant::exchange
