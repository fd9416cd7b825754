#include <Eigen/SparseCholesky>

#include "pliant/plate/solver_errors.hpp"
#include "pliant/plate/sparse/sparse_factor.hpp"

namespace pliant {
namespace {

class EigenFactor final : public SparseFactor {
 public:
  Result<void> analyze(const SparseMatrix& matrix) override {
    ldlt_.analyzePattern(matrix);
    return {};
  }

  std::size_t bytes() const override {
    return (sizeof(double) + sizeof(int)) * ldlt_.factor_entries();
  }

  Result<void> factorize(const SparseMatrix& matrix, const StopRequest&) override {
    ldlt_.factorize(matrix);
    // Eigen reports zero pivots only; it factors an indefinite matrix as LDL^T without an error.
    Eigen::Index pivot = 0;
    const bool is_definite =
        ldlt_.info() == Eigen::Success && ldlt_.vectorD().minCoeff<Eigen::PropagateNaN>(&pivot) > 0;
    if (is_definite) return {};
    return fail(not_positive_definite(matrix.rows(), pivot));
  }

  Result<Field> solve(const Field& right_hand_sides) override {
    return Field(ldlt_.solve(right_hand_sides));
  }

 private:
  using Ldlt = Eigen::SimplicialLDLT<SparseMatrix, Eigen::Upper, Eigen::AMDOrdering<int>>;

  // Eigen counts the entries of the factor in the analysis, but does not expose the count.
  struct CountingLdlt : Ldlt {
    std::size_t factor_entries() const { return m_nonZerosPerCol.cast<std::size_t>().sum(); }
  };

  CountingLdlt ldlt_;
};

}  // namespace

std::unique_ptr<SparseFactor> make_eigen_factor() { return std::make_unique<EigenFactor>(); }

}  // namespace pliant
