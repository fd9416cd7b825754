#pragma once

#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/timeline/curve_report.hpp"
#include "pliant/timeline/extrapolated.hpp"
#include "pliant/timeline/handle.hpp"
#include "pliant/timeline/key.hpp"

namespace pliant::timeline {

/// A curve ready to evaluate, and notes for its author.
template <int D>
struct Compiled {
  Extrapolated<D> curve;
  std::vector<CurveNote> notes;       ///< in the order of the keys
  std::vector<KeyHandle<D>> handles;  ///< of the Bézier segments, in the order of frames
};

/// The error of work that was stopped.
inline tl::unexpected<Complaint> interruption() {
  return tl::unexpected(Complaint{.message = "interrupted", .kind = Complaint::Kind::Interrupted});
}

/// Checks the rules and turns keys into segments. Errors: those of `Curve::make`.
template <int D>
[[nodiscard]] Checked<Compiled<D>> compile(const CurveKeys<D>& keys,
                                           const StopRequest& should_stop = {});

extern template Checked<Compiled<1>> compile(const CurveKeys<1>&, const StopRequest&);
extern template Checked<Compiled<3>> compile(const CurveKeys<3>&, const StopRequest&);

}  // namespace pliant::timeline
