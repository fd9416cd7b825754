#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "frame_rate.hpp"
#include "pliant/core/result.hpp"

namespace pliant::cli {

/// What a movie file is, by its ending.
enum class MovieFormat { Mp4, Gif, Webm };

/// Errors: InvalidInput, naming the endings that there are.
Result<MovieFormat> movie_format(const std::filesystem::path& file);

/// What is to be written.
struct MoviePlan {
  std::filesystem::path file;
  MovieFormat format = MovieFormat::Mp4;
  FrameRate rate;
  int threads = 0;      ///< that ffmpeg may use; 0: its own choice
  std::string scratch;  ///< an empty folder that is gone later
};

/// Makes a movie of pictures by way of ffmpeg. The file appears whole under its name or not at all.
class MovieWriter {
 public:
  /// Errors: Unwritable, if there is no ffmpeg, or no file can be made there.
  static Result<MovieWriter> start(const MoviePlan& plan);

  MovieWriter(MovieWriter&&) noexcept;
  MovieWriter& operator=(MovieWriter&&) = delete;
  ~MovieWriter();

  /// The next frame, a PNG file; all of one size. Errors: Unwritable, Interrupted.
  Result<void> write(std::string_view picture);
  /// Gives the file its name, and how long it is. [bytes] Errors: as for `write`.
  Result<std::size_t> finish();

 private:
  struct State;
  explicit MovieWriter(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace pliant::cli
