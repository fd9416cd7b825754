#include "simulations.hpp"

#include <algorithm>
#include <climits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "arrays.hpp"
#include "collected.hpp"
#include "fill.hpp"
#include "parts.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/scene/format/shape_description.hpp"
#include "pliant/simulation/live.hpp"
#include "pliant/simulation/report_json.hpp"
#include "pliant/states/folder_store.hpp"
#include "pliant/states/state_store.hpp"

namespace pliant::python {
namespace {

using py::arg;
using py::kw_only;

// -- Frames
// ----------------------------------------------------------------------------------------

/// A frame that nothing changes: the class `Frame`.
struct SharedFrame {
  std::shared_ptr<const Frame> frame;
  RestPositions rest;
};

/// One surface of it: the class `SurfaceFrame`.
struct SharedSurface {
  std::shared_ptr<const Frame> frame;
  RestPositions rest;
  std::size_t index = 0;

  const SurfaceFrame& surface() const { return frame->surfaces()[index]; }

  /// The positions at rest at this frame, of a shape that moves or not.
  const Field& object_rest() const {
    const Field& moving = surface().object_rest();
    return moving.rows() > 0 ? moving : (*rest)[index];
  }
};

bool is_of_floats(const py::dtype& type) {
  return type.kind() == 'f' && (type.itemsize() == 4 || type.itemsize() == 8) &&
         type.byteorder() != '>';
}

// What is given is filled whole or not at all.
void check_out(const py::object& out, py::ssize_t rows) {
  const auto refuse = [&](const std::string& rule) {
    throw py::value_error(fmt::format("out must be {}", rule));
  };
  if (!py::isinstance<py::array>(out)) refuse("an array");
  const auto array = py::reinterpret_borrow<py::array>(out);
  if (!is_of_floats(array.dtype())) refuse("of float32 or float64");
  if (array.ndim() != 2 || array.shape(0) != rows || array.shape(1) != 3)
    refuse(fmt::format("of the shape ({}, 3)", rows));
  if (!array.writeable()) refuse("writeable");
  if ((array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_) == 0) refuse("aligned");
  if ((array.flags() & (py::array::c_style | py::array::f_style)) == 0)
    refuse("contiguous, in the order of C or Fortran");
}

py::object positions_of(const SharedSurface& own, const std::string& space, const py::object& out) {
  const bool in_world = is_world(space);
  const py::ssize_t rows = own.surface().object_positions().rows();
  py::array to;
  if (out.is_none()) {
    to = py::array_t<double>({rows, py::ssize_t{3}});
  } else {
    check_out(out, rows);
    to = py::reinterpret_borrow<py::array>(out);
  }
  fill(own.surface(), in_world, to.mutable_data(),
       {.is_single = to.itemsize() == sizeof(float),
        .is_by_rows = (to.flags() & py::array::c_style) != 0});
  return to;
}

py::object surface_object(const SharedFrame& own, const SurfaceFrame& surface) {
  const auto index = static_cast<std::size_t>(&surface - own.frame->surfaces().data());
  return py::cast(SharedSurface{own.frame, own.rest, index});
}

void add_frames(Module& module) {
  Class<SharedSurface> surface(module, "SurfaceFrame", py::module_local(),
                               "One surface at one frame, which does not change.");
  surface.def_property_readonly(
      "name", [](const SharedSurface& own) { return own.surface().name(); }, "Of the surface.");
  surface.def_property_readonly(
      "object_positions",
      [](const py::object& own) {
        return view_of(own.cast<SharedSurface&>().surface().object_positions(), own);
      },
      "(V, 3) float64, object space, a read-only view [length].");
  surface.def_property_readonly(
      "object_rest",
      [](const py::object& own) { return view_of(own.cast<SharedSurface&>().object_rest(), own); },
      "(V, 3) float64, the vertices at rest at this frame, object space, a read-only view "
      "[length].");
  surface.def_property_readonly(
      "transform",
      [](const SharedSurface& own) {
        const Transform& transform = own.surface().transform();
        py::array_t<double> matrix({4, 4});
        auto numbers = matrix.mutable_unchecked<2>();
        for (int row = 0; row < 4; ++row)
          for (int column = 0; column < 4; ++column)
            numbers(row, column) = row == 3      ? (column == 3 ? 1 : 0)
                                   : column == 3 ? transform.translation[row]
                                                 : transform.linear(row, column);
        return matrix;
      },
      "(4, 4) float64, of column vectors: object to world.");
  surface.def_property_readonly(
      "peak_displacement",
      [](const SharedSurface& own) { return own.surface().peak_displacement(); },
      "The largest distance of a vertex from rest, world space [length].");
  surface.def("positions", &positions_of, kw_only(), arg("space") = "world",
              arg("out") = py::none(),
              R"((V, 3) positions [length], of `space` world or object.

A new array of float64, or `out`: float64 or float32, rounded to the nearest, contiguous in the
order of C or Fortran. ValueError for another `out`, into which nothing is written.)");
  surface.def("__repr__", [](const SharedSurface& own) {
    return fmt::format("<pliant.SurfaceFrame {} of {} vertices>", own.surface().name(),
                       own.surface().object_positions().rows());
  });

  Class<SharedFrame> frame(module, "Frame", py::module_local(),
                           "All surfaces at one frame: a mapping from names to SurfaceFrame.");
  frame.def_property_readonly(
      "number", [](const SharedFrame& own) { return own.frame->number(); }, "Of the frame.");
  frame.def("__getitem__", [](const SharedFrame& own, const py::object& name) {
    if (py::isinstance<py::str>(name)) {
      if (const auto* const found = own.frame->find_surface(text_of(name)))
        return surface_object(own, *found);
      throw py::key_error(own.frame->no_surface_text(text_of(name)));
    }
    throw py::key_error(std::string(py::repr(name)));
  });
  frame.def("__len__", [](const SharedFrame& own) { return own.frame->surfaces().size(); });
  frame.def("__iter__", [](const SharedFrame& own) {
    py::list names;
    for (const SurfaceFrame& each : own.frame->surfaces()) names.append(each.name());
    return py::iter(names);
  });
  frame.def("__repr__", [](const SharedFrame& own) {
    std::vector<std::string> names;
    for (const SurfaceFrame& each : own.frame->surfaces()) names.push_back(each.name());
    return fmt::format("<pliant.Frame {} of {}>", own.frame->number(), fmt::join(names, ", "));
  });
}

// -- Rest shapes
// -----------------------------------------------------------------------------------

/// A surface before any force acts on it: the class `RestShape`.
struct SharedShape {
  std::shared_ptr<const RestShape> shape;
};

void add_shapes(Module& module) {
  Class<SharedShape> shape(module, "RestShape", py::module_local(),
                           "A surface before any force acts on it.");
  shape.def_property_readonly(
      "mesh",
      [](const SharedShape& own) {
        return SharedMesh{std::shared_ptr<const Mesh>(own.shape, &own.shape->mesh)};
      },
      "The `Mesh` as it is written.");
  shape.def_property_readonly(
      "vertex_nodes",
      [](const py::object& own) {
        const auto& nodes = own.cast<SharedShape&>().shape->vertex_nodes;
        return view_of(py::array_t<int>(static_cast<py::ssize_t>(nodes.size()), nodes.data(), own));
      },
      "(V,) int32, read-only: the node of each vertex; -1: none of its own.");
  shape.def_property_readonly(
      "rest",
      [](const py::object& own) { return view_of(own.cast<SharedShape&>().shape->rest, own); },
      "(nodes, 3) float64, object space, read-only [length].");
  shape.def_property_readonly(
      "grid",
      [](const SharedShape& own) -> py::object {
        if (!own.shape->grid) return py::none();
        const Grid& grid = *own.shape->grid;
        const auto wrap = static_cast<std::size_t>(wrap_of(grid.is_closed_u, grid.is_closed_v));
        return class_named("GridFacts")(grid.columns, grid.rows, grid.hu, grid.hv,
                                        std::string(wrap_words[wrap]));
      },
      "`columns, rows, hu, hv, wrap`, or None: a surface of triangles, or driven.");
  const auto add_fact = [&](const char* name, auto of, const char* meaning) {
    shape.def_property_readonly(
        name,
        [of](const SharedShape& own) -> py::object {
          const auto summary = summary_of(*own.shape);
          return summary ? py::object(py::cast(of(*summary))) : py::none();
        },
        meaning);
  };
  add_fact(
      "nodes", [](const SurfaceSummary& s) { return s.nodes; },
      "Of a surface of triangles, else None.");
  add_fact(
      "faces", [](const SurfaceSummary& s) { return s.faces; },
      "That take part, of a surface of triangles, else None.");
  add_fact(
      "pieces", [](const SurfaceSummary& s) { return s.pieces; },
      "Faces joined by corners, of a surface of triangles, else None.");
  add_fact(
      "border_edges", [](const SurfaceSummary& s) { return s.border_edges; },
      "Of a surface of triangles, else None.");
  add_fact(
      "unit", [](const SurfaceSummary& s) { return std::pair(s.unit[0], s.unit[1]); },
      "The lengths that count as 1 along u and v, of a surface of triangles, else None.");
  shape.def_property_readonly(
      "note", [](const SharedShape& own) { return own.shape->note; },
      "A remark on how the mesh was read; may be empty.");
  shape.def("__repr__", [](const SharedShape& own) {
    return fmt::format("<pliant.RestShape {} of {} vertices>", own.shape->name,
                       own.shape->mesh.vertex_count());
  });
}

// -- Stores
// ----------------------------------------------------------------------------------------

void add_stores(Module& module) {
  Class<MemoryStateStore, std::shared_ptr<MemoryStateStore>>(
      module, "MemoryStore", py::module_local(),
      "States in memory, so that other simulations solve again only what changed. Thread-safe.")
      .def(py::init<std::size_t>(), arg("bytes"))
      .def_property_readonly("bytes", &MemoryStateStore::bytes, "Stored at present.");
  Class<FolderStateStore, std::shared_ptr<FolderStateStore>>(
      module, "FolderStore", py::module_local(),
      "States in a folder, which several processes may share. Thread-safe.")
      .def(py::init([](const py::object& folder, std::size_t bytes) {
             return std::shared_ptr<FolderStateStore>(taken(FolderStateStore::open(
                 class_named("file_name")(folder).cast<std::string>(), bytes)));
           }),
           arg("folder"), arg("bytes"))
      .def_property_readonly("trouble", &FolderStateStore::trouble,
                             "Why nothing is written any more; empty: no failure.");
}

StateStore* store_of(const py::object& store) {
  if (store.is_none()) return nullptr;
  if (py::isinstance<MemoryStateStore>(store)) return &store.cast<MemoryStateStore&>();
  if (py::isinstance<FolderStateStore>(store)) return &store.cast<FolderStateStore&>();
  throw py::type_error("store must be a MemoryStore or a FolderStore");
}

SolverChoice solver_of(const std::string& word) {
  const auto choice = solver_choice(word);
  if (choice && (*choice == SolverChoice::Auto || is_available(*choice))) return *choice;
  std::string allowed(name_of(SolverChoice::Auto));
  for (const SolverChoice each : available_solvers())
    if (each != SolverChoice::Auto) allowed += ", " + std::string(name_of(each));
  throw py::value_error("solver \"" + word + "\": allowed: " + allowed);
}

// -- Arguments
// -------------------------------------------------------------------------------------

template <class Native>
void interrupt(Native& own) {
  own.asking->check_process();
  own.asking->interrupt();
}

std::string repr_of(const py::handle& given) { return py::str(py::repr(given)); }

/// A whole number of Python that is an int. Raises TypeError, InvalidInput.
int frame_of(const py::handle& given) {
  if (PyIndex_Check(given.ptr()) == 0)
    throw py::type_error("frame must be a whole number, not " + repr_of(given));
  const auto number = py::reinterpret_steal<py::object>(PyNumber_Index(given.ptr()));
  if (!number) throw py::error_already_set();
  int overflow = 0;
  const long value = PyLong_AsLongAndOverflow(number.ptr(), &overflow);
  if (overflow != 0 || value < INT_MIN || value > INT_MAX)
    raise(Error{.message = fmt::format("frame {}: beyond what a frame can be", repr_of(number))});
  return static_cast<int>(value);
}

// -- Simulations
// -----------------------------------------------------------------------------------

std::unique_ptr<OwnSimulation> make_simulation(const py::object& scene, int threads,
                                               const std::string& solver,
                                               std::size_t checkpoint_bytes,
                                               const py::object& max_memory,
                                               const py::object& store,
                                               const py::object& should_stop, bool profile) {
  auto own = std::make_unique<OwnSimulation>();
  own->asking = std::make_unique<Asking>(should_stop);
  own->scene = class_named("copy_scene")(scene);
  own->store = store;
  own->is_profiled = profile;
  SimulationOptions options = options_of(threads, solver, *own->asking, max_memory, store);
  options.checkpoint_bytes = checkpoint_bytes;
  options.profile = profile;
  Scene native = scene_of(own->scene, own->asking.get());
  Turn turn(*own->asking);
  own->working.emplace(turn.run([&] { return Simulation::make(std::move(native), options); }));
  own->rest = rest_of(*own->working);
  return own;
}

std::vector<int> frames_of(const Simulation& simulation, const py::object& frames) {
  if (frames.is_none()) {
    std::vector<int> all;
    for (const int frame : simulation.frames()) all.push_back(frame);
    return all;
  }
  std::vector<int> wanted;
  if (!py::isinstance<py::iterable>(frames) || py::isinstance<py::str>(frames))
    throw py::type_error("frames must be whole numbers, not " + repr_of(frames));
  for (const py::handle frame : frames) wanted.push_back(frame_of(frame));
  return wanted;
}

py::object all_positions(OwnSimulation& own, const py::object& name, const py::object& frames,
                         const std::string& space, const py::object& dtype) {
  Turn turn(*own.asking);
  Simulation& simulation = *own.working;
  const std::size_t surface = surface_index(simulation.scene(), name);
  const std::vector<int> wanted = frames_of(simulation, frames);
  const bool in_world = is_world(space);
  const py::dtype type = py::dtype::from_args(dtype);
  if (!is_of_floats(type)) throw py::value_error("dtype must be float32 or float64");
  const Eigen::Index rows = simulation.rest_shapes()[surface].mesh.vertex_count();
  py::array array(type, std::vector<py::ssize_t>{static_cast<py::ssize_t>(wanted.size()),
                                                 static_cast<py::ssize_t>(rows), 3});
  auto* to = static_cast<char*>(array.mutable_data());
  const bool is_single = type.itemsize() == sizeof(float);
  turn.run([&]() -> Result<void> {
    Frame frame;
    for (const int number : wanted) {
      auto next = simulation.at(number, std::move(frame));
      if (!next) return fail(next.error());
      frame = *std::move(next);
      fill(frame.surfaces()[surface], in_world, to, {.is_single = is_single});
      to += 3 * rows * type.itemsize();
    }
    return {};
  });
  return array;
}

void add_simulation(Module& module) {
  Class<OwnSimulation> simulation(
      module, "Simulation", py::module_local(), collected<OwnSimulation>(),
      R"(A scene over its frames: the bits of `pliant bake`, in any order of calls.

`threads` work at the same time; `solver` is auto, spectral, supernodal or eigen; `checkpoint_bytes`
keep states, so that earlier frames are quick; `max_memory` limits all [bytes]; `store` keeps states
beyond this simulation; `should_stop()` is asked before every step. Raises what is wrong with the
scene, all in one error. Safe to call from several threads: one waits for the other.)");
  simulation.def(py::init(&make_simulation), arg("scene"), kw_only(), arg("threads") = 1,
                 arg("solver") = "auto", arg("checkpoint_bytes") = std::size_t{1} << 28U,
                 arg("max_memory") = py::none(), arg("store") = py::none(),
                 arg("should_stop") = py::none(), arg("profile") = false);
  simulation.def_property_readonly(
      "frames",
      [](const OwnSimulation& own) {
        own.asking->check_process();
        const Scene& scene = own.working->scene();
        return py::reinterpret_borrow<py::object>(reinterpret_cast<PyObject*>(&PyRange_Type))(
            scene.start, scene.end + 1);
      },
      "range(start, end + 1).");
  simulation.def_property_readonly(
      "scene",
      [](const OwnSimulation& own) {
        own.asking->check_process();
        return class_named("copy_scene")(own.scene);
      },
      "A copy of the scene that it runs.");
  simulation.def(
      "at",
      [](OwnSimulation& own, const py::object& given) {
        const int frame = frame_of(given);
        Turn turn(*own.asking);
        return frame_object(turn.run([&] { return own.working->at(frame); }), own.rest);
      },
      arg("frame"), "A `Frame`, in any order. Raises InvalidInput outside `frames`.");
  simulation.def("positions", &all_positions, arg("name") = py::none(), kw_only(),
                 arg("frames") = py::none(), arg("space") = "world",
                 arg("dtype") = py::str("float64"),
                 "(F, V, 3) positions of a surface at `frames`, by default all [length].");
  simulation.def(
      "report",
      [](OwnSimulation& own, const py::object& given) {
        const int frame = frame_of(given);
        Turn turn(*own.asking);
        return object_of_json(turn.run([&]() -> Result<std::string> {
          auto report = own.working->report(frame);
          if (!report) return fail(report.error());
          return to_json(*report, *own.working);
        }));
      },
      arg("frame"), "The frame's entry of `pliant bake --regions`, a dict.");
  simulation.def(
      "warnings",
      [](OwnSimulation& own) {
        Turn turn(*own.asking);
        return warning_list(own.working->warnings());
      },
      "The warnings of the frames so far: `SceneWarning`s.");
  simulation.def(
      "state",
      [](OwnSimulation& own, const py::object& given) {
        const int frame = frame_of(given);
        Turn turn(*own.asking);
        return py::bytes(turn.run([&] { return own.working->state_bytes(frame); }));
      },
      arg("frame"), "The state at a frame, to go on from with `restore`.");
  simulation.def(
      "restore",
      [](OwnSimulation& own, const py::bytes& state) {
        Turn turn(*own.asking);
        const auto bytes = std::string(state);
        return turn.run([&] { return own.working->restore(bytes); });
      },
      arg("state"),
      "Goes to a state, and returns its frame. Raises InvalidInput for another scene's.");
  simulation.def_property_readonly(
      "frame_counts",
      [](OwnSimulation& own) {
        Turn turn(*own.asking);
        const FrameCounts counts = own.working->frame_counts();
        return py::make_tuple(counts.solved, counts.read);
      },
      "(solved, read from the store).");
  simulation.def(
      "profile",
      [](OwnSimulation& own) {
        Turn turn(*own.asking);
        py::dict times;
        if (!own.is_profiled) return times;
        const Profile profile = own.working->profile();
        for (std::size_t k = 0; k < stage_count; ++k) {
          const auto stage = static_cast<Stage>(k);
          times[py::str(std::string(name_of(stage)))] = profile[stage];
        }
        return times;
      },
      "Stage -> seconds; empty without `profile=True`.");
  simulation.def(
      "interrupt", interrupt<OwnSimulation>,
      "From any thread: the call that runs raises Interrupted. Without one nothing happens.");
  simulation.def(
      "shape",
      [](OwnSimulation& own, const py::object& name) {
        Turn turn(*own.asking);
        const std::size_t surface = surface_index(own.working->scene(), name);
        return SharedShape{std::make_shared<const RestShape>(own.working->rest_shapes()[surface])};
      },
      arg("name") = py::none(), "The `RestShape` of a surface.");
  simulation.def("__repr__", [](const OwnSimulation& own) {
    const Scene& scene = own.working->scene();
    return fmt::format("<pliant.Simulation of frames {} to {}>", scene.start, scene.end);
  });
  simulation.def("__reduce__", [](const OwnSimulation&) -> py::object {
    throw py::type_error("a Simulation cannot be pickled; pickle its scene, or a state");
  });
}

// -- Live
// ------------------------------------------------------------------------------------------

/// The class `LiveSimulation`.
using OwnLive = Own<LiveSimulation>;

std::vector<double> live_value(const py::object& value) {
  if (py::isinstance<py::bool_>(value)) return {value.cast<bool>() ? 1.0 : 0.0};
  const py::object given = class_named("value")("value", value);
  if (py::isinstance<py::tuple>(given)) return given.cast<std::vector<double>>();
  return {given.cast<double>()};
}

void add_live(Module& module) {
  Class<OwnLive> live(module, "LiveSimulation", py::module_local(), collected<OwnLive>(),
                      R"(A scene that is played live: set channels, advance, read positions.

With `records` what was set is kept for `performance()`, whose bake has the bits that were played.)");
  live.def(
      py::init([](const py::object& scene, bool records, int threads, const std::string& solver,
                  const py::object& max_memory, const py::object& should_stop) {
        auto own = std::make_unique<OwnLive>();
        own->asking = std::make_unique<Asking>(should_stop);
        own->scene = class_named("copy_scene")(scene);
        own->records = records;
        LiveOptions options{options_of(threads, solver, *own->asking, max_memory, py::none()),
                            records};
        Scene native = scene_of(own->scene, own->asking.get());
        Turn turn(*own->asking);
        own->working.emplace(
            turn.run([&] { return LiveSimulation::make(std::move(native), options); }));
        own->rest = rest_of(*own->working);
        return own;
      }),
      arg("scene"), kw_only(), arg("records") = false, arg("threads") = 1, arg("solver") = "auto",
      arg("max_memory") = py::none(), arg("should_stop") = py::none());
  live.def_property_readonly(
      "frame",
      [](OwnLive& own) {
        Turn turn(*own.asking);
        return own.working->frame();
      },
      "The present frame.");
  const auto set = [](OwnLive& own, const std::string& path, const py::object& value) {
    const std::vector<double> numbers = live_value(value);
    Turn turn(*own.asking);
    turn.run([&] { return own.working->set(path, numbers); });
  };
  live.def("set", set, arg("path"), arg("value"),
           "Sets a channel from the present frame on. Raises InvalidInput with the nearest name.");
  live.def("__setitem__", set, arg("path"), arg("value"));
  live.def(
      "advance",
      [](OwnLive& own, int frames) {
        if (frames < 0) throw py::value_error("frames must not be negative");
        Turn turn(*own.asking);
        turn.run([&]() -> Result<void> {
          for (int k = 0; k < frames; ++k)
            if (auto done = own.working->advance(); !done) return done;
          return {};
        });
      },
      arg("frames") = 1, "Solves the present frame, and goes on to the next.");
  live.def(
      "positions",
      [](OwnLive& own) {
        Turn turn(*own.asking);
        return frame_object(turn.run([&] { return own.working->positions(); }), own.rest);
      },
      "The `Frame` as it is now.");
  live.def(
      "report",
      [](OwnLive& own) {
        Turn turn(*own.asking);
        return object_of_json(turn.run([&]() -> Result<std::string> {
          auto report = own.working->report();
          if (!report) return fail(report.error());
          return to_json(*report, *own.working);
        }));
      },
      "The solve that `advance` would make now, as `Simulation.report`.");
  live.def(
      "performance",
      [](OwnLive& own) {
        if (!own.records)
          throw py::value_error("performance() needs LiveSimulation(…, records=True)");
        Turn turn(*own.asking);
        return python_scene(turn.run([&] { return own.working->performance(); }), own.scene);
      },
      "The `Scene` with everything set so far as keys.");
  live.def(
      "warnings",
      [](OwnLive& own) {
        Turn turn(*own.asking);
        return warning_list(own.working->warnings());
      },
      "As `Simulation.warnings`.");
  live.def("interrupt", interrupt<OwnLive>, "As `Simulation.interrupt`.");
  live.def("__reduce__", [](const OwnLive&) -> py::object {
    throw py::type_error("a LiveSimulation cannot be pickled");
  });
}

}  // namespace

bool is_world(const std::string& space) {
  if (space != "world" && space != "object")
    throw py::value_error("space \"" + space + "\": allowed: world, object");
  return space == "world";
}

py::list warning_list(const std::vector<Warning>& warnings) {
  py::list list;
  for (const Warning& warning : warnings) {
    py::list frames;
    for (const auto& range : warning.frames.ranges())
      frames.append(py::make_tuple(range.first, range.second));
    list.append(class_named("SceneWarning")(std::string(word_of(warning.kind)), warning.surface,
                                            warning.force, py::tuple(frames), warning.message()));
  }
  return list;
}

void check_threads(int threads) {
  constexpr int most = 1024;
  if (threads < 1 || threads > most)
    throw py::value_error(fmt::format("threads={}: 1 to {} are allowed", threads, most));
}

SimulationOptions options_of(int threads, const std::string& solver, Asking& asking,
                             const py::object& max_memory, const py::object& store) {
  check_threads(threads);
  SimulationOptions options;
  options.threads = threads;
  options.solver = solver_of(solver);
  options.should_stop = asking.request();
  if (!max_memory.is_none()) {
    // Cut off at the most that there can be.
    const Py_ssize_t bytes = PyNumber_AsSsize_t(max_memory.ptr(), nullptr);
    if (PyErr_Occurred() != nullptr) throw py::error_already_set();
    if (bytes < 0) throw py::value_error("max_memory must not be negative");
    options.max_memory = static_cast<std::size_t>(bytes);
  }
  options.store = store_of(store);
  return options;
}

std::size_t surface_index(const Scene& scene, const py::object& name) {
  std::string names;
  if (name.is_none()) {
    if (scene.surfaces.size() == 1) return 0;
    throw py::type_error("a scene of several surfaces needs the name of one");
  }
  if (!py::isinstance<py::str>(name))
    throw py::type_error("the name of a surface must be a text, not " + repr_of(name));
  const std::string wanted = text_of(name);
  for (std::size_t k = 0; k < scene.surfaces.size(); ++k) {
    if (scene.surfaces[k].name == wanted) return k;
    names += (names.empty() ? "" : ", ") + scene.surfaces[k].name;
  }
  throw py::key_error("no surface is named \"" + wanted + "\"; there are: " + names);
}

py::object object_of_json(const std::string& json) {
  return py::module_::import("json").attr("loads")(json);
}

py::object frame_object(Frame frame, const RestPositions& rest) {
  return py::cast(SharedFrame{std::make_shared<const Frame>(std::move(frame)), rest});
}

void add_simulations(Module& module) {
  add_frames(module);
  add_shapes(module);
  add_stores(module);
  add_simulation(module);
  add_live(module);
}

}  // namespace pliant::python
