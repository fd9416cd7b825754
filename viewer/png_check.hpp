#pragma once

#include <cstddef>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant::viewer {

/// The size of a picture. [px]
struct PictureSize {
  int width = 0;
  int height = 0;
};

/// Checks that this is exactly one complete PNG file of that size, as a browser's canvas makes it
/// (8 bits, RGB or RGBA, not interlaced): signature, order of chunks, checksums, all rows of the
/// picture, no bytes after its end. Errors: InvalidInput; Interrupted. Source: W3C, PNG, second
/// edition.
Result<void> check_png(std::string_view bytes, PictureSize size,
                       const StopRequest& should_stop = {});

/// An upper bound for the size of such a file [bytes].
std::size_t longest_png(PictureSize size);

}  // namespace pliant::viewer
