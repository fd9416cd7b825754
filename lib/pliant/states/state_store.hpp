#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "pliant/core/hash.hpp"

namespace pliant {

/// Stores states beyond the life of a simulation: each surface's state at each frame, under a key
/// computed from everything that determines it. A simulation reads a stored state instead of
/// solving it. So an edit that takes effect at frame k costs only the frames from k on.
///
/// A store may lose states at any time; what it returns is checked, and never changes a result.
/// Thread-safe: several simulations may share one.
class StateStore {
 public:
  StateStore() = default;
  StateStore(const StateStore&) = delete;
  StateStore& operator=(const StateStore&) = delete;
  virtual ~StateStore() = default;

  /// Whether `read` will probably succeed.
  virtual bool holds(const Hash& key) = 0;

  /// The bytes written under the key, or null. A state has at most `most` bytes; longer ones are
  /// not ours.
  virtual std::optional<std::string> read(const Hash& key, std::size_t most) = 0;

  /// Stores the bytes if possible; failure is not an error.
  virtual void write(const Hash& key, std::string_view bytes) = 0;

  /// Removes bytes that were found damaged.
  virtual void discard(const Hash& key) = 0;
};

/// A store in memory, for edits within one program. Removes the least recently used states first.
class MemoryStateStore final : public StateStore {
 public:
  explicit MemoryStateStore(std::size_t byte_budget);
  ~MemoryStateStore() override;

  bool holds(const Hash& key) override;
  std::optional<std::string> read(const Hash& key, std::size_t most) override;
  void write(const Hash& key, std::string_view bytes) override;
  void discard(const Hash& key) override;

  std::size_t bytes() const;  ///< stored at present
  std::size_t byte_budget() const;

 private:
  class Entries;
  std::unique_ptr<Entries> entries_;
};

}  // namespace pliant
