#pragma once

#include <string>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// How many files of a sequence were there as they had to be, and how many were written.
struct FileCounts {
  long kept = 0;
  long written = 0;
};

/// Writes the frames of one surface, first to last, in a format that holds one. What was written is
/// whole or not there: without `finish` a format of one file leaves nothing behind.
class SurfaceWriter {
 public:
  SurfaceWriter() = default;
  SurfaceWriter(const SurfaceWriter&) = delete;
  SurfaceWriter& operator=(const SurfaceWriter&) = delete;
  virtual ~SurfaceWriter() = default;

  /// Positions (#vertices x 3, in the order of the mesh) of the next frame. Errors: Unwritable;
  /// NotFinite where the format has single precision only and a coordinate is beyond it.
  virtual Result<void> write(int frame, const Field& positions) = 0;

  /// Gives the result its name. Errors: Unwritable. Requires: every frame has been written.
  virtual Result<void> finish() = 0;

  /// Of a sequence, so far.
  virtual FileCounts file_counts() const { return {}; }
};

/// What such a writer needs to know ahead.
struct SurfacePlan {
  std::string file;
  const Mesh* mesh = nullptr;  ///< outlives the writer
  int first_frame = 0;
  int last_frame = 0;
  double fps = 24;              ///< [1/s]
  const Field* rest = nullptr;  ///< positions at rest in the frames' space; none: those of the mesh
  bool resume = false;          ///< files of a sequence that are what would be written are kept

  int frame_count() const { return last_frame - first_frame + 1; }
};

}  // namespace pliant
