#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// Writes the frames of one surface, first to last. What was written is whole or not there: without
/// `finish` a format of one file leaves nothing behind.
class AnimationWriter {
 public:
  AnimationWriter() = default;
  AnimationWriter(const AnimationWriter&) = delete;
  AnimationWriter& operator=(const AnimationWriter&) = delete;
  virtual ~AnimationWriter() = default;

  /// Positions (#vertices x 3, in the order of the mesh) of the next frame. Errors: Unwritable.
  virtual Result<void> write(int frame, const Field& positions) = 0;

  /// Gives the result its name. Errors: Unwritable.
  virtual Result<void> finish() = 0;
};

/// What a writer needs to know ahead.
struct AnimationPlan {
  std::filesystem::path file;  ///< its ending picks the format
  const Mesh* mesh = nullptr;  ///< outlives the writer
  int first_frame = 0;
  int last_frame = 0;
};

/// The endings that `make_writer` knows, with their dots.
std::vector<std::string> known_endings();

/// Whether the file's ending names a format. Errors: InvalidInput, listing the endings.
Result<void> check_ending(const std::filesystem::path& file);

/// A writer for the format that the file's ending names: `.npy`, or an `.obj` or
/// `.ply` sequence.
/// Errors: InvalidInput for an unknown ending; Unwritable.
Result<std::unique_ptr<AnimationWriter>> make_writer(const AnimationPlan& plan);

}  // namespace pliant
