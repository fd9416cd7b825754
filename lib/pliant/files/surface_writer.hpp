#pragma once

#include <string>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/core/transform.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// One surface at one frame.
struct SurfacePose {
  Field positions;  ///< #vertices x 3, in the order of the mesh; in object space if it is placed
  Placement placement = {};  ///< of a placed surface: object to world

  /// Whether the transform that gave the positions reflects (`Transform::is_mirrored`): then the
  /// faces are written turned round, so that they keep their outer sides.
  bool is_mirrored = false;

  bool is_shown = true;  ///< surfaces always are, colliders while they are enabled
};

/// Number of files of a sequence that were already correct, and of those written.
struct FileCounts {
  long kept = 0;
  long written = 0;
};

/// Writes the frames of one surface, first to last, in a format for one surface. Files appear whole
/// or not at all: without `finish` a format of one file leaves nothing behind.
class SurfaceWriter {
 public:
  SurfaceWriter() = default;
  SurfaceWriter(const SurfaceWriter&) = delete;
  SurfaceWriter& operator=(const SurfaceWriter&) = delete;
  virtual ~SurfaceWriter() = default;

  /// The surface at the next frame; not its placement. Errors: Unwritable; NotFinite if the format
  /// has only single precision and a coordinate is out of range; Interrupted.
  virtual Result<void> write(int frame, const SurfacePose& pose) = 0;

  /// Gives the result its name. Errors: Unwritable. Requires: every frame has been written.
  virtual Result<void> finish() = 0;

  /// Of a sequence, until now.
  virtual FileCounts file_counts() const { return {}; }
};

/// The parameters of such a writer.
struct SurfacePlan {
  std::string file;
  const Mesh* mesh = nullptr;  ///< must outlive the writer
  int first_frame = 0;
  int last_frame = 0;
  double fps = 24;              ///< [1/s]
  const Field* rest = nullptr;  ///< positions at rest in the frames' space; null: those of the mesh
  bool is_mirrored = false;     ///< as of a pose, of the rest positions
  bool resume = false;          ///< keeps files of a sequence that already have the right content
  StopRequest should_stop = {};

  int frame_count() const { return last_frame - first_frame + 1; }
};

}  // namespace pliant
