#include <algorithm>
#include <chrono>
#include <functional>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands/inputs.hpp"
#include "cli/commands/look.hpp"
#include "cli/commands/scene_input.hpp"
#include "cli/terminal/child.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/output_file.hpp"
#include "cli/terminal/progress.hpp"
#include "cli/terminal/report.hpp"
#include "cli/view/movie_writer.hpp"
#include "cli/view/view.hpp"
#include "cli/view/view_picture.hpp"
#include "cli/view/view_scene.hpp"
#include "pliant/core/memory_budget.hpp"

namespace pliant::cli {
namespace {

// The properties of a movie that are known before making it.
struct Plan {
  MovieFormat format = MovieFormat::Mp4;
  viewer::PictureSize size;
  FrameRate rate;
};

Result<void> check_programs() {
  if (!is_on_path("ffmpeg")) {
    return fail(
        ErrorCode::Unwritable,
        "--movie needs ffmpeg to write the movie (Debian package ffmpeg); it is not on the PATH");
  }
  return check_browser("--movie");
}

Result<Plan> make_plan(const ViewOptions& options, const Scene& scene) {
  const std::string name = printable(*options.movie);
  if (auto free = check_no_input("--movie", *options.movie, scene); !free)
    return fail(free.error());
  const auto format = movie_format(*options.movie);
  if (!format) return fail(format.error());
  const auto size = parse_size(options.size);
  if (!size) return fail(size.error());
  if (*format != MovieFormat::Gif && (size->width % 2 != 0 || size->height % 2 != 0)) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("--size {}: the width and height of a .mp4 or .webm must be even",
                            options.size));
  }
  const auto rate = frame_rate(scene.fps);
  if (!rate) {
    return fail(
        ErrorCode::InvalidInput,
        fmt::format("--movie {}: the scene has {} frames per second; a movie can have {} to {}",
                    name, scene.fps, least_rate, most_rate));
  }
  if (*format == MovieFormat::Gif && scene.fps > 50) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("--movie {}: the scene has {} frames per second; a .gif can have at "
                            "most 50, .mp4 and .webm more",
                            name, scene.fps));
  }
  return Plan{*format, *size, *rate};
}

// Orders frames of a movie, some ahead of those that it takes: the browser draws them meanwhile.
class FrameTaker {
 public:
  FrameTaker(PictureTaker& taker, const FrameSpan& frames, const Plan& plan, std::string look)
      : taker_(taker), frames_(frames), plan_(plan), look_(std::move(look)), next_(frames.first) {}

  Result<void> order_ahead() {
    const std::size_t bytes = std::size_t{4} * static_cast<std::size_t>(plan_.size.width) *
                              static_cast<std::size_t>(plan_.size.height);
    const std::size_t ahead = std::clamp<std::size_t>(most_waiting / bytes, 1, 4);
    for (; next_ <= frames_.last && waiting_ < ahead; ++next_, ++waiting_) {
      auto ordered = taker_.order({next_}, plan_.size, look_, viewer::PictureForm::Pixels);
      if (!ordered) return ordered;
    }
    return {};
  }

  Result<std::string> take(const std::function<Result<void>()>& check) {
    auto picture = taker_.take(check);
    --waiting_;
    if (auto ordered = order_ahead(); !ordered) return fail(ordered.error());
    return picture;
  }

 private:
  static constexpr std::size_t most_waiting = 100'000'000;  // [bytes]

  PictureTaker& taker_;
  FrameSpan frames_;
  Plan plan_;
  std::string look_;
  int next_;                 // to be ordered
  std::size_t waiting_ = 0;  // ordered, and not taken yet
};

Result<void> write_frames(FrameTaker& taker, MovieWriter& movie, const FrameSpan& frames,
                          bool is_quiet) {
  Progress progress(frames.count(), is_quiet);
  for (int frame = frames.first; frame <= frames.last; ++frame) {
    const auto picture = taker.take([&] { return movie.check_runs(); });
    const auto written = picture ? movie.write(*picture) : fail(picture.error());
    if (!written) return fail(with_frame(written.error(), frame));
    progress.advance();
  }
  return {};
}

// Its size in bytes and its number of frames.
struct Movie {
  std::size_t size = 0;
  int frame_count = 0;
};

Result<Movie> make_movie(const ViewOptions& options, std::string_view page) {
  // All checks that do not need a run come first.
  if (auto format = movie_format(*options.movie); !format) return fail(format.error());
  if (auto look = check_look(options.look); !look) return fail(look.error());
  auto scene = read_scene(options.scene, options.root, options.changes);
  if (!scene) return fail(scene.error());
  const auto plan = make_plan(options, *scene);
  if (!plan) return fail(plan.error());
  const auto range = parse_frames(options.frames, *scene);
  if (!range) return fail(range.error());
  if (auto found = check_programs(); !found) return fail(found.error());
  const auto folder = ScratchFolder::make();
  if (!folder) return fail(folder.error());
  auto movie = MovieWriter::start({.file = *options.movie,
                                   .format = plan->format,
                                   .size = plan->size,
                                   .rate = plan->rate,
                                   .threads = options.resources.threads},
                                  *folder);
  if (!movie) return fail(movie.error());
  auto taker = PictureTaker::start(page);
  if (!taker) return fail(taker.error());
  FrameTaker pictures(*taker, *range, *plan, options.look);
  // The browser starts while the scene is baked.
  if (auto ordered = pictures.order_ahead(); !ordered) return fail(ordered.error());
  auto baked = bake_scene(*std::move(scene), options, &was_interrupted);
  if (!baked) return fail(baked.error());
  taker->publish(std::move(baked->bake.packed));
  if (auto written = write_frames(pictures, *movie, *range, options.is_quiet); !written)
    return fail(written.error());
  taker->close();  // ahead of the rest of ffmpeg's work
  const auto size = movie->finish();
  if (!size) return fail(size.error());
  return Movie{*size, range->count()};
}

}  // namespace

int movie_view(const ViewOptions& options, std::string_view page) {
  const auto begin = std::chrono::steady_clock::now();
  const auto movie = make_movie(options, page);
  if (!movie) return report(with_kept(movie.error(), "no movie was written"));
  if (options.is_quiet) return exit_done;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  print(stdout,
        fmt::format("{}: {} frames, {} pixels, {}, {:.2f} s\n", printable(*options.movie),
                    movie->frame_count, options.size, bytes_text(movie->size), elapsed.count()));
  return exit_done;
}

}  // namespace pliant::cli
