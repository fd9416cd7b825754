#include "pliant/document/document.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/text.hpp"
#include "pliant/document/draft.hpp"
#include "pliant/document/editor.hpp"
#include "pliant/document/object_drafts.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/scene/checks/channel_check.hpp"
#include "pliant/scene/read.hpp"

namespace pliant {
namespace {

/// The edits of batches as a list: those of one from the last to the first, so that each offset is
/// that of the text at its turn.
std::vector<TextEdit> in_order(const std::vector<edit::EditBatch>& batches) {
  std::vector<TextEdit> edits;
  for (const edit::EditBatch& batch : batches)
    edits.insert(edits.end(), batch.rbegin(), batch.rend());
  return edits;
}

/// The objects that two scenes do not share, and `scene` if its own attributes differ.
std::vector<std::string> differing_objects(const Scene& before, const Scene& after) {
  std::set<std::string> names;
  const auto compare = [&](const auto& olds, const auto& news) {
    const auto add = [&](const auto& things, const auto& others) {
      std::map<std::string_view, const std::remove_cvref_t<decltype(things.front())>*> by_name;
      for (const auto& other : others) by_name.emplace(other.name, &other);
      for (const auto& thing : things) {
        const auto found = by_name.find(thing.name);
        if (found == by_name.end() || !(*found->second == thing)) names.insert(thing.name);
      }
    };
    add(olds, news);
    add(news, olds);
  };
  compare(before.surfaces, after.surfaces);
  compare(before.forces, after.forces);
  compare(before.groups, after.groups);
  compare(before.colliders, after.colliders);
  const auto own = [](const Scene& scene) {
    return std::tie(scene.fps, scene.start, scene.end, scene.seed);
  };
  if (own(before) != own(after)) names.insert("scene");
  return {names.begin(), names.end()};
}

}  // namespace

Result<SceneDocument> SceneDocument::open(const std::string& file, DocumentOptions options) {
  auto text = read_file(file, largest_scene_file, options.should_stop);
  if (!text) return fail(text.error());
  return from_text(*std::move(text), file, folder_of_file(file), std::move(options));
}

Result<SceneDocument> SceneDocument::from_text(std::string text, const std::string& name,
                                               const std::string& folder, DocumentOptions options) {
  SceneDocument document;
  document.file_ = name;
  document.folder_ = folder;
  document.options_ = std::move(options);
  auto scene = document.checked(text);
  if (!scene) return fail(scene.error());
  document.scene_ = *std::move(scene);
  document.saved_ = text;
  document.text_ = std::move(text);
  return document;
}

Result<Scene> SceneDocument::parse(const std::string& text) const {
  return parse_scene(text, file_, folder_, options_.root, options_.should_stop);
}

/// The scene of a text that satisfies all that `validate` asks.
Result<Scene> SceneDocument::checked(const std::string& text) const {
  auto scene = parse(text);
  if (!scene) return scene;
  StopPoll poll(options_.should_stop);
  constexpr std::size_t parts_of_channel = 256;
  const auto is_over = [&] { return poll.after(parts_of_channel); };
  if (std::vector<Error> errors = check_channels(*scene, {}, is_over); !errors.empty())
    return fail(as_one(std::move(errors), file_));
  if (is_stopped(options_.should_stop)) return interrupted();
  if (options_.check)
    if (auto satisfied = options_.check(*scene); !satisfied) return fail(satisfied.error());
  return scene;
}

/// What operations make of a text, whose scene is given.
Result<SceneDocument::EditedText> SceneDocument::edited(const std::string& text, const Scene& scene,
                                                        const std::vector<Operation>& operations,
                                                        const std::string& name) const {
  auto draft = edit::Draft::make(text, file_, options_.should_stop);
  if (!draft) return fail(draft.error());
  edit::Editor editor(*draft, scene, [this](const std::string& of) { return parse(of); });
  edit::ObjectDrafts objects(*draft, scene);
  for (const Operation& operation : operations) {
    if (objects.apply(operation)) continue;
    if (auto done = objects.flush(); !done) return fail(done.error());
    if (auto done = editor.apply(operation); !done) return fail(done.error());
  }
  if (auto done = objects.flush(); !done) return fail(done.error());
  std::set<std::string> parts = objects.parts();
  parts.insert(editor.parts().begin(), editor.parts().end());
  Edit edit{.name = name, .batches = draft->take_batches(), .parts = {parts.begin(), parts.end()}};
  if (name.empty() && !operations.empty()) edit.name = described(operations.front());
  if (name.empty() && operations.size() > 1)
    edit.name += fmt::format(" and {} more", operations.size() - 1);
  return EditedText{std::move(edit), draft->text()};
}

/// Makes an edit of the present text, which is the last one then.
Change SceneDocument::push(EditedText edited, Scene scene) {
  edited.edit.before = last_;
  edited.edit.replaced = std::exchange(edits_[last_].next, edits_.size());
  last_ = edits_.size();
  edits_.push_back(std::move(edited.edit));
  text_ = std::move(edited.text);
  scene_before_ = std::exchange(scene_, std::move(scene));
  const Edit& last = edits_.back();
  return {.name = last.name, .edits = in_order(last.batches), .parts = last.parts};
}

/// Forgets the last edit, and all that were made after it. The text stays.
void SceneDocument::remove_last() {
  const std::size_t removed = last_;
  last_ = edits_[removed].before;
  edits_[last_].next = edits_[removed].replaced;
  edits_.resize(removed);
}

/// The text before the last edit, and the batches that make it of the present one.
std::string SceneDocument::text_before(std::vector<edit::EditBatch>& batches) const {
  const std::vector<edit::EditBatch>& made = edits_[last_].batches;
  std::string text = text_;
  for (auto batch = made.rbegin(); batch != made.rend(); ++batch) {
    batches.push_back(edit::reversed(*batch));
    text = edit::made(text, batches.back());
  }
  return text;
}

Result<Change> SceneDocument::apply(const std::vector<Operation>& operations,
                                    const std::string& name) {
  auto edited = this->edited(text_, scene_, operations, name);
  if (!edited) return fail(edited.error());
  if (edited->text == text_) return Change{.name = std::move(edited->edit.name)};
  auto scene = checked(edited->text);
  if (!scene) return fail(scene.error());
  return push(*std::move(edited), *std::move(scene));
}

Result<Change> SceneDocument::amend(const std::vector<Operation>& operations,
                                    const std::string& name) {
  if (!can_undo()) return fail(ErrorCode::InvalidInput, "there is nothing to amend", file_);
  std::vector<edit::EditBatch> batches;
  std::string before = text_before(batches);
  if (!scene_before_) {
    auto scene = parse(before);
    if (!scene) return fail(scene.error());
    scene_before_ = *std::move(scene);
  }
  auto edited = this->edited(before, *scene_before_, operations, name);
  if (!edited) return fail(edited.error());
  if (edited->text == before) return drop();
  const bool is_same = edited->text == text_;
  auto scene = is_same ? Result<Scene>(scene_) : checked(edited->text);
  if (!scene) return fail(scene.error());

  std::set<std::string> parts(edits_[last_].parts.begin(), edits_[last_].parts.end());
  remove_last();
  scene_ = *std::move(scene_before_);
  Change change = push(*std::move(edited), *std::move(scene));
  if (is_same) return Change{.name = std::move(change.name)};
  const std::vector<TextEdit> back = in_order(batches);
  change.edits.insert(change.edits.begin(), back.begin(), back.end());
  parts.insert(change.parts.begin(), change.parts.end());
  change.parts.assign(parts.begin(), parts.end());
  return change;
}

Result<Change> SceneDocument::drop() {
  auto change = undo();
  if (!change) return change;
  last_ = edits_[last_].next;
  remove_last();
  return change;
}

Result<Change> SceneDocument::replace(const std::string& text, const std::string& name) {
  Edit edit{.name = name.empty() ? "replace the text" : name};
  if (text == text_) return Change{.name = std::move(edit.name)};
  auto scene = checked(text);
  if (!scene) return fail(scene.error());
  edit.batches = {{edit::difference(text_, text)}};
  edit.parts = differing_objects(scene_, *scene);
  return push({std::move(edit), text}, *std::move(scene));
}

/// Takes the text that the batches make of the present one.
Result<Change> SceneDocument::take(std::string text, const Edit& edit,
                                   const std::vector<edit::EditBatch>& batches) {
  auto scene = parse(text);
  if (!scene) return fail(scene.error());
  scene_before_ = std::exchange(scene_, *std::move(scene));
  text_ = std::move(text);
  return Change{.name = edit.name, .edits = in_order(batches), .parts = edit.parts};
}

Result<Change> SceneDocument::load() {
  auto text = read_file(file_, largest_scene_file, options_.should_stop);
  if (!text) return fail(text.error());
  auto change = replace(*text, "load");
  if (change) saved_ = *std::move(text);
  return change;
}

Result<void> SceneDocument::refresh() {
  auto scene = checked(text_);
  if (!scene) return fail(scene.error());
  scene_ = *std::move(scene);
  scene_before_.reset();
  return {};
}

Result<Change> SceneDocument::undo() {
  if (!can_undo()) return fail(ErrorCode::InvalidInput, "there is nothing to undo", file_);
  std::vector<edit::EditBatch> batches;
  std::string text = text_before(batches);
  auto change = take(std::move(text), edits_[last_], batches);
  if (!change) return change;
  scene_before_.reset();
  last_ = edits_[last_].before;
  return change;
}

Result<Change> SceneDocument::redo() {
  if (!can_redo()) return fail(ErrorCode::InvalidInput, "there is nothing to redo", file_);
  const std::size_t next = edits_[last_].next;
  const Edit& edit = edits_[next];
  std::string text = text_;
  for (const edit::EditBatch& batch : edit.batches) text = edit::made(text, batch);
  auto change = take(std::move(text), edit, edit.batches);
  if (change) last_ = next;
  return change;
}

const std::string& SceneDocument::undo_name() const { return edits_[last_].name; }

const std::string& SceneDocument::redo_name() const { return edits_[edits_[last_].next].name; }

/// The file that has the text once it is saved to `file`.
std::string SceneDocument::written_file(const std::string& file) const {
  std::error_code unknown;
  const auto place = std::filesystem::canonical(file, unknown);
  return options_.follows_links && !unknown ? place.string() : file;
}

Result<void> SceneDocument::save() {
  if (auto done = rewrite_file(written_file(file_), saved_, text_); !done) return done;
  saved_ = text_;
  return {};
}

Result<void> SceneDocument::save_as(const std::string& file) {
  if (auto place = check_scene_place(text_, file_, folder_, file); !place) return place;
  if (auto done = write_file(written_file(file), text_); !done) return done;
  const auto rename = [&](Scene& scene) {
    for (SceneNote& note : scene.notes)
      if (note.file == file_) note.file = file;
    scene.origin.rename(file);
  };
  rename(scene_);
  if (scene_before_) rename(*scene_before_);
  file_ = file;
  folder_ = folder_of_file(file);
  saved_ = text_;
  return {};
}

Result<bool> SceneDocument::has_file_changed() const {
  const auto bytes = read_file(file_, largest_scene_file, options_.should_stop);
  if (!bytes) return fail(bytes.error());
  return *bytes != saved_;
}

Result<void> check_scene_place(const std::string& text, const std::string& name,
                               const std::string& folder, const std::string& file,
                               const StopRequest& should_stop) {
  namespace fs = std::filesystem;
  const auto or_here = [](const std::string& name) { return fs::path(name.empty() ? "." : name); };
  std::error_code unknown;
  if (fs::equivalent(or_here(folder_of_file(file)), or_here(folder), unknown) && !unknown)
    return {};
  const auto draft = edit::Draft::make(text, name, should_stop);
  if (!draft) return fail(draft.error());
  const bool names_files =
      draft->any_attribute([](std::string_view attribute, const std::string& value) {
        return (attribute == "file" || attribute == "cache") && fs::path(value).is_relative();
      });
  if (!names_files) return {};
  return fail(ErrorCode::InvalidInput,
              fmt::format("the scene names files relative to its own folder {}; save it there",
                          or_here(folder).string()),
              file);
}

}  // namespace pliant
