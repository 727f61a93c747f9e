#pragma once
// A list of variants of one kind (shapes, gradients, surfaces, methods, metrics, checks, scenes). A new one is one file and one line in the
// list.

#include <string>
#include <utility>
#include <vector>

#include "sdf/descriptor.h"
#include "sdf/error.h"

namespace limn {

/// T has a Description as its member `about`. The order is that of help, lists and sweeps.
template <class T>
class Registry {
 public:
  /// `what` names the kind in messages: "method".
  Registry(std::string what, std::vector<T> all) : what_(std::move(what)), all_(std::move(all)) {}

  auto begin() const { return all_.begin(); }                   ///< For range-based loops.
  auto end() const { return all_.end(); }                       ///< For range-based loops.
  std::size_t size() const { return all_.size(); }              ///< Number of entries.
  const T& operator[](std::size_t i) const { return all_[i]; }  ///< Entry `i` in the list's order; not checked.

  /// Of all entries, in order.
  std::vector<std::string> names() const {
    std::vector<std::string> names;
    for (const T& one : all_) names.push_back(one.about.name);
    return names;
  }

  /// Null where there is none of that name.
  const T* look_up(const std::string& name) const {
    for (const T& one : all_)
      if (one.about.name == name) return &one;
    return nullptr;
  }

  /// Throws InputError naming the nearest that there is; `file` and `field` go into the message.
  const T& find(const std::string& name, const std::string& file = {}, const std::string& field = {}) const {
    if (const T* const one = look_up(name)) return *one;
    throw InputError({file, field, name, "unknown " + what_, known_names(name, names())});
  }

 private:
  std::string what_;
  std::vector<T> all_;
};

}  // namespace limn
