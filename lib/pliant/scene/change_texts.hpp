#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/change.hpp"

namespace pliant {

/// Checks that there are the files that changes made a scene name. Errors: InvalidInput, naming the
/// change.
Result<void> check_files(const Scene& changed, std::span<const SceneChange> changes);

/// A text that a change does not take.
struct WrongText {
  std::size_t number = 0;  ///< among the texts, counted from 0
  Error error;             ///< InvalidInput; or Interrupted, ahead of this text
};

/// Checks that `make_changes` would make a change with each of many texts, each by itself, in much
/// less time, and `check_files`. The first text that these refuse; null: there is none.
std::optional<WrongText> check_change_texts(const Scene& scene, const SceneChange& change,
                                            std::span<const std::string_view> texts,
                                            const std::string& root,
                                            const StopRequest& should_stop);

}  // namespace pliant
