#pragma once

#include <optional>

#include "pliant/core/result.hpp"
#include "pliant/timeline/curve_report.hpp"
#include "pliant/timeline/key.hpp"

namespace pliant::timeline {

/// The largest allowed absolute value of any number of a curve. Products of two such numbers stay
/// finite, so nothing between the keys can overflow.
inline constexpr double largest_number = 1e150;

/// The first rule that the keys of an author break, if any: see `Curve::make`.
template <int D>
std::optional<Complaint> broken_rule(const CurveKeys<D>& keys);

extern template std::optional<Complaint> broken_rule(const CurveKeys<1>&);
extern template std::optional<Complaint> broken_rule(const CurveKeys<3>&);

}  // namespace pliant::timeline
