#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pliant::testing {

/// Writes PNGs without libpng: the pixels are not compressed.
class PngMaker {
 public:
  int width = 1, height = 1;
  int bits = 8;             ///< of a channel, 8 or 16
  int colours = 0;          ///< the format's colour type: 0, 2, 4 or 6
  int interlace = 0;        ///< 1: says that it is interlaced
  std::vector<int> values;  ///< of all channels, row by row from the top

  std::string bytes() const {
    std::string head = big(width) + big(height);
    head +=
        {static_cast<char>(bits), static_cast<char>(colours), 0, 0, static_cast<char>(interlace)};
    return "\x89PNG\r\n\x1a\n" + chunk("IHDR", head) + more + chunk("IDAT", stream()) +
           chunk("IEND", "");
  }

  std::string more = {};  ///< chunks before the pixels

  static std::string chunk(const std::string& name, const std::string& data) {
    return big(static_cast<std::uint32_t>(data.size())) + name + data + big(crc(name + data));
  }

  static std::string big(std::uint32_t number) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8)
      bytes += static_cast<char>(number >> shift & 0xffu);
    return bytes;
  }

 private:
  int channels() const { return colours == 2 ? 3 : colours == 4 ? 2 : colours == 6 ? 4 : 1; }

  // Rows without a filter, in blocks of zlib that are only stored.
  std::string stream() const {
    std::string rows;
    std::size_t next = 0;
    for (int y = 0; y < height; ++y) {
      rows += '\0';
      for (int k = 0; k < width * channels() && next < values.size(); ++k, ++next) {
        if (bits == 16) rows += static_cast<char>(values[next] >> 8);
        rows += static_cast<char>(values[next] & 0xff);
      }
    }
    std::string stream = "\x78\x01";
    for (std::size_t at = 0; at < rows.size(); at += 65535) {
      const std::string block = rows.substr(at, 65535);
      const auto size = static_cast<unsigned>(block.size());
      stream += static_cast<char>(at + 65535 >= rows.size());
      for (const unsigned number : {size, ~size & 0xffffu}) {
        stream += static_cast<char>(number & 0xff);
        stream += static_cast<char>(number >> 8);
      }
      stream += block;
    }
    return stream + big(adler(rows));
  }

  static std::uint32_t crc(std::string_view bytes) {
    std::uint32_t sum = 0xffffffff;
    for (const char byte : bytes) {
      sum ^= static_cast<unsigned char>(byte);
      for (int k = 0; k < 8; ++k) sum = sum & 1 ? 0xedb88320 ^ sum >> 1 : sum >> 1;
    }
    return ~sum;
  }

  static std::uint32_t adler(std::string_view bytes) {
    std::uint32_t a = 1, b = 0;
    for (const char byte : bytes) {
      a = (a + static_cast<unsigned char>(byte)) % 65521;
      b = (b + a) % 65521;
    }
    return b << 16 | a;
  }
};

/// A grey PNG of 8 bits.
inline std::string grey_png(int width, int height, std::vector<int> values) {
  PngMaker png;
  png.width = width;
  png.height = height;
  png.values = std::move(values);
  return png.bytes();
}

}  // namespace pliant::testing
