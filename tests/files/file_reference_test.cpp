#include "pliant/files/file_reference.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <sys/stat.h>

#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::EndsWith;

namespace {

namespace fs = std::filesystem;

constexpr std::size_t plenty = 1000;

// inside/shot/ with meshes, inside/near.bin, outside.bin, and links between them.
struct LinkedFolders {
  LinkedFolders() {
    fs::create_directories(shot);
    for (const fs::path& file : {outside / "outside.bin", inside / "near.bin", shot / "own.bin",
                                 shot / "my numbers.bin", shot / "100%.bin", shot / "a%20b.bin"})
      std::ofstream(file) << file.filename().string();
    fs::create_symlink(outside / "outside.bin", shot / "leaves.bin");
    fs::create_symlink("../near.bin", shot / "stays.bin");
    fs::create_directory_symlink(outside, shot / "door");
    fs::create_symlink("loop.bin", shot / "loop.bin");
    fs::create_symlink("/nowhere/at/all", shot / "dangling.bin");
    mkfifo((shot / "pipe.bin").c_str(), 0600);
  }

  ScratchFolder scratch;
  fs::path outside = fs::canonical(scratch.path());
  fs::path inside = outside / "inside";
  fs::path shot = inside / "shot";
  fs::path mesh = shot / "a.gltf";

  std::string bytes(const std::string& uri, const fs::path& root = {}) const {
    const auto read = read_reference(uri, mesh, root, plenty);
    if (read) return *read;
    CHECK(read.error().code == ErrorCode::InvalidInput);
    return read.error().message;
  }
};

}  // namespace

TEST_CASE("a reference is read in the root and below", "[mesh][file_reference]") {
  const LinkedFolders at;
  CHECK(at.bytes("own.bin") == "own.bin");
  CHECK(at.bytes("./own.bin") == "own.bin");
  CHECK(at.bytes("../shot/own.bin") == "own.bin");
  CHECK(at.bytes("my%20numbers.bin") == "my numbers.bin");
  CHECK(at.bytes("my numbers.bin") == "my numbers.bin");
  CHECK(at.bytes("100%.bin") == "100%.bin");
  CHECK(at.bytes("a%20b.bin") == "a%20b.bin");
  CHECK(at.bytes("own%2Ebin") == "own.bin");
  CHECK(at.bytes("../near.bin", at.inside) == "near.bin");
  CHECK(at.bytes("stays.bin", at.inside) == "near.bin");
  CHECK(at.bytes("leaves.bin", "/") == "outside.bin");
  CHECK(find_reference("none.bin", at.mesh, at.inside).value() == at.shot / "none.bin");
  CHECK(find_reference("stays.bin", at.mesh, at.inside).value() == at.inside / "near.bin");
}

TEST_CASE("a reference that leads out of the root is refused", "[mesh][file_reference]") {
  const LinkedFolders at;
  for (const std::string uri :
       {"../near.bin", "..%2Fnear.bin", "%2e%2e/near.bin", "../../outside.bin", "leaves.bin",
        "stays.bin", "door/outside.bin", "door/none.bin", "../shot2/own.bin", "dangling.bin",
        "none/../../near.bin", "none/../../none.bin"}) {
    CAPTURE(uri);
    CHECK(at.bytes(uri) ==
          fmt::format(
              "the file refers to \"{}\", which is outside {}; --root DIR allows another folder",
              uri, at.shot.string()));
  }
  // A folder whose name begins like the root's is a different one.
  fs::create_directory(at.inside / "shots");
  std::ofstream(at.inside / "shots" / "own.bin") << "another";
  CHECK_THAT(at.bytes("../shots/own.bin"), contains_text("which is outside"));
  CHECK_THAT(at.bytes("/etc/passwd"), contains_text("which is an absolute path"));
  CHECK_THAT(at.bytes("%2Fetc%2Fpasswd"), contains_text("which is an absolute path"));
  CHECK_THAT(at.bytes("//host/a.bin"), contains_text("which is an absolute path"));
  CHECK_THAT(at.bytes((at.shot / "own.bin").string()), contains_text("which is an absolute path"));
  CHECK_THAT(at.bytes("own.bin%00.png"), contains_text("which is not the name of a file"));
  for (const std::string scheme : {"file", "http", "https", "C", "x-y+z.1"}) {
    CHECK_THAT(at.bytes(scheme + ":///etc/passwd"),
               EndsWith(fmt::format("but the scheme \"{}\" is not supported; only files are read",
                                    scheme)));
  }
  CHECK_THAT(at.bytes("own.bin", at.outside / "none"),
             contains_text("but the folder that must contain it cannot be found"));
}

TEST_CASE("a reference is a regular file that can be read", "[mesh][file_reference]") {
  const LinkedFolders at;
  CHECK_THAT(at.bytes("none.bin"),
             EndsWith("none.bin: cannot read the file: No such file or directory"));
  CHECK_THAT(at.bytes("pipe.bin"), EndsWith("it is not a regular file"));
  CHECK_THAT(at.bytes("."), EndsWith("it is a folder"));
  CHECK_THAT(at.bytes(""), EndsWith("it is a folder"));
  CHECK_THAT(at.bytes("loop.bin"), contains_text("loop.bin"));
  CHECK_FALSE(read_reference("own.bin", at.mesh, {}, 3));
  CHECK_FALSE(read_reference(std::string(100000, 'x'), at.mesh, {}, plenty));
}

TEST_CASE("references of a mesh in the current folder are looked for there",
          "[mesh][file_reference]") {
  CHECK(find_reference("a.bin", "a.gltf", {}).value() == fs::current_path() / "a.bin");
  CHECK(find_reference("a.bin", "a.gltf", ".").value() == fs::current_path() / "a.bin");
}
