#pragma once

#include <memory>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include "pliant/core/field.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant::python {

namespace py = pybind11;

class Module;

/// Numbers as they are in memory, row by row; a copy of what is none.
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// A mesh that nothing changes: the class `Mesh`. Copies share it.
struct SharedMesh {
  std::shared_ptr<const Mesh> mesh;

  friend bool operator==(const SharedMesh& a, const SharedMesh& b) {
    return a.mesh == b.mesh || *a.mesh == *b.mesh;
  }
};

/// A read-only array of memory that `owner` keeps alive.
py::array view_of(py::array array, const py::object& owner = {});

/// A field as an array that is read-only, and keeps `owner` alive, whose memory it is.
py::array view_of(const Field& field, const py::object& owner);

/// A copy as a read-only array (n, 3).
py::array copy_of(const Field& field);

/// An array of real numbers. Raises TypeError naming `what`.
py::array array_of(const py::handle& given, const char* what);

/// Frames, a number or an array (n,), all finite. Raises TypeError or ValueError.
py::array_t<double> frames_of(const py::handle& given);

/// The rows of an array (n, 3) of numbers. Raises InvalidInput naming `what`.
Field field_of(const py::handle& array, const char* what);

/// The numbers of an array, row by row.
std::vector<double> numbers_of(const py::handle& array);

/// Adds Mesh and read_mesh.
void add_arrays(Module& module);

}  // namespace pliant::python
