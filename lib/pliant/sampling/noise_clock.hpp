#pragma once

#include <cstddef>
#include <mutex>
#include <vector>

namespace pliant {

/// The sum of a noise's keyed rate over the frames, so that its pattern never jumps; not for other
/// rooms. docs/model.md, "Forces".
///
/// In frame order it evaluates the rate once per frame. Any other frame needs at most `stride`
/// evaluations, once the frames before it have been summed. The order of summation does not depend
/// on the order of calls, so the bits are the same. Thread-safe.
class NoiseClock {
 public:
  explicit NoiseClock(int start) : start_(start) {}

  /// rate(start) * start + rate(start) + rate(start + 1) + … + rate(frame - 1), added in this
  /// order; ahead of the start, rate(start) * start - rate(start - 1) - … - rate(frame). Requires:
  /// `rate` is the same at each call for the frames before `frame`, or frames never decrease and it
  /// is the same for those not summed yet; for frames ahead of the start, and the start if one was
  /// asked for, it never changes.
  template <class Rate>
  double sum(int frame, const Rate& rate) {
    const std::lock_guard lock(mutex_);
    if (frame < start_) return sum_back(frame, rate);
    if (marks_.empty()) {
      marks_.push_back(rate(start_) * start_);
      go_to_mark(0);
    }
    const auto wanted = static_cast<std::size_t>(frame - start_) / stride;
    const std::size_t mark = wanted < marks_.size() ? wanted : marks_.size() - 1;
    if (frame < frame_ || start_ + static_cast<int>(mark) * stride > frame_) go_to_mark(mark);
    while (frame_ < frame) {
      sum_ += rate(frame_);
      ++frame_;
      const int passed = frame_ - start_;
      if (passed % stride == 0 && static_cast<std::size_t>(passed / stride) == marks_.size()) {
        marks_.push_back(sum_);
      }
    }
    return sum_;
  }

  static constexpr int stride = 64;

 private:
  template <class Rate>
  double sum_back(int frame, const Rate& rate) {
    if (ahead_.empty()) ahead_.push_back(rate(start_) * start_);
    const auto wanted = static_cast<std::size_t>(start_ - frame);
    while (ahead_.size() <= wanted) {
      ahead_.push_back(ahead_.back() - rate(start_ - static_cast<int>(ahead_.size())));
    }
    return ahead_[wanted];
  }

  void go_to_mark(std::size_t mark) {
    frame_ = start_ + static_cast<int>(mark) * stride;
    sum_ = marks_[mark];
  }

  std::mutex mutex_;
  int start_;
  int frame_ = 0;  // the frame of `sum_`
  double sum_ = 0;
  std::vector<double> marks_;  // the sums at start, start + stride, …, as far as summed
  std::vector<double> ahead_;  // those at start, start - 1, …; a preroll is short
};

}  // namespace pliant
