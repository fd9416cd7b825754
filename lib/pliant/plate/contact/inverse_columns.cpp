#include "pliant/plate/contact/inverse_columns.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace pliant {

void InverseColumns::forget() {
  columns_.clear();
  static_cast<void>(share_.try_resize(0));
}

// Columns that are not needed now are kept as long as they are not too many.
Result<void> InverseColumns::reserve(std::span<const int> unknowns, Eigen::Index size) {
  constexpr std::size_t most_kept = std::size_t{256} << 20U;  // [bytes]
  const auto column = static_cast<std::size_t>(size) * sizeof(double);
  const auto is_new = [this](int unknown) { return !columns_.contains(unknown); };
  const auto added = static_cast<std::size_t>(std::ranges::count_if(unknowns, is_new));
  if (added == 0) return {};
  const bool fits = (columns_.size() + added) * column <= most_kept &&
                    share_.try_resize((columns_.size() + added) * column);
  if (fits) return {};
  std::erase_if(columns_, [&](const auto& kept) {
    return !std::ranges::binary_search(unknowns, kept.first);
  });
  const std::size_t bytes = unknowns.size() * column;
  if (share_.try_resize(bytes)) return {};
  return fail(ErrorCode::OutOfMemory,
              fmt::format("the contact of {} nodes {}", unknowns.size(), share_.complaint(bytes)));
}

Result<void> InverseColumns::take(std::span<const int> unknowns, Eigen::Index size,
                                  const Solve& solve) {
  if (auto reserved = reserve(unknowns, size); !reserved) return reserved;
  std::vector<int> missing;
  for (const int unknown : unknowns)
    if (!columns_.contains(unknown)) missing.push_back(unknown);
  Field forces = Field::Zero(size, 3);
  for (std::size_t first = 0; first < missing.size(); first += 3) {
    if (context_.is_stopped()) return interrupted();
    const std::size_t count = std::min<std::size_t>(3, missing.size() - first);
    const auto set = [&](double force) {
      for (std::size_t k = 0; k < count; ++k)
        forces(missing[first + k], static_cast<Eigen::Index>(k)) = force;
    };
    set(1);
    const auto solution = solve(forces);
    if (!solution) return fail(solution.error());
    set(0);
    for (std::size_t k = 0; k < count; ++k) {
      const double* const column = solution->col(static_cast<Eigen::Index>(k)).data();
      columns_.emplace(missing[first + k], std::vector<double>(column, column + size));
    }
  }
  return {};
}

}  // namespace pliant
