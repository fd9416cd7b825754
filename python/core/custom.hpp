#pragma once

#include <pybind11/pybind11.h>

#include "pliant/scene/scene.hpp"

namespace pliant::python {

namespace py = pybind11;

class Asking;

/// The force of a `pliant.Custom` with these values. `owner` keeps its functions, and they must not
/// call it again; null: nothing does.
CustomForce custom_force_of(const py::dict& values, Asking* owner);

}  // namespace pliant::python
