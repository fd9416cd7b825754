#pragma once

#include <cstddef>

#include "pliant/core/result.hpp"
#include "pliant/plate/vibration.hpp"

namespace pliant {

/// A patch of a body as a plate of its own, for those who ask for its vibrations. Internal.
class PatchPlate {
 public:
  PatchPlate() = default;
  PatchPlate(const PatchPlate&) = delete;
  PatchPlate& operator=(const PatchPlate&) = delete;
  virtual ~PatchPlate() = default;

  /// Without a shift, as long as this lives, or until another is asked for. Requires: it is held.
  /// Errors: those of the solver.
  virtual Result<VibratingPlate> vibrating() = 0;

  /// As `pliant::smallest_eigenvalue`.
  virtual Result<double> smallest_eigenvalue() = 0;

  virtual std::size_t memory() const = 0;  ///< [bytes]
};

}  // namespace pliant
