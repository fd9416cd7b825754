#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/document/operation.hpp"
#include "pliant/document/text_edit.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

struct DocumentOptions {
  /// Contains the files that meshes refer to, as in `load_scene`.
  std::string root = {};
  /// What else a scene must satisfy, such as `Simulation::check`; empty: nothing.
  std::function<Result<void>(const Scene& scene)> check = {};
  /// Whether saving to a symbolic link writes the file that it leads to; else it is refused. Names
  /// of files are relative to the folder of the link.
  bool follows_links = false;
  /// Asked by all that reads or changes the document, which is then Interrupted.
  StopRequest should_stop = {};
};

/// What an edit changed.
struct Change {
  std::string name;                     ///< of the edit
  std::vector<TextEdit> edits = {};     ///< of the text, to be made one after the other
  std::vector<std::string> parts = {};  ///< `NAME.attribute`, or `NAME` of a whole object; sorted
};

/// The text of a scene file, which operations change no more than they must: comments, order,
/// indentation, quotes, line ends and numbers that they do not touch stay byte for byte. It is
/// always a scene that can be read.
class SceneDocument {
 public:
  /// Errors: as `load_scene`; channels that break a rule at a frame; those of `options.check`.
  static Result<SceneDocument> open(const std::string& file, DocumentOptions options = {});

  /// The same for a text; `name` and `folder` as in `parse_scene`.
  static Result<SceneDocument> from_text(std::string text, const std::string& name,
                                         const std::string& folder, DocumentOptions options = {});

  const std::string& text() const { return text_; }
  const Scene& scene() const { return scene_; }
  const std::string& file() const { return file_; }
  /// Its relative names of files are those of this folder; empty: the current one.
  const std::string& folder() const { return folder_; }

  /// Makes operations as one edit, all or nothing; `name`: of the edit, by default what the first
  /// one does. Edits that were undone cannot be made again, unless it is dropped. An edit that
  /// changes no byte is none.
  ///
  /// Errors: an operation names what is not there, or asks for what its comment excludes; the
  /// resulting text has a problem, said as for a file that has it.
  Result<Change> apply(const std::vector<Operation>& operations, const std::string& name = {});

  /// The same in place of the last edit that is not undone, as one that was never made: of a drag,
  /// the next value in place of the last. Edits that were made after it and undone are lost. If
  /// the text is as it was before that edit, `drop` it. A refusal leaves the edit as it is. The
  /// `Change` leads from the text as it is; its `parts` are those of both edits.
  ///
  /// Errors: there is no edit; those of `apply`.
  Result<Change> amend(const std::vector<Operation>& operations, const std::string& name = {});

  /// Takes the last edit that is not undone back, as one that was never made: what `redo` could
  /// make before it, it can make again. Errors: those of `undo`.
  Result<Change> drop();

  /// Takes another text in place of the whole, as one edit of the characters between those that
  /// both begin and end with. The parts of the `Change` are the objects that differ, and `scene`.
  /// Errors: those of `from_text`.
  Result<Change> replace(const std::string& text, const std::string& name = {});

  /// Takes the text that the file has now in place of the whole, likewise; it is saved then.
  /// Errors: those of `open`.
  Result<Change> load();

  /// Reads the files that the text includes, and all that it is checked against, again: one of them
  /// has changed. Errors: those of `from_text`, and the scene stays as it is.
  Result<void> refresh();

  /// Takes the last edit back, or makes it again. Errors: there is none; InvalidInput, Unreadable
  /// if a file that the scene includes has changed so that the text cannot be read any more.
  Result<Change> undo();
  Result<Change> redo();
  bool can_undo() const { return last_ != 0; }
  bool can_redo() const { return edits_[last_].next != 0; }
  const std::string& undo_name() const;  ///< empty: there is none
  const std::string& redo_name() const;

  /// Writes the text, which appears whole in the file or not at all. Errors: Unwritable; among
  /// them: the file has other bytes by now than when it was read or saved last, and keeps them.
  Result<void> save();
  /// The same to any file, whatever is in it, which is that of the document from then on. Errors:
  /// InvalidInput for another folder if the scene names files relative to its own.
  Result<void> save_as(const std::string& file);
  bool is_saved() const { return text_ == saved_; }

  /// Whether the file has other bytes now than when it was read or saved last. Errors: Unreadable.
  Result<bool> has_file_changed() const;

 private:
  struct Edit {
    std::string name;
    std::vector<edit::EditBatch> batches = {};  // one after the other
    std::vector<std::string> parts = {};
    std::size_t before = 0;    // the edit that it was made after
    std::size_t replaced = 0;  // what could be made again there, until it was made; 0: nothing
    std::size_t next = 0;      // what can be made again after it, if it is the last; 0: nothing
  };

  /// An edit, and the text after it.
  struct EditedText {
    Edit edit;
    std::string text;
  };

  SceneDocument() = default;
  std::string written_file(const std::string& file) const;
  Result<Scene> parse(const std::string& text) const;
  Result<Scene> checked(const std::string& text) const;
  Result<EditedText> edited(const std::string& text, const Scene& scene,
                            const std::vector<Operation>& operations,
                            const std::string& name) const;
  Change push(EditedText edited, Scene scene);
  void remove_last();
  std::string text_before(std::vector<edit::EditBatch>& batches) const;
  Result<Change> take(std::string text, const Edit& edit,
                      const std::vector<edit::EditBatch>& batches);

  std::string file_;
  std::string folder_;
  DocumentOptions options_;
  std::string text_;
  std::string saved_;
  Scene scene_;
  std::optional<Scene> scene_before_;  // the last edit; null: unknown
  // In the order in which they were made; the first stands for none. With the last one that is not
  // undone go all behind it, which were made after it.
  std::vector<Edit> edits_ = std::vector<Edit>(1);
  std::size_t last_ = 0;  // that is not undone
};

/// Whether the text of a scene, whose files are relative to `folder`, means the same as the text of
/// `file`. `name`: its own file in messages. Errors: InvalidInput for another folder, if it names
/// files by relative paths; those of `markup_of`.
Result<void> check_scene_place(const std::string& text, const std::string& name,
                               const std::string& folder, const std::string& file,
                               const StopRequest& should_stop = {});

}  // namespace pliant
