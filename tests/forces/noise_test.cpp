#include "pliant/forces/noise.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "support/catch.hpp"

using namespace pliant;
using pliant::testing::WithinAbs;

namespace {

// A uniformly random place in a large part of space and time.
struct Sample {
  Vector3d place;
  double time;
};

std::vector<Sample> samples(int count, double extent) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> coordinate(-extent, extent);
  std::vector<Sample> all;
  for (int k = 0; k < count; ++k) {
    Sample sample;
    for (double& x : sample.place) x = coordinate(random);
    sample.time = coordinate(random);
    all.push_back(sample);
  }
  return all;
}

// Noise at a place moved along one of the four axes of space-time.
Vector3d noise_along(const Sample& from, int axis, double by, std::uint64_t seed = 9) {
  Sample moved = from;
  (axis < 3 ? moved.place[axis] : moved.time) += by;
  return smooth_noise(seed, moved.place, moved.time);
}

}  // namespace

TEST_CASE("noise lies in -1 to 1 and is 0 on average", "[forces][noise]") {
  Vector3d sum = Vector3d::Zero();
  double squares = 0, largest = 0;
  constexpr int count = 40'000;
  for (const Sample& sample : samples(count, 1e4)) {
    const Vector3d value = smooth_noise(3, sample.place, sample.time);
    sum += value;
    squares += value.squaredNorm() / 3;
    largest = std::max(largest, value.cwiseAbs().maxCoeff());
  }
  CHECK(largest <= 1);
  CHECK(largest > 0.75);
  // A corner's variance is 1/3; on average a blend has m^4 of it, m = mean of w^2 + (1-w)^2.
  double m = 0;
  for (int k = 0; k < 1000; ++k) {
    const double f = (k + 0.5) / 1000, w = f * f * f * (f * (6 * f - 15) + 10);
    m += (w * w + (1 - w) * (1 - w)) / 1000;
  }
  const double variance = std::pow(m, 4) / 3;
  CHECK_THAT(squares / count, WithinAbs(variance, 0.03 * variance));
  // Independent places: five standard deviations of the mean.
  for (const double mean : sum / count) {
    CHECK(std::abs(mean) < 5 * std::sqrt(variance / count));
  }
}

TEST_CASE("corners of the lattice are evenly distributed and independent", "[forces][noise]") {
  std::vector<int> bins(10);
  double neighbours = 0, components = 0, seeds = 0;
  constexpr int side = 24, count = side * side * side;
  for (int x = 0; x < side; ++x) {
    for (int y = 0; y < side; ++y) {
      for (int t = 0; t < side; ++t) {
        const Vector3d value = lattice_vector(1, x, y, -7, t);
        ++bins[static_cast<std::size_t>(std::min(9.0, (value.x() + 1) * 5))];
        neighbours += value.x() * (lattice_vector(1, x + 1, y, -7, t).x() +
                                   lattice_vector(1, x, y, -7, t + 1).x());
        components += value.x() * value.y() + value.y() * value.z();
        seeds += value.x() * lattice_vector(2, x, y, -7, t).x();
      }
    }
  }
  double chi_squared = 0;
  for (const int bin : bins) chi_squared += std::pow(bin - count / 10.0, 2) / (count / 10.0);
  CHECK(chi_squared < 30);  // 9 degrees of freedom: 1 in 2000
  // Sums of products of independent variables of variance 1/3: five standard deviations.
  const double limit = 5 * std::sqrt(2.0 * count) / 3;
  CHECK(std::abs(neighbours) < limit);
  CHECK(std::abs(components) < limit);
  CHECK(std::abs(seeds) < limit);
}

TEST_CASE("noise takes the corner's vector at a corner", "[forces][noise]") {
  for (const auto& [x, y, z, t] : {std::array{0, 0, 0, 0}, std::array{-3, 5, -1, 12}}) {
    CHECK(smooth_noise(4, Vector3d(x, y, z), t) == lattice_vector(4, x, y, z, t));
  }
}

TEST_CASE("noise and its first two derivatives go on across cells", "[forces][noise]") {
  const int axis = GENERATE(0, 1, 2, 3);
  for (Sample sample : samples(50, 20)) {
    // At a face between two cells the one-sided differences are equal.
    double& coordinate = axis < 3 ? sample.place[axis] : sample.time;
    coordinate = std::round(coordinate);
    const double h = 1e-4;
    const auto f = [&](double by) { return noise_along(sample, axis, by); };
    CHECK((f(h) - f(-h)).norm() < 1e-8);                           // both derivatives are 0: h^3
    CHECK(((f(2 * h) - 2 * f(h) + f(0)) / (h * h)).norm() < 0.2);  // 60 h times a change
    CHECK(((f(-2 * h) - 2 * f(-h) + f(0)) / (h * h)).norm() < 0.2);
  }
  // Nowhere steep: the weight changes by at most 15/8 per cell, between values at most 2 apart.
  for (const Sample& sample : samples(200, 20)) {
    const double h = 1e-5;
    const Vector3d slope = (noise_along(sample, axis, h) - noise_along(sample, axis, -h)) / (2 * h);
    CHECK(slope.cwiseAbs().maxCoeff() < 3.75 + 1e-6);
  }
}

TEST_CASE("noise forgets itself over one cell", "[forces][noise]") {
  const int axis = GENERATE(0, 3);
  const auto correlation = [&](double by) {
    double products = 0, squares = 0;
    for (const Sample& sample : samples(8000, 1e3)) {
      const Vector3d here = noise_along(sample, axis, 0);
      products += here.dot(noise_along(sample, axis, by));
      squares += here.squaredNorm();
    }
    return products / squares;
  };
  CHECK(correlation(0.1) > 0.9);
  CHECK(std::abs(correlation(0.6) - 0.4) < 0.2);
  CHECK(std::abs(correlation(2.0)) < 0.03);  // no common corner
}

TEST_CASE("noise has hardly anything beyond one wave a cell", "[forces][noise]") {
  const int axis = GENERATE(0, 3);
  constexpr int cells = 64, per_cell = 8, count = cells * per_cell;
  // Far from other faces; a Hann window, since a stretch of noise is not periodic.
  std::vector<double> power(count / 2);
  for (const Sample& start : samples(6, 100)) {
    std::vector<double> values(count);
    for (int k = 0; k < count; ++k) {
      const double window = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * k / count);
      values[k] = window * noise_along(start, axis, static_cast<double>(k) / per_cell).x();
    }
    for (int wave = 0; wave < count / 2; ++wave) {
      std::complex<double> sum = 0;
      for (int k = 0; k < count; ++k) {
        sum += values[k] * std::polar(1.0, -2 * std::numbers::pi * wave * k / count);
      }
      power[wave] += std::norm(sum);
    }
  }
  double below = 0, beyond = 0;
  for (int wave = 0; wave < count / 2; ++wave) (wave <= cells ? below : beyond) += power[wave];
  CHECK(beyond < 0.01 * (below + beyond));
  // It is not constant: most of the power is between a tenth of a wave and one wave per cell.
  double slow = 0;
  for (int wave = 0; wave < cells / 10; ++wave) slow += power[wave];
  CHECK(slow < 0.5 * (below + beyond));
}

TEST_CASE("noise is a function of its arguments, whatever was asked before", "[forces][noise]") {
  const std::vector<Sample> all = samples(100, 50);
  std::vector<Vector3d> forwards, backwards;
  for (const Sample& sample : all) {
    forwards.push_back(smooth_noise(7, sample.place, sample.time));
  }
  for (auto sample = all.rbegin(); sample != all.rend(); ++sample) {
    backwards.push_back(smooth_noise(7, sample->place, sample->time));
  }
  std::reverse(backwards.begin(), backwards.end());
  CHECK(forwards == backwards);
}

TEST_CASE("noise has a value however far away", "[forces][noise]") {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double far :
       {1e15, -1e16, 9.3e18, -9.3e18, 1e19, 1e300, -1e308, infinity, -infinity}) {
    const Vector3d here = smooth_noise(1, {far, 0.5, 0.25}, 0.125);
    const Vector3d then = smooth_noise(1, {0.5, 0.25, far}, far);
    CAPTURE(far);
    CHECK(here.cwiseAbs().maxCoeff() <= 1);
    CHECK(then.cwiseAbs().maxCoeff() <= 1);
    CHECK(here == smooth_noise(1, {far, 0.5, 0.25}, 0.125));
  }
  // Even at the limit of double precision, neighbours differ.
  CHECK(smooth_noise(1, {9e15, 0, 0}, 0) != smooth_noise(1, {9e15 + 2, 0, 0}, 0));
}
