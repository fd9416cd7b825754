#include "pliant/plate/contact/complementarity.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
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

// A place among others, in boxes of boxes: three bits tell in which eighth of its box it is, those
// of the largest box first.
constexpr int most_depth = 20;

std::uint64_t nested_boxes_of(const Vector3d& place, const Vector3d& corner, double size) {
  std::uint64_t boxes = 0;
  constexpr double sides = 1U << most_depth;
  std::uint32_t box[3];
  for (int k = 0; k < 3; ++k) {
    const double side = (place[k] - corner[k]) / size * sides;
    box[k] = static_cast<std::uint32_t>(std::clamp(side, 0.0, sides - 1));
  }
  for (int bit = most_depth; bit-- > 0;)
    for (const std::uint32_t side : box) boxes = boxes << 1U | (side >> bit & 1U);
  return boxes;
}

// The depth at which each row is the first one of its box, of nested ones around all.
std::vector<int> depths_of(const std::vector<ContactRow>& rows) {
  Vector3d corner = rows[0].place, end = corner;
  for (const ContactRow& row : rows) {
    corner = corner.cwiseMin(row.place);
    end = end.cwiseMax(row.place);
  }
  const double size = std::max((end - corner).maxCoeff(), std::numeric_limits<double>::min());
  std::vector<std::pair<std::uint64_t, std::size_t>> order;
  for (std::size_t k = 0; k < rows.size(); ++k)
    order.emplace_back(nested_boxes_of(rows[k].place, corner, size), k);
  std::ranges::sort(order);
  std::vector<int> depths(rows.size(), most_depth + 1);
  for (int depth = most_depth; depth >= 0; --depth) {
    const int bits = 3 * (most_depth - depth);
    for (std::size_t k = 0; k < order.size();) {
      std::size_t first = order[k].second;
      const std::uint64_t box = order[k].first >> bits;
      for (; k < order.size() && order[k].first >> bits == box; ++k)
        first = std::min(first, order[k].second);
      depths[first] = depth;
    }
  }
  return depths;
}

// What solves of many forces leave, as a part, until the sets are right, and then.
constexpr double rough = 1e-8, exact = 1e-12;

Vector3d part_across(const Vector3d& n, const Vector3d& way) { return way - dot_of(n, way) * n; }

Vector3d turned_across(const Vector3d& n, const Vector3d& along) {
  return {n[1] * along[2] - n[2] * along[1], n[2] * along[0] - n[0] * along[2],
          n[0] * along[1] - n[1] * along[0]};
}

}  // namespace

void Complementarity::begin_step() { before_.clear(); }

// Those that pushed in the solve before push at first. In the first solve of a step these are those
// that rested there and are needed; if most only lay there, as on what moved, those; if there are
// none, all that are needed. Whether nothing is known of which push.
bool Complementarity::begin(const std::vector<ContactRow>& rows,
                            const std::vector<double>& bounds) {
  const auto count = [&](bool ContactRow::*kind) {
    return std::ranges::count_if(
        rows, [&](const ContactRow& row) { return row.*kind && !row.sticks && row.lift > 0; });
  };
  const auto lying = count(&ContactRow::lies), resting = count(&ContactRow::rests);
  const bool some_lie = lying > 0, some_rest = resting > 0 && 2 * resting >= lying;
  pushes_.assign(rows.size(), false);
  friction_.assign(rows.size(), {});
  is_smooth_ = false;
  is_rough_ = true;
  forces_.assign(rows.size(), Vector3d::Zero());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto before = before_.find({rows[k].unknown, rows[k].collider});
    const bool is_needed =
        rows[k].lift > 0 && (some_rest ? rows[k].rests : rows[k].lies || !some_lie);
    pushes_[k] = rows[k].sticks || (before_.empty() ? is_needed : before != before_.end());
    if (bounds.empty() || rows[k].sticks) continue;
    if (before != before_.end()) friction_[k] = before->second;
    friction_[k].bound = bounds[k];
    if (bounds[k] == 0) friction_[k] = {};
  }
  return before_.empty() && !some_lie;
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
    if (is_smooth_ && friction.bound > 0) {
      const auto [one, other] = across(row.normal);
      for (const Vector3d& along : {one, other})
        add(k, false, along, friction.length / friction.bound);
    } else if (friction.slips) {
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

// On which the forces move the unknowns of all rows.
Result<std::vector<Vector3d>> Complementarity::ways(const std::vector<ContactRow>& rows,
                                                    const SolvedMatrix& plate) const {
  std::vector<PlacedVector> forces;
  std::vector<int> unknowns;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    unknowns.push_back(rows[k].unknown);
    if (!forces_[k].isZero(0)) forces.push_back({rows[k].unknown, forces_[k]});
  }
  return matrix_.ways(forces, unknowns, plate);
}

// Solves with what pushes and slips now.
Result<void> Complementarity::turn(const std::vector<ContactRow>& rows, const SolvedMatrix& plate) {
  list_parts(rows);
  if (auto factored = matrix_.factor(along_, plate); !factored) return factored;
  // The forces are those of the sets alone at last, whatever they were before.
  std::vector<double> start;
  for (std::size_t i = 0; i < parts_.size() && is_rough(); ++i)
    start.push_back(dot_of(along_[i].direction, forces_[parts_[i].row]));
  forces_.assign(rows.size(), Vector3d::Zero());
  bool slips = false;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (!friction_[k].slips) continue;
    forces_[k] = -friction_[k].bound * friction_[k].along;
    slips = true;
  }
  std::vector<double> right;
  for (std::size_t i = 0; i < parts_.size(); ++i) right.push_back(lift_of(rows, i));
  if (slips) {
    const auto moved = ways(rows, plate);
    if (!moved) return fail(moved.error());
    for (std::size_t i = 0; i < parts_.size(); ++i)
      right[i] -= dot_of(along_[i].direction, (*moved)[parts_[i].row]);
  }
  auto sizes = matrix_.solved(right, plate, is_rough() ? rough : exact, std::move(start));
  if (!sizes) return fail(sizes.error());
  sizes_ = *std::move(sizes);
  for (std::size_t i = 0; i < parts_.size(); ++i)
    forces_[parts_[i].row] += sizes_[i] * along_[i].direction;
  auto moved = ways(rows, plate);
  if (!moved) return fail(moved.error());
  ways_ = *std::move(moved);
  return {};
}

std::size_t Complementarity::pushing() const {
  return static_cast<std::size_t>(std::ranges::count(pushes_, true));
}

// Where many push, leaves out all rows but those of which the first `few` are spread over all that
// push: their set is soon found, and the plate that lies on them tells the set of more.
bool Complementarity::begin_with_few(const std::vector<ContactRow>& rows, std::size_t few) {
  constexpr std::size_t many = 400;
  if (pushing() <= many) return false;
  depths_ = depths_of(rows);
  std::vector<int> depths;  // of those that push
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (pushes_[k]) depths.push_back(depths_[k]);
  std::ranges::nth_element(depths, depths.begin() + static_cast<std::ptrdiff_t>(few));
  depth_ = depths[few];
  for (std::size_t k = 0; k < rows.size(); ++k)
    if (is_left_out(k) && !rows[k].sticks) pushes_[k] = false;
  return true;
}

// Adds rows as long as few are wrong; whether it did.
bool Complementarity::add_rows(const std::vector<ContactRow>& rows, double tolerance,
                               std::vector<std::size_t>& wrong) {
  bool is_more = false;
  while (!depths_.empty() && 50 * wrong.size() <= pushing()) {
    if (++depth_ > most_depth) depths_.clear();
    wrong = wrong_rows(rows, tolerance);
    is_more = true;
  }
  return is_more;
}

// Those that push the wrong way, and those that do not push and are not kept.
std::vector<std::size_t> Complementarity::wrong_rows(const std::vector<ContactRow>& rows,
                                                     double tolerance) const {
  double most = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i)
    if (parts_[i].is_normal) most = std::max(most, std::abs(sizes_[i]));
  double fine = tolerance;
  for (const Vector3d& way : ways_)
    if (is_rough()) fine = std::max(fine, 1e-6 * length_of(way));
  std::vector<std::size_t> wrong;
  std::size_t part = 0;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    while (part < parts_.size() && parts_[part].row < k) ++part;
    if (rows[k].sticks || is_left_out(k)) continue;
    if (pushes_[k]) {
      if (sizes_[part] < -(is_rough() ? 1e-6 : 1e-13) * most) wrong.push_back(k);
    } else if (rows[k].lift - dot_of(rows[k].normal, ways_[k]) > fine) {
      wrong.push_back(k);
    }
  }
  return wrong;
}

// Lets rows slip and hold as their forces and slips say; whether any changed.
bool Complementarity::update_friction(const std::vector<ContactRow>& rows, double tolerance) {
  bool changed = false;
  double fine = tolerance;  // what rounding may leave of a slip
  for (const Vector3d& way : ways_)
    fine = std::max(fine, (is_rough() ? 1e-6 : 1e-10) * length_of(way));
  for (std::size_t k = 0; k < rows.size(); ++k) {
    Friction& friction = friction_[k];
    if (!(friction.bound > 0)) continue;
    if (!friction.slips) {
      const Vector3d force = part_across(rows[k].normal, forces_[k]);
      const double size = length_of(force);
      if (!(size > friction.bound * (1 + (is_rough() ? 1e-6 : 1e-10)))) continue;
      friction = {friction.bound, true, -force / size, 0};
      changed = true;
      continue;
    }
    const Vector3d slip = part_across(rows[k].normal, rows[k].slip + ways_[k]);
    const double length = length_of(slip);
    if (!(dot_of(slip, friction.along) > 0)) {
      // Against its force, or not at all: it holds, or just begins to slip.
      if (length <= fine && friction.length == 0) continue;
      friction = {friction.bound};
      changed = true;
      continue;
    }
    const Vector3d along = slip / length;
    const bool is_same = length_of(along - friction.along) * friction.length <= fine &&
                         std::abs(length - friction.length) <= fine + 1e-9 * length;
    friction.along = along;
    friction.length = length;
    changed = changed || !is_same;
  }
  return changed;
}

// Friction as springs that are as strong as the slip of the turn before makes them: what is least
// then falls with each turn, if slowly, where Newton's method may go round. From there it goes on.
void Complementarity::smooth(const std::vector<ContactRow>& rows, bool goes_on) {
  for (std::size_t k = 0; k < rows.size(); ++k) {
    Friction& friction = friction_[k];
    if (!(friction.bound > 0)) continue;
    const Vector3d slip = part_across(rows[k].normal, rows[k].slip + ways_[k]);
    const double force = length_of(part_across(rows[k].normal, forces_[k]));
    friction.length = length_of(slip);
    friction.slips = !goes_on && friction.length > 0 && force > 0.999 * friction.bound;
    if (friction.slips) friction.along = slip / friction.length;
    if (!goes_on && !friction.slips) friction.length = 0;
  }
  is_smooth_ = goes_on;
}

// What the next solve of the step begins with.
void Complementarity::keep(const std::vector<ContactRow>& rows) {
  before_.clear();
  for (std::size_t k = 0; k < rows.size(); ++k) {
    if (pushes_[k]) before_.emplace(std::pair(rows[k].unknown, rows[k].collider), friction_[k]);
  }
}

Result<std::vector<Vector3d>> Complementarity::solve(const std::vector<ContactRow>& rows,
                                                     const std::vector<double>& bounds,
                                                     double tolerance, const SolvedMatrix& plate) {
  // Of pivots in blocks that leave no fewer wrong rows: a block that is too large is peeled ring by
  // ring, each larger than the one before. Then those that pull go before those that lack join.
  constexpr int patience = 40, most_patience = 400;
  constexpr int turns_of_newton = 40;  // that may be needed; then as many smooth ones
  constexpr std::size_t few = 50;
  depths_.clear();
  const bool is_new = begin(rows, bounds);
  int updates = 0;
  std::size_t fewest = std::numeric_limits<std::size_t>::max(), wrong_before = fewest;
  int waited = 0;
  // Single pivots end by themselves; the bound is far beyond what they need.
  const std::size_t most_turns = 1000 + 20 * rows.size();
  bool has_begun_with_few = !bounds.empty() || (is_new && begin_with_few(rows, few));
  for (std::size_t turns = 0; turns < most_turns; ++turns) {
    if (context_.is_stopped()) return interrupted();
    if (auto turned = turn(rows, plate); !turned) return fail(turned.error());
    std::vector<std::size_t> wrong = wrong_rows(rows, tolerance);
    // A set that is known is wrong at its border, if at all; blocks may soon mend that.
    const bool is_slow = 3 * wrong.size() > 2 * std::exchange(wrong_before, wrong.size());
    if (!has_begun_with_few && is_slow && 16 * wrong.size() > pushing()) {
      has_begun_with_few = true;
      if (begin_with_few(rows, 4 * wrong.size() > pushing() ? few : pushing() / 16)) continue;
    }
    if (add_rows(rows, tolerance, wrong)) {
      fewest = std::numeric_limits<std::size_t>::max();
      waited = 0;
    }
    if (wrong.empty()) {
      bool is_settled = true;
      if (!bounds.empty()) {
        fewest = std::numeric_limits<std::size_t>::max();
        waited = 0;
        const bool will_be_smooth = ++updates / turns_of_newton % 2 == 1;
        if (is_smooth_ || will_be_smooth) {
          smooth(rows, will_be_smooth);
          is_settled = false;
        } else {
          is_settled = !update_friction(rows, tolerance);
        }
      }
      if (!is_settled) continue;
      if (!is_rough()) {
        keep(rows);
        return forces_;
      }
      // All of it once more, as exactly as it can be; dense factors always are.
      is_rough_ = false;
      continue;
    }
    waited = wrong.size() < fewest ? 0 : waited + 1;
    fewest = std::min(fewest, wrong.size());
    const auto pulls = [&](std::size_t row) { return pushes_[row]; };
    if (waited > patience && std::ranges::any_of(wrong, pulls))
      std::erase_if(wrong, [&](std::size_t row) { return !pushes_[row]; });
    if (waited > most_patience) wrong.erase(wrong.begin() + 1, wrong.end());
    for (const std::size_t row : wrong) pushes_[row] = !pushes_[row];
    // What is left of a set that is nearly right is seen as exactly as it can be.
    constexpr std::size_t most_rough_turns = 100;
    if (bounds.empty() && depths_.empty())
      is_rough_ = 500 * wrong.size() > pushing() && turns < most_rough_turns;
  }
  return fail(
      ErrorCode::SolverFailed,
      fmt::format("the contact of {} nodes did not settle in {} turns", rows.size(), most_turns));
}

Result<std::vector<Vector3d>> Complementarity::answer_to(const std::vector<ContactRow>& rows,
                                                         const std::vector<Vector3d>& moved,
                                                         double tolerance,
                                                         const SolvedMatrix& plate) {
  std::vector<double> lack;
  double most = 0;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    lack.push_back(lift_of(rows, i) - dot_of(along_[i].direction, moved[parts_[i].row]) -
                   along_[i].give * sizes_[i]);
    most = std::max(most, std::abs(lack.back()));
  }
  if (!(most > tolerance)) return std::vector<Vector3d>();
  const auto more = matrix_.solved(lack, plate);
  if (!more) return fail(more.error());
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    sizes_[i] += (*more)[i];
    forces_[parts_[i].row] += (*more)[i] * along_[i].direction;
  }
  return forces_;
}

}  // namespace pliant
