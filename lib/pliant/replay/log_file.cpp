#include "pliant/replay/log_file.hpp"

#include <utility>

#include <fmt/format.h>

#include "pliant/replay/log_line.hpp"

namespace pliant {
namespace {

tl::unexpected<Error> is_too_large() {
  return fail(ErrorCode::InvalidInput,
              fmt::format("a line of the log would have more than {} MiB or {} numbers, the most "
                          "that is read again; record fewer states",
                          replay::longest_line >> 20U, replay::most_values));
}

}  // namespace

Result<ReplayLogWriter> ReplayLogWriter::create(const std::filesystem::path& file,
                                                const ReplayHeader& header) {
  auto created = AtomicFile::create(file);
  if (!created) return fail(created.error());
  ReplayLogWriter writer(*std::move(created));
  if (auto written = writer.write_line(replay::to_json(header)); !written) {
    return fail(written.error());
  }
  return writer;
}

Result<void> ReplayLogWriter::write(const ReplayFrame& frame) {
  std::size_t values = 16 * frame.surfaces.size();
  for (const BodyState& state : frame.states)
    values += static_cast<std::size_t>(state.positions.size() + state.velocities.size());
  if (values > replay::most_values) return is_too_large();
  ++frame_count_;
  return write_line(replay::to_json(frame));
}

Result<void> ReplayLogWriter::finish() {
  if (auto written = write_line(replay::to_json_end(frame_count_)); !written) return written;
  return file_.commit();
}

Result<void> ReplayLogWriter::write_line(std::string json) {
  const std::string line = replay::sealed(std::move(json), seal_) + '\n';
  return line.size() <= replay::longest_line ? file_.write(line) : is_too_large();
}

ReplayLogReader::ReplayLogReader(std::string name, LineReader lines)
    : name_(std::move(name)), lines_(std::move(lines)) {}

Result<ReplayLogReader> ReplayLogReader::open(const std::filesystem::path& file,
                                              const StopRequest& should_stop) {
  auto lines =
      LineReader::open(file, replay::longest_line, LineReader::LongLines::Refuse, 0, should_stop);
  if (!lines) return fail(lines.error());
  ReplayLogReader reader(file.string(), *std::move(lines));
  if (auto read = reader.read_header(should_stop); !read) return fail(read.error());
  return reader;
}

Result<void> ReplayLogReader::read_header(const StopRequest& should_stop) {
  // Checked before a whole line is read, which may be all of some other large file.
  const auto is_log = lines_.begins_with(replay::first_member, should_stop);
  if (!is_log) return fail(is_log.error());
  if (!*is_log) return fail(ErrorCode::InvalidInput, "this is not a replay log", name_);
  const auto line = next_line(should_stop);
  if (!line) return fail(line.error());
  // The format version is checked before the seal, which belongs to this version.
  if (const auto format = replay::format_of(*line); format && *format != replay_format) {
    return at_fault(
        fmt::format("the log has format {}; this version reads format {}", *format, replay_format));
  }
  if (auto sound = check_seal(*line, should_stop); !sound) return sound;
  auto header = replay::read_header(*line, should_stop);
  if (!header) return as_told(header.error(), "this is not the first line of a replay log");
  header_ = *std::move(header);
  return {};
}

Result<std::optional<ReplayFrame>> ReplayLogReader::next(const StopRequest& should_stop) {
  if (is_at_end_) return std::nullopt;
  const auto line = next_line(should_stop);
  if (!line) return fail(line.error());
  if (auto sound = check_seal(*line, should_stop); !sound) return fail(sound.error());
  if (replay::is_end(*line)) {
    if (auto read = read_end(*line, should_stop); !read) return fail(read.error());
    return std::nullopt;
  }
  const long number = header_.start + frame_count_;
  const std::string other = fmt::format("this is not frame {} of the log", number);
  auto frame = replay::read_frame(*line, header_, should_stop);
  if (!frame) return as_told(frame.error(), other);
  if (frame->number != number || number > header_.end) return at_fault(other);
  ++frame_count_;
  return std::optional(*std::move(frame));
}

Result<void> ReplayLogReader::read_end(std::string_view line, const StopRequest& should_stop) {
  const auto frame_count = replay::read_end(line);
  if (!frame_count)
    return as_told(frame_count.error(), "this is not the last line of a replay log");
  if (*frame_count != frame_count_ || *frame_count != header_.frame_count()) {
    return at_fault(
        fmt::format("the log ends after {} of {} frames", frame_count_, header_.frame_count()));
  }
  const auto more = lines_.next(should_stop);
  if (!more) return fail(more.error());
  if (*more) return at_fault("there is data after the end of the log");
  is_at_end_ = true;
  return {};
}

Result<std::string_view> ReplayLogReader::next_line(const StopRequest& should_stop) {
  const auto line = lines_.next(should_stop);
  if (!line) return fail(line.error());
  // A last line without its newline is truncated, even if only that byte is missing.
  if (*line && (*line)->is_whole) return (*line)->text;
  if (lines_.line() == 1) return at_fault("the log is truncated: it ends within its first line");
  return at_fault(fmt::format("the log is truncated: it has {} of {} frames", frame_count_,
                              header_.frame_count()));
}

Result<void> ReplayLogReader::check_seal(std::string_view line, const StopRequest& should_stop) {
  const auto is_sound = replay::is_sound(line, seal_, should_stop);
  if (!is_sound) return fail(is_sound.error());
  if (*is_sound) return {};
  return at_fault("this line does not match its seal: the log was changed after it was recorded");
}

tl::unexpected<Error> ReplayLogReader::at_fault(std::string message) const {
  return fail(ErrorCode::InvalidInput, std::move(message), name_, lines_.line());
}

// What is wrong with the content of a line that is sound.
tl::unexpected<Error> ReplayLogReader::as_told(const Error& error, std::string_view what) const {
  if (error.code == ErrorCode::Interrupted) return fail(error);
  return at_fault(fmt::format("{}: {}", what, error.message));
}

}  // namespace pliant
