#include "scenes.hpp"

#include <cmath>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "arrays.hpp"
#include "call.hpp"
#include "curves.hpp"
#include "parts.hpp"
#include "pliant/document/format_scene.hpp"
#include "pliant/document/save_scene.hpp"
#include "pliant/scene/changes/change.hpp"
#include "pliant/scene/channels.hpp"
#include "pliant/scene/format/schema.hpp"
#include "pliant/scene/read.hpp"
#include "pliant/scene/write.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant::python {
namespace {

using Strings = std::vector<std::string>;

py::dict channels_object(const py::object& scene) {
  const Scene native = scene_of(scene);
  py::dict channels;
  for (const NamedChannel& channel : channels_of(native))
    channels[channel.path.c_str()] =
        std::visit([](const auto* own) { return channel_object(*own); }, channel.channel);
  return channels;
}

py::object sampled(const py::object& scene, const std::string& path, const py::object& frames) {
  const Scene native = scene_of(scene);
  const auto channels = channels_of(native);
  const auto found = std::find_if(channels.begin(), channels.end(),
                                  [&](const NamedChannel& each) { return each.path == path; });
  if (found == channels.end()) throw py::key_error(no_channel(native, path));
  const auto array = frames_of(frames);
  const auto sample = [&](double frame) -> std::vector<double> {
    return std::visit(
        [&](const auto* own) -> std::vector<double> {
          using Own = std::remove_cvref_t<decltype(*own)>;
          if constexpr (std::is_same_v<Own, Switch>) {
            return {own->at(frame) ? 1.0 : 0.0};
          } else {
            const auto value = own->at(frame);
            return {value.begin(), value.end()};
          }
        },
        found->channel);
  };
  const std::size_t width = sample(native.start).size();
  std::vector<py::ssize_t> shape;
  if (array.ndim() == 1) shape.push_back(array.size());
  if (width > 1) shape.push_back(static_cast<py::ssize_t>(width));
  if (shape.empty()) return py::float_(sample(*array.data())[0]);
  py::array_t<double> result(shape);
  double* to = result.mutable_data();
  constexpr std::size_t parts_of_value = 64;
  run_once([&](const StopRequest& should_stop) -> Result<void> {
    StopPoll poll(should_stop);
    for (const double frame : std::span(array.data(), static_cast<std::size_t>(array.size()))) {
      if (poll.after(parts_of_value)) return interrupted();
      for (const double number : sample(frame)) *to++ = number;
    }
    return {};
  });
  return result;
}

/// The problems of an error, or the notes: what `validate` tells.
py::list findings_of(const std::string& file, const std::string& root) {
  return run_once([&](const StopRequest& should_stop) -> Result<py::list> {
    auto scene = load_scene(file, root, should_stop);
    Result<std::vector<SceneNote>> notes;
    if (scene) notes = Simulation::check(*scene, {.should_stop = should_stop});
    const Acquired acquired;
    py::list findings;
    const auto add = [&](const char* severity, const std::string& message, const std::string& at,
                         int line) {
      findings.append(problem_object(severity, message, at, line));
    };
    const auto add_error = [&](const Error& error) {
      add("error", error.message, error.file, error.line);
      for (const Error& other : error.others) add("error", other.message, other.file, other.line);
    };
    if (!scene || !notes) {
      const Error& error = scene ? notes.error() : scene.error();
      if (error.code == ErrorCode::Interrupted) return fail(error);
      add_error(error);
      return findings;
    }
    for (const SceneNote& note : scene->notes) add("note", note.message, note.file, note.line);
    for (const SceneNote& note : *notes) add("note", note.message, note.file, note.line);
    for (const Warning& warning : warnings_about(*scene))
      add("warning", warning.message(), file, 0);
    return findings;
  });
}

}  // namespace

void add_scenes(Module& module) {
  module.def("load", [](const std::string& file, const std::string& root) {
    return python_scene(run_once(
        [&](const StopRequest& should_stop) { return load_scene(file, root, should_stop); }));
  });
  module.def("parse", [](const std::string& text, const std::string& name,
                         const std::string& folder, const std::string& root) {
    return python_scene(run_once([&](const StopRequest& should_stop) {
      return parse_scene(text, name, folder, root, should_stop);
    }));
  });
  module.def("validate", &findings_of);
  module.def("format_scene", [](const std::string& text) {
    return run_once(
        [&](const StopRequest& should_stop) { return format_scene(text, "<text>", should_stop); });
  });
  module.def("schema", [] { return scene_schema(); });
  module.def("channels", &channels_object);
  module.def("sample", &sampled);
  module.def("check", [](const py::object& scene) {
    const Scene native = scene_of(scene);
    run_once([&](const StopRequest& should_stop) -> Result<void> {
      const auto notes = Simulation::check(native, {.should_stop = should_stop});
      if (!notes) return fail(notes.error());
      return {};
    });
  });
  module.def("changed", [](const py::object& scene, const Strings& changes) {
    Scene native = scene_of(scene);
    run_once([&](const StopRequest&) { return change_scene(native, changes); });
    return python_scene(std::move(native), scene);
  });
  module.def("to_xml", [](const py::object& scene, const std::string& folder) {
    const Scene native = scene_of(scene);
    return run_once(
        [&](const StopRequest& should_stop) { return to_xml(native, folder, should_stop); });
  });
  module.def("save", [](const py::object& scene, const std::string& file) {
    const Scene native = scene_of(scene);
    run_once([&](const StopRequest& should_stop) { return save_scene(native, file, should_stop); });
  });
}

}  // namespace pliant::python
