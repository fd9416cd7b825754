#include "pliant/files/row_order.hpp"

#include <bit>
#include <cstdint>
#include <string>

#include "pliant/files/formats.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "support/catch.hpp"
#include "support/npy.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

// More rows than are written at a time, and not a multiple of that number.
const Mesh& large_mesh() {
  static const Mesh mesh = make_mesh({.columns = 131, .rows = 129});
  return mesh;
}

}  // namespace

TEST_CASE("blocks of rows follow each other without a gap", "[output][row_order]") {
  for (const Eigen::Index rows : {Eigen::Index{1}, rows_at_a_time - 1, rows_at_a_time,
                                  rows_at_a_time + 1, 2 * rows_at_a_time + 5}) {
    const Field field = Field::Random(rows, 3);
    Eigen::Index next = 0;
    const Result<void> done =
        for_row_blocks(field, [&](Eigen::Index first, Eigen::Index count) -> Result<void> {
          CHECK(first == next);
          CHECK((count > 0 && count <= rows_at_a_time));
          next += count;
          return {};
        });
    CHECK(done);
    CHECK(next == rows);
  }
  const Field field = Field::Random(3 * rows_at_a_time, 3);
  int asked = 0;
  const Result<void> stopped =
      for_row_blocks(field, [&](Eigen::Index, Eigen::Index) -> Result<void> {
        return ++asked == 2 ? Result<void>(fail(ErrorCode::Unwritable, "full")) : Result<void>();
      });
  CHECK_FALSE(stopped);
  CHECK(asked == 2);
}

TEST_CASE("files of several blocks hold every number in its place", "[output][row_order]") {
  const ScratchFolder folder;
  const Mesh& mesh = large_mesh();
  const Eigen::Index rows = mesh.vertex_count();
  REQUIRE(rows > 2 * rows_at_a_time);
  const Field frames[] = {Field::Random(rows, 3), Field::Random(rows, 3)};
  for (const char* name : {"a.npy", "a.pc2", "a.mdd"}) {
    const SurfacePlan plan{folder.file(name), &mesh, 1, 2};
    const bool is_npy = name[2] == 'n', is_mdd = name[2] == 'm';
    auto writer = (is_npy   ? make_npy_writer(plan)
                   : is_mdd ? make_mdd_writer(plan)
                            : make_pc2_writer(plan))
                      .value();
    for (int k = 0; k < 2; ++k) REQUIRE(writer->write(k + 1, {frames[k]}));
    REQUIRE(writer->finish());
    if (is_npy) {
      const NpyFile npy = NpyFile::read(plan.file);
      bool is_same = npy.numbers.size() == static_cast<std::size_t>(6 * rows);
      for (std::size_t k = 0; is_same && k < npy.numbers.size(); ++k) {
        const auto row = static_cast<Eigen::Index>(k / 3) % rows;
        is_same = npy.numbers[k] == frames[k / (3 * rows)](row, static_cast<Eigen::Index>(k % 3));
      }
      CHECK(is_same);
      continue;
    }
    const std::string bytes = read_file(plan.file).value();
    const std::size_t head = bytes.size() - static_cast<std::size_t>(2 * 3 * 4 * rows);
    CHECK(head == (is_mdd ? 8u + 2 * 4 : 32u));
    bool is_same = true;
    for (std::size_t k = 0; k < static_cast<std::size_t>(6 * rows); ++k) {
      std::uint32_t bits = 0;
      for (std::size_t n = 0; n < 4; ++n) {
        bits |= std::uint32_t{static_cast<unsigned char>(bytes[head + 4 * k + n])}
                << 8 * (is_mdd ? 3 - n : n);
      }
      const auto row = static_cast<Eigen::Index>(k / 3) % rows;
      const double number = frames[k / (3 * rows)](row, static_cast<Eigen::Index>(k % 3));
      is_same = is_same && std::bit_cast<float>(bits) == static_cast<float>(number);
    }
    CHECK(is_same);
  }
}

TEST_CASE("a coordinate beyond float in a later block is named", "[output][row_order]") {
  const ScratchFolder folder;
  Field positions = large_mesh().positions;
  positions(rows_at_a_time + 6, 1) = -1e39;
  positions(rows_at_a_time + 7, 0) = 1e300;
  auto writer = make_pc2_writer({folder.file("a.pc2"), &large_mesh(), 1, 1}).value();
  const auto written = writer->write(1, {positions});
  REQUIRE_FALSE(written);
  CHECK(written.error().code == ErrorCode::NotFinite);
  CHECK_THAT(written.error().message,
             Catch::Matchers::StartsWith("vertex 8198 at frame 1 has the coordinate -1e+39"));
}
