#include "pliant/files/sequence.hpp"

#include <cerrno>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <system_error>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pliant/files/atomic_file.hpp"
#include "pliant/files/open_folder.hpp"
#include "pliant/files/output_place.hpp"

namespace pliant {
namespace {

// The names of a sequence's files: the frame is between the two parts.
class SequenceName {
 public:
  explicit SequenceName(const std::filesystem::path& pattern) : head_(pattern.filename().string()) {
    std::size_t last = head_.rfind('#');
    if (last == std::string::npos) {
      const std::size_t dot = head_.rfind('.');
      tail_ = head_.substr(dot);
      head_.resize(dot + 1);
    } else {
      const std::size_t first = head_.find_last_not_of('#', last) + 1;
      width_ = last + 1 - first;
      tail_ = head_.substr(last + 1);
      head_.resize(first);
    }
  }

  std::string of(int frame) const {
    return fmt::format("{}{}{:0{}}{}", head_, frame < 0 ? "-" : "", std::abs(std::int64_t{frame}),
                       width_, tail_);
  }

  // The frame of a file with that name, if it belongs to the sequence.
  std::optional<int> frame_in(const std::string& name) const {
    if (name.size() <= head_.size() + tail_.size() || !name.starts_with(head_) ||
        !name.ends_with(tail_)) {
      return {};
    }
    int frame = 0;
    const char* const end = name.data() + name.size() - tail_.size();
    const auto [stop, error] = std::from_chars(name.data() + head_.size(), end, frame);
    if (error != std::errc() || stop != end || of(frame) != name) return {};
    return frame;
  }

 private:
  std::string head_;
  std::string tail_;
  std::size_t width_ = 4;
};

// The content of a regular file, compared from its beginning.
class FileBytes {
 public:
  explicit FileBytes(const std::filesystem::path& file)
      : descriptor_(open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC)) {
    struct stat status = {};
    is_open_ = descriptor_.is_open() && fstat(descriptor_.number(), &status) == 0 &&
               S_ISREG(status.st_mode);
  }

  bool is_open() const { return is_open_; }

  bool next_are(std::string_view bytes) {
    there_.resize(bytes.size());
    return fill() && there_ == bytes;
  }

  bool are_all_read() {
    there_.resize(1);
    return !fill();
  }

  bool flush() const { return flush_descriptor(descriptor_.number()) == 0; }

 private:
  // Fills `there_` from the file; false if the file is too short or cannot be read.
  bool fill() {
    std::size_t done = 0;
    while (done < there_.size()) {
      const ssize_t count = read(descriptor_.number(), there_.data() + done, there_.size() - done);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) return false;
      done += static_cast<std::size_t>(count);
    }
    return true;
  }

  OpenDescriptor descriptor_;
  bool is_open_ = false;
  std::string there_;
};

}  // namespace

std::filesystem::path sequence_file(const std::filesystem::path& pattern, int frame) {
  return pattern.parent_path() / SequenceName(pattern).of(frame);
}

// Lists the folder once, instead of querying each of possibly a million frames.
Result<void> check_sequence(const SurfacePlan& plan) {
  for (const int frame : {plan.first_frame, plan.last_frame}) {  // one has the longest name
    if (auto place = check_output_place(sequence_file(plan.file, frame)); !place) return place;
  }
  const SequenceName name(plan.file);
  const std::filesystem::path parent = std::filesystem::path(plan.file).parent_path();
  std::error_code error;
  for (std::filesystem::directory_iterator entry(parent.empty() ? "." : parent, error), end;
       !error && entry != end; entry.increment(error)) {
    const auto frame = name.frame_in(entry->path().filename().string());
    if (!frame || *frame < plan.first_frame || *frame > plan.last_frame) continue;
    if (auto place = check_output_place(sequence_file(plan.file, *frame)); !place) return place;
  }
  auto probe = AtomicFile::create(sequence_file(plan.file, plan.first_frame));
  if (!probe) return fail(probe.error());
  return {};
}

SequenceWriter::SequenceWriter(const SurfacePlan& plan)
    : pattern_(plan.file), resumes_(plan.resume), should_stop_(plan.should_stop) {}

Result<void> SequenceWriter::write(int frame, const SurfacePose& pose) {
  const std::filesystem::path name = sequence_file(pattern_, frame);
  if (resumes_) {
    const auto is_kept = is_there(name, pose);
    if (!is_kept) return fail(is_kept.error());
    if (*is_kept) {
      ++counts_.kept;
      return {};
    }
  }
  // The names are flushed at the end: losing one loses that frame, just as if the power had failed
  // a moment earlier.
  auto file = AtomicFile::create(name, Flush::Bytes);
  if (!file) return fail(file.error());
  auto written = write_frame(pose, [&](std::string_view bytes) { return file->write(bytes); });
  if (written) written = file->commit();
  if (written) ++counts_.written;
  return written;
}

Result<void> SequenceWriter::finish() { return flush_folder(pattern_); }

// Whether the file has the content to be written; if so, flushes it to the disk. Errors:
// Interrupted.
Result<bool> SequenceWriter::is_there(const std::filesystem::path& file, const SurfacePose& pose) {
  FileBytes bytes(file);
  if (!bytes.is_open()) return false;
  const auto is_next = [&](std::string_view part) -> Result<void> {
    if (bytes.next_are(part)) return {};
    return fail(ErrorCode::Unreadable, "differs");
  };
  const auto compared = write_frame(pose, is_next);
  if (!compared && compared.error().code == ErrorCode::Interrupted) return fail(compared.error());
  return compared && bytes.are_all_read() && bytes.flush();
}

}  // namespace pliant
