#pragma once

#include <pybind11/pybind11.h>

#include "call.hpp"

namespace pliant::python {

/// The native object of an instance; null while it is made and after its end.
template <class Native>
Native* native_of(PyObject* self) {
  auto* const instance = reinterpret_cast<py::detail::instance*>(self);
  if (!instance->owned) return nullptr;  // its places are not there yet
  auto held = instance->get_value_and_holder();
  return held.holder_constructed() ? static_cast<Native*>(held.value_ptr()) : nullptr;
}

/// For a class whose functions of Python may refer to their own object: the collector of garbage
/// sees the functions of its `asking`, and its `objects()`.
template <class Native>
py::custom_type_setup collected() {
  return py::custom_type_setup([](PyHeapTypeObject* heap_type) {
    PyTypeObject& type = heap_type->ht_type;
    type.tp_flags |= Py_TPFLAGS_HAVE_GC;
    type.tp_traverse = [](PyObject* self, visitproc visit, void* arg) -> int {
      Py_VISIT(Py_TYPE(self));
      auto* const own = native_of<Native>(self);
      if (own == nullptr) return 0;
      for (const Held& function : own->asking->functions()) Py_VISIT(function->ptr());
      for (const py::object* const object : own->objects()) Py_VISIT(object->ptr());
      return 0;
    };
    type.tp_clear = [](PyObject* self) -> int {
      if (auto* const own = native_of<Native>(self)) {
        own->asking->let_go();
        for (py::object* const object : own->objects()) *object = py::none();
      }
      return 0;
    };
    type.tp_dealloc = [](PyObject* self) {
      PyObject_GC_UnTrack(self);
      py::detail::pybind11_object_dealloc(self);
    };
  });
}

}  // namespace pliant::python
