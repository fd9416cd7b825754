#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "editor/edit_session.hpp"
#include "pliant/core/result.hpp"

namespace pliant::editor {

/// How an export goes on.
struct ExportState {
  std::string file;
  int done = 0, total = 0;  ///< frames
  std::string state;        ///< `running`, `done`, `failed`, `stopped`
  std::optional<Error> error = {};
};

/// Writes files of a scene, one export at a time. Thread-safe.
class Exporter {
 public:
  Exporter() = default;
  Exporter(const Exporter&) = delete;
  Exporter& operator=(const Exporter&) = delete;
  virtual ~Exporter() = default;

  /// What to write, as the request says it; `text`, `name` in messages, and `folder`: the scene.
  struct Order {
    std::string text, name, folder;
    std::string root;   ///< as of `load_scene`
    std::string saved;  ///< the file with this text; empty: it is not saved
    std::string file;   ///< where it goes
    std::optional<FrameSpan> frames = {};
    FrameSpan scene_frames = {};
    std::string surface = {}, space = {};
    std::function<void(const ExportState&)> tell = {};  ///< called in any thread
  };

  /// Errors: InvalidInput: one is running; the order breaks a rule.
  virtual Result<void> start(Order order) = 0;
  virtual void stop() = 0;
};

/// The server of `pliant edit`: the viewer's, with the requests of docs/editor.md.
class EditServer {
 public:
  /// Answers from now on. `port` 0: any free port. `exporter` may be null. Errors: those of
  /// `EditSession::open`; Unwritable if the port is in use.
  static Result<EditServer> start(std::string page, int port, SessionOptions options,
                                  std::shared_ptr<Exporter> exporter);

  EditServer(EditServer&&) noexcept;
  EditServer& operator=(EditServer&&) = delete;
  ~EditServer();  ///< ends all connections

  std::string address() const;

  /// Those of the scene that it began with.
  const std::vector<SceneNote>& notes() const;

  /// Ends the work. Returns what is to be told of changes that were not saved; null: all are.
  std::optional<Error> finish();

 private:
  struct State;
  explicit EditServer(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace pliant::editor
