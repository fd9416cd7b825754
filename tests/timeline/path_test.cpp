#include "pliant/timeline/path.hpp"

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "pliant/timeline/position.hpp"
#include "support/catch.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

using Places = std::vector<Value<3>>;

Places random_places(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-5, 5);
  Places places;
  for (int k = 0; k < count; ++k) {
    const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
    places.push_back({x, y, z});
  }
  return places;
}

double distance(const Value<3>& a, const Value<3>& b) {
  return std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]);
}

/// The centripetal spline by Barry and Goldman's pyramid, which has no formula in common with Path:
/// `count` points on the segment from p[1] to p[2].
Places pyramid(const Places& p, int count) {
  double t[4] = {0, 0, 0, 0};
  for (int k = 0; k < 3; ++k) t[k + 1] = t[k] + std::sqrt(distance(p[k], p[k + 1]));
  Places places;
  for (int k = 0; k <= count; ++k) {
    const double at = t[1] + (t[2] - t[1]) * k / count;
    Places row = p;
    for (int level = 1; level < 4; ++level) {
      // At the second level the two middle ones span t[0]..t[2] and t[1]..t[3], at the third
      // t[1]..t[2].
      for (int j = 0; j + level < 4; ++j) {
        const double from = level == 3 ? t[1] : t[j], to = level == 3 ? t[2] : t[j + level];
        for (int c = 0; c < 3; ++c) {
          row[j][c] = ((to - at) * row[j][c] + (at - from) * row[j + 1][c]) / (to - from);
        }
      }
    }
    places.push_back(row[0]);
  }
  return places;
}

/// The length of a polygon, extrapolated to remove the error of its chords (they are too short by
/// h^2).
double length_of(const Places& fine) {
  double all = 0, every_other = 0;
  for (std::size_t k = 1; k < fine.size(); ++k) all += distance(fine[k - 1], fine[k]);
  for (std::size_t k = 2; k < fine.size(); k += 2) every_other += distance(fine[k - 2], fine[k]);
  return all + (all - every_other) / 3;
}

/// Each segment of an open path with the waypoints that determine it; mirrored ones beyond the
/// ends.
std::vector<Places> segments_of(const Places& waypoints) {
  Places all = waypoints;
  const auto mirrored = [](const Value<3>& end, const Value<3>& next) {
    return Value<3>{2 * end[0] - next[0], 2 * end[1] - next[1], 2 * end[2] - next[2]};
  };
  all.insert(all.begin(), mirrored(waypoints[0], waypoints[1]));
  all.push_back(mirrored(waypoints.back(), waypoints[waypoints.size() - 2]));
  std::vector<Places> segments;
  for (std::size_t k = 0; k + 3 < all.size(); ++k) {
    segments.push_back({all.begin() + k, all.begin() + k + 4});
  }
  return segments;
}

TEST_CASE("a share of the way is that share of the length", "[timeline][path]") {
  const unsigned seed = GENERATE(1, 2, 3, 4);
  const Places waypoints = random_places(6, seed);
  const Path path = Path::make(waypoints).value();
  std::vector<double> lengths;
  double total = 0;
  for (const Places& segment : segments_of(waypoints)) {
    lengths.push_back(length_of(pyramid(segment, 20'000)));
    total += lengths.back();
  }
  CHECK_THAT(path.length(), WithinRel(total, 1e-9));
  // The waypoints are at the cumulative lengths of the segments.
  double walked = 0;
  for (std::size_t k = 0; k < waypoints.size(); ++k) {
    CHECK(distance(path.at(walked / total), waypoints[k]) < 1e-8 * total);
    if (k < lengths.size()) walked += lengths[k];
  }
  // And within a segment.
  const Places fine = pyramid(segments_of(waypoints)[2], 20'000);
  const double before = lengths[0] + lengths[1];
  for (const std::size_t k : {2000, 7000, 11'000, 19'998}) {
    const double here = before + length_of({fine.begin(), fine.begin() + k + 1});
    CHECK(distance(path.at(here / total), fine[k]) < 1e-9 * total);
  }
}

TEST_CASE("even progress is even speed", "[timeline][path]") {
  const bool is_closed = GENERATE(false, true);
  const Path path = Path::make(random_places(9, 5), is_closed).value();
  constexpr int steps = 20'000;
  const double step = path.length() / steps;
  for (int k = 0; k < steps; ++k) {
    const double chord = distance(path.at(k / double(steps)), path.at((k + 1) / double(steps)));
    // Chords are too short by curvature^2 step^2 / 24, which is 4e-3 at the sharpest bend here.
    CHECK(chord <= step * (1 + 1e-9));
    CHECK(chord > step * (1 - 1e-2));
  }
}

TEST_CASE("a path begins and ends at its waypoints, exactly", "[timeline][path]") {
  const Places waypoints = random_places(7, 6);
  const Path open = Path::make(waypoints).value();
  const Path closed = Path::make(waypoints, true).value();
  CHECK(open.at(0) == waypoints.front());
  CHECK(open.at(1) == waypoints.back());
  CHECK(open.at(-3) == waypoints.front());
  CHECK(open.at(7) == waypoints.back());
  CHECK(closed.at(0) == waypoints.front());
  CHECK(closed.at(1) == waypoints.front());
  CHECK(closed.length() > open.length());
}

TEST_CASE("a closed path has no corner where it closes", "[timeline][path]") {
  const Path path = Path::make(random_places(5, 7), true).value();
  const double h = 1e-6;
  const Value<3> before = path.at(1 - h), here = path.at(0), after = path.at(h);
  double along = 0;
  for (int c = 0; c < 3; ++c) along += (here[c] - before[c]) * (after[c] - here[c]);
  CHECK_THAT(along / (distance(before, here) * distance(here, after)), WithinAbs(1, 1e-6));
  // A square's corners: by symmetry a quarter of the length is a waypoint.
  const Path square = Path::make({{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}}, true).value();
  CHECK(distance(square.at(0.25), {0, 1, 0}) < 1e-12);
  CHECK(distance(square.at(0.75), {0, -1, 0}) < 1e-12);
}

TEST_CASE("waypoints on a line make a straight way", "[timeline][path]") {
  const Path path = Path::make({{0, 0, 0}, {1, 2, 2}, {1.5, 3, 3}, {10, 20, 20}}).value();
  CHECK_THAT(path.length(), WithinRel(30.0, 1e-13));
  for (const double share : {0.01, 0.3, 0.5, 0.99}) {
    CHECK(distance(path.at(share), {10 * share, 20 * share, 20 * share}) < 1e-11);
  }
}

TEST_CASE("a way that turns back is walked to its turning point", "[timeline][path]") {
  // At the middle waypoint the speed of the spline in its own parameter is 0.
  const Path path = Path::make({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}}).value();
  CHECK_THAT(path.length(), WithinRel(2.0, 1e-12));
  CHECK(distance(path.at(0.5), {1, 0, 0}) < 1e-9);
  CHECK_THAT(path.at(0.25)[0], WithinAbs(0.5, 1e-11));
  CHECK_THAT(path.at(0.9)[0], WithinAbs(0.2, 1e-11));
}

TEST_CASE("a path scales with its waypoints", "[timeline][path]") {
  const double scale = GENERATE(1e-60, 1e-3, 1e140);
  const Places small = random_places(5, 8);
  Places large = small;
  for (Value<3>& place : large)
    for (double& x : place) x *= scale;
  const Path a = Path::make(small).value(), b = Path::make(large).value();
  CHECK_THAT(b.length() / scale, WithinRel(a.length(), 1e-12));
  for (const double share : {0.2, 0.7}) {
    for (int c = 0; c < 3; ++c)
      CHECK_THAT(b.at(share)[c] / scale, WithinAbs(a.at(share)[c], 1e-11));
  }
}

TEST_CASE("waypoints that make no path are told", "[timeline][path]") {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto error = [](Places places, bool is_closed = false) {
    const auto path = Path::make(std::move(places), is_closed);
    REQUIRE_FALSE(path);
    return path.error();
  };
  CHECK(error({}).index == 0);
  CHECK(error({{0, 0, 0}, {1, 0, 0}}).message == "a path must have at least three waypoints");
  CHECK(error({{0, 0, 0}, {1, 0, 0}, {1, 0, 0}}).index == 2);
  CHECK(error({{0, 0, 0}, {1, nan, 0}, {2, 0, 0}}).index == 1);
  CHECK(error({{0, 0, 0}, {1, 1e151, 0}, {2, 0, 0}}).index == 1);
  CHECK(error({{0, 0, 0}, {1, 0, 0}, {0, 0, 0}}, true).index == 0);
  CHECK(error(Places(Path::most_waypoints + 1)).index == Path::most_waypoints + 1);
}

TEST_CASE("whatever the timing, a position stays on its path", "[timeline][position]") {
  const Path path = Path::make(random_places(5, 9)).value();
  const PositionChannel slow = PathMotion{path, make({key(0, 0), key(10, 1)})};
  const PositionChannel retimed =
      PathMotion{path, make({key(0, 0), key(2, 0.8), key(7, 0.1), key(10, 1)})};
  CHECK(slow.is_animated());
  CHECK_FALSE(PositionChannel(PathMotion{path, 0.5}).is_animated());
  for (double frame = 0; frame <= 10; frame += 0.37) {
    const double progress = retimed.path()->progress.at(frame)[0];
    CHECK(retimed.at(frame) == path.at(progress));
    CHECK(slow.at(frame) == path.at(slow.path()->progress.at(frame)[0]));
  }
  CHECK(slow.at(0) == retimed.at(0));
  CHECK(slow.at(10) == retimed.at(10));
}

TEST_CASE("a position without a path is a channel", "[timeline][position]") {
  const PositionChannel constant = Value<3>{1, 2, 3};
  CHECK(constant.at(5) == Value<3>{1, 2, 3});
  CHECK_FALSE(constant.is_animated());
  CHECK(constant.path() == nullptr);
  REQUIRE(constant.channel());
}

}  // namespace
}  // namespace pliant::testing
