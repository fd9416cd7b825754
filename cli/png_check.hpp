#pragma once

#include <cstddef>
#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant::cli {

/// Of a picture. [px]
struct PictureSize {
  int width = 0;
  int height = 0;
};

/// Whether this is a whole PNG file of that size, as a browser's canvas gives one (8 bits, RGB or
/// RGBA, not interlaced), and nothing else: signature, order of chunks, checksums, all rows of the
/// picture, no byte behind its end. Errors: InvalidInput. Source: W3C, PNG, second edition.
Result<void> check_png(std::string_view bytes, PictureSize size);

/// No such file is longer [bytes].
std::size_t longest_png(PictureSize size);

}  // namespace pliant::cli
