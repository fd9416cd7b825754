#pragma once

#include <cstddef>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/timeline/curve_report.hpp"
#include "pliant/timeline/key.hpp"

namespace pliant::timeline {

/// Keys with the inner loop's copies written out.
template <int D>
struct WrittenKeys {
  std::vector<Key<D>> keys;         ///< frames strictly increasing; empty: no copies to write
  std::vector<std::size_t> origin;  ///< the author's index of each key
  std::vector<CurveNote> notes;     ///< about keys that the loop hides, or a loop without copies

  const std::vector<Key<D>>& keys_of(const CurveKeys<D>& author) const {
    return keys.empty() ? author.keys : keys;
  }
  std::size_t origin_of(std::size_t key) const { return origin.empty() ? key : origin[key]; }
};

/// The most keys that a loop may write out.
inline constexpr double most_written_keys = 1e6;

/// Writes out the copies of the inner loop, if there is one (docs/timeline.md, section "Inner
/// loop"). Errors: more than `most_written_keys`; copies that rounding puts on one frame, or whose
/// numbers exceed the limit of checks.hpp. Requires: broken_rule(keys) finds nothing.
template <int D>
[[nodiscard]] Checked<WrittenKeys<D>> written_out(const CurveKeys<D>& keys);

extern template Checked<WrittenKeys<1>> written_out(const CurveKeys<1>&);
extern template Checked<WrittenKeys<3>> written_out(const CurveKeys<3>&);

}  // namespace pliant::timeline
