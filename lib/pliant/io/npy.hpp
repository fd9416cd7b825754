#pragma once

#include "pliant/io/writer.hpp"

namespace pliant {

/// A NumPy array of float64, C order, shape (frames, vertices, 3): format version 1.0 of
/// numpy.lib.format. Streams: one frame is held at a time.
Result<std::unique_ptr<AnimationWriter>> make_npy_writer(const AnimationPlan& plan);

}  // namespace pliant
