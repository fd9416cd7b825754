// What `load_scene`'s root keeps out.

#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pliant/scene/inputs.hpp"
#include "pliant/scene/read.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

namespace pliant::testing {
namespace {

namespace fs = std::filesystem;

/// shots/a.xml in a folder beside secret/, with links into it.
class Folders {
 public:
  Folders() {
    for (const char* folder : {"shots", "shots/below", "secret"})
      fs::create_directory(folder_.file(folder));
    for (const char* folder : {"shots/", "shots/below/", "secret/"}) {
      folder_.write(folder + std::string("part.xml"), "<fragment/>");
      folder_.write(folder + std::string("mesh.obj"), "v 0 0 0\n");
      folder_.write(folder + std::string("a.pc2"), "");
      folder_.write(folder + std::string("b.png"), "");
    }
    fs::create_directory_symlink("../secret", folder_.file("shots/folder"));
    fs::create_directory_symlink(folder_.file("secret"), folder_.file("shots/absolute"));
    fs::create_directory_symlink("below", folder_.file("shots/inside"));
    for (const char* name : {"part.xml", "mesh.obj", "a.pc2", "b.png"}) {
      fs::create_symlink(fs::path("../secret") / name,
                         folder_.file(fmt::format("shots/link-{}", name)));
      fs::create_symlink(fmt::format("link-{}", name),
                         folder_.file(fmt::format("shots/twice-{}", name)));
      fs::create_symlink("../none", folder_.file(fmt::format("shots/dangling-{}", name)));
    }
  }

  fs::path file(const std::string& name) const { return folder_.file(name); }
  fs::path scene(std::string_view body) const {
    return folder_.write("shots/a.xml",
                         fmt::format("<scene start=\"1\" end=\"2\">{}</scene>", body));
  }

 private:
  ScratchFolder folder_;
};

/// A scene that leads to a file in each way that there is.
std::vector<std::pair<std::string, std::string>> ways_to(const std::string& folder) {
  const auto surface = [](const std::string& shape) {
    return fmt::format("<surface name=\"s\">{}</surface>", shape);
  };
  const std::string grid = "<grid columns=\"3\" rows=\"3\"{}/>";
  return {
      {"part.xml", fmt::format("<include file=\"{}part.xml\"/>", folder)},
      {"mesh.obj", surface(fmt::format("<mesh file=\"{}mesh.obj\"/>", folder))},
      {"mesh.obj", surface(fmt::format("<subdivision file=\"{}mesh.obj\"/>", folder))},
      {"a.pc2", surface(fmt::format("<mesh file=\"mesh.obj\" cache=\"{}a.pc2\"/>", folder))},
      {"a.pc2",
       surface(fmt::format(fmt::runtime(grid), fmt::format(" cache=\"{}a.pc2\"", folder)))},
      {"b.png",
       surface(fmt::format(fmt::runtime(grid), "") +
               fmt::format("<material><map channel=\"b\" file=\"{}b.png\"/></material>", folder))},
  };
}

TEST_CASE("a root keeps out every file outside it", "[scene][root]") {
  const Folders folders;
  const std::string root = folders.file("shots").string();
  const std::string secret = folders.file("secret/").string();
  for (const std::string& folder :
       {std::string("../secret/"), std::string("folder/"), std::string("absolute/"), secret,
        std::string("link-"), std::string("twice-"), std::string("below/../../secret/"),
        std::string("folder/../secret/"), std::string("./../shots/../secret/"),
        std::string("none/../../secret/"), std::string("../")}) {
    for (const auto& [name, body] : ways_to(folder)) {
      for (const bool is_defined : {false, true}) {
        std::string text = body;
        if (is_defined)
          text = fmt::format("<define name=\"d\" value=\"{}\"/>", folder) +
                 text.replace(text.find(folder + name), folder.size(), "${d}");
        CAPTURE(text);
        const auto scene = load_scene(folders.scene(text), root);
        REQUIRE_FALSE(scene);
        CHECK(scene.error().others.empty());
        CHECK_THAT(scene.error().message,
                   contains_text("it is outside " + root + ", the folder of --root"));
        CHECK(scene.error().line == 1);
        // Without a root the scene may lead there.
        if (folder != "../" && !folder.starts_with("none")) CHECK(load_scene(folders.scene(text)));
      }
    }
  }
}

TEST_CASE("a root keeps out links to what may appear later", "[scene][root]") {
  const Folders folders;
  for (const auto& [name, body] : ways_to("dangling-")) {
    CAPTURE(body);
    const auto scene = load_scene(folders.scene(body), folders.file("shots"));
    REQUIRE_FALSE(scene);
    CHECK_THAT(scene.error().message, contains_text("it is outside"));
  }
}

TEST_CASE("a root lets in what is in it", "[scene][root]") {
  const Folders folders;
  for (const std::string& folder :
       {std::string(), std::string("below/"), std::string("inside/"), std::string("../shots/"),
        std::string("folder/../shots/below/"), folders.file("shots/below/").string()}) {
    for (const auto& [name, body] : ways_to(folder)) {
      CAPTURE(body);
      CHECK(load_scene(folders.scene(body), folders.file("shots")));
      CHECK(load_scene(folders.scene(body), folders.file("shots/inside/..")));
      CHECK(load_scene(folders.scene(body), folders.file("")));
      CHECK(load_scene(folders.scene(body), "/"));
    }
  }
  // The scene itself is named by the caller.
  CHECK(load_scene(folders.scene(""), folders.file("secret")));
  // In a root that is a link.
  fs::create_directory_symlink("shots", folders.file("alias"));
  CHECK(load_scene(folders.scene("<include file=\"part.xml\"/>"), folders.file("alias")));
}

TEST_CASE("what an included file leads to is kept in too", "[scene][root]") {
  const Folders folders;
  const std::string root = folders.file("shots").string();
  const auto write = [&](const std::string& text) {
    std::ofstream(folders.file("shots/below/rig.xml")) << text;
  };
  for (const auto& [name, body] : ways_to("../../secret/")) {
    CAPTURE(body);
    write("<fragment>" + body + "</fragment>");
    const auto scene = load_scene(folders.scene("<include file=\"below/rig.xml\"/>"), root);
    REQUIRE_FALSE(scene);
    CHECK(scene.error().file == folders.file("shots/below/rig.xml"));
    CHECK_THAT(scene.error().message, contains_text("it is outside " + root));
  }
  // What a mesh refers to: by default it may be in the folder of the file that names the mesh.
  std::ofstream(folders.file("shots/below/mesh.gltf"))
      << R"({"asset":{"version":"2.0"},"scenes":[{}],"buffers":[{"byteLength":0,"uri":"../mesh.obj"},{"byteLength":0,"uri":"a.pc2"}]})";
  write("<surface name=\"s\"><mesh file=\"mesh.gltf\"/></surface>");
  const auto scene = folders.scene("<include file=\"below/rig.xml\"/>");
  const auto referred = [&](const std::string& of) {
    std::vector<std::string> names;
    for (const SceneInput& input : inputs_of(load_scene(scene, of).value()))
      names.push_back(input.file.filename());
    return names;
  };
  CHECK(referred("") == std::vector<std::string>{"a.xml", "rig.xml", "mesh.gltf", "a.pc2"});
  CHECK(referred(root) ==
        std::vector<std::string>{"a.xml", "rig.xml", "mesh.gltf", "mesh.obj", "a.pc2"});
}

TEST_CASE("a refused file tells nothing of what is there", "[scene][root]") {
  const Folders folders;
  const auto message = [&](const std::string& name) {
    return load_scene(folders.scene(fmt::format("<include file=\"../{}\"/>", name)),
                      folders.file("shots"))
        .error()
        .message;
  };
  std::string there = message("secret"), absent = message("nowhere");
  for (std::string* one : {&there, &absent})
    for (const char* name : {"secret", "nowhere"})
      for (std::size_t at; (at = one->find(name)) != std::string::npos;)
        one->erase(at, std::string(name).size());
  CHECK(there == absent);
}

}  // namespace
}  // namespace pliant::testing
