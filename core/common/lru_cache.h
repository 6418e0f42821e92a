// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CORE_COMMON_LRU_CACHE_H_
#define OVERTONE_CORE_COMMON_LRU_CACHE_H_

#include <cstddef>
#include <list>
#include <map>
#include <memory>
#include <utility>

namespace overtone {

// Keeps the `capacity` shared values that were asked for last. O(log n). Not thread-safe.
template <typename Key, typename Value>
class LruCache {
 public:
  explicit LruCache(size_t capacity) : capacity_(capacity) {}

  // Null: not kept.
  std::shared_ptr<const Value> Find(const Key& key) {
    const auto found = position_of_.find(key);
    if (found == position_of_.end()) return nullptr;
    entries_.splice(entries_.begin(), entries_, found->second);
    return found->second->second;
  }

  void Insert(const Key& key, std::shared_ptr<const Value> value) {
    Erase(key);
    entries_.emplace_front(key, std::move(value));
    position_of_[key] = entries_.begin();
    if (entries_.size() > capacity_) Erase(Key(entries_.back().first));
  }

  void Erase(const Key& key) {
    const auto found = position_of_.find(key);
    if (found == position_of_.end()) return;
    entries_.erase(found->second);
    position_of_.erase(found);
  }

  size_t size() const { return entries_.size(); }

 private:
  using Entries = std::list<std::pair<Key, std::shared_ptr<const Value>>>;  // newest first

  const size_t capacity_;
  Entries entries_;
  std::map<Key, typename Entries::iterator> position_of_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_COMMON_LRU_CACHE_H_
