#include "pliant/files/line_reader.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "pliant/files/read_file.hpp"

namespace pliant {
namespace {

constexpr std::size_t piece_size = std::size_t{1} << 18U;
constexpr std::size_t longest_with_nul = std::size_t{1} << 18U;  // a hole of a file is longer

}  // namespace

LineReader::LineReader(OpenDescriptor file, std::string name, std::size_t longest,
                       LongLines long_lines, std::uintmax_t begin)
    : file_(std::move(file)),
      name_(std::move(name)),
      longest_(longest),
      long_lines_(long_lines),
      next_(begin) {}

Result<LineReader> LineReader::open(const std::filesystem::path& file, std::size_t longest,
                                    LongLines long_lines, std::uintmax_t begin,
                                    const StopRequest& should_stop) {
  if (auto readable = check_readable(file); !readable) return fail(readable.error());
  int number = -1;
  do {  // a pipe waits for its writer
    if (is_stopped(should_stop)) return interrupted();
    number = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  } while (number < 0 && errno == EINTR);
  const int error = errno;
  LineReader reader(OpenDescriptor(number), file.string(), longest, long_lines, begin);
  if (number < 0) return reader.cannot_read(error);
  if (begin > 0 && lseek(number, static_cast<off_t>(begin), SEEK_SET) < 0)
    return reader.cannot_read(errno);
  return reader;
}

Result<bool> LineReader::begins_with(std::string_view text, const StopRequest& should_stop) {
  while (bytes_.size() - begin_ < text.size()) {
    auto more = read_more(should_stop);
    if (!more || !*more) return more;
  }
  return std::string_view(bytes_).substr(begin_).starts_with(text);
}

Result<std::optional<LineReader::Line>> LineReader::next(const StopRequest& should_stop) {
  const auto refuse = [&](std::string message) {
    return fail(ErrorCode::InvalidInput, std::move(message), name_, line_);
  };
  count_line();
  bool has_nul = false;
  std::uintmax_t dropped = 0;  // of a line that is passed over
  for (std::size_t known = 0;;) {
    const std::string_view rest = std::string_view(bytes_).substr(begin_);
    const std::size_t end = rest.find('\n', known);
    const std::string_view line = rest.substr(0, end);
    has_nul = has_nul || line.find('\0', known) != std::string_view::npos;
    if (has_nul && dropped + line.size() > longest_with_nul)
      return refuse("this line has NUL bytes, which no text has");
    const bool is_too_long = dropped > 0 || line.size() > longest_;
    if (is_too_long && long_lines_ == LongLines::Refuse)
      return refuse(fmt::format("this line is longer than {} KiB", longest_ >> 10U));
    if (end != std::string_view::npos) {
      begin_ += end + 1;
      next_ += dropped + end + 1;
      if (!is_too_long) return Line{line};
      count_line();
      has_nul = false;
      dropped = known = 0;
      continue;
    }
    known = rest.size();
    if (is_too_long) {
      dropped += std::exchange(known, 0);
      begin_ = bytes_.size();
    }
    const auto more = read_more(should_stop);
    if (!more) return fail(more.error());
    if (*more) continue;
    if (known + dropped == 0) return std::nullopt;
    begin_ = bytes_.size();
    return Line{std::string_view(bytes_).substr(begin_ - known), false};
  }
}

void LineReader::count_line() {
  if (line_ < std::numeric_limits<int>::max()) ++line_;
}

// Forgets what is before the next line. False: the file ends.
Result<bool> LineReader::read_more(const StopRequest& should_stop) {
  bytes_.erase(0, std::exchange(begin_, 0));
  const std::size_t size = bytes_.size();
  bytes_.resize(size + piece_size);
  ssize_t count = 0;
  do {
    if (is_stopped(should_stop)) return interrupted();
    count = read(file_.number(), bytes_.data() + size, piece_size);
  } while (count < 0 && errno == EINTR);
  const int error = errno;
  bytes_.resize(size + static_cast<std::size_t>(std::max<ssize_t>(0, count)));
  if (count < 0) return cannot_read(error);
  return count > 0;
}

tl::unexpected<Error> LineReader::cannot_read(int error) const {
  return fail(ErrorCode::Unreadable, std::string("cannot read the file: ") + std::strerror(error),
              name_);
}

}  // namespace pliant
