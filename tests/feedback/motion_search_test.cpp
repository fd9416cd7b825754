#include "pliant/feedback/motion_search.hpp"

#include <cmath>
#include <numbers>

#include "support/catch.hpp"

using namespace pliant;
using Catch::Matchers::WithinRel;

namespace {

constexpr double frame = 1.0 / 24;

// One vibration, or two, in frames with steps of dt.
RegionMotion motion(Integrator integrator, double dt, std::vector<ExcitedMode> modes = {{3e3, 1}},
                    double time_scale = 1) {
  const double interval = frame * time_scale;
  RegionMotion one{.modes = std::move(modes), .slowest = 3e3};
  one.frame_seconds = frame;
  one.interval = interval;
  one.creeping = divide_interval(interval, dt, Stepping::Exact);
  one.still = one.creeping;
  one.swinging = one.creeping;
  one.swinging.integrator = integrator;
  if (integrator == Integrator::Exact)
    one.swinging = one.creeping = {1, interval, Integrator::Exact};
  return one;
}

Dynamics felt(const RegionMotion& one, const Material& material) {
  return one.felt(material.density, material.damping);
}

double settling(const RegionMotion& one, const Material& material) {
  return one.settling(felt(one, material)).time;
}

double frequency(const RegionMotion& one, const Material& material) {
  return one.swing(felt(one, material)).frequency;
}

// A number between 0 and 1, the same in every run.
class Numbers {
 public:
  double between(double low, double high) {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return low + (high - low) * static_cast<double>(state_ >> 11U) / 9007199254740992.0;
  }

 private:
  std::uint64_t state_ = 1;
};

}  // namespace

TEST_CASE("a material that is found has the frequency and the settling that it is found for",
          "[feedback][suggest]") {
  Numbers numbers;
  int met = 0, between = 0;
  const int count = 300;
  for (int k = 0; k < count; ++k) {
    const auto integrator = static_cast<Integrator>(k % 3);
    RegionMotion one = motion(integrator, numbers.between(0.001, 0.01),
                              {{3e3, 0.8}, {2e4, 0.15}, {3e5, 0.05}}, numbers.between(0.5, 1.5));
    one.has_ratio = k % 2 == 1;
    one.drag = one.has_ratio ? 1 : numbers.between(0.2, 3);
    const double ring = numbers.between(0.3, 5);
    const double settle = numbers.between(0.3, 4) / ring;
    CAPTURE(k, ring, settle);
    const MaterialFound found = find_material(one, {1, 1}, settle, ring);
    REQUIRE(found.material.density > 0);
    REQUIRE(found.material.damping >= 0);
    CHECK(found.frequency.obstacle == Obstacle::None);
    CHECK_THAT(frequency(one, found.material), WithinRel(ring, 5e-3));
    const double reached = settling(one, found.material);
    const double miss = std::abs(reached / settle - 1);
    if (found.settling.obstacle == Obstacle::None) {
      ++met;
      CHECK(miss < 0.02);
      continue;
    }
    // What is missed is explained, and no material on a fine grid is much nearer.
    CHECK(!found.settling.reason.empty());
    between += found.settling.obstacle == Obstacle::BetweenSwings ? 1 : 0;
    if (found.settling.obstacle == Obstacle::StepsDamp) CHECK(reached < settle);
    if (found.settling.obstacle == Obstacle::TooSoon) CHECK(reached > settle);
    for (double factor = 0.01; factor < 2; factor *= 1.02) {
      Material other = found.material;
      other.damping *= factor;
      const Swing swing = one.swing(felt(one, other));
      if (swing.damping_ratio > 0.65) continue;
      // The same frequency: time goes with the root of the density.
      const double stretch = swing.frequency / ring;
      CHECK(std::abs(settling(one, other) * stretch / settle - 1) > miss - 0.04);
    }
  }
  CHECK(met > count / 4);
  CHECK(between > 5);
}

TEST_CASE("without a frequency the density stays, and the damping stays on its side",
          "[feedback][suggest]") {
  Numbers numbers;
  for (int k = 0; k < 100; ++k) {
    const RegionMotion one = motion(static_cast<Integrator>(k % 3), 0.004);
    const double density = numbers.between(1, 100);
    const double critical = 2 * std::sqrt(3e3 * density);
    const double unit = std::sqrt(density / 3e3);
    const bool creeps = k % 2 == 0;
    const double wanted = std::max(2 * frame, (creeps ? 8 : 5) * unit);
    const Material now{density, (creeps ? 4 : 0.1) * critical};
    CAPTURE(k, density, wanted);
    const MaterialFound found = find_material(one, now, wanted, {});
    CHECK(found.material.density == density);
    if (std::abs(settling(one, found.material) / wanted - 1) > 0.02) {
      CHECK(found.settling.obstacle != Obstacle::None);
      continue;
    }
    if (found.settling.obstacle == Obstacle::None && wanted > 5 * frame)
      CHECK((found.material.damping > 0.68 * critical) == creeps);
  }
}

TEST_CASE("without a time to settle the damping stays", "[feedback][suggest]") {
  for (const bool has_ratio : {false, true}) {
    for (const Integrator integrator :
         {Integrator::BackwardEuler, Integrator::Newmark, Integrator::Exact}) {
      RegionMotion one = motion(integrator, 0.002);
      one.has_ratio = has_ratio;
      const Material now{50, has_ratio ? 0.2 : 100};
      const MaterialFound found = find_material(one, now, {}, 2.5);
      CHECK(found.material.damping == now.damping);
      CHECK(found.frequency.obstacle == Obstacle::None);
      CHECK_THAT(frequency(one, found.material), WithinRel(2.5, 1e-3));
      // Of the two densities with that frequency it is the one that rings.
      CHECK(one.swing(felt(one, found.material)).damping_ratio < 0.69);
    }
  }
}

TEST_CASE("what meets the goals is kept", "[feedback][suggest]") {
  const RegionMotion one = motion(Integrator::Newmark, 0.004);
  const Material now{20, 60};
  const MaterialFound found =
      find_material(one, now, settling(one, now) * 1.001, frequency(one, now) * 0.999);
  CHECK(found.material.density == now.density);
  CHECK(found.material.damping == now.damping);
}

TEST_CASE("what cannot be reached has its reason, and what it names helps", "[feedback][suggest]") {
  const auto dt_in = [](const std::string& reason) {
    const std::size_t at = reason.find("dt=\"");
    REQUIRE(at != std::string::npos);
    return std::stod(reason.substr(at + 4));
  };
  SECTION("backward Euler damps") {
    const RegionMotion one = motion(Integrator::BackwardEuler, 0.04);
    const MaterialFound found = find_material(one, {1, 1}, 2, 2);
    CHECK(found.settling.obstacle == Obstacle::StepsDamp);
    CHECK(found.material.damping == 0);
    const double dt = dt_in(found.settling.reason);
    const RegionMotion finer = motion(Integrator::BackwardEuler, dt);
    CHECK(find_material(finer, {1, 1}, 2, 2).settling.obstacle == Obstacle::None);
    // It is not finer than need be.
    const RegionMotion coarser = motion(Integrator::BackwardEuler, 2 * dt);
    CHECK(find_material(coarser, {1, 1}, 2, 2).settling.obstacle == Obstacle::StepsDamp);
    const RegionMotion newmark = motion(Integrator::Newmark, 0.04);
    CHECK(find_material(newmark, {1, 1}, 2, 2).settling.obstacle == Obstacle::None);
  }
  SECTION("the same with a density that stays") {
    const RegionMotion one = motion(Integrator::BackwardEuler, 0.04);
    const Material now{10, 1};
    const MaterialFound found = find_material(one, now, 3, {});
    CHECK(found.settling.obstacle == Obstacle::StepsDamp);
    CHECK(found.material.damping == 0);
    const RegionMotion finer = motion(Integrator::BackwardEuler, dt_in(found.settling.reason));
    CHECK(find_material(finer, now, 3, {}).settling.obstacle != Obstacle::StepsDamp);
    // By creeping it can be reached, which is told.
    const std::size_t at = found.settling.reason.rfind("with damping ");
    REQUIRE(at != std::string::npos);
    const Material creeping{10, std::stod(found.settling.reason.substr(at + 13))};
    CHECK_THAT(settling(one, creeping), WithinRel(3, 0.005));
    CHECK(creeping.damping > 2 * std::sqrt(3e3 * 10));
  }
  SECTION("steps are too long") {
    const RegionMotion one = motion(Integrator::BackwardEuler, 0.05);
    for (const bool settles : {false, true}) {
      const MaterialFound found =
          find_material(one, {1, 0}, settles ? std::optional(1.0) : std::nullopt, 8);
      CHECK(found.frequency.obstacle == Obstacle::StepsTooLong);
      CHECK(frequency(one, found.material) > 1);
      CHECK(frequency(one, found.material) < 8);
      const RegionMotion finer = motion(Integrator::BackwardEuler, dt_in(found.frequency.reason));
      CHECK(find_material(finer, {1, 0}, {}, 8).frequency.obstacle == Obstacle::None);
    }
  }
  SECTION("frames are too far apart") {
    const RegionMotion one = motion(Integrator::Exact, 0.01);
    const MaterialFound found = find_material(one, {1, 0}, {}, 20);
    CHECK(found.frequency.obstacle == Obstacle::FrameRate);
    CHECK_THAT(frequency(one, found.material), WithinRel(12, 1e-3));
    CHECK(find_material(one, {1, 0}, 1, 20).frequency.obstacle == Obstacle::FrameRate);
    CHECK(find_material(one, {1, 1}, 0.01, 3).settling.obstacle == Obstacle::FrameRate);
  }
  SECTION("the damping that stays is too much") {
    const RegionMotion one = motion(Integrator::Exact, 0.01);
    const MaterialFound found = find_material(one, {1, 1000}, {}, 3);
    CHECK(found.frequency.obstacle == Obstacle::Overdamped);
    // It is the fastest: eta / (2 sqrt(lambda rho)) = 0.69.
    const double reached = frequency(one, found.material);
    CHECK(reached > 0.2);
    CHECK(reached < 3);
    for (const double other : {0.8, 1.25}) {
      const Material next{found.material.density * other, 1000};
      CHECK(frequency(one, next) < 1.01 * reached);
    }
    RegionMotion ratio = one;
    ratio.has_ratio = true;
    CHECK(find_material(ratio, {1, 2}, {}, 3).frequency.obstacle == Obstacle::Overdamped);
  }
  SECTION("it cannot settle that soon") {
    const RegionMotion one = motion(Integrator::Exact, 0.01);
    const MaterialFound found = find_material(one, {1, 1}, 0.1, 1);
    CHECK(found.settling.obstacle == Obstacle::TooSoon);
    CHECK(settling(one, found.material) > 0.25);
    CHECK(settling(one, found.material) < 0.45);
    const Material slow{300, 1};
    const MaterialFound kept = find_material(one, slow, 0.1, {});
    CHECK(kept.settling.obstacle == Obstacle::TooSoon);
    for (const double other : {0.5, 0.8, 1.3, 3.0}) {
      const Material next{300, kept.material.damping * other};
      CHECK(settling(one, next) > 0.99 * settling(one, kept.material));
    }
  }
  SECTION("a map takes all damping away") {
    RegionMotion one = motion(Integrator::Exact, 0.01);
    one.drag = 0;
    CHECK(find_material(one, {10, 1}, 1, {}).settling.obstacle == Obstacle::NoDamping);
    CHECK(find_material(one, {10, 1}, 1, 2).settling.obstacle == Obstacle::NoDamping);
  }
  SECTION("a ratio damps nothing without density") {
    RegionMotion one = motion(Integrator::Exact, 0.01);
    one.has_ratio = true;
    CHECK(find_material(one, {0, 0.1}, 1, {}).settling.obstacle == Obstacle::NoInertia);
  }
}

TEST_CASE("without density it creeps in the time that is wanted", "[feedback][suggest]") {
  for (const Integrator integrator : {Integrator::BackwardEuler, Integrator::Exact}) {
    const RegionMotion one = motion(integrator, 0.01, {{3e3, 0.8}, {4e4, 0.2}});
    for (const double wanted : {0.2, 1.0, 30.0}) {
      const MaterialFound found = find_material(one, {0, 5}, wanted, {});
      CHECK(found.material.density == 0);
      CHECK_THAT(settling(one, found.material), WithinRel(wanted, 0.005));
    }
  }
}
