#pragma once

#include <cstddef>
#include <string>

namespace pliant {

/// Something that the rules changed or that has no effect; legal, but worth reporting to the
/// author.
struct CurveNote {
  std::size_t key = 0;  ///< index of the key
  std::string message;  ///< one line; for a shortened tangent with its old and new length [frames]
};

}  // namespace pliant
