#include "pliant/plate/contact/contact_steps.hpp"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "pliant/core/transform.hpp"

namespace pliant {
namespace {

// What the rows' forces, of the world, move.
Result<Field> moved_by(const ContactPlate& plate, const StepContact& contact,
                       const std::vector<Vector3d>& forces) {
  const std::vector<ContactRow>& rows = contact.rows();
  const Transform to_plate{contact.to_plate(), Vector3d::Zero()};
  Field all = Field::Zero(plate.terms.known.rows(), 3);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (!forces[k].isZero(0)) all.row(rows[k].unknown) += to_world(to_plate, forces[k]).transpose();
  }
  return plate.solve(all);
}

bool has_friction(const std::vector<ContactRow>& rows) {
  return std::ranges::any_of(rows,
                             [](const ContactRow& row) { return row.friction > 0 && !row.sticks; });
}

// How much friction each row has at most, by the forces of rows in the solve before.
std::vector<double> bounds_of(const std::vector<ContactRow>& rows,
                              const std::map<std::pair<int, int>, double>& pressures) {
  std::vector<double> bounds;
  for (const ContactRow& row : rows) {
    const auto before = pressures.find({row.unknown, row.collider});
    bounds.push_back(before == pressures.end() ? 0 : row.friction * before->second);
  }
  return bounds;
}

std::map<std::pair<int, int>, double> pressures_of(const std::vector<ContactRow>& rows,
                                                   const std::vector<Vector3d>& forces) {
  std::map<std::pair<int, int>, double> pressures;
  for (std::size_t k = 0; k < forces.size(); ++k)
    pressures[{rows[k].unknown, rows[k].collider}] =
        std::max(0.0, dot_of(rows[k].normal, forces[k]));
  return pressures;
}

}  // namespace

Result<Field> free_end(const ContactPlate& plate, const Motion& motion) {
  const StepTerms& terms = plate.terms;
  const Eigen::Index moving = motion.displacement.rows();
  Field sums = terms.known;
  for (int k = 0; k < 3; ++k) {
    sums.col(k).head(moving) += terms.shift.cwiseProduct(motion.displacement.col(k)) +
                                terms.inertia.cwiseProduct(motion.velocity.col(k));
  }
  return plate.solve(sums);
}

// Corrected until those that push lack nothing: columns may be rough.
Result<Field> pushed_by_contact(const ContactPlate& plate, Complementarity& problem,
                                const StepContact& contact, const std::vector<double>& bounds,
                                std::vector<Vector3d>& forces) {
  constexpr int most_corrections = 4;
  const std::vector<ContactRow>& rows = contact.rows();
  auto found = problem.solve(rows, bounds, contact.tolerance(), plate.matrix);
  if (!found) return fail(found.error());
  forces = *std::move(found);
  const Transform to_world_space{contact.to_world(), Vector3d::Zero()};
  auto moved = moved_by(plate, contact, forces);
  for (int turn = 0; moved && turn < most_corrections; ++turn) {
    std::vector<Vector3d> ways;
    for (const ContactRow& row : rows)
      ways.push_back(to_world(to_world_space, Vector3d(moved->row(row.unknown).transpose())));
    auto better = problem.answer_to(rows, ways, contact.tolerance(), plate.matrix);
    if (!better) return fail(better.error());
    if (better->empty()) break;
    forces = *std::move(better);
    moved = moved_by(plate, contact, forces);
  }
  return moved;
}

Result<Field> settle_contact(StepContact& contact, Complementarity& problem,
                             const Balance& balance) {
  std::vector<Vector3d> forces;
  std::map<std::pair<int, int>, double> pressures;  // in the solve before
  Field end;
  const auto settle = [&](bool has_bounds) -> Result<void> {
    do {
      auto balanced = balance(
          has_bounds ? bounds_of(contact.rows(), pressures) : std::vector<double>(), forces);
      if (!balanced) return fail(balanced.error());
      end = *std::move(balanced);
    } while (contact.join(end));
    return {};
  };
  problem.begin_step();
  if (auto settled = settle(false); !settled) return fail(settled.error());
  constexpr int rounds = 3;
  for (int round = 0; round < rounds && has_friction(contact.rows()); ++round) {
    pressures = pressures_of(contact.rows(), forces);
    if (auto settled = settle(true); !settled) return fail(settled.error());
  }
  contact.end(forces);
  return end;
}

Result<void> step_with_contact(const ContactPlate& plate, Complementarity& problem, int number,
                               StepContact& contact, Motion& motion) {
  Field& w = motion.displacement;
  auto all = free_end(plate, motion);
  if (!all) return fail(all.error());
  Field next = all->topRows(w.rows());
  if (contact.begin(number, w, next)) {
    const auto balance = [&](const std::vector<double>& bounds,
                             std::vector<Vector3d>& forces) -> Result<Field> {
      const auto moved = pushed_by_contact(plate, problem, contact, bounds, forces);
      if (!moved) return fail(moved.error());
      return Field(all->topRows(w.rows()) + moved->topRows(w.rows()));
    };
    auto end = settle_contact(contact, problem, balance);
    if (!end) return fail(end.error());
    next = *std::move(end);
  } else {
    contact.end({});
  }
  motion.velocity = (next - w) / plate.dt;
  w = std::move(next);
  return {};
}

Result<bool> stands_without_contact(const ContactPlate& half, int number, StepContact& contact,
                                    Motion& motion) {
  const auto all = free_end(half, motion);
  if (!all) return fail(all.error());
  Field& w = motion.displacement;
  const auto end = all->topRows(w.rows());
  Field next = 2 * end - w;
  if (contact.begin(number, w, next)) return false;
  contact.end({});
  motion.velocity = 2 * (end - w) / half.dt - motion.velocity;
  w = std::move(next);
  return true;
}

}  // namespace pliant
