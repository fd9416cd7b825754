#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <pybind11/pybind11.h>

#include "call.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant::python {

/// The vertices of each surface at rest, for frames that outlive their simulation.
using RestPositions = std::shared_ptr<const std::vector<Field>>;

/// Those of a simulation or a live run.
template <class Working>
RestPositions rest_of(const Working& working) {
  auto rest = std::make_shared<std::vector<Field>>();
  for (const RestShape& shape : working.rest_shapes()) rest->push_back(shape.mesh.positions);
  return rest;
}

/// Something of the library that works in threads of its own, with what its calls need.
template <class Working>
struct Own {
  std::unique_ptr<Asking> asking;
  py::object scene;  ///< a copy of the Python scene
  py::object store;  ///< keeps it alive
  std::optional<Working> working;
  RestPositions rest;
  bool is_profiled = false;  ///< of a simulation
  bool records = false;      ///< of a live run

  std::array<py::object*, 2> objects() { return {&scene, &store}; }

  Own() = default;
  Own(const Own&) = delete;
  Own& operator=(const Own&) = delete;
  ~Own() {
    // In a child after a fork its threads are not there: nothing can wait for their end.
    if (asking && asking->is_of_parent() && working)
      new std::optional<Working>(std::move(working));  // NOLINT
  }
};

/// The class `Simulation`.
using OwnSimulation = Own<Simulation>;

/// Raises ValueError if there are not 1 to 1024, as of the command.
void check_threads(int threads);

/// The options that a call names; `asking` must outlive their use.
SimulationOptions options_of(int threads, const std::string& solver, Asking& asking,
                             const py::object& max_memory, const py::object& store);

/// Whether it is the word for world space, and not that for object space. Raises ValueError.
bool is_world(const std::string& space);

/// Warnings as the class `SceneWarning`.
py::list warning_list(const std::vector<Warning>& warnings);

/// The index of a surface. Raises KeyError naming all, TypeError.
std::size_t surface_index(const Scene& scene, const py::object& name);

/// JSON as objects of Python.
py::object object_of_json(const std::string& json);

/// A frame as the class `Frame`.
py::object frame_object(Frame frame, const RestPositions& rest);

/// Adds Simulation, LiveSimulation, Frame, SurfaceFrame, RestShape, MemoryStore and FolderStore.
void add_simulations(Module& module);

}  // namespace pliant::python
