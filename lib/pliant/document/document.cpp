#include "pliant/document/document.hpp"

#include <algorithm>
#include <filesystem>
#include <set>
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

const std::string no_name;

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

Result<Change> SceneDocument::apply(const std::vector<Operation>& operations,
                                    const std::string& name) {
  auto draft = edit::Draft::make(text_, file_, options_.should_stop);
  if (!draft) return fail(draft.error());
  edit::Editor editor(*draft, scene_, [this](const std::string& text) { return parse(text); });
  edit::ObjectDrafts objects(*draft, scene_);
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
  if (draft->text() == text_) return Change{.name = edit.name};
  auto scene = checked(draft->text());
  if (!scene) return fail(scene.error());
  scene_ = *std::move(scene);
  text_ = draft->text();
  edits_.resize(done_);
  edits_.push_back(std::move(edit));
  ++done_;
  const Edit& last = edits_.back();
  return Change{.name = last.name, .edits = in_order(last.batches), .parts = last.parts};
}

/// Takes the text that the batches make of the present one.
Result<Change> SceneDocument::take(std::string text, const Edit& edit,
                                   const std::vector<edit::EditBatch>& batches) {
  auto scene = parse(text);
  if (!scene) return fail(scene.error());
  scene_ = *std::move(scene);
  text_ = std::move(text);
  return Change{.name = edit.name, .edits = in_order(batches), .parts = edit.parts};
}

Result<Change> SceneDocument::undo() {
  if (!can_undo()) return fail(ErrorCode::InvalidInput, "there is nothing to undo", file_);
  const Edit& edit = edits_[done_ - 1];
  std::vector<edit::EditBatch> batches;
  std::string text = text_;
  for (auto batch = edit.batches.rbegin(); batch != edit.batches.rend(); ++batch) {
    batches.push_back(edit::reversed(*batch));
    text = edit::made(text, batches.back());
  }
  auto change = take(std::move(text), edit, batches);
  if (change) --done_;
  return change;
}

Result<Change> SceneDocument::redo() {
  if (!can_redo()) return fail(ErrorCode::InvalidInput, "there is nothing to redo", file_);
  const Edit& edit = edits_[done_];
  std::string text = text_;
  for (const edit::EditBatch& batch : edit.batches) text = edit::made(text, batch);
  auto change = take(std::move(text), edit, edit.batches);
  if (change) ++done_;
  return change;
}

const std::string& SceneDocument::undo_name() const {
  return can_undo() ? edits_[done_ - 1].name : no_name;
}

const std::string& SceneDocument::redo_name() const {
  return can_redo() ? edits_[done_].name : no_name;
}

Result<void> SceneDocument::save() {
  if (auto written = rewrite_file(file_, saved_, text_); !written) return written;
  saved_ = text_;
  return {};
}

Result<void> SceneDocument::save_as(const std::string& file) {
  if (auto place = check_scene_place(text_, file_, folder_, file); !place) return place;
  if (auto written = write_file(file, text_); !written) return written;
  for (SceneNote& note : scene_.notes)
    if (note.file == file_) note.file = file;
  scene_.origin.rename(file);
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
