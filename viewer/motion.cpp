#include "viewer/motion.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <span>
#include <utility>

#include "pliant/files/single_precision.hpp"

namespace pliant::viewer {
namespace {

constexpr double greatest = 32767;
constexpr std::array<int, 6> predictions = {
    prediction::nothing, prediction::nothing + prediction::along,
    prediction::same,    prediction::same + prediction::along,
    prediction::even,    prediction::even + prediction::along};

// Differences are modulo 2^16.
std::uint16_t wrapped(int number) { return static_cast<std::uint16_t>(number); }

// 0, -1, 1, -2, … become 0, 1, 2, 3, …, so that numbers of small magnitude have a small high byte.
std::uint16_t folded(std::uint16_t difference) {
  const bool is_negative = difference >= 0x8000;
  return static_cast<std::uint16_t>((difference << 1) ^ (is_negative ? 0xffff : 0));
}

using Numbers = std::vector<std::int16_t>;

// The prediction error of each number; `before` and `earlier` are one and two frames before.
std::vector<std::uint16_t> misses(int predicted, const Numbers& now, const Numbers& before,
                                  const Numbers& earlier, std::size_t vertex_count) {
  const int along = predicted & prediction::along;
  const int kind = predicted - along;
  const int of_before = kind == prediction::nothing ? 0 : kind == prediction::same ? 1 : 2;
  const int of_earlier = kind == prediction::even ? -1 : 0;
  std::vector<std::uint16_t> result(now.size());
  for (std::size_t component = 0; component < 3; ++component) {
    std::uint16_t last = 0;
    for (std::size_t k = component * vertex_count; k < (component + 1) * vertex_count; ++k) {
      const std::uint16_t missed =
          wrapped(now[k] - of_before * before[k] - of_earlier * earlier[k]);
      result[k] = folded(along != 0 ? wrapped(missed - last) : missed);
      last = missed;
    }
  }
  return result;
}

// Approximate cost of a frame: the total number of bits of its numbers.
std::size_t weight(std::span<const std::uint16_t> numbers) {
  std::array<std::size_t, 17> counts = {};
  for (const std::uint16_t number : numbers) {
    ++counts[static_cast<std::size_t>(std::bit_width(number))];
  }
  std::size_t sum = 0;
  for (std::size_t bits = 1; bits < counts.size(); ++bits) sum += bits * counts[bits];
  return sum;
}

}  // namespace

Json to_json(const PackedMotion& motion, Arrays& arrays) {
  return {{"step", motion.step},
          {"predictors", arrays.add(motion.predictors)},
          {"lowBytes", arrays.add(motion.low)},
          {"highBytes", arrays.add(motion.high)}};
}

MotionPacker::MotionPacker(Field rest, std::vector<int> order)
    : rest_(std::move(rest)), order_(std::move(order)) {}

Result<void> MotionPacker::add(const Field& positions, int frame) {
  if (auto single = to_single(positions, frame); !single) return fail(single.error());
  const Field displacement = positions - rest_;
  std::vector<float> ordered;
  ordered.reserve(3 * vertex_count());
  for (int component = 0; component < 3; ++component) {
    for (const int vertex : order_) {
      ordered.push_back(static_cast<float>(displacement(vertex, component)));
    }
  }
  if (displacement.size() > 0) peak_ = std::max(peak_, displacement.cwiseAbs().maxCoeff());
  displacements_.push_back(std::move(ordered));
  return {};
}

MotionPacker::Numbers MotionPacker::quantised(std::size_t frame, double step) const {
  Numbers numbers(3 * vertex_count(), 0);
  if (step == 0) return numbers;
  std::transform(displacements_[frame].begin(), displacements_[frame].end(), numbers.begin(),
                 [=](float displacement) {
                   const double steps = std::nearbyint(displacement / step);
                   return static_cast<std::int16_t>(std::clamp(steps, -greatest, greatest));
                 });
  return numbers;
}

Result<PackedMotion> MotionPacker::pack(const StopRequest& should_stop) const {
  PackedMotion packed;
  packed.peak = peak_;
  packed.step = peak_ / greatest;
  Numbers before(3 * vertex_count(), 0), earlier = before;
  for (std::size_t frame = 0; frame < displacements_.size(); ++frame) {
    Numbers now = quantised(frame, packed.step);
    int best = prediction::nothing;
    std::vector<std::uint16_t> least = misses(best, now, before, earlier, vertex_count());
    std::size_t least_weight = weight(least);
    for (const int predicted : predictions) {
      if (is_stopped(should_stop)) return interrupted();
      std::vector<std::uint16_t> missed = misses(predicted, now, before, earlier, vertex_count());
      const std::size_t missed_weight = weight(missed);
      if (missed_weight >= least_weight) continue;
      best = predicted;
      least = std::move(missed);
      least_weight = missed_weight;
    }
    packed.predictors.push_back(static_cast<char>(best));
    for (const std::uint16_t number : least) {
      packed.low.push_back(static_cast<char>(number & 0xff));
      packed.high.push_back(static_cast<char>(number >> 8));
    }
    earlier = std::exchange(before, std::move(now));
  }
  return packed;
}

}  // namespace pliant::viewer
