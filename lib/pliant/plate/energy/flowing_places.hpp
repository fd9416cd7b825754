#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pliant/plate/energy/plastic_steps.hpp"
#include "pliant/plate/kernels/kernels.hpp"

namespace pliant {

/// The places of a plate that flow or may, and the unknowns they depend on: all that a step needs
/// to know but the solve. Numbers are those on the unknowns of the places, ascending, of one
/// component at work after the other. Internal to plate.
class FlowingPlaces {
 public:
  using Numbers = std::vector<double>;

  /// `places` ascending; `components` at work; `unknowns` is their number in the whole plate.
  FlowingPlaces(FlowingPlate& plate, const PlateKernels& kernels, std::vector<int> places,
                std::vector<int> components, Eigen::Index unknowns);

  const std::vector<int>& places() const { return places_; }

  /// The unknowns that they depend on.
  std::span<const UnknownRun> runs() const { return spans_; }

  Numbers zero() const { return Numbers(components_.size() * pitch(), 0.0); }

  /// The longest of the numbers on the unknowns of the plate from `first` to before `last`.
  double longest(const Numbers& numbers, Eigen::Index first, Eigen::Index last) const;

  /// Numbers on the unknowns of fewer places.
  Numbers taken_over(const FlowingPlaces& earlier, const Numbers& numbers) const;

  void take_from(const Field& all, Numbers& own) const;
  void add_to(Field& all, const Numbers& own) const;
  /// Sets what `add_to` changes to 0.
  void clear_in(Field& all) const;

  /// The plastic curvatures from which a step begins.
  void begin(const PlasticField& from);

  /// Goes to displacements x. What then flows: the return mapping, eq. (8j). `forces` are those of
  /// the growth of the plastic curvatures.
  void go_to(const Numbers& x, Numbers& forces);

  /// Looks along a way from there. way . (how these forces change along it).
  double look_along(const Numbers& way);

  /// The forces after so much of the way.
  void flow_after(double part, Numbers& forces);

  /// Goes as far as `flow_after` was asked last.
  void go() { xi_.swap(there_); }

  bool is_flowing() const { return flowing_ > 0; }

  /// Adds `part` times how the plastic curvatures grow where `flow_after` was asked last.
  void grow(PlasticField& plastic, double part) const;

 private:
  void make_runs(const PlaceRows& rows);
  std::size_t pitch() const { return static_cast<std::size_t>(view_.unknowns); }
  template <class F>
  void for_each_span(const F& f) const;

  const PlateKernels& kernels_;
  std::vector<int> places_, components_;
  std::vector<int> unknowns_;      // of the plate
  std::vector<UnknownRun> spans_;  // of these
  std::vector<PlaceCurvatures> held_;
  std::vector<double> shares_;  // 1 + H of each place
  std::vector<FlowRun> runs_;
  std::vector<FlowTerm> terms_;
  std::vector<FlowLaw> laws_;
  FlowView view_;
  Numbers stress_, xi_, change_, there_;  // xi of x = 0; where it is; what the way changes
  Numbers tangent_, work_;
  long flowing_ = 0;
};

}  // namespace pliant
