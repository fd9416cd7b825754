#pragma once

#include <vector>

#include "pliant/plate/energy/stencil_table.hpp"
#include "pliant/plate/plate_problem.hpp"
#include "pliant/plate/sparse/plate_matrix.hpp"

namespace pliant {

/// The plate of an outline in a grid. Its K is that of the bending energy, which for even plates
/// with clamped edges is the stencil's, entry by entry; docs/model.md, "One energy". Internal to
/// plate.
class GridAssembly final : public PlateAssembly, private DifferenceResidual {
 public:
  /// The system's shift is not read.
  explicit GridAssembly(const PlateSystem& system);

  /// Whether it is that of such a system.
  bool is_of(const PlateSystem& system) const { return system_ == unshifted(system); }

  int size() const override { return system_.outline.unknown_count(); }
  PlateWeights weights() const override;
  Eigen::VectorXd goals() const override;
  std::size_t most_entries() const override;
  Result<Entries<double>> entries() const override;
  Result<Entries<long double>> precise_entries() const override;
  const DifferenceResidual* differences() const override { return is_stencil() ? this : nullptr; }
  bool loses_digits(double shift) const override;

  /// The forces on the unknowns by a load (#nodes x 3), the rim's displacement and the tangents.
  Field forces(const Field& load, const EdgeTangents& tangents, const Field& displacement) const;

 private:
  static PlateSystem unshifted(PlateSystem system);
  bool is_stencil() const;
  Field residual(const Eigen::VectorXd& shifts, const Field& x, const Field& f) const override;
  template <class Real>
  StencilTable<Real> table() const;
  template <class Real>
  Entries<Real> entries_of() const;

  PlateSystem system_;
  std::vector<int> numbers_;  // of the unknowns, by node
};

/// An estimate of the condition number of the matrix of an even plate with clamped edges: an upper
/// bound of its eigenvalues divided by the smallest one of the whole rectangle, simply supported.
/// At least 1.
double estimate_condition(const PlateSystem& system);

}  // namespace pliant
