#include "pliant/plate/contact/contact_matrix.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace pliant {

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
Result<void> ContactMatrix::factor(std::span<const ContactForce> forces, Eigen::Index size,
                                   const InverseColumns::Solve& solve_plate) {
  const std::size_t count = forces.size(), kept = count_kept(forces);
  std::vector<int> unknowns;
  for (const ContactForce& force : forces)
    if (unknowns.empty() || unknowns.back() != force.unknown) unknowns.push_back(force.unknown);
  if (auto taken = columns_.take(unknowns, size, solve_plate); !taken) return taken;
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

std::vector<double> ContactMatrix::solved(std::vector<double> x) const {
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

}  // namespace pliant
