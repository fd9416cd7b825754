#include "pliant/files/spool_file.hpp"

#include "pliant/files/read_file.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;

TEST_CASE("spooled bytes come in order behind what is written first", "[output][spool_file]") {
  const ScratchFolder folder;
  auto spool = SpoolFile::create(folder.file("a.bin")).value();
  CHECK(folder.entry_count() == 0);  // it has no name, so nothing can be left behind
  std::string expected = "head";
  for (int k = 0; k < 5000; ++k) {
    const std::string piece(static_cast<std::size_t>(k), static_cast<char>(k));
    REQUIRE(spool.write(piece));
    expected += piece;
  }
  CHECK(spool.size() == expected.size() - 4);
  auto file = AtomicFile::create(folder.file("a.bin")).value();
  REQUIRE(file.write("head"));
  REQUIRE(spool.copy_to(file));
  REQUIRE(file.commit());
  CHECK(read_file(folder.file("a.bin")).value() == expected);
}

TEST_CASE("a spool that has no place is unwritable", "[output][spool_file]") {
  const ScratchFolder folder;
  const auto spool = SpoolFile::create(folder.file("none") / "a.bin");
  REQUIRE_FALSE(spool);
  CHECK(spool.error().code == ErrorCode::Unwritable);
}
