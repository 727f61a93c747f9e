#include "subdiv/tessellate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <optional>

#include "sdf/memory_text.h"
#include "sdf/size_error.h"
#include "subdiv/dual_contour.h"
#include "subdiv/local_field.h"
#include "subdiv/polygon.h"
#include "subdiv/surface_snap.h"

namespace limn {
namespace {

/// Cells along the longest side, tried in turn. Finer than the last the cage would have more faces than a surface needs to start from.
constexpr std::array kCells = {8, 12, 16, 24, 32, 48, 64, 96, 128};

struct Cage {
  Mesh mesh;
  SnapResult snapped;
};

Cage snapped_cage(const Field& field, Mesh mesh) {
  Cage cage{std::move(mesh), {}};
  cage.snapped = snap_to_surface(field, cage.mesh);
  relax(field, cage.mesh, cage.snapped, 2);
  // Neighbours that have moved show a vertex more sides: one beside a corner of three faces may have seen only two of them.
  for (int round = 0; round < 2; ++round) cage.snapped = snap_to_surface(field, cage.mesh);
  unfold(field, cage.mesh, cage.snapped, 12);
  return cage;
}

/// One refinement, its vertices on the surface. The scheme's topology with vertices half way between their neighbours; where they belong
/// the field says.
Cage refined_once(const Field& field, const Mesh& mesh, std::int64_t max_bytes) {
  Cage finer{refine(mesh, {Scheme::bilinear, 1, false, NormalKind::flat, max_bytes}), {}};
  finer.snapped = snap_to_surface(field, finer.mesh);
  unfold(field, finer.mesh, finer.snapped, 8);
  return finer;
}

/// Faces whose middle lies off the surface by more than this share of their edges, and vertices by more than a thousandth of the radius:
/// there the mesh goes across what it should go around.
constexpr double kFarFace = 0.25, kFarVertex = 1e-3;

size_t count_of(const std::vector<char>& marked) { return static_cast<size_t>(std::count(marked.begin(), marked.end(), char{1})); }

size_t count_far_vertices(const Field& field, const Mesh& mesh) {
  const double most = kFarVertex * field.traits().bounds.radius();
  std::vector<char> far(mesh.vertex_count(), 0);
  visit_groups(field, mesh.positions, most, [&](LocalField& local, std::span<const std::uint32_t> members) {
    const std::vector<double> off = local.distances_off(members_of(mesh.positions, members));
    for (size_t i = 0; i < members.size(); ++i) far[members[i]] = off[i] > most;
  });
  return count_of(far);
}

double mean_edge(const std::vector<glm::dvec3>& corners) {
  double sum = 0.0;
  for (size_t i = 0; i < corners.size(); ++i) sum += glm::distance(corners[i], corners[(i + 1) % corners.size()]);
  return sum / static_cast<double>(corners.size());
}

size_t count_far_faces(const Field& field, const Mesh& mesh) {
  const std::vector<std::int32_t> first = first_corners(mesh);
  const FaceMiddles faces(mesh, first);
  std::vector<char> far(mesh.face_count(), 0);
  visit_groups(field, faces.middles, 0.0, [&](LocalField& local, std::span<const std::uint32_t> members) {
    std::vector<glm::dvec3> corners;
    const std::vector<double> off = local.distances_off(members_of(faces.middles, members));
    for (size_t i = 0; i < members.size(); ++i) {
      const std::uint32_t f = members[i];
      gather_corners(mesh, face_corners(mesh, first[f], f), corners);
      far[f] = off[i] > kFarFace * mean_edge(corners);
    }
  });
  return count_of(far);
}

/// Where walls run out to nothing some faces are bad whatever the sampling: so many are accepted, since finer samplings only make the cage
/// larger.
constexpr double kBadShare = 1.0 / 500.0;
/// Samplings tried once a topology is confirmed.
constexpr int kMostTried = 3;

/// A cage, and what it was judged by.
struct JudgedCage {
  Cage cage{};
  std::optional<Cage> finer{};  ///< Refined once; nothing where it was bad before.
  /// The share of faces that lie the wrong way up or off the surface, now or after that refinement: walls thinner than an edge, and holes
  /// narrower than a face, show themselves there.
  double bad_share = 0.0;
};

JudgedCage judged(const Field& field, Cage cage) {
  const auto share = [](size_t count, const Mesh& mesh) { return static_cast<double>(count) / static_cast<double>(mesh.face_count()); };
  const double now = share(folded_faces(field, cage.mesh).size() + count_far_vertices(field, cage.mesh), cage.mesh);
  // No refinement mends what is this bad.
  if (now > 2.0 * kBadShare) return {std::move(cage), {}, now};
  Cage finer = refined_once(field, cage.mesh, std::int64_t{8} << 30);
  const double then = share(folded_faces(field, finer.mesh).size() + count_far_faces(field, finer.mesh), finer.mesh);
  return {std::move(cage), std::move(finer), std::max(now, then)};
}

/// What lattices gave.
struct CageSearch {
  std::optional<JudgedCage> best{};  ///< Of those whose topology a neighbouring lattice confirms.
  Mesh last{};                       ///< Of the finest lattice; without faces where it is not closed.
};

/// The coarsest lattice whose topology a neighbouring one confirms and whose faces lie on the surface, the right way up; failing that, the
/// best met.
CageSearch search_cage(const Field& field, ThinWalls thin_walls) {
  CageSearch search;
  Mesh previous;
  std::optional<Topology> previous_topology;
  int tried = 0;
  for (const int cells : kCells) {
    Mesh mesh = dual_contour(field, cells, thin_walls);
    const std::optional<Topology> topology = topology_of(mesh);
    if (topology && topology == previous_topology) {
      for (const Mesh* candidate : {&previous, &mesh}) {
        JudgedCage cage = judged(field, snapped_cage(field, *candidate));
        if (!search.best || cage.bad_share < search.best->bad_share) search.best = std::move(cage);
        if (search.best->bad_share <= kBadShare) return search;
      }
      if (++tried == kMostTried) return search;
    }
    previous = std::move(mesh);
    previous_topology = topology;
  }
  if (previous_topology) search.last = std::move(previous);
  return search;
}

JudgedCage find_cage(const Field& field) {
  const Box& box = field.traits().bounds;
  if (box.empty()) throw InputError({"", "shape", "", "the surface is empty: there is nothing to tessellate", "a shape with a surface"});
  if (!box.finite())
    throw InputError({"", "shape", "", "an unbounded surface cannot be tessellated", "a bounded shape, or its intersection with one"});
  CageSearch search = search_cage(field, ThinWalls::kept);
  // Where walls are too thin and too many for all samplings, a surface without them is better than none.
  if (!search.best) {
    CageSearch without = search_cage(field, ThinWalls::lost);
    if (without.best || search.last.face_sizes.empty()) search = std::move(without);
  }
  if (search.best) return std::move(*search.best);
  if (search.last.face_sizes.empty())
    throw InputError({"", "shape", "", fmt::format("no closed surface was found with {} cells along its longest side", kCells.back()),
                      "a shape without details thinner than that, or the surface kind level_set"});
  return {snapped_cage(field, std::move(search.last)), {}, 0.0};
}

}  // namespace

struct FieldCage {
  Cage cage{};
  double found_ms = 0.0;
  std::shared_ptr<const FieldCage> finer{};  ///< Refined once, where finding it took that already.
};

namespace {

template <class Make>
std::shared_ptr<const FieldCage> timed(const Make& make) {
  const auto start = std::chrono::steady_clock::now();
  FieldCage cage = make();
  cage.found_ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return std::make_shared<const FieldCage>(std::move(cage));
}

/// Of a refinement that is kept, as predicted; finer ones are made anew from the finest that is.
constexpr std::int64_t kMostKeptBytes = std::int64_t{64} << 20;

std::shared_ptr<const FieldCage> refined_once(const Field& field, const FieldCage& cage, std::int64_t max_bytes) {
  if (cage.finer) return cage.finer;
  return timed([&] { return FieldCage{.cage = refined_once(field, cage.cage.mesh, max_bytes)}; });
}

/// Refined as often as its level says, from the finest that is kept.
Cage refined(const Field& field, std::shared_ptr<const FieldCage> cage, const TessellateSettings& settings) {
  int level = 0;
  if (settings.refinements != nullptr) {
    FieldCages& kept = *settings.refinements;
    while (static_cast<int>(kept.size()) < settings.level &&
           predict_refined_size(cage->cage.mesh, Scheme::bilinear, static_cast<int>(kept.size()) + 1).bytes <= kMostKeptBytes)
      kept.push_back(refined_once(field, kept.empty() ? *cage : *kept.back(), settings.max_bytes));
    level = std::min(settings.level, static_cast<int>(kept.size()));
    if (level > 0) cage = kept[static_cast<size_t>(level) - 1];
  }
  if (level == settings.level) return cage->cage;
  Cage result = cage->finer ? cage->finer->cage : refined_once(field, cage->cage.mesh, settings.max_bytes);
  for (++level; level < settings.level; ++level) result = refined_once(field, result.mesh, settings.max_bytes);
  return result;
}

}  // namespace

std::shared_ptr<const FieldCage> find_field_cage(const Field& field) {
  return timed([&] {
    JudgedCage found = find_cage(field);
    FieldCage cage{.cage = std::move(found.cage)};
    if (found.finer && predict_refined_size(cage.cage.mesh, Scheme::bilinear, 1).bytes <= kMostKeptBytes)
      cage.finer = std::make_shared<const FieldCage>(FieldCage{.cage = std::move(*found.finer)});
    return cage;
  });
}

double time_to_find_ms(const FieldCage& cage) { return cage.found_ms; }

const Mesh& mesh_of(const FieldCage& cage) { return cage.cage.mesh; }

Mesh cage_of(const Field& field) { return find_cage(field).cage.mesh; }

Mesh tessellate(const Field& field, const TessellateSettings& settings) {
  if (settings.level < 0 || settings.level > 8)
    throw InputError({"", "level", fmt::format("{}", settings.level), "the subdivision level is out of range", "0 to 8"});
  const std::shared_ptr<const FieldCage> found = settings.cage ? settings.cage : find_field_cage(field);
  const RefinedSize size = predict_refined_size(found->cage.mesh, Scheme::bilinear, settings.level);
  if (size.bytes > settings.max_bytes)
    throw SizeError({"", "level", fmt::format("{}", settings.level),
                     fmt::format("the mesh has {} faces and needs {}", size.faces, memory_text(static_cast<double>(size.bytes))),
                     fmt::format("a lower level (at most {})", memory_text(static_cast<double>(settings.max_bytes)))});
  Cage cage = refined(field, found, settings);
  follow_creases(field, cage.mesh, cage.snapped);
  turn_quads_along_creases(field, cage.mesh, cage.snapped.feature);
  split_quads_along_creases(field, cage.mesh, cage.snapped.feature);
  if (settings.normals == NormalKind::limit) cage.mesh.corner_normals = field_normals(field, cage.mesh, cage.snapped.feature);
  return std::move(cage.mesh);
}

}  // namespace limn
