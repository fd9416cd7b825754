#include "cli/view/movie_writer.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "cli/terminal/interrupt.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/atomic_file.hpp"

namespace pliant::cli {
namespace {

tl::unexpected<Error> missing(const std::string& reason) {
  return fail(
      ErrorCode::Unwritable,
      fmt::format("--movie needs ffmpeg to write the movie (Debian package ffmpeg): {}", reason));
}

// A running ffmpeg, which reads bytes from its standard input; killed by the destructor.
class Ffmpeg {
 public:
  // `words` are arguments after those of all runs: no questions, errors only. Relative names are
  // of files in the folder; its messages are written to the file `log` there. Errors: Unwritable
  // if there is no ffmpeg.
  static Result<Ffmpeg> start(const std::vector<std::string>& words, const ScratchFolder& folder) {
    std::vector<std::string> all = {"ffmpeg",    "-hide_banner", "-nostdin",
                                    "-loglevel", "error",        "-y"};
    all.insert(all.end(), words.begin(), words.end());
    const std::string log = folder.path() + "/log";
    const OpenDescriptor messages(
        open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
    Pipe pixels;
    if (!messages.is_open() || !pixels.open()) return missing(std::strerror(errno));
    auto program = SupervisedProgram::start(
        std::move(all), {.input = pixels.reading.number(), .errors = messages.number()}, folder);
    if (!program) return missing(program.error().message);
    const int input = pixels.writing.number();
    fcntl(input, F_SETFL, fcntl(input, F_GETFL) | O_NONBLOCK);
    return Ffmpeg(*std::move(program), std::move(pixels.writing), log);
  }

  Result<void> check_runs() {
    if (program_.code()) return failure();
    return {};
  }

  // Waits until it has read all bytes. Errors: Unwritable with ffmpeg's message if it ended;
  // Interrupted.
  Result<void> write(std::string_view bytes) {
    while (!bytes.empty()) {
      if (was_interrupted()) return interrupted();
      pollfd ready = {input_.number(), POLLOUT, 0};
      if (poll(&ready, 1, static_cast<int>(std::chrono::milliseconds(100).count())) <= 0) continue;
      const ssize_t written = ::write(input_.number(), bytes.data(), bytes.size());
      if (written > 0) {
        bytes.remove_prefix(static_cast<std::size_t>(written));
      } else if (errno != EAGAIN && errno != EINTR) {
        return failure();
      }
    }
    return {};
  }

  // Ends the input and waits until ffmpeg has finished. Errors: as for `write`.
  Result<void> finish() {
    input_ = OpenDescriptor();
    for (;;) {
      if (const auto code = program_.code()) return *code == 0 ? Result<void>() : failure();
      if (was_interrupted()) return interrupted();
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }

 private:
  Ffmpeg(SupervisedProgram program, OpenDescriptor input, std::string log)
      : program_(std::move(program)), input_(std::move(input)), log_(std::move(log)) {}

  // The first line of its log, or the beginning of it: later ones are consequences.
  tl::unexpected<Error> failure() const {
    std::ifstream file(log_);
    constexpr std::size_t longest = 300;
    std::array<char, longest + 1> bytes = {};
    file.getline(bytes.data(), bytes.size());
    const std::string_view line = bytes.data();
    return fail(ErrorCode::Unwritable,
                fmt::format("ffmpeg could not write the movie: {}",
                            line.empty() ? "it gave no reason" : printable(line)));
  }

  SupervisedProgram program_;  // its incomplete output is useless
  OpenDescriptor input_;
  std::string log_;
};

using Words = std::vector<std::string>;

void append(Words& words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
}

// Input of the pixels of all frames.
Words pixels_from(const std::string& source, const MoviePlan& plan) {
  return {"-f",         "rawvideo",         "-pix_fmt",
          "rgba",       "-video_size",      fmt::format("{}x{}", plan.size.width, plan.size.height),
          "-framerate", to_text(plan.rate), "-i",
          source};
}

// Converts screen colours to BT.709, as players expect, and tags the file with it.
const std::string to_yuv_filter =
    "scale=out_color_matrix=bt709:out_range=tv:flags=bicubic+accurate_rnd+full_chroma_int,"
    "format=yuv420p";
const Words to_yuv = {"-vf",   to_yuv_filter, "-colorspace", "bt709",        "-color_primaries",
                      "bt709", "-color_trc",  "bt709",       "-color_range", "tv"};

// Without the version of ffmpeg and the time of day.
const Words plain = {"-an", "-map_metadata", "-1", "-fflags", "+bitexact", "-flags:v", "+bitexact"};

Words words_for(const MoviePlan& plan, const std::string& out) {
  Words words = pixels_from("pipe:0", plan);
  if (plan.threads > 0) append(words, {"-threads", std::to_string(plan.threads)});
  switch (plan.format) {
    case MovieFormat::Mp4:
      append(words, to_yuv);
      append(words, {"-c:v", "libx264", "-preset", "medium", "-crf", "17"});
      append(words, plain);
      append(words, {"-movflags", "+faststart", "-f", "mp4", out});
      break;
    case MovieFormat::Webm:
      append(words, to_yuv);
      append(words, {"-c:v", "libvpx-vp9", "-crf", "20", "-b:v", "0", "-row-mt", "1", "-deadline",
                     "good", "-cpu-used", "4"});
      append(words, plain);
      append(words, {"-f", "webm", out});
      break;
    case MovieFormat::Gif:
      // The first pass finds 256 colours for all frames, and keeps these without loss; the second
      // pass uses them.
      append(words, {"-filter_complex",
                     "[0:v]split[kept][seen];[seen]palettegen=stats_mode=full[colours]",
                     "-map",
                     "[colours]",
                     "-frames:v",
                     "1",
                     "-f",
                     "image2",
                     "-update",
                     "1",
                     out,
                     "-map",
                     "[kept]",
                     "-c:v",
                     "utvideo",
                     "-pix_fmt",
                     "gbrp",
                     "-f",
                     "nut",
                     "frames"});
      break;
  }
  return words;
}

Words gif_words(const std::string& frames, const std::string& palette, const std::string& out) {
  Words words = {
      "-i", frames, "-i", palette, "-filter_complex", "[0:v][1:v]paletteuse=dither=sierra2_4a"};
  append(words, plain);
  append(words, {"-loop", "0", "-f", "gif", out});
  return words;
}

}  // namespace

struct MovieWriter::State {
  MoviePlan plan;
  const ScratchFolder& folder;
  AtomicFile file;
  Ffmpeg ffmpeg;
  std::string scratch(std::string_view name) const {
    return fmt::format("{}/{}", folder.path(), name);
  }

  // The second pass, with the palette.
  Result<void> write_gif() {
    auto second = Ffmpeg::start(gif_words("frames", "palette.png", "movie"), folder);
    if (!second) return fail(second.error());
    return second->finish();
  }

  // Copies the movie from the temporary folder, which may be on another disk, to its place.
  Result<std::size_t> copy() {
    const std::string made = scratch("movie");
    std::error_code unknown;
    const auto kind = std::filesystem::symlink_status(made, unknown).type();
    if (kind != std::filesystem::file_type::regular)
      return fail(ErrorCode::Unwritable, "ffmpeg wrote no movie");
    std::ifstream movie(made, std::ios::binary);
    std::string piece(1 << 20, '\0');
    std::size_t size = 0;
    while (movie) {
      if (was_interrupted()) return interrupted();
      movie.read(piece.data(), static_cast<std::streamsize>(piece.size()));
      const auto count = static_cast<std::size_t>(movie.gcount());
      if (auto written = file.write(std::string_view(piece).substr(0, count)); !written) {
        return fail(written.error());
      }
      size += count;
    }
    if (size == 0) return fail(ErrorCode::Unwritable, "ffmpeg wrote no movie");
    return size;
  }
};

Result<MovieFormat> movie_format(const std::filesystem::path& file) {
  const std::string ending = ending_of(file);
  if (ending == ".mp4") return MovieFormat::Mp4;
  if (ending == ".gif") return MovieFormat::Gif;
  if (ending == ".webm") return MovieFormat::Webm;
  return fail(ErrorCode::InvalidInput,
              fmt::format("--movie {}: no format has the ending \"{}\"; allowed: .mp4, .gif, .webm",
                          printable(file.string()), printable(ending)));
}

MovieWriter::MovieWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
MovieWriter::MovieWriter(MovieWriter&&) noexcept = default;
MovieWriter::~MovieWriter() = default;

Result<MovieWriter> MovieWriter::start(const MoviePlan& plan, const ScratchFolder& folder) {
  auto file = AtomicFile::create(plan.file);
  if (!file) return fail(file.error());
  const bool is_gif = plan.format == MovieFormat::Gif;
  auto ffmpeg = Ffmpeg::start(words_for(plan, is_gif ? "palette.png" : "movie"), folder);
  if (!ffmpeg) return fail(ffmpeg.error());
  auto state = std::make_unique<State>(State{plan, folder, *std::move(file), *std::move(ffmpeg)});
  return MovieWriter(std::move(state));
}

Result<void> MovieWriter::check_runs() { return state_->ffmpeg.check_runs(); }

Result<void> MovieWriter::write(std::string_view picture) { return state_->ffmpeg.write(picture); }

Result<std::size_t> MovieWriter::finish() {
  if (auto done = state_->ffmpeg.finish(); !done) return fail(done.error());
  if (state_->plan.format == MovieFormat::Gif) {
    if (auto done = state_->write_gif(); !done) return fail(done.error());
  }
  const auto size = state_->copy();
  if (!size) return fail(size.error());
  if (auto done = state_->file.commit(); !done) return fail(done.error());
  return *size;
}

}  // namespace pliant::cli
