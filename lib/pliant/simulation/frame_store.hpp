#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "pliant/core/hash.hpp"

namespace pliant {

/// Keeps what simulations computed beyond their own life, each surface's state at each frame under
/// a key made of all that it came from: a simulation that comes to a key that is there reads the
/// state and solves nothing. So an edit that takes effect at frame k costs the frames from k on.
///
/// A store may lose anything at any time; what it gives back is checked, and never changes a
/// result. Several simulations, in several threads, may use one.
class FrameStore {
 public:
  FrameStore() = default;
  FrameStore(const FrameStore&) = delete;
  FrameStore& operator=(const FrameStore&) = delete;
  virtual ~FrameStore() = default;

  /// Whether `read` is likely to give something.
  virtual bool holds(const Hash& key) = 0;

  /// What was written under the key, or nothing. More bytes than `most` are none of ours.
  virtual std::optional<std::string> read(const Hash& key, std::size_t most) = 0;

  /// Keeps the bytes if it can. There is nothing to be done about it if it cannot.
  virtual void write(const Hash& key, std::string_view bytes) = 0;

  /// What `read` gave is damaged.
  virtual void discard(const Hash& key) = 0;
};

/// A store in memory: for edits within one program. What was used longest ago goes first.
class MemoryFrameStore final : public FrameStore {
 public:
  explicit MemoryFrameStore(std::size_t byte_budget);
  ~MemoryFrameStore() override;

  bool holds(const Hash& key) override;
  std::optional<std::string> read(const Hash& key, std::size_t most) override;
  void write(const Hash& key, std::string_view bytes) override;
  void discard(const Hash& key) override;

  std::size_t bytes() const;  ///< kept now
  std::size_t byte_budget() const;

 private:
  class Kept;
  std::unique_ptr<Kept> kept_;
};

}  // namespace pliant
