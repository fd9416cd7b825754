#pragma once

#include <cstdint>
#include <string>
#include <variant>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/timeline/key.hpp"

namespace pliant::edit {

/// Keys of a channel, as operations have them.
using AnyKeys = std::variant<CurveKeys<1>, CurveKeys<3>>;

/// Keys as the text of an <animate>, on one line. Errors: those of `Curve::make`.
Checked<std::string> animate_text(const AnyKeys& keys, const std::string& channel);

/// The keys of such a text: vectors if a value has three numbers, and 1 and 0 of `true` and
/// `false`. `copies`: of keys by loops, which are counted. Errors: the first problem, with its
/// line; too many copies; Interrupted.
Result<AnyKeys> keys_of_animate(const std::string& text, const std::string& channel,
                                std::int64_t& copies, const StopRequest& should_stop = {});

}  // namespace pliant::edit
