#include <algorithm>
#include <cmath>
#include <vector>

#include "support/catch.hpp"
#include "support/met_scenes.hpp"
#include "support/random_scene.hpp"
#include "support/sanitized.hpp"

using namespace pliant;
using namespace pliant::testing;

// Colliders of any shape, speed and size. docs/model.md, "Contact".

namespace {

class RandomContact {
 public:
  explicit RandomContact(unsigned seed)
      : chance_(seed), scale_(std::vector{1e-6, 1e-3, 1.0, 1.0, 1e3, 1e6}[chance_.below(6)]) {}

  Scene scene() {
    Surface surface = chance_.once_in(3) ? wide_skin() : wide_mat();
    surface.transform.scale = Value<3>{scale_, scale_, scale_};
    if (chance_.once_in(3)) surface.solver.integrator = Integrator::Newmark;
    if (chance_.once_in(3)) {
      surface.material.yield = 0.5;
      surface.material.hardening = std::vector{0.02, 0.1, 1.0}[chance_.below(3)];
    }
    if (chance_.once_in(4)) surface.solver.region = SolvedRegion::Forces;
    std::vector<Collider> colliders;
    for (int k = chance_.between(1, 3); k > 0; --k) colliders.push_back(collider());
    std::vector<Force> forces;
    if (chance_.once_in(2)) forces.push_back(weight_of(scale_ * number(0, 20)));
    Scene made = met_scene(surface, colliders, forces);
    made.end = 6;
    return made;
  }

 private:
  double number(int least, int most) { return std::stod(chance_.number(least, most)); }

  Value<3> place(int least, int most) {
    return {scale_ * number(least, most), scale_ * number(least, most),
            scale_ * number(least, most)};
  }

  Collider collider() {
    // Up to a hundred radii in a frame.
    std::vector<std::pair<double, Value<3>>> keys;
    for (int frame = 1; frame <= 7; ++frame)
      keys.push_back({double(frame), chance_.once_in(5) ? place(-100, 100) : place(-4, 4)});
    Collider made = testing::collider(
        fmt::format("c{}", ++count_),
        {.translate = vector_curve(keys), .rotate = Value<3>{number(-90, 90), number(-90, 90), 0}});
    const double size = scale_ * number(1, 4);
    switch (chance_.below(4)) {
      case 0:
        made.shape = SphereChannels{.radius = size};
        break;
      case 1:
        made.shape = CapsuleChannels{.radius = curve({{1, size}, {6, size / 2}}), .length = size};
        break;
      case 2:  // a thin one
        made.shape = BoxChannels{.size = Value<3>{2 * size, 0.02 * size, size}};
        break;
      default:
        made.shape = PlaneChannels{};
    }
    made.deformation_radius = scale_ * number(0, 3);
    if (chance_.once_in(3)) made.offset = scale_ * 0.1;
    if (chance_.once_in(3)) made.friction = number(0, 2);
    if (chance_.once_in(6)) made.stick = true;
    return made;
  }

  Chance chance_;
  double scale_;
  int count_ = 0;
};

}  // namespace

TEST_CASE("whatever meets whatever, all ends, is finite, and has the same bits",
          "[simulation][contact][threads]") {
  for (unsigned seed = 0; seed < (is_sanitized ? 6u : 30u); ++seed) {
    CAPTURE(seed);
    const Scene scene = RandomContact(seed).scene();
    Simulation simulation = Simulation::make(scene).value();
    SimulationOptions options;
    options.threads = 2;
    options.checkpoint_bytes = 0;
    Simulation other = Simulation::make(scene, options).value();
    const Field& rest = simulation.rest_shapes()[0].rest;
    const double diagonal = scene.surfaces[0].transform.scale.at(1)[0] *
                            (rest.colwise().maxCoeff() - rest.colwise().minCoeff()).norm();
    std::vector<Field> frames;
    for (int frame = scene.start; frame <= scene.end; ++frame) {
      const auto shown = simulation.at(frame);
      if (!shown) FAIL(shown.error().message);
      frames.push_back(shown->surfaces()[0].positions());
      REQUIRE(frames.back().allFinite());
      const FrameReport report = simulation.report(frame).value();
      for (const ContactFacts& facts : report.surfaces[0].contacts) {
        // Nodes that it pushes are not inside, wherever it came from, unless another one holds
        // them.
        if (report.surfaces[0].contacts.size() > 1) continue;
        const PlacedCollider one =
            placed(standing(scene.colliders[static_cast<std::size_t>(facts.collider)], frame), 0);
        double deepest = 0;
        for (const int node : facts.nodes) {
          const Vector3d p = frames.back().row(node).transpose();
          deepest = std::max(deepest, -nearness(one.kept, one.to_frame(p)).distance);
        }
        CHECK(deepest <= 1.1e-9 * diagonal);
      }
    }
    for (int frame = scene.end; frame >= scene.start; --frame) {
      CHECK(other.at(frame).value().surfaces()[0].positions() ==
            frames[static_cast<std::size_t>(frame - scene.start)]);
    }
  }
}
