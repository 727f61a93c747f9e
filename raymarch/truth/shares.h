#pragma once
// Internal: what objects of one kind bring to a border, traced each in the way of its kind: fields, and the limit surfaces of cages. The
// border of a scene that has both is made of both shares, each hiding the other.

#include <memory>
#include <optional>

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
  LatticeSteps lattice{};
  std::optional<LimitGrid> grid{};  ///< Once it is sampled.

  /// Not sampled yet. Throws InputError where a cage has no limit surface.
  SampledCage(const SceneObject& object, const ShareSettings& settings, bool turned = false);
  SampledCage(const SampledCage&) = delete;
  SampledCage& operator=(const SampledCage&) = delete;
  void sample(const Camera& camera);
};
using SampledCages = std::vector<std::unique_ptr<SampledCage>>;
/// One for each of `objects`, sampled side by side as far as their grids together are no larger than one may be. Null where there is no
/// more room, or a cage cannot be sampled: who needs it then says why.
SampledCages cages_ahead(const Scene& scene, const std::vector<size_t>& objects, const ShareSettings& settings);

/// `model` is the scene's (proxy.h), about the solver's origin: rays ask it what hides what. `cages` are of `objects`.
struct TruthProxy;
TruthShare trace_cages(const Scene& scene, const std::vector<size_t>& objects, const ShareSettings& settings,
                       const std::shared_ptr<const TruthProxy>& proxy, SampledCages cages, const ExecutionSettings& how);

}  // namespace limn
