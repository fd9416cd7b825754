#pragma once

#include <pybind11/pybind11.h>

#include "pliant/scene/scene.hpp"

namespace pliant::python {

namespace py = pybind11;

class Asking;
class Module;

/// The scene that a `pliant.Scene` says, with the places of the file that it was read from. Raises
/// TypeError for what is no scene. `owner`: the `Asking` of what will call its forces of Python.
/// Requires: the GIL.
Scene scene_of(const py::object& scene, Asking* owner = nullptr);

/// The `pliant.Scene` that says the same. Its forces of Python are those of `like` that have their
/// names. Requires: the GIL.
py::object python_scene(Scene scene, const py::object& like = py::none());

/// Adds what makes Python's classes of parts: `table()`, the rows of each.
void add_parts(Module& module);

}  // namespace pliant::python
