#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "pliant/core/result.hpp"
#include "png_check.hpp"
#include "view.hpp"

namespace pliant::cli {

/// Writes a picture of one frame, or a sheet of several, which a browser without a window draws.
/// Gives the exit code.
int picture_view(const ViewOptions& options, std::string_view page);

/// WxH, as large as a canvas may be. Errors: InvalidInput, naming --size.
Result<PictureSize> parse_size(const std::string& text);

/// Whether there is a browser. Errors: Unwritable, if not; `option` needs one.
Result<void> check_browser(std::string_view option);

/// A folder that is gone with its owner.
class ScratchFolder {
 public:
  static Result<ScratchFolder> make();
  ScratchFolder(ScratchFolder&& other) noexcept : path_(std::exchange(other.path_, {})) {}
  ScratchFolder& operator=(ScratchFolder&&) = delete;
  ~ScratchFolder();

  const std::string& path() const { return path_; }

 private:
  explicit ScratchFolder(std::string path) : path_(std::move(path)) {}

  std::string path_;
};

/// A browser without a window that draws pictures of a bake, one after the other; ended with its
/// owner.
class PictureTaker {
 public:
  /// `packed`: see `ViewBake`. Errors: Unwritable, if there is no browser.
  static Result<PictureTaker> start(std::string_view page, std::string packed);

  PictureTaker(PictureTaker&&) noexcept;
  PictureTaker& operator=(PictureTaker&&) = delete;
  ~PictureTaker();

  /// Asks for a picture of one frame, or for a sheet of several; `look` as --look has it.
  void order(const std::vector<int>& frames, PictureSize size, const std::string& look);
  /// The picture that was asked for, a PNG file; waits for it. Errors: Unwritable, if the browser
  /// ended or takes too long; Interrupted.
  Result<std::string> take();

 private:
  struct State;
  explicit PictureTaker(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace pliant::cli
