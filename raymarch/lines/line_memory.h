#pragma once
// Internal: what does not depend on the view, kept from one to the next. Whatever is kept is the same as if it were made anew.

#include <map>
#include <memory>

#include "raymarch/lines/mesh_tree.h"
#include "raymarch/lines/placed_level_set.h"
#include "raymarch/truth/limit_grid.h"

namespace limn {

/// A cage's limit surface about its own middle, and its samples by LimitGrid's steps.
struct KeptCage {
  std::shared_ptr<const LimitSurface> surface{};
  std::map<int, std::shared_ptr<const LimitGrid>> grids{};
};

/// Places in solver space, whose origin is the scene's middle and no view's.
struct KeptLevelSets {
  std::map<size_t, SharedLevelSet> placed{};  ///< By the object's index.
  std::vector<std::vector<size_t>> bodies{};  ///< Places in their list of those that overlap; empty before the first view.
  std::map<std::pair<size_t, size_t>, std::vector<SurfaceCell>> meetings{};  ///< Cells of a pair in which one may meet the other.
};

struct KeptLines {
  std::map<size_t, KeptCage> cages{};                                         ///< By the object's index.
  std::map<std::pair<size_t, int>, std::shared_ptr<const MeshTree>> trees{};  ///< By the first object's index and the refinement.
  KeptLevelSets level_sets{};
};

}  // namespace limn
