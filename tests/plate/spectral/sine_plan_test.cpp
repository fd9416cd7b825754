#include "pliant/plate/spectral/sine_plan.hpp"

#include <cmath>
#include <vector>

#include "pliant/plate/plate_solver.hpp"
#include "pliant/plate/spectral/primes.hpp"
#include "support/catch.hpp"

using namespace pliant;

namespace {

// Transforms `lanes` columns.
std::vector<double> transformed(const SinePlan& plan, const PlateKernels& kernels,
                                std::vector<double> points) {
  std::vector<double> work(static_cast<std::size_t>(sine_work(plan.view()) * kernels.lanes));
  kernels.sine_transform(plan.view(), points.data(), work.data());
  return points;
}

std::vector<double> random_points(int count) {
  std::vector<double> points;
  unsigned state = 7;
  for (int k = 0; k < count; ++k) {
    state = state * 1664525 + 1013904223;
    points.push_back(state / 2147483648.0 - 1);
  }
  return points;
}

// By the definition, in extended precision; the angle is reduced in integers.
std::vector<long double> defined(int length, const std::vector<double>& x) {
  const long double pi = std::acos(-1.0L);
  std::vector<long double> sines;
  for (long n = 0; n < 2L * length; ++n) {
    sines.push_back(std::sin(pi * static_cast<long double>(n) / length));
  }
  std::vector<long double> sums;
  for (long k = 1; k < length; ++k) {
    long double sum = 0;
    for (long j = 1; j < length; ++j) sum += x[j - 1] * sines[j * k % (2L * length)];
    sums.push_back(sum);
  }
  return sums;
}

double norm(const std::vector<double>& x) {
  double sum = 0;
  for (const double number : x) sum += number * number;
  return std::sqrt(sum);
}

// Lengths with small primes only, odd and even, with each radix; squares, twice and three times a
// large prime; all primes to 600, and larger ones whose halves have small primes only, or not.
std::vector<int> lengths() {
  std::vector<int> lengths{2,  4,  6,   8,   9,   10,  12,  14,  16,  18,  20,  21,  22,
                           25, 26, 30,  60,  100, 128, 143, 243, 360, 400, 480, 625, 1000,
                           34, 38, 201, 289, 361, 394, 478, 502, 537, 994, 1007};
  for (int length = 3; length < 600; ++length) {
    if (is_prime(length)) lengths.push_back(length);
  }
  lengths.insert(lengths.end(), {719, 787, 1009, 1999});
  return lengths;
}

}  // namespace

TEST_CASE("kernels are as wide as they may be, but no narrower than there are",
          "[plate][spectral]") {
  for (int k = 0; runnable_kernels(k); ++k) {
    const PlateKernels* const kernels = runnable_kernels(k);
    CHECK(&kernels_of_width(kernels->lanes) == kernels);
    if (k > 0) CHECK(&kernels_of_width(runnable_kernels(k - 1)->lanes - 1) == kernels);
  }
  CHECK(&kernels_of_width(widest_lanes) == runnable_kernels(0));
  CHECK(&kernels_of_width(0) == &baseline_kernels);
}

TEST_CASE("a point of a turn is right to an ulp or two", "[plate][spectral]") {
  const long double pi = std::acos(-1.0L);
  for (const long n : {1L, 2L, 3L, 8L, 12L, 360L, 1001L}) {
    for (long k = 0; k < 2 * n; ++k) {
      const TurnPoint point = turn_point(k, n);
      const long double angle = 2 * pi * static_cast<long double>(k % n) / n;
      CHECK(std::abs(static_cast<double>(std::cos(angle) - point.cosine)) <= 2.3e-16);
      CHECK(std::abs(static_cast<double>(std::sin(angle) - point.sine)) <= 2.3e-16);
    }
  }
  CHECK(turn_point(1, 4).cosine == 0);  // exact if the value is representable
  CHECK(turn_point(1, 2).sine == 0);
}

TEST_CASE("the sine transform is what its definition says", "[plate][spectral]") {
  const PlateKernels& kernels = *runnable_kernels(0);
  for (const int length : lengths()) {
    CAPTURE(length);
    const SinePlan plan(length);
    const int points = length - 1;
    const std::vector<double> x = random_points(points * kernels.lanes);
    const std::vector<double> y = transformed(plan, kernels, x);
    for (const int lane : {0, kernels.lanes - 1}) {
      std::vector<double> column, difference;
      for (int j = 0; j < points; ++j) column.push_back(x[j * kernels.lanes + lane]);
      const std::vector<long double> expected = defined(length, column);
      for (int k = 0; k < points; ++k) {
        difference.push_back(static_cast<double>(expected[k] - y[k * kernels.lanes + lane]));
      }
      // The transform is sqrt(L/2) times an orthogonal one, with a few roundings per stage. A
      // convolution has two transforms, and a chirp rotates all points by rounded angles twice.
      const double stages = plan.view().chirp ? 8 : plan.view().kernel ? 4 : 2;
      CHECK(norm(difference) <= stages * 2.2e-16 * std::sqrt(length / 2.0) * norm(column));
    }
  }
}

TEST_CASE("the sine transform is its own inverse", "[plate][spectral]") {
  const PlateKernels& kernels = *runnable_kernels(0);
  for (const int length : {400, 401, 479, 719, 1000, 1006, 2000, 2003}) {
    const SinePlan plan(length);
    const std::vector<double> x = random_points((length - 1) * kernels.lanes);
    std::vector<double> y = transformed(plan, kernels, transformed(plan, kernels, x));
    for (std::size_t k = 0; k < x.size(); ++k) y[k] = y[k] * (2.0 / length) - x[k];
    CHECK(norm(y) <= (plan.view().kernel ? 3e-15 : 1e-15) * norm(x));
  }
}

TEST_CASE("every width of vectors transforms to the same bits", "[plate][spectral]") {
  for (const int length : lengths()) {
    CAPTURE(length);
    const SinePlan plan(length);
    const int points = length - 1;
    const std::vector<double> columns = random_points(points * 8);  // point by point
    std::vector<double> first;
    for (int which = 0; runnable_kernels(which); ++which) {
      const PlateKernels& kernels = *runnable_kernels(which);
      std::vector<double> result(columns.size());
      for (int begin = 0; begin < 8; begin += kernels.lanes) {
        std::vector<double> tile;
        for (int j = 0; j < points; ++j) {
          for (int lane = 0; lane < kernels.lanes; ++lane) {
            tile.push_back(columns[j * 8 + begin + lane]);
          }
        }
        tile = transformed(plan, kernels, tile);
        for (int j = 0; j < points; ++j) {
          for (int lane = 0; lane < kernels.lanes; ++lane) {
            result[j * 8 + begin + lane] = tile[j * kernels.lanes + lane];
          }
        }
      }
      if (which == 0) first = result;
      CHECK((result == first));
    }
  }
}

TEST_CASE("two columns at once are transformed by the definition too, to the same bits",
          "[plate][spectral]") {
  for (const int length : lengths()) {
    CAPTURE(length);
    const SinePlan plan(length);
    if (!plan.view().places) continue;
    const int points = length - 1;
    const std::vector<double> columns = random_points(points * 16);  // point by point
    std::vector<double> first;
    for (int which = 0; runnable_kernels(which); ++which) {
      const PlateKernels& kernels = *runnable_kernels(which);
      std::vector<double> work(static_cast<std::size_t>(sine_work(plan.view()) * kernels.lanes));
      std::vector<double> result(columns.size());
      for (int begin = 0; begin < 8; begin += kernels.lanes) {
        std::vector<double> tiles[2];
        const auto each = [&](const auto& work_on) {
          for (int tile : {0, 1}) {
            for (int j = 0; j < points; ++j) {
              for (int lane = 0; lane < kernels.lanes; ++lane) {
                work_on(tile, j * kernels.lanes + lane, j * 16 + 8 * tile + begin + lane);
              }
            }
          }
        };
        each([&](int tile, int, int at) { tiles[tile].push_back(columns[at]); });
        kernels.sine_transform_pair(plan.view(), tiles[0].data(), tiles[1].data(), work.data());
        each([&](int tile, int k, int at) { result[at] = tiles[tile][k]; });
      }
      if (which == 0) first = result;
      CHECK((result == first));
    }
    for (const int which : {0, 7}) {
      std::vector<double> both, difference;
      for (const int column : {which, which + 8}) {
        std::vector<double> x;
        for (int j = 0; j < points; ++j) x.push_back(columns[j * 16 + column]);
        const std::vector<long double> expected = defined(length, x);
        for (int k = 0; k < points; ++k)
          difference.push_back(static_cast<double>(expected[k] - first[k * 16 + column]));
        both.insert(both.end(), x.begin(), x.end());
      }
      // Odd coefficients are sums of up to L/2 numbers, each as wrong as one above: a random walk.
      const double roundings = 2 * std::sqrt(length / 2.0);
      CHECK(norm(difference) <= roundings * 2.2e-16 * std::sqrt(length / 2.0) * norm(both));
    }
  }
}

TEST_CASE("a sine transform keeps to the room that it asks for", "[plate][spectral]") {
  for (int length = 2; length < 1200; ++length) {
    CAPTURE(length);
    const SinePlan plan(length);
    CHECK(plan.size() >= static_cast<std::size_t>(length));
    CHECK(plan.size() <= SinePlan::most_size(length));
    const SineView view = plan.view();
    CHECK(sine_work(view) <= 6L * length);
    if (length % 7 != 0 && !is_prime(length)) continue;
    for (int which = 0; runnable_kernels(which); ++which) {
      const PlateKernels& kernels = *runnable_kernels(which);
      const auto used = static_cast<std::size_t>(sine_work(view) * kernels.lanes);
      std::vector<double> work(used + 64, 7.0);
      const std::vector<double> x = random_points((length - 1) * kernels.lanes);
      std::vector<double> points = x;
      points.resize(x.size() + 64, 7.0);
      kernels.sine_transform(view, points.data(), work.data());
      bool is_within = true;
      for (std::size_t k = 0; k < 64; ++k) {
        is_within = is_within && work[used + k] == 7 && points[x.size() + k] == 7;
      }
      CHECK(is_within);
      CHECK(work[used - 1] != 7);  // it uses all of the workspace
      points.resize(x.size());
      CHECK((points == transformed(plan, kernels, x)));  // for any previous content
    }
  }
}
