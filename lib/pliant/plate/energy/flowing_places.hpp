#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "pliant/plate/energy/plastic_steps.hpp"

namespace pliant {

/// The places of a plate that flow or may, and the unknowns they depend on: all that Newton's
/// method needs to know in a step but the solve. `N` components are at work, 1 or 3. Numbers on the
/// unknowns are side by side, N for each; the last ones, of what is held, are 0. Internal to plate.
template <std::size_t N>
class FlowingPlaces {
 public:
  using Numbers = std::vector<double>;
  using Curvatures = std::array<double, 3 * N>;
  using Growth = std::vector<Curvatures>;

  /// `places` ascending; the first N of `components` are those at work; `unknowns` is their number
  /// in the whole plate.
  FlowingPlaces(FlowingPlate& plate, std::vector<int> places, std::array<int, 3> components,
                Eigen::Index unknowns)
      : places_(std::move(places)),
        components_(components),
        all_(unknowns),
        rows_(plate.rows_of(places_)),
        stress_(places_.size()),
        xi_(places_.size()),
        change_(places_.size()),
        growth_(places_.size()) {
    std::vector<int> numbers(static_cast<std::size_t>(unknowns), -1);
    for (const int unknown : rows_.unknowns) {
      if (unknown >= 0) numbers[unknown] = 0;
    }
    for (int unknown = 0; unknown < static_cast<int>(unknowns); ++unknown) {
      if (numbers[unknown] < 0) continue;
      numbers[unknown] = static_cast<int>(unknowns_.size());
      unknowns_.push_back(unknown);
    }
    for (int& unknown : rows_.unknowns)
      unknown = unknown < 0 ? static_cast<int>(unknowns_.size()) : numbers[unknown];
  }

  const std::vector<int>& places() const { return places_; }

  /// The unknowns of the plate, ascending.
  const std::vector<int>& unknowns() const { return unknowns_; }
  Eigen::Index all_unknowns() const { return all_; }

  Numbers zero() const { return Numbers((unknowns_.size() + 1) * N, 0.0); }

  /// Numbers on the unknowns, or growths, of fewer places.
  Numbers taken_over(const FlowingPlaces& earlier, const Numbers& numbers) const {
    Numbers own = zero();
    std::size_t at = 0;
    for (std::size_t k = 0; k < earlier.unknowns_.size(); ++k) {
      while (unknowns_[at] < earlier.unknowns_[k]) ++at;
      for (std::size_t n = 0; n < N; ++n) own[at * N + n] = numbers[k * N + n];
    }
    return own;
  }
  Growth taken_over(const FlowingPlaces& earlier, const Growth& growth) const {
    Growth own(places_.size(), Curvatures{});
    std::size_t at = 0;
    for (std::size_t k = 0; k < earlier.places_.size(); ++k) {
      while (places_[at] < earlier.places_[k]) ++at;
      own[at] = growth[k];
    }
    return own;
  }

  Numbers taken_from(const Field& all) const {
    Numbers own = zero();
    for (std::size_t n = 0; n < N; ++n) {
      const double* const from = all.col(components_[n]).data();
      for (std::size_t k = 0; k < unknowns_.size(); ++k) own[k * N + n] = from[unknowns_[k]];
    }
    return own;
  }

  void add_to(Field& all, const Numbers& own) const {
    for (std::size_t n = 0; n < N; ++n) {
      double* const to = all.col(components_[n]).data();
      for (std::size_t k = 0; k < unknowns_.size(); ++k) to[unknowns_[k]] += own[k * N + n];
    }
  }

  /// Sets what `add_to` changes to 0.
  void clear_in(Field& all) const {
    for (std::size_t n = 0; n < N; ++n) {
      double* const to = all.col(components_[n]).data();
      for (const int unknown : unknowns_) to[unknown] = 0;
    }
  }

  /// The plastic curvatures from which a step begins.
  void begin(const PlasticField& from) {
    for (std::size_t k = 0; k < places_.size(); ++k) {
      const double share = 1 + pattern(k).law.hardening;
      for (std::size_t n = 0; n < 3 * N; ++n)
        stress_[k][n] = rows_.held[k][column(n)] - share * from(places_[k], column(n));
    }
  }

  /// Goes to displacements x. What then flows: the return mapping, eq. (8j). The forces of the
  /// growth of the plastic curvatures.
  Numbers go_to(const Numbers& x) {
    for (std::size_t k = 0; k < places_.size(); ++k) {
      xi_[k] = curvatures(k, x);
      for (std::size_t n = 0; n < 3 * N; ++n) xi_[k][n] += stress_[k][n];
      change_[k] = {};
    }
    return flow_after(0);
  }

  /// Looks along a way from there. way . (how these forces change along it).
  double look_along(const Numbers& way) {
    for (std::size_t k = 0; k < places_.size(); ++k) change_[k] = curvatures(k, way);
    double sum = 0;
    for (const Flowing& one : flowing_) {
      const PlaceRows::Pattern& own = pattern(one.place);
      const Curvatures moments = moments_of(own.form, change_[one.place]);
      double along = 0, whole = 0;
      for (std::size_t n = 0; n < 3 * N; ++n) {
        along += xi_[one.place][n] * moments[n];
        whole += change_[one.place][n] * moments[n];
      }
      sum += own.area * (one.whole * whole + one.along * along * along);
    }
    return sum;
  }

  /// The forces after so much of the way.
  Numbers flow_after(double part) {
    Numbers forces = zero();
    std::size_t count = 0;
    flowing_.resize(places_.size());
    for (std::size_t k = 0; k < places_.size(); ++k) {
      const PlaceRows::Pattern& own = pattern(k);
      Curvatures xi = xi_[k];
      for (std::size_t n = 0; n < 3 * N; ++n) xi[n] += part * change_[k][n];
      const double squared = product_of(own.form, xi, xi);
      growth_[k] = {};
      if (!(squared > own.law.yield * own.law.yield)) continue;
      const double share = 1 / (1 + own.law.hardening);
      const double bound = share * own.law.yield / std::sqrt(squared);
      const double whole = share - bound;
      for (std::size_t n = 0; n < 3 * N; ++n) growth_[k][n] = whole * xi[n];
      add_forces(k, growth_[k], forces);
      flowing_[count++] = {k, whole, bound / squared};
    }
    flowing_.resize(count);
    leave_held(forces);
    return forces;
  }

  /// Goes so much of the way. Requires: `flow_after` was asked last for that.
  void go(double part) {
    for (std::size_t k = 0; k < places_.size(); ++k) {
      for (std::size_t n = 0; n < 3 * N; ++n) xi_[k][n] += part * change_[k][n];
    }
  }

  bool is_flowing() const { return !flowing_.empty(); }

  /// How the plastic curvatures of the places grow, where it is.
  const Growth& growth() const { return growth_; }

  Numbers forces_of(const Growth& growth) const {
    Numbers forces = zero();
    for (std::size_t k = 0; k < places_.size(); ++k) {
      if (growth[k] != Curvatures{}) add_forces(k, growth[k], forces);
    }
    leave_held(forces);
    return forces;
  }

  /// Adds `part` times the growth.
  void grow(PlasticField& plastic, double part) const {
    for (const Flowing& one : flowing_) {
      for (std::size_t n = 0; n < 3 * N; ++n)
        plastic(places_[one.place], column(n)) += part * growth_[one.place][n];
    }
  }

 private:
  // As its curvatures change by dk, the plastic ones change by whole dk + along xi (xi . C dk).
  struct Flowing {
    std::size_t place = 0;
    double whole = 0, along = 0;
  };

  const PlaceRows::Pattern& pattern(std::size_t place) const {
    return rows_.patterns[static_cast<std::size_t>(rows_.pattern_of[place])];
  }

  int column(std::size_t n) const { return static_cast<int>(n / N) * 3 + components_[n % N]; }

  Curvatures curvatures(std::size_t place, const Numbers& x) const {
    Curvatures k = {};
    const int* unknown = rows_.unknowns.data() + rows_.starts[place];
    for (const std::array<double, 3>& by : pattern(place).by) {
      const double* const at = x.data() + N * static_cast<std::size_t>(*unknown++);
      for (std::size_t n = 0; n < N; ++n) {
        k[n] += by[0] * at[n];
        k[N + n] += by[1] * at[n];
        k[2 * N + n] += by[2] * at[n];
      }
    }
    return k;
  }

  void add_forces(std::size_t place, const Curvatures& k, Numbers& forces) const {
    const PlaceRows::Pattern& own = pattern(place);
    Curvatures m = moments_of(own.form, k);
    for (double& moment : m) moment *= own.area;
    const int* unknown = rows_.unknowns.data() + rows_.starts[place];
    for (const std::array<double, 3>& by : own.by) {
      double* const at = forces.data() + N * static_cast<std::size_t>(*unknown++);
      for (std::size_t n = 0; n < N; ++n)
        at[n] += by[0] * m[n] + by[1] * m[N + n] + by[2] * m[2 * N + n];
    }
  }

  static void leave_held(Numbers& forces) {
    for (std::size_t n = 1; n <= N; ++n) forces[forces.size() - n] = 0;
  }

  std::vector<int> places_;
  std::array<int, 3> components_;
  Eigen::Index all_;
  PlaceRows rows_;
  std::vector<int> unknowns_;
  Growth stress_, xi_, change_;  // xi of x = 0; where it is; what the way changes
  Growth growth_;
  std::vector<Flowing> flowing_;
};

}  // namespace pliant
