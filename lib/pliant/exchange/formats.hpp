#pragma once

#include "pliant/exchange/curve_file.hpp"

namespace pliant::exchange {

// The readers and writers of `parse_curves` and `write_curves`.

// F-curves of Blender as JSON (docs/interchange.md, "Keys"), as script/blender_curves.py writes and
// reads them. What Blender shows between and beside keys: evaluate_fcurve in
// blenkernel/intern/fcurve.c, fcm_cycles_time in fmodifier.c, and blenlib/intern/easing.c.

/// See `parse_curves`.
Result<CurveFile> parse_blender(std::string_view text, const CurveReading& reading);

/// See `write_curves`.
Result<CurveText> write_blender(const std::vector<ChannelCurve>& curves,
                                const CurveWriting& writing);

/// Whether Blender's easing has the shape of pliant's. It turns the phase of an elastic round that
/// falls by less than its amplitude, and one between equal values swings there alone.
bool has_blender_easing(const Interpolation& easing, double change);

// Maya's .anim, the text of its plug-in animImportExport, version 1.1. Its layout and the meaning
// of angles and weights: devkit/plug-ins/animImportExport of Maya's development kit. An angle is
// that of the tangent in the units of the file, per frame: its tangent is the slope. A weight is
// the length of the handle, frames and value taken as one plane.

/// See `parse_curves`.
Result<CurveFile> parse_maya(std::string_view text, const CurveReading& reading);

/// See `write_curves`.
Result<CurveText> write_maya(const std::vector<ChannelCurve>& curves, const CurveWriting& writing);

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
