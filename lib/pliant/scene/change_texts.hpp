#pragma once

#include <span>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/change.hpp"

namespace pliant {

/// Checks that `make_changes` would make a change with each of many texts, each by itself, in much
/// less time. Errors: that of the first text that it would refuse; Interrupted.
Result<void> check_change_texts(const Scene& scene, const SceneChange& change,
                                std::span<const std::string_view> texts, const std::string& root,
                                const StopRequest& should_stop);

}  // namespace pliant
