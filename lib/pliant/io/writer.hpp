#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/transform.hpp"
#include "pliant/io/surface_writer.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// One surface at one frame.
struct SurfacePose {
  Field positions;  ///< #vertices x 3, in the order of the mesh; object space if it is placed
  Placement placement = {};  ///< of a placed surface: object to world
};

/// Writes the frames of a scene, first to last. What was written is whole or not there: without
/// `finish` a format of one file leaves nothing behind. What `finish` has done is on the disk.
class AnimationWriter {
 public:
  AnimationWriter() = default;
  AnimationWriter(const AnimationWriter&) = delete;
  AnimationWriter& operator=(const AnimationWriter&) = delete;
  virtual ~AnimationWriter() = default;

  /// The surfaces at the next frame, in the order of the plan. Errors: Unwritable; NotFinite where
  /// the format has single precision only and a coordinate is beyond it.
  virtual Result<void> write(int frame, std::span<const SurfacePose> surfaces) = 0;

  /// Gives the result its name. Errors: Unwritable. Requires: every frame has been written.
  virtual Result<void> finish() = 0;

  /// Of a sequence, so far.
  virtual FileCounts file_counts() const { return {}; }
};

/// One surface as a writer is told of it ahead.
struct AnimatedSurface {
  std::string name;            ///< [A-Za-z_][A-Za-z0-9_-]*, unique
  const Mesh* mesh = nullptr;  ///< outlives the writer
  Field rest;                  ///< #vertices x 3: at rest, in the space of the poses
};

/// What a writer needs to know ahead.
struct AnimationPlan {
  std::string file;  ///< its ending picks the format
  std::vector<AnimatedSurface> surfaces = {};
  int first_frame = 0;
  int last_frame = 0;
  double fps = 24;         ///< [1/s]
  bool is_placed = false;  ///< poses are in object space, with placements
  bool resume = false;     ///< files of a sequence that are what would be written are kept

  int frame_count() const { return last_frame - first_frame + 1; }
};

/// The endings that `make_writer` knows, with their dots.
std::vector<std::string> known_endings();

/// Whether the file's ending names a format. Errors: InvalidInput, listing the endings.
Result<void> check_ending(const std::string& file);

/// Every file that the plan's writer will write whose name is known ahead, those of a sequence
/// among them. Requires: check_ending(plan.file).
std::vector<std::string> files_of(const AnimationPlan& plan);

/// Whether the writer may also write, replace or remove a file of that name beside `plan.file`: the
/// numbers of a .gltf, whose name shows only at the end (`gltf_numbers.hpp`).
bool is_named_at_the_end(const AnimationPlan& plan, std::string_view name);

/// A writer for the format that the file's ending names. `.glb`, `.gltf` and `.usda` hold all
/// surfaces; of the others each surface has its own, OUT-NAME.ext where there are several.
/// Errors: InvalidInput for an unknown ending, for more frames than a format can hold, for resuming
/// a format of one file, and as `check_output_place` for each of its files; Unwritable.
/// Requires: a surface at least; poses in object space go to any format, placements to `.glb`,
/// `.gltf` and `.usda` only.
Result<std::unique_ptr<AnimationWriter>> make_writer(const AnimationPlan& plan);

}  // namespace pliant
