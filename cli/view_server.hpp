#pragma once

#include <memory>
#include <optional>
#include <string>

#include "pliant/core/result.hpp"
#include "png_check.hpp"

namespace pliant::cli {

/// What the page at `address()`take is asked for.
struct PictureOrder {
  std::string job;   ///< a JSON object
  PictureSize size;  ///< of the picture that has to come of it
};

/// Serves the viewer's page to browsers of this machine, and tells it what happens to the scene.
/// Whoever asks without the address's token, from another page, or by another name than this
/// machine's own gets nothing; see `ViewGate`.
class ViewServer {
 public:
  /// Takes requests from now on. `port` 0: any that is free. Errors: Unwritable where the port is
  /// taken.
  static Result<ViewServer> start(std::string page, int port);

  ViewServer(ViewServer&&) noexcept;
  ViewServer& operator=(ViewServer&&) = delete;
  ~ViewServer();  ///< ends all connections

  /// Of the page, with the token that all its requests need, and with a slash at its end.
  std::string address() const;

  /// Pages show this bake (see `ViewBake::packed`) from now on, those that are open too.
  void publish(std::string packed);
  /// A new bake has begun.
  void tell_working();
  /// There is no new bake; what open pages show stays. `messages`: a JSON array of
  /// {kind, file, line, text}.
  void tell_failure(std::string messages);

  /// Page `address()`take asks for the job, and sends one picture back. The next order stands in
  /// place of the last.
  void order_picture(PictureOrder order);
  /// The picture, a PNG file, once it is there; takes it. Errors: InvalidInput where what came is
  /// not the one that was ordered (see `check_png`).
  std::optional<Result<std::string>> take_picture();

 private:
  struct State;
  explicit ViewServer(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace pliant::cli
