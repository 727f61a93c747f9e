#include "raymarch/truth/marching_tetrahedra.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

namespace limn {
namespace {

constexpr std::array<std::array<int, 4>, 6> kTetrahedra = {
    {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}}};
constexpr size_t kEdges = 19;  // of the tetrahedra: 12 of the cell, a diagonal of each face, and that of the cell
// A share of the step across a face: points that Newton moves farther would change places with their neighbours.
constexpr double kSmoothReach = 0.25;
constexpr int kSeamSteps = 40;
constexpr double kSeedOff = 0.01;  // of an edge, and of the reach of Newton's iteration
constexpr int kSeedSteps = 4;

glm::ivec3 offset_of(int corner) { return {corner & 1, corner >> 1 & 1, corner >> 2 & 1}; }

/// Above 0.
std::uint64_t key_of_vertex(const glm::ivec3& vertex) {
  const auto part = [](int v) { return static_cast<std::uint64_t>(v); };
  return (((part(vertex.x) << 20 | part(vertex.y)) << 20 | part(vertex.z)) << 3) + 1;
}

struct FaceCrossing {
  std::uint64_t key = 0;
  bool crossed = false;
};

class Marcher {
 public:
  /// With `seam`, it is that field's zeros that are looked for instead of N.V's levels.
  Marcher(FieldEvaluator& evaluator, FieldEvaluator* seam, const Viewer& viewer, const CellGrid& grid, const glm::ivec3& cell,
          LatticeSamples* samples, const Seeds& seeds)
      : evaluator_(evaluator), seam_(seam), viewer_(viewer), samples_(samples), seeds_(seeds), cell_(cell), side_(grid.side) {
    for (int i = 0; i < 8; ++i) points_[static_cast<size_t>(i)] = grid.vertex(cell + offset_of(i));
    find_values();
    for (size_t i = 0; i < 8; ++i) inside_[i] = values_[i] < 0.0;
    if (seeds_.spline != nullptr && holds_surface()) find_edges(*seeds_.spline);
  }

  bool holds_surface() const { return std::find(inside_.begin(), inside_.end(), !inside_[0]) != inside_.end(); }

  bool march(double level, CellCurves& output) {
    output_ = &output;
    level_ = level;
    faces_.clear();
    if (!turns()) return false;
    bool any = false;
    for (const auto& corners : kTetrahedra) any = march_tetrahedron(corners) || any;
    return any;
  }

 private:
  void find_values() {
    if (seeds_.spline != nullptr) {
      seeds_.spline->read(seeds_.first_node + cell_);
      values_ = seeds_.spline->corner_values();
      return;
    }
    if (samples_ == nullptr) return evaluator_.values(points_, values_);
    std::array<glm::dvec3, 8> points;
    std::array<size_t, 8> corners{};
    size_t missing = 0;
    for (size_t i = 0; i < 8; ++i) {
      bool added = false;
      values_[i] = samples_->values.at(vertex_key(static_cast<int>(i)), added);
      if (!added) continue;
      points[missing] = points_[i];
      corners[missing++] = i;
    }
    if (missing == 0) return;
    std::array<double, 8> values;
    evaluator_.values(std::span(points).first(missing), std::span(values).first(missing));
    bool added = false;
    for (size_t k = 0; k < missing; ++k) {
      values_[corners[k]] = values[k];
      samples_->values.at(vertex_key(static_cast<int>(corners[k])), added) = values[k];
    }
  }

  std::uint64_t vertex_key(int corner) const { return key_of_vertex(cell_ + offset_of(corner)); }

  std::uint64_t edge_key(int low, int high) const { return vertex_key(low) + static_cast<std::uint64_t>(low ^ high); }

  bool in(int corner) const { return inside_[static_cast<size_t>(corner)]; }

  /// Of the places where the surface meets the cell's edges, those of the tetrahedra, some lie above the level and some below.
  bool turns() {
    bool any_above = false, any_below = false;
    for (int low = 0; low < 8; ++low) {
      for (int high = low + 1; high < 8; ++high) {
        if ((low & high) != low || in(low) == in(high)) continue;
        (above(edge(low, high)) ? any_above : any_below) = true;
        if (any_above && any_below) return true;
      }
    }
    return false;
  }

  /// All at once that no other cell has found; what is left edge() finds.
  void find_edges(const SplineCellReader& spline) {
    std::array<CellEdge, kEdges> edges{};
    std::array<EdgePoint, kEdges> points{};
    size_t count = 0;
    for (int low = 0; low < 8; ++low) {
      for (int high = low + 1; high < 8; ++high) {
        if ((low & high) != low || in(low) == in(high)) continue;
        if (const EdgeSample* const known = samples_->edges.find(edge_key(low, high)))
          keep_edge(low, high, *known);
        else
          edges[count++] = {static_cast<std::uint8_t>(low), static_cast<std::uint8_t>(high)};
      }
    }
    spline.find_on_edges(std::span(edges).first(count), kSeedOff, std::span(points).first(count));
    for (size_t k = 0; k < count; ++k) {
      if (!points[k].found) continue;
      const glm::dvec3 &start = points_[edges[k].from], &end = points_[edges[k].to];
      bool added = false;
      EdgeSample& sample = samples_->edges.at(edge_key(edges[k].from, edges[k].to), added);
      sample = {start + points[k].share * (end - start), points[k].gradient};
      keep_edge(edges[k].from, edges[k].to, sample);
    }
  }
  std::uint8_t& place_of_edge(int low, int high) {
    const int place = 8 * low + high;
    return edges_[static_cast<size_t>(place)];
  }
  void keep_edge(int low, int high, const EdgeSample& sample) {
    found_[edges_found_] = {sample.p, sample.gradient, facing(sample.p, sample.gradient)};
    place_of_edge(low, high) = static_cast<std::uint8_t>(++edges_found_);
  }

  /// The surface on the edge between two corners on different sides, always found from the lower corner.
  const SurfaceSample& edge(int a, int b) {
    const auto low = static_cast<size_t>(std::min(a, b)), high = static_cast<size_t>(std::max(a, b));
    std::uint8_t& place = place_of_edge(static_cast<int>(low), static_cast<int>(high));
    if (place != 0) return found_[place - size_t{1}];
    place = static_cast<std::uint8_t>(++edges_found_);
    SurfaceSample& sample = found_[place - size_t{1}];
    const auto find = [&] {
      if (seeds_.wanted) return seed_on_edge(low, high);
      return sample_at(root_between(evaluator_, points_[low], points_[high], values_[low], values_[high]));
    };
    if (samples_ == nullptr) {
      sample = find();
    } else {
      bool added = false;
      EdgeSample& known = samples_->edges.at(edge_key(std::min(a, b), std::max(a, b)), added);
      if (added) {
        const SurfaceSample found = find();
        known = {found.p, found.gradient};
      }
      sample = {known.p, known.gradient, facing(known.p, known.gradient)};
    }
    return sample;
  }
  /// Within a hundredth of the edge: the curves are followed from points beside them. Newton's iteration, whose last step the gradient is
  /// not taken anew for.
  SurfaceSample seed_on_edge(size_t low, size_t high) {
    const glm::dvec3 start = points_[low], way = points_[high] - start;
    const double a = values_[low], b = values_[high];
    double t = a / (a - b), from = 0.0, to = 1.0;
    for (int step = 0; step < kSeedSteps; ++step) {
      const glm::dvec3 p = start + t * way;
      double value = 0.0;
      glm::dvec3 gradient;
      evaluator_.gradients(std::span(&p, 1), std::span(&value, 1), std::span(&gradient, 1));
      ((value < 0.0) == (a < 0.0) ? from : to) = t;
      const double next = t - value / glm::dot(gradient, way);
      if (!(next >= from && next <= to)) break;
      if (std::fabs(next - t) < kSeedOff) {
        const glm::dvec3 q = start + next * way;
        return {q, gradient, facing_of(viewer_, q, gradient)};
      }
      t = next;
    }
    return sample_at(root_between(evaluator_, start, points_[high], a, b));
  }
  SurfaceSample sample_at(const glm::dvec3& p) {
    if (seam_ != nullptr) return {p, glm::dvec3(0.0), seam_->value(p)};
    return sample_surface(evaluator_, viewer_, p);
  }
  /// Of seeds by one root and one division: this is asked more often than anything.
  double facing(const glm::dvec3& p, const glm::dvec3& gradient) const {
    if (!seeds_.wanted) return facing_of(viewer_, p, gradient);
    const Camera& eye = viewer_.facing;
    const glm::dvec3 way = eye.projection == Projection::perspective ? eye.eye - p : eye.world_from_camera[2];
    const double lengths = glm::dot(gradient, gradient) * glm::dot(way, way);
    return lengths > 0.0 ? glm::dot(gradient, way) / std::sqrt(lengths) : 0.0;
  }
  bool above(const SurfaceSample& sample) const { return !(sample.facing < level_); }

  std::uint64_t key_of(int a, int b, int c) const {
    const glm::ivec3 base = cell_ + offset_of(a);
    const auto part = [](int v) { return static_cast<std::uint64_t>(v); };
    return ((part(base.x) << 19 | part(base.y)) << 19 | part(base.z)) << 6 | part(b ^ a) << 3 | part(c ^ a);
  }

  /// Of a face with its corners in order along the diagonal.
  FaceCrossing face(int a, int b, int c) {
    const bool ia = in(a), ib = in(b), ic = in(c);
    if (ia == ib && ib == ic) return {};
    const int lone = ib == ic ? a : ia == ic ? b : c;
    const int first = lone == a ? b : a, second = lone == c ? b : c;
    const SurfaceSample &start = edge(lone, first), &end = edge(lone, second);
    if (above(start) == above(end)) return {};
    const FaceCrossing result{key_of(a, b, c), true};
    if (is_new(result.key)) output_->crossings.push_back({result.key, locate(lone, first, second, start, end)});
    return result;
  }
  bool is_new(std::uint64_t face) {
    bool added = false;
    if (seeds_.wanted) {
      output_->known.at(face, added);
      return added;
    }
    added = std::find(faces_.begin(), faces_.end(), face) == faces_.end();
    if (added) faces_.push_back(face);
    return added;
  }

  CurvePoint locate(int lone, int first, int second, const SurfaceSample& start, const SurfaceSample& end) {
    const auto at = [&](int corner) { return points_[static_cast<size_t>(corner)]; };
    const Fan fan{at(lone), at(first), at(second) - at(first), values_[static_cast<size_t>(lone)]};
    const double step = glm::length(end.p - start.p);
    if (seam_ != nullptr) return locate_seam(fan, start, end);
    if (seeds_.wanted) {
      if (const auto seed = locate_seed(fan, start, end)) return *seed;
    }
    if (auto point = bisect(evaluator_, viewer_, level_, fan, 0.0, 1.0, start, end, kSmoothReach * step)) return *point;
    CurvePoint point;
    point.p = point_between(start, end);
    if (auto polished = polish(evaluator_, viewer_, level_, point.p, side_)) {
      point = *polished;
    } else {
      point.rough = true;
      point.high = point.low = glm::normalize(start.gradient + end.gradient);
    }
    point.uphill = start.facing > end.facing ? start.p - end.p : end.p - start.p;
    return point;
  }

  glm::dvec3 point_between(const SurfaceSample& start, const SurfaceSample& end) const {
    return glm::mix(start.p, end.p, (level_ - start.facing) / (end.facing - start.facing));
  }

  /// Newton's iteration from between two places on the face. Where the surface turns within the cell only the way along the face leads
  /// onto the curve: then from nearer ones.
  std::optional<CurvePoint> locate_seed(const Fan& fan, SurfaceSample start, SurfaceSample end) {
    double low = 0.0, high = 1.0;
    for (int step = 0; step < kSeedSteps; ++step) {
      if (auto seed = polish(evaluator_, viewer_, level_, point_between(start, end), kSmoothReach * side_, kSeedOff)) return seed;
      const double share = std::clamp((level_ - start.facing) / (end.facing - start.facing), 0.1, 0.9), place = glm::mix(low, high, share);
      const auto middle = fan.at(evaluator_, viewer_, place);
      if (!middle) break;
      const bool as_start = above(*middle) == above(start);
      (as_start ? start : end) = *middle;
      (as_start ? low : high) = place;
    }
    return {};
  }

  /// Along the face: Newton first, false position where that leads away.
  CurvePoint locate_seam(const Fan& fan, const SurfaceSample& start, const SurfaceSample& end) {
    const double step = glm::length(end.p - start.p);
    double low = 0.0, high = 1.0, at_low = start.facing, at_high = end.facing;
    CurvePoint point;
    point.p = start.p + at_low / (at_low - at_high) * (end.p - start.p);
    point.crease = true;
    for (int k = 0; k < kSeamSteps; ++k) {
      if (auto polished = polish_seam(evaluator_, *seam_, point.p, kSmoothReach * step)) return *polished;
      const double middle = k % 2 == 0 ? std::clamp(at_low / (at_low - at_high), 0.05, 0.95) : 0.5, s = glm::mix(low, high, middle);
      const auto sample = fan.at(evaluator_, viewer_, s);
      if (!sample) break;
      point.p = sample->p;
      const double value = seam_->value(point.p);
      const bool as_low = (value < 0.0) == (at_low < 0.0);
      (as_low ? low : high) = s;
      (as_low ? at_low : at_high) = value;
    }
    return point;
  }

  void link(const FaceCrossing& a, const FaceCrossing& b) { output_->links.push_back({a.key, b.key}); }

  bool march_tetrahedron(const std::array<int, 4>& v) {
    const std::array<FaceCrossing, 4> faces = {face(v[1], v[2], v[3]), face(v[0], v[2], v[3]), face(v[0], v[1], v[3]),
                                               face(v[0], v[1], v[2])};  // face i lies opposite corner i
    std::array<size_t, 4> crossed{};
    size_t count = 0;
    for (size_t i = 0; i < 4; ++i) {
      if (faces[i].crossed) crossed[count++] = i;
    }
    if (count == 2) link(faces[crossed[0]], faces[crossed[1]]);
    if (count == 4) link_quad(v, faces);
    return count > 0;
  }

  /// N.V - c changes sign along all four sides of the surface's quad: which two of its corners are cut off, its middle decides.
  void link_quad(const std::array<int, 4>& v, const std::array<FaceCrossing, 4>& faces) {
    size_t b = 1;
    while (in(v[b]) != in(v[0])) ++b;
    const size_t c = b == 1 ? 2 : 1, d = 6 - b - c;
    const auto middle_of = [&](size_t i, size_t j) {
      return 0.5 * (points_[static_cast<size_t>(v[i])] + points_[static_cast<size_t>(v[j])]);
    };
    const glm::dvec3 ab = middle_of(0, b), cd = middle_of(c, d);
    const double f_ab = evaluator_.value(ab), f_cd = evaluator_.value(cd);
    bool middle_above = true;
    if ((f_ab < 0.0) != (f_cd < 0.0)) {
      middle_above = above(sample_at(root_between(evaluator_, ab, cd, f_ab, f_cd)));
    }
    // Corner AC of the quad joins faces ABC (opposite D) and ACD (opposite B).
    const bool cut_ac = above(edge(v[0], v[c])) != middle_above;
    link(faces[d], faces[cut_ac ? b : 0]);
    link(faces[c], faces[cut_ac ? 0 : b]);
  }

  FieldEvaluator& evaluator_;
  FieldEvaluator* seam_;
  const Viewer& viewer_;
  LatticeSamples* samples_;
  Seeds seeds_;
  glm::ivec3 cell_;
  CellCurves* output_ = nullptr;
  double side_;
  double level_ = 0.0;
  std::array<glm::dvec3, 8> points_;
  std::array<double, 8> values_;
  std::array<bool, 8> inside_;
  std::array<std::uint8_t, 64> edges_{};  ///< By both corners: one more than the place in `found_`, or 0.
  std::array<SurfaceSample, kEdges> found_;
  size_t edges_found_ = 0;
  std::vector<std::uint64_t> faces_;
};

}  // namespace

bool march_cell(FieldEvaluator& evaluator, const Viewer& viewer, const CellGrid& grid, const glm::ivec3& cell,
                const std::array<double, kCurveFamilies>& levels, FamilyMask families, LatticeSamples* samples, CellOutput& output,
                const Seeds& seeds) {
  Marcher marcher(evaluator, nullptr, viewer, grid, cell, samples, seeds);
  bool any = false;
  if (marcher.holds_surface()) {
    for (size_t family = 0; family < kCurveFamilies; ++family) {
      if (families >> family & 1u) any = marcher.march(levels[family], output[family]) || any;
    }
  }
  return any;
}

bool march_seam(FieldEvaluator& first, FieldEvaluator& second, const Viewer& viewer, const CellGrid& grid, const glm::ivec3& cell,
                CellCurves& output) {
  Marcher marcher(first, &second, viewer, grid, cell, nullptr, {});
  return marcher.holds_surface() && marcher.march(0.0, output);
}

}  // namespace limn
