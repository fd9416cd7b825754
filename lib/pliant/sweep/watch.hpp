#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant {

class LogReader;

/// Counts takes of a sweep that end in other processes, by what is added to its log from now on.
/// A look costs one at the size of each file of the log, and what was added.
class SweepWatch {
 public:
  /// For the takes that are true. Errors: Unreadable; Interrupted.
  static Result<SweepWatch> begin(const std::string& folder, std::vector<bool> takes,
                                  const StopRequest& should_stop = {});

  SweepWatch(SweepWatch&&) noexcept;
  SweepWatch& operator=(SweepWatch&&) = delete;
  ~SweepWatch();

  /// Errors: Unreadable; Interrupted.
  Result<void> look(const StopRequest& should_stop = {});

  std::size_t ended() const { return ended_; }    ///< each take once
  std::size_t failed() const { return failed_; }  ///< among these

 private:
  SweepWatch(std::unique_ptr<LogReader> reader, std::vector<bool> takes);

  std::unique_ptr<LogReader> reader_;
  std::vector<bool> takes_;  // that did not end yet
  std::size_t ended_ = 0, failed_ = 0;
};

}  // namespace pliant
