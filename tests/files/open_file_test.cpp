#include "pliant/files/open_file.hpp"

#include <atomic>
#include <filesystem>
#include <string>
#include <thread>

#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>

#include "pliant/files/read_file.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

namespace fs = std::filesystem;

/// root/ with a file and a folder, beside secret/ with files of the same names.
struct Folders {
  Folders() {
    for (const fs::path& folder : {root, secret}) {
      fs::create_directories(folder / "sub");
      write(folder / "f", folder.filename());
      write(folder / "sub/f", folder.filename());
    }
  }
  static void write(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

  /// The bytes of a file below the root, or what is said instead.
  std::string bytes(const fs::path& file) const {
    const auto opened = OpenFile::open(file, root);
    return opened ? read_file(*opened).value() : opened.error().message;
  }

  ScratchFolder scratch;
  fs::path base = fs::canonical(scratch.path());
  fs::path root = base / "root";
  fs::path secret = base / "secret";
  std::string outside = "it is outside " + root.string() + ", the folder of --root";
};

/// Something that another program does all the time.
class Meanwhile {
 public:
  template <class Act>
  explicit Meanwhile(Act act)
      : thread_([this, act] {
          while (!is_over_) act();
        }) {}
  ~Meanwhile() {
    is_over_ = true;
    thread_.join();
  }

 private:
  std::atomic<bool> is_over_ = false;
  std::thread thread_;
};

void exchange(const fs::path& one, const fs::path& other) {
  renameat2(AT_FDCWD, one.c_str(), AT_FDCWD, other.c_str(), RENAME_EXCHANGE);
}

}  // namespace

TEST_CASE("a file is opened where its name leads in the root", "[core][open_file]") {
  const Folders at;
  fs::create_symlink("f", at.root / "near");
  fs::create_symlink(at.root / "sub", at.root / "absolute");
  fs::create_symlink(at.root, at.base / "alias");
  fs::create_symlink("../secret/../root/sub", at.root / "round");
  for (const std::string name :
       {"f", "./f", "sub/f", "sub/../f", "near", "absolute/f", "absolute/../f", "round/f",
        "../root/f", "../secret/../root/f", "../none/../root/f", "../alias/f", "sub//./f"}) {
    CAPTURE(name);
    CHECK(at.bytes(at.root / name) == "root");
  }
  const auto real = [&](const std::string& name) { return find_below(at.root / name, at.root); };
  CHECK(real("near").value() == at.root / "f");
  CHECK(real("absolute/../none/x").value() == at.root / "none/x");
  CHECK(OpenFile::open(at.root / "f").value().identity() ==
        OpenFile::open(at.root / "near", at.root).value().identity());
  CHECK(OpenFile::open(at.root / "f").value().identity() !=
        OpenFile::open(at.root / "sub/f").value().identity());
  CHECK(OpenFile::open("/proc/self/exe", "/"));
  CHECK(OpenFile::open(at.root / "f", at.base / "alias"));
}

TEST_CASE("a file outside the root is refused in the same words whether it exists",
          "[core][open_file]") {
  const Folders at;
  fs::create_symlink("../secret/f", at.root / "link");
  fs::create_symlink("../secret/none", at.root / "dangling");
  fs::create_symlink(at.secret, at.root / "door");
  fs::create_symlink(at.base / "none", at.root / "no-door");
  fs::create_symlink("loop", at.secret / "loop");
  fs::create_directory(at.base / "rooted");
  Folders::write(at.base / "rooted/f", "secret");
  for (const std::string name : {"../secret/f",
                                 "../secret/none",
                                 "../secret/f/x",
                                 "../secret/loop",
                                 "../secret",
                                 "../none",
                                 "..",
                                 "link",
                                 "dangling",
                                 "door/f",
                                 "door/none",
                                 "door/sub/../f",
                                 "door",
                                 "no-door",
                                 "no-door/f",
                                 "sub/../../secret/f",
                                 "none/../../secret/f",
                                 "none/../../none/f",
                                 "../rooted/f",
                                 "../root/../secret/f",
                                 "door/../root/../secret/f"}) {
    CAPTURE(name);
    CHECK(at.bytes(at.root / name) == at.outside);
    CHECK(find_below(at.root / name, at.root).error().code == ErrorCode::InvalidInput);
    CHECK(find_below(at.root / name, {}).value() == at.root / name);
  }
  CHECK(at.bytes("/etc/passwd") == at.outside);
  CHECK(at.bytes("/proc/self/fd/0") == at.outside);
  CHECK_THAT(at.bytes(at.root / std::string(10000, 'x')), contains_text("File name too long"));
  CHECK(at.bytes(at.root / "none") == "cannot read the file: No such file or directory");
  // Where the path comes back, what it passes is not told either.
  CHECK(at.bytes(at.root / "../secret/../root/f") == at.bytes(at.root / "../none/../root/f"));
}

TEST_CASE("only a regular file is opened, and nothing waits", "[core][open_file]") {
  const Folders at;
  REQUIRE(mkfifo((at.root / "pipe").c_str(), 0600) == 0);
  fs::create_symlink("loop", at.root / "loop");
  for (const fs::path& root : {fs::path(), at.root}) {
    const auto why = [&](const fs::path& file) {
      return OpenFile::open(file, root).error().message;
    };
    CHECK(why(at.root / "pipe") == "cannot read the file: it is not a regular file");
    CHECK(why(at.root / "sub") == "cannot read the file: it is a folder");
    CHECK(why(at.root / "none") == "cannot read the file: No such file or directory");
    CHECK(why(at.root / "f/x") == "cannot read the file: Not a directory");
    CHECK(why(at.root / "f/") == "cannot read the file: Not a directory");
    CHECK(why(at.root / "none/../f") == "cannot read the file: No such file or directory");
    CHECK(why(at.root / "loop") == "cannot read the file: Too many levels of symbolic links");
  }
  CHECK(OpenFile::open("/dev/null").error().message ==
        "cannot read the file: it is not a regular file");
  // A root that is not there.
  CHECK(OpenFile::open(at.root / "none/f", at.root / "none").error().message ==
        "cannot read the file: No such file or directory");
  CHECK_THAT(OpenFile::open(at.root / "f", at.root / "none").error().message,
             contains_text("it is outside"));
}

TEST_CASE("an open file stays what it was, whatever its name leads to", "[core][open_file]") {
  const Folders at;
  const auto opened = OpenFile::open(at.root / "f", at.root).value();
  const std::string stamp = opened.stamp();
  fs::remove(at.root / "f");
  fs::create_symlink(at.secret / "f", at.root / "f");
  CHECK(read_file(opened).value() == "root");
  CHECK(read_file(opened).value() == "root");  // from its beginning again
  CHECK(opened.size() == 4);
  CHECK(opened.stamp() == stamp);
  CHECK(read_file(opened, 3).error().code == ErrorCode::Unreadable);
  CHECK(read_file(opened, 4, [] { return true; }).error().code == ErrorCode::Interrupted);
}

TEST_CASE("nothing that is renamed meanwhile leads out of the root", "[core][open_file][threads]") {
  const Folders at;
  const auto is_kept_out = [&](const fs::path& file) {
    bool was_read = false;
    for (int round = 0; round < 3000; ++round) {
      const auto opened = OpenFile::open(file, at.root);
      if (!opened) continue;
      const std::string bytes = read_file(*opened).value();
      was_read = true;
      if (bytes != "root") return false;
    }
    return was_read;
  };
  SECTION("a file and a link") {
    fs::create_symlink(at.secret / "f", at.root / "link");
    const Meanwhile swaps([&] { exchange(at.root / "f", at.root / "link"); });
    CHECK(is_kept_out(at.root / "f"));
  }
  SECTION("a folder and a link") {
    fs::create_symlink(at.secret, at.root / "link");
    const Meanwhile swaps([&] { exchange(at.root / "sub", at.root / "link"); });
    CHECK(is_kept_out(at.root / "sub/f"));
  }
  SECTION("a folder that goes out and comes back") {
    fs::create_directory(at.root / "sub/deep");
    const Meanwhile swaps([&] { exchange(at.root / "sub/deep", at.secret / "sub"); });
    CHECK(is_kept_out(at.root / "sub/deep/../f"));
  }
  SECTION("a folder that comes into being") {
    fs::create_symlink(at.secret / "sub", at.base / "no");
    const Meanwhile swaps([&] {
      fs::rename(at.base / "no", at.root / "no");
      fs::rename(at.root / "no", at.base / "no");
    });
    const auto never = [&] {
      for (int round = 0; round < 3000; ++round)
        if (OpenFile::open(at.root / "no/../f", at.root)) return false;
      return true;
    };
    CHECK(never());
  }
}
