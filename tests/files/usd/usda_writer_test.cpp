#include <regex>
#include <sstream>

#include "files/animated_meshes.hpp"
#include "pliant/files/formats.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/files/usd/usda_names.hpp"
#include "pliant/mesh/drawn_solid.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

/// The numbers of one sample of an attribute, found in the text.
std::vector<double> sample(const std::string& text, const std::string& attribute, int frame) {
  const std::size_t begin = text.find(attribute + ".timeSamples = {");
  REQUIRE(begin != std::string::npos);
  const std::size_t at = text.find("            " + std::to_string(frame) + ": ", begin);
  REQUIRE(at < text.find('}', begin));
  const std::size_t end = text.find('\n', at);
  std::string row = text.substr(text.find(':', at) + 1, end - text.find(':', at) - 1);
  for (char& c : row)
    if (c == '(' || c == ')' || c == ',' || c == '[' || c == ']') c = ' ';
  std::istringstream stream(row);
  std::vector<double> numbers;
  for (double number = 0; stream >> number;) numbers.push_back(number);
  return numbers;
}

std::string written(const ScratchFolder& folder, AnimationPlan plan,
                    const std::vector<std::vector<Field>>& frames) {
  plan.file = folder.file("a.usda");
  REQUIRE(write_all(plan, frames));
  return read_file(plan.file).value();
}

}  // namespace

TEST_CASE("a USD file has every frame, and velocities that lead to the next", "[output][usda]") {
  const ScratchFolder folder;
  const Mesh mesh = dressed_sheet();
  std::vector<Field> frames;
  for (int k = 0; k < 4; ++k) frames.push_back(mesh.positions + Field::Random(12, 3));
  AnimationPlan plan = plan_of({}, mesh);
  plan.fps = 24000.0 / 1001;
  const std::string text = written(folder, plan, {frames});
  for (const char* line :
       {"defaultPrim = \"scene\"", "startTimeCode = 1\n", "endTimeCode = 4\n",
        "timeCodesPerSecond = 23.976023976023978\n", "framesPerSecond = 23.976023976023978\n",
        "metersPerUnit = 1\n", "upAxis = \"Y\"\n", "subdivisionScheme = \"none\"",
        "interpolation = \"faceVarying\"", "def GeomSubset \"Skin_red\"",
        "displayName = \"Skin red\"", "</scene/materials/Skin_red>"})
    CHECK_THAT(text, contains_text(line));
  for (int frame = 1; frame <= 4; ++frame) {
    const auto points = sample(text, "points", frame);
    const auto extent = sample(text, "extent", frame);
    const auto velocities = sample(text, "velocities", frame);
    REQUIRE((points.size() == 36 && extent.size() == 6 && velocities.size() == 36));
    CHECK(sample(text, "normals", frame).size() == 3 * mesh.corner_vertices.size());
    const int from = std::min(frame, 3) - 1;
    for (int k = 0; k < 36; ++k) {
      const std::size_t n = static_cast<std::size_t>(k);
      const double exact = frames[static_cast<std::size_t>(frame - 1)](k / 3, k % 3);
      CHECK(static_cast<float>(points[n]) == static_cast<float>(exact));
      CHECK((extent[n % 3] <= points[n] && points[n] <= extent[n % 3 + 3]));
      const double way = frames[static_cast<std::size_t>(from + 1)](k / 3, k % 3) -
                         frames[static_cast<std::size_t>(from)](k / 3, k % 3);
      CHECK_THAT(velocities[n], WithinAbs(way * plan.fps, 1e-5));
    }
  }
}

TEST_CASE("a single frame has no velocities", "[output][usda]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  const std::string text = written(folder, plan_of({}, mesh), {{mesh.positions}});
  CHECK(text.find("velocities") == std::string::npos);
  CHECK_THAT(text, contains_text("interpolation = \"vertex\""));
}

TEST_CASE("surfaces whose names meet in USD stay apart", "[output][usda]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  AnimationPlan plan;
  for (const char* name : {"a-b", "a_b", "materials", "a_b_2"})
    plan.surfaces.push_back({name, &mesh, mesh.positions});
  const std::vector<Field> still = {mesh.positions};
  const std::string text = written(folder, plan, {still, still, still, still});
  for (const char* prim : {"\"a_b\"", "\"a_b_2\"", "\"materials\"", "\"a_b_2_2\""})
    CHECK_THAT(text, contains_text(std::string("def Mesh ") + prim));
  CHECK_THAT(text, contains_text("displayName = \"a-b\""));
}

TEST_CASE("USD names are plain and taken once", "[output][usda]") {
  UsdaNames names;
  CHECK(names.take("3 Bälle") == "_3_B__lle");
  CHECK(names.take("") == "_");
  CHECK(names.take("x") == "x");
  CHECK(names.take("x") == "x_2");
  CHECK(names.take("x_2") == "x_2_2");
  CHECK(names.take("y_2") == "y_2");
  CHECK(names.take("y") == "y");
  CHECK(names.take("y") == "y_3");
  CHECK(usda_string("a\"b\\c\n") == "\"a\\\"b\\\\c_\"");
}

TEST_CASE("a placed surface has its transform in USD", "[output][usda]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  AnimationPlan plan = plan_of(folder.file("a.usda"), mesh);
  plan.is_placed = true;
  plan.first_frame = 1;
  plan.last_frame = 2;
  auto writer = make_writer(plan).value();
  for (int frame = 1; frame <= 2; ++frame) {
    const Placement placement{{0.1 * frame, 2, 3}, {4, 5, 6}, {1, 1, 2}, RotateOrder::Yzx};
    REQUIRE(writer->write(frame, std::vector<SurfacePose>{{mesh.positions, placement}}));
  }
  REQUIRE(writer->finish());
  const std::string text = read_file(folder.file("a.usda")).value();
  CHECK(sample(text, "xformOp:translate", 2) == std::vector{0.2, 2.0, 3.0});
  CHECK_THAT(text, contains_text("double3 xformOp:rotateYZX = (4, 5, 6)\n"));
  CHECK_THAT(text, contains_text("xformOpOrder = [\"xformOp:translate\", \"xformOp:rotateYZX\", "
                                 "\"xformOp:scale\"]"));
}

TEST_CASE("a collider has samples in USD only where it changes", "[output][usda]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({}), solid = make_ball_mesh(1).mesh;
  const Field grown = 1.5 * solid.positions;
  const AnimationPlan plan = plan_of(folder.file("a.usda"), mesh);
  REQUIRE(write_collider(plan, solid, {solid.positions, solid.positions, solid.positions, grown}));
  const std::string all = read_file(folder.file("a.usda")).value();
  REQUIRE(all.find("def Mesh \"ball_1\"") != std::string::npos);
  const std::string text = all.substr(all.find("def Mesh \"ball_1\""));
  CHECK_THAT(text, contains_text("displayName = \"ball-1\""));
  CHECK_THAT(text, contains_text("rel material:binding = </scene/materials/collider>"));
  CHECK(text.find("velocities") == std::string::npos);
  for (int frame = 1; frame <= 4; ++frame) {
    CHECK(sample(text, "xformOp:translate", frame) == std::vector{1.0 * frame, 2.0, 3.0});
    CHECK(sample(text, "xformOp:scale", frame) == std::vector{1.0 * frame, 1.0, 1.0});
    CHECK_THAT(text, contains_text(std::to_string(frame) +
                                   (frame == 3 ? ": \"invisible\"" : ": \"inherited\"")));
  }
  // The frame before a change keeps what was.
  const std::string points = text.substr(text.find("points.timeSamples"),
                                         text.find("normals (") - text.find("points.timeSamples"));
  CHECK(points.find("            2: ") == std::string::npos);
  for (const auto& [frame, size] : {std::pair(1, 1.0), {3, 1.0}, {4, 1.5}}) {
    const auto extent = sample(text, "extent", frame);
    CHECK(extent == std::vector{-size, -size, -size, size, size, size});
    CHECK(sample(text, "points", frame).size() == 3 * static_cast<std::size_t>(grown.rows()));
  }
}
