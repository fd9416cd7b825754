#pragma once

#include <variant>

#include <pybind11/pybind11.h>

#include "pliant/timeline/channel.hpp"
#include "pliant/timeline/curve.hpp"
#include "pliant/timeline/position.hpp"

namespace pliant::python {

namespace py = pybind11;

class Module;

/// A curve of one or three components: the class `Curve`.
struct AnyCurve {
  std::variant<Curve<1>, Curve<3>> curve;

  friend bool operator==(const AnyCurve&, const AnyCurve&) = default;
};

/// A position that follows a path: the class `Path`.
struct PathPosition {
  PositionChannel position;  ///< has a path

  friend bool operator==(const PathPosition&, const PathPosition&) = default;
};

/// A number, or a tuple of three.
template <int D>
py::object value_object(const Value<D>& value) {
  if constexpr (D == 1)
    return py::float_(value[0]);
  else
    return py::make_tuple(value[0], value[1], value[2]);
}

/// What a channel reads back as: a curve, or its value.
template <int D>
py::object channel_object(const Channel<D>& channel) {
  if (channel.is_animated()) return py::cast(AnyCurve{channel.curve()});
  return value_object<D>(channel.at(0));
}
inline py::object channel_object(const Switch& channel) {
  if (channel.is_animated()) return channel_object(channel.channel());
  return py::bool_(channel.at(0));
}

/// Adds Curve, Path, and what reads and writes files of curves.
void add_curves(Module& module);

}  // namespace pliant::python
