#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/plate/contact/inverse_columns.hpp"
#include "pliant/plate/kernels/kernels.hpp"

namespace pliant {

/// A force of contact on an unknown along a direction of the world, whose size is not known.
struct ContactForce {
  int unknown = 0;
  Vector3d direction = {0, 1, 0};  ///< of length 1
  double give = 0;                 ///< by which it lets the unknown move for a size of 1, >= 0
  bool is_soft = false;  ///< it gives by a 1e-10 of what it moves: others may hold as well

  friend bool operator==(const ContactForce&, const ContactForce&) = default;
};

/// S + diag(give) with S_ij = direction_i . direction_j times the entry of the inverse at their
/// unknowns: positive definite. Its factor is a function of the matrix and the forces in their
/// order. Internal to plate.
class ContactMatrix {
 public:
  ContactMatrix(InverseColumns& columns, const RunContext& context)
      : columns_(columns), context_(context), kernels_(kernels_of_width(context.most_lanes)) {}

  /// The plate's matrix is another one.
  void forget() { factored_.clear(); }

  /// Factors that of some forces, unknowns ascending. `size`: #unknowns. Errors: those of the
  /// columns; SolverFailed; Interrupted.
  Result<void> factor(std::span<const ContactForce> forces, Eigen::Index size,
                      const InverseColumns::Solve& solve_plate);

  /// Requires: `factor` succeeded last.
  std::vector<double> solved(std::vector<double> right) const;

  /// What a force of size 1 moves an unknown. Requires: it was among those factored last, or taken.
  double entry(int of, int at) const { return columns_.of(of)[at]; }

 private:
  std::size_t count_kept(std::span<const ContactForce> forces) const;
  void make_room(std::size_t count, std::size_t kept);

  InverseColumns& columns_;
  RunContext context_;
  const PlateKernels& kernels_;
  std::vector<ContactForce> factored_;  // as far as the factor is right
  std::vector<double> factor_;          // L of L L^T, a padded row after the other
  std::size_t pitch_ = 0;
};

}  // namespace pliant
