#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cli/view/view.hpp"
#include "pliant/core/result.hpp"
#include "viewer/json.hpp"
#include "viewer/png_check.hpp"
#include "viewer/server.hpp"

namespace pliant::cli {

/// Writes a picture of one frame, or a sheet of several, drawn by a headless browser. Returns the
/// exit code.
int picture_view(const ViewOptions& options, std::string_view page);

/// Parses WxH, at most the size of a canvas. Errors: InvalidInput, naming --size.
Result<viewer::PictureSize> parse_size(const std::string& text);

inline constexpr int longest_side = 8192;  ///< of a canvas [px]

/// Checks that there is a browser. Errors: Unwritable if not; `option` is the option that needs
/// one.
Result<void> check_browser(std::string_view option);

/// A headless browser that draws pictures of a bake, one after the other; ended by the destructor.
class PictureTaker {
 public:
  /// Errors: Unwritable if there is no folder for temporary files.
  static Result<PictureTaker> start(std::string_view page);

  PictureTaker(PictureTaker&&) noexcept;
  PictureTaker& operator=(PictureTaker&&) = delete;
  ~PictureTaker();

  /// Requests a picture of one frame, or a sheet of several; `look` in the syntax of --look.
  Result<void> order(const std::vector<int>& frames, viewer::PictureSize size,
                     const std::string& look, viewer::PictureForm form = viewer::PictureForm::Png);
  /// Requests a picture of that size; `job`: what the page shall draw, an object. The browser
  /// starts with the first order, which may be given ahead of the bake. Errors: Unwritable if there
  /// is no browser.
  Result<void> order(viewer::Json job, viewer::PictureSize size,
                     viewer::PictureForm form = viewer::PictureForm::Png);
  /// What to draw: see `ViewBake::packed`, or `SweepBake` for the page of a sweep.
  void publish(std::string packed);
  /// Waits for the next of the pictures ordered, as long as `check` succeeds. Requires: `publish`
  /// was called. Errors: those of `check`; Unwritable if the browser ended or needs too long;
  /// Interrupted.
  Result<std::string> take(const std::function<Result<void>()>& check = nullptr);
  /// Ends the browser.
  void close();

 private:
  struct State;
  explicit PictureTaker(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace pliant::cli
