#pragma once
// Internal: smooth surfaces as fine triangles whose corners lie on them, with their exact curvature everywhere: what lines that are defined
// by curvature are traced over.

#include <array>
#include <functional>
#include <optional>

#include "raymarch/lines/surface_curves.h"

namespace limn {

/// A point of a smooth surface, solver space. The shape operator maps a tangent to how the unit normal changes along it: symmetric, its
/// quadratic form is the normal curvature, positive where the surface bends away from its normal.
struct FeaturePoint {
  glm::dvec3 p{0.0};
  glm::dvec3 normal{0.0};  ///< Unit.
  glm::dmat3 shape{0.0};
  std::uint32_t sheet = 0;  ///< Which smooth part of the surface: a branch of sharp CSG, a patch of a limit surface.
  glm::dvec2 uv{0.0};       ///< On the patch.
  bool valid = false;
};

/// A triangle, and a place in it.
struct FeaturePlace {
  std::uint32_t triangle = 0;
  glm::dvec3 weights{0.0};  ///< Of the triangle's corners; they add up to 1.
};

/// One smooth surface, or the smooth parts of one with edges. Functions are called from many threads and own what they need.
struct FeatureSurface {
  std::vector<FeaturePoint> nodes{};
  std::vector<std::array<std::uint32_t, 3>> triangles{};  ///< Of nodes; neighbours share them where the surface is smooth.
  /// Where the triangles themselves are what is drawn: of each its number among those that rays are cast against.
  std::vector<std::uint32_t> faces{};
  double radius = 1.0;  ///< Of the whole object: what sizes of curvature are measured by.
  double step = 0.0;    ///< Derivatives of curvature mean nothing over less than this, world units; 0: none.
  bool swings = false;  ///< Over a step, beside edges that are finer: a spline through voxels does.
  std::function<FeaturePoint(const FeaturePlace&)> at{};
  /// How the normal curvature along a unit tangent changes on the geodesic that goes that way, 1 / world unit squared.
  std::function<double(const FeaturePoint&, const glm::dvec3& tangent)> change{};
  /// A point a small step beside another, on the same sheet.
  std::function<FeaturePoint(const FeaturePoint&, const glm::dvec3& step)> beside{};
  /// Below 0 where another sheet is the surface; empty: nowhere.
  std::function<double(const FeaturePoint&)> margin{};
  std::function<int(const FeaturePoint&)> object{};  ///< From 1.
  std::function<void(SurfaceCurve&)> complete{};     ///< Adds what goes through a curve; empty: nothing does.
};

/// Of all objects of a scene that are smooth. `notes` gets what is left out or coarser than it should be.
std::vector<FeatureSurface> field_features(const LineTask& task, const std::vector<size_t>& objects, std::vector<std::string>& notes);
std::vector<FeatureSurface> cage_features(const LineTask& task, const std::vector<size_t>& objects, std::vector<std::string>& notes);
/// Of meshes that are drawn as they are.
std::vector<FeatureSurface> mesh_features(const LineTask& task, const std::vector<size_t>& objects, std::vector<std::string>& notes);
std::vector<FeatureSurface> level_set_features(const LineTask& task, const std::vector<size_t>& objects, std::vector<std::string>& notes);

/// The tensor's tangential part: of a field's Hessian over its gradient's length, the shape operator.
glm::dmat3 tangential(const glm::dmat3& tensor, const glm::dvec3& normal);

inline constexpr double kFeatureEdge_px = 2.0;
inline constexpr std::int64_t kMostFeatureTriangles = 1'000'000;

}  // namespace limn
