#include "pliant/replay/log_file.hpp"

#include <utility>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/read_file.hpp"
#include "pliant/replay/log_line.hpp"

namespace pliant {
namespace {

constexpr const char* broken_seal =
    "this line does not match its seal: the log was changed after it was recorded";

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
  ++frame_count_;
  return write_line(replay::to_json(frame));
}

Result<void> ReplayLogWriter::finish() {
  if (auto written = write_line(replay::to_json_end(frame_count_)); !written) return written;
  return file_.commit();
}

Result<void> ReplayLogWriter::write_line(std::string json) {
  return file_.write(replay::sealed(std::move(json), seal_) + '\n');
}

ReplayLogReader::ReplayLogReader(std::string name, std::ifstream stream)
    : name_(std::move(name)), stream_(std::move(stream)) {}

Result<ReplayLogReader> ReplayLogReader::open(const std::filesystem::path& file) {
  if (auto readable = check_readable(file); !readable) return fail(readable.error());
  ReplayLogReader reader(file.string(), std::ifstream(file, std::ios::binary));
  if (auto read = reader.read_header(); !read) return fail(read.error());
  return reader;
}

Result<void> ReplayLogReader::read_header() {
  // Checked before a whole line is read, which may be all of some other large file.
  std::string start(replay::first_member.size(), '\0');
  stream_.read(start.data(), static_cast<std::streamsize>(start.size()));
  if (start != replay::first_member) {
    return fail(ErrorCode::InvalidInput, "this is not a replay log", name_);
  }
  auto line = next_line();
  if (!line) return fail(line.error());
  const std::string whole = start + *line;
  // The format version is checked before the seal, which belongs to this version.
  if (const auto format = replay::format_of(whole); format && *format != replay_format) {
    return at_fault(
        fmt::format("the log has format {}; this version reads format {}", *format, replay_format));
  }
  if (!replay::is_sound(whole, seal_)) return at_fault(broken_seal);
  auto header = replay::read_header(whole);
  if (!header) return at_fault("this is not the first line of a replay log");
  header_ = *std::move(header);
  return {};
}

Result<std::optional<ReplayFrame>> ReplayLogReader::next() {
  if (is_at_end_) return std::nullopt;
  const auto line = next_line();
  if (!line) return fail(line.error());
  if (!replay::is_sound(*line, seal_)) return at_fault(broken_seal);
  if (const auto count = replay::read_end(*line)) {
    if (auto read = read_end(*count); !read) return fail(read.error());
    return std::nullopt;
  }
  const long number = header_.start + frame_count_;
  auto frame = replay::read_frame(*line, header_);
  if (!frame || frame->number != number || number > header_.end) {
    return at_fault(fmt::format("this is not frame {} of the log", number));
  }
  ++frame_count_;
  return std::optional(*std::move(frame));
}

Result<void> ReplayLogReader::read_end(long frame_count) {
  if (frame_count != frame_count_ || frame_count != header_.frame_count()) {
    return at_fault(
        fmt::format("the log ends after {} of {} frames", frame_count_, header_.frame_count()));
  }
  if (stream_.peek() != std::ifstream::traits_type::eof()) {
    ++line_;
    return at_fault("there is data after the end of the log");
  }
  is_at_end_ = true;
  return {};
}

Result<std::string> ReplayLogReader::next_line() {
  std::string line;
  ++line_;
  const bool is_there = static_cast<bool>(std::getline(stream_, line));
  // A last line without its newline is truncated, even if only that byte is missing.
  if (is_there && !stream_.eof()) return line;
  if (line_ == 1) return at_fault("the log is truncated: it ends within its first line");
  return at_fault(fmt::format("the log is truncated: it has {} of {} frames", frame_count_,
                              header_.frame_count()));
}

tl::unexpected<Error> ReplayLogReader::at_fault(std::string message) const {
  return fail(ErrorCode::InvalidInput, std::move(message), name_, line_);
}

}  // namespace pliant
