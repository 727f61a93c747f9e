#pragma once
// Internal: curves on single branches and along their seams, cut to what is surface of the whole and joined where one leads into the next.

#include <memory>

#include "raymarch/truth/branches.h"
#include "raymarch/truth/field_curves.h"
#include "raymarch/truth/marching_tetrahedra.h"

namespace limn {

/// Followed without regard to what is surface: a curve N.V = c on branch `first`, or the seam of `first` and `second`.
struct Strand {
  int first = 0, second = -1;
  double c = 0.0;
  bool closed = false;
  std::vector<CurvePoint> points{};
  bool whole = false;     ///< A seam that is wanted whatever N.V is beside it.
  bool followed = false;  ///< Its steps need no refinement.
};

/// Crossings joined along their links, in an order that hangs on their keys alone.
std::vector<Strand> assemble(const CellCurves& cells, int first, int second, double c);

/// What the strands of a field share. Safe from many threads.
class StrandScope {
 public:
  StrandScope(const SharpField& sharp, double extent);
  ~StrandScope();
  StrandScope(const StrandScope&) = delete;
  StrandScope& operator=(const StrandScope&) = delete;

  /// Of many branches those that may be surface around a place are evaluated there; of the others, which bounds show to decide nothing, the
  /// values at its middle will do.
  struct Around {
    std::vector<size_t> near{};
    std::vector<double> values{};  ///< Of all branches.
  };
  /// `cube` counts cubes of one size along each axis.
  const Around& around(const glm::ivec3& cube);
  glm::ivec3 cube_of(const glm::dvec3& p) const { return glm::ivec3(glm::floor(p / side_)); }
  /// Of all branches, for the calling thread.
  std::vector<FieldEvaluator>& evaluators();

 private:
  struct Shared;
  const SharpField& sharp_;
  double side_;
  std::unique_ptr<Shared> shared_;
};

struct StrandSettings {
  const SharpField& sharp;
  StrandScope& scope;
  const Camera& camera;
  const Viewer& viewer;
  double tolerance_px = 0.005;
  double extent = 1.0;
  double lipschitz = 1.0;  ///< Of the branches.
};

/// The stretches of a strand that are curves of the whole surface: on it, and along a seam with c between the N.V of the two sides. Changes
/// are bracketed to rounding; that there is none between two points the field's steepness proves, down to steps of a few hundredths of a
/// pixel.
std::vector<FieldCurve> cut_to_surface(const Strand& strand, const StrandSettings& settings);

/// Open curves joined at ends that lie together, nearest first; where more than two do, those that have the higher N.V on the same side.
/// `worst_gap_px` grows to the widest gap that was closed or
/// that is left, in the image, between an end that leads nowhere and the next such.
std::vector<FieldCurve> join_ends(std::vector<FieldCurve> pieces, const Camera& camera, double& worst_gap_px);

}  // namespace limn
