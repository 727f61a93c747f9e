#pragma once
// Internal: what does not depend on the view, kept from one to the next. Whatever is kept is the same as if it were made anew.

#include <map>
#include <memory>

#include "raymarch/lines/mesh_tree.h"
#include "raymarch/truth/limit_grid.h"

namespace limn {

/// A cage's limit surface about its own middle, and its samples by LimitGrid's steps.
struct KeptCage {
  std::shared_ptr<const LimitSurface> surface{};
  std::map<int, std::shared_ptr<const LimitGrid>> grids{};
};

struct KeptLines {
  std::map<size_t, KeptCage> cages{};                                         ///< By the object's index.
  std::map<std::pair<size_t, int>, std::shared_ptr<const MeshTree>> trees{};  ///< By the first object's index and the refinement.
};

}  // namespace limn
