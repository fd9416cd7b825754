#include "pliant/files/boxed/mesh_message.hpp"

#include <memory>
#include <random>

#include <fcntl.h>
#include <unistd.h>

#include "files/boxed/boxed_programs.hpp"
#include "files/mesh_files.hpp"
#include "pliant/files/boxed/run_boxed.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

/// The reader's answer for a file of the sheet: two faces of triangles and more.
std::string true_message() {
  const ScratchFolder folder;
  const int input = open(folder.write("a.fbx", fbx_binary(small_sheet(false))).c_str(), O_RDONLY);
  const auto end = run_boxed(reader(), {"fbx", "", "0"}, input,
                             {std::size_t{512} << 20, 60, std::size_t{1} << 20}, {});
  close(input);
  return end.value().answer;
}

/// Parses bytes in a buffer of exactly their size, and reads all that the message refers to: an
/// address sanitizer detects any read beyond the end.
std::optional<double> sum_of_all(const std::string& bytes) {
  const auto exact = std::make_unique<char[]>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), exact.get());
  const auto message = parse_mesh_message({exact.get(), bytes.size()});
  if (!message) return {};
  double sum = static_cast<double>(message->reason.size());
  const auto add = [&](const auto& numbers) {
    for (std::size_t k = 0; k < numbers.size(); ++k) sum += static_cast<double>(numbers[k]);
  };
  add(message->reason);
  for (const ObjectEntry& names : message->objects) {
    add(names.node);
    add(names.mesh);
  }
  if (message->chosen) CHECK(*message->chosen < message->objects.size());
  for (const Submesh& submesh : message->submeshes) {
    add(submesh.material);
    add(submesh.positions);
    add(submesh.normals);
    add(submesh.uvs);
    add(submesh.corners);
    std::size_t corners = 0;
    for (std::size_t face = 0; face < submesh.sizes.size(); ++face) corners += submesh.sizes[face];
    CHECK(corners == submesh.corners.size());
  }
  return sum;
}

}  // namespace

TEST_CASE("the reader's answer has what the file has", "[mesh][mesh_message]") {
  const std::string bytes = true_message();
  const auto message = parse_mesh_message(bytes);
  REQUIRE(message);
  CHECK(message->kind == MessageKind::Scene);
  REQUIRE(message->objects.size() == 1);
  CHECK(message->objects[0].node == "cloth");
  CHECK(message->objects[0].vertices == 16);
  CHECK(message->objects[0].faces == 4);
  CHECK(message->objects[0].left_out == 0);
  CHECK(message->chosen == 0u);
  REQUIRE(message->submeshes.size() == 1);
  CHECK(message->submeshes[0].sizes.size() == 4);
  CHECK(message->submeshes[0].corners.size() == 16);
  CHECK(message->submeshes[0].positions.size() == 3 * 16);
  CHECK(message->submeshes[0].uvs.size() == 2 * 16);
  CHECK(message->submeshes[0].uv_sets == 1);
}

TEST_CASE("an answer that is cut short or goes on is none", "[mesh][mesh_message]") {
  const std::string whole = true_message();
  for (std::size_t length = 0; length < whole.size(); ++length)
    CHECK_FALSE(sum_of_all(whole.substr(0, length)));
  CHECK_FALSE(sum_of_all(whole + '\0'));
  CHECK(sum_of_all(whole));
}

TEST_CASE("no answer reads past its end", "[mesh][mesh_message]") {
  const std::string whole = true_message();
  std::mt19937 random(1);
  int parsed = 0;
  const auto check = [&](const std::string& mutant) { parsed += sum_of_all(mutant).has_value(); };
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const int value : {0x00, 0x01, 0x7f, 0x80, 0xff}) {
      std::string mutant = whole;
      mutant[at] = static_cast<char>(value);
      check(mutant);
    }
  }
  for (int trial = 0; trial < 20000; ++trial) {  // counts matter most: near the beginning
    std::string mutant = whole;
    for (int k = 0; k < 3; ++k) mutant[random() % 220] = static_cast<char>(random());
    check(mutant);
  }
  CHECK(parsed > 1000);  // most bytes are coordinates, which may be any
}

TEST_CASE("numbers that promise more than there is take no memory", "[mesh][mesh_message]") {
  const auto packed = [](auto number) {
    return std::string(reinterpret_cast<const char*>(&number), sizeof number);
  };
  const std::string begin = packed(message_begin) + packed(std::uint32_t{0});
  CHECK_FALSE(sum_of_all(begin + packed(std::uint32_t{0xffff'ffff}) + std::string(100, '\0')));
  CHECK_FALSE(sum_of_all(begin + packed(std::uint32_t{1'000'000}) + std::string(100, '\0')));
  CHECK_FALSE(sum_of_all(packed(message_begin) + packed(std::uint32_t{9}) + packed(message_end)));
}
