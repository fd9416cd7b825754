#pragma once

#include <memory>
#include <optional>
#include <string>

#include "pliant/core/result.hpp"
#include "viewer/png_check.hpp"

namespace pliant::viewer {

/// A picture as a page sends it.
enum class PictureForm {
  Png,    ///< a file, see `check_png`
  Pixels  ///< the bytes red, green, blue and alpha of each pixel, rows from the top
};

/// An order for the page at `address()`take.
struct PictureOrder {
  std::string job;   ///< a JSON object
  PictureSize size;  ///< of the picture that the page must send
  PictureForm form = PictureForm::Png;
};

/// Serves the viewer's page to browsers of this machine, and notifies it of changes to the scene.
/// Requests without the address's token, from another page, or by a name other than this machine's
/// own are refused; see `Gate`.
class ViewServer {
 public:
  /// Accepts requests from now on. `port` 0: any free port. Errors: Unwritable if the port is in
  /// use.
  static Result<ViewServer> start(std::string page, int port);

  ViewServer(ViewServer&&) noexcept;
  ViewServer& operator=(ViewServer&&) = delete;
  ~ViewServer();  ///< ends all connections

  /// The address of the page, with the token that all its requests need and a slash at its end.
  std::string address() const;

  /// Makes all pages, including open ones, show this bake (see `ViewBake::packed`).
  void publish(std::string packed);
  /// Notifies pages that a new bake has begun. They keep the messages of the last one, if it
  /// failed.
  void tell_working();
  /// Notifies pages that the new bake failed; all pages, also new ones, show the last one that was
  /// published, with these messages: a JSON array of {kind, file, line, text} in one line.
  void tell_failure(const std::string& messages);

  /// The page at `address()`take requests the jobs, and sends one picture for each, in their order.
  /// Until a picture is taken it is in memory: order few ahead.
  void order_picture(PictureOrder order);
  /// Removes and returns the next picture; null if it has not arrived. Errors: InvalidInput if it
  /// is not the picture ordered.
  std::optional<Result<std::string>> take_picture();

 private:
  struct State;
  explicit ViewServer(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace pliant::viewer
