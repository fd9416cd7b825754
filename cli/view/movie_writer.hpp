#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "cli/commands/frame_rate.hpp"
#include "cli/terminal/supervised_program.hpp"
#include "pliant/core/result.hpp"
#include "viewer/png_check.hpp"

namespace pliant::cli {

/// The format of a movie file, by its extension.
enum class MovieFormat { Mp4, Gif, Webm };

/// Errors: InvalidInput, naming the known extensions.
Result<MovieFormat> movie_format(const std::filesystem::path& file);

/// The movie to write.
struct MoviePlan {
  std::filesystem::path file;
  MovieFormat format = MovieFormat::Mp4;
  viewer::PictureSize size;
  FrameRate rate;
  int threads = 0;  ///< of ffmpeg; 0: its own choice
};

/// Makes a movie from pictures with ffmpeg. The file appears complete under its name or not at all.
class MovieWriter {
 public:
  /// `folder`: empty, for temporary files; must outlive the writer. Errors: Unwritable if there is
  /// no ffmpeg, or the file cannot be made.
  static Result<MovieWriter> start(const MoviePlan& plan, const ScratchFolder& folder);

  MovieWriter(MovieWriter&&) noexcept;
  MovieWriter& operator=(MovieWriter&&) = delete;
  ~MovieWriter();

  /// Errors: Unwritable with ffmpeg's message if it ended too early.
  Result<void> check_runs();
  /// Adds the next frame: its pixels, as `PictureForm::Pixels`. Errors: Unwritable, Interrupted.
  Result<void> write(std::string_view picture);
  /// Gives the file its name, and returns its size. [bytes] Errors: as for `write`.
  Result<std::size_t> finish();

 private:
  struct State;
  explicit MovieWriter(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace pliant::cli
