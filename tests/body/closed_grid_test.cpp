#include <cmath>

#include "body/sheets.hpp"
#include "pliant/body/step_facts.hpp"
#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

// A quarter turn about y, exact.
Vector3d quarter(const Vector3d& p) { return {-p.z(), p.y(), p.x()}; }

// A tube about y, closed along u, of a radius at which columns are about 1 apart; a quarter turn
// takes its nodes to each other exactly. Requires: columns is a multiple of 4.
NodeSheet tube(int columns, int rows) {
  NodeSheet s{{columns, rows, 1, 1, true, false}, Field(columns * rows, 3)};
  const double turn = 2 * std::acos(-1.0), radius = columns / turn;
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double angle = turn * (i % (columns / 4)) / columns;
      Vector3d p{radius * std::cos(angle), j - 0.5 * (rows - 1), radius * std::sin(angle)};
      for (int k = i / (columns / 4); k > 0; --k) p = quarter(p);
      s.rest.row(s.grid.node(i, j)) = p.transpose();
    }
  }
  return s;
}

// The same closed along v instead: its columns are the tube's rows.
NodeSheet turned_tube(int columns, int rows) {
  const NodeSheet along_u = tube(rows, columns);
  NodeSheet s{{columns, rows, 1, 1, false, true}, Field(columns * rows, 3)};
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i)
      s.rest.row(s.grid.node(i, j)) = along_u.rest.row(along_u.grid.node(j, i));
  }
  return s;
}

// A torus about y, closed along both.
NodeSheet torus(int columns, int rows) {
  NodeSheet s{{columns, rows, 1, 1, true, true}, Field(columns * rows, 3)};
  const double turn = 2 * std::acos(-1.0);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const double a = turn * i / columns, b = turn * j / rows, small = rows / turn;
      const double r = columns / turn + 2 * small + small * std::cos(b);
      s.rest.row(s.grid.node(i, j)) << r * std::cos(a), small * std::sin(b), r * std::sin(a);
    }
  }
  return s;
}

// A force on the outside of a tube at an angle of `columns` columns, inwards.
SampledForce poke_at(const NodeSheet& s, double columns, double y, double magnitude,
                     double radius = 3.5, Falloff falloff = Falloff::Smooth) {
  const double turn = 2 * std::acos(-1.0), angle = turn * columns / s.grid.columns;
  const double r = s.grid.columns / turn;
  const Vector3d out{std::cos(angle), 0, std::sin(angle)};
  return {PointForce{r * out + Vector3d{0, y, 0}, -out}, magnitude, radius, 0.7 * radius, falloff};
}

SampledForce swell(double magnitude, double reach = 100) {
  return {RadialForce{{0, 0, 0}}, magnitude, reach, reach, Falloff::Linear};
}

GridBody body_of(const NodeSheet& s, const BodySettings& settings = {.measure = Measure::Rest}) {
  return GridBody(s.grid, s.rest, settings);
}

// Displacements about y turned by whole columns, moved round to the nodes they turn to.
Field turned(const NodeSheet& s, const Field& nodes, int by) {
  const double angle = 2 * std::acos(-1.0) * by / s.grid.columns;
  Field result(nodes.rows(), 3);
  for (int j = 0; j < s.grid.rows; ++j) {
    for (int i = 0; i < s.grid.columns; ++i) {
      const Eigen::RowVector3d p = nodes.row(s.grid.node(i, j));
      result.row(s.grid.node((i + by) % s.grid.columns, j))
          << std::cos(angle) * p[0] - std::sin(angle) * p[2],
          p[1], std::sin(angle) * p[0] + std::cos(angle) * p[2];
    }
  }
  return result;
}

}  // namespace

TEST_CASE("a box across the seam moves as its copy elsewhere, to the bit", "[body][closed]") {
  const NodeSheet s = tube(48, 15);
  const auto press = [&](const Vector3d& at, const Vector3d& direction) {
    return inputs_of({{PointForce{at, direction}, 2e5, 5.5, 2.5, Falloff::Constant}});
  };
  const double r = s.rest(0, 0);
  const Vector3d at{r, 0.25, 0.1}, along{-1, 0.5, 0};
  GridBody across = body_of(s), elsewhere = body_of(s);
  BodyInputs here = press(at, along), there = press(quarter(at), quarter(along));
  here.tangents.su0 = {1, 2, 3};
  there.tangents.su0 = quarter({1, 2, 3});
  for (int frame = 0; frame < 12; ++frame) {
    const StepPlan one = step(across, here).value(), other = step(elsewhere, there).value();
    const Box box = one.selection.regions.at(0).box;
    REQUIRE(box.i1 >= 48);
    REQUIRE(other.selection.regions.at(0).box ==
            Box{box.i0 + 12 - 48, box.i1 + 12 - 48, box.j0, box.j1});
    REQUIRE(one.selection.regions[0].patches.at(0).is_rectangle());
  }
  REQUIRE(peak_of(across) > 0.1);
  int differing = 0;
  for (int j = 0; j < 15; ++j) {
    for (int i = 0; i < 48; ++i) {
      const Vector3d p = across.state().positions.row(s.grid.node(i, j)).transpose();
      const Vector3d v = across.state().velocities.row(s.grid.node(i, j)).transpose();
      const int node = s.grid.node((i + 12) % 48, j);
      differing += quarter(p) != Vector3d(elsewhere.state().positions.row(node).transpose());
      differing += quarter(v) != Vector3d(elsewhere.state().velocities.row(node).transpose());
    }
  }
  CHECK(differing == 0);
}

TEST_CASE("forces that are moved round a tube move it as before, moved round", "[body][closed]") {
  const NodeSheet s = tube(32, 17);
  const Combine how = GENERATE(Combine::Box, Combine::Islands, Combine::Union);
  const Release release = GENERATE(Release::Freeze, Release::Recover);
  const Measure measure = GENERATE(Measure::Current, Measure::Rest);
  const bool is_ring = GENERATE(false, true);
  CAPTURE(how, release, measure, is_ring);
  const int by = 19;
  const BodySettings settings{.measure = measure, .combine = how, .release = release};
  GridBody before = body_of(s, settings), after = body_of(s, settings);
  const auto forces = [&](double shift, int frame) {
    // The second one travels; the third is disabled after some frames.
    std::vector<SampledForce> all = {
        poke_at(s, 1.3 + shift, -1.2, 3e4),
        poke_at(s, 7.4 + 0.8 * frame + shift, 2.1, -2e4, 4.2, Falloff::Gaussian)};
    if (is_ring && frame < 5) all.push_back(swell(1e4, 5.7));
    return inputs_of(std::move(all));
  };
  int rings = 0, across = 0;
  for (int frame = 0; frame < 9; ++frame) {
    const StepPlan one = step(before, forces(0, frame)).value();
    const StepPlan other = step(after, forces(by, frame)).value();
    REQUIRE(one.unknown_count() == other.unknown_count());
    REQUIRE(one.recovering.size() == other.recovering.size());
    for (const Region& region : one.selection.regions) {
      rings += s.grid.is_ring_u(region.box);
      across += region.box.i1 >= s.grid.columns;
    }
    const double peak = peak_of(before);
    const Field moved = before.state().positions - s.rest;
    CHECK((after.state().positions - s.rest - turned(s, moved, by)).cwiseAbs().maxCoeff() <
          1e-9 * peak);
  }
  REQUIRE(peak_of(before) > 0.1);
  CHECK((rings > 0) == is_ring);
  CHECK(rings + across > 0);
}

TEST_CASE("a ring is a lap of the strip that goes round for ever", "[body][closed]") {
  // The unrolled tube has the same nodes again and again. What its ends, six laps away, add decays
  // at least by exp(-0.34) from node to node.
  const bool is_along_v = GENERATE(false, true);
  const int lap = 16, laps = 13, across = 9;
  const NodeSheet ring = is_along_v ? turned_tube(across, lap) : tube(lap, across);
  const int columns = is_along_v ? across : lap * laps, rows = is_along_v ? lap * laps : across;
  NodeSheet strip{{columns, rows, 1, 1}, Field(columns * rows, 3)};
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i)
      strip.rest.row(strip.grid.node(i, j)) =
          ring.rest.row(ring.grid.node(i % ring.grid.columns, j % ring.grid.rows));
  }
  const Dynamics dynamics = GENERATE(Dynamics{0, 0}, Dynamics{40, 20});
  // All of it is selected; the second force differs round the ring.
  BodyInputs in =
      inputs_of({swell(4e2), {NoiseForce{{0, 0, 0}, 0.3, 0.5, 7}, 5e2, 100, 100, Falloff::Linear}});
  in.dynamics = dynamics;
  in.stiffness = {1, 0.5, 3};
  // What a closed direction has of tangents counts for nothing; the strip has none at its ends.
  const Vector3d slope{0.1, 0.2, -0.1};
  (is_along_v ? in.tangents.su1 : in.tangents.sv1) = slope;
  BodyInputs with_ends = in;
  (is_along_v ? with_ends.tangents.sv0 : with_ends.tangents.su0) = {5, 5, 5};
  GridBody round = body_of(ring), unrolled = body_of(strip);
  for (int frame = 0; frame < 4; ++frame) {
    REQUIRE(step(round, with_ends)->unknown_count() == lap * (across - 2));
    REQUIRE(step(unrolled, in)->solves());
  }
  REQUIRE(peak_of(round) > 0.01);
  double worst = 0;
  for (int j = 0; j < ring.grid.rows; ++j) {
    for (int i = 0; i < ring.grid.columns; ++i) {
      const int node =
          strip.grid.node(i + (is_along_v ? 0 : 6 * lap), j + (is_along_v ? 6 * lap : 0));
      worst = std::max(worst, (round.state().positions.row(ring.grid.node(i, j)) -
                               unrolled.state().positions.row(node))
                                  .norm());
    }
  }
  CHECK(worst < 1e-10 * peak_of(round));
}

TEST_CASE("a tube pressed evenly all round stays round", "[body][closed]") {
  const NodeSheet s = tube(20, 11);
  GridBody body = body_of(s, {.measure = Measure::Current});
  for (int frame = 0; frame < 10; ++frame) {
    REQUIRE(step(body, inputs_of({swell(-3e4, 5)}))->solves());
    const Field moved = body.state().positions - s.rest;
    CHECK((moved - turned(s, moved, 1)).cwiseAbs().maxCoeff() < 1e-12 * peak_of(body));
    CHECK((moved - turned(s, moved, 7)).cwiseAbs().maxCoeff() < 1e-12 * peak_of(body));
  }
  CHECK(peak_of(body) > 0.1);
}

TEST_CASE("displacements of a closed grid add up", "[body][closed]") {
  const NodeSheet s = GENERATE(tube(24, 11), torus(24, 12));
  const Dynamics dynamics{40, 20};
  const SampledForce a = poke_at(s, 0.4, 1, 3e4), b = poke_at(s, 9.2, -2, -5e4);
  const auto moved = [&](std::vector<SampledForce> forces) {
    GridBody body = body_of(s);
    BodyInputs in = inputs_of(std::move(forces));
    in.dynamics = dynamics;
    in.forces.push_back(swell(0));  // selects all
    for (int frame = 0; frame < 5; ++frame) REQUIRE(step(body, in)->solves());
    return Field(body.state().positions - s.rest);
  };
  const Field sum = moved({a}) + moved({b}), both = moved({a, b});
  REQUIRE(both.norm() > 0.1);
  CHECK((sum - both).norm() < 1e-10 * both.norm());
}

TEST_CASE("a surface closed along both needs inertia or drag where nothing holds it",
          "[body][closed]") {
  const NodeSheet s = torus(12, 9);
  GridBody body = body_of(s);
  BodyInputs in = inputs_of({swell(50)});
  in.dynamics = {0, 0};
  const BodyState before = body.state();
  const auto refused = step(body, in);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::SolverFailed);
  CHECK(refused.error().message.find("nothing holds a static surface") == 0);
  CHECK(body.state() == before);

  in.dynamics = {0, 40};  // a push on all nodes moves all, without bending
  in.forces = {{UniformForce{{0, 1, 0}}, 50, 100, 100, Falloff::Constant}};
  REQUIRE(step(body, in)->unknown_count() == 12 * 9);
  const Field moved = body.state().positions - s.rest;
  const double way = in.frame_length * 50 / 40;
  CHECK((moved.col(1).array() - way).abs().maxCoeff() < 1e-9 * way);

  // A single cell that is left out holds it.
  in.dynamics = {0, 0};
  in.forces = {{PointForce{s.rest.row(0).transpose(), {0, 1, 0}}, 50, 3.5, 2, Falloff::Constant}};
  CHECK(step(body, in)->solves());
}

TEST_CASE("what recovers on a closed grid comes to rest, to the bit", "[body][closed][recover]") {
  const NodeSheet s = GENERATE(tube(24, 13), turned_tube(13, 24), torus(16, 12));
  const Combine how = GENERATE(Combine::Box, Combine::Islands, Combine::Union);
  GridBody body =
      body_of(s, {.measure = Measure::Rest, .combine = how, .release = Release::Recover});
  const Vector3d first = s.rest.row(0).transpose();
  const Vector3d middle = s.rest.row(s.grid.node(0, s.grid.rows / 2)).transpose();
  const auto inputs = [&](double x) {
    BodyInputs in =
        inputs_of({{PointForce{middle + Vector3d{0, x, 0}, {1, 1, 0}}, 4, 3.2, 2, Falloff::Smooth},
                   {PointForce{first, {0, 1, 1}}, 3, 2.6, 2, Falloff::Smooth}});
    in.dynamics = {0.002, 0.02};
    return in;
  };
  for (int frame = 0; frame < 8; ++frame) REQUIRE(step(body, inputs(0.3 * frame - 2)));
  REQUIRE(peak_of(body) > 0.05);
  BodyInputs nothing = inputs(0);
  nothing.forces.clear();
  int frames = 0;
  while (step(body, nothing)->solves()) REQUIRE(++frames < 1000);
  CHECK(frames > 2);
  CHECK(body.state().positions == s.rest);
  CHECK(body.state().velocities.isZero(0));
}

TEST_CASE("facts of a step are told of boxes across the seam as of others", "[body][closed]") {
  const NodeSheet s = tube(40, 13);
  GridBody body = body_of(s);
  const auto facts = [&](std::vector<SampledForce> forces) {
    const BodyInputs in = inputs_of(std::move(forces));
    return facts_of(in, body.look(in).value(), Combine::Box);
  };
  for (const double shift : {0.0, 10.0, 20.0, 37.5}) {
    CAPTURE(shift);
    // Columns -3 to 3 and 1 to 7 meet; those of 13 to 19 are apart.
    const SampledForce a = poke_at(s, shift, 0, 1e3), b = poke_at(s, shift + 4, 0, 1e3),
                       c = poke_at(s, shift + 16, 0, 1e3);
    const StepFacts near = facts({a, b}), far = facts({a, b, c});
    for (const ForceFacts& one : near.forces) {
      CHECK_FALSE(one.is_apart);
      CHECK_FALSE(one.is_outside);
      CHECK_FALSE(one.is_too_small);
      CHECK(one.touches);
      CHECK(one.pushes);
    }
    for (const ForceFacts& one : far.forces) CHECK(one.is_apart);
    // A force box elsewhere, and a selection too small to solve.
    SampledForce outside = poke_at(s, shift + 20, 0, 1e3);
    outside.deformation_radius = 0;
    CHECK(facts({a, outside}).forces[1].is_outside);
    CHECK(facts({poke_at(s, shift, 0, 1e3, 1.2)}).forces[0].is_too_small == (shift == 37.5));
  }
}
