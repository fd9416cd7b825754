#include "pliant/core/shelf.hpp"

#include <iterator>
#include <typeinfo>

namespace pliant {

std::vector<std::shared_ptr<const Shelf::Item>> Shelf::items_of(const Hash& key) const {
  const std::lock_guard lock(mutex_);
  std::vector<std::shared_ptr<const Item>> items;
  const auto [first, last] = by_key_.equal_range(number_of(key));
  for (auto found = first; found != last; ++found) items.push_back(found->second->item);
  return items;
}

void Shelf::use(const Hash& key, const Item& item) {
  const std::lock_guard lock(mutex_);
  const auto [first, last] = by_key_.equal_range(number_of(key));
  for (auto found = first; found != last; ++found) {
    if (found->second->item.get() != &item) continue;
    entries_.splice(entries_.begin(), entries_, found->second);
    return;
  }
}

// Takes an entry off the shelf.
Shelf::Entries Shelf::take(Places::iterator place) {
  const Entries::iterator entry = place->second;
  by_key_.erase(place);
  bytes_ -= entry->bytes;
  Entries taken;
  taken.splice(taken.begin(), entries_, entry);
  return taken;
}

void Shelf::put(const Hash& key, std::shared_ptr<const Item> item, std::size_t bytes,
                Entries& gone) {
  ++kept_;
  entries_.push_front({key, std::move(item), bytes});
  by_key_.emplace(number_of(key), entries_.begin());
  for (bytes_ += bytes; bytes_ > max_bytes_;) {
    const auto oldest = std::prev(entries_.end());
    auto found = by_key_.lower_bound(number_of(oldest->key));
    while (found->second != oldest) ++found;
    gone.splice(gone.begin(), take(found));
  }
}

void Shelf::keep(const Hash& key, std::shared_ptr<const Item> item, std::size_t bytes) {
  if (bytes > max_bytes_) return;
  Entries gone;  // destroyed without the lock
  const std::lock_guard lock(mutex_);
  put(key, std::move(item), bytes, gone);
}

void Shelf::keep_instead(const Hash& key, std::shared_ptr<const Item> item, std::size_t bytes) {
  if (bytes > max_bytes_) return;
  Entries gone;  // destroyed without the lock
  const std::lock_guard lock(mutex_);
  const Item& kept = *item;
  const auto [first, last] = by_key_.equal_range(number_of(key));
  for (auto place = first; place != last;) {
    const auto here = place++;
    const Item& other = *here->second->item;
    if (typeid(other) == typeid(kept)) gone.splice(gone.begin(), take(here));
  }
  put(key, std::move(item), bytes, gone);
}

std::size_t Shelf::kept() const {
  const std::lock_guard lock(mutex_);
  return kept_;
}

std::size_t Shelf::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

}  // namespace pliant
