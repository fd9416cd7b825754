#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/plate/contact/inverse_columns.hpp"
#include "pliant/plate/contact/nearby_schur.hpp"
#include "pliant/plate/kernels/kernels.hpp"

namespace pliant {

/// A plate's matrix, as contact uses it.
struct SolvedMatrix {
  Eigen::Index size = 0;        ///< #unknowns
  InverseColumns::Solve solve;  ///< its inverse times forces (#unknowns x 3), perhaps roughly
  std::function<Result<SparseMatrix>()> upper;  ///< makes its upper triangle
};

/// A force of contact on an unknown along a direction of the world, whose size is not known.
struct ContactForce {
  int unknown = 0;
  Vector3d direction = {0, 1, 0};  ///< of length 1
  double give = 0;                 ///< by which it lets the unknown move for a size of 1, >= 0
  bool is_soft = false;  ///< it gives by a 1e-10 of what it moves: others may hold as well

  friend bool operator==(const ContactForce&, const ContactForce&) = default;
};

/// A force of the world on an unknown, or its way.
struct PlacedVector {
  int unknown = 0;
  Vector3d vector = {0, 0, 0};
};

/// S + diag(give) with S_ij = direction_i . direction_j times the entry of the inverse at their
/// unknowns: positive definite. What is found is a function of the plate's matrix and of the forces
/// in their order. Few forces have a dense factor, from columns of the inverse; many are solved by
/// conjugate gradients, with the inverse of a part of the plate around them for a preconditioner.
/// docs/model.md, "Contact". Internal to plate.
class ContactMatrix {
 public:
  ContactMatrix(InverseColumns& columns, const RunContext& context)
      : columns_(columns), context_(context), kernels_(kernels_of_width(context.most_lanes)) {}

  /// Whether the last forces have a factor.
  bool is_dense() const { return is_dense_; }

  /// The plate's matrix is another one.
  void forget();

  /// Takes forces, unknowns ascending. Errors: those of the plate's solves; SolverFailed;
  /// Interrupted.
  Result<void> factor(std::span<const ContactForce> forces, const SolvedMatrix& plate);

  /// The sizes of the forces that move their unknowns so far along them, but for `least` of it if
  /// they are many; then the search begins with `start`, none: with 0. Requires: `factor` succeeded
  /// last, for the same plate.
  Result<std::vector<double>> solved(const std::vector<double>& right, const SolvedMatrix& plate,
                                     double least = 1e-13, std::vector<double> start = {});

  /// The ways on which forces move some unknowns. Requires: those with a force are among the ones
  /// of `factor`.
  Result<std::vector<Vector3d>> ways(std::span<const PlacedVector> forces,
                                     std::span<const int> unknowns,
                                     const SolvedMatrix& plate) const;

 private:
  Result<void> factor_densely(std::span<const ContactForce> forces, const SolvedMatrix& plate);
  std::size_t count_kept(std::span<const ContactForce> forces) const;
  void make_room(std::size_t count, std::size_t kept);
  std::vector<double> solved_densely(std::vector<double> x) const;
  Result<void> surround(const SolvedMatrix& plate);
  Result<void> make_schur(const SolvedMatrix& plate);
  Result<std::vector<double>> times(const std::vector<double>& x, const SolvedMatrix& plate) const;
  Result<std::vector<double>> preconditioned(const std::vector<double>& x) const;

  InverseColumns& columns_;
  RunContext context_;
  const PlateKernels& kernels_;
  bool is_dense_ = true;
  std::vector<ContactForce> forces_;
  std::vector<int> unknowns_;  // of the forces, each once
  // Dense.
  std::vector<ContactForce> factored_;  // as far as the factor is right
  std::vector<double> factor_;          // L of L L^T, a padded row after the other
  std::size_t pitch_ = 0;
  // Of many.
  std::optional<SparseMatrix> matrix_;  // of the plate
  std::optional<NearbySchur> schur_;
  std::vector<int> schur_unknowns_;  // of `schur_`
  std::vector<double> shares_;       // of the plate that the forces need
};

}  // namespace pliant
