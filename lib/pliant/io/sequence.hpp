#pragma once

#include <filesystem>

#include "pliant/core/result.hpp"
#include "pliant/io/writer.hpp"

namespace pliant {

/// The name of one file of a sequence: the last run of `#` in the file's name becomes the frame
/// with at least as many digits; without one, four digits go ahead of the ending (`OUT.0001.obj`).
std::filesystem::path sequence_file(const std::filesystem::path& pattern, int frame);

/// Whether the first file of the plan's sequence can be created: a folder that cannot be written to
/// should not show only after a long run. Leaves nothing behind. Errors: Unwritable.
Result<void> check_sequence(const AnimationPlan& plan);

}  // namespace pliant
