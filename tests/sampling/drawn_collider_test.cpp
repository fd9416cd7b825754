#include "pliant/sampling/drawn_collider.hpp"

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "contact/solid_meshes.hpp"
#include "pliant/contact/collider.hpp"
#include "pliant/core/transform.hpp"
#include "pliant/mesh/normals.hpp"
#include "pliant/sampling/collider_mesh.hpp"
#include "pliant/simulation/simulation.hpp"
#include "scene/scene_text.hpp"
#include "support/caches.hpp"
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

// What is drawn of a mesh, as a file has it.
class DrawnFile {
 public:
  explicit DrawnFile(const MeshSolid& solid, const std::string& more = {},
                     const std::string& transform = {}, bool is_inward = false) {
    std::string text;
    const Field& points = solid.posed->points();
    for (Eigen::Index k = 0; k < points.rows(); ++k)
      text += fmt::format("v {} {} {}\n", points(k, 0), points(k, 1), points(k, 2));
    for (SolidMesh::Corners corners : solid.posed->mesh().triangles()) {
      if (is_inward) std::swap(corners[1], corners[2]);
      text += fmt::format("f {} {} {}\n", corners[0] + 1, corners[1] + 1, corners[2] + 1);
    }
    simulation_ = Simulation::make(scene_of(fmt::format(
        R"(<scene version="1" start="1" end="3"><surface name="mat"><grid columns="5" rows="5"/></surface>
        <collider name="rock"><mesh file="{}"{}/>{}</collider></scene>)",
        folder_.write("rock.obj", text).string(), more, transform)));
    REQUIRE(simulation_);
    drawn_ =
        DrawnCollider::make(simulation_->scene().colliders[0], 2, simulation_->collider_meshes()[0])
            .value();
  }

  const DrawnCollider& operator*() const { return *drawn_; }
  const DrawnCollider* operator->() const { return &*drawn_; }

 private:
  ScratchFolder folder_;
  Result<Simulation> simulation_ = fail(ErrorCode::InvalidInput, "");
  std::optional<DrawnCollider> drawn_;
};

// Six times the volume that faces enclose, > 0 if they look outwards.
double volume_of(const Mesh& mesh, const Field& positions) {
  double sum = 0;
  for (std::size_t k = 0; k < mesh.corner_vertices.size(); k += 3) {
    const auto at = [&](std::size_t corner) -> Vector3d {
      return positions.row(mesh.corner_vertices[k + corner]).transpose();
    };
    sum += at(0).dot(cross_of(at(1), at(2)));
  }
  return sum;
}

}  // namespace

TEST_CASE("a collider that is a mesh is drawn with the points of its file and its cache",
          "[sampling][drawn_collider]") {
  const MeshSolid star = star_mesh();
  for (const bool is_inward : {false, true}) {
    const DrawnFile still(star, "", R"(<transform translate="1 2 3" scale="-1 2 0.5"/>)",
                          is_inward);
    CHECK_FALSE(still->moves_points());
    CHECK(are_equal(still->mesh().positions, star.posed->points()));
    CHECK(volume_of(still->mesh(), still->mesh().positions) > 0);
    const SurfacePose pose = still->at(3).value();
    CHECK(are_equal(pose.positions, star.posed->points()));
    // Programs turn what a node's own scale mirrors.
    CHECK(pose.placement.scale == Vector3d(-1, 2, 0.5));
    CHECK(pose.placement.translate == Vector3d(1, 2, 3));
  }
  std::vector<Field> samples;
  for (const double size : {1.0, 1.5, 0.75})
    samples.push_back((size * star.posed->points()).cast<float>().cast<double>());
  const ScratchFolder folder;
  const DrawnFile moving(star,
                         fmt::format(R"( cache="{}")", write_cache(folder, "rock.npy", samples)));
  CHECK(moving->moves_points());
  CHECK(are_equal(moving->mesh().positions, samples[1]));
  for (int frame = 1; frame <= 3; ++frame)
    CHECK(are_equal(moving->at(frame).value().positions,
                    samples[static_cast<std::size_t>(frame) - 1]));
}

TEST_CASE("edges of a mesh are hard where it turns much", "[sampling][drawn_collider]") {
  // Each side of a box has normals of its own, whatever its triangles.
  const DrawnFile box(box_mesh({3, 1, 2}, 3));
  const Mesh& mesh = box->mesh();
  CHECK(normal_count(mesh) == 6 * 16);
  const Field normals = unit_normals(mesh, mesh.positions);
  std::map<int, int> vertices;
  for (std::size_t corner = 0; corner < mesh.corner_vertices.size(); ++corner) {
    const auto [known, is_new] =
        vertices.try_emplace(mesh.corner_normals[corner], mesh.corner_vertices[corner]);
    CHECK(known->second == mesh.corner_vertices[corner]);
  }
  for (Eigen::Index k = 0; k < normals.rows(); ++k)
    CHECK(normals.row(k).cwiseAbs().maxCoeff() == 1);
  CHECK(DrawnFile(ball_mesh(1, 6))->mesh().corner_normals.empty());
  const auto prism = [](double degrees) {
    TriangleSoup soup;
    const double rise = std::tan(degrees / 2 * 3.14159265358979 / 180);
    const Vector3d top(0, rise, -1), left(-1, 0, -1), right(1, 0, -1), way(0, 0, 2);
    soup.add_quad(left, left + way, top + way, top);
    soup.add_quad(top, top + way, right + way, right);
    soup.add_quad(left, right, right + way, left + way);
    soup.add(left, top, right);
    soup.add(left + way, right + way, top + way);
    return soup.solid();
  };
  const auto normals_on_top = [&](double degrees) {
    const DrawnFile drawn(prism(degrees));
    std::set<int> found;
    for (std::size_t corner = 0; corner < drawn->mesh().corner_vertices.size(); ++corner) {
      const Eigen::RowVector3d at =
          drawn->mesh().positions.row(drawn->mesh().corner_vertices[corner]);
      if (at[1] > 0 && at[2] < 0) found.insert(normal_of(drawn->mesh(), corner));
    }
    return found.size();
  };
  CHECK(normals_on_top(39) == 2);  // one of the sides, one of the end
  CHECK(normals_on_top(41) == 3);
}

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
