#include <bit>
#include <cstdint>

#include "files/animated_meshes.hpp"
#include "pliant/files/formats.hpp"
#include "pliant/files/obj/read_obj.hpp"
#include "pliant/files/read_file.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

std::uint32_t bits_at(const std::string& bytes, std::size_t at, bool is_big) {
  std::uint32_t bits = 0;
  for (std::size_t k = 0; k < 4; ++k)
    bits |= std::uint32_t{static_cast<unsigned char>(bytes[at + k])} << 8 * (is_big ? 3 - k : k);
  return bits;
}

float float_at(const std::string& bytes, std::size_t at, bool is_big) {
  return std::bit_cast<float>(bits_at(bytes, at, is_big));
}

void check_positions(const std::string& bytes, std::size_t at, bool is_big,
                     const std::vector<Field>& frames) {
  for (const Field& frame : frames) {
    for (Eigen::Index row = 0; row < frame.rows(); ++row)
      for (int k = 0; k < 3; ++k, at += 4)
        CHECK(float_at(bytes, at, is_big) == static_cast<float>(frame(row, k)));
  }
  CHECK(at == bytes.size());
}

}  // namespace

TEST_CASE("a PC2 file has its header and every position", "[output][point_cache]") {
  const ScratchFolder folder;
  const Mesh mesh = dressed_sheet();
  const auto frames = bump(mesh.positions, 5, 3);
  auto writer =
      make_pc2_writer(
          {.file = folder.file("a.pc2"), .mesh = &mesh, .first_frame = -2, .last_frame = 0})
          .value();
  for (int k = 0; k < 3; ++k) REQUIRE(writer->write(k - 2, {frames[static_cast<std::size_t>(k)]}));
  CHECK(folder.entry_count() == 2);  // both unfinished
  CHECK_FALSE(std::filesystem::exists(folder.file("a.pc2")));
  REQUIRE(writer->finish());
  const std::string bytes = read_file(folder.file("a.pc2")).value();
  CHECK(bytes.substr(0, 12) == std::string("POINTCACHE2\0", 12));
  CHECK(bits_at(bytes, 12, false) == 1);
  CHECK(bits_at(bytes, 16, false) == 12);
  CHECK(float_at(bytes, 20, false) == -2);
  CHECK(float_at(bytes, 24, false) == 1);
  CHECK(bits_at(bytes, 28, false) == 3);
  check_positions(bytes, 32, false, frames);
}

TEST_CASE("an MDD file is big endian and counts seconds from its first frame",
          "[output][point_cache]") {
  const ScratchFolder folder;
  const Mesh mesh = dressed_sheet();
  const auto frames = bump(mesh.positions, 5, 3);
  AnimationPlan plan = plan_of(folder.file("a.mdd"), mesh);
  plan.fps = 24000.0 / 1001;
  REQUIRE(write_all(plan, {frames}));
  const std::string bytes = read_file(folder.file("a.mdd")).value();
  CHECK(bits_at(bytes, 0, true) == 3);
  CHECK(bits_at(bytes, 4, true) == 12);
  for (int k = 0; k < 3; ++k)
    CHECK(float_at(bytes, 8 + 4 * static_cast<std::size_t>(k), true) ==
          static_cast<float>(k * 1001.0 / 24000));
  check_positions(bytes, 20, true, frames);
}

TEST_CASE("a point cache comes with the mesh that it moves", "[output][point_cache]") {
  const ScratchFolder folder;
  const Mesh mesh = dressed_sheet();
  AnimationPlan plan = plan_of(folder.file("a.pc2"), mesh);
  plan.surfaces[0].rest.array() += 7;
  REQUIRE(write_all(plan, {bump(mesh.positions, 5, 2)}));
  const Mesh back = read_obj(folder.file("a.obj")).value();
  CHECK(back.positions == plan.surfaces[0].rest);
  CHECK(back.corner_vertices == mesh.corner_vertices);
  CHECK(back.materials == mesh.materials);
  CHECK(folder.entry_count() == 2);
}

TEST_CASE("what is beyond single precision is refused", "[output][point_cache]") {
  const ScratchFolder folder;
  const Mesh mesh = dressed_sheet();
  auto frames = bump(mesh.positions, 5, 2);
  frames[1](3, 2) = 1e39;
  for (const char* name : {"a.pc2", "a.mdd", "a.glb", "a.gltf", "a.usda"}) {
    const auto written = write_all(plan_of(folder.file(name), mesh), {frames});
    REQUIRE_FALSE(written);
    CHECK(written.error().code == ErrorCode::NotFinite);
    CHECK_THAT(written.error().message, contains_text("vertex 3 at frame 2"));
    CHECK(folder.entry_count() == 0);
  }
}
