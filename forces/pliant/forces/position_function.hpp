#pragma once

#include <functional>
#include <span>
#include <type_traits>
#include <utility>

#include "pliant/core/field.hpp"

namespace pliant {

/// A function of a position that a program gives: of one, or of many in one call. Made of either
///   Value f(const Vector3d& p, Also...)
///   void f(std::span<const Vector3d> points, Also..., std::span<Value> values)
/// where `values` has a place for each of `points`, and the value at a point depends on that point
/// and `Also` alone. Called for many in both cases.
template <class Value, class... Also>
class PositionFunction {
 public:
  using OfOne = std::function<Value(const Vector3d& p, Also...)>;
  using OfMany = std::function<void(std::span<const Vector3d> points, Also..., std::span<Value>)>;

  /// Empty, and so if made of an empty function.
  PositionFunction() = default;

  template <class F>
  requires(!std::is_same_v<F, PositionFunction> &&
           (std::is_constructible_v<OfMany, F> || std::is_constructible_v<OfOne, F>))
      PositionFunction(F function) {
    if constexpr (std::is_constructible_v<OfMany, F>) {
      of_many_ = std::move(function);
      is_of_many_ = true;
    } else if (OfOne of_one = std::move(function)) {
      of_many_ = [of_one = std::move(of_one)](std::span<const Vector3d> points, Also... also,
                                              std::span<Value> values) {
        for (std::size_t k = 0; k < points.size(); ++k) values[k] = of_one(points[k], also...);
      };
    }
  }

  explicit operator bool() const { return static_cast<bool>(of_many_); }

  /// Whether it was made of a function of many positions.
  bool is_of_many() const { return is_of_many_; }

  /// Requires: it is not empty; as many values as points.
  void operator()(std::span<const Vector3d> points, Also... also, std::span<Value> values) const {
    of_many_(points, also..., values);
  }

 private:
  OfMany of_many_;
  bool is_of_many_ = false;
};

}  // namespace pliant
