#pragma once

#include <filesystem>
#include <functional>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/files/byte_sink.hpp"
#include "pliant/files/surface_writer.hpp"

namespace pliant {

/// The name of one file of a sequence: the last run of `#` in the file's name becomes the frame
/// with at least as many digits; without one, four digits are inserted before the ending
/// (`OUT.0001.obj`).
std::filesystem::path sequence_file(const std::filesystem::path& pattern, int frame);

/// Whether the files of the plan's sequence can be written, so that an unwritable folder, or a link
/// with the name of a file, is reported before a long run. Leaves nothing behind. Errors: those of
/// `check_output_place`; Unwritable.
Result<void> check_sequence(const SurfacePlan& plan);

/// Writes a file for each frame; all are on the disk after `finish`.
///
/// A plan that resumes keeps a file that has, byte for byte, the content to be written. Any other
/// file is written: a missing one, one of another scene, or one that is truncated, longer or
/// damaged.
class SequenceWriter : public SurfaceWriter {
 public:
  Result<void> write(int frame, const SurfacePose& pose) final;
  Result<void> finish() final;
  FileCounts file_counts() const final { return counts_; }

 protected:
  explicit SequenceWriter(const SurfacePlan& plan);

  const StopRequest& should_stop() const { return should_stop_; }

 private:
  /// The content of the file of one frame.
  virtual Result<void> write_frame(const SurfacePose& pose, const ByteSink& sink) = 0;

  Result<bool> is_there(const std::filesystem::path& file, const SurfacePose& pose);

  std::filesystem::path pattern_;
  bool resumes_;
  StopRequest should_stop_;
  FileCounts counts_;
};

}  // namespace pliant
