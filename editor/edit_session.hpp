#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "editor/answer.hpp"
#include "editor/files.hpp"
#include "editor/frame_solver.hpp"
#include "editor/ghosts.hpp"
#include "editor/journal.hpp"
#include "editor/members.hpp"
#include "editor/takes.hpp"
#include "pliant/document/document.hpp"

namespace pliant::editor {

/// A scene to begin with.
struct Beginning {
  std::string text;
  std::vector<std::pair<std::string, std::string>> files = {};  ///< that it names, and their bytes
};

/// What the command gives to its editor. `begin` and `material`, which take long, are called in
/// another thread than the session's.
struct EditorTools {
  /// JSON: {"starters":[{"name","summary"}…],"materials":[…]}.
  std::function<Json()> starters = {};
  /// A PNG of a starter; null: there is none of that name.
  std::function<std::optional<std::string>(const std::string& starter)> picture = {};
  /// The scene of a starter as that of a file, with a material, and with a mesh of the user's
  /// own and its object, unless they are empty.
  std::function<Result<Beginning>(const std::string& starter, const std::string& material,
                                  const std::string& mesh, const std::string& object,
                                  const std::string& file)>
      begin = {};
  /// The text of a scene with a material for a surface.
  std::function<Result<std::string>(const SceneDocument& document, const std::string& surface,
                                    const std::string& material)>
      material = {};
};

struct SessionOptions {
  std::string file;  ///< may not be there yet; empty: the document has no name yet
  std::string root;  ///< the folder of everything that is read or written; no links, no dots
  std::string journals = Journal::standard_folder();  ///< empty: there are none
  SimulationOptions simulation = {};
  EditorTools tools = {};
};

/// What takes long: to be called in any thread, with options that stop it once there is another
/// revision. What it returns answers in the session's thread, if there is not.
using LongWork = std::function<std::function<HttpAnswer()>(const SimulationOptions& options)>;
using Begun = std::variant<HttpAnswer, LongWork>;

/// The document that is edited: what pages ask for and change, one request after the other. Each
/// answer to a POST is docs/editor.md's. Used by one thread.
class EditSession {
 public:
  /// `notify` is called, in any thread, when the events have changed. Errors: those of
  /// `SceneDocument::open` if there is such a file.
  static Result<std::unique_ptr<EditSession>> open(SessionOptions options,
                                                   std::function<void()> notify);

  HttpAnswer document() const;
  /// The same, and what the scene says of each attribute. `revision`: null: the newest.
  HttpAnswer objects(std::optional<Revision> revision) const;
  HttpAnswer starters() const;
  HttpAnswer picture(const std::string& starter) const;
  HttpAnswer picture_of_take(std::int64_t id) const;

  HttpAnswer operations(const Body& body);
  HttpAnswer undo(const Body& body);
  HttpAnswer redo(const Body& body);
  HttpAnswer save(const Body& body);
  HttpAnswer load(const Body& body);
  HttpAnswer open_file(const Body& body);  ///< of a scene, while there is none
  HttpAnswer restore(const Body& body);
  HttpAnswer discard(const Body& body);
  HttpAnswer keep(const Body& body);  ///< a take
  HttpAnswer take(const Body& body);  ///< opens, renames, saves or deletes one
  Begun begin(const Body& body);      ///< with a starter
  Begun add(const Body& body);
  Begun material(const Body& body);
  Begun motion(const Body& body);

  /// Looks at the files of the scene and writes the journal, if it is time. Call it often.
  void tick();
  /// Writes the journal at once.
  void flush();

  FrameSolver& solver() { return solver_; }
  Json takes() const;  ///< docs/editor.md has it
  /// Plays a take, unless it is played. Errors: there is none with this id; those of its scene.
  Result<const Ghost*> ghost(std::int64_t take);
  const Ghosts& ghosts() const { return ghosts_; }
  Revision revision() const { return revision_; }
  bool has_scene() const { return document_.has_value(); }
  /// Errors: InvalidInput: the scene is made from that file, under this name or another.
  Result<void> check_export(const std::filesystem::path& place) const;
  const SceneDocument& scene_document() const { return *document_; }
  const std::string& root() const { return options_.root; }
  const SimulationOptions& simulation() const { return options_.simulation; }
  bool is_saved() const;
  bool is_changed_on_disk() const { return is_changed_on_disk_; }
  int disk_count() const { return disk_count_; }  ///< how often other bytes were found there
  /// Why there is no journal, or why it was not written; empty: it was.
  const std::string& journal_fault() const { return journal_fault_; }
  std::string told_name() const;  ///< of the document, in messages

  /// Of the document's file, without links and dots; of one without a file the root.
  std::string folder_of_file() const;

  /// The file of a request: relative to the root. Errors: InvalidInput for one that is not in it.
  Result<std::filesystem::path> place_of(const std::string& file) const;

 private:
  using Clock = std::chrono::steady_clock;

  EditSession(SessionOptions options, std::function<void()> notify);
  DocumentOptions document_options();
  std::string file_in_root() const;
  Json document_json() const;
  void watch();
  void look_at_disk();
  bool is_new(const std::filesystem::path& file, FileStamp now, FileStamp& known);
  Result<std::filesystem::path> own_place() const;
  Result<std::filesystem::path> place_of_scene(const std::string& file) const;
  Result<void> check_save(const std::filesystem::path& place) const;
  FileStamp own_stamp() const;
  void read_others_again();
  void write_journal();
  void take_left();
  void open_journal();
  HttpAnswer changed(const Change& change, const Json& more = Json::object());
  HttpAnswer step(const std::vector<Operation>& operations, const std::string& name,
                  const std::string& gesture, const Json& more = Json::object());
  HttpAnswer save_take(const Take& take, const std::string& file, bool overwrites);
  HttpAnswer begin_with(const Beginning& beginning, const std::string& name);
  void start(SceneDocument document, bool is_on_disk);
  bool is_gesture(const std::string& gesture) const;
  void play();

  SessionOptions options_;
  std::function<void()> notify_;
  FrameSolver solver_;
  Takes takes_;
  Ghosts ghosts_;
  int read_again_ = 0;  // files that scenes name, how often
  std::optional<SceneDocument> document_;
  Revision revision_ = 0;
  bool is_on_disk_ = false;  // the document has a file, which has been read or written
  bool is_gone_ = false;     // from the disk
  bool is_changed_on_disk_ = false;
  int disk_count_ = 0;
  std::string gesture_;         // whose step is the last one; empty: none
  std::string before_gesture_;  // the text

  FileStamp stamp_;                                       // of the document's file
  std::map<std::filesystem::path, FileStamp> others_;     // of the files that it names
  std::map<std::filesystem::path, FileStamp> unsettled_;  // of files that may still be written
  Clock::time_point looked_ = {};

  std::optional<Journal> journal_;
  std::string journal_fault_;  // why there is none, or why it was not written; empty: it was
  Clock::time_point written_ = {};
  std::pair<Revision, bool> journaled_ = {};  // and whether it was saved then
};

}  // namespace pliant::editor
