#include "pliant/simulation/frame_store.hpp"

namespace pliant {

bool MemoryFrameStore::holds(const Hash& key) {
  const std::lock_guard lock(mutex_);
  return kept_.contains(place_of(key));
}

std::optional<std::string> MemoryFrameStore::read(const Hash& key, std::size_t most) {
  const std::lock_guard lock(mutex_);
  const auto kept = kept_.find(place_of(key));
  if (kept == kept_.end() || kept->second.bytes.size() > most) return {};
  turns_.splice(turns_.end(), turns_, kept->second.turn);
  return kept->second.bytes;
}

void MemoryFrameStore::write(const Hash& key, std::string_view bytes) {
  const std::lock_guard lock(mutex_);
  const Place place = place_of(key);
  erase(place);
  if (bytes.size() > byte_budget_) return;
  while (bytes_ + bytes.size() > byte_budget_) erase(Place(turns_.front()));
  bytes_ += bytes.size();
  kept_.emplace(place, Kept{std::string(bytes), turns_.insert(turns_.end(), place)});
}

void MemoryFrameStore::discard(const Hash& key) {
  const std::lock_guard lock(mutex_);
  erase(place_of(key));
}

std::size_t MemoryFrameStore::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

void MemoryFrameStore::erase(const Place& place) {
  const auto kept = kept_.find(place);
  if (kept == kept_.end()) return;
  bytes_ -= kept->second.bytes.size();
  turns_.erase(kept->second.turn);
  kept_.erase(kept);
}

}  // namespace pliant
