#include "custom.hpp"

#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <pybind11/numpy.h>

#include "arrays.hpp"
#include "call.hpp"
#include "errors.hpp"

namespace pliant::python {
namespace {

py::array points_array(std::span<const Vector3d> points) {
  py::array_t<double> array({static_cast<py::ssize_t>(points.size()), py::ssize_t{3}});
  std::copy_n(points.front().data(), 3 * points.size(), array.mutable_data());
  return view_of(array);
}

/// Calls a function for points, and copies its answer of `width` numbers a point.
void call(const Held& function, const std::string& name, const char* what,
          std::span<const Vector3d> points, const ForceTime& time, int width, double* to,
          const void* owner) {
  if (points.empty()) return;
  const Acquired acquired;
  const InCallback callback(owner);
  const py::object answer =
      (*function)(points_array(points), class_named("ForceTime")(time.frame, time.seconds));
  const py::array array = py::array::ensure(answer);
  if (!array) PyErr_Clear();
  const auto refuse = [&](const std::string& given) {
    throw py::value_error(
        fmt::format("force \"{}\": {} must return numbers of the shape ({},{}), not {}", name, what,
                    points.size(), width == 1 ? "" : " 3", given));
  };
  if (!array) refuse(std::string(py::repr(answer)));
  const char kind = array.dtype().kind();
  if (kind != 'f' && kind != 'i' && kind != 'u')
    refuse("of the dtype " + std::string(py::str(array.dtype())));
  if (array.ndim() != (width == 1 ? 1 : 2) ||
      array.shape(0) != static_cast<py::ssize_t>(points.size()) ||
      (width > 1 && array.shape(1) != width))
    refuse(std::string(py::str(array.attr("shape"))));
  const Numbers numbers(array);
  std::copy_n(numbers.data(), numbers.size(), to);
}

}  // namespace

CustomForce custom_force_of(const py::dict& values, Asking* owner) {
  const auto keep = [&](const py::object& function) {
    return owner == nullptr ? held(function) : owner->keep(function);
  };
  const std::string name = values["name"].cast<std::string>();
  CustomForce result{.key = values["key"].cast<std::string>()};
  result.unit_force = [name, owner, function = keep(values["force"])](
                          std::span<const Vector3d> points, const ForceTime& time,
                          std::span<Vector3d> forces) {
    if (!points.empty())
      call(function, name, "force", points, time, 3, forces.front().data(), owner);
  };
  const py::object distance = values["distance"];
  if (!distance.is_none())
    result.distance = [name, owner, function = keep(distance)](std::span<const Vector3d> points,
                                                               const ForceTime& time,
                                                               std::span<double> distances) {
      call(function, name, "distance", points, time, 1, distances.data(), owner);
    };
  return result;
}

}  // namespace pliant::python
