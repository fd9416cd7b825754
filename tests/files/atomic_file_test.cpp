#include "pliant/files/atomic_file.hpp"

#include <csignal>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include "pliant/files/read_file.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;

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

TEST_CASE("a file keeps the owner and group of the one that it replaces", "[output][atomic_file]") {
  if (geteuid() != 0) return;  // others have one user and one group
  const ScratchFolder folder;
  const std::string name = folder.write("a.txt", "old").string();
  REQUIRE(chown(name.c_str(), 1234, 2345) == 0);
  REQUIRE(chmod(name.c_str(), 04640) == 0);
  for (const bool is_rewritten : {false, true}) {
    REQUIRE((is_rewritten ? rewrite_file(name, "new", "newer") : write_file(name, "new")));
    struct stat now = {};
    REQUIRE(stat(name.c_str(), &now) == 0);
    CHECK(now.st_uid == 1234);
    CHECK(now.st_gid == 2345);
    CHECK((now.st_mode & 07777U) == 0640);  // never with the rights of its owner
  }
}

TEST_CASE("a file keeps what is attached to the one that it replaces", "[output][atomic_file]") {
  const ScratchFolder folder;
  const std::string name = folder.write("a.txt", "old").string();
  if (setxattr(name.c_str(), "user.note", "mine", 4, 0) != 0) return;  // no file system for this
  REQUIRE(rewrite_file(name, "old", "new"));
  char note[8] = {};
  CHECK(getxattr(name.c_str(), "user.note", note, sizeof note) == 4);
  CHECK(std::string(note) == "mine");
}

TEST_CASE("nobody else can open a file before it has its permissions", "[output][atomic_file]") {
  const ScratchFolder folder;
  const std::string name = folder.write("a.txt", "old").string();
  REQUIRE(chmod(name.c_str(), 0600) == 0);
  const auto file = begun(folder, "secret");
  for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
    struct stat now = {};
    REQUIRE(stat(entry.path().c_str(), &now) == 0);
    CHECK((now.st_mode & 0777U) == 0600);
  }
}

TEST_CASE("a rewrite takes the place of the bytes that it was made of", "[output][atomic_file]") {
  const ScratchFolder folder;
  const auto file = folder.write("a.txt", "old");
  CHECK(rewrite_file(file, "old", "new"));
  CHECK(read_file(file).value() == "new");
  for (const std::string_view old : {"", "ne", "new!", "old"}) {
    const auto refused = rewrite_file(file, old, "newer");
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == ErrorCode::Unwritable);
    CHECK(refused.error().file == file.string());
    CHECK_THAT(refused.error().message, EndsWith("it has changed since it was read"));
  }
  CHECK(read_file(file).value() == "new");
  std::filesystem::remove(file);
  CHECK(rewrite_file(file, "new", "again"));
  CHECK(read_file(file).value() == "again");
  folder.write("a.txt", "");
  CHECK(rewrite_file(file, "", "full"));
  CHECK(folder.entry_count() == 1);
}

TEST_CASE("what is saved during a rewrite is never lost", "[output][atomic_file][threads]") {
  const ScratchFolder folder;
  const auto file = folder.write("a.txt", "");
  for (int round = 0; round < 300; ++round) {
    folder.write("a.txt", "old");
    std::thread editor([&] {
      folder.write("saved", "saved");
      std::filesystem::rename(folder.file("saved"), file);
    });
    (void)rewrite_file(file, "old", "rewritten");
    editor.join();
    REQUIRE(read_file(file).value() == "saved");
  }
  CHECK(folder.entry_count() == 1);
}

TEST_CASE("several files get their names together, or none does", "[output][atomic_file]") {
  const ScratchFolder folder;
  folder.write("a.txt", "old");
  const auto begin = [&](std::vector<std::string> names) {
    std::vector<AtomicFile> files;
    for (const std::string& name : names) {
      files.push_back(AtomicFile::create(folder.file(name)).value());
      REQUIRE(files.back().write("new " + name));
    }
    return files;
  };
  const auto content = [&](const char* name) { return read_file(folder.file(name)).value(); };
  std::vector<AtomicFile> files = begin({"a.txt", "b.txt", "c.txt"});
  CHECK(folder.entry_count() == 4);
  // In the moment before, a name becomes that of a folder.
  std::filesystem::create_directory(folder.file("c.txt"));
  const auto refused = commit_all(std::move(files));
  REQUIRE_FALSE(refused);
  CHECK(refused.error().file == folder.file("c.txt").string());
  CHECK_THAT(refused.error().message, Contains("it is a folder"));
  CHECK(content("a.txt") == "old");
  CHECK_FALSE(std::filesystem::exists(folder.file("b.txt")));
  CHECK(folder.entry_count() == 2);
  std::filesystem::remove(folder.file("c.txt"));
  REQUIRE(commit_all(begin({"a.txt", "b.txt", "c.txt"})));
  for (const char* name : {"a.txt", "b.txt", "c.txt"})
    CHECK(content(name) == std::string("new ") + name);
  CHECK(folder.entry_count() == 3);
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

TEST_CASE("writing ends when asked, and the old file stays", "[output][atomic_file]") {
  const ScratchFolder folder;
  const std::string name = folder.write("a.txt", "old").string();
  const std::string bytes(20'000'000, 'x');
  int asked = 0;
  REQUIRE(write_file(name, bytes, [&] { return ++asked < 0; }));
  CHECK(asked > 4);
  REQUIRE(write_file(name, "old"));
  for (int moment = 1; moment <= asked; ++moment) {
    int left = moment;
    const auto written = write_file(name, bytes, [&] { return --left <= 0; });
    REQUIRE_FALSE(written);
    CHECK(written.error().code == ErrorCode::Interrupted);
    CHECK(left == 0);
    CHECK(std::filesystem::file_size(name) == 3);
  }
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
