#include "pliant/files/output_place.hpp"

#include <string>

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include "pliant/files/atomic_file.hpp"
#include "pliant/files/read_file.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

namespace {

void check_refused(const std::filesystem::path& file, const char* words) {
  CAPTURE(file.string());
  const auto place = check_output_place(file);
  REQUIRE_FALSE(place);
  CHECK(place.error().code == ErrorCode::InvalidInput);
  CHECK(place.error().file == file.string());
  CHECK_THAT(place.error().message, Contains(words));
  const auto created = AtomicFile::create(file);  // nothing passes the check
  REQUIRE_FALSE(created);
  CHECK(created.error().message == place.error().message);
}

}  // namespace

TEST_CASE("what is no regular file is not replaced", "[output][output_place]") {
  const ScratchFolder folder;
  folder.write("plain", "");
  std::filesystem::create_symlink(folder.file("plain"), folder.file("link"));
  std::filesystem::create_symlink(folder.file("none"), folder.file("dangling"));
  REQUIRE(mkfifo(folder.file("pipe").c_str(), 0600) == 0);
  const int descriptor = socket(AF_UNIX, SOCK_STREAM, 0);
  sockaddr_un address = {};
  address.sun_family = AF_UNIX;
  folder.file("socket").string().copy(address.sun_path, sizeof(address.sun_path) - 1);
  REQUIRE(bind(descriptor, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0);
  close(descriptor);
  check_refused(folder.file("link"), "symbolic link");
  check_refused(folder.file("dangling"), "symbolic link");
  check_refused(folder.file("pipe"), "it is a pipe");
  check_refused(folder.file("socket"), "it is a socket");
  check_refused(folder.path(), "it is a folder");
  check_refused(folder.path() / "", "it is a folder");
  check_refused(folder.path() / "..", "it is a folder");
  check_refused("/dev/null", "it is a device");
  check_refused("/dev/stdout", "symbolic link");
  check_refused("", "the name is empty");
  CHECK(check_output_place(folder.file("plain")));
  CHECK(check_output_place(folder.file("new")));
  CHECK(folder.entry_count() == 5);
}

TEST_CASE("a file that may not be written is not replaced", "[output][output_place]") {
  const ScratchFolder folder;
  const auto file = folder.write("published", "as it was");
  REQUIRE(chmod(file.c_str(), 0444) == 0);
  REQUIRE(chmod(folder.path().c_str(), 0777) == 0);
  // Root may write any file.
  const uid_t user = geteuid();
  if (user == 0) REQUIRE(seteuid(65534) == 0);
  check_refused(file, "it may not be written");
  if (user == 0) REQUIRE(seteuid(user) == 0);
  CHECK(read_file(file).value() == "as it was");
}

TEST_CASE("names go as far as the folder allows", "[output][output_place]") {
  const ScratchFolder folder;
  for (const char* letter : {"n", "\xc3\xbc", "\xf0\x9f\x8c\x8a"}) {
    std::string name(3, '.');  // so that no character ends at the cut
    while (name.size() + std::string_view(letter).size() <= 255) name += letter;
    name.resize(255, 'e');
    auto file = AtomicFile::create(folder.file(name));
    REQUIRE(file);
    REQUIRE(file->write("whole"));
    REQUIRE(file->commit());
    CHECK(read_file(folder.file(name)).value() == "whole");
    check_refused(folder.file(name + "x"), "its name has 256 bytes; the folder allows 255");
  }
  CHECK(folder.entry_count() == 3);
}

TEST_CASE("paths go as far as the system allows", "[output][output_place]") {
  const ScratchFolder folder;
  std::filesystem::path deep = folder.path();
  while (deep.string().size() + 201 < 4090) deep /= std::string(200, 'd');
  std::filesystem::create_directories(deep);
  // With its terminating zero the path has exactly the 4096 bytes that the system allows.
  const auto file = deep / std::string(4095 - deep.string().size() - 1, 'f');
  REQUIRE(file.string().size() == 4095);
  auto created = AtomicFile::create(file);
  REQUIRE(created);
  REQUIRE(created->commit());
  CHECK(std::filesystem::exists(file));
  check_refused(file.string() + "f", "its path has 4096 bytes; the system allows 4095");
}

TEST_CASE("names that begin alike do not meet while they are written", "[output][output_place]") {
  const std::string start(200, 'a');
  CHECK(hidden_name("x/" + start + "1") != hidden_name("x/" + start + "2"));
  CHECK(hidden_name("x/" + start + "1").size() < 80);
  CHECK(hidden_name("x/short.npy") == ".short.npy");
}
