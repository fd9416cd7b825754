#pragma once

#include <memory>
#include <optional>
#include <string>

#include "pliant/core/result.hpp"

namespace pliant::cli {

/// Serves the viewer's page to browsers of this machine, and tells it what happens to the scene.
/// Who asks by another name than this machine's own gets nothing, so that no page from elsewhere
/// can read a scene through a name of its own (DNS rebinding).
class ViewServer {
 public:
  /// Takes requests from now on. `port` 0: any that is free. Errors: Unwritable where the port is
  /// taken.
  static Result<ViewServer> start(std::string page, int port);

  ViewServer(ViewServer&&) noexcept;
  ViewServer& operator=(ViewServer&&) = delete;
  ~ViewServer();  ///< ends all connections

  int port() const;

  /// Pages show this bake (see `ViewBake::packed`) from now on, those that are open too.
  void publish(std::string packed);
  /// A new bake has begun.
  void tell_working();
  /// There is no new bake; what open pages show stays. `messages`: a JSON array of
  /// {kind, file, line, text}.
  void tell_failure(std::string messages);

  /// Page /take asks for `job`, a JSON object, and sends a picture back.
  void order_picture(std::string job);
  /// The picture, a PNG file, once it is there; takes it.
  std::optional<std::string> take_picture();

 private:
  struct State;
  explicit ViewServer(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace pliant::cli
