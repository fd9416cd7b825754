#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"

namespace pliant::editor {

/// A text of the document that somebody kept, to compare others with.
struct Take {
  std::int64_t id = 0;  ///< from 1 on; no other take has had it
  std::string name;
  std::string text;
  std::shared_ptr<const std::string> picture = {};  ///< a PNG; null: there is none
};

/// The takes of a command, in the order in which they were kept.
class Takes {
 public:
  /// `max_bytes`: of all texts and pictures together.
  explicit Takes(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// Keeps a text, by default as `Take N`; `picture` empty: none. Returns the id. Errors:
  /// InvalidInput for too many takes, or one that is too large; those of `rename`.
  Result<std::int64_t> keep(std::string name, std::string text, std::string picture);

  const Take* find(std::int64_t id) const;  ///< null: there is none
  const std::vector<Take>& all() const { return takes_; }

  /// Requires: there is one with this id. Errors: InvalidInput for no name, a long one, or one
  /// with control characters.
  Result<void> rename(std::int64_t id, std::string name);
  void remove(std::int64_t id);

 private:
  std::size_t max_bytes_;
  std::int64_t last_id_ = 0;
  std::vector<Take> takes_;
};

/// The picture of a take from a request: a small PNG as base 64. Empty: there is none. Errors:
/// InvalidInput: it is no such picture, or too large; Interrupted.
Result<std::string> picture_from(std::string_view text, const StopRequest& should_stop);

}  // namespace pliant::editor
