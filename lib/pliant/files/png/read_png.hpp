#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant {

/// The most pixels that a picture may have along a side.
inline constexpr int longest_picture_side = 16384;

/// The first channel of a picture, without the gamma or the colours that its file may tell of.
struct Picture {
  int width = 0;                           ///< >= 1
  int height = 0;                          ///< >= 1
  int white = 255;                         ///< the value that counts as 1: 255 or 65535
  std::vector<std::uint16_t> values = {};  ///< height rows of width values, from the top

  /// The value at (u,v), 0 to 1, v upwards: bilinear between the centres of pixels, constant beyond
  /// the outermost. (u,v) outside of 0 to 1 are held there. Requires: they are finite.
  double at(double u, double v) const;
};

/// The memory that the values of a PNG take, by its first bytes. Errors: as `parse_png`. [bytes]
Result<std::size_t> bytes_of_png(std::string_view bytes);

/// Reads a PNG of 8 or 16 bits a channel, not interlaced, grey or in colours, from its bytes; alpha
/// is ignored. `name` is the file's name in messages. Memory is proportional to the file. Errors,
/// naming the file: no such PNG; a palette; a side longer than `longest_picture_side`; broken or
/// missing data; OutOfMemory; Interrupted.
Result<Picture> parse_png(std::string_view bytes, const std::string& name,
                          const StopRequest& should_stop = {});

}  // namespace pliant
