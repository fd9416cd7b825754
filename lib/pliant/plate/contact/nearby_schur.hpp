#pragma once

#include <memory>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/plate/sparse/sparse_factor.hpp"

namespace pliant {

/// Nearly the inverse of a part of a plate's inverse: with c some unknowns and b those near them,
/// A_cc - A_cb A_bb^-1 A_bc, which is that inverse itself if b is all others. Symmetric, positive
/// definite. Internal to plate.
class NearbySchur {
 public:
  /// `matrix`: both triangles of A; `unknowns` ascending. Near is what so many entries in a row
  /// lead to. Errors: SolverFailed; Interrupted.
  static Result<NearbySchur> make(const SparseMatrix& matrix, const std::vector<int>& unknowns,
                                  int reach, const RunContext& context);

  /// Times numbers of the unknowns (#unknowns x 3).
  Result<Field> times(const Field& x) const;

 private:
  SparseMatrix own_;                      // A_cc
  SparseMatrix across_;                   // A_bc
  std::unique_ptr<SparseFactor> factor_;  // of A_bb; null: there is no b
};

}  // namespace pliant
