#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <functional>
#include <vector>

#include "pliant/core/stop_request.hpp"
#include "pliant/timeline/key.hpp"

namespace pliant::exchange {

/// A function of the frame that is smooth over an interval, with its one-sided slopes, which may be
/// infinite.
template <int D>
struct SmoothFunction {
  std::function<Value<D>(double frame)> value;
  std::function<Value<D>(double frame)> slope_right;  ///< [unit/frame]
  std::function<Value<D>(double frame)> slope_left;
};

/// A cubic in time over an interval, by values and slopes at its ends.
template <int D>
struct FittedCubic {
  double start = 0;
  double end = 0;
  Value<D> from = {};
  Value<D> to = {};
  Value<D> from_slope = {};
  Value<D> to_slope = {};

  Value<D> at(double frame) const {
    const double length = end - start;
    const double q = (frame - start) / length;
    const double p = 1 - q;
    Value<D> value;
    for (int c = 0; c < D; ++c) {
      value[c] = p * p * (1 + 2 * q) * from[c] + q * q * (1 + 2 * p) * to[c] +
                 length * p * q * (p * from_slope[c] - q * to_slope[c]);
    }
    return value;
  }
};

template <int D>
struct Fit {
  std::vector<FittedCubic<D>> cubics;
  double deviation = 0;     ///< the largest of any component, at many frames [unit]
  bool is_complete = true;  ///< no more cubics were needed than are allowed
  bool is_close = true;     ///< none deviates by more than the tolerance and what rounding makes
  bool is_stopped = false;  ///< it was asked to stop: the rest means nothing
};

/// The most cubics that one interval becomes.
inline constexpr std::size_t most_fitted = 50'000;

/// Replaces a smooth function by cubics that have its values and slopes at their ends, by halving
/// an interval until each cubic deviates by at most `tolerance` or is shorter than two times
/// `shortest` frames. If `most` cubics do not suffice, those that deviate most are the ones that
/// were halved. The deviation is measured at 32 frames of each cubic, and the tolerance there is
/// 0.8 of the given one, but not less than what rounding makes of the values.
template <int D>
class Fitter {
 public:
  Fitter(const SmoothFunction<D>& function, double tolerance, double shortest,
         std::size_t most = most_fitted, const StopRequest& should_stop = {})
      : function_(function),
        tolerance_(tolerance),
        shortest_(shortest),
        most_(most),
        should_stop_(should_stop) {}

  Fit<D> fit(double start, double end) {
    add(start, end, function_.value(start), function_.value(end));
    for (std::size_t round = 0; !coarse_.empty() && coarse_.size() + fit_.cubics.size() < most_;
         ++round) {
      fit_.is_stopped = pliant::is_stopped(should_stop_, round);
      if (fit_.is_stopped) return std::move(fit_);
      std::pop_heap(coarse_.begin(), coarse_.end());
      const FittedCubic<D> whole = coarse_.back().cubic;
      coarse_.pop_back();
      const double middle = middle_of(whole);
      const Value<D> between = function_.value(middle);
      add(whole.start, middle, whole.from, between);
      add(middle, whole.end, between, whole.to);
    }
    fit_.is_complete = coarse_.empty();
    for (const Coarse& each : coarse_) keep(each.cubic, each.deviation);
    std::sort(fit_.cubics.begin(), fit_.cubics.end(),
              [](const auto& a, const auto& b) { return a.start < b.start; });
    return std::move(fit_);
  }

 private:
  /// A cubic that deviates too much and can be halved.
  struct Coarse {
    FittedCubic<D> cubic;
    double deviation = 0;

    friend bool operator<(const Coarse& a, const Coarse& b) { return a.deviation < b.deviation; }
  };

  static double rounding_of(const FittedCubic<D>& cubic) {
    double largest = 0;
    for (int c = 0; c < D; ++c)
      largest = std::max({largest, std::fabs(cubic.from[c]), std::fabs(cubic.to[c])});
    return 1e-13 * largest;
  }

  static double middle_of(const FittedCubic<D>& cubic) {
    return cubic.start + (cubic.end - cubic.start) / 2;
  }

  void keep(FittedCubic<D> cubic, double deviation) {
    const double allowed = std::max(tolerance_, rounding_of(cubic));
    if (deviation > allowed) {
      // Where the function is nearly vertical, its slope means nothing over a whole part.
      FittedCubic<D> line = cubic;
      for (int c = 0; c < D; ++c)
        line.from_slope[c] = line.to_slope[c] =
            (line.to[c] - line.from[c]) / (line.end - line.start);
      const double of_line = deviation_of(line);
      if (of_line < deviation) cubic = line, deviation = of_line;
    }
    fit_.is_close = fit_.is_close && deviation <= allowed;
    fit_.deviation = std::max(fit_.deviation, deviation);
    fit_.cubics.push_back(cubic);
  }

  void add(double start, double end, const Value<D>& from, const Value<D>& to) {
    FittedCubic<D> cubic{
        start, end, from, to, function_.slope_right(start), function_.slope_left(end)};
    for (int c = 0; c < D; ++c) {
      // No cubic is vertical: the straight line instead.
      const double secant = (to[c] - from[c]) / (end - start);
      if (!(std::fabs(cubic.from_slope[c]) < steepest)) cubic.from_slope[c] = secant;
      if (!(std::fabs(cubic.to_slope[c]) < steepest)) cubic.to_slope[c] = secant;
    }
    const double deviation = deviation_of(cubic);
    const double middle = middle_of(cubic);
    if (deviation <= std::max(0.8 * tolerance_, rounding_of(cubic)) ||
        end - start < 2 * shortest_ || middle <= start || middle >= end) {
      return keep(cubic, deviation);
    }
    coarse_.push_back({cubic, deviation});
    std::push_heap(coarse_.begin(), coarse_.end());
  }

  double deviation_of(const FittedCubic<D>& cubic) const {
    constexpr int parts = 33;
    double largest = 0;
    for (int k = 1; k < parts; ++k) {
      const double frame = cubic.start + (cubic.end - cubic.start) * k / parts;
      const Value<D> exact = function_.value(frame);
      const Value<D> fitted = cubic.at(frame);
      for (int c = 0; c < D; ++c) largest = std::max(largest, std::fabs(exact[c] - fitted[c]));
    }
    return largest;
  }

  static constexpr double steepest = 1e100;

  const SmoothFunction<D>& function_;
  double tolerance_;
  double shortest_;
  std::size_t most_;
  StopRequest should_stop_;
  std::vector<Coarse> coarse_;  // a heap; the first deviates most
  Fit<D> fit_;
};

}  // namespace pliant::exchange
