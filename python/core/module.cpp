#include <cstddef>
#include <string>

#include <pybind11/pybind11.h>

#include "arrays.hpp"
#include "call.hpp"
#include "curve_files.hpp"
#include "curves.hpp"
#include "documents.hpp"
#include "errors.hpp"
#include "feedback.hpp"
#include "parts.hpp"
#include "runs.hpp"
#include "scenes.hpp"
#include "simulations.hpp"
#include "sweeps.hpp"

namespace {

/// Refuses a NumPy that this pybind11 reads wrongly: version 2 moved members of its arrays' types.
void check_numpy() {
  if (PYBIND11_VERSION_HEX >= 0x020C0000) return;
  const auto version =
      pybind11::str(pybind11::module_::import("numpy").attr("__version__")).cast<std::string>();
  if (std::stoi(version) < 2) return;
  throw pybind11::import_error("this build of pliant, with pybind11 " +
                               std::to_string(PYBIND11_VERSION_MAJOR) + "." +
                               std::to_string(PYBIND11_VERSION_MINOR) +
                               ", needs NumPy 1.21 or later, before 2; this is NumPy " + version);
}

}  // namespace

PYBIND11_MODULE(_core, uncounted) {
  namespace python = pliant::python;
  check_numpy();
  python::add_errors(uncounted);
  python::Module module(uncounted);
  module.attr("version") = PLIANT_VERSION;
  python::add_arrays(module);
  python::add_curves(module);
  python::add_parts(module);
  python::add_scenes(module);
  python::add_simulations(module);
  python::add_documents(module);
  python::add_feedback(module);
  python::add_runs(module);
  python::add_sweeps(module);
  python::add_curve_files(module);
  // An object that only __new__ has made would be memory without a value.
  for (const auto& [type, info] : pybind11::detail::get_local_internals().registered_types_cpp)
    info->operator_new = [](std::size_t) -> void* {
      throw pybind11::type_error("this object was made without __init__");
    };
}
