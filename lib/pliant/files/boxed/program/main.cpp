// The sandboxed program of read_assimp: reads the mesh file that is open as its input through
// assimp, and answers with a MeshMessage. Arguments after those of `enter_box`: ENDING OBJECT
// UV_SET.

#include <cerrno>
#include <cstdlib>
#include <exception>
#include <new>
#include <string>
#include <utility>

#include <sys/stat.h>
#include <unistd.h>

#include "pliant/files/boxed/program/enter_box.hpp"
#include "pliant/files/boxed/program/read_scene.hpp"
#include "pliant/files/boxed/program/write_message.hpp"
#include "pliant/files/boxed/run_boxed.hpp"

namespace {

using namespace pliant;

constexpr int broken = 1;

// Reads from the beginning, even if another process with the same open file has moved its offset.
bool read_all(std::string& bytes) {
  constexpr std::size_t chunk = std::size_t{1} << 20;
  struct stat status {};
  if (fstat(boxed_input, &status) == 0 && status.st_size > 0)
    bytes.reserve(static_cast<std::size_t>(status.st_size) + chunk);
  for (;;) {
    const std::size_t size = bytes.size();
    bytes.resize(size + chunk);
    const ssize_t count = pread(boxed_input, bytes.data() + size, chunk, static_cast<off_t>(size));
    bytes.resize(size + (count > 0 ? static_cast<std::size_t>(count) : 0));
    if (count == 0) return true;
    if (count < 0 && errno != EINTR) return false;
  }
}

}  // namespace

int main(int count, char** arguments) {
  if (count != box_arguments + 3 || !enter_box(count, arguments)) return broken;
  try {
    std::string bytes;
    if (!read_all(bytes)) return broken;
    const int uv_set = std::atoi(arguments[box_arguments + 2]);
    const AssimpScene read = read_scene(std::move(bytes), arguments[box_arguments]);
    const bool is_written = write_message(boxed_answer, read, arguments[box_arguments + 1], uv_set);
    // Exits at once: destroying assimp's objects for a broken file could fail.
    _exit(is_written ? boxed_done : broken);
  } catch (const std::bad_alloc&) {
    _exit(boxed_out_of_memory);
  } catch (const std::exception&) {
    _exit(broken);
  }
}
