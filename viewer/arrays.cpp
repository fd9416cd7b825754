#include "viewer/arrays.hpp"

#include <algorithm>
#include <array>

#include <zlib.h>

namespace pliant::viewer {
namespace {

// Number of bytes to pass to zlib between two asks: its counters have fewer bits, and bytes that
// hardly need any place are many.
uInt portion(std::size_t bytes) {
  constexpr std::size_t most = std::size_t{1} << 20U;
  return static_cast<uInt>(std::min(bytes, most));
}

}  // namespace

Result<std::string> deflated(std::string_view bytes, const StopRequest& should_stop) {
  const auto no_memory = [] {
    return fail(ErrorCode::OutOfMemory, "the packed frames of the page do not fit in memory");
  };
  z_stream stream = {};
  constexpr int raw_window = -15;  // no header, no checksum
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, raw_window, 9, Z_DEFAULT_STRATEGY) !=
      Z_OK) {
    return no_memory();
  }
  std::string packed;
  std::array<char, std::size_t{1} << 16> chunk;
  int status = Z_OK;
  bool is_stopped = false;
  while (status == Z_OK && !is_stopped) {
    const uInt given = portion(bytes.size());
    // zlib only reads the input, but its struct is not const.
    stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
    stream.avail_in = given;
    stream.next_out = reinterpret_cast<Bytef*>(chunk.data());
    stream.avail_out = static_cast<uInt>(chunk.size());
    status = deflate(&stream, given == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
    bytes.remove_prefix(given - stream.avail_in);
    packed.append(chunk.data(), chunk.size() - stream.avail_out);
    is_stopped = pliant::is_stopped(should_stop);
  }
  deflateEnd(&stream);
  if (is_stopped) return interrupted();
  if (status != Z_STREAM_END) return no_memory();
  return packed;
}

}  // namespace pliant::viewer
