#include "pliant/states/state_store.hpp"

#include <list>
#include <map>
#include <mutex>
#include <utility>

namespace pliant {

/// The bytes of each key, in the order of their last use. Requires: `mutex` is locked.
class MemoryStateStore::Kept {
 public:
  explicit Kept(std::size_t byte_budget) : byte_budget_(byte_budget) {}

  mutable std::mutex mutex;

  bool contains(const Hash& key) const { return states_.contains(place_of(key)); }

  std::optional<std::string> use(const Hash& key, std::size_t most) {
    const auto state = states_.find(place_of(key));
    if (state == states_.end() || state->second.bytes.size() > most) return {};
    turns_.splice(turns_.end(), turns_, state->second.turn);
    return state->second.bytes;
  }

  void insert(const Hash& key, std::string_view bytes) {
    const Place place = place_of(key);
    erase(place);
    if (bytes.size() > byte_budget_) return;
    while (bytes_ + bytes.size() > byte_budget_) erase(Place(turns_.front()));
    bytes_ += bytes.size();
    states_.emplace(place, State{std::string(bytes), turns_.insert(turns_.end(), place)});
  }

  void erase(const Hash& key) { erase(place_of(key)); }

  std::size_t bytes() const { return bytes_; }
  std::size_t byte_budget() const { return byte_budget_; }

 private:
  using Place = std::pair<std::uint64_t, std::uint64_t>;
  struct State {
    std::string bytes;
    std::list<Place>::iterator turn;
  };

  static Place place_of(const Hash& key) { return {key.high, key.low}; }

  void erase(const Place& place) {
    const auto state = states_.find(place);
    if (state == states_.end()) return;
    bytes_ -= state->second.bytes.size();
    turns_.erase(state->second.turn);
    states_.erase(state);
  }

  std::size_t byte_budget_;
  std::size_t bytes_ = 0;
  std::map<Place, State> states_;
  std::list<Place> turns_;  // least recently used first
};

MemoryStateStore::MemoryStateStore(std::size_t byte_budget)
    : kept_(std::make_unique<Kept>(byte_budget)) {}

MemoryStateStore::~MemoryStateStore() = default;

bool MemoryStateStore::holds(const Hash& key) {
  const std::lock_guard lock(kept_->mutex);
  return kept_->contains(key);
}

std::optional<std::string> MemoryStateStore::read(const Hash& key, std::size_t most) {
  const std::lock_guard lock(kept_->mutex);
  return kept_->use(key, most);
}

void MemoryStateStore::write(const Hash& key, std::string_view bytes) {
  const std::lock_guard lock(kept_->mutex);
  kept_->insert(key, bytes);
}

void MemoryStateStore::discard(const Hash& key) {
  const std::lock_guard lock(kept_->mutex);
  kept_->erase(key);
}

std::size_t MemoryStateStore::bytes() const {
  const std::lock_guard lock(kept_->mutex);
  return kept_->bytes();
}

std::size_t MemoryStateStore::byte_budget() const { return kept_->byte_budget(); }

}  // namespace pliant
