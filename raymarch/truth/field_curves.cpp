#include "raymarch/truth/field_curves.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "raymarch/truth/cell_settling.h"
#include "raymarch/truth/followed_curves.h"
#include "raymarch/truth/refined_curves.h"
#include "raymarch/truth/strands.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr int kMostHalvings = 2;  // of cells

/// The domain is wider than the bounds by odd shares on every side: what is symmetric about its own middle then keeps off the cells' faces.
CellGrid make_grid(const Box& bounds, int level) {
  const double side = bounds.longest_side() * 1.0517311;
  const glm::dvec3 center = bounds.center() + side * glm::dvec3(0.0061803, -0.0041421, 0.0073205);
  return {center - 0.5 * side, std::ldexp(side, -level)};
}

/// Pixels per world unit where the object is seen largest: at its nearest, but not nearer than a tenth of its radius.
double largest_scale(const Camera& camera, const Box& bounds) {
  const double z = project(camera, bounds.center()).z;
  return pixels_per_unit_at(camera, std::max(z - bounds.radius(), 0.1 * bounds.radius()));
}

/// Points that are off the curve are left to the refinement, where others remain to start from.
void drop_rough(Strand& curve) {
  const auto rough = [](const CurvePoint& point) { return point.rough; };
  const auto good = std::count_if(curve.points.begin(), curve.points.end(), std::not_fn(rough));
  if (good >= 4) curve.points.erase(std::remove_if(curve.points.begin(), curve.points.end(), rough), curve.points.end());
}

/// Where a curve runs along the faces it crosses, neighbouring crossings may come out in the wrong order: of a sharp turn the point is
/// dropped, also where a closed curve ends. Were it a corner of the curve, the refinement would find it again.
void drop_backward(Strand& curve) {
  for (bool again = true; again && curve.points.size() > 8;) {
    again = false;
    const auto turns_back = [](const CurvePoint& before, const CurvePoint& at, const CurvePoint& after) {
      return glm::dot(at.p - before.p, after.p - at.p) < 0.0;
    };
    std::vector<CurvePoint> kept = {curve.points[0]};
    for (size_t i = 1; i + 1 < curve.points.size(); ++i) {
      if (turns_back(kept.back(), curve.points[i], curve.points[i + 1]))
        again = true;
      else
        kept.push_back(curve.points[i]);
    }
    if (curve.closed && turns_back(kept.back(), curve.points.back(), kept.front()))
      again = true;
    else
      kept.push_back(curve.points.back());
    if (kept.size() < 6) return;
    curve.points = std::move(kept);
  }
}

/// What was found on the branches and along their seams, as strands.
std::vector<Strand> strands_of(CellResult& found, const CellSearch& search, const CellCurveSettings& settings, const ExecutionSettings& how,
                               FieldCurves& stats) {
  std::vector<Strand> strands;
  for (auto& [branch, families] : found.branches) {
    for (size_t family = 0; family < kCurveFamilies; ++family) {
      std::vector<Strand> joined = assemble(families[family], branch, -1, search.levels[family]);
      if (settings.follow > 0.0) {
        if (search.levels[family] == 0.0) {
          for (const glm::dvec3& seed : settings.seeds) joined.push_back({branch, -1, 0.0, false, {CurvePoint{seed}}});
        }
        joined = follow_strands(std::move(joined), search.sharp.branches[static_cast<size_t>(branch)], search.camera, search.viewer,
                                {settings.tolerance_px, settings.follow}, how);
      }
      for (Strand& strand : joined) {
        if (strand.followed) {
          strands.push_back(std::move(strand));
          continue;
        }
        drop_rough(strand);
        stats.rough += std::count_if(strand.points.begin(), strand.points.end(), [](const CurvePoint& point) { return point.rough; });
        drop_backward(strand);
        strands.push_back(std::move(strand));
      }
    }
  }
  for (auto& [seam, curves] : found.seams) {
    auto whole = assemble(curves, seam.first, seam.second, 0.0);
    if (search.whole_seams) {
      for (Strand& strand : whole) {
        strand.whole = true;
        strands.push_back(std::move(strand));
      }
      continue;
    }
    for (size_t family = 0; family < kCurveFamilies; ++family) {
      if (!(search.families >> family & 1u)) continue;
      for (Strand strand : whole) {
        strand.c = search.levels[family];
        strands.push_back(std::move(strand));
      }
    }
  }
  return strands;
}

}  // namespace

void curves_of_cells(CellResult& found, const CellSearch& search, const CellCurveSettings& settings, const ExecutionSettings& how,
                     FieldCurves& result) {
  std::vector<Strand> strands = strands_of(found, search, settings, how, result);
  StrandScope scope(search.sharp, settings.extent);
  const StrandSettings cutting{search.sharp,          scope,           search.camera,     search.viewer,
                               settings.tolerance_px, settings.extent, settings.lipschitz};
  std::vector<std::vector<FieldCurve>> cut(strands.size());
  std::vector<FieldCurves> stats(strands.size());
  parallel_for(size_t{0}, strands.size(), [&](size_t i) {
    if (how.cancelled && how.cancelled()) throw Cancelled{};
    Strand& strand = strands[i];
    // A lone smooth branch is the surface.
    if (strand.followed && search.sharp.branches.size() == 1) {
      cut[i].push_back({strand.c, strand.closed, false, false, std::move(strand.points)});
      return;
    }
    cut[i] = cut_to_surface(strand, cutting);
    if (strand.second >= 0 || strand.followed) return;
    const Refiner refiner{search.sharp.branches[static_cast<size_t>(strand.first)],
                          search.camera,
                          search.viewer,
                          settings.tolerance_px,
                          settings.extent,
                          settings.follow == 0.0};
    for (FieldCurve& curve : cut[i]) {
      refine(refiner, curve, stats[i]);
      stats[i].broken += count_broken(refiner, curve);
    }
  });
  std::vector<FieldCurve> pieces, seams;
  for (size_t i = 0; i < strands.size(); ++i) {
    result.unrefined += stats[i].unrefined;
    result.broken += stats[i].broken;
    result.worst_unrefined_px = std::max(result.worst_unrefined_px, stats[i].worst_unrefined_px);
    for (FieldCurve& curve : cut[i]) (curve.seam ? seams : pieces).push_back(std::move(curve));
  }
  double widest_gap_px = 0.0;
  result.curves = join_ends(std::move(pieces), search.camera, search.whole_seams ? widest_gap_px : result.worst_unrefined_px);
  result.curves.insert(result.curves.end(), std::make_move_iterator(seams.begin()), std::make_move_iterator(seams.end()));
  for (const FieldCurve& curve : result.curves) result.open_ends += curve.closed ? 0 : 2;
}

namespace {

/// With cells of one size.
FieldCurves traced_in(const SharpField& sharp, double lipschitz, const std::optional<std::pair<int, int>>& only_seam, const Box& bounds,
                      int level, const Camera& camera, const Viewer& viewer, const FieldCurveSettings& settings,
                      const ExecutionSettings& how) {
  FieldCurves result;
  const CellGrid grid = make_grid(bounds, level);
  result.level = level;
  result.cell = grid.side;
  result.cell_px = grid.side * largest_scale(camera, bounds);
  const bool both = settings.threshold > 0.0 && !only_seam;
  const CellSearch search{sharp, camera, viewer, grid, level, {0.0, settings.threshold}, both ? 3u : 1u, settings.whole_seams, only_seam};
  CellResult found = search_cells(search, settings.memory ? settings.memory(level) : nullptr, how);
  result.cells = found.cells;
  result.unsettled = found.unsettled;
  result.unproven_px = kUnprovenReach * result.cell_px;
  curves_of_cells(found, search, {settings.tolerance_px, bounds.radius(), lipschitz}, how, result);
  return result;
}

/// Where curves of a field are looked for, and in cells of which level.
struct SearchedBox {
  Box bounds{};
  bool cut = false;
  int level = 5;
};

SearchedBox searched_box(const Field& field, const Camera& camera, const FieldCurveSettings& settings) {
  SearchedBox box{field.traits().bounds};
  if (box.bounds.empty()) return box;
  box.cut = !box.bounds.finite();
  if (box.cut) box.bounds = intersect(box.bounds, settings.unbounded_domain);
  if (box.bounds.empty()) return box;
  const double cells = box.bounds.longest_side() * largest_scale(camera, box.bounds) / settings.cell_px;
  box.level = std::clamp(static_cast<int>(std::ceil(std::log2(std::max(cells, 1.0)))), 5, settings.finest_level);
  return box;
}

}  // namespace

FieldCurves trace_field_curves(const Field& field, const Camera& camera, const Viewer& viewer, const FieldCurveSettings& settings,
                               const ExecutionSettings& how) {
  const SearchedBox box = searched_box(field, camera, settings);
  FieldCurves result;
  if (!box.bounds.empty()) {
    const SharpField sharp = split_branches(field, box.bounds.radius(), settings.whole_seams);
    // Cells that hold two arms of a curve are halved.
    int level = box.level;
    const int finest = std::min(level + kMostHalvings, settings.finest_level);
    do result = traced_in(sharp, field.traits().lipschitz, {}, box.bounds, level, camera, viewer, settings, how);
    while (result.broken > 0 && level++ < finest);
  }
  result.domain_cut = box.cut;
  return result;
}

FieldCurves trace_zeros_on_branch(const Field& field, const SharpField& sharp, int branch, const Camera& camera, const Viewer& viewer,
                                  const FieldCurveSettings& settings, const ExecutionSettings& how) {
  const SearchedBox box = searched_box(field, camera, settings);
  if (box.bounds.empty()) return {};
  const std::pair<int, int> seam{branch, static_cast<int>(sharp.branches.size()) - 1};
  FieldCurves result = traced_in(sharp, field.traits().lipschitz, seam, box.bounds, box.level, camera, viewer, settings, how);
  result.domain_cut = box.cut;
  return result;
}

}  // namespace limn
