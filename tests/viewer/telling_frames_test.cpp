#include "viewer/telling_frames.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::viewer;

namespace {

// The course of three vertices, two of which stand still, while one goes `height` up and down.
MotionCourse course_of(int count, const std::function<double(int)>& height,
                       const Matrix3d& linear = Matrix3d::Identity()) {
  const Field rest = Field{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}};
  CourseFollower follower;
  for (int k = 0; k < count; ++k) {
    Field positions = rest;
    positions(2, 1) += height(k);
    Transform transform;
    transform.linear = linear;
    transform.translation = {7.0 * k, 0, 0};
    const double peak = (linear * Vector3d(0, height(k), 0)).norm();
    follower.add(Frame(k, {SurfaceFrame("s", positions, transform, peak)}), {&rest});
  }
  return follower.course();
}

bool has(const std::vector<int>& chosen, int frame) {
  return std::find(chosen.begin(), chosen.end(), frame) != chosen.end();
}

// What holds for every course.
void check_choice(const MotionCourse& course, const std::vector<int>& chosen, int most) {
  const int count = static_cast<int>(course.displaced.size());
  CHECK(static_cast<int>(chosen.size()) == std::min(count, most));
  CHECK(std::adjacent_find(chosen.begin(), chosen.end(), std::greater_equal<>()) == chosen.end());
  CHECK(chosen.front() == 0);
  CHECK(chosen.back() == count - 1);
  const auto peak = std::max_element(course.displaced.begin(), course.displaced.end());
  CHECK(has(chosen, static_cast<int>(peak - course.displaced.begin())));
}

}  // namespace

TEST_CASE("frames that tell a motion are its peaks and where it turns", "[viewer][telling]") {
  // Six swings about rest, each of 11 frames, that fade; then the surface is still.
  const auto ring = [](int k) {
    return k > 66 ? 0 : std::exp(-k / 40.0) * std::sin(std::numbers::pi * k / 11);
  };
  const MotionCourse course = course_of(120, ring);
  for (const int most : {6, 12}) check_choice(course, telling_frames(course, most), most);
  const std::vector<int> chosen = telling_frames(course, 12);
  for (int k = 1; k < 66; ++k) {
    const bool turns = (ring(k) - ring(k - 1)) * (ring(k + 1) - ring(k)) < 0;
    INFO(k);
    CHECK((course.turns[k] < 0) == turns);
    if (turns) CHECK(has(chosen, k));
  }
  // Where it swings through rest it is fastest, and tells least.
  for (int k = 11; k < 66; k += 11) CHECK_FALSE(has(chosen, k));
}

TEST_CASE("a motion that stops on its way back turns there", "[viewer][telling]") {
  const auto height = [](int k) {
    return k < 20 ? k / 20.0 : k < 34 ? 1 - (k - 20) / 20.0 : k < 54 ? 0.3 + (k - 34) / 20.0 : 1.3;
  };
  const MotionCourse course = course_of(100, height);
  const std::vector<int> chosen = telling_frames(course, 6);
  check_choice(course, chosen, 6);
  for (const int k : {20, 34, 54}) CHECK(has(chosen, k));
}

TEST_CASE("tremor does not crowd out what moves far", "[viewer][telling]") {
  // Pressed down and kept there, it trembles at every frame; later it is lifted a little.
  const auto height = [](int k) {
    const double tremor = k > 20 && k < 90 ? 1e-5 * (k % 2) : 0;
    return -2 * std::min(k / 20.0, 1.0) + tremor + (k >= 90 ? std::min((k - 89) / 5.0, 1.0) : 0);
  };
  const MotionCourse course = course_of(110, height);
  const std::vector<int> chosen = telling_frames(course, 8);
  check_choice(course, chosen, 8);
  // The widest gap is no wider than even frames would leave it, twice: the rest is spread.
  int widest = 0;
  for (std::size_t n = 1; n < chosen.size(); ++n)
    widest = std::max(widest, chosen[n] - chosen[n - 1]);
  CHECK(widest <= 2 * 109 / 7 + 1);
}

TEST_CASE("frames are spread where nothing moves, and all are chosen if they are few",
          "[viewer][telling]") {
  const MotionCourse still = course_of(97, [](int) { return 0.0; });
  CHECK(std::all_of(still.steps.begin(), still.steps.end(), [](double x) { return x == 0; }));
  CHECK(telling_frames(still, 9) == std::vector<int>{0, 12, 24, 36, 48, 60, 72, 84, 96});
  for (const int count : {1, 2, 5, 12, 13, 14}) {
    const MotionCourse course = course_of(count, [](int k) { return k % 2; });
    const std::vector<int> chosen = telling_frames(course, 12);
    CHECK(static_cast<int>(chosen.size()) == std::min(count, 12));
    CHECK(chosen.back() == count - 1);
  }
}

TEST_CASE("a course is measured in the world, apart from the transform", "[viewer][telling]") {
  const auto height = [](int k) { return 0.1 * k * (20 - k); };
  const Matrix3d linear = Vector3d(2, -3, 0.5).asDiagonal();
  const MotionCourse course = course_of(21, height, linear);
  for (int k = 0; k < 21; ++k) {
    CHECK_THAT(course.displaced[k], WithinAbs(3 * height(k), 1e-12));
    if (k > 0)
      CHECK_THAT(course.steps[k], WithinAbs(3 * std::abs(height(k) - height(k - 1)), 1e-12));
  }
}
