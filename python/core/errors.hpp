#pragma once

#include <string>
#include <utility>

#include <pybind11/pybind11.h>

#include "pliant/core/result.hpp"

namespace pliant::python {

namespace py = pybind11;

/// Classes of the package that the core makes objects of, by their names. Requires: the GIL.
py::object class_named(const char* name);

/// Tells the core of the package's classes, `name=class`.
void add_errors(py::module_& module);

/// A file's name or other text of the library, whose bytes that are no UTF-8 stand for themselves.
py::str name_text(const std::string& text);

/// The bytes of a text as `name_text` makes it.
std::string text_of(const py::handle& text);

/// A `Problem`; an empty file and line 0 become None.
py::object problem_object(const char* severity, const std::string& message, const std::string& file,
                          int line);

/// Raises the Python exception of an error, with all its problems. Requires: the GIL.
[[noreturn]] void raise(const Error& error);

/// Raises InvalidInput. Requires: the GIL.
[[noreturn]] inline void refuse(std::string message) {
  raise(Error{.message = std::move(message)});
}

/// Raises InvalidInput for what is wrong with a value named `what`. Requires: the GIL.
[[noreturn]] void raise(const std::string& what, const Complaint& complaint);

/// The value, or raises its error. Requires: the GIL.
template <class T>
T taken(Result<T>&& result) {
  if (!result) raise(result.error());
  if constexpr (!std::is_void_v<T>) return *std::move(result);
}

}  // namespace pliant::python
