#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "pliant/core/memory_budget.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/plate/sparse/sparse_factor.hpp"

namespace pliant {

/// Entries of the upper triangle of a symmetric matrix. Those of one place are summed.
template <class Real>
struct Entries {
  std::vector<int> rows, columns;
  std::vector<Real> values;

  void reserve(std::size_t count) {
    rows.reserve(count);
    columns.reserve(count);
    values.reserve(count);
  }

  /// That of (one, other) and of (other, one).
  void add(int one, int other, Real value) {
    rows.push_back(std::min(one, other));
    columns.push_back(std::max(one, other));
    values.push_back(value);
  }
};

/// What the unknowns that move have, in their order: all or the first ones. Their areas, and the
/// diagonals by which density and damping are multiplied.
struct PlateWeights {
  Eigen::VectorXd areas;
  Eigen::VectorXd masses;  ///< areas times the factors of a map of density
  Eigen::VectorXd drags;   ///< areas times those of a map of damping
};

/// What a solution leaves, by differences in extended precision: entries, which are rounded one by
/// one, lose digits. Internal to plate.
class DifferenceResidual {
 public:
  virtual ~DifferenceResidual() = default;

  /// f - (K + diag(shifts)) x (#unknowns x 3).
  virtual Field residual(const Eigen::VectorXd& shifts, const Field& x, const Field& f) const = 0;
};

/// What a plate is made of: a grid of any outline, or triangles. Internal to plate.
class PlateAssembly {
 public:
  PlateAssembly() = default;
  PlateAssembly(const PlateAssembly&) = delete;
  PlateAssembly& operator=(const PlateAssembly&) = delete;
  virtual ~PlateAssembly() = default;

  virtual int size() const = 0;  ///< #unknowns
  virtual PlateWeights weights() const = 0;

  /// How many `entries` has, or a few more.
  virtual std::size_t most_entries() const = 0;

  /// Those of K, the Hessian of the bending energy, in one order for both types. Errors:
  /// Interrupted.
  virtual Result<Entries<double>> entries() const = 0;
  virtual Result<Entries<long double>> precise_entries() const = 0;

  /// What a goal adds to the diagonal of K at the unknowns that move; empty: nothing. `entries` and
  /// `differences` do not contain it.
  virtual Eigen::VectorXd goals() const { return {}; }

  /// Null: there are entries only.
  virtual const DifferenceResidual* differences() const { return nullptr; }

  /// Whether solutions of K + shift M are known to need correction.
  virtual bool loses_digits(double /*shift*/) const { return false; }
};

/// K + a diagonal, of which what a solution leaves can be computed in extended precision (64 bits
/// of mantissa on x86-64): in plain double its rounding error would be as large as what is left.
/// Internal to plate.
class PlateMatrix {
 public:
  explicit PlateMatrix(const RunContext& context) : context_(context), share_(context.memory) {}

  /// Takes K of an assembly, which outlives it here. Errors: OutOfMemory; Interrupted.
  Result<void> assemble(const PlateAssembly& assembly);

  /// The last one. Requires: there is one.
  const PlateAssembly& assembly() const { return *assembly_; }

  /// K: the upper triangle by columns, rows ascending.
  const SparseMatrix& stiffness() const { return stiffness_; }

  /// Whether the last two K have their entries at the same places.
  bool keeps_pattern() const { return keeps_pattern_; }

  /// The upper triangle of K + diag(shifts), of the first unknowns.
  SparseMatrix shifted(const Eigen::VectorXd& shifts) const;

  /// Makes what `residual` needs. Errors: OutOfMemory; Interrupted.
  Result<void> open();

  /// f - (K + diag(shifts)) x (#unknowns x 3). Requires: `open` succeeded.
  Field residual(const Eigen::VectorXd& shifts, const Field& x, const Field& f) const;

  /// Frees what `open` made.
  void close();

  std::size_t memory() const { return share_.bytes(); }

 private:
  using Extended = long double;

  // Both triangles, by rows, columns ascending.
  struct Precise {
    std::vector<std::size_t> starts;  // #rows + 1
    std::vector<int> columns;
    std::vector<Extended> values;
  };

  Result<void> take(std::size_t bytes);
  std::size_t kept_bytes() const;
  std::size_t place_on_diagonal(Eigen::Index column) const;

  RunContext context_;
  MemoryShare share_;
  const PlateAssembly* assembly_ = nullptr;
  SparseMatrix stiffness_;
  std::vector<int> places_;  // of the assembly's entries in `stiffness_`
  Eigen::VectorXd goals_;    // the assembly's, in `stiffness_`
  bool keeps_pattern_ = false;
  Precise precise_;
};

}  // namespace pliant
