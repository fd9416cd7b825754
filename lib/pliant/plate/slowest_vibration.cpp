#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/core/hash_stream.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/core/shelf.hpp"
#include "pliant/plate/small_modes.hpp"
#include "pliant/plate/solver_errors.hpp"
#include "pliant/plate/sparse/matrix_bytes.hpp"
#include "pliant/plate/vibration.hpp"

namespace pliant {
namespace {

using Shape = std::vector<double>;

// Sum of a_k m_k b_k, in four parts, so that an addition need not wait for the last one. In a fixed
// order: the result is on the way to the state.
double mass_product(const Shape& masses, const Shape& a, const Shape& b) {
  double sums[4] = {0, 0, 0, 0};
  const std::size_t whole = a.size() / 4 * 4;
  for (std::size_t k = 0; k < whole; k += 4) {
    for (std::size_t n = 0; n < 4; ++n) sums[n] += a[k + n] * masses[k + n] * b[k + n];
  }
  for (std::size_t k = whole; k < a.size(); ++k) sums[0] += a[k] * masses[k] * b[k];
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

void add_multiple(Shape& a, double factor, const Shape& b) {
  for (std::size_t k = 0; k < a.size(); ++k) a[k] += factor * b[k];
}

Shape shape_of(const Eigen::VectorXd& column) { return {column.begin(), column.end()}; }

// What is kept on a shelf: the slowest vibration of a plate with this matrix and these masses.
struct KnownVibration final : Shelf::Item {
  KnownVibration(const SparseMatrix& of, const Eigen::VectorXd& with) : matrix(of), masses(with) {}

  SparseMatrix matrix;
  Eigen::VectorXd masses;
  double lambda = 0;

  std::array<std::string_view, 4> parts() const {
    const auto [starts, rows, values] = matrix_bytes(matrix);
    return {starts, rows, values, bytes_in(masses.data(), masses.size())};
  }
  Hash key(SolverChoice solver) const {
    HashStream stream;
    stream.add("slowest vibration by ");
    stream.add(name_of(solver));
    for (const std::string_view part : parts()) stream.add(part);
    return stream.hash();
  }
  bool is_same_as(const KnownVibration& other) const { return parts() == other.parts(); }
  std::size_t bytes() const {
    std::size_t sum = 0;
    for (const std::string_view part : parts()) sum += part.size();
    return sum;
  }
};

// Lanczos' method with blocks of three, on the inverse of K + shift M. In the space of the basis,
// which is orthogonal by mass, the inverse is the small matrix `projected_`, whose largest
// eigenvalues mu are those of the slowest vibrations: mu = 1 / (lambda + shift). If the basis is
// full, it starts again with the best approximations found. If that takes long, because many
// eigenvalues are close together, as for a sliver, the shift goes to just below the smallest one,
// which tears them apart; that K + shift M is still positive proves that none was missed.
class SlowestVibration {
 public:
  explicit SlowestVibration(const VibratingPlate& plate)
      : plate_(plate),
        masses_(shape_of(plate.masses)),
        share_(plate.context.memory),
        solve_(plate.solve),
        shift_(plate.shift) {}

  Result<double> find() {
    const std::size_t bytes = (most_shapes + 2 * width + 12) * masses_.size() * sizeof(double);
    if (!share_.try_resize(bytes)) {
      return fail(ErrorCode::OutOfMemory, "finding the slowest vibration of a plate with " +
                                              std::to_string(masses_.size()) + " moving nodes " +
                                              share_.complaint(bytes));
    }
    for (Eigen::Index k = 0; k < plate_.rigid.cols(); ++k) {
      Shape shape = shape_of(plate_.rigid.col(k));
      if (const double length = make_new(shape); length > 0) rigid_.push_back(std::move(shape));
    }
    std::vector<Shape> block;
    for (Eigen::Index k = 0; k < plate_.shapes.cols(); ++k) {
      Shape shape = shape_of(plate_.shapes.col(k));
      if (make_new(shape, &block) > 0) block.push_back(std::move(shape));
    }
    int patience = first_patience;
    for (int pass = 0; pass < most_passes && !block.empty(); ++pass) {
      if (plate_.context.is_stopped()) return interrupted();
      auto next = extend(std::move(block));
      if (!next) return fail(next.error());
      const SmallModes modes = small_modes(projected_, basis_.size());
      const std::size_t place = place_of_slowest(modes);
      const bool is_all = next->empty();
      if (place < basis_.size() && (is_all || error_of(modes, place) <= wanted_error))
        return lambda_of(modes, place);
      if (is_all) break;
      block = *std::move(next);
      if (--patience <= 0 && plate_.shifted) {
        patience = later_patience;
        auto moved = move_shift(lambda_of(modes, 0), error_of(modes, 0));
        if (!moved) return fail(moved.error());
        if (*moved) {
          start_again(modes, width);
          block = std::exchange(basis_, {});
          projected_.clear();
          continue;
        }
      }
      if (basis_.size() + width > most_shapes) start_again(modes, kept_shapes);
    }
    // The space of all shapes has no other motions.
    if (rigid_.size() + basis_.size() >= masses_.size()) return 0.0;
    return fail(ErrorCode::SolverFailed,
                "the slowest vibration of a plate with " + std::to_string(masses_.size()) +
                    " moving nodes was not found to 1e-7; give it a damping in place of a "
                    "dampingRatio");
  }

 private:
  static constexpr std::size_t width = 3;
  static constexpr std::size_t most_shapes = 24, kept_shapes = 9;
  static constexpr int most_passes = 1000;
  static constexpr int first_patience = 30, later_patience = 10;  // until the shift moves [passes]
  static constexpr double wanted_error = 5e-8;  // of the eigenvalue, at most: its square is nearer

  // Makes a shape of length 1, orthogonal to the basis, the rigid motions and `others`. Its length
  // before, 0 if nothing but rounding error is left; `parts` are what it had of the basis, and then
  // of the others.
  double make_new(Shape& shape, const std::vector<Shape>* others = nullptr,
                  std::vector<double>* parts = nullptr) const {
    const double whole = std::sqrt(mass_product(masses_, shape, shape));
    const std::size_t known_count = rigid_.size() + basis_.size() + (others ? others->size() : 0);
    if (parts) parts->assign(basis_.size() + (others ? others->size() : 0), 0);
    if (!(whole > 0) || !std::isfinite(whole)) return 0;
    double length = whole;
    // Once more if much was taken away, whose rounding errors then count.
    for (int pass = 0; pass < 3; ++pass) {
      const double before = length;
      for (const Shape& known : rigid_)
        add_multiple(shape, -mass_product(masses_, known, shape), known);
      std::size_t place = 0;
      const auto take = [&](const Shape& known) {
        const double part = mass_product(masses_, known, shape);
        add_multiple(shape, -part, known);
        if (parts) (*parts)[place++] += part;
      };
      std::for_each(basis_.begin(), basis_.end(), take);
      if (others) std::for_each(others->begin(), others->end(), take);
      length = std::sqrt(mass_product(masses_, shape, shape));
      if (!(length > 1e-14 * whole)) return 0;
      if (length > 0.5 * before) break;
    }
    if (known_count >= masses_.size()) return 0;
    for (double& number : shape) number /= length;
    return length;
  }

  // Adds a block to the basis, and finds the next one: what the inverse makes of it beyond the
  // basis. Empty if that is nothing.
  Result<std::vector<Shape>> extend(std::vector<Shape> block) {
    const std::size_t before = basis_.size(), added = block.size();
    Field forces = Field::Zero(plate_.masses.size(), 3);
    for (std::size_t k = 0; k < added; ++k) {
      for (std::size_t row = 0; row < masses_.size(); ++row)
        forces(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(k)) =
            masses_[row] * block[k][row];
    }
    const auto solved = solve_(forces);
    if (!solved) return fail(solved.error());
    for (Shape& shape : block) basis_.push_back(std::move(shape));
    const std::size_t size = basis_.size();
    std::vector<double> projected(size * size, 0);
    for (std::size_t row = 0; row < before; ++row) {
      std::copy_n(projected_.begin() + static_cast<std::ptrdiff_t>(row * before), before,
                  projected.begin() + static_cast<std::ptrdiff_t>(row * size));
    }
    projected_ = std::move(projected);
    std::vector<Shape> next;
    beyond_.assign(added, std::vector<double>(width, 0));
    first_of_last_ = before;
    std::vector<double> parts;
    for (std::size_t k = 0; k < added; ++k) {
      Shape shape = shape_of(solved->col(static_cast<Eigen::Index>(k)));
      const double length = make_new(shape, &next, &parts);
      const std::size_t column = before + k;
      for (std::size_t row = 0; row < size; ++row)
        projected_[row * size + column] = projected_[column * size + row] = parts[row];
      for (std::size_t n = 0; n < next.size(); ++n) beyond_[k][n] = parts[size + n];
      if (length == 0) continue;
      beyond_[k][next.size()] = length;
      next.push_back(std::move(shape));
    }
    return next;
  }

  // Eigenvalue mu of the k-th slowest vibration.
  double value_of(const SmallModes& modes, std::size_t k) const {
    return modes.values[basis_.size() - 1 - k];
  }
  const double* vector_of(const SmallModes& modes, std::size_t k) const {
    return &modes.vectors[(basis_.size() - 1 - k) * basis_.size()];
  }

  double lambda_of(const SmallModes& modes, std::size_t k) const {
    return 1 / value_of(modes, k) - shift_;
  }

  // Moves the shift near -lambda, as near as the error allows. False: it cannot.
  Result<bool> move_shift(double lambda, double error) {
    for (error *= 2; error < 0.5; error *= 4) {
      const double shift = -lambda * (1 - error);
      auto solve = plate_.shifted(shift);
      if (solve) {
        solve_ = *std::move(solve);
        shift_ = shift;
        return true;
      }
      // Otherwise the smallest eigenvalue is farther below.
      if (solve.error().code != ErrorCode::SolverFailed) return fail(solve.error());
    }
    auto same = plate_.shifted(shift_);  // the solve from before may be gone
    if (!same) return fail(same.error());
    solve_ = *std::move(same);
    return false;
  }

  // The place of the slowest vibration that is no rigid motion: these have lambda = 0, but for the
  // rounding errors of solves.
  std::size_t place_of_slowest(const SmallModes& modes) const {
    if (plate_.shift == 0 || !rigid_.empty()) return 0;
    std::size_t place = 0;
    while (place < basis_.size() && value_of(modes, place) * plate_.shift > 1 - 1e-8) ++place;
    return place;
  }

  // The relative error of lambda, at most: there is an eigenvalue of the inverse as near to mu as
  // what the inverse makes of the vibration is to mu times it.
  double error_of(const SmallModes& modes, std::size_t place) const {
    const double mu = value_of(modes, place);
    const double* const last = vector_of(modes, place) + first_of_last_;
    double square = 0;
    for (std::size_t n = 0; n < width; ++n) {
      double sum = 0;
      for (std::size_t k = 0; k < beyond_.size(); ++k) sum += beyond_[k][n] * last[k];
      square += sum * sum;
    }
    return std::sqrt(square) / mu / (lambda_of(modes, place) * mu);
  }

  void start_again(const SmallModes& modes, std::size_t kept) {
    std::vector<Shape> best;
    std::vector<double> projected(kept * kept, 0);
    for (std::size_t k = 0; k < kept; ++k) {
      Shape sum(masses_.size(), 0);
      const double* const vector = vector_of(modes, k);
      for (std::size_t n = 0; n < basis_.size(); ++n) add_multiple(sum, vector[n], basis_[n]);
      best.push_back(std::move(sum));
      projected[k * kept + k] = value_of(modes, k);
    }
    basis_ = std::move(best);
    projected_ = std::move(projected);
  }

  const VibratingPlate& plate_;
  Shape masses_;
  MemoryShare share_;
  std::function<Result<Field>(const Field&)> solve_;
  double shift_;
  std::vector<Shape> rigid_;
  std::vector<Shape> basis_;
  std::vector<double> projected_;  // row by row
  // What the inverse makes of the last block beyond the basis: parts of the next block.
  std::vector<std::vector<double>> beyond_;
  std::size_t first_of_last_ = 0;  // the last block in the basis
};

}  // namespace

Result<double> smallest_eigenvalue(const VibratingPlate& plate) {
  Shelf* const shelf = plate.matrix ? plate.context.shelf : nullptr;
  if (!shelf) return SlowestVibration(plate).find();
  const auto matrix = plate.matrix();
  if (!matrix) return fail(matrix.error());
  auto known = std::make_shared<KnownVibration>(*matrix, plate.masses);
  const Hash key = known->key(plate.solver);
  const auto is_same = [&](const KnownVibration& one) { return one.is_same_as(*known); };
  if (const auto found = shelf->find<KnownVibration>(key, is_same)) return found->lambda;
  auto lambda = SlowestVibration(plate).find();
  if (!lambda) return lambda;
  known->lambda = *lambda;
  const std::size_t bytes = known->bytes();
  shelf->keep(key, std::move(known), bytes);
  return lambda;
}

}  // namespace pliant
