#pragma once
// The border as it really is, solved in double precision from what the scene is and never from a picture of it: the reference of every
// metric.

#include <memory>
#include <string>
#include <vector>

#include "raymarch/border_curves.h"
#include "raymarch/gbuffer.h"
#include "raymarch/scene.h"

namespace limn {

/// What the border of a mesh that is no cage, and of a volume, is asked of.
enum class TruthReference {
  given,   ///< The file as it is: its facets, its interpolated normals, its samples. What does a coarser model of it lose?
  smooth,  ///< The surface that was meant, of which the file is all there is: known no better than two ways to read it agree.
};

struct TruthProxy;  // raymarch/truth/proxy.h
/// What the truths of several views of one scene have in common, made with the first of them. Used by one truth at a time.
struct TruthCache {
  std::shared_ptr<const TruthProxy> proxy{};  ///< Null before the first.
};

/// Which border is solved, and how precisely.
struct TruthSettings {
  double threshold = 0.4;       ///< Of the rim: its level curve is N.V = threshold; 0 leaves the silhouette alone. In [0, 1).
  double tolerance_px = 0.005;  ///< How far the polylines may lie from the curves.
  std::int64_t max_bytes = std::int64_t{4} << 30;     ///< For stand-ins of what has no closed description.
  TruthReference reference = TruthReference::smooth;  ///< Of meshes and volumes; fields and cages say which surface they mean.
  TruthCache* cache = nullptr;                        ///< Of the same scene; changes nothing but the time. May be null.
};

/// The visible border of a scene.
struct BorderTruth {
  BorderCurves curves{};  ///< Visible parts only.
  /// Share of each pixel that is ink of the rim: hit, and N.V below the threshold.
  Image<float> coverage{};
  /// Contour generators: closed curves on the surfaces, hidden ones and parts included. Objects that overlap count as one body.
  int contour_generators = 0,
      level_curves = 0;              ///< The same of level curves N.V = threshold.
  bool exact = true;                 ///< False where a finest affordable version stands in for the surface itself, or a part is left out.
  double bound_px = 0.0;             ///< No point of `curves` lies farther from the true border than this; an estimate where not `exact`.
  std::string from{};                ///< What it was solved on, in words: "the field", "the limit surface", "a mesh of level 6".
  std::vector<std::string> notes{};  ///< What the bound does not cover, with numbers.
};

/// Throws InputError for a threshold outside [0, 1) and for a scene that nothing affordable can stand in for.
BorderTruth solve_truth(const Scene& scene, const Camera& camera, const TruthSettings& settings, const ExecutionSettings& how);

/// Lets truths of this scene use a model that is there already, where it is one that they would make: of meshes alone, cages refined onto
/// their limit, others as they are. `settings`: what it was built with. Truths are the same without; what the cache holds already stays.
void offer_model(const Scene& scene, const SurfaceSettings& settings, const SceneModel& model, TruthCache& cache);

/// Whether TruthSettings::reference makes a difference: the scene has a mesh that is no cage, or a volume.
bool has_given_surface(const Scene& scene);

}  // namespace limn
