#pragma once
// Internal: a field at the nodes of a lattice and its surface on the lattice's edges. Cells share them, and so do views: neither knows
// where anybody looks from.

#include <bit>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <utility>
#include <vector>

namespace limn {

/// Values by keys that are not 0, in the order in which they came, found by open addressing.
template <class Value>
class KeyedValues {
 public:
  /// A new one is Value{}; `added` says whether it is.
  Value& at(std::uint64_t key, bool& added) {
    if (2 * entries_.size() >= places_.size()) grow();
    size_t place = hash(key);
    while (places_[place] != kNone && entries_[places_[place]].first != key) place = (place + 1) & (places_.size() - 1);
    added = places_[place] == kNone;
    if (added) {
      places_[place] = static_cast<std::uint32_t>(entries_.size());
      entries_.emplace_back(key, Value{});
    }
    return entries_[places_[place]].second;
  }
  /// Null where there is none.
  const Value* find(std::uint64_t key) const {
    if (places_.empty()) return nullptr;
    size_t place = hash(key);
    while (places_[place] != kNone && entries_[places_[place]].first != key) place = (place + 1) & (places_.size() - 1);
    return places_[place] == kNone ? nullptr : &entries_[places_[place]].second;
  }
  /// Keys and values, in the order in which they came.
  const std::vector<std::pair<std::uint64_t, Value>>& entries() const { return entries_; }
  /// Room for so many.
  void reserve(size_t count) {
    entries_.reserve(count);
    if (2 * count >= places_.size()) resize(std::bit_ceil(2 * count + 1));
  }
  size_t bytes() const { return entries_.capacity() * sizeof(entries_[0]) + places_.capacity() * sizeof(places_[0]); }

 private:
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  /// The highest bits of the product, which all bits of the key have a part in: keys of cells have one coordinate above the others.
  size_t hash(std::uint64_t key) const { return static_cast<size_t>((key * 0x9e3779b97f4a7c15u) >> shift_); }
  void grow() { resize(places_.empty() ? 64 : 2 * places_.size()); }
  void resize(size_t places) {
    places_.assign(places, kNone);
    shift_ = 64 - std::countr_zero(places_.size());
    for (size_t i = 0; i < entries_.size(); ++i) {
      size_t place = hash(entries_[i].first);
      while (places_[place] != kNone) place = (place + 1) & (places_.size() - 1);
      places_[place] = static_cast<std::uint32_t>(i);
    }
  }
  std::vector<std::pair<std::uint64_t, Value>> entries_{};
  std::vector<std::uint32_t> places_{};  ///< A power of two of them.
  int shift_ = 63;
};

/// Where an edge meets the surface.
struct EdgeSample {
  glm::dvec3 p{0.0}, gradient{0.0};
};

/// Of one branch; used by one thread at a time.
struct LatticeSamples {
  KeyedValues<double> values{};
  KeyedValues<EdgeSample> edges{};
  size_t bytes() const { return values.bytes() + edges.bytes(); }
};

}  // namespace limn
