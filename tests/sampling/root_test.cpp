// What a scene's root keeps out after the scene was read.

#include <filesystem>
#include <string>

#include <fmt/format.h>

#include "pliant/sampling/animated_shape.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/scene/inputs.hpp"
#include "pliant/scene/read.hpp"
#include "pliant/scene/sharing/expand.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

namespace fs = std::filesystem;

std::string scene_with(const std::string& shape) {
  return fmt::format("<scene start=\"1\" end=\"2\"><surface name=\"s\">{}</surface></scene>",
                     shape);
}

// What is said of the shape of a scene's surface.
std::string complaint_about(const Scene& scene) {
  const Surface& surface = scene.surfaces.front();
  auto made = make_rest_shape(surface, scene.origin, {});
  if (!made) return made.error().message;
  if (!surface.is_animated()) return "none";
  const auto animated = animate(*made, surface, scene, {});
  return animated ? "none" : animated.error().message;
}

}  // namespace

TEST_CASE("what a scene leads to is opened in its root, whatever has come into its place",
          "[sampling][root][threads][boxed]") {
  const std::string grid = "<grid columns=\"5\" rows=\"5\"{}/>";
  for (const auto& [file, shape] :
       {std::pair<std::string, std::string>("a.obj", "<mesh file=\"a.obj\"/>"),
        {"a.ply", "<mesh file=\"a.ply\"/>"},
        {"a.gltf", "<mesh file=\"a.gltf\"/>"},
        {"a.fbx", "<mesh file=\"a.fbx\"/>"},
        {"a.obj", "<subdivision file=\"a.obj\"/>"},
        {"a.pc2", fmt::format(fmt::runtime(grid), " cache=\"a.pc2\"")},
        {"b.png", fmt::format(fmt::runtime(grid), "") +
                      "<material><map channel=\"b\" file=\"b.png\"/></material>"},
        {"b.npy", fmt::format(fmt::runtime(grid), "") +
                      "<material><map channel=\"b\" file=\"b.npy\"/></material>"}}) {
    CAPTURE(shape);
    const ScratchFolder folder;
    const fs::path root = fs::canonical(folder.path()) / "root";
    fs::create_directory(root);
    folder.write("root/" + file, "mine");
    folder.write("secret", "secret");
    const auto scene = load_scene(folder.write("root/a.xml", scene_with(shape)), root);
    REQUIRE(scene);
    CHECK_THAT(complaint_about(*scene), !contains_text("is outside"));
    const auto path = inputs_of(*scene).back();
    CHECK(path.root == root);
    for (const char* const target : {"../secret", "../none"}) {
      fs::remove(root / file);
      fs::create_symlink(target, root / file);
      CHECK_THAT(
          complaint_about(*scene),
          contains_text(fmt::format("it is outside {}, the folder of --root", root.string())));
    }
    // Without a root the scene may lead there.
    CHECK_THAT(complaint_about(load_scene(root / "a.xml").value()), !contains_text("is outside"));
  }
}

TEST_CASE("the file that is included is the one that was found in the root", "[sampling][root]") {
  const ScratchFolder folder;
  fs::create_directory(folder.file("root"));
  const auto file = folder.write("root/a.xml", "mine");
  folder.write("secret", "secret");
  const xml::TextFiles files = xml::files_on_disk(folder.file("root"));
  const auto swap = [&] {
    fs::remove(file);
    fs::create_symlink("../secret", file);
  };
  REQUIRE(files.identify(file));
  swap();
  CHECK(files.read(file, 100).value() == "mine");
  CHECK_FALSE(files.identify(file));
  CHECK_FALSE(files.read(file, 100));
}
