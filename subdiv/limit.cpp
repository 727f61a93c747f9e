#include <algorithm>

#include "sdf/error.h"
#include "subdiv/opensubdiv_cage.h"
#include "subdiv/opensubdiv_cells.h"

namespace limn {

/// Faces in the given cage's numbering; after them the second and further pieces of faces that pass a vertex twice.
struct LimitSurfaceData {
  std::unique_ptr<Far::TopologyRefiner> refiner;
  std::unique_ptr<Bfr::RefinerSurfaceFactory<>> factory;
  std::vector<LimitCell> cells;
  std::vector<int> face_sizes;
  std::vector<char> holes;
  Scheme scheme = Scheme::catmark;
};

namespace {

/// Where each face of a clean cage goes: the first piece of a face stands for it, others follow after all faces.
std::vector<size_t> places_of(const CleanCage& clean, size_t faces) {
  std::vector<char> taken(faces, 0);
  std::vector<size_t> places;
  for (const std::int32_t face : clean.face_of) {
    char& here = taken[static_cast<size_t>(face)];
    places.push_back(here ? faces++ : static_cast<size_t>(face));
    here = 1;
  }
  return places;
}

bool touches_other_sheets(const Far::TopologyLevel& level, int face) {
  const Far::ConstIndexArray corners = level.GetFaceVertices(face), edges = level.GetFaceEdges(face);
  return std::any_of(corners.begin(), corners.end(), [&](int v) { return level.IsVertexNonManifold(v); }) ||
         std::any_of(edges.begin(), edges.end(), [&](int e) { return level.IsEdgeInfSharp(e) && !level.IsEdgeBoundary(e); });
}

/// What Bfr can gather as it is, all else in parts; sheets that hang together by more than an edge with two faces are parted first.
LimitCell cell_of(const LimitSurfaceData& data, const Mesh& clean, int face, std::optional<SeparatedCage>& separated) {
  const Far::TopologyLevel& level = data.refiner->GetLevel(0);
  LimitCell cell;
  cell.corners = clean.face_sizes[static_cast<size_t>(face)];
  if (simple_neighbourhood(level, face)) {
    cell.patch = make_patch(*data.factory, face, clean.positions);
    return cell;
  }
  // Bilinear faces depend on their own corners alone.
  if (data.scheme == Scheme::bilinear || !touches_other_sheets(level, face)) return make_cell(*data.refiner, clean, data.scheme, face);
  if (!separated) separated = separate_sheets(level, clean, data.scheme);
  const bool same = separated->same_limit[static_cast<size_t>(face)] != 0;
  return make_cell(same ? *separated->refiner : *data.refiner, same ? separated->mesh : clean, data.scheme, face);
}

}  // namespace

LimitSurface::LimitSurface(const Mesh& cage, Scheme scheme, const std::string& file) {
  const CleanCage clean = clean_cage(cage, scheme, file);
  auto data = std::make_shared<LimitSurfaceData>();
  data->scheme = scheme;
  data->refiner = make_refiner(clean.mesh, scheme, file);
  data->factory = std::make_unique<Bfr::RefinerSurfaceFactory<>>(*data->refiner, patch_options());
  const std::vector<size_t> places = places_of(clean, cage.face_count());
  const size_t count = std::max(cage.face_count(), places.empty() ? 0 : *std::max_element(places.begin(), places.end()) + 1);
  data->cells.resize(count);
  data->face_sizes.assign(cage.face_sizes.begin(), cage.face_sizes.end());
  data->face_sizes.resize(count, 0);
  // What a clean cage has not (collapsed faces, copies) is no part of the surface.
  data->holes.assign(count, 1);
  std::optional<SeparatedCage> separated;
  for (size_t f = 0; f < places.size(); ++f) {
    const size_t at = places[f];
    data->face_sizes[at] = clean.mesh.face_sizes[f];
    data->holes[at] = data->refiner->GetLevel(0).IsFaceHole(static_cast<int>(f));
    if (!data->holes[at]) data->cells[at] = cell_of(*data, clean.mesh, static_cast<int>(f), separated);
  }
  data_ = std::move(data);
}

int LimitSurface::face_count() const { return static_cast<int>(data_->cells.size()); }

bool LimitSurface::is_hole(int face) const {
  LIMN_CHECK(face >= 0 && face < face_count());
  return data_->holes[static_cast<size_t>(face)] != 0;
}

int LimitSurface::face_size(int face) const {
  LIMN_CHECK(face >= 0 && face < face_count());
  return data_->face_sizes[static_cast<size_t>(face)];
}

bool LimitSurface::has_sub_faces(int face) const {
  LIMN_CHECK(face >= 0 && face < face_count());
  const LimitCell& cell = data_->cells[static_cast<size_t>(face)];
  return data_->scheme != Scheme::loop && cell.corners != 4 && cell.valid();
}

bool LimitSurface::is_tip(int face, int sub_face, int corner) const {
  LIMN_CHECK(face >= 0 && face < face_count());
  const LimitCell& cell = data_->cells[static_cast<size_t>(face)];
  return data_->scheme == Scheme::catmark && cell.valid() && has_tip(cell, sub_face, corner);
}

bool LimitSurface::evaluate(int face, int sub_face, double u, double v, LimitPoint& out, LimitOrder order) const {
  LIMN_CHECK(face >= 0 && face < face_count());
  return evaluate_cell(data_->cells[static_cast<size_t>(face)], data_->scheme, sub_face, u, v, order, out);
}

}  // namespace limn
