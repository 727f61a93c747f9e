#pragma once
// Internal: what does not depend on the view, kept from one to the next. Whatever is kept is the same as if it were made anew.

#include <map>
#include <memory>

#include "raymarch/lines/form_trimming.h"
#include "raymarch/lines/mesh_tree.h"
#include "raymarch/lines/placed_level_set.h"
#include "raymarch/lines/smoothed_scene.h"
#include "raymarch/truth/lattice_memory.h"
#include "raymarch/truth/limit_grid.h"
#include "subdiv/vertex_curvature.h"

namespace limn {

/// A cage's limit surface about its own middle, and its samples by LimitGrid's steps.
struct KeptCage {
  std::shared_ptr<const LimitSurface> surface{};
  std::vector<PatchSide> sides{};  ///< Empty before the first view.
  std::map<int, std::shared_ptr<const LimitGrid>> grids{};
};

/// Places in solver space, whose origin is the scene's middle and no view's.
struct KeptLevelSets {
  std::map<size_t, SharedLevelSet> placed{};   ///< By the object's index.
  std::vector<std::vector<size_t>> bodies{};   ///< Places in their list of those that overlap; empty before the first view.
  std::map<size_t, LatticeMemory> lattices{};  ///< By the object's place in their list.
  std::map<std::pair<size_t, size_t>, std::vector<SurfaceCell>> meetings{};  ///< Cells of a pair in which one may meet the other.
};

struct KeptLines {
  std::shared_ptr<const SmoothedScene> smoothed{};                            ///< Null before it is asked for.
  std::map<size_t, KeptCage> cages{};                                         ///< By the object's index.
  std::map<size_t, std::shared_ptr<const SmoothCurvature>> curvatures{};      ///< Of meshes, by the object's index.
  std::map<std::pair<size_t, int>, std::shared_ptr<const MeshTree>> trees{};  ///< By the first object's index and the refinement.
  KeptLevelSets level_sets{};
  /// By the body's place among those of the scene, which are the same in all views, and the level of its cells.
  std::map<std::pair<size_t, int>, LatticeMemory> fields{};
  /// By the same place: null where the body has no closed form.
  std::map<size_t, std::shared_ptr<const FormMeetings>> forms{};
};

}  // namespace limn
