#include "pliant/output/atomic_file.hpp"

#include <csignal>
#include <string>
#include <vector>

#include <sys/resource.h>
#include <sys/stat.h>

#include "pliant/core/read_file.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

namespace {

// A file a.txt that is written and has no name yet.
AtomicFile begun(const ScratchFolder& folder, std::string_view content) {
  auto file = AtomicFile::create(folder.file("a.txt"));
  REQUIRE(file);
  REQUIRE(file->write(content));
  return *std::move(file);
}

}  // namespace

TEST_CASE("a committed file is whole and nothing else is left", "[output][atomic_file]") {
  const ScratchFolder folder;
  auto file = AtomicFile::create(folder.file("a.bin"));
  REQUIRE(file);
  REQUIRE(file->write("head"));
  const std::vector<double> numbers{1, -0.5};
  REQUIRE(file->write(numbers));
  CHECK_FALSE(std::filesystem::exists(folder.file("a.bin")));
  REQUIRE(file->commit());
  CHECK(read_file(folder.file("a.bin"))->size() == 4 + 16);
  CHECK(folder.entry_count() == 1);
}

TEST_CASE("a file that is not committed leaves what was there", "[output][atomic_file]") {
  const ScratchFolder folder;
  folder.write("a.txt", "old");
  {
    auto file = AtomicFile::create(folder.file("a.txt"));
    REQUIRE(file->write("new"));
  }
  CHECK(read_file(folder.file("a.txt")).value() == "old");
  CHECK(folder.entry_count() == 1);
}

TEST_CASE("two writers of one name do not meet", "[output][atomic_file]") {
  const ScratchFolder folder;
  auto first = begun(folder, "first"), second = begun(folder, "second");
  REQUIRE(second.commit());
  REQUIRE(first.commit());
  CHECK(read_file(folder.file("a.txt")).value() == "first");
  CHECK(folder.entry_count() == 1);
}

TEST_CASE("a file that must be new takes the place of none", "[output][atomic_file]") {
  const ScratchFolder folder;
  auto first = begun(folder, "first"), second = begun(folder, "second");
  CHECK(second.commit_new().value());
  CHECK_FALSE(first.commit_new().value());
  CHECK(read_file(folder.file("a.txt")).value() == "second");
  CHECK(folder.entry_count() == 1);
}

TEST_CASE("a new file has the permissions of any other", "[output][atomic_file]") {
  const ScratchFolder folder;
  REQUIRE(AtomicFile::create(folder.file("a.txt"))->commit());
  struct stat ours = {}, plain = {};
  stat(folder.file("a.txt").c_str(), &ours);
  stat(folder.write("plain", "").c_str(), &plain);
  CHECK(ours.st_mode == plain.st_mode);
}

TEST_CASE("a file keeps the permissions of the one that it replaces", "[output][atomic_file]") {
  const ScratchFolder folder;
  const std::string name = folder.write("a.txt", "old").string();
  for (const mode_t mode : {0600U, 0664U, 0755U}) {
    REQUIRE(chmod(name.c_str(), mode) == 0);
    REQUIRE(write_file(name, "new"));
    struct stat now = {};
    stat(name.c_str(), &now);
    CHECK((now.st_mode & 0777U) == mode);
  }
}

TEST_CASE("what cannot be written is an error that names the file", "[output][atomic_file]") {
  const ScratchFolder folder;
  const auto missing = AtomicFile::create(folder.file("no/such/a.txt"));
  REQUIRE_FALSE(missing);
  CHECK(missing.error().code == ErrorCode::Unwritable);
  CHECK(missing.error().file == folder.file("no/such/a.txt").string());
  CHECK_THAT(missing.error().message, Contains("No such file or directory"));
  CHECK_THAT(AtomicFile::create(folder.path()).error().message, Contains("it is a folder"));
}

TEST_CASE("a full disk is an error and leaves nothing", "[output][atomic_file]") {
  // The limit on a file's size simulates a full disk.
  const ScratchFolder folder;
  auto file = AtomicFile::create(folder.file("a.bin"));
  REQUIRE(file);
  struct Limit {
    Limit() {
      getrlimit(RLIMIT_FSIZE, &before);
      const rlimit small{1 << 16, before.rlim_max};
      setrlimit(RLIMIT_FSIZE, &small);
      handler = std::signal(SIGXFSZ, SIG_IGN);
    }
    ~Limit() {
      setrlimit(RLIMIT_FSIZE, &before);
      std::signal(SIGXFSZ, handler);
    }
    rlimit before = {};
    void (*handler)(int) = nullptr;
  };
  Result<void> written;
  {
    const Limit limit;
    written = file->write(std::string(1 << 20, 'x'));
  }
  REQUIRE_FALSE(written);
  CHECK(written.error().code == ErrorCode::Unwritable);
  { const AtomicFile gone = *std::move(file); }
  CHECK(folder.entry_count() == 0);
}
