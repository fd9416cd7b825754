#pragma once

#include <cstddef>
#include <functional>
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

  /// Makes operations as one edit, all or nothing; `name`: of the edit, by default what the first
  /// one does. Edits that were undone are lost. A edit that changes no byte is none.
  ///
  /// Errors: an operation names what is not there, or asks for what its comment excludes; the
  /// resulting text has a problem, said as for a file that has it.
  Result<Change> apply(const std::vector<Operation>& operations, const std::string& name = {});

  /// Takes the last edit back, or makes it again. Errors: there is none; InvalidInput, Unreadable
  /// if a file that the scene includes has changed so that the text cannot be read any more.
  Result<Change> undo();
  Result<Change> redo();
  bool can_undo() const { return done_ > 0; }
  bool can_redo() const { return done_ < edits_.size(); }
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
    std::vector<edit::EditBatch> batches;  // one after the other
    std::vector<std::string> parts;
  };

  SceneDocument() = default;
  Result<Scene> parse(const std::string& text) const;
  Result<Scene> checked(const std::string& text) const;
  Result<Change> take(std::string text, const Edit& edit,
                      const std::vector<edit::EditBatch>& batches);

  std::string file_;
  std::string folder_;
  DocumentOptions options_;
  std::string text_;
  std::string saved_;
  Scene scene_;
  std::vector<Edit> edits_;
  std::size_t done_ = 0;  // edits that are not undone
};

/// Whether the text of a scene, whose files are relative to `folder`, means the same as the text of
/// `file`. `name`: its own file in messages. Errors: InvalidInput for another folder, if it names
/// files by relative paths; those of `markup_of`.
Result<void> check_scene_place(const std::string& text, const std::string& name,
                               const std::string& folder, const std::string& file,
                               const StopRequest& should_stop = {});

}  // namespace pliant
