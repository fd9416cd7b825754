#include "pliant/plate/contact/complementarity.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace pliant {
namespace {

// Two directions across another, of length 1.
std::pair<Vector3d, Vector3d> across(const Vector3d& n) {
  int least = 0;
  for (int k = 1; k < 3; ++k)
    if (std::abs(n[k]) < std::abs(n[least])) least = k;
  const Vector3d axis = Vector3d::Unit(least);
  Vector3d one = axis - dot_of(axis, n) * n;
  one /= length_of(one);
  return {one, Vector3d(n[1] * one[2] - n[2] * one[1], n[2] * one[0] - n[0] * one[2],
                        n[0] * one[1] - n[1] * one[0])};
}

Vector3d part_across(const Vector3d& n, const Vector3d& way) { return way - dot_of(n, way) * n; }

Vector3d turned_across(const Vector3d& n, const Vector3d& along) {
  return {n[1] * along[2] - n[2] * along[1], n[2] * along[0] - n[0] * along[2],
          n[0] * along[1] - n[1] * along[0]};
}

}  // namespace

// Those that lay there and are needed push at first; if there are none, all that are needed.
void Complementarity::begin(const std::vector<ContactRow>& rows,
                            const std::vector<double>& bounds) {
  const bool some_lie = std::ranges::any_of(
      rows, [](const ContactRow& row) { return row.lies && !row.sticks && row.lift > 0; });
  pushes_.assign(rows.size(), false);
  friction_.assign(rows.size(), {});
  forces_.assign(rows.size(), Vector3d::Zero());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    pushes_[k] = rows[k].sticks || (rows[k].lift > 0 && (rows[k].lies || !some_lie));
    if (!bounds.empty() && !rows[k].sticks) friction_[k].bound = bounds[k];
  }
}

void Complementarity::list_parts(const std::vector<ContactRow>& rows) {
  parts_.clear();
  along_.clear();
  const auto add = [&](std::size_t k, bool is_normal, const Vector3d& direction, double give) {
    // What several rows hold across their normals is held more often than it need be.
    const bool has_other = (k > 0 && rows[k - 1].unknown == rows[k].unknown) ||
                           (k + 1 < rows.size() && rows[k + 1].unknown == rows[k].unknown);
    parts_.push_back({k, is_normal});
    along_.push_back({rows[k].unknown, direction, give, !is_normal && has_other});
  };
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const ContactRow& row = rows[k];
    const Friction& friction = friction_[k];
    if (pushes_[k]) add(k, true, row.normal, 0);
    if (friction.slips) {
      // Newton's method on bound |slip|: as the slip turns, so does its force.
      add(k, false, turned_across(row.normal, friction.along), friction.length / friction.bound);
    } else if (row.sticks || friction.bound > 0) {
      const auto [one, other] = across(row.normal);
      add(k, false, one, 0);
      add(k, false, other, 0);
    }
  }
}

// How far a part has to move its unknown.
double Complementarity::lift_of(const std::vector<ContactRow>& rows, std::size_t part) const {
  const ContactRow& row = rows[parts_[part].row];
  return parts_[part].is_normal ? row.lift : -dot_of(along_[part].direction, row.slip);
}

// Solves with what pushes and slips now.
Result<void> Complementarity::turn(const std::vector<ContactRow>& rows, Eigen::Index size,
                                   const InverseColumns::Solve& solve_plate) {
  list_parts(rows);
  std::vector<ContactForce> all = along_;
  if (auto factored = matrix_.factor(all, size, solve_plate); !factored) return factored;
  std::vector<double> right;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    double lift = lift_of(rows, i);
    for (std::size_t k = 0; k < rows.size(); ++k) {
      const Friction& friction = friction_[k];
      if (!friction.slips) continue;
      lift += friction.bound * dot_of(along_[i].direction, friction.along) *
              matrix_.entry(rows[k].unknown, along_[i].unknown);
    }
    right.push_back(lift);
  }
  sizes_ = matrix_.solved(std::move(right));
  forces_.assign(rows.size(), Vector3d::Zero());
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (friction_[k].slips) forces_[k] = -friction_[k].bound * friction_[k].along;
  for (std::size_t i = 0; i < parts_.size(); ++i)
    forces_[parts_[i].row] += sizes_[i] * along_[i].direction;
  return {};
}

// What the forces move the unknown of a row, by the columns.
Vector3d Complementarity::way_of(const std::vector<ContactRow>& rows, std::size_t row) const {
  Vector3d way(0, 0, 0);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (forces_[k].isZero(0)) continue;
    way += matrix_.entry(rows[k].unknown, rows[row].unknown) * forces_[k];
  }
  return way;
}

// Those that push the wrong way, and those that do not push and are not kept.
std::vector<std::size_t> Complementarity::wrong_rows(const std::vector<ContactRow>& rows,
                                                     double tolerance) const {
  double most = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i)
    if (parts_[i].is_normal) most = std::max(most, std::abs(sizes_[i]));
  std::vector<std::size_t> wrong;
  std::size_t part = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    while (part < parts_.size() && parts_[part].row < k) ++part;
    if (rows[k].sticks) continue;
    if (pushes_[k]) {
      if (sizes_[part] < -1e-13 * most) wrong.push_back(k);
    } else if (rows[k].lift - dot_of(rows[k].normal, way_of(rows, k)) > tolerance) {
      wrong.push_back(k);
    }
  }
  return wrong;
}

// Lets rows slip and hold as their forces and slips say; whether any changed.
bool Complementarity::update_friction(const std::vector<ContactRow>& rows, double tolerance) {
  bool changed = false;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    Friction& friction = friction_[k];
    if (!(friction.bound > 0)) continue;
    if (!friction.slips) {
      const Vector3d force = part_across(rows[k].normal, forces_[k]);
      const double size = length_of(force);
      if (!(size > friction.bound * (1 + 1e-12))) continue;
      friction = {friction.bound, true, -force / size, 0};
      changed = true;
      continue;
    }
    const Vector3d slip = part_across(rows[k].normal, rows[k].slip + way_of(rows, k));
    const double length = length_of(slip);
    if (!(dot_of(slip, friction.along) > 0)) {
      // Against its force, or not at all: it holds, or just begins to slip.
      if (length <= tolerance && friction.length == 0) continue;
      friction = {friction.bound};
      changed = true;
      continue;
    }
    const Vector3d along = slip / length;
    const bool is_same = length_of(along - friction.along) * friction.length <= tolerance &&
                         std::abs(length - friction.length) <= tolerance + 1e-9 * length;
    friction.along = along;
    friction.length = length;
    changed = changed || !is_same;
  }
  return changed;
}

Result<std::vector<Vector3d>> Complementarity::solve(const std::vector<ContactRow>& rows,
                                                     const std::vector<double>& bounds,
                                                     Eigen::Index size, double tolerance,
                                                     const InverseColumns::Solve& solve_plate) {
  constexpr int patience = 10;  // of pivots in blocks that leave no fewer wrong rows
  begin(rows, bounds);
  std::size_t fewest = std::numeric_limits<std::size_t>::max();
  int waited = 0;
  // Single pivots end by themselves; the bound is far beyond what they need.
  const std::size_t most_turns = 1000 + 20 * rows.size();
  for (std::size_t turns = 0; turns < most_turns; ++turns) {
    if (context_.is_stopped()) return interrupted();
    if (auto turned = turn(rows, size, solve_plate); !turned) return fail(turned.error());
    const std::vector<std::size_t> wrong = wrong_rows(rows, tolerance);
    if (wrong.empty()) {
      if (!bounds.empty() && update_friction(rows, tolerance)) continue;
      return forces_;
    }
    waited = wrong.size() < fewest ? 0 : waited + 1;
    fewest = std::min(fewest, wrong.size());
    const std::size_t count = waited > patience ? 1 : wrong.size();
    for (std::size_t n = 0; n < count; ++n) pushes_[wrong[n]] = !pushes_[wrong[n]];
  }
  return fail(
      ErrorCode::SolverFailed,
      fmt::format("the contact of {} nodes did not settle in {} turns", rows.size(), most_turns));
}

std::vector<Vector3d> Complementarity::answer_to(const std::vector<ContactRow>& rows,
                                                 const std::vector<Vector3d>& moved,
                                                 double tolerance) {
  std::vector<double> lack;
  double most = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    lack.push_back(lift_of(rows, i) - dot_of(along_[i].direction, moved[parts_[i].row]) -
                   along_[i].give * sizes_[i]);
    most = std::max(most, std::abs(lack.back()));
  }
  if (!(most > tolerance)) return {};
  const std::vector<double> more = matrix_.solved(std::move(lack));
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    sizes_[i] += more[i];
    forces_[parts_[i].row] += more[i] * along_[i].direction;
  }
  return forces_;
}

}  // namespace pliant
