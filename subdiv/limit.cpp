#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/far/topologyLevel.h>

#include <algorithm>
#include <cmath>

#include "sdf/error.h"
#include "subdiv/opensubdiv_cage.h"

namespace limn {

namespace Bfr = OpenSubdiv::Bfr;

/// Surfaces and their patch points, face by face, in the given cage's numbering.
struct LimitSurfaceData {
  std::unique_ptr<Far::TopologyRefiner> refiner;
  std::unique_ptr<Bfr::RefinerSurfaceFactory<>> factory;
  std::vector<Bfr::Surface<double>> surfaces;
  std::vector<std::vector<double>> patch_points;
  std::vector<int> face_sizes;
  std::vector<std::int32_t> holes;
  Scheme scheme = Scheme::catmark;
};

namespace {

/// Around extraordinary vertices and semi-sharp features the patches approximate the limit; each level of isolation brings them nearer,
/// and sharpness wears off by 1 a level, so that 10 levels hold every semi-sharp crease.
constexpr int kSmoothLevels = 8, kSharpLevels = 10;

/// Bfr gathers a face's neighbours corner by corner, and overruns its buffers where one neighbour is met again at a corner that is not
/// the next (two faces that share two edges, tubes of fewer than three faces) or where an edge has more than two faces.
bool simple_neighbourhood(const Far::TopologyLevel& level, int face) {
  const Far::ConstIndexArray corners = level.GetFaceVertices(face);
  std::vector<std::pair<int, int>> met;
  for (int i = 0; i < corners.size(); ++i) {
    if (level.IsVertexNonManifold(corners[i])) return false;
    for (const int neighbour : level.GetVertexFaces(corners[i]))
      if (neighbour != face) met.emplace_back(neighbour, i);
  }
  std::sort(met.begin(), met.end());
  const int n = corners.size();
  for (size_t first = 0, end = 0; first < met.size(); first = end) {
    while (end < met.size() && met[end].first == met[first].first) ++end;
    if (end - first == 1) continue;
    const int gap = met[first + 1].second - met[first].second;
    if (end - first > 2 || (gap != 1 && gap != n - 1)) return false;
  }
  return true;
}

/// OpenSubdiv 3.5 gives second derivatives of the wrong sign in the triangular patches that lie upside down in their face (it scales them
/// by the cube of what it scales first derivatives by, which is negative there). The change of the first derivatives tells.
void mend_sign(const Bfr::Surface<double>& surface, const double* patch_points, double u, double v, LimitPoint& point) {
  constexpr double kStep = 1e-3;
  double step_u = kStep * (1.0 / 3.0 - u), step_v = kStep * (1.0 / 3.0 - v);
  if (std::abs(step_u) + std::abs(step_v) < 0.01 * kStep) step_u = 0.1 * kStep;
  const double uv[2] = {u + step_u, v + step_v};
  LimitPoint near;
  surface.Evaluate(uv, patch_points, 3, &near.position.x, &near.du.x, &near.dv.x);
  const double agreement = glm::dot(near.du - point.du, step_u * point.duu + step_v * point.duv) +
                           glm::dot(near.dv - point.dv, step_u * point.duv + step_v * point.dvv);
  if (agreement >= 0.0) return;
  point.duu = -point.duu, point.duv = -point.duv, point.dvv = -point.dvv;
}

}  // namespace

LimitSurface::LimitSurface(const Mesh& cage, Scheme scheme, const std::string& file) {
  const CleanCage clean = clean_cage(cage, scheme, file);
  auto data = std::make_shared<LimitSurfaceData>();
  data->scheme = scheme;
  data->holes = cage.holes;
  data->refiner = make_refiner(clean.mesh, scheme, file);
  Bfr::SurfaceFactory::Options options;
  options.SetApproxLevelSmooth(kSmoothLevels).SetApproxLevelSharp(kSharpLevels);
  data->factory = std::make_unique<Bfr::RefinerSurfaceFactory<>>(*data->refiner, options);
  data->surfaces.resize(cage.face_count());
  data->patch_points.resize(cage.face_count());
  data->face_sizes.assign(cage.face_sizes.begin(), cage.face_sizes.end());
  static_assert(sizeof(glm::dvec3) == 3 * sizeof(double));
  const double* mesh_points = &clean.mesh.positions[0].x;
  for (size_t f = 0; f < clean.face_of.size(); ++f) {
    const auto face = static_cast<size_t>(clean.face_of[f]);
    // Of a face that was cut in two the first piece stands for it.
    if (data->surfaces[face].IsValid() || !simple_neighbourhood(data->refiner->GetLevel(0), static_cast<int>(f))) continue;
    Bfr::Surface<double>& surface = data->surfaces[face];
    if (!data->factory->InitVertexSurface(static_cast<int>(f), &surface)) continue;
    data->face_sizes[face] = surface.GetFaceSize();
    data->patch_points[face].resize(3 * static_cast<size_t>(surface.GetNumPatchPoints()));
    surface.PreparePatchPoints(mesh_points, 3, data->patch_points[face].data(), 3);
  }
  data_ = std::move(data);
}

int LimitSurface::face_count() const { return static_cast<int>(data_->surfaces.size()); }

bool LimitSurface::is_hole(int face) const {
  LIMN_CHECK(face >= 0 && face < face_count());
  return std::binary_search(data_->holes.begin(), data_->holes.end(), face);
}

int LimitSurface::face_size(int face) const {
  LIMN_CHECK(face >= 0 && face < face_count());
  return data_->face_sizes[static_cast<size_t>(face)];
}

bool LimitSurface::has_sub_faces(int face) const {
  LIMN_CHECK(face >= 0 && face < face_count());
  const Bfr::Surface<double>& surface = data_->surfaces[static_cast<size_t>(face)];
  return surface.IsValid() && surface.GetParameterization().HasSubFaces();
}

bool LimitSurface::evaluate(int face, int sub_face, double u, double v, LimitPoint& out) const {
  LIMN_CHECK(face >= 0 && face < face_count());
  const Bfr::Surface<double>& surface = data_->surfaces[static_cast<size_t>(face)];
  if (!surface.IsValid()) return false;
  const Bfr::Parameterization parameters = surface.GetParameterization();
  double uv[2] = {u, v};
  double scale = 1.0;
  if (parameters.HasSubFaces()) {
    if (sub_face < 0 || sub_face >= parameters.GetFaceSize()) return false;
    const double normalized[2] = {u, v};
    parameters.ConvertNormalizedSubFaceToCoord(sub_face, normalized, uv);
    scale = 0.5;  // A sub-quad is half a unit wide in its face's coordinates.
  }
  surface.Evaluate(uv, data_->patch_points[static_cast<size_t>(face)].data(), 3, &out.position.x, &out.du.x, &out.dv.x, &out.duu.x,
                   &out.duv.x, &out.dvv.x);
  if (data_->scheme == Scheme::loop) mend_sign(surface, data_->patch_points[static_cast<size_t>(face)].data(), uv[0], uv[1], out);
  out.du *= scale, out.dv *= scale;
  out.duu *= scale * scale, out.duv *= scale * scale, out.dvv *= scale * scale;
  return true;
}

}  // namespace limn
