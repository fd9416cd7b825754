#include "viewer/png_check.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <zlib.h>

#include "pliant/core/byte_order.hpp"

namespace pliant::viewer {
namespace {

constexpr std::string_view signature("\x89PNG\r\n\x1a\n", 8);

std::uint32_t number_at(std::string_view bytes, std::size_t place) {
  return number_from<std::uint32_t>(bytes.data() + place, std::endian::big);
}

const Bytef* zlib_bytes(std::string_view bytes) {
  return reinterpret_cast<const Bytef*>(bytes.data());
}

struct Chunk {
  std::string_view type;
  std::string_view content;
};

constexpr std::size_t checked_bytes = std::size_t{1} << 20U;  // between two asks

// The checksum of the bytes, or null: stopped.
std::optional<std::uint32_t> checksum(std::string_view bytes, const StopRequest& should_stop) {
  auto sum = crc32_z(0, nullptr, 0);
  for (; !bytes.empty(); bytes.remove_prefix(std::min(bytes.size(), checked_bytes))) {
    if (is_stopped(should_stop)) return {};
    sum = crc32_z(sum, zlib_bytes(bytes), std::min(bytes.size(), checked_bytes));
  }
  return static_cast<std::uint32_t>(sum);
}

// The chunks of a file; IEND must be the last.
Result<std::vector<Chunk>> chunks_of(std::string_view bytes, const StopRequest& should_stop) {
  if (!bytes.starts_with(signature)) return invalid("it is not a PNG");
  constexpr std::size_t frame = 12;  // length, type and checksum
  std::vector<Chunk> chunks;
  for (bytes.remove_prefix(signature.size()); !bytes.empty();) {
    if (bytes.size() < frame) return invalid("it is truncated");
    const std::size_t length = number_at(bytes, 0);
    if (length > bytes.size() - frame) return invalid("it is truncated");
    const std::string_view sealed = bytes.substr(4, 4 + length);
    const auto sum = checksum(sealed, should_stop);
    if (!sum) return interrupted();
    if (*sum != number_at(bytes, 8 + length)) return invalid("a chunk has a wrong checksum");
    chunks.push_back({sealed.substr(0, 4), sealed.substr(4)});
    bytes.remove_prefix(frame + length);
    if (chunks.back().type != "IEND") continue;
    if (length > 0 || !bytes.empty()) return invalid("there is data after its end");
    return chunks;
  }
  return invalid("it is truncated");
}

// Bytes of a row, including its filter byte.
Result<std::size_t> row_bytes(const Chunk& first, PictureSize size) {
  if (first.type != "IHDR" || first.content.size() != 13) return invalid("it has no header");
  const std::uint32_t width = number_at(first.content, 0), height = number_at(first.content, 4);
  if (width != static_cast<std::uint32_t>(size.width) ||
      height != static_cast<std::uint32_t>(size.height)) {
    return invalid(
        fmt::format("it has {} x {} pixels, not {} x {}", width, height, size.width, size.height));
  }
  const std::string_view form = first.content.substr(8);
  constexpr std::string_view rgb("\x08\x02\0\0\0", 5), rgba("\x08\x06\0\0\0", 5);
  if (form != rgb && form != rgba) return invalid("its pixels are not 8-bit RGB or RGBA");
  return 1 + static_cast<std::size_t>(width) * (form == rgb ? 3 : 4);
}

// Unpacks rows to check their number and filters, without storing them.
class Rows {
 public:
  Rows(std::size_t bytes, std::size_t count, const StopRequest& should_stop)
      : row_bytes_(bytes), left_(bytes * count), poll_(should_stop) {}

  Result<void> take(std::string_view packed) {
    if (!is_open_) return invalid("its rows cannot be decompressed");
    stream_.next_in = const_cast<Bytef*>(zlib_bytes(packed));
    stream_.avail_in = static_cast<uInt>(packed.size());
    while (!has_ended_) {
      stream_.next_out = piece_.data();
      stream_.avail_out = static_cast<uInt>(piece_.size());
      const int state = inflate(&stream_, Z_NO_FLUSH);
      if (state == Z_BUF_ERROR) return {};  // all input so far is consumed
      if (state != Z_OK && state != Z_STREAM_END) return invalid("its rows cannot be decompressed");
      const std::size_t count = piece_.size() - stream_.avail_out;
      if (auto seen = look_at(count); !seen) return seen;
      if (poll_.after(count)) return interrupted();
      has_ended_ = state == Z_STREAM_END;
    }
    return stream_.avail_in == 0 ? Result<void>() : invalid("there is data after its rows");
  }

  bool is_whole() const { return has_ended_ && left_ == 0; }

 private:
  struct End {
    void operator()(z_stream* stream) const { inflateEnd(stream); }
  };

  Result<void> look_at(std::size_t count) {
    if (count > left_) return invalid("it has too many rows");
    const std::size_t begin = place_;
    place_ += count;
    left_ -= count;
    constexpr int most_filter = 4;
    for (std::size_t row = (begin + row_bytes_ - 1) / row_bytes_ * row_bytes_; row < place_;
         row += row_bytes_) {
      if (piece_[row - begin] > most_filter) return invalid("a row has an unknown filter");
    }
    return {};
  }

  std::size_t row_bytes_;
  std::size_t left_;
  std::size_t place_ = 0;
  StopPoll poll_;
  bool has_ended_ = false;
  std::array<Bytef, 65'536> piece_;
  z_stream stream_ = {};
  bool is_open_ = inflateInit(&stream_) == Z_OK;
  std::unique_ptr<z_stream, End> end_{&stream_};
};

}  // namespace

Result<void> check_png(std::string_view bytes, PictureSize size, const StopRequest& should_stop) {
  const auto chunks = chunks_of(bytes, should_stop);
  if (!chunks) return fail(chunks.error());
  const auto width = row_bytes(chunks->front(), size);
  if (!width) return fail(width.error());
  Rows rows(*width, static_cast<std::size_t>(size.height), should_stop);
  std::string_view before = "IHDR";
  bool has_rows = false;
  for (std::size_t k = 1; k + 1 < chunks->size(); ++k) {
    const Chunk& chunk = (*chunks)[k];
    if (chunk.type == "IDAT") {
      if (has_rows && before != "IDAT") return invalid("its IDAT chunks are not consecutive");
      has_rows = true;
      if (auto taken = rows.take(chunk.content); !taken) return taken;
    } else if ((chunk.type.front() & 0x20) == 0) {  // upper case: a critical chunk
      return invalid(fmt::format("it has the unexpected chunk {}", printable(chunk.type)));
    }
    before = chunk.type;
  }
  return rows.is_whole() ? Result<void>() : invalid("rows are missing");
}

std::size_t longest_png(PictureSize size) {
  // Uncompressed rows, the overhead of deflate and chunks for incompressible data, and some
  // metadata.
  const std::size_t rows =
      (1 + 4 * static_cast<std::size_t>(size.width)) * static_cast<std::size_t>(size.height);
  return rows + rows / 64 + 65'536;
}

}  // namespace pliant::viewer
