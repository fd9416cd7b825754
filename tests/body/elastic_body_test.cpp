#include "pliant/body/elastic_body.hpp"

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "body/sheets.hpp"
#include "pliant/body/patch_plate.hpp"
#include "pliant/body/triangle_body.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/sanitized.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

// A body of one kind, and the length of its surface's side.
struct SurfaceKind {
  std::string name;
  double side;
  std::function<std::unique_ptr<Body>(const BodySettings&, const RunContext&)> make;
};

std::vector<SurfaceKind> kinds() {
  const auto sheet = std::make_shared<const NodeSheet>(hilly_sheet(17, 15));
  const auto surface =
      std::make_shared<const TriangleSurface>(make_surface(square(11, 1, 0.3, true)).value());
  return {{"a grid", 14,
           [=](const BodySettings& settings, const RunContext& context) {
             return std::make_unique<GridBody>(sheet->grid, sheet->rest, settings,
                                               SolverChoice::Auto, context);
           }},
          {"triangles", 1, [=](const BodySettings& settings, const RunContext& context) {
             return std::make_unique<TriangleBody>(surface, settings, SolverChoice::Auto, context);
           }}};
}

std::vector<std::pair<std::string, BodySettings>> settings_of_each_kind_of_state() {
  std::vector<std::pair<std::string, BodySettings>> all;
  all.emplace_back("plain", BodySettings{});
  all.emplace_back("islands that recover", BodySettings{});
  all.back().second.combine = Combine::Islands;
  all.back().second.release = Release::Recover;
  all.emplace_back("newmark", BodySettings{});
  all.back().second.integrator = Integrator::Newmark;
  all.emplace_back("exact", BodySettings{});
  all.back().second.integrator = Integrator::Exact;
  all.emplace_back("yields", BodySettings{});
  all.back().second.yields = true;
  all.emplace_back("whole", BodySettings{});
  all.back().second.region = SolvedRegion::All;
  for (auto& [name, settings] : all) settings.measure = Measure::Rest;
  return all;
}

// Regions that stay, slide, are two, and vanish for a while.
BodyInputs inputs_at(int frame, const SurfaceKind& kind, const BodySettings& settings) {
  const double radius = 0.3 * kind.side;
  const double x = (frame < 3 ? 0 : 0.03 * (frame - 3)) * kind.side;
  std::vector<SampledForce> forces;
  if (frame < 5 || frame > 7) {
    forces.push_back(press(x, 0, 5 / (kind.side * kind.side), radius));
    if (frame > 9) forces.push_back(press(-0.35 * kind.side, 0.1 * kind.side, 2, 0.5 * radius));
  }
  BodyInputs inputs = inputs_of(std::move(forces));
  const double scale = kind.side * kind.side * kind.side * kind.side;  // of 1/L
  inputs.dynamics = {0.002 * scale, 0.01 * scale};
  inputs.tangents.su0 = {0, 0.1 * frame, 0};
  if (settings.yields) inputs.law = PlasticLaw{0.01, 0.2};
  return inputs;
}

constexpr int frames_stepped = 13;

template <class F>
void for_each_body(const F& f) {
  for (const SurfaceKind& kind : kinds()) {
    for (const auto& [name, settings] : settings_of_each_kind_of_state()) {
      CAPTURE(kind.name, name);
      f(kind, settings);
    }
  }
}

// The states before the first frame and after each.
std::vector<BodyState> states_of(const SurfaceKind& kind, const BodySettings& settings) {
  const auto body = kind.make(settings, {});
  std::vector<BodyState> states = {body->state()};
  for (int frame = 0; frame < frames_stepped; ++frame) {
    REQUIRE(body->step(inputs_at(frame, kind, settings)));
    states.push_back(body->state());
  }
  CHECK(peak_of(*body) > 0);
  return states;
}

}  // namespace

TEST_CASE("a body goes on from any state, whatever it has done before", "[body]") {
  for_each_body([](const SurfaceKind& kind, const BodySettings& settings) {
    const std::vector<BodyState> states = states_of(kind, settings);
    const auto used = kind.make(settings, {});
    for (const int first : is_sanitized ? std::vector{7, 3} : std::vector{7, 0, 11, 3, 10}) {
      CAPTURE(first);
      const auto fresh = kind.make(settings, {});
      for (Body* const body : {used.get(), fresh.get()}) {
        body->restore(states[static_cast<std::size_t>(first)]);
        for (int frame = first; frame < std::min(frames_stepped, first + 3); ++frame) {
          REQUIRE(body->step(inputs_at(frame, kind, settings)));
          CHECK(body->state() == states[static_cast<std::size_t>(frame) + 1]);
        }
      }
    }
  });
}

TEST_CASE("a frame that is stopped changes nothing, and can be done again", "[body]") {
  for_each_body([](const SurfaceKind& kind, const BodySettings& settings) {
    const std::vector<BodyState> states = states_of(kind, settings);
    int asked = 0, patience = 1'000'000;
    const RunContext context{.should_stop = [&] { return ++asked > patience; }};
    const auto body = kind.make(settings, context);
    const int last = is_sanitized ? 5 : frames_stepped;
    for (int frame = 0; frame < last; ++frame) {
      const BodyInputs inputs = inputs_at(frame, kind, settings);
      const BodyState& before = states[static_cast<std::size_t>(frame)];
      bool is_done = false;
      for (int stop_at = 1; !is_done; stop_at += is_sanitized ? 1 + stop_at : 1 + stop_at / 4) {
        CAPTURE(frame, stop_at);
        asked = 0;
        patience = stop_at - 1;
        const auto stepped = body->step(inputs);
        is_done = stepped.has_value();
        if (is_done) break;
        CHECK(stepped.error().code == ErrorCode::Interrupted);
        CHECK(body->state() == before);
      }
      CHECK(body->state() == states[static_cast<std::size_t>(frame) + 1]);
    }
  });
}

TEST_CASE("a patch that a body hands out is the plate that its step solves", "[body]") {
  for (const SurfaceKind& kind : kinds()) {
    for (const Combine combine : {Combine::Box, Combine::Union}) {
      CAPTURE(kind.name, combine);
      BodySettings settings;
      settings.combine = combine;
      settings.measure = Measure::Rest;
      const auto body = kind.make(settings, {});
      Eigen::Index node = 0;
      body->rest().rowwise().squaredNorm().minCoeff(&node);
      // One node is pushed; another force only selects, so that a union has a mask.
      SampledForce push = press(0, 0, 1, 0.3 * kind.side);
      push.kind = PointForce{body->rest().row(node).transpose(), {0, 1, 0}};
      push.force_radius = 1e-3 * kind.side;
      SampledForce select = press(0.2 * kind.side, 0.25 * kind.side, 0, 0.2 * kind.side);
      BodyInputs inputs = inputs_of({push, select});
      inputs.dynamics = {0, 0};
      const StepPlan plan = body->look(inputs).value();
      REQUIRE(body->step(inputs));
      const Field ways = body->state().positions - body->rest();
      const auto patches = body->moved_patches(plan, 0);
      REQUIRE(patches.size() == 1);
      const std::vector<int>& nodes = patches[0].nodes;
      std::vector<int> ascending = nodes, moved;
      std::sort(ascending.begin(), ascending.end());
      for (int k = 0; k < ways.rows(); ++k) {
        if (!ways.row(k).isZero(0)) moved.push_back(k);
      }
      CHECK(ascending == moved);
      const bool is_union = combine == Combine::Union;
      CHECK(patches[0].is_rectangle == (kind.name == "a grid" && !is_union));
      const auto plate = body->plate_of(inputs, plan, 0, 0);
      const auto vibrating = plate->vibrating();
      REQUIRE(vibrating);
      REQUIRE(ways(node, 1) > 0);
      const auto at = std::find(nodes.begin(), nodes.end(), node) - nodes.begin();
      // A surface spreads a force over the area near it.
      Field load = Field::Zero(static_cast<Eigen::Index>(nodes.size()), 3);
      load(at, 1) = 1;
      if (plan.surface) load = plan.surface->loads.at(0);
      const Eigen::VectorXd found = vibrating->solve(load).value().col(1);
      REQUIRE(found(at) > 0);
      const Eigen::VectorXd expected = ways(nodes, 1) / ways(node, 1);
      CHECK((found / found(at) - expected).cwiseAbs().maxCoeff() < 1e-9);
      CHECK(plate->smallest_eigenvalue().value() > 0);
    }
  }
}
