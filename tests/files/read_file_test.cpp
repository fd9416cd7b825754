#include "pliant/files/read_file.hpp"

#include <string>

#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using pliant::testing::ScratchFolder;

TEST_CASE("a file is read byte for byte", "[core][read_file]") {
  const ScratchFolder folder;
  std::string bytes = "a\r\nb";
  bytes.push_back('\0');
  bytes.append(3u << 20, 'x');
  CHECK(read_file(folder.write("f", bytes)).value() == bytes);
  CHECK(read_file(folder.write("empty", "")).value().empty());
}

TEST_CASE("a file is passed on in pieces, as many as are wanted", "[core][read_file]") {
  const ScratchFolder folder;
  const std::string bytes = std::string(5u << 20, 'x') + "end";
  const auto file = folder.write("f", bytes);
  std::string all;
  CHECK(read_pieces(file, [&](std::string_view piece) {
    all += piece;
    return true;
  }));
  CHECK(all == bytes);
  int pieces = 0;
  CHECK(read_pieces(file, [&](std::string_view) { return ++pieces < 2; }));
  CHECK(pieces == 2);
  const auto missing = read_pieces(folder.file("missing"), [](std::string_view) { return true; });
  REQUIRE_FALSE(missing);
  CHECK(missing.error().message == "cannot read the file: No such file or directory");
}

TEST_CASE("a file that cannot be read says which and why", "[core][read_file]") {
  const ScratchFolder folder;
  const auto missing = read_file(folder.file("missing.xml"));
  REQUIRE_FALSE(missing);
  CHECK(missing.error().code == ErrorCode::Unreadable);
  CHECK(missing.error().file == folder.file("missing.xml").string());
  CHECK(missing.error().message == "cannot read the file: No such file or directory");
  CHECK(read_file(folder.path()).error().message == "cannot read the file: it is a folder");
  CHECK(read_file(folder.write("big", std::string(3u << 20, 'x')), 2u << 20).error().message ==
        "cannot read the file: it is larger than 2 MiB");
}

TEST_CASE("whether a file can be read is known without reading it", "[core][read_file]") {
  const ScratchFolder folder;
  CHECK(check_readable(folder.write("f", "x")));
  for (const auto& path : {folder.path(), folder.file("missing")}) {
    CHECK(check_readable(path).error().message == read_file(path).error().message);
  }
}
