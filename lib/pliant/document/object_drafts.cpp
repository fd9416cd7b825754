#include "pliant/document/object_drafts.hpp"

#include <algorithm>
#include <iterator>
#include <utility>
#include <variant>

#include <fmt/format.h>

namespace pliant::edit {
namespace {

/// The channel or attribute of an operation that concerns a single object; null: it is another one.
const std::string* path_of(const Operation& operation) {
  if (const auto* set = std::get_if<Set>(&operation)) return &set->path;
  if (const auto* set = std::get_if<SetCurve>(&operation)) return &set->channel;
  return nullptr;
}

}  // namespace

bool ObjectDrafts::apply(const Operation& operation) {
  const std::string* const path = path_of(operation);
  ObjectText* const part =
      path ? text_of(std::string_view(*path).substr(0, path->find('.'))) : nullptr;
  if (!part) return false;
  // A curve whose values are computed needs the definitions.
  const bool is_computed = part->text.find('$') != std::string::npos;
  if (is_computed && std::holds_alternative<SetCurve>(operation)) return false;
  auto draft = Draft::make(part->text, whole_.file(), whole_.should_stop());
  if (!draft) return false;
  draft->use_indent(indent_);
  Editor editor(*draft, scene_, [](const std::string&) { return invalid(""); });
  if (!editor.apply(operation)) return false;
  std::vector<EditBatch> batches = draft->take_batches();
  const auto is_outside = [&](const TextEdit& edit) { return edit.at <= part->begin; };
  for (const EditBatch& batch : batches)
    if (std::ranges::any_of(batch, is_outside)) return false;
  part->text = draft->text();
  std::ranges::move(batches, std::back_inserter(part->batches));
  parts_.insert(editor.parts().begin(), editor.parts().end());
  return true;
}

void ObjectDrafts::find_objects() {
  indent_ = whole_.indent();
  const auto add = [&](ElementIndex element) {
    if (auto name = whole_.value(element, "name")) objects_.emplace(*std::move(name), element);
  };
  for (const ElementIndex child : whole_.children(Draft::root)) {
    add(child);
    if (whole_.name(child) != "group") continue;
    for (const ElementIndex member : whole_.children(child)) add(member);
  }
}

ObjectDrafts::ObjectText* ObjectDrafts::text_of(std::string_view name) {
  if (const auto known = parts_of_text_.find(name); known != parts_of_text_.end())
    return &known->second;
  if (objects_.empty()) find_objects();
  const auto object = objects_.find(std::string(name));
  if (object == objects_.end()) return nullptr;
  ObjectText part;
  part.text = scene_around(object->second, part.begin);
  return &parts_of_text_.emplace(name, std::move(part)).first->second;
}

/// The object with the tags around it, each with the blanks before it.
std::string ObjectDrafts::scene_around(ElementIndex object, std::size_t& begin) const {
  std::string opening, closing;
  for (ElementIndex outer = whole_.place(object).parent;; outer = whole_.place(outer).parent) {
    const TextRange tag{outer == Draft::root ? whole_.place(outer).opening_tag().begin
                                             : whole_.with_blanks_before(outer).begin,
                        whole_.place(outer).tag_end};
    opening.insert(0, tag.of(whole_.text()));
    closing += fmt::format("</{}>", whole_.name(outer));
    if (outer == Draft::root) break;
  }
  const TextRange range = whole_.with_blanks_before(object);
  begin = opening.size() + whole_.place(object).whole().begin - range.begin;
  return opening + std::string(range.of(whole_.text())) + closing;
}

Result<void> ObjectDrafts::flush() {
  for (std::size_t k = 0; !parts_of_text_.empty(); ++k) {
    objects_.clear();
    find_objects();
    bool has_more = false;
    for (const auto& [name, part] : parts_of_text_) {
      if (k >= part.batches.size()) continue;
      has_more = true;
      const std::size_t begin = whole_.place(objects_.at(name)).whole().begin;
      for (const TextEdit& edit : part.batches[k]) {
        const auto at = static_cast<std::uint32_t>(begin + edit.at - part.begin);
        whole_.replace({at, at + static_cast<std::uint32_t>(edit.removed.size())}, edit.inserted);
      }
    }
    if (auto done = whole_.commit(); !done) return done;
    if (!has_more) break;
  }
  objects_.clear();
  parts_of_text_.clear();
  return {};
}

}  // namespace pliant::edit
