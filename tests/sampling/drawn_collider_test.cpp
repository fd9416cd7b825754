#include "pliant/sampling/drawn_collider.hpp"

#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "pliant/contact/collider.hpp"
#include "pliant/core/transform.hpp"
#include "scene/scene_text.hpp"
#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

// As the engine has it, written once more.
Solid expected_solid(const Collider& collider, int frame) {
  if (const auto* sphere = std::get_if<SphereChannels>(&collider.shape))
    return SphereSolid{sphere->radius.at(frame)[0]};
  if (const auto* capsule = std::get_if<CapsuleChannels>(&collider.shape))
    return CapsuleSolid{capsule->radius.at(frame)[0], capsule->length.at(frame)[0]};
  const auto& box = std::get<BoxChannels>(collider.shape);
  const Value<3> size = box.size.at(frame);
  return BoxSolid{{size[0], size[1], size[2]}, box.round.at(frame)[0]};
}

const char* const scene_text = R"(<scene version="1" start="1" end="9">
  <surface name="mat"><grid columns="5" rows="5"/></surface>
  <surface name="rug"><grid columns="5" rows="5"/></surface>
  <collider name="ball"><sphere>
      <animate attribute="radius"><key frame="1" value="1"/><key frame="9" value="3"/></animate>
    </sphere><transform rotate="10 20 30" scale="-2 2 2"/></collider>
  <collider name="arm"><capsule radius="0.5">
      <animate attribute="length"><key frame="1" value="0"/><key frame="9" value="3"/></animate>
    </capsule><transform translate="1 2 3" rotate="10 20 30"><animate attribute="scale">
      <key frame="1" value="1 1 1"/><key frame="9" value="2 2 2"/></animate></transform></collider>
  <collider name="crate"><box><animate attribute="size">
      <key frame="1" value="1 2 3"/><key frame="9" value="3 1 2"/></animate></box>
    <transform scale="1 -2 0.5" rotate="0 45 0"/></collider>
  <collider name="pad" targets="rug"><box size="1 2 3"><animate attribute="round">
      <key frame="1" value="0"/><key frame="9" value="0.4"/></animate></box>
    <transform scale="1 2 3"/></collider>
  <collider name="gate"><animate attribute="enabled">
      <key frame="1" value="true"/><key frame="5" value="false"/></animate><sphere/></collider>
  <collider name="floor"><plane/></collider>
</scene>)";

}  // namespace

TEST_CASE("a collider's mesh lies on the solid that surfaces meet", "[sampling][drawn_collider]") {
  const Scene scene = scene_of(scene_text);
  for (const Collider& collider : scene.colliders) {
    const std::optional<DrawnCollider> mesh = DrawnCollider::make(collider, 3).value();
    REQUIRE(mesh.has_value() == (collider.name != "floor"));
    if (!mesh) continue;
    CHECK(are_equal(mesh->at(3).value().positions, mesh->mesh().positions));
    for (int frame = 1; frame <= 9; ++frame) {
      CAPTURE(collider.name, frame);
      const ColliderPose pose{expected_solid(collider, frame),
                              collider.transform.placement_at(frame), 0};
      const PlacedCollider placed = pliant::placed({pose, pose}, 0);
      const SurfacePose shown = mesh->at(frame).value();
      CHECK(shown.is_shown == (collider.name != "gate" || frame < 5));
      CHECK(shown.placement.scale.minCoeff() > 0);
      const Field world = to_world(make_transform(shown.placement), shown.positions);
      double least = 0, most = 0;
      for (Eigen::Index k = 0; k < world.rows(); ++k) {
        const double distance =
            nearness(placed.kept.solid, placed.to_frame(world.row(k).transpose())).distance;
        least = std::min(least, distance);
        most = std::max(most, distance);
      }
      CHECK((least > -1e-13 && most < 1e-13));
      CHECK((mesh->moves_points() || are_equal(shown.positions, mesh->mesh().positions)));
      // Scale alone makes a ball and a sharp box grow.
      CHECK(mesh->moves_points() == (collider.name == "arm" || collider.name == "pad"));
    }
  }
}

TEST_CASE("colliders are written with the surfaces they meet", "[sampling][drawn_collider]") {
  const Scene scene = scene_of(scene_text);
  const Mesh mesh;
  const std::vector<std::shared_ptr<const ColliderMesh>> none(scene.colliders.size());
  const auto names = [&](std::vector<AnimatedSurface> surfaces) {
    std::string all;
    const AnimationPlan plan{.file = "a.glb", .surfaces = surfaces, .first_frame = 1};
    const DrawnColliders meshes = DrawnColliders::make(scene, none, plan, 1 << 30).value();
    for (const AnimatedSurface& each : meshes.surfaces()) all += each.name + ' ';
    return all;
  };
  CHECK(names({{"mat", &mesh, {}}}) == "ball arm crate gate ");
  CHECK(names({{"mat", &mesh, {}}, {"rug", &mesh, {}}}) == "ball arm crate pad gate ");
  // Within memory, and none in formats that do not contain them.
  AnimationPlan plan{.file = "a.glb", .surfaces = {{"mat", &mesh, {}}}};
  const std::size_t enough = 4 * DrawnCollider::make(scene.colliders[0], 1).value()->bytes();
  CHECK(DrawnColliders::make(scene, none, plan, enough));
  const auto refused = DrawnColliders::make(scene, none, plan, enough - 1);
  REQUIRE_FALSE(refused);
  CHECK(refused.error().code == ErrorCode::OutOfMemory);
  CHECK_THAT(refused.error().message, contains_text("--no-colliders"));
  plan.file = "a.obj";
  CHECK(DrawnColliders::make(scene, none, plan, 0).value().surfaces().empty());
}
