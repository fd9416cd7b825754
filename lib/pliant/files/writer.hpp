#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/files/surface_writer.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// Writes the frames of a scene, first to last. Files appear whole or not at all: without `finish`
/// a format of one file leaves nothing behind. After `finish` all is on the disk.
class AnimationWriter {
 public:
  AnimationWriter() = default;
  AnimationWriter(const AnimationWriter&) = delete;
  AnimationWriter& operator=(const AnimationWriter&) = delete;
  virtual ~AnimationWriter() = default;

  /// The surfaces and colliders at the next frame, in the order of the plan. Errors: Unwritable;
  /// NotFinite if the format has only single precision and a coordinate is out of range;
  /// Interrupted.
  virtual Result<void> write(int frame, std::span<const SurfacePose> surfaces,
                             std::span<const SurfacePose> colliders) = 0;
  Result<void> write(int frame, std::span<const SurfacePose> surfaces) {
    return write(frame, surfaces, {});
  }

  /// Gives the result its name. Errors: Unwritable; Interrupted. Requires: every frame has been
  /// written.
  virtual Result<void> finish() = 0;

  /// Of a sequence, until now.
  virtual FileCounts file_counts() const { return {}; }
};

/// The parameters of one surface for a writer.
struct AnimatedSurface {
  std::string name;            ///< [A-Za-z_][A-Za-z0-9_-]*, unique
  const Mesh* mesh = nullptr;  ///< must outlive the writer
  Field rest;                  ///< #vertices x 3: at rest, in the space of the poses

  /// As of a pose, of `rest`. Formats whose faces are the same at all frames turn them by this one,
  /// so it should be that of the first frame; a sequence turns them by that of each frame.
  bool is_mirrored = false;
};

/// The parameters of a writer.
struct AnimationPlan {
  std::string file;  ///< its ending determines the format
  std::vector<AnimatedSurface> surfaces = {};
  /// Solids beside them, always placed; only `.glb`, `.gltf` and `.usda` contain them.
  std::vector<AnimatedSurface> colliders = {};
  int first_frame = 0;
  int last_frame = 0;
  double fps = 24;               ///< [1/s]
  bool is_placed = false;        ///< poses are in object space, with placements
  bool resume = false;           ///< keeps files of a sequence that already have the right content
  StopRequest should_stop = {};  ///< called while files are made

  int frame_count() const { return last_frame - first_frame + 1; }
};

/// The endings that `make_writer` supports, with their dots.
std::vector<std::string> known_endings();

/// Whether the file's ending is that of a format. Errors: InvalidInput, listing the endings.
Result<void> check_ending(const std::string& file);

/// Whether its format contains colliders. Requires: check_ending(file).
bool contains_colliders(const std::string& file);

/// What single precision does to vertices in a box that is far from the origin.
struct PrecisionLoss {
  std::size_t surface = 0;  ///< of a plan
  double error = 0;         ///< the farthest that a vertex may be moved [length]
  double size = 0;          ///< the diagonal of the box [length]
  Vector3d centre;          ///< of the box [length]
};

/// None: no vertex in the box is moved by more than 1e-4 of its size.
std::optional<PrecisionLoss> precision_loss_in(const Vector3d& low, const Vector3d& high);

/// The surfaces at rest to which the format of a plan does so, in the space of the poses. Requires:
/// check_ending(plan.file).
std::vector<PrecisionLoss> precision_losses(const AnimationPlan& plan);

/// All files of the plan's writer whose names are known in advance, including those of a sequence.
/// Requires: check_ending(plan.file).
std::vector<std::string> files_of(const AnimationPlan& plan);

/// Whether the writer may also write, replace or remove a file of that name beside `plan.file`: the
/// numbers of a .gltf, whose name is known only at the end (`gltf_numbers.hpp`).
bool is_named_at_the_end(const AnimationPlan& plan, std::string_view name);

/// A writer for the format of the file's ending. `.glb`, `.gltf` and `.usda` contain all surfaces;
/// in other formats each surface has its own file, OUT-NAME.ext if there are several. Errors:
/// InvalidInput for an unknown ending, for more frames than a format can store, for resuming a
/// format of one file, and as `check_output_place` for each of its files; Unwritable; Interrupted.
/// Requires: at
/// least one surface; any format accepts poses in object space, but only `.glb`, `.gltf` and
/// `.usda` accept placements of surfaces.
Result<std::unique_ptr<AnimationWriter>> make_writer(const AnimationPlan& plan);

}  // namespace pliant
