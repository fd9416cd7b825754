#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/io/obj_text.hpp"
#include "pliant/io/surface_writer.hpp"

namespace pliant {

/// The name of one file of a sequence: the last run of `#` in the file's name becomes the frame
/// with at least as many digits; without one, four digits go ahead of the ending (`OUT.0001.obj`).
std::filesystem::path sequence_file(const std::filesystem::path& pattern, int frame);

/// Whether the first file of the plan's sequence can be created: a folder that cannot be written to
/// should not show only after a long run. Leaves nothing behind. Errors: Unwritable.
Result<void> check_sequence(const SurfacePlan& plan);

/// Writes a file for each frame.
///
/// A plan that resumes goes on after the files that are there from the first frame on without a
/// gap: a file is whole where it is there at all. The first and the last of them must hold just
/// what would be written, so that what is resumed is the same scene, or one that differs only
/// where both agree. Errors then: Unwritable, naming the file that holds something else.
class SequenceWriter : public SurfaceWriter {
 public:
  Result<void> write(int frame, const Field& positions) final;
  Result<void> finish() final { return {}; }

 protected:
  explicit SequenceWriter(const SurfacePlan& plan);

 private:
  /// What the file of one frame holds.
  virtual Result<void> write_frame(const Field& positions, const ByteSink& sink) = 0;

  Result<void> compare(int frame, const Field& positions);

  std::filesystem::path pattern_;
  int first_frame_;
  int frames_there_ = 0;  // whole files from the first frame on
};

}  // namespace pliant
