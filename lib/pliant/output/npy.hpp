#pragma once

#include <memory>

#include "pliant/output/surface_writer.hpp"

namespace pliant {

/// A NumPy array of float64, C order, shape (frames, vertices, 3): format version 1.0 of
/// numpy.lib.format. Streams: only one frame is in memory at a time.
Result<std::unique_ptr<SurfaceWriter>> make_npy_writer(const SurfacePlan& plan);

}  // namespace pliant
