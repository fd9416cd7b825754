#pragma once

#include "pliant/io/writer.hpp"

namespace pliant {

/// One Wavefront OBJ file a frame: positions (shortest text that reads back the same double),
/// texture coordinates and faces as in the source mesh.
Result<std::unique_ptr<AnimationWriter>> make_obj_writer(const AnimationPlan& plan);

/// The name of one file of a sequence: the last run of `#` in the file's name becomes the frame
/// with at least as many digits; without one, four digits go ahead of the ending (`OUT.0001.obj`).
std::filesystem::path sequence_file(const std::filesystem::path& pattern, int frame);

}  // namespace pliant
