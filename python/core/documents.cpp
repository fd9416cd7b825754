#include "documents.hpp"

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <pybind11/stl.h>

#include "call.hpp"
#include "curves.hpp"
#include "parts.hpp"
#include "pliant/document/animate_text.hpp"
#include "pliant/document/document.hpp"
#include "pliant/document/operation_json.hpp"
#include "pliant/scene/format/description.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/simulation/simulation.hpp"
#include "runs.hpp"

namespace pliant::python {
namespace {

/// A document with what its calls need: the class `Document`.
struct OwnDocument {
  std::unique_ptr<Asking> asking = std::make_unique<Asking>();
  std::optional<SceneDocument> document;
};

DocumentOptions document_options(Asking& asking, const std::string& root) {
  DocumentOptions options{.root = root, .should_stop = asking.request()};
  options.check = [should_stop = options.should_stop](const Scene& scene) -> Result<void> {
    const auto notes = Simulation::check(scene, {.should_stop = should_stop});
    if (!notes) return fail(notes.error());
    return {};
  };
  return options;
}

std::unique_ptr<OwnDocument> open(const std::string& file, const std::string& root) {
  auto own = std::make_unique<OwnDocument>();
  Turn turn(*own->asking);
  own->document.emplace(
      turn.run([&] { return SceneDocument::open(file, document_options(*own->asking, root)); }));
  return own;
}

std::unique_ptr<OwnDocument> from_text(const std::string& text, const std::string& name,
                                       const std::string& folder) {
  auto own = std::make_unique<OwnDocument>();
  Turn turn(*own->asking);
  own->document.emplace(turn.run([&] {
    return SceneDocument::from_text(text, name, folder, document_options(*own->asking, ""));
  }));
  return own;
}

py::object change_object(const Change& change) {
  py::list edits;
  for (const TextEdit& edit : change.edits)
    edits.append(class_named("TextEdit")(edit.at, edit.removed, edit.inserted));
  return class_named("Change")(change.name, py::tuple(edits), py::tuple(py::cast(change.parts)));
}

/// A member of a document, read when no other call changes it.
template <class Get>
auto reading(Get get) {
  return [get](OwnDocument& own) {
    const Turn turn(*own.asking);
    return get(*own.document);
  };
}

/// A call that changes a document.
template <class Work>
auto changing(Work work) {
  return [work](OwnDocument& own) {
    Turn turn(*own.asking);
    return change_object(turn.run([&] { return work(*own.document); }));
  };
}

/// Whether the attribute of that name is a switch, of whatever has it.
bool is_switch(const std::string& channel) {
  static const auto names = [] {
    std::set<std::string> switches;
    const auto add = [&](const auto& thing) {
      for_each_channel(thing, [&](const std::string& name, const Attribute&, const auto& of) {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(of)>, Switch>)
          switches.insert(name);
      });
    };
    add(Surface());
    add(Force());
    add(Group());
    add(Collider());
    return switches;
  }();
  return names.contains(channel.substr(channel.find('.') + 1));
}

/// A switch steps, also by a curve whose keys do not say so: as a `Scene` takes one.
void make_step(edit::AnyKeys& keys) {
  if (auto* const own = std::get_if<CurveKeys<1>>(&keys))
    for (Key<1>& key : own->keys)
      if (key.next.kind == Interpolation::Kind::Bezier) key.next.kind = Interpolation::Kind::Step;
}

Result<Change> apply(SceneDocument& document, const std::string& json, const std::string& name,
                     const StopRequest& should_stop) {
  auto operations = parse_operations(json, should_stop);
  if (!operations) return fail(operations.error());
  for (Operation& operation : *operations) {
    if (auto* const one = std::get_if<edit::SetCurve>(&operation); one && is_switch(one->channel))
      make_step(one->keys);
    if (auto* const one = std::get_if<edit::Splice>(&operation); one && is_switch(one->channel))
      make_step(one->keys);
  }
  return document.apply(*operations, name);
}

/// Members as the class `Member`.
py::tuple members_of(const std::vector<MemberFormat>& members) {
  py::list list;
  for (const MemberFormat& member : members) {
    py::list words;
    for (const std::string_view word : member.words) words.append(std::string(word));
    list.append(class_named("Member")(std::string(member.name), std::string(member.type),
                                      std::string(member.meaning), std::string(member.unit),
                                      member.range, py::tuple(words), member.is_required,
                                      member.standard, members_of(member.members)));
  }
  return py::tuple(list);
}

py::list formats() {
  py::list list;
  for (const OperationFormat& format : operation_formats())
    list.append(py::make_tuple(std::string(format.name), std::string(format.meaning),
                               members_of(format.members)));
  return list;
}

std::string curve_text(const AnyCurve& curve, const std::string& channel) {
  auto text = std::visit(
      [&](const auto& own) { return edit::animate_text(edit::AnyKeys(own.keys()), channel); },
      curve.curve);
  if (!text) raise("curve", text.error());
  return *std::move(text);
}

}  // namespace

void add_documents(Module& module) {
  module.def("operation_formats", &formats);
  module.def("curve_text", &curve_text);
  module.def("numbers_text",
             [](const std::vector<double>& numbers) { return edit::to_text(numbers); });
  Class<OwnDocument> document(module, "Document", py::module_local());
  document.def(py::init(&open));
  document.def_static("from_text", &from_text);
  document.def_property_readonly("text", reading([](const auto& own) { return own.text(); }));
  document.def_property_readonly(
      "file", reading([](const auto& own) { return py::str(name_text(own.file())); }));
  document.def_property_readonly(
      "scene", reading([](const auto& own) { return python_scene(own.scene()); }));
  document.def_property_readonly("can_undo",
                                 reading([](const auto& own) { return own.can_undo(); }));
  document.def_property_readonly("can_redo",
                                 reading([](const auto& own) { return own.can_redo(); }));
  document.def_property_readonly("undo_name",
                                 reading([](const auto& own) { return own.undo_name(); }));
  document.def_property_readonly("redo_name",
                                 reading([](const auto& own) { return own.redo_name(); }));
  document.def_property_readonly("is_saved",
                                 reading([](const auto& own) { return own.is_saved(); }));
  document.def("has_file_changed", [](OwnDocument& own) {
    Turn turn(*own.asking);
    return turn.run([&] { return own.document->has_file_changed(); });
  });
  document.def(
      "apply", [](OwnDocument& own, const std::string& operations, const std::string& name) {
        Turn turn(*own.asking);
        return change_object(turn.run(
            [&] { return apply(*own.document, operations, name, own.asking->request()); }));
      });
  document.def("undo", changing([](SceneDocument& own) { return own.undo(); }));
  document.def("redo", changing([](SceneDocument& own) { return own.redo(); }));
  document.def("save", [](OwnDocument& own) {
    Turn turn(*own.asking);
    turn.run([&] { return own.document->save(); });
  });
  document.def("save_as", [](OwnDocument& own, const std::string& file) {
    Turn turn(*own.asking);
    turn.run([&] { return own.document->save_as(file); });
  });
}

}  // namespace pliant::python
