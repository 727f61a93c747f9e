#pragma once
// The finest affordable models of a scene: what stands in for surfaces that are not fields, where rays have to be cast against them.

#include "raymarch/truth.h"

namespace limn {

/// Objects as fields where they are fields, cages refined until their edges are about `edge_px` long or `max_faces` are reached, other
/// meshes and volumes as they are, with their best normals.
struct TruthProxy {
  SceneModel model{};
  int level = 0;                     ///< Of the refined cages.
  double edge_px = 0.0;              ///< Mean edge of the cages, where they are seen.
  std::vector<std::string> words{};  ///< What each kind of object became: "a mesh of level 6".
};
/// How often its cages are refined.
int proxy_level(const Scene& scene, const Camera& camera, double edge_px);
/// The model alone, with cages refined so often.
SceneModel proxy_model(const Scene& scene, int level, std::int64_t max_bytes);
TruthProxy make_proxy(const Scene& scene, const Camera& camera, std::int64_t max_bytes, double edge_px);
/// The same for a truth: with the model in the settings' cache where its level fits, else the cache has the new one.
std::shared_ptr<const TruthProxy> proxy_for(const Scene& scene, const Camera& camera, const TruthSettings& settings, double edge_px);

/// A mesh that is to be subdivided.
bool is_cage(const SceneObject& object);

}  // namespace limn
