#pragma once

#include "pliant/exchange/curve_file.hpp"

namespace pliant::exchange {

// Maya's .anim, the text of its plug-in animImportExport, version 1.1. Its layout and the meaning
// of angles and weights: devkit/plug-ins/animImportExport of Maya's development kit. An angle is
// that of the tangent in the units of the file, per frame: its tangent is the slope. A weight is
// the length of the handle, frames and value taken as one plane.

/// See `parse_curves`.
Result<CurveFile> parse_maya(std::string_view text, const CurveReading& reading);

/// See `write_curves`.
Result<CurveText> write_maya(const std::vector<ChannelCurve>& curves, const CurveWriting& writing);

}  // namespace pliant::exchange
