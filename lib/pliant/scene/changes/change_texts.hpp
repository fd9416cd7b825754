#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/changes/change.hpp"
#include "pliant/scene/format/resolve.hpp"

namespace pliant {

/// Checks that there are the files that changes made a scene name. Errors: InvalidInput, naming the
/// change.
Result<void> check_files(const Scene& changed, std::span<const SceneChange> changes);

/// A text that a change does not take.
struct WrongText {
  std::size_t number = 0;  ///< among the texts, counted from 0
  Error error;             ///< InvalidInput; or Interrupted, ahead of this text
};

/// Checks many changes of one scene, each by itself, in much less time than `make_changes` and
/// `check_files` take: the scene is copied once, and its things are found by their names.
class ChangeCheck {
 public:
  ChangeCheck(const Scene& scene, std::string root);
  ChangeCheck(const ChangeCheck&) = delete;
  ChangeCheck& operator=(const ChangeCheck&) = delete;

  /// The first text with which these would refuse the change; null: there is none.
  std::optional<WrongText> first_wrong(const SceneChange& change,
                                       std::span<const std::string_view> texts,
                                       const StopRequest& should_stop);

  /// Whether the path is that of an attribute which names a file.
  bool names_file(const std::string& path) const;

 private:
  std::optional<WrongText> first_wrong_at(const Checked<xml::SlotAt>& at, const SceneChange& change,
                                          std::span<const std::string_view> texts,
                                          const StopRequest& should_stop) const;

  Scene scene_;  // between two checks as it was, but for its own values
  xml::NamedThings things_;
  std::string root_;
};

}  // namespace pliant
