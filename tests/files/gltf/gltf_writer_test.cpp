#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <assimp/Importer.hpp>
#include <assimp/scene.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "files/animated_meshes.hpp"
#include "pliant/core/hash.hpp"
#include "pliant/files/boxed/read_assimp.hpp"
#include "pliant/files/formats.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/mesh/drawn_solid.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using nlohmann::json;

namespace {

/// A glTF file parsed according to the format, without the writer's code.
struct WrittenGltf {
  json root;
  std::string numbers;

  explicit WrittenGltf(const std::filesystem::path& file) {
    const std::string bytes = read_file(file).value();
    if (file.extension() == ".gltf") {
      root = json::parse(bytes);
      numbers =
          read_file(file.parent_path() / root["buffers"][0]["uri"].get<std::string>()).value();
      return;
    }
    const auto word = [&](std::size_t at) {
      std::uint32_t number = 0;
      std::memcpy(&number, bytes.data() + at, 4);
      return number;
    };
    REQUIRE(bytes.substr(0, 4) == "glTF");
    CHECK(word(4) == 2);
    CHECK(word(8) == bytes.size());
    const std::size_t json_size = word(12);
    CHECK(json_size % 4 == 0);
    root = json::parse(bytes.substr(20, json_size));
    CHECK(word(20 + json_size) + 28 + json_size == bytes.size());
    CHECK(bytes.substr(24 + json_size, 4) == std::string("BIN\0", 4));
    numbers = bytes.substr(28 + json_size);
  }

  template <class Number>
  std::vector<Number> view(const json& index, std::size_t count) const {
    const json& view = root["bufferViews"][index.get<std::size_t>()];
    std::vector<Number> result(count);
    REQUIRE(count * sizeof(Number) <= view["byteLength"].get<std::size_t>());
    std::memcpy(result.data(), numbers.data() + view["byteOffset"].get<std::size_t>(),
                count * sizeof(Number));
    return result;
  }

  std::vector<float> floats(const json& index) const {
    const json& accessor = root["accessors"][index.get<std::size_t>()];
    const std::string type = accessor["type"];
    const std::size_t width = type == "SCALAR" ? 1 : static_cast<std::size_t>(type[3] - '0');
    const std::size_t count = accessor["count"].get<std::size_t>() * width;
    std::vector<float> result(count, 0);
    if (accessor.contains("bufferView")) result = view<float>(accessor["bufferView"], count);
    if (!accessor.contains("sparse")) return result;
    const json& sparse = accessor["sparse"];
    const std::size_t rows = sparse["count"];
    const auto values = view<float>(sparse["values"]["bufferView"], rows * width);
    const auto rows_at = [&](auto number) {
      const auto indices = view<decltype(number)>(sparse["indices"]["bufferView"], rows);
      for (std::size_t k = 0; k < rows; ++k)
        for (std::size_t n = 0; n < width; ++n)
          result[indices[k] * width + n] = values[k * width + n];
    };
    const int type_of_indices = sparse["indices"]["componentType"];
    if (type_of_indices == 5121) rows_at(std::uint8_t{});
    if (type_of_indices == 5123) rows_at(std::uint16_t{});
    if (type_of_indices == 5125) rows_at(std::uint32_t{});
    return result;
  }

  /// Positions of a mesh's vertices at one key of its weights.
  std::vector<float> shape(std::size_t mesh, std::size_t key) const {
    const json& primitive = root["meshes"][mesh]["primitives"][0];
    std::vector<float> positions = floats(primitive["attributes"]["POSITION"]);
    if (!primitive.contains("targets")) return positions;
    for (const json& channel : root["animations"][0]["channels"]) {
      if (channel["target"]["path"] != "weights" || channel["target"]["node"] != mesh) continue;
      const json& sampler =
          root["animations"][0]["samplers"][channel["sampler"].get<std::size_t>()];
      const auto weights = floats(sampler["output"]);
      const std::size_t targets = primitive["targets"].size();
      for (std::size_t target = 0; target < targets; ++target) {
        const float weight = weights[key * targets + target];
        if (weight == 0) continue;
        CHECK(weight == 1);
        const auto offsets = floats(primitive["targets"][target]["POSITION"]);
        for (std::size_t k = 0; k < offsets.size(); ++k) positions[k] += offsets[k];
      }
    }
    return positions;
  }
};

std::filesystem::path written(const ScratchFolder& folder, const char* name, const Mesh& mesh,
                              const std::vector<Field>& frames) {
  REQUIRE(write_all(plan_of(folder.file(name), mesh), {frames}));
  return folder.file(name);
}

}  // namespace

TEST_CASE("glTF gives every frame to a rounding", "[output][gltf]") {
  const ScratchFolder folder;
  Mesh mesh = dressed_sheet();
  mesh.positions += 0.1 * Field::Random(12, 3);
  std::vector<Field> frames;
  const double reach = GENERATE(0.0, 1e-3, 1.0, 1e4);
  for (int k = 0; k < 5; ++k) frames.push_back(mesh.positions + reach * Field::Random(12, 3));
  const WrittenGltf gltf(written(folder, GENERATE("a.glb", "a.gltf"), mesh, frames));
  for (std::size_t frame = 0; frame < 5; ++frame) {
    const auto positions = gltf.shape(0, frame);
    REQUIRE(positions.size() > 36);  // a seam and a hard edge split vertices
    for (int vertex = 0; vertex < 12; ++vertex) {
      for (int k = 0; k < 3; ++k) {
        const double exact = frames[frame](vertex, k);
        // The offset is rounded once, and the sum once.
        const double offset = exact - mesh.positions(vertex, k);
        const double bound = 0x1p-24 * (std::abs(exact) + std::abs(offset)) * 1.01 + 0x1p-149;
        CHECK(std::abs(static_cast<double>(positions[static_cast<std::size_t>(3 * vertex + k)]) -
                       exact) <= bound);
      }
    }
  }
}

TEST_CASE("offsets are sparse where that is smaller", "[output][gltf]") {
  const ScratchFolder folder;
  const int rows = GENERATE(5, 10, 2000);
  if (is_sanitized && rows > 10) return;
  const Mesh mesh = make_mesh({.columns = 40, .rows = rows});
  const int last = mesh.vertex_count() - 1;
  const WrittenGltf gltf(written(folder, "a.glb", mesh, bump(mesh.positions, last, 3)));
  const json& targets = gltf.root["meshes"][0]["primitives"][0]["targets"];
  REQUIRE(targets.size() == 2);  // the first frame is at rest
  for (const json& target : targets) {
    const json& accessor = gltf.root["accessors"][target["POSITION"].get<std::size_t>()];
    CHECK_FALSE(accessor.contains("bufferView"));
    CHECK(accessor["sparse"]["count"] == 1);
    CHECK(accessor["sparse"]["indices"]["componentType"] == (last < 256     ? 5121
                                                             : last < 65536 ? 5123
                                                                            : 5125));
    CHECK(accessor["min"] == json::array({0, 0, 0}));
    CHECK(accessor["max"][1].get<float>() ==
          gltf.floats(target["POSITION"])[3 * static_cast<std::size_t>(last) + 1]);
  }
  CHECK(gltf.shape(0, 2)[3 * static_cast<std::size_t>(last) + 1] == 0.2f);

  std::vector<Field> dense = {mesh.positions, mesh.positions.array() + 1};
  const WrittenGltf moved(written(folder, "b.glb", mesh, dense));
  const json& target = moved.root["meshes"][0]["primitives"][0]["targets"][0];
  CHECK_FALSE(moved.root["accessors"][target["POSITION"].get<std::size_t>()].contains("sparse"));
  // Normals do not change if all vertices move alike: they need no bytes.
  const json& normals = moved.root["accessors"][target["NORMAL"].get<std::size_t>()];
  CHECK_FALSE(normals.contains("sparse"));
  CHECK_FALSE(normals.contains("bufferView"));
}

TEST_CASE("frames of equal bits share a target, adjacent or not", "[output][gltf]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  const auto shapes = bump(mesh.positions, 4, 4);  // the first one is at rest
  const std::vector<std::size_t> shown = {0, 1, 1, 2, 0, 3, 1, 2, 2, 3, 0};
  std::vector<Field> frames;
  for (const std::size_t shape : shown) frames.push_back(shapes[shape]);
  const WrittenGltf gltf(written(folder, "a.glb", mesh, frames));
  CHECK(gltf.root["meshes"][0]["primitives"][0]["targets"].size() == 3);
  for (std::size_t key = 0; key < shown.size(); ++key)
    CHECK(gltf.shape(0, key)[13] == static_cast<float>(frames[key](4, 1)));
  const WrittenGltf still(written(folder, "b.glb", mesh, {shapes[0], shapes[0]}));
  CHECK_FALSE(still.root.contains("animations"));
  CHECK_FALSE(still.root["meshes"][0]["primitives"][0].contains("targets"));
}

TEST_CASE("times are seconds from the first frame, whatever the rate", "[output][gltf]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  AnimationPlan plan = plan_of(folder.file("a.glb"), mesh);
  plan.fps = 24000.0 / 1001;
  REQUIRE(write_all(plan, {bump(mesh.positions, 4, 4)}));
  const WrittenGltf gltf(folder.file("a.glb"));
  const auto times = gltf.floats(gltf.root["animations"][0]["samplers"][0]["input"]);
  REQUIRE(times.size() == 4);
  for (int k = 0; k < 4; ++k)
    CHECK(times[static_cast<std::size_t>(k)] == static_cast<float>(k * 1001.0 / 24000));
}

TEST_CASE("vertices of the mesh come first, then those split off", "[output][gltf]") {
  const ScratchFolder folder;
  const Mesh mesh = dressed_sheet();
  const WrittenGltf gltf(written(folder, "a.glb", mesh, bump(mesh.positions, 5, 2)));
  const json& attributes = gltf.root["meshes"][0]["primitives"][0]["attributes"];
  const auto positions = gltf.floats(attributes["POSITION"]);
  for (int vertex = 0; vertex < 12; ++vertex)
    for (int k = 0; k < 3; ++k)
      CHECK(positions[static_cast<std::size_t>(3 * vertex + k)] ==
            static_cast<float>(mesh.positions(vertex, k)));
  // Three vertices of the flat face also belong to other faces, and one has two (u,v).
  CHECK(positions.size() == 3 * (12 + 3 + 1));
}

TEST_CASE("assimp finds materials, shading and (u,v) of a glTF", "[output][gltf][threads]") {
  const ScratchFolder folder;
  const Mesh mesh = dressed_sheet();
  const Mesh back =
      read_assimp(written(folder, "a.glb", mesh, bump(mesh.positions, 5, 3)), "sheet").value();
  CHECK(back.materials.names == std::vector<std::string>{"Skin red", "Steel"});
  CHECK(back.face_sizes.size() == 12);
  CHECK(std::count(back.materials.of_faces.begin(), back.materials.of_faces.end(), 0) == 6);
  CHECK(std::count(back.materials.of_faces.begin(), back.materials.of_faces.end(), -1) == 2);
  Assimp::Importer importer;
  const aiScene* const scene = importer.ReadFile(folder.file("a.glb").string(), 0);
  REQUIRE(scene);
  REQUIRE(scene->mNumMeshes == 3);  // one per material
  REQUIRE(scene->mMeshes[0]->mNumAnimMeshes == 2);
  CHECK(scene->mMeshes[0]->mAnimMeshes[1]->mVertices[5].y == 0.2f);
  CHECK(scene->mNumAnimations == 1);
}

TEST_CASE("a placed surface is a node that moves", "[output][gltf]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  AnimationPlan plan = plan_of(folder.file("a.glb"), mesh);
  plan.is_placed = true;
  plan.first_frame = 1;
  plan.last_frame = 3;
  auto writer = make_writer(plan).value();
  const auto placement = [](int frame) {
    return Placement{{1.0 * frame, 2, 3}, {20, 100.0 * frame, -40}, {1, -2, 0.5}, RotateOrder::Zxy};
  };
  for (int frame = 1; frame <= 3; ++frame)
    REQUIRE(writer->write(frame, std::vector<SurfacePose>{{mesh.positions, placement(frame)}}));
  REQUIRE(writer->finish());
  const WrittenGltf gltf(folder.file("a.glb"));
  CHECK(gltf.root["nodes"][0]["scale"] == json::array({1, -2, 0.5}));
  const json& animation = gltf.root["animations"][0];
  REQUIRE(animation["channels"].size() == 2);  // the scale does not change
  CHECK(animation["channels"][1]["target"]["path"] == "rotation");
  const auto rotations = gltf.floats(animation["samplers"][1]["output"]);
  for (int frame = 1; frame <= 3; ++frame) {
    const float* q = rotations.data() + 4 * (frame - 1);
    const Eigen::Matrix3d rotation = Eigen::Quaterniond(q[3], q[0], q[1], q[2]).toRotationMatrix();
    Placement turned = placement(frame);
    turned.scale = Vector3d::Ones();
    CHECK((rotation - make_transform(turned).linear).cwiseAbs().maxCoeff() < 1e-6);
    if (frame > 1) {  // the shorter way
      float dot = 0;
      for (int k = 0; k < 4; ++k) dot += q[k] * q[k - 4];
      CHECK(dot >= 0);
    }
  }
}

TEST_CASE("a collider is a node that moves, hidden by a scale of 0", "[output][gltf]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({}), solid = make_ball_mesh(1).mesh;
  REQUIRE(write_all(plan_of(folder.file("none.glb"), mesh), {{mesh.positions, mesh.positions}}));
  const Field grown = 1.5 * solid.positions;
  const bool grows = GENERATE(false, true);
  const Field& last = grows ? grown : solid.positions;
  REQUIRE(write_collider(plan_of(folder.file("a.glb"), mesh), solid,
                         {solid.positions, solid.positions, last, last}));
  const WrittenGltf none(folder.file("none.glb")), gltf(folder.file("a.glb"));
  CHECK_FALSE(none.root.contains("animations"));
  CHECK(gltf.root["nodes"][0] == none.root["nodes"][0]);
  CHECK(gltf.root["meshes"][0] == none.root["meshes"][0]);
  CHECK(gltf.root["nodes"].size() == 2);
  CHECK(gltf.root["nodes"][1]["name"] == "ball-1");
  const json& mesh_of_ball = gltf.root["meshes"][1];
  const json& material =
      gltf.root["materials"][mesh_of_ball["primitives"][0]["material"].get<std::size_t>()];
  CHECK(material["name"] == "collider");
  CHECK(material["pbrMetallicRoughness"].contains("baseColorFactor"));
  CHECK(mesh_of_ball["primitives"][0].contains("targets") == grows);
  const json& animation = gltf.root["animations"][0];
  const auto channel = [&](const std::string& path) {
    for (const json& each : animation["channels"]) {
      if (each["target"]["path"] != path) continue;
      CHECK(each["target"]["node"] == 1);
      return animation["samplers"][each["sampler"].get<std::size_t>()];
    }
    FAIL(path);
    return json();
  };
  CHECK(gltf.floats(channel("translation")["output"]) ==
        std::vector<float>{1, 2, 3, 2, 2, 3, 3, 2, 3, 4, 2, 3});
  CHECK(gltf.floats(channel("scale")["output"]) ==
        std::vector<float>{1, 1, 1, 2, 1, 1, 0, 0, 0, 4, 1, 1});
  CHECK(channel("scale")["interpolation"] == "STEP");  // it does not shrink to be hidden
  CHECK(channel("translation")["interpolation"] == "LINEAR");
  if (grows) CHECK(gltf.floats(channel("weights")["output"]) == std::vector<float>{0, 0, 1, 1});
}

TEST_CASE("formats of one surface do not write colliders", "[output]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({}), solid = make_ball_mesh(1).mesh;
  for (const char* name : {"a.npy", "a.obj", "a.ply", "a.pc2", "a.mdd"}) {
    REQUIRE(write_all(plan_of(folder.file(std::string("none") + name), mesh),
                      {{mesh.positions, mesh.positions, mesh.positions, mesh.positions}}));
    REQUIRE(write_collider(plan_of(folder.file(name), mesh), solid,
                           std::vector<Field>(4, solid.positions)));
  }
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder.file(""))) {
    const std::string name = entry.path().filename().string();
    if (name.substr(0, 1) != "a") continue;
    ++files;
    CHECK(read_file(entry.path()).value() == read_file(folder.file("none" + name)).value());
  }
  CHECK(files > 5);
}

TEST_CASE("what glTF cannot hold is refused ahead", "[output][gltf]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  AnimationPlan plan = plan_of(folder.file("a.glb"), mesh);
  plan.first_frame = 1;
  plan.last_frame = most_gltf_frames + 1;
  const auto writer = make_writer(plan);
  REQUIRE_FALSE(writer);
  CHECK(writer.error().code == ErrorCode::InvalidInput);
  CHECK_THAT(writer.error().message, contains_text(".usda, .pc2"));
  CHECK(folder.entry_count() == 0);
}

TEST_CASE("an unfinished glTF leaves nothing", "[output][gltf]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  for (const char* name : {"a.glb", "a.gltf", "a.usda", "a.pc2", "a.mdd"}) {
    AnimationPlan plan = plan_of(folder.file(name), mesh);
    plan.last_frame = 3;
    auto writer = make_writer(plan).value();
    REQUIRE(writer->write(0, std::vector<SurfacePose>{{mesh.positions}}));
    writer.reset();
    CHECK(folder.entry_count() == 0);
  }
}

namespace {

/// Names of the files with numbers of STEM.gltf.
std::vector<std::string> numbers_of(const ScratchFolder& folder, const std::string& stem) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    const std::string name = entry.path().filename().string();
    const std::string digits = name.substr(std::min(name.size(), stem.size() + 1));
    if (name.starts_with(stem + '.') && digits.size() == 20 && digits.ends_with(".bin") &&
        digits.find_first_not_of("0123456789abcdef") == 16) {
      names.push_back(name);
    }
  }
  return names;
}

}  // namespace

TEST_CASE("a name that has to be escaped finds its numbers", "[output][gltf]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  const auto file = written(folder, "a b%20ü.gltf", mesh, bump(mesh.positions, 4, 2));
  const json root = json::parse(read_file(file).value());
  const auto numbers = numbers_of(folder, "a b%20ü");
  REQUIRE(numbers.size() == 1);
  CHECK(root["buffers"][0]["uri"] ==
        "a%20b%2520%C3%BC" + numbers.front().substr(std::string("a b%20ü").size()));
}

TEST_CASE("a glTF's numbers are named by what they are", "[output][gltf]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  written(folder, "a.gltf", mesh, bump(mesh.positions, 4, 3));
  const auto first = numbers_of(folder, "a");
  REQUIRE(first.size() == 1);
  const std::string bytes = read_file(folder.file(first.front())).value();
  CHECK(first.front() == "a." + to_text(hash_of(bytes)).substr(0, 16) + ".bin");
  written(folder, "a.gltf", mesh, bump(mesh.positions, 4, 3));
  CHECK(numbers_of(folder, "a") == first);
}

TEST_CASE("only the numbers of the glTF that is replaced are removed", "[output][gltf]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  written(folder, "a.gltf", mesh, bump(mesh.positions, 4, 3));
  const std::string first = numbers_of(folder, "a").front();
  const std::string left = "of another glTF, or of a bake that was killed";
  const std::vector<std::string> others = {"a." + to_text(hash_of(left)).substr(0, 16) + ".bin",
                                           "a.bin",
                                           "a.0123456789ABCDEF.bin",
                                           "a.123456789abcdef.bin",
                                           "b.0123456789abcdef.bin",
                                           "a.0123456789abcdef.binary"};
  for (const std::string& other : others) folder.write(other, left);
  written(folder, "a.gltf", mesh, bump(mesh.positions, 5, 3));
  const std::string second = numbers_of(folder, "a").front();
  CHECK_FALSE(std::filesystem::exists(folder.file(first)));
  for (const std::string& other : others) CHECK(std::filesystem::exists(folder.file(other)));
}

TEST_CASE("numbers that another glTF refers to stay, however it does so", "[output][gltf]") {
  const Mesh mesh = make_mesh({});
  const auto json_of = [](const std::string& uri) {
    return R"({"asset":{"version":"2.0"},"buffers":[{"uri":")" + uri + R"("}]})";
  };
  const auto in_glb = [&](const std::string& text) {
    std::string bytes = "glTF";
    for (const std::uint32_t number : {2U, static_cast<std::uint32_t>(20 + text.size()),
                                       static_cast<std::uint32_t>(text.size())})
      bytes.append(reinterpret_cast<const char*>(&number), 4);
    return bytes + "JSON" + text;
  };
  const auto escaped = [](const std::string& name, const std::string& form) {
    std::string uri;
    for (const char c : name) uri += fmt::format(fmt::runtime(form), static_cast<unsigned>(c));
    return uri;
  };
  for (const std::string way :
       {"copy", "escaped", "escaped twice", "split", "glb", "other chunk", "UTF-16", "large glb"}) {
    CAPTURE(way);
    const ScratchFolder folder;
    written(folder, "a.gltf", mesh, bump(mesh.positions, 4, 3));
    const std::string numbers = numbers_of(folder, "a").front();
    if (way == "copy") std::filesystem::copy(folder.file("a.gltf"), folder.file("copy.GLTF"));
    if (way == "escaped") folder.write("b.gltf", json_of(escaped(numbers, "%{:02x}")));
    if (way == "escaped twice")
      folder.write("b.gltf", json_of(escaped(escaped(numbers, "%{:02X}"), "\\u{:04x}")));
    // As readers of URLs read it: without tabs and line ends.
    if (way == "split")
      folder.write("b.gltf", json_of(numbers.substr(0, 9) + "\\t" + numbers.substr(9)));
    if (way == "glb") folder.write("b.glb", in_glb(json_of(numbers)));
    if (way == "other chunk")
      folder.write("b.glb", in_glb("").replace(16, 4, "BIN") + json_of(numbers));
    if (way == "UTF-16") folder.write("b.gltf", "\xFF\xFE" + std::string("{\0", 2));
    if (way == "large glb") {
      folder.write("b.Glb", in_glb(json_of(numbers)));
      std::filesystem::resize_file(folder.file("b.Glb"), std::uintmax_t{1} << 30);
    }
    written(folder, "a.gltf", mesh, bump(mesh.positions, 5, 3));
    CHECK(std::filesystem::exists(folder.file(numbers)));
    CHECK(numbers_of(folder, "a").size() == 2);
  }
}

TEST_CASE("a placement that glTF cannot hold is an error with its place", "[output][gltf]") {
  const Mesh mesh = make_mesh({});
  const double inf = std::numeric_limits<double>::infinity();
  struct Case {
    Placement placement;
    const char* single;  // glTF's message; null: no error
    const char* twice;   // USD's message; null: no error
  };
  const std::vector<Case> cases = {
      {{{0, 1e300, 0}},
       "translate of 1e+300, which is too large for the single precision",
       nullptr},
      {{{0, 0, 0}, {0, 0, 0}, {1, 1, 3.5e38}}, "scale of 3.5e+38, which is too large", nullptr},
      {{{0, 0, 0}, {0, 0, 0}, {1, -1e-50, 1}}, "scale of -1e-50, which is too small", nullptr},
      {{{1e-50, 0, 0}}, nullptr, nullptr},
      {{{0, 0, 0}, {0, 1e300, 0}}, nullptr, nullptr},
      {{{-inf, 0, 0}}, "translate of -inf, which is not finite", "translate of -inf, which is no"},
      {{{0, 0, 0}, {0, 0, inf}},
       "rotate of inf, which is not finite",
       "rotate of inf, which is no"},
      {{{0, 0, 0}, {0, 0, 0}, {1, inf, 1}}, "scale of inf", "scale of inf"}};
  for (const Case& each : cases) {
    for (const char* name : {"a.gltf", "a.glb", "a.usda"}) {
      const ScratchFolder folder;
      AnimationPlan plan = plan_of(folder.file(name), mesh);
      plan.is_placed = true;
      plan.first_frame = 6;
      plan.last_frame = 7;
      auto writer = make_writer(plan).value();
      REQUIRE(writer->write(6, std::vector<SurfacePose>{{mesh.positions}}));
      const auto moved =
          writer->write(7, std::vector<SurfacePose>{{mesh.positions, each.placement}});
      const char* const words = std::string(name) == "a.usda" ? each.twice : each.single;
      CAPTURE(name, words == nullptr ? "" : words);
      CHECK(static_cast<bool>(moved) == (words == nullptr));
      if (moved || words == nullptr) continue;
      CHECK(moved.error().code == ErrorCode::NotFinite);
      CHECK_THAT(moved.error().message,
                 contains_text(std::string("surface \"sheet\" at frame 7 has a ") + words));
    }
  }
}

TEST_CASE("a position that a format cannot hold is told by the mesh's own vertex",
          "[output][gltf]") {
  Mesh mesh = make_mesh({});
  mesh.first_index = 1;
  for (const char* name : {"a.gltf", "a.usda", "a.pc2"}) {
    for (const double coordinate : {1e39, std::numeric_limits<double>::infinity()}) {
      const ScratchFolder folder;
      Field moved = mesh.positions;
      moved(2, 1) = coordinate;
      const auto all = write_all(plan_of(folder.file(name), mesh), {{mesh.positions, moved}});
      REQUIRE_FALSE(all);
      CHECK_THAT(all.error().message, contains_text("vertex 3 at frame "));
      CHECK_THAT(all.error().message,
                 contains_text(std::isinf(coordinate) ? "which is not finite"
                                                      : ".npy, .obj and .ply store double"));
    }
  }
}

TEST_CASE("numbers that are not what their name says are nobody's to remove", "[output][gltf]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  const auto mine = folder.write("a.0123456789abcdef.bin", "precious");
  written(folder, "a.gltf", mesh, {mesh.positions, mesh.positions});
  CHECK(folder.entry_count() == 3);
  written(folder, "a.gltf", mesh, bump(mesh.positions, 5, 2));
  CHECK(folder.entry_count() == 3);  // the old numbers are removed
  CHECK(read_file(mine).value() == "precious");
}

TEST_CASE("times beyond single precision are refused ahead", "[output][gltf]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  for (const char* name : {"a.gltf", "a.glb", "a.mdd"}) {
    AnimationPlan plan = plan_of(folder.file(name), mesh);
    plan.last_frame = 2;
    plan.fps = 1e-39;
    const auto writer = make_writer(plan);
    REQUIRE_FALSE(writer);
    CHECK_THAT(writer.error().message, contains_text("too large for the single precision"));
  }
  CHECK(folder.entry_count() == 0);
}
