// Vertices and edges of the view graph.

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "raymarch/lines/graph_building.h"
#include "sdf/parallel.h"
#include "sdf/segment.h"

namespace limn {
namespace {

constexpr double kDepthShare = 0.02;    // of an error across the picture is one along the line of sight, px
constexpr double kSamePlace_px = 0.05;  // between ends of curves that meet, along the surface
constexpr double kSnap_px = 5.0;        // between a contour's end and the joint it leads to, along the crease
constexpr double kOnStep_px = 0.1;      // and across it

/// Places by cells, so that each finds its neighbours in constant time.
class PlaceIndex {
 public:
  explicit PlaceIndex(double cell) : cell_(cell) {}
  void add(const glm::dvec3& p, int value) { cells_[key(cell_of(p))].push_back({p, value}); }
  /// The value at the nearest place within `reach` (at most the cell's side), or -1.
  int nearest(const glm::dvec3& p, double reach) const {
    int best = -1;
    const glm::ivec3 middle = cell_of(p);
    for (int i = 0; i < 27; ++i) {
      const auto at = cells_.find(key(middle + glm::ivec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)));
      if (at == cells_.end()) continue;
      for (const auto& [q, value] : at->second) {
        if (const double apart = glm::distance(p, q); apart <= reach) {
          reach = apart;
          best = value;
        }
      }
    }
    return best;
  }

 private:
  glm::ivec3 cell_of(const glm::dvec3& p) const { return glm::ivec3(glm::floor(p / cell_)); }
  static std::uint64_t key(const glm::ivec3& c) {
    const auto u = [](int x) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)); };
    return u(c.x) * 0x9e3779b97f4a7c15u ^ u(c.y) * 0xc2b2ae3d27d4eb4fu ^ u(c.z) * 0x165667b19e3779f9u;
  }
  double cell_;
  std::unordered_map<std::uint64_t, std::vector<std::pair<glm::dvec3, int>>> cells_;
};

/// World units of a pixel where the nearest of the curves runs; the middle of what is seen elsewhere.
double pixel_size(const std::vector<SurfaceCurve>& curves, const Camera& camera) {
  const double unseen = std::numeric_limits<double>::infinity();
  const auto of_curves = [&](const IndexRange<size_t>& range, double least) {
    for (size_t c = range.begin(); c < range.end(); ++c) {
      for (const CurveSample& sample : curves[c].samples) {
        if (sample.depth > 0.0) least = std::min(least, 1.0 / pixels_per_unit_at(camera, sample.depth));
      }
    }
    return least;
  };
  const double least =
      parallel_reduce(curves.size(), size_t{1}, unseen, of_curves, [](double one, double other) { return std::min(one, other); });
  return std::isfinite(least) ? least : 1.0;
}

LinePoint line_point(const CurveSample& sample, const glm::dvec3& origin) {
  return {sample.px, sample.depth, sample.p + origin, sample.high, sample.radial_curvature};
}

double distance_to_chord(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b) {
  const glm::dvec3 along = b - a;
  const double length2 = glm::dot(along, along);
  const double t = length2 > 0.0 ? std::clamp(glm::dot(p - a, along) / length2, 0.0, 1.0) : 0.0;
  return glm::distance(p, a + t * along);
}

/// Marks what is kept between px[first] and px[last]: Douglas & Peucker 1973.
void keep_between(const std::vector<glm::dvec3>& px, size_t first, size_t last, double tolerance_px, std::vector<bool>& keep) {
  std::vector<std::pair<size_t, size_t>> stack = {{first, last}};
  while (!stack.empty()) {
    const auto [low, high] = stack.back();
    stack.pop_back();
    if (high - low < 2) continue;
    size_t farthest = low;
    double most = tolerance_px;
    for (size_t i = low + 1; i < high; ++i) {
      const double distance = distance_to_chord(px[i], px[low], px[high]);
      if (distance > most) {
        most = distance;
        farthest = i;
      }
    }
    if (farthest == low) continue;
    keep[farthest] = true;
    stack.push_back({low, farthest});
    stack.push_back({farthest, high});
  }
}

std::vector<bool> kept_by_thinning(const std::vector<glm::dvec3>& px, bool closed, double tolerance_px) {
  std::vector<bool> keep(px.size(), false);
  keep.front() = keep.back() = true;
  if (closed && px.size() > 3) {
    // A closed curve has no chord from its first to its last point: it is halved first.
    keep[px.size() / 2] = true;
    keep_between(px, 0, px.size() / 2, tolerance_px, keep);
    keep_between(px, px.size() / 2, px.size() - 1, tolerance_px, keep);
  } else {
    keep_between(px, 0, px.size() - 1, tolerance_px, keep);
  }
  return keep;
}

double last_place(const SurfaceCurve& curve) {
  return curve.closed ? std::numeric_limits<double>::infinity() : static_cast<double>(curve.samples.size() - 1);
}

/// The points of an edge, as few as the tolerance allows, in the order of the curve. `at_events`: the curve's samples there.
std::vector<LinePoint> points_of_piece(const SurfaceCurve& curve, const CurvePiece& piece, const std::vector<CurveSample>& at_events,
                                       const LineTask& task) {
  const size_t n = curve.samples.size();
  const auto sample_of = [&](int event, double place) {
    return event >= 0 ? at_events[static_cast<size_t>(event)] : sample_at(curve, std::min(place, last_place(curve)), task.camera);
  };
  const CurveSample first = sample_of(piece.begin, piece.from), last = sample_of(piece.end, piece.to);
  std::vector<const CurveSample*> samples{&first};
  for (double place = std::floor(piece.from) + 1.0; place < piece.to; place += 1.0)
    samples.push_back(&curve.samples[static_cast<size_t>(place) % n]);
  samples.push_back(&last);
  // Image points and depths: chords keep near the curve along the lines of sight too, where it is seen end on.
  const double per_unit = kDepthShare * pixels_per_unit_at(task.camera, std::max(first.depth, 1e-9));
  std::vector<glm::dvec3> px;
  px.reserve(samples.size());
  for (const CurveSample* sample : samples) px.emplace_back(sample->px, per_unit * sample->depth);
  const std::vector<bool> keep = kept_by_thinning(px, piece.begin < 0, 0.5 * task.settings.tolerance_px);
  std::vector<LinePoint> points;
  for (size_t i = 0; i < samples.size(); ++i) {
    if (keep[i]) points.push_back(line_point(*samples[i], task.origin));
  }
  if (piece.begin < 0 && points.size() > 2) points.pop_back();  // The first again.
  return points;
}

/// Where an event of a curve is, and the vertex that it became.
struct EventPlace {
  glm::dvec3 p{0.0};
  glm::dvec2 px{0.0};
  double depth = 0.0;
  int vertex = -1;
};

/// A piece as it is drawn.
struct DrawnPiece {
  bool wanted = false;
  bool turned = false;  ///< Against the order of the curve.
  LineClass line_class = LineClass::contour;
  int object = 1;
  std::vector<LinePoint> points{};
};
/// What takes the curves' own points, from many threads.
struct CurveParts {
  std::vector<EventPlace> events{};
  std::vector<DrawnPiece> pieces{};
};
DrawnPiece drawn_piece(const SurfaceCurve& curve, const CurvePiece& piece, const std::vector<CurveSample>& at_events,
                       const LineTask& task) {
  const CurveSample& step = curve.samples[static_cast<size_t>(piece.from) % curve.samples.size()];
  if (!task.wants(step.line_class)) return {};
  DrawnPiece drawn{true, step.more_on_left < 0, step.line_class, step.object, points_of_piece(curve, piece, at_events, task)};
  if (drawn.turned) std::reverse(drawn.points.begin(), drawn.points.end());
  return drawn;
}
CurveParts parts_of(const SurfaceCurve& curve, const CutCurve& cut, const LineTask& task) {
  CurveParts parts;
  std::vector<CurveSample> samples;
  samples.reserve(cut.events.size());
  parts.events.reserve(cut.events.size());
  parts.pieces.reserve(cut.pieces.size());
  for (const CurveEvent& event : cut.events) {
    const CurveSample& sample = samples.emplace_back(sample_at(curve, std::min(event.at, last_place(curve)), task.camera));
    parts.events.push_back({sample.p, sample.px, sample.depth});
  }
  for (const CurvePiece& piece : cut.pieces) parts.pieces.push_back(drawn_piece(curve, piece, samples, task));
  return parts;
}

/// The last piece that a place lies on, or none. Of a closed curve the last one may go on past its first sample.
std::optional<size_t> piece_at(const std::vector<CurvePiece>& pieces, double place, double steps) {
  if (pieces.empty()) return {};
  if (place + steps <= pieces.back().to) return pieces.size() - 1;
  const auto next =
      std::upper_bound(pieces.begin(), pieces.end(), place, [](double at, const CurvePiece& piece) { return at < piece.from; });
  if (next == pieces.begin() || place > (next - 1)->to) return {};
  return static_cast<size_t>(next - pieces.begin()) - 1;
}

struct Builder {
  const std::vector<SurfaceCurve>& curves;
  const CutCurves& cut;
  const LineTask& task;
  ViewGraph& graph;
  double pixel;
  PlaceIndex places;
  std::vector<CurveParts> parts;
  const Camera& camera = task.camera;

  int vertex(std::uint32_t c, int event) {
    const CurveEvent& at = cut.curves[c].events[static_cast<size_t>(event)];
    EventPlace& here = parts[c].events[static_cast<size_t>(event)];
    if (here.vertex >= 0) return here.vertex;
    const bool shared = at.kind == VertexKind::end || at.kind == VertexKind::joint;
    if (shared) {
      const double reach = kSamePlace_px * std::max(pixel, 1.0 / pixels_per_unit_at(camera, std::max(here.depth, 1e-9)));
      here.vertex = places.nearest(here.p, reach);
      if (here.vertex >= 0) {
        graph.vertices[static_cast<size_t>(here.vertex)].kind = VertexKind::joint;
        return here.vertex;
      }
    }
    here.vertex = static_cast<int>(graph.vertices.size());
    graph.vertices.push_back({at.kind, here.px, here.depth, -1});
    if (shared) places.add(here.p, here.vertex);
    return here.vertex;
  }
  /// The new edge's index; -1 where its class is not wanted.
  int add_edge(const CurvePiece& piece, DrawnPiece drawn) {
    if (!drawn.wanted) return -1;
    const bool sharp = !curves[piece.curve].smooth;
    LineEdge edge{drawn.line_class,       drawn.object, piece.invisibility, piece.certain, sharp, static_cast<int>(piece.curve), -1, -1,
                  std::move(drawn.points)};
    if (piece.begin >= 0) edge.begin = vertex(piece.curve, piece.begin);
    if (piece.end >= 0) edge.end = vertex(piece.curve, piece.end);
    if (drawn.turned) std::swap(edge.begin, edge.end);
    graph.edges.push_back(std::move(edge));
    return static_cast<int>(graph.edges.size()) - 1;
  }
};

}  // namespace

void snap_joints(std::vector<SurfaceCurve>& curves, const Camera& camera) {
  const double pixel = pixel_size(curves, camera);
  PlaceIndex ends(kSnap_px * pixel);
  std::vector<CurveSample> samples;
  for (const SurfaceCurve& curve : curves) {
    if (!curve.smooth || curve.closed) continue;
    for (const CurveSample* end : {&curve.samples.front(), &curve.samples.back()}) {
      ends.add(end->p, static_cast<int>(samples.size()));
      samples.push_back(*end);
    }
  }
  for (SurfaceCurve& curve : curves) {
    if (curve.smooth) continue;
    const size_t n = curve.samples.size();
    for (size_t i = 0; i < n; ++i) {
      CurveSample& sample = curve.samples[i];
      if (!sample.joint || (!curve.closed && (i == 0 || i + 1 == n))) continue;
      // Contours go on past a line of materials on smooth surface: an end near by is that on an edge beyond.
      if (sample.line_class == LineClass::material && sample.high == sample.low) continue;
      const int end = ends.nearest(sample.p, kSnap_px * pixel);
      if (end < 0) continue;
      // It is the end on this step, not one of a neighbour's.
      const glm::dvec3 &before = curve.samples[(i + n - 1) % n].p, &after = curve.samples[(i + 1) % n].p;
      if (distance_to_segment(samples[static_cast<size_t>(end)].p, before, after) > kOnStep_px * pixel) continue;
      sample.p = samples[static_cast<size_t>(end)].p;
      sample.px = samples[static_cast<size_t>(end)].px;
      sample.depth = samples[static_cast<size_t>(end)].depth;
    }
  }
}

void add_edges(const std::vector<SurfaceCurve>& curves, const CutCurves& cut, const LineTask& task, ViewGraph& graph) {
  const double pixel = pixel_size(curves, task.camera);
  Builder builder{curves, cut, task, graph, pixel, PlaceIndex(16.0 * kSamePlace_px * pixel), std::vector<CurveParts>(curves.size())};
  std::vector<std::vector<int>> edge_of(curves.size());
  parallel_for(size_t{0}, curves.size(), [&](size_t c) { builder.parts[c] = parts_of(curves[c], cut.curves[c], task); });
  size_t pieces_of_all = 0, events_of_all = 0;
  for (const CutCurve& of_curve : cut.curves) pieces_of_all += of_curve.pieces.size(), events_of_all += of_curve.events.size();
  graph.edges.reserve(graph.edges.size() + pieces_of_all);
  graph.vertices.reserve(graph.vertices.size() + events_of_all);
  for (size_t c = 0; c < curves.size(); ++c) {
    const std::vector<CurvePiece>& pieces = cut.curves[c].pieces;
    for (size_t k = 0; k < pieces.size(); ++k) edge_of[c].push_back(builder.add_edge(pieces[k], std::move(builder.parts[c].pieces[k])));
  }
  parallel_for(size_t{0}, curves.size(), [&](size_t c) {
    for (size_t k = 0; k < cut.curves[c].events.size(); ++k) {
      const CurveEvent& event = cut.curves[c].events[k];
      const int vertex = builder.parts[c].events[k].vertex;
      if (vertex < 0 || event.kind != VertexKind::crossing) continue;
      const auto steps = static_cast<double>(curves[event.nearer].samples.size());
      if (const auto piece = piece_at(cut.curves[event.nearer].pieces, event.on_nearer, steps))
        graph.vertices[static_cast<size_t>(vertex)].crossed_by = edge_of[event.nearer][*piece];
    }
  });
}

}  // namespace limn
