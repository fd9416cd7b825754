#pragma once

#include <filesystem>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

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
};

/// What such a writer needs to know ahead.
struct SurfacePlan {
  std::filesystem::path file;
  const Mesh* mesh = nullptr;  ///< outlives the writer
  int first_frame = 0;
  int last_frame = 0;
  double fps = 24;              ///< [1/s]
  const Field* rest = nullptr;  ///< positions at rest in the frames' space; none: those of the mesh
  bool resume = false;          ///< a sequence goes on after the last whole frame that is there

  int frame_count() const { return last_frame - first_frame + 1; }
};

}  // namespace pliant
