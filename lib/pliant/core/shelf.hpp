#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "pliant/core/hash.hpp"

namespace pliant {

/// What several runs make alike, and need to make only once: rest shapes, factors. Keeps those used
/// last. Never changes a result: what is found is equal to what would be made. Thread-safe.
class Shelf {
 public:
  /// What can be kept. Immutable once it is.
  struct Item {
    Item() = default;
    Item(const Item&) = default;
    Item& operator=(const Item&) = default;
    virtual ~Item() = default;
  };

  /// Keeps items that take at most so many bytes together.
  explicit Shelf(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// The item of this key that `is_same` accepts; null: there is none. It stays valid without the
  /// shelf.
  template <class Wanted>
  std::shared_ptr<const Wanted> find(const Hash& key,
                                     const std::function<bool(const Wanted&)>& is_same) {
    for (const std::shared_ptr<const Item>& item : items_of(key)) {
      auto found = std::dynamic_pointer_cast<const Wanted>(item);
      if (!found || !is_same(*found)) continue;
      use(key, *item);
      return found;
    }
    return nullptr;
  }

  /// Keeps an item, in place of those used least. `bytes`: those that it takes.
  void keep(const Hash& key, std::shared_ptr<const Item> item, std::size_t bytes);

  /// The same, also in place of all of its type that have the key: for what changes often.
  void keep_instead(const Hash& key, std::shared_ptr<const Item> item, std::size_t bytes);

  std::size_t bytes() const;  ///< that all items take [bytes]
  std::size_t kept() const;   ///< how many items it was given to keep so far

 private:
  struct Entry {
    Hash key;
    std::shared_ptr<const Item> item;
    std::size_t bytes;
  };
  using Entries = std::list<Entry>;
  using Number = std::pair<std::uint64_t, std::uint64_t>;
  using Places = std::multimap<Number, Entries::iterator>;

  static Number number_of(const Hash& key) { return {key.high, key.low}; }
  std::vector<std::shared_ptr<const Item>> items_of(const Hash& key) const;
  void use(const Hash& key, const Item& item);
  Entries take(Places::iterator place);
  void put(const Hash& key, std::shared_ptr<const Item> item, std::size_t bytes, Entries& gone);

  mutable std::mutex mutex_;
  std::size_t max_bytes_;
  std::size_t bytes_ = 0;
  std::size_t kept_ = 0;
  Entries entries_;  // the last used one first
  Places by_key_;
};

}  // namespace pliant
