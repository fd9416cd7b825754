#include "errors.hpp"

#include <chrono>
#include <thread>
#include <vector>

#include <pthread.h>

#include "call.hpp"

namespace pliant::python {
namespace {

// Never destroyed: the interpreter is gone by then.
py::dict& classes() {
  static auto* const all = new py::dict;  // NOLINT
  return *all;
}

const char* name_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::InvalidInput:
      return "InvalidInput";
    case ErrorCode::Unreadable:
      return "Unreadable";
    case ErrorCode::Unwritable:
      return "Unwritable";
    case ErrorCode::OutOfMemory:
      return "OutOfMemory";
    case ErrorCode::SolverFailed:
      return "SolverFailed";
    case ErrorCode::NotFinite:
      return "NotFinite";
    case ErrorCode::Interrupted:
      return "Interrupted";
  }
  return "Error";
}

py::object problem_of(const Error& error) {
  return problem_object("error", error.message, error.file, error.line);
}

/// What a function of Python made, or its exception.
py::object owned(PyObject* made) {
  if (made == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::object>(made);
}

py::str decoded(const std::string& text, const char* others) {
  return owned(PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), others));
}

}  // namespace

py::object class_named(const char* name) { return classes()[name]; }

py::str name_text(const std::string& text) { return decoded(text, "surrogateescape"); }

std::string text_of(const py::handle& text) {
  return py::bytes(owned(PyUnicode_AsEncodedString(text.ptr(), "utf-8", "surrogateescape")));
}

py::object problem_object(const char* severity, const std::string& message, const std::string& file,
                          int line) {
  return class_named("Problem")(severity, decoded(message, "backslashreplace"),
                                file.empty() ? py::object(py::none()) : name_text(file),
                                line == 0 ? py::object(py::none()) : py::int_(line));
}

void raise(const Error& error) {
  py::list problems;
  problems.append(problem_of(error));
  for (const Error& other : error.others) problems.append(problem_of(other));
  const py::object type = class_named(name_of(error.code));
  const py::object exception = type(py::tuple(problems));
  PyErr_SetObject(type.ptr(), exception.ptr());
  throw py::error_already_set();
}

void raise(const std::string& what, const Complaint& complaint) {
  raise(Error{.code = complaint.kind == Complaint::Kind::Interrupted ? ErrorCode::Interrupted
                                                                     : ErrorCode::InvalidInput,
              .message = what + ": " + complaint.message});
}

void add_errors(py::module_& module) {
  // Values that were accepted where they came in, but are of another type than is needed.
  py::register_local_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const py::cast_error&) {
      PyErr_SetString(PyExc_TypeError, "an argument has a wrong type");
    }
  });
  pthread_atfork(nullptr, nullptr, Exit::keep_this_thread);
  module.def("end", [] {
    Exit::ending_thread = std::this_thread::get_id();
    Exit::has_begun = true;
    const py::gil_scoped_release released;
    const auto latest = std::chrono::steady_clock::now() + std::chrono::seconds(10);
    while (Exit::has_threads_inside() && std::chrono::steady_clock::now() < latest)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  module.def("register", [](const py::kwargs& named) {
    for (const auto& [name, type] : named) classes()[name] = type;
  });
}

}  // namespace pliant::python
