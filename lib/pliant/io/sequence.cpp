#include "pliant/io/sequence.hpp"

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

#include <fmt/format.h>

#include "pliant/io/atomic_file.hpp"

namespace pliant {

std::filesystem::path sequence_file(const std::filesystem::path& pattern, int frame) {
  std::string name = pattern.filename().string();
  std::size_t last = name.rfind('#');
  std::size_t width = 4;
  if (last == std::string::npos) {
    const std::size_t dot = name.rfind('.');
    name.insert(dot, ".#");
    last = dot + 1;
  } else {
    width = last + 1 - (name.find_last_not_of('#', last) + 1);
  }
  const std::size_t first = name.find_last_not_of('#', last) + 1;
  name.replace(first, last + 1 - first,
               fmt::format("{}{:0{}}", frame < 0 ? "-" : "", std::abs(std::int64_t{frame}), width));
  return pattern.parent_path() / name;
}

Result<void> check_sequence(const SurfacePlan& plan) {
  auto probe = AtomicFile::create(sequence_file(plan.file, plan.first_frame));
  if (!probe) return fail(probe.error());
  return {};
}

SequenceWriter::SequenceWriter(const SurfacePlan& plan)
    : pattern_(plan.file), first_frame_(plan.first_frame) {
  std::error_code unknown;
  while (plan.resume && frames_there_ < plan.frame_count() &&
         std::filesystem::is_regular_file(sequence_file(pattern_, first_frame_ + frames_there_),
                                          unknown)) {
    ++frames_there_;
  }
}

Result<void> SequenceWriter::write(int frame, const Field& positions) {
  const int place = frame - first_frame_;
  if (place < frames_there_)
    return place == 0 || place == frames_there_ - 1 ? compare(frame, positions) : Result<void>();
  auto file = AtomicFile::create(sequence_file(pattern_, frame));
  if (!file) return fail(file.error());
  auto written = write_frame(positions, [&](std::string_view bytes) { return file->write(bytes); });
  return written ? file->commit() : written;
}

// Whether the file that is there is the one that would be written.
Result<void> SequenceWriter::compare(int frame, const Field& positions) {
  const std::filesystem::path name = sequence_file(pattern_, frame);
  std::ifstream file(name, std::ios::binary);
  const auto differs = [&] {
    return fail(ErrorCode::Unwritable,
                fmt::format("cannot be resumed: this is not what the scene gives at frame {}; bake "
                            "without --resume, or to another name",
                            frame),
                name.string());
  };
  std::string there;
  const auto is_next = [&](std::string_view bytes) -> Result<void> {
    there.resize(bytes.size());
    file.read(there.data(), static_cast<std::streamsize>(there.size()));
    if (file.gcount() == static_cast<std::streamsize>(bytes.size()) && there == bytes) return {};
    return differs();
  };
  if (auto same = write_frame(positions, is_next); !same) return same;
  if (file.peek() != std::ifstream::traits_type::eof()) return differs();
  return {};
}

}  // namespace pliant
