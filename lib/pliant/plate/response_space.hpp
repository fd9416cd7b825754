#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "pliant/core/result.hpp"
#include "pliant/plate/plate.hpp"
#include "pliant/plate/time_steps.hpp"
#include "pliant/plate/vibration.hpp"

namespace pliant {

/// A frame of a plate at rest, or moved by the frames before.
struct LoadedFrame {
  Eigen::Matrix<double, Eigen::Dynamic, 3> load;  ///< of each pattern, along x, y, z
  Dynamics dynamics;
  TimeSteps steps;
};

/// How a plate moves, from rest, under loads that are sums of a few patterns, in the space of its
/// slow vibrations that they excite: many steps of it cost less than one of the plate. Shapes are
/// found by Lanczos' method on the inverse of K, with a block that starts with the patterns'
/// displacements at rest, so that these are exact; docs/model.md, eq. (42f). Source: Nour-Omid,
/// Clough, Dynamic analysis of structures using Lanczos co-ordinates (1984).
class ResponseSpace {
 public:
  /// A displacement, as parts of the shapes.
  using Parts = Eigen::Matrix<double, Eigen::Dynamic, 3>;

  /// Requires: what holds the plate, whose shift is 0, and what `plate` refers to outlives it; up
  /// to three patterns (#unknowns x #patterns), of which none is 0.
  ResponseSpace(VibratingPlate plate, const Eigen::MatrixXd& patterns);

  /// The displacements after frames. So many shapes are found, at most `most_shapes`, that the last
  /// ones change no displacement by more than 1e-4 of the largest, as root mean square; null: they
  /// do. Requires: no exact steps. Errors: those of the plate's solve; Interrupted.
  Result<std::optional<std::vector<Parts>>> play(std::span<const LoadedFrame> frames,
                                                 Eigen::Index most_shapes);

  /// Those of the unknowns. Many at once take less time than one after another. Requires: all have
  /// as many parts.
  std::vector<Field> displacements(std::span<const Parts> parts) const;

  /// `excited_modes` of the displacement at rest under a pattern, the only one. Errors: as for
  /// `play`.
  Result<std::vector<ExcitedMode>> excited_modes(Eigen::Index node);

  Eigen::Index shape_count() const { return shapes_.cols(); }

 private:
  Result<void> start();
  Result<void> extend();
  Eigen::MatrixXd orthonormal(const Eigen::MatrixXd& block, double whole,
                              Eigen::MatrixXd& parts) const;
  Result<Eigen::MatrixXd> solved(const Eigen::MatrixXd& forces) const;
  Result<std::vector<Parts>> parts_after(std::span<const LoadedFrame> frames,
                                         Eigen::Index count) const;
  static bool agree(std::span<const Parts> fewer, std::span<const Parts> all);

  VibratingPlate plate_;
  Eigen::MatrixXd patterns_;
  Eigen::VectorXd roots_;      // of the masses: shapes times them are orthonormal
  Eigen::MatrixXd shapes_;     // times `roots_`
  Eigen::MatrixXd next_;       // those that come next; none: the shapes are all that is excited
  Eigen::MatrixXd at_rest_;    // parts that the patterns' displacements at rest have of shapes
  Eigen::MatrixXd projected_;  // the inverse of K, by mass
};

}  // namespace pliant
