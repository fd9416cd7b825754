#include <cmath>
#include <cstddef>
#include <optional>

#include "pliant/timeline/tangents.hpp"

namespace pliant::timeline {

namespace {

/// One unknown slope and its equation: before m[i-1] + diagonal m[i] + after m[i+1] = right.
struct Unknown {
  double before = 0;
  double diagonal = 1;
  double after = 0;
  double right = 0;
  double slope = 0;
  bool is_fixed = false;
  bool is_capped = false;
  KeyPolyline::Corner corner;

  void fix(double value) {
    before = after = 0;
    diagonal = 1;
    right = slope = value;
    is_fixed = true;
  }
};

/// Elimination without pivoting: the rows are diagonally dominant. `right` becomes the solution.
void solve_chain(const std::vector<Unknown>& rows, std::vector<double> diagonal,
                 std::vector<double>& right) {
  for (std::size_t i = 1; i < rows.size(); ++i) {
    const double factor = rows[i].before / diagonal[i - 1];
    diagonal[i] -= factor * rows[i - 1].after;
    right[i] -= factor * right[i - 1];
  }
  right.back() /= diagonal.back();
  for (std::size_t i = rows.size() - 1; i-- > 0;) {
    right[i] = (right[i] - rows[i].after * right[i + 1]) / diagonal[i];
  }
}

/// A chain whose ends may also be coupled: `before` of the first row refers to the last unknown,
/// `after` of the last row to the first one. The corners are handled by the Sherman-Morrison
/// formula.
void solve_ring(std::vector<Unknown>& rows) {
  const std::size_t count = rows.size();
  if (count == 1) {
    Unknown& only = rows.front();
    only.slope = only.right / (only.diagonal + only.before + only.after);
    return;
  }
  if (count == 2) {  // both neighbours are the other unknown
    const double a = rows[0].diagonal;
    const double b = rows[0].before + rows[0].after;
    const double c = rows[1].before + rows[1].after;
    const double d = rows[1].diagonal;
    const double determinant = a * d - b * c;
    const double first = (rows[0].right * d - b * rows[1].right) / determinant;
    rows[1].slope = (a * rows[1].right - c * rows[0].right) / determinant;
    rows[0].slope = first;
    return;
  }
  std::vector<double> diagonal;
  std::vector<double> right;
  for (const Unknown& row : rows) {
    diagonal.push_back(row.diagonal);
    right.push_back(row.right);
  }
  const double top = rows.front().before;
  const double bottom = rows.back().after;
  if (top == 0 && bottom == 0) {
    solve_chain(rows, diagonal, right);
    for (std::size_t i = 0; i < count; ++i) rows[i].slope = right[i];
    return;
  }
  const double pivot = -diagonal.front();
  diagonal.front() -= pivot;
  diagonal.back() -= top * bottom / pivot;
  std::vector<double> corner(count, 0.0);
  corner.front() = pivot;
  corner.back() = bottom;
  solve_chain(rows, diagonal, right);
  solve_chain(rows, diagonal, corner);
  const double factor = (right.front() + top * right.back() / pivot) /
                        (1 + corner.front() + top * corner.back() / pivot);
  for (std::size_t i = 0; i < count; ++i) rows[i].slope = right[i] - factor * corner[i];
}

class System {
 public:
  System(const KeyPolyline& polyline, const SmoothSides& sides, Slopes& slopes)
      : course_(polyline), sides_(sides), slopes_(slopes) {
    const std::size_t keys = polyline.size();
    in_.resize(keys);
    out_.resize(keys);
    // In the order of the keys, so that neighbours in time are neighbours among the unknowns; an
    // `in` side at the seam of a periodic curve that has its own unknown is last.
    for (std::size_t k = 0; k < keys; ++k) add_unknowns(k);
    for (std::size_t k = 0; k < keys; ++k) write_equations(k);
  }

  void solve(const StopRequest& should_stop) {
    if (unknowns_.empty()) return;
    do {
      solve_ring(unknowns_);
      slopes_.is_stopped = is_stopped(should_stop);
    } while (!slopes_.is_stopped && fix_what_overshoots());
  }

  void store() {
    for (std::size_t k = 0; k < course_.size(); ++k) {
      if (in_[k]) slopes_.in[k] = unknowns_[*in_[k]].slope;
      if (out_[k]) slopes_.out[k] = unknowns_[*out_[k]].slope;
    }
    // A side that no solved segment reads (outside the curve, or beside a step) has the slope of
    // the other.
    for (std::size_t k = 0; k < course_.size(); ++k) {
      const std::size_t other = seam(k);
      if (sides_.in[k] != SmoothKind::None && !in_[k]) {
        slopes_.in[k] = k == 0 && other != k ? slopes_.in[other] : slopes_.out[k];
      }
      if (sides_.out[k] != SmoothKind::None && !out_[k]) {
        slopes_.out[k] = k != 0 && other != k ? slopes_.out[other] : slopes_.in[k];
      }
    }
  }

 private:
  std::size_t last() const { return course_.size() - 1; }

  /// The key at the same place in time: the other end of a periodic curve, or the key itself.
  std::size_t seam(std::size_t key) const {
    if (!course_.is_periodic || (key != 0 && key != last())) return key;
    return last() - key;
  }
  /// The key whose `in` side ends where the `out` side of `key` starts.
  std::size_t arriving(std::size_t key) const { return key == 0 ? seam(key) : key; }

  bool solves_in(std::size_t key) const {
    return key > 0 && sides_.in[key] != SmoothKind::None && course_.is_bezier[key - 1];
  }
  bool solves_out(std::size_t key) const {
    return key < last() && sides_.out[key] != SmoothKind::None && course_.is_bezier[key];
  }
  bool joins(std::size_t arriving_key, std::size_t leaving_key) const {
    return solves_in(arriving_key) && solves_out(leaving_key) && !course_.jumps[leaving_key];
  }

  std::size_t add_unknown(bool is_capped) {
    unknowns_.emplace_back();
    unknowns_.back().is_capped = is_capped;
    return unknowns_.size() - 1;
  }

  void add_unknowns(std::size_t key) {
    const bool capped_in = sides_.in[key] == SmoothKind::Capped;
    const bool capped_out = sides_.out[key] == SmoothKind::Capped;
    if (course_.is_periodic && key == last()) {
      if (joins(key, 0)) {
        in_[key] = out_[0];
        if (capped_in) unknowns_[*out_[0]].is_capped = true;
        return;
      }
    }
    if (solves_in(key)) in_[key] = add_unknown(capped_in);
    if (!solves_out(key)) return;
    if (joins(key, key)) {
      out_[key] = in_[key];
      if (capped_out) unknowns_[*in_[key]].is_capped = true;
    } else {
      out_[key] = add_unknown(capped_out);
    }
  }

  void write_equations(std::size_t key) {
    const bool is_seam_end = course_.is_periodic && key == last() && key != 0;
    if (in_[key] && in_[key] != out_[key] && !(is_seam_end && in_[key] == out_[0])) {
      write_natural(key, false);
    }
    if (!out_[key]) return;
    const std::size_t from = arriving(key);
    if (in_[from] == out_[key]) {
      write_joint(from, key);
    } else {
      write_natural(key, true);
    }
  }

  /// Eq. 11, scaled so that its weights sum to one.
  void write_joint(std::size_t arriving_key, std::size_t key) {
    Unknown& row = unknowns_[*out_[key]];
    row.corner = course_.at(key, true);
    const KeyPolyline::Corner& corner = row.corner;
    const double lengths = corner.length_before + corner.length_after;
    const double before = corner.length_after / lengths;
    const double after = corner.length_before / lengths;
    row.diagonal = 2;
    row.right = 3 * (before * corner.secant_before + after * corner.secant_after);
    couple_before(row, arriving_key - 1, before);
    couple_after(row, key + 1, after);
    if (row.is_capped && corner.is_extremum()) row.fix(0);
  }

  /// Eq. 12 at an end of a run; slope 0 if the key's other side is flat.
  void write_natural(std::size_t key, bool is_out) {
    Unknown& row = unknowns_[is_out ? *out_[key] : *in_[key]];
    row.corner = course_.at(key, is_out);
    row.diagonal = 2;
    if (is_out) {
      row.right = 3 * course_.secants[key];
      couple_after(row, key + 1, 1);
    } else {
      row.right = 3 * course_.secants[key - 1];
      couple_before(row, key - 1, 1);
    }
    const bool is_flat = meets_flat_side(key, is_out);
    if (is_flat || (row.is_capped && row.corner.is_extremum())) row.fix(0);
  }

  bool meets_flat_side(std::size_t key, bool is_out) const {
    if (course_.jumps[key]) return false;
    const std::size_t other = is_out ? arriving(key) : (key == last() ? seam(key) : key);
    if (is_out) {
      return other > 0 && course_.is_bezier[other - 1] && sides_.in[other] == SmoothKind::None &&
             slopes_.in[other] == 0;
    }
    return other < last() && course_.is_bezier[other] && sides_.out[other] == SmoothKind::None &&
           slopes_.out[other] == 0;
  }

  /// The slope at the start of the segment before: an unknown, or given by another kind.
  void couple_before(Unknown& row, std::size_t key, double weight) {
    if (out_[key]) {
      row.before = weight;
    } else {
      row.right -= weight * slopes_.out[key];
    }
  }
  void couple_after(Unknown& row, std::size_t key, double weight) {
    if (in_[key]) {
      row.after = weight;
    } else {
      row.right -= weight * slopes_.in[key];
    }
  }

  /// Eq. 13 on all unknowns at once. Returns whether any was fixed, so that the others must be
  /// solved again.
  bool fix_what_overshoots() {
    bool has_fixed = false;
    for (Unknown& unknown : unknowns_) {
      if (unknown.is_fixed || !unknown.is_capped) continue;
      const KeyPolyline::Corner& corner = unknown.corner;
      const double slope = unknown.slope;
      const bool opposes = (corner.has_before && opposite(slope, corner.secant_before)) ||
                           (corner.has_after && opposite(slope, corner.secant_after));
      const double cap = corner.cap();
      if (opposes) {
        unknown.fix(0);
      } else if (std::fabs(slope) > cap) {
        unknown.fix(std::copysign(cap, slope));
      } else {
        continue;
      }
      has_fixed = true;
    }
    return has_fixed;
  }

  static bool opposite(double a, double b) { return (a > 0 && b < 0) || (a < 0 && b > 0); }

  const KeyPolyline& course_;
  const SmoothSides& sides_;
  Slopes& slopes_;
  std::vector<Unknown> unknowns_;
  std::vector<std::optional<std::size_t>> in_;  // the unknown of each key's `in` side
  std::vector<std::optional<std::size_t>> out_;
};

}  // namespace

void solve_smooth_tangents(const KeyPolyline& polyline, const SmoothSides& sides, Slopes& slopes,
                           const StopRequest& should_stop) {
  System system(polyline, sides, slopes);
  system.solve(should_stop);
  system.store();
}

}  // namespace pliant::timeline
