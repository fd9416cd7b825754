#include "pliant/states/state_store.hpp"

#include <list>
#include <map>
#include <mutex>
#include <utility>

namespace pliant {

/// The bytes of each key, in the order of their last use. Requires: `mutex` is locked.
class MemoryStateStore::Entries {
 public:
  explicit Entries(std::size_t byte_budget) : byte_budget_(byte_budget) {}

  mutable std::mutex mutex;

  bool contains(const Hash& key) const { return entries_.contains(place_of(key)); }

  std::optional<std::string> use(const Hash& key, std::size_t most) {
    const auto entry = entries_.find(place_of(key));
    if (entry == entries_.end() || entry->second.bytes.size() > most) return {};
    turns_.splice(turns_.end(), turns_, entry->second.turn);
    return entry->second.bytes;
  }

  void insert(const Hash& key, std::string_view bytes) {
    const Place place = place_of(key);
    erase(place);
    if (bytes.size() > byte_budget_) return;
    while (bytes_ + bytes.size() > byte_budget_) erase(Place(turns_.front()));
    bytes_ += bytes.size();
    entries_.emplace(place, Entry{std::string(bytes), turns_.insert(turns_.end(), place)});
  }

  void erase(const Hash& key) { erase(place_of(key)); }

  std::size_t bytes() const { return bytes_; }
  std::size_t byte_budget() const { return byte_budget_; }

 private:
  using Place = std::pair<std::uint64_t, std::uint64_t>;
  struct Entry {
    std::string bytes;
    std::list<Place>::iterator turn;
  };

  static Place place_of(const Hash& key) { return {key.high, key.low}; }

  void erase(const Place& place) {
    const auto entry = entries_.find(place);
    if (entry == entries_.end()) return;
    bytes_ -= entry->second.bytes.size();
    turns_.erase(entry->second.turn);
    entries_.erase(entry);
  }

  std::size_t byte_budget_;
  std::size_t bytes_ = 0;
  std::map<Place, Entry> entries_;
  std::list<Place> turns_;  // least recently used first
};

MemoryStateStore::MemoryStateStore(std::size_t byte_budget)
    : entries_(std::make_unique<Entries>(byte_budget)) {}

MemoryStateStore::~MemoryStateStore() = default;

bool MemoryStateStore::holds(const Hash& key) {
  const std::lock_guard lock(entries_->mutex);
  return entries_->contains(key);
}

std::optional<std::string> MemoryStateStore::read(const Hash& key, std::size_t most) {
  const std::lock_guard lock(entries_->mutex);
  return entries_->use(key, most);
}

void MemoryStateStore::write(const Hash& key, std::string_view bytes) {
  const std::lock_guard lock(entries_->mutex);
  entries_->insert(key, bytes);
}

void MemoryStateStore::discard(const Hash& key) {
  const std::lock_guard lock(entries_->mutex);
  entries_->erase(key);
}

std::size_t MemoryStateStore::bytes() const {
  const std::lock_guard lock(entries_->mutex);
  return entries_->bytes();
}

std::size_t MemoryStateStore::byte_budget() const { return entries_->byte_budget(); }

}  // namespace pliant
