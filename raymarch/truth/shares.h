#pragma once
// Internal: what objects of one kind bring to a border, traced each in the way of its kind: fields, and the limit surfaces of cages. The
// border of a scene that has both is made of both shares, each hiding the other.

#include "raymarch/truth/limit_grid.h"
#include "raymarch/truth/parts.h"

namespace limn {

/// Objects of one kind. Functions are called from many threads and own what they need.
struct TruthShare {
  std::vector<size_t> objects{};      ///< Indices in the scene.
  std::vector<TracedCurve> curves{};  ///< Solver space; numbers of objects are the scene's.
  int contour_generators = 0, level_curves = 0;
  bool exact = true;                 ///< False where a part of the objects is left out.
  double unrefined_px = 0.0;         ///< What the bound has to grow by.
  std::vector<std::string> notes{};  ///< What the bound does not cover.
  /// Something of this share is between the point, which lies on the scene's object number `object` (of this share or not), and the eye.
  std::function<bool(const TracedPoint& point, int object)> blocked{};
  double lift_px = 0.0;  ///< As in CurveScene.
  /// As in CurveScene, for this share's curves; may be empty.
  std::function<TracedPoint(const TracedCurve& curve, size_t i, double t)> between{};
  std::function<double(const glm::dvec3& p, int object)> others{};
};

/// What both ways of tracing go by.
struct ShareSettings {
  Camera camera{};         ///< Solver space.
  glm::dvec3 origin{0.0};  ///< World: solver space's.
  double extent = 1.0;     ///< Radius of the whole scene, or what stands in for one.
  TruthSettings truth{};
};

/// `scene` may hold other kinds too: `objects` says which are meant.
TruthShare trace_fields(const Scene& scene, const std::vector<size_t>& objects, const ShareSettings& settings,
                        const ExecutionSettings& how);
/// A cage, its limit surface and the samples of it between which curves are looked for. `turned`: its back.
struct SampledCage {
  Mesh cage{};
  LimitSurface surface;
  PlacedLimitSurface placed;
  double cell_px = 0.0;
  LimitGrid grid{};

  SampledCage(const SceneObject& object, const ShareSettings& settings, bool turned = false);
  SampledCage(const SampledCage&) = delete;
  SampledCage& operator=(const SampledCage&) = delete;
};
/// `model` is the scene's (proxy.h), about the solver's origin: rays ask it what hides what. `first`: of the first of `objects`, where it
/// is there already; may be null.
struct TruthProxy;
TruthShare trace_cages(const Scene& scene, const std::vector<size_t>& objects, const ShareSettings& settings,
                       const std::shared_ptr<const TruthProxy>& proxy, std::unique_ptr<const SampledCage> first,
                       const ExecutionSettings& how);

}  // namespace limn
