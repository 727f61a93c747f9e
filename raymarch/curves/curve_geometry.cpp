#include "raymarch/curves/curve_geometry.h"

#include <algorithm>
#include <cmath>

#include "sdf/segment.h"

namespace limn {
namespace {

glm::dvec2 point_at(const BorderCurve& curve, size_t i) { return curve.points[i % curve.points.size()].px; }

size_t segment_count(const BorderCurve& curve) {
  if (curve.points.size() < 2) return 0;
  return curve.closed ? curve.points.size() : curve.points.size() - 1;
}

/// Unit, from about a pixel before the end towards it: the last segment alone may be too short to have a direction.
glm::dvec2 end_direction(const BorderCurve& curve, bool last) {
  const size_t count = curve.points.size();
  const glm::dvec2 end = curve.points[last ? count - 1 : 0].px;
  for (size_t k = 1; k < count; ++k) {
    const glm::dvec2 to_end = end - curve.points[last ? count - 1 - k : k].px;
    const double length = glm::length(to_end);
    if (length >= 1.0 || (k + 1 == count && length > 0.0)) return to_end / length;
  }
  return glm::dvec2(0.0);
}

/// No less than the square of anything whose root is at most `distance`: most segments are told to be farther without a root.
double square_about(double distance) { return distance * distance * (1.0 + 1e-12); }

}  // namespace

std::vector<BorderSample> resample(const BorderCurves& curves, std::optional<CurveKind> kind, double step_px) {
  std::vector<BorderSample> samples;
  for (size_t c = 0; c < curves.curves.size(); ++c) {
    const BorderCurve& curve = curves.curves[c];
    const double length = length_px(curve);
    if ((kind && curve.kind != *kind) || !(length > 0.0)) continue;
    const auto count = static_cast<size_t>(std::max(1.0, std::round(length / step_px)));
    const double piece = length / static_cast<double>(count);
    double before = 0.0;
    size_t k = 0;
    for (size_t i = 0; i < segment_count(curve) && k < count; ++i) {
      const glm::dvec2 a = point_at(curve, i), along = point_at(curve, i + 1) - a;
      const double own = glm::length(along);
      const bool final = i + 1 == segment_count(curve);
      for (; k < count && own > 0.0; ++k) {
        const double at = (static_cast<double>(k) + 0.5) * piece - before;
        if (at >= own && !final) break;
        const double fraction = std::clamp(at / own, 0.0, 1.0);
        samples.push_back({a + fraction * along, glm::dvec2(-along.y, along.x) / own, piece, curve.kind, curve.object, c, i, fraction});
      }
      before += own;
    }
  }
  return samples;
}

bool is_within_picture(const glm::dvec2& px, const Camera& camera, double margin_px) {
  return px.x >= margin_px && px.y >= margin_px && px.x <= camera.width_px - margin_px && px.y <= camera.height_px - margin_px;
}

std::vector<BorderSample> within_picture(std::vector<BorderSample> samples, const Camera& camera, double margin_px) {
  std::erase_if(samples, [&](const BorderSample& sample) { return !is_within_picture(sample.px, camera, margin_px); });
  return samples;
}

CurveIndex::CurveIndex(const BorderCurves& curves, std::optional<CurveKind> kind, double continue_px) {
  for (const BorderCurve& curve : curves.curves) {
    if (kind && curve.kind != *kind) continue;
    const size_t count = segment_count(curve);
    const bool open = !curve.closed, continued = open && continue_px > 0.0;
    const auto add = [&](const glm::dvec2& from, const glm::dvec2& to, bool starts, bool ends) {
      segments_.push_back({from, to, curve.object, curve.kind, starts, ends});
    };
    (curve.kind == CurveKind::silhouette ? has_silhouette_ : has_inner_) |= count > 0;
    for (size_t i = 0; i < count; ++i)
      add(point_at(curve, i), point_at(curve, i + 1), open && !continued && i == 0, open && !continued && i + 1 == count);
    if (!continued || count == 0) continue;
    const glm::dvec2 front = curve.points.front().px, back = curve.points.back().px;
    add(front + continue_px * end_direction(curve, false), front, true, false);
    add(back, back + continue_px * end_direction(curve, true), false, true);
  }
  std::vector<SegmentEnds> ends;
  ends.reserve(segments_.size());
  for (const Segment& segment : segments_) ends.push_back({segment.a, segment.b});
  grid_ = segment_grid(ends);
}

template <class Visit>
void CurveIndex::visit_cell(int column, int row, const Visit& visit) const {
  for (const std::uint32_t k : grid_.in_cell(column, row)) visit(segments_[k]);
}

template <class Visit>
void CurveIndex::visit_outwards(const glm::dvec2& px, const double& reach_px, const Visit& visit) const {
  const double x = std::floor((px.x - grid_.origin.x) / grid_.cell_px), y = std::floor((px.y - grid_.origin.y) / grid_.cell_px);
  // Rings of cells about the point; whatever lies in ring k is at least (k - 1) cells and the way out of the point's own away (less what
  // rounding may add). From far outside, start where the grid does.
  const glm::dvec2 place = px - grid_.origin - grid_.cell_px * glm::dvec2(x, y);
  const double way_out = std::min({place.x, place.y, grid_.cell_px - place.x, grid_.cell_px - place.y}) - 1e-6;
  const double outside = std::max({0.0, -x, -y, x - (grid_.columns - 1), y - (grid_.rows - 1)});
  const double furthest = std::max({std::abs(x), std::abs(y), std::abs(x - grid_.columns), std::abs(y - grid_.rows)}) + 1.0;
  for (double ring = outside; ring <= furthest && (ring - 1.0) * grid_.cell_px + way_out <= reach_px; ring += 1.0) {
    const double x0 = x - ring, x1 = x + ring, y0 = y - ring, y1 = y + ring;
    for (double row = std::max(y0, 0.0); row <= std::min(y1, grid_.rows - 1.0); row += 1.0) {
      if (row == y0 || row == y1) {
        for (double column = std::max(x0, 0.0); column <= std::min(x1, grid_.columns - 1.0); column += 1.0)
          visit_cell(static_cast<int>(column), static_cast<int>(row), visit);
        continue;
      }
      if (x0 >= 0.0) visit_cell(static_cast<int>(x0), static_cast<int>(row), visit);
      if (x1 < grid_.columns) visit_cell(static_cast<int>(x1), static_cast<int>(row), visit);
    }
  }
}

std::optional<NearestPoint> CurveIndex::nearest(const glm::dvec2& px, int object, double reach_px, std::optional<glm::dvec2> facing) const {
  if (segments_.empty()) return std::nullopt;
  NearestPoint best{reach_px, {}, false};
  double most_squared = square_about(reach_px);
  bool found = false;
  visit_outwards(px, best.distance_px, [&](const Segment& segment) {
    if (object != 0 && segment.object != object) return;
    const glm::dvec2 along = segment.b - segment.a;
    if (facing && !(glm::dot(*facing, glm::dvec2(-along.y, along.x)) > 0.0)) return;
    const double s = closest_share(px - segment.a, along);
    const glm::dvec2 point = segment.a + s * along;
    const glm::dvec2 away = px - point;
    const double squared = glm::dot(away, away);
    if (!(squared <= most_squared)) return;
    const double distance = std::sqrt(squared);
    if (!(distance <= best.distance_px) || (found && distance == best.distance_px)) return;
    found = true;
    most_squared = square_about(distance);
    best = {distance, point, (segment.starts && s == 0.0) || (segment.ends && s == 1.0)};
  });
  if (!found) return std::nullopt;
  return best;
}

NearestDistances CurveIndex::nearest_distances(const glm::dvec2& px, CurveKind kind) const {
  NearestDistances best;
  if (segments_.empty()) return best;
  // What is nearest of one kind is no nearer than what is nearest of all.
  const bool has_kind = kind == CurveKind::silhouette ? has_silhouette_ : has_inner_;
  double any_squared = best.any_px, of_kind_squared = best.of_kind_px;
  visit_outwards(px, has_kind ? best.of_kind_px : best.any_px, [&](const Segment& segment) {
    const glm::dvec2 away = px - closest_on_segment(px, segment.a, segment.b);
    const double squared = glm::dot(away, away);
    if (squared < any_squared) any_squared = squared, best.any_px = std::sqrt(squared);
    if (segment.kind == kind && squared < of_kind_squared) of_kind_squared = squared, best.of_kind_px = std::sqrt(squared);
  });
  return best;
}

std::optional<CurveMeeting> CurveIndex::meeting(const glm::dvec2& px, const glm::dvec2& direction, int object, double reach_px) const {
  if (segments_.empty()) return std::nullopt;
  std::optional<CurveMeeting> best;
  const auto look = [&](const Segment& segment) {
    if (object != 0 && segment.object != object) return;
    const glm::dvec2 along = segment.b - segment.a;
    const double facing = glm::dot(direction, glm::dvec2(-along.y, along.x));
    if (!(facing > 0.0)) return;
    const double t = glm::dot(segment.a - px, glm::dvec2(-along.y, along.x)) / facing;
    // A little beyond both ends, so that no line slips through between two segments.
    const double squared = glm::dot(along, along), s = glm::dot(px + t * direction - segment.a, along) / squared;
    if (!(s >= -1e-9 && s <= 1.0 + 1e-9) || std::abs(t) > reach_px) return;
    if (!best || std::abs(t) < std::abs(best->along_px)) best = CurveMeeting{t};
  };
  const glm::dvec2 a = px - reach_px * direction, b = px + reach_px * direction;
  if (std::max(a.y, b.y) < grid_.origin.y || std::min(a.y, b.y) > grid_.origin.y + grid_.rows * grid_.cell_px) return best;
  for (int row = grid_.row_of(std::min(a.y, b.y)); row <= grid_.row_of(std::max(a.y, b.y)); ++row) {
    double s0 = 0.0, s1 = 1.0;
    if (a.y != b.y) {
      const double u = (grid_.origin.y + row * grid_.cell_px - a.y) / (b.y - a.y),
                   v = (grid_.origin.y + (row + 1) * grid_.cell_px - a.y) / (b.y - a.y);
      s0 = std::clamp(std::min(u, v) - 1e-9, 0.0, 1.0);
      s1 = std::clamp(std::max(u, v) + 1e-9, 0.0, 1.0);
    }
    const double xa = a.x + s0 * (b.x - a.x), xb = a.x + s1 * (b.x - a.x);
    for (int column = grid_.column_of(std::min(xa, xb)); column <= grid_.column_of(std::max(xa, xb)); ++column)
      visit_cell(column, row, look);
  }
  return best;
}

double search_reach_px(const Camera& camera) { return std::max(16.0, 0.02 * std::hypot(camera.width_px, camera.height_px)); }

}  // namespace limn
