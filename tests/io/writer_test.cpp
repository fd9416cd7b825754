#include "pliant/io/writer.hpp"

#include <cctype>

#include "pliant/mesh/grid_sheet.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

TEST_CASE("every known ending has a writer, and no other", "[io][writer]") {
  const ScratchFolder folder;
  const Mesh mesh = make_mesh({});
  for (const std::string& ending : known_endings()) {
    CHECK(make_writer({folder.file("a" + ending), &mesh, 1, 1}));
    std::string upper = ending;
    for (char& c : upper) c = static_cast<char>(std::toupper(c));
    CHECK(make_writer({folder.file("a" + upper), &mesh, 1, 1}));
  }
  for (const char* name : {"a", "a.xyz", ".npy"}) {
    const auto writer = make_writer({folder.file(name), &mesh, 1, 1});
    REQUIRE_FALSE(writer);
    CHECK(writer.error().code == ErrorCode::InvalidInput);
    CHECK_THAT(writer.error().message, Contains("allowed: .npy, .obj, .ply"));
  }
}
