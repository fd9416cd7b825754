#include <string>

#include "pliant/scene/elements/read_elements.hpp"
#include "scene/scene_text.hpp"

namespace pliant::testing {
namespace {

TEST_CASE("a surface has one shape and each part once", "[scene][surface]") {
  check_each({
      {scene_with("<surface name=\"s\"/>"),
       2,
       {"<surface> \"s\" has no shape", "<grid>, <mesh>, <nurbs> or <subdivision>"}},
      {surface_with("<mesh file=\"/etc/passwd\"/>"), 3, {"\"sheet\" has two shapes", "at line 2"}},
      {surface_with("<grid columns=\"3\" rows=\"3\"/>"), 3, {"two shapes"}},
      {surface_with("<material/>\n<material/>"), 4, {"second <material>", "first is at line 3"}},
      {surface_with("<transform/><solver/>\n<transform/>"), 4, {"second <transform>"}},
      {surface_with("<tangents/>\n<tangents/>"), 4, {"second <tangents>"}},
      {surface_with("<solver/>\n<solver/>"), 4, {"second <solver>"}},
  });
}

TEST_CASE("the parts of a surface stand in any order", "[scene][surface]") {
  const Scene scene =
      scene_of(scene_with("<surface name=\"s\"><solver dt=\"0.5\"/><material density=\"3\"/><mesh "
                          "file=\"/etc/passwd\"/></surface>"));
  CHECK(scene.surfaces.at(0).solver.dt.at(1)[0] == 0.5);
  CHECK(scene.surfaces.at(0).material.density.at(1)[0] == 3);
  CHECK(std::holds_alternative<MeshFile>(scene.surfaces.at(0).shape));
}

TEST_CASE("a mesh path is relative to the scene's folder", "[scene][surface]") {
  const auto path_of = [](const std::string& file) {
    const Scene scene =
        scene_of(scene_with("<surface name=\"s\"><mesh file=\"" + file + "\"/></surface>"));
    return std::get<MeshFile>(scene.surfaces.at(0).shape).path;
  };
  CHECK(path_of("body.obj") == "shots/body.obj");
  CHECK(path_of("../a/körper.obj") == "shots/../a/körper.obj");
  CHECK(path_of("/models/body.obj") == "/models/body.obj");
}

TEST_CASE("all six orders of rotation are read", "[scene][surface]") {
  const auto order_of = [](const std::string& order) {
    return scene_of(surface_with("<transform rotateOrder=\"" + order + "\"/>"))
        .surfaces.at(0)
        .transform.rotate_order;
  };
  CHECK(order_of("xyz") == RotateOrder::Xyz);
  CHECK(order_of("xzy") == RotateOrder::Xzy);
  CHECK(order_of("yxz") == RotateOrder::Yxz);
  CHECK(order_of("yzx") == RotateOrder::Yzx);
  CHECK(order_of("zxy") == RotateOrder::Zxy);
  CHECK(order_of("zyx") == RotateOrder::Zyx);
}

TEST_CASE("an animate stands in its part or directly in the surface", "[scene][surface]") {
  const std::string keys = "<key frame=\"1\" value=\"5\"/></animate>";
  const auto is_density_animated = [](const std::string& parts) {
    return scene_of(surface_with(parts)).surfaces.at(0).material.density.is_animated();
  };
  CHECK(is_density_animated("<material><animate attribute=\"density\">" + keys + "</material>"));
  CHECK(is_density_animated("<animate attribute=\"density\">" + keys));
  CHECK(
      is_density_animated("<animate attribute=\"density\">" + keys + "<material damping=\"2\"/>"));
  check_each({
      {surface_with("<animate attribute=\"density\">" + keys + "\n<material density=\"3\"/>"),
       4,
       {"density=\"3\": density is already animated (line 3)"}},
      {surface_with("<material density=\"3\"/>\n<animate attribute=\"density\">" + keys),
       4,
       {"attribute=\"density\": is already given (line 3)"}},
      {surface_with("<material><animate attribute=\"density\">" + keys +
                    "</material>\n<animate attribute=\"density\">" + keys),
       4,
       {"attribute=\"density\": is already animated (line 3)"}},
      {surface_with("<animate attribute=\"enabled\">" + keys),
       3,
       {"\"enabled\": cannot be animated", "translate"}},
      {surface_with("<animate attribute=\"startFrame\">" + keys),
       3,
       {"\"startFrame\": cannot be animated"}},
      {surface_with("<material><animate attribute=\"dt\">" + keys + "</material>"),
       3,
       {"<material> has no such channel", "allowed: density, damping, b, c, d"}},
  });
}

}  // namespace
}  // namespace pliant::testing
