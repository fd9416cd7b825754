#include "pliant/sweep/watch.hpp"

#include <filesystem>
#include <utility>

#include "pliant/sweep/log.hpp"

namespace pliant {

SweepWatch::SweepWatch(std::unique_ptr<LogReader> reader, std::vector<bool> takes)
    : reader_(std::move(reader)), takes_(std::move(takes)) {}
SweepWatch::SweepWatch(SweepWatch&&) noexcept = default;
SweepWatch::~SweepWatch() = default;

Result<SweepWatch> SweepWatch::begin(const std::string& folder, std::vector<bool> takes,
                                     const StopRequest& should_stop) {
  auto reader = std::make_unique<LogReader>(std::filesystem::path(folder) / "log");
  if (auto skipped = reader->skip(should_stop); !skipped) return fail(skipped.error());
  return SweepWatch(std::move(reader), std::move(takes));
}

Result<void> SweepWatch::look(const StopRequest& should_stop) {
  return reader_->read(
      [&](const LogLine& line) {
        if (line.take >= takes_.size() || !takes_[line.take]) return;
        takes_[line.take] = false;
        ++ended_;
        failed_ += line.is_done ? 0 : 1;
      },
      should_stop);
}

}  // namespace pliant
