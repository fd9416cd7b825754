#include "sweeps.hpp"

#include <chrono>
#include <future>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "call.hpp"
#include "collected.hpp"
#include "parts.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/writer.hpp"
#include "pliant/sweep/csv.hpp"
#include "pliant/sweep/folder.hpp"
#include "pliant/sweep/log.hpp"
#include "pliant/sweep/sweep.hpp"
#include "runs.hpp"
#include "simulations.hpp"

namespace pliant::python {
namespace {

using Strings = std::vector<std::string>;

/// Takes of scenes in memory: the class `SweepCore`.
struct OwnSweep {
  std::unique_ptr<Asking> asking = std::make_unique<Asking>();
  py::list scenes;  // as they were given
  std::optional<Sweep> sweep;

  std::array<py::object*, 1> objects() { return {&scenes}; }
};

/// Those of a folder: the class `SweepFolderCore`.
struct OwnFolder {
  std::unique_ptr<Asking> asking = std::make_unique<Asking>();
  std::optional<SweepFolder> folder;
};

/// Runs takes in other threads, while this one looks for Ctrl-C: it may have none of the takes.
template <class Work>
auto beside(Asking& asking, Work&& work) {
  const StopRequest should_stop = asking.request();
  auto result = std::async(std::launch::async, std::forward<Work>(work));
  while (result.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready) should_stop();
  return result.get();
}

SweepVariation variation_of(std::size_t scene_count, const Strings& vary, const Strings& set,
                            const std::optional<std::size_t>& sample,
                            const std::optional<std::string>& table,
                            const std::string& table_name) {
  return {.scene_count = scene_count,
          .set = set,
          .vary = vary,
          .samples = sample,
          .table = table,
          .table_name = table_name};
}

std::optional<FrameSpan> span_of(const py::object& frames) {
  if (frames.is_none()) return {};
  return frame_span(frames);
}

SolverChoice solver_of(const std::string& word, Asking& asking) {
  return options_of(1, word, asking, py::none(), py::none()).solver;
}

std::unique_ptr<OwnSweep> make_sweep(const py::list& scenes, const Strings& vary,
                                     const Strings& set, const std::optional<std::size_t>& sample,
                                     const std::optional<std::string>& table,
                                     const py::object& frames, const std::string& solver) {
  auto own = std::make_unique<OwnSweep>();
  std::vector<Scene> native;
  for (const py::handle scene : scenes) {
    own->scenes.append(class_named("copy_scene")(scene));
    native.push_back(scene_of(own->scenes[native.size()], own->asking.get()));
  }
  const SweepVariation variation =
      variation_of(native.size(), vary, set, sample, table, table ? "table" : "");
  const SweepSettings settings{.frames = span_of(frames),
                               .solver = solver_of(solver, *own->asking)};
  Turn turn(*own->asking);
  own->sweep.emplace(turn.run([&]() -> Result<Sweep> {
    const StopRequest should_stop = own->asking->request();
    auto takes = Takes::make(variation, should_stop);
    if (!takes) return fail(takes.error());
    return Sweep::make(std::move(native), *std::move(takes), settings, should_stop);
  }));
  return own;
}

py::tuple paths_of(const Sweep& sweep) {
  py::list paths;
  for (const VariedPath& path : sweep.takes().paths()) paths.append(path.title());
  return py::tuple(paths);
}

template <class T>
py::array_t<T> column_of(const std::vector<T>& numbers) {
  return py::array_t<T>(static_cast<py::ssize_t>(numbers.size()), numbers.data());
}

/// The columns of a table, by their names: `records[k]` is of take `takes[k]`.
py::dict columns_of(const Sweep& sweep, const std::vector<std::size_t>& takes,
                    const std::vector<TakeRecord>& records) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  std::vector<std::int64_t> numbers, scenes, peak_frames, settles;
  std::vector<double> peaks, finals, rms, speeds, energies;
  py::list statuses, hashes, errors;
  std::vector<py::list> values(sweep.takes().paths().size());
  for (std::size_t k = 0; k < takes.size(); ++k) {
    const TakeRecord& record = records[k];
    const Measures& m = record.measures;
    const bool is_done = record.status == TakeStatus::Done;
    numbers.push_back(static_cast<std::int64_t>(takes[k]));
    scenes.push_back(static_cast<std::int64_t>(sweep.takes().scene_of(takes[k])));
    statuses.append(is_done ? "done" : record.status == TakeStatus::Failed ? "failed" : "missing");
    const auto texts = sweep.takes().texts(takes[k]);
    for (std::size_t p = 0; p < values.size(); ++p) values[p].append(std::string(texts[p]));
    peaks.push_back(is_done ? m.peak : none);
    peak_frames.push_back(is_done ? m.peak_frame : 0);
    finals.push_back(is_done ? m.final : none);
    rms.push_back(is_done ? m.rms : none);
    speeds.push_back(is_done ? m.speed : none);
    energies.push_back(is_done ? m.energy : none);
    settles.push_back(is_done ? m.settle : 0);
    hashes.append(is_done ? to_text(m.hash) : std::string());
    errors.append(name_text(record.error));
  }
  py::dict columns;
  columns["take"] = column_of(numbers);
  columns["status"] = statuses;
  columns["scene"] = column_of(scenes);
  py::list texts;
  for (const py::list& column : values) texts.append(column);
  columns["paths"] = texts;
  columns["peak"] = column_of(peaks);
  columns["peak_frame"] = column_of(peak_frames);
  columns["final"] = column_of(finals);
  columns["rms"] = column_of(rms);
  columns["speed"] = column_of(speeds);
  columns["energy"] = column_of(energies);
  columns["settle"] = column_of(settles);
  columns["hash"] = hashes;
  columns["error"] = errors;
  return columns;
}

/// The function `watch(take, frame)` of a program, which sees each frame; false ends the take.
class Watching {
 public:
  Watching(const py::object& watch, const Asking* owner)
      : watch_(watch.is_none() ? nullptr : held(watch)), owner_(owner) {}

  bool is_asked() const { return watch_ != nullptr; }

  /// From any thread.
  bool see(std::size_t take, const Simulation& simulation, const Frame& frame) {
    const RestPositions rest = rest_of(take, simulation, frame);
    const Acquired acquired;
    const InCallback callback(owner_);
    const py::object answer = (*watch_)(take, frame_object(frame, rest));
    return answer.is_none() || py::bool_(answer);
  }

  void end(std::size_t take) {
    const std::lock_guard lock(mutex_);
    takes_.erase(take);
  }

 private:
  struct Take {
    int frame = 0;  // the last that was seen
    RestPositions rest;
  };

  /// The same for all frames of a take, which may begin again.
  RestPositions rest_of(std::size_t take, const Simulation& simulation, const Frame& frame) {
    const std::lock_guard lock(mutex_);
    Take& own = takes_[take];
    if (!own.rest || frame.number() <= own.frame) own.rest = pliant::python::rest_of(simulation);
    own.frame = frame.number();
    return own.rest;
  }

  Held watch_;
  const Asking* owner_;
  std::mutex mutex_;
  std::map<std::size_t, Take> takes_;  // that run
};

TakeRecord record_of(const TakeOutcome& outcome) {
  if (outcome.measures) return {TakeStatus::Done, *outcome.measures, {}, {}, outcome.seconds};
  return {TakeStatus::Failed,
          {},
          error_text(outcome.measures.error(), Folders::Without),
          error_text(outcome.measures.error(), Folders::With),
          outcome.seconds};
}

/// Takes by their numbers; None: all. Raises IndexError.
std::vector<std::size_t> takes_of(const Sweep& sweep, const py::object& takes) {
  std::vector<std::size_t> numbers(sweep.takes().count());
  std::iota(numbers.begin(), numbers.end(), std::size_t{0});
  if (takes.is_none()) return numbers;
  std::vector<std::size_t> wanted;
  for (const py::handle take : takes) {
    const py::ssize_t number = PyNumber_AsSsize_t(take.ptr(), PyExc_IndexError);
    if (PyErr_Occurred() != nullptr) throw py::error_already_set();
    if (number < 0 || static_cast<std::size_t>(number) >= numbers.size())
      throw py::index_error(
          fmt::format("there is no take {}; there are 0 to {}", number, numbers.size() - 1));
    wanted.push_back(static_cast<std::size_t>(number));
  }
  return wanted;
}

py::dict run_sweep(OwnSweep& own, const py::object& takes, int threads,
                   const py::object& max_memory, const py::object& watch,
                   const py::object& progress) {
  const SimulationOptions limits = options_of(threads, "auto", *own.asking, max_memory, py::none());
  const std::vector<std::size_t> wanted = takes_of(*own.sweep, takes);
  const Telling telling(progress, own.asking.get());
  Watching watching(watch, own.asking.get());
  std::vector<TakeRecord> records(own.sweep->takes().count());
  std::int64_t done = 0;
  SweepRun run{.threads = threads,
               .max_memory = limits.max_memory,
               .should_stop = limits.should_stop,
               .take_done = [&](const TakeOutcome& outcome) -> Result<void> {
                 records[outcome.take] = record_of(outcome);
                 watching.end(outcome.take);
                 telling.tell(++done, static_cast<std::int64_t>(wanted.size()));
                 return {};
               }};
  if (watching.is_asked())
    run.watch = [&](std::size_t take, const Simulation& simulation, const Frame& frame) {
      return Result<bool>(watching.see(take, simulation, frame));
    };
  {
    Turn turn(*own.asking);
    turn.run([&] { return beside(*own.asking, [&] { return own.sweep->run(wanted, run); }); });
  }
  std::vector<TakeRecord> chosen;
  for (const std::size_t take : wanted) chosen.push_back(records[take]);
  return columns_of(*own.sweep, wanted, chosen);
}

py::object scene_of_take(const OwnSweep& own, const py::object& take) {
  const std::size_t number = takes_of(*own.sweep, py::make_tuple(take)).front();
  const std::size_t scene = own.sweep->takes().scene_of(number);
  return python_scene(taken(own.sweep->scene_of(number)), own.scenes[scene]);
}

// -- Folders
// ---------------------------------------------------------------------------------------

std::string ending_to_write(const std::string& write) {
  if (write.empty()) return "";
  const std::string ending = write.starts_with('.') ? write : "." + write;
  taken(check_ending("takes" + ending));
  return ending_of("takes" + ending);
}

std::unique_ptr<OwnFolder> make_folder(const std::string& folder, const Strings& files,
                                       const Strings& vary, const Strings& set,
                                       const std::optional<std::size_t>& sample,
                                       const std::optional<std::string>& table,
                                       const py::object& frames, const std::string& solver,
                                       const std::string& write) {
  auto own = std::make_unique<OwnFolder>();
  const SweepRequest request{
      .scenes = files,
      .variation = variation_of(files.size(), vary, set, sample, table, table ? "table" : ""),
      .frames = span_of(frames),
      .solver = solver_of(solver, *own->asking),
      .write = ending_to_write(write)};
  Turn turn(*own->asking);
  own->folder.emplace(
      turn.run([&] { return SweepFolder::make(folder, request, own->asking->request()); }));
  return own;
}

std::unique_ptr<OwnFolder> open_folder(const std::string& folder) {
  auto own = std::make_unique<OwnFolder>();
  Turn turn(*own->asking);
  own->folder.emplace(turn.run([&] { return SweepFolder::open(folder, own->asking->request()); }));
  return own;
}

void run_folder(OwnFolder& own, std::size_t part, std::size_t count, bool retry, int threads,
                const py::object& max_memory, const py::object& progress) {
  if (part >= count) throw py::value_error("part must be (k, p) with 0 <= k < p");
  const SimulationOptions limits = options_of(threads, "auto", *own.asking, max_memory, py::none());
  const Telling telling(progress, own.asking.get());
  std::int64_t done = 0, total = 0;
  const FolderRun run{.threads = threads,
                      .max_memory = limits.max_memory,
                      .should_stop = limits.should_stop,
                      .part = {part, count},
                      .retry = retry,
                      .begin = [&](std::size_t all) { total = static_cast<std::int64_t>(all); },
                      .take_done = [&](const TakeOutcome&) { telling.tell(++done, total); }};
  Turn turn(*own.asking);
  turn.run([&] {
    return beside(*own.asking, [&]() -> Result<void> {
      if (auto ran = own.folder->run(run); !ran) return ran;
      if (count > 1) return {};
      const auto status = own.folder->status(limits.should_stop);
      if (!status) return fail(status.error());
      return own.folder->write_table(*status, limits.should_stop);
    });
  });
}

SweepStatus status_of(OwnFolder& own) {
  Turn turn(*own.asking);
  return turn.run([&] { return own.folder->status(own.asking->request()); });
}

py::object status_object(OwnFolder& own) {
  const SweepStatus status = status_of(own);
  py::list conflicts;
  for (const HashConflict& each : status.conflicts)
    conflicts.append(py::make_tuple(each.take, name_text(each.host), name_text(each.other_host)));
  return class_named("SweepStatus")(status.done, status.failed, status.missing(),
                                    py::tuple(conflicts));
}

py::dict table_of(OwnFolder& own) {
  const SweepStatus status = status_of(own);
  const Sweep& sweep = own.folder->sweep();
  return columns_of(sweep, takes_of(sweep, py::none()), status.takes);
}

}  // namespace

void add_sweeps(Module& module) {
  module.def("csv_field", [](const std::string& text) { return csv_field(text); });
  Class<OwnSweep>(module, "SweepCore", py::module_local(), collected<OwnSweep>())
      .def(py::init(&make_sweep))
      .def("__len__", [](const OwnSweep& own) { return own.sweep->takes().count(); })
      .def_property_readonly("paths", [](const OwnSweep& own) { return paths_of(*own.sweep); })
      .def("scene", &scene_of_take)
      .def("run", &run_sweep);
  Class<OwnFolder>(module, "SweepFolderCore", py::module_local())
      .def(py::init(&make_folder))
      .def_static("open", &open_folder)
      .def("__len__", [](const OwnFolder& own) { return own.folder->sweep().takes().count(); })
      .def_property_readonly("paths",
                             [](const OwnFolder& own) { return paths_of(own.folder->sweep()); })
      .def_property_readonly("folder",
                             [](const OwnFolder& own) { return name_text(own.folder->folder()); })
      .def_property_readonly("files",
                             [](const OwnFolder& own) {
                               py::list files;
                               for (const std::string& file : own.folder->request().scenes)
                                 files.append(name_text(file));
                               return py::tuple(files);
                             })
      .def("run", &run_folder)
      .def("status", &status_object)
      .def("table", &table_of);
}

}  // namespace pliant::python
