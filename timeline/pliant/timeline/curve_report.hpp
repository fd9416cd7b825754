#pragma once

#include <cstddef>
#include <string>

namespace pliant {

/// Why keys make no curve.
struct CurveError {
  std::size_t key = 0;  ///< index of the key at fault
  std::string message;  ///< one line: the thing, the value, the rule
};

/// Something the rules changed or left without effect; legal, but an author would want to know.
struct CurveNote {
  std::size_t key = 0;  ///< index of the key
  std::string message;  ///< one line; for a shortened tangent with its old and new length [frames]
};

}  // namespace pliant
