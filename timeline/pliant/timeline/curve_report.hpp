#pragma once

#include <cstddef>
#include <string>

namespace pliant {

/// The reason why keys do not form a curve.
struct CurveError {
  std::size_t key = 0;           ///< index of the wrong key
  std::string message;           ///< one line: the thing, the value, the rule
  bool is_interruption = false;  ///< the work was stopped; no key is wrong
};

/// Something that the rules changed or that has no effect; legal, but worth reporting to the
/// author.
struct CurveNote {
  std::size_t key = 0;  ///< index of the key
  std::string message;  ///< one line; for a shortened tangent with its old and new length [frames]
};

}  // namespace pliant
