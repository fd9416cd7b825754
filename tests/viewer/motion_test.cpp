#include "viewer/motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numeric>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "support/catch.hpp"

namespace {

using namespace pliant;
using pliant::viewer::MotionPacker;
using pliant::viewer::PackedMotion;

// Frames x (#vertices x 3), decoded as docs/viewer.md describes.
std::vector<Field> unpacked(const PackedMotion& packed, const std::vector<int>& order) {
  const std::size_t count = order.size();
  std::vector<std::vector<long>> frames(2, std::vector<long>(3 * count, 0));
  std::vector<Field> result;
  std::size_t read = 0;
  for (const char predictor : packed.predictors) {
    std::vector<long> now(3 * count);
    const auto& before = frames[frames.size() - 1];
    const auto& earlier = frames[frames.size() - 2];
    for (std::size_t component = 0; component < 3; ++component) {
      long missed_before = 0;
      for (std::size_t k = 0; k < count; ++k, ++read) {
        const long m = static_cast<unsigned char>(packed.low[read]) +
                       256L * static_cast<unsigned char>(packed.high[read]);
        long missed = m % 2 == 0 ? m / 2 : -(m + 1) / 2;
        if ((predictor & 4) != 0) missed += missed_before;
        missed_before = missed;
        const std::size_t place = component * count + k;
        const int kind = predictor & 3;
        const long guess = kind == 0   ? 0
                           : kind == 1 ? before[place]
                                       : 2 * before[place] - earlier[place];
        now[place] = static_cast<std::int16_t>(static_cast<std::uint16_t>(guess + missed));
      }
    }
    Field displacement(static_cast<Eigen::Index>(count), 3);
    for (std::size_t place = 0; place < now.size(); ++place) {
      displacement(order[place % count], static_cast<Eigen::Index>(place / count)) =
          packed.step * static_cast<double>(now[place]);
    }
    frames.push_back(std::move(now));
    result.push_back(displacement);
  }
  return result;
}

struct Motion {
  Field rest;
  std::vector<int> order;
  std::vector<Field> frames;
};

Motion motion(int vertex_count, int frame_count,
              const std::function<double(int vertex, int component, int frame)>& displacement) {
  std::mt19937 random(7);
  Motion result{Field(vertex_count, 3), std::vector<int>(vertex_count), {}};
  std::iota(result.order.begin(), result.order.end(), 0);
  std::shuffle(result.order.begin(), result.order.end(), random);
  for (int k = 0; k < vertex_count; ++k) result.rest.row(k) << k, -0.5 * k, 3;
  for (int frame = 0; frame < frame_count; ++frame) {
    Field positions = result.rest;
    for (int k = 0; k < vertex_count; ++k) {
      for (int c = 0; c < 3; ++c) positions(k, c) += displacement(k, c, frame);
    }
    result.frames.push_back(positions);
  }
  return result;
}

PackedMotion pack(const Motion& motion) {
  MotionPacker packer(motion.rest, motion.order);
  int frame = 1;
  for (const Field& positions : motion.frames) REQUIRE(packer.add(positions, frame++));
  return packer.pack().value();
}

double largest_error(const Motion& motion, const PackedMotion& packed) {
  const auto found = unpacked(packed, motion.order);
  REQUIRE(found.size() == motion.frames.size());
  double error = 0;
  for (std::size_t k = 0; k < found.size(); ++k) {
    error = std::max(error, (motion.rest + found[k] - motion.frames[k]).cwiseAbs().maxCoeff());
  }
  return error;
}

}  // namespace

TEST_CASE("packed motion is within half a step, whatever it does", "[view]") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> anything(-3, 3);
  const std::vector<std::pair<const char*, Motion>> motions = {
      {"noise", motion(50, 20, [&](int, int, int) { return anything(random); })},
      {"from end to end in a frame",
       motion(9, 12, [](int k, int c, int f) { return (k + c + f) % 2 == 0 ? 2.5 : -2.5; })},
      {"a wave",
       motion(80, 40, [](int k, int c, int f) { return c * std::sin(0.1 * k + 0.3 * f); })},
      {"one vertex of many",
       motion(60, 8, [](int k, int c, int f) { return k == 31 && c == 1 ? 1e9 * f : 1e-3; })},
      {"tiny", motion(20, 6, [](int k, int, int f) { return 1e-9 * (k - f); })},
      {"one frame", motion(5, 1, [](int k, int, int) { return k; })}};
  for (const auto& [name, given] : motions) {
    INFO(name);
    const PackedMotion packed = pack(given);
    const double float_rounding = packed.peak * 0x1p-24;
    const double double_rounding = 1e-15 * given.rest.cwiseAbs().maxCoeff();
    CHECK(packed.step == packed.peak / 32767);
    CHECK(largest_error(given, packed) <= 0.5001 * packed.step + float_rounding + double_rounding);
  }
}

TEST_CASE("a surface at rest packs to zeros", "[view]") {
  const PackedMotion packed = pack(motion(30, 5, [](int, int, int) { return 0.0; }));
  CHECK(packed.step == 0);
  CHECK(packed.low == std::string(30 * 3 * 5, '\0'));
  CHECK(packed.high == packed.low);
}

TEST_CASE("each way of prediction is used where it is best", "[view]") {
  const auto predictors = [](const Motion& given) {
    const PackedMotion packed = pack(given);
    return std::set<int>(packed.predictors.begin() + 2, packed.predictors.end());
  };
  // Uniform motion, each vertex in another direction, so that the vertex before does not help the
  // prediction.
  std::mt19937 random(5);
  std::uniform_real_distribution<double> speed(-1, 1);
  std::vector<double> speeds;
  for (int k = 0; k < 300; ++k) speeds.push_back(speed(random));
  const auto even = motion(100, 30, [&](int k, int c, int f) { return f * speeds[3 * k + c]; });
  CHECK(predictors(even) == std::set<int>{pliant::viewer::prediction::even});
  // A constant pose.
  const auto held =
      motion(100, 9, [&](int k, int c, int f) { return f > 0 ? speeds[3 * k + c] : 0; });
  CHECK(predictors(held) == std::set<int>{pliant::viewer::prediction::same});
  // All vertices jump together, to another place at each frame.
  const auto jumping = motion(100, 9, [&](int, int, int f) { return speeds[f]; });
  for (const int predictor : predictors(jumping))
    CHECK((predictor & pliant::viewer::prediction::along));
}

TEST_CASE("a position beyond float is an error that names its frame and vertex", "[view]") {
  MotionPacker packer(Field::Zero(2, 3), {0, 1});
  Field positions = Field::Zero(2, 3);
  positions(1, 2) = 1e39;
  const auto added = packer.add(positions, 17);
  REQUIRE_FALSE(added);
  CHECK(added.error().code == ErrorCode::NotFinite);
  CHECK(added.error().message.find("vertex 1 at frame 17") != std::string::npos);
}
