#pragma once
// Internal: facts about one object that several checks look at, each made when it is first asked for.

#include <memory>

#include "raymarch/audit.h"
#include "subdiv/mesh_audit.h"

namespace limn {

/// Points of the surface as it is, and what is there; spread evenly by area, so that shares of them are shares of the surface.
struct SurfaceSamples {
  std::vector<glm::dvec3> points{};
  std::vector<glm::dvec3> normals{};  ///< Unit, outwards.
  std::vector<double> slopes{};       ///< |grad f| across the surface; empty for meshes. NaN where there is none.
  std::vector<double> walls{};        ///< Thickness of the wall behind the point, along the normal, world; infinite where it is thick.
  std::vector<double> gaps{};         ///< Width of the gap before it.
  std::vector<double> bending{};      ///< Larger absolute principal curvature times the longest side; empty for volumes.
  double longest_side = 0.0;          ///< World, of the bounds.
  std::string of{};                   ///< What was sampled, where it is not the object itself.
};

class AuditFacts {
 public:
  AuditFacts(const SceneObject& of, const AuditSettings& how) : object(of), settings(how) {}

  const SceneObject& object;
  const AuditSettings& settings;

  const Field* field() const { return std::get_if<Field>(&object.source); }
  const MeshSource* mesh() const { return std::get_if<MeshSource>(&object.source); }
  const LevelSetSource* level_set() const { return std::get_if<LevelSetSource>(&object.source); }
  /// The scheme a mesh will be refined by; empty where it is taken as it is.
  std::optional<Scheme> scheme() const;

  /// Of a mesh or cage as loaded: of all of it where that was asked for or there are at most 100,000 faces, else of 20,000 of them.
  const MeshFacts& mesh_facts();
  std::string sample_text();        ///< For messages with a number of mesh_facts(): how much was looked at, where that is not all.
  const SurfaceSamples& samples();  ///< Empty for what has no bounds.

 private:
  std::unique_ptr<MeshFacts> mesh_facts_{};
  std::unique_ptr<SurfaceSamples> samples_{};
};

SurfaceSamples sample_field(const Field& field);
/// Of the mesh, or of the cage refined as far as asked, or as a million faces allow.
SurfaceSamples sample_mesh(const SceneObject& object, const SurfaceSettings& settings);
SurfaceSamples sample_level_set(const SceneObject& object);

/// `lower_quantile` of those that are not NaN; infinite ones count.
double known_quantile(std::vector<double> values, double share);
/// Share of the values that are below `limit`.
double share_below(std::span<const double> values, double limit);

}  // namespace limn
