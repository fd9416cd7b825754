#pragma once

#include <pybind11/pybind11.h>

#include "call.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant::python {

/// What a run tells of its progress, `progress(done, total)`; None: nothing. What it raises ends
/// the run and passes to the caller.
class Telling {
 public:
  /// `owner`: the `Asking` of what runs, which the function must not call.
  Telling(const py::object& progress, const void* owner)
      : function_(progress.is_none() ? nullptr : held(progress)), owner_(owner) {}

  /// Does not require the GIL.
  void tell(std::int64_t done, std::int64_t total) const {
    if (!function_) return;
    const Acquired acquired;
    const InCallback callback(owner_);
    (*function_)(done, total);
  }

 private:
  Held function_;
  const void* owner_;
};

/// Frames that are given as `(first, last)`; None: all of the scene. Raises InvalidInput for those
/// that it does not have.
FrameSpan frames_within(const py::object& frames, const Scene& scene);

/// Frames that are given as `(first, last)`. Raises InvalidInput.
FrameSpan frame_span(const py::object& frames);

/// Adds what makes files of a whole run: bakes, pages and replays.
void add_runs(Module& module);

}  // namespace pliant::python
