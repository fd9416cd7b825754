#pragma once

#include <optional>
#include <utility>

#include "pliant/timeline/curve.hpp"

namespace pliant {

/// A parameter over time with D components: one constant, or a curve.
template <int D>
class Channel {
 public:
  Channel(Value<D> constant = {});  // NOLINT: a constant is a channel
  Channel(Curve<D> curve);          // NOLINT: a curve is a channel
  Channel(double constant)          // NOLINT: a number is a channel
      requires(D == 1)
      : Channel(Value<D>{constant}) {}
  Channel(const Channel&);
  Channel(Channel&&) noexcept;
  Channel& operator=(const Channel&);
  Channel& operator=(Channel&&) noexcept;
  ~Channel();

  /// The value at a frame [unit]. Requires: finite.
  Value<D> at(double frame) const { return curve_ ? curve_->value(frame) : constant_; }

  bool is_animated() const { return curve_.has_value(); }

  /// The curve. Requires: is_animated().
  const Curve<D>& curve() const { return *curve_; }

  /// Adjusts its value at every frame. Requires: no component of a curve is adjusted already.
  void adjust(const Adjustments<D>& adjustments);

  /// What its curve is adjusted by; null: nothing, or it is constant.
  const Adjustments<D>* adjustments() const { return curve_ ? curve_->adjustments() : nullptr; }

  friend bool operator==(const Channel&, const Channel&) = default;

 private:
  Value<D> constant_ = {};
  std::optional<Curve<D>> curve_;
};

extern template class Channel<1>;
extern template class Channel<3>;

/// A switch over time: a channel whose curve steps between 0 (false) and 1 (true).
class Switch {
 public:
  Switch(bool constant) : channel_(constant ? 1.0 : 0.0) {}  // NOLINT: a boolean is a switch

  /// Keys with values 0 and 1 only, and steps only (Step, StepNext).
  Switch(Curve<1> curve) : channel_(std::move(curve)) {}  // NOLINT: a curve is a switch

  bool at(double frame) const { return channel_.at(frame)[0] != 0; }
  bool is_animated() const { return channel_.is_animated(); }
  const Channel<1>& channel() const { return channel_; }

  friend bool operator==(const Switch&, const Switch&) = default;

 private:
  Channel<1> channel_;
};

}  // namespace pliant
