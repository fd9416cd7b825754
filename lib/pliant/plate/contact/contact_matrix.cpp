#include "pliant/plate/contact/contact_matrix.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace pliant {
namespace {

// From so many forces on, gradients are faster than a factor; where some unknowns have several
// forces, as with friction, the preconditioner is worse.
constexpr std::size_t most_dense = 400, most_dense_of_several = 1200;

// Entries that lead to what is near: of a grid, 16 nodes.
constexpr int reach_of_nearby = 8;

double dot_product(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += a[k] * b[k];
  return sum;
}

double largest(const std::vector<double>& numbers) {
  double most = 0;
  for (const double number : numbers) most = std::max(most, std::abs(number));
  return most;
}

}  // namespace

void ContactMatrix::forget() {
  factored_.clear();
  matrix_.reset();
  schur_.reset();
}

Result<void> ContactMatrix::factor(std::span<const ContactForce> forces,
                                   const SolvedMatrix& plate) {
  forces_.assign(forces.begin(), forces.end());
  unknowns_.clear();
  for (const ContactForce& force : forces)
    if (unknowns_.empty() || unknowns_.back() != force.unknown) unknowns_.push_back(force.unknown);
  const bool are_several = forces.size() > unknowns_.size();
  is_dense_ = forces.size() <= (are_several ? most_dense_of_several : most_dense);
  return is_dense_ ? factor_densely(forces, plate) : surround(plate);
}

Result<std::vector<Vector3d>> ContactMatrix::ways(std::span<const PlacedVector> forces,
                                                  std::span<const int> unknowns,
                                                  const SolvedMatrix& plate) const {
  std::vector<Vector3d> all;
  // A solve costs about as much as so many columns for all unknowns of the plate.
  constexpr std::size_t columns_of_a_solve = 16;
  if (is_dense_ && forces.size() * unknowns.size() <=
                       columns_of_a_solve * static_cast<std::size_t>(plate.size)) {
    all.assign(unknowns.size(), Vector3d::Zero());
    for (const PlacedVector& force : forces) {
      const double* const column = columns_.of(force.unknown);
      for (std::size_t i = 0; i < unknowns.size(); ++i)
        all[i] += column[unknowns[i]] * force.vector;
    }
    return all;
  }
  Field pressed = Field::Zero(plate.size, 3);
  for (const PlacedVector& force : forces) pressed.row(force.unknown) += force.vector.transpose();
  const auto moved = plate.solve(pressed);
  if (!moved) return fail(moved.error());
  for (const int unknown : unknowns) all.emplace_back(moved->row(unknown).transpose());
  return all;
}

// How many of the first forces are the first ones of the factor.
std::size_t ContactMatrix::count_kept(std::span<const ContactForce> forces) const {
  const auto [end, other] = std::ranges::mismatch(factored_, forces);
  return static_cast<std::size_t>(end - factored_.begin());
}

void ContactMatrix::make_room(std::size_t count, std::size_t kept) {
  if (count > pitch_) {
    const std::size_t pitch = (count + count / 4 + 7) / 8 * 8;
    std::vector<double> wider(pitch * pitch, 0.0);
    for (std::size_t i = 0; i < kept; ++i)
      std::copy_n(factor_.data() + i * pitch_, i + 1, wider.data() + i * pitch);
    factor_ = std::move(wider);
    pitch_ = pitch;
  }
  std::fill_n(factor_.data() + kept * pitch_, (count - kept) * pitch_, 0.0);
}

// Cholesky's factor by rows: sums are dot products of rows, of one order for all widths. A row
// depends on those before it only, so that the first ones of an earlier factor are kept.
Result<void> ContactMatrix::factor_densely(std::span<const ContactForce> forces,
                                           const SolvedMatrix& plate) {
  const std::size_t count = forces.size(), kept = count_kept(forces);
  if (auto taken = columns_.take(unknowns_, plate.size, plate.solve); !taken) return taken;
  factored_.resize(kept);
  make_room(count, kept);
  std::vector<const double*> columns;
  for (const ContactForce& force : forces) columns.push_back(columns_.of(force.unknown));
  for (std::size_t i = kept; i < count; ++i) {
    if (context_.is_stopped()) return interrupted();
    const ContactForce& force = forces[i];
    double* const own = factor_.data() + i * pitch_;
    for (std::size_t j = 0; j <= i; ++j) {
      // The unknown of j is not greater.
      double entry = dot_of(force.direction, forces[j].direction) * columns[j][force.unknown];
      if (j == i) entry = entry * (force.is_soft ? 1 + 1e-10 : 1) + force.give;
      const double* const other = factor_.data() + j * pitch_;
      const auto shared = static_cast<long>((j + 7) / 8 * 8);
      const double rest = entry - kernels_.dot_product(shared, own, other);
      if (j < i) {
        own[j] = rest / other[j];
      } else if (rest > 0) {
        own[j] = std::sqrt(rest);
      } else {
        return fail(ErrorCode::SolverFailed,
                    fmt::format("contact has no solution: pivot {} of {} of its matrix is {}, but "
                                "must be positive",
                                i, count, rest));
      }
    }
    factored_.push_back(force);
  }
  return {};
}

std::vector<double> ContactMatrix::solved_densely(std::vector<double> x) const {
  const std::size_t count = x.size();
  for (std::size_t i = 0; i < count; ++i) {
    const double* const row = factor_.data() + i * pitch_;
    double sum = x[i];
    for (std::size_t j = 0; j < i; ++j) sum -= row[j] * x[j];
    x[i] = sum / row[i];
  }
  for (std::size_t i = count; i-- > 0;) {
    const double* const row = factor_.data() + i * pitch_;
    x[i] /= row[i];
    for (std::size_t j = 0; j < i; ++j) x[j] -= row[j] * x[i];
  }
  return x;
}

// Makes the preconditioner.
Result<void> ContactMatrix::surround(const SolvedMatrix& plate) {
  if (auto made = make_schur(plate); !made) return made;
  // What gives by itself needs the less of the plate: 1 for a force that does not.
  shares_.clear();
  for (const ContactForce& force : forces_) {
    const double own = force.give > 0 ? matrix_->coeff(force.unknown, force.unknown) : 0;
    shares_.push_back(1 / std::sqrt(1 + force.give * own));
  }
  return {};
}

Result<void> ContactMatrix::make_schur(const SolvedMatrix& plate) {
  if (!matrix_) {
    const auto upper = plate.upper();
    if (!upper) return fail(upper.error());
    matrix_ = SparseMatrix(upper->selfadjointView<Eigen::Upper>());
  }
  if (schur_ && schur_unknowns_ == unknowns_) return {};
  schur_.reset();
  auto made = NearbySchur::make(*matrix_, unknowns_, reach_of_nearby, context_);
  if (!made) return fail(made.error());
  schur_ = *std::move(made);
  schur_unknowns_ = unknowns_;
  return {};
}

Result<std::vector<double>> ContactMatrix::times(const std::vector<double>& x,
                                                 const SolvedMatrix& plate) const {
  Field pressed = Field::Zero(plate.size, 3);
  for (std::size_t k = 0; k < x.size(); ++k)
    pressed.row(forces_[k].unknown) += x[k] * forces_[k].direction.transpose();
  const auto moved = plate.solve(pressed);
  if (!moved) return fail(moved.error());
  std::vector<double> product(x.size());
  for (std::size_t k = 0; k < x.size(); ++k) {
    product[k] = dot_of(forces_[k].direction, moved->row(forces_[k].unknown).transpose()) +
                 forces_[k].give * x[k];
  }
  return product;
}

Result<std::vector<double>> ContactMatrix::preconditioned(const std::vector<double>& x) const {
  Field pressed = Field::Zero(static_cast<Eigen::Index>(unknowns_.size()), 3);
  const auto for_each = [&](const auto& visit) {
    Eigen::Index place = -1;
    for (std::size_t k = 0; k < x.size(); ++k) {
      if (k == 0 || forces_[k].unknown != forces_[k - 1].unknown) ++place;
      visit(k, place);
    }
  };
  for_each([&](std::size_t k, Eigen::Index place) {
    pressed.row(place) += shares_[k] * x[k] * forces_[k].direction.transpose();
  });
  const auto product = schur_->times(pressed);
  if (!product) return fail(product.error());
  std::vector<double> result(x.size());
  for_each([&](std::size_t k, Eigen::Index place) {
    result[k] = shares_[k] * dot_of(forces_[k].direction, product->row(place).transpose());
  });
  return result;
}

// Conjugate gradients.
Result<std::vector<double>> ContactMatrix::solved(const std::vector<double>& right,
                                                  const SolvedMatrix& plate, double least,
                                                  std::vector<double> start) {
  if (is_dense_) return solved_densely(right);
  constexpr int most_turns = 500;
  std::vector<double> left = right, x = std::move(start), way;
  x.resize(right.size(), 0.0);
  if (std::ranges::any_of(x, [](double number) { return number != 0; })) {
    auto product = times(x, plate);
    if (!product) return product;
    for (std::size_t k = 0; k < left.size(); ++k) left[k] -= (*product)[k];
  }
  const double whole = largest(right);
  double before = 0;
  for (int turn = 0; turn < most_turns && largest(left) > least * whole; ++turn) {
    if (context_.is_stopped()) return interrupted();
    auto next = preconditioned(left);
    if (!next) return next;
    const double now = dot_product(left, *next);
    if (turn == 0) {
      way = *next;
    } else {
      for (std::size_t k = 0; k < way.size(); ++k) way[k] = (*next)[k] + now / before * way[k];
    }
    before = now;
    auto product = times(way, plate);
    if (!product) return product;
    const double part = now / dot_product(way, *product);
    if (!std::isfinite(part)) break;
    for (std::size_t k = 0; k < x.size(); ++k) {
      x[k] += part * way[k];
      left[k] -= part * (*product)[k];
    }
  }
  return x;
}

}  // namespace pliant
