#include "raymarch/gbuffer/trace_scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "raymarch/mesh/open_sheet.h"
#include "raymarch/scene/covered_pixels.h"

namespace limn {
namespace {

void take_hit(int i, int object, const HitBatch& from, RayBatch& rays, SceneHits& found) {
  found.hits.t[i] = from.t[i];
  found.hits.normal_x[i] = from.normal_x[i];
  found.hits.normal_y[i] = from.normal_y[i];
  found.hits.normal_z[i] = from.normal_z[i];
  found.hits.face[i] = from.face[i];
  found.hits.material[i] = from.material[i];
  found.hits.status[i] = from.status[i];
  found.object[i] = from.status[i] == HitStatus::hit ? object : -1;
  rays.t_max[i] = from.t[i];
}

/// Surfaces that coincide (faces on one plane, objects twice) hit at depths that differ by rounding; which of them is seen must not change
/// from pixel to pixel: the first in the scene is. Rays are single precision: origin, direction and t are each off by half a unit in the
/// last place, for either object and times the slope at which the surface is seen.
bool nearer(int i, const HitBatch& own, const RayBatch& rays, const SceneHits& found) {
  if (found.hits.status[i] == HitStatus::miss) return own.t[i] <= rays.t_max[i];
  const float reach = std::max({std::abs(rays.origin_x[i]), std::abs(rays.origin_y[i]), std::abs(rays.origin_z[i])}) + rays.t_max[i];
  return own.t[i] < rays.t_max[i] - reach * 0x1p-19f;
}

/// Hits of one surface become the scene's where they are nearer.
void take_nearer(size_t object, const HitBatch& own, RayBatch& rays, SceneHits& found) {
  for (int i = 0; i < rays.count; ++i) {
    if (own.status[i] != HitStatus::miss && nearer(i, own, rays, found)) take_hit(i, static_cast<int>(object), own, rays, found);
  }
}

/// `trace(object, samples)` traces one surface. `visit(f)` calls f for each that may be.
template <class Visit, class Trace>
void trace_all(size_t objects, std::span<RayBatch> rays, std::span<SceneHits> found, const Visit& visit, const Trace& trace) {
  std::array<SampleHits, kMostSamples> samples;
  const size_t count = rays.size();
  for (size_t k = 0; k < count; ++k) {
    std::fill_n(found[k].hits.status, rays[k].count, HitStatus::miss);
    samples[k] = {&rays[k], &found[k].hits};
  }
  if (objects == 1) {
    trace(size_t{0}, std::span(samples).first(count));
    for (size_t k = 0; k < count; ++k)
      for (int i = 0; i < rays[k].count; ++i) found[k].object[i] = found[k].hits.status[i] == HitStatus::hit ? 0 : -1;
    return;
  }
  const auto own = std::make_unique_for_overwrite<HitBatch[]>(count);
  for (size_t k = 0; k < count; ++k) {
    std::fill_n(found[k].object, rays[k].count, -1);
    samples[k].hits = &own[k];
  }
  visit([&](size_t object) {
    for (size_t k = 0; k < count; ++k) {
      std::fill_n(own[k].status, rays[k].count, HitStatus::miss);
      std::copy_n(rays[k].t_max, rays[k].count, own[k].t);
    }
    trace(object, std::span(samples).first(count));
    for (size_t k = 0; k < count; ++k) take_nearer(object, own[k], rays[k], found[k]);
  });
}

void turn_normals(std::span<const char> turned, const RayBatch& rays, SceneHits& found) {
  if (turned.empty()) return;
  HitBatch& hits = found.hits;
  for (int i = 0; i < rays.count; ++i) {
    if (found.object[i] < 0 || !turned[static_cast<size_t>(found.object[i])]) continue;
    const glm::vec3 normal(hits.normal_x[i], hits.normal_y[i], hits.normal_z[i]);
    if (glm::dot(normal, rays.direction(i)) <= 0.0f) continue;
    hits.normal_x[i] = -normal.x, hits.normal_y[i] = -normal.y, hits.normal_z[i] = -normal.z;
  }
}

bool overlap(const PixelTile& a, const PixelTile& b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

bool touches(const SurfaceView& view, const PixelTile& covered, const PixelTile& tile) {
  return overlap(covered, tile) && (!view.touches || view.touches(view.state.get(), tile));
}

constexpr size_t kManySurfaces = 16;
constexpr int kListCell_px = 32;

void list_by_cells(const ViewRequest& request, ModelView& view) {
  view.columns = (request.camera.width_px + kListCell_px - 1) / kListCell_px;
  const int rows = (request.camera.height_px + kListCell_px - 1) / kListCell_px;
  view.cells.resize(static_cast<size_t>(view.columns) * static_cast<size_t>(rows));
  for (size_t k = 0; k < view.covered.size(); ++k) {
    const PixelTile& covered = view.covered[k];
    if (covered.width <= 0 || covered.height <= 0) continue;
    for (int row = covered.y / kListCell_px; row <= (covered.y + covered.height - 1) / kListCell_px; ++row)
      for (int column = covered.x / kListCell_px; column <= (covered.x + covered.width - 1) / kListCell_px; ++column)
        view.cells[static_cast<size_t>(row) * static_cast<size_t>(view.columns) + static_cast<size_t>(column)].push_back(
            static_cast<std::uint32_t>(k));
  }
}

/// Calls take(k) for the surfaces that may be seen in the tile, in order, until it returns false.
template <class Take>
void visit_surfaces(const ModelView& view, const PixelTile& tile, const Take& take) {
  const auto is_seen = [&](size_t k) { return touches(view.surfaces[k], view.covered[k], tile); };
  if (view.cells.empty()) {
    for (size_t k = 0; k < view.surfaces.size(); ++k)
      if (is_seen(k) && !take(k)) return;
    return;
  }
  const int first_row = tile.y / kListCell_px, last_row = (tile.y + tile.height - 1) / kListCell_px;
  const int first_column = tile.x / kListCell_px, last_column = (tile.x + tile.width - 1) / kListCell_px;
  const auto cell = [&](int row, int column) -> const std::vector<std::uint32_t>& {
    return view.cells[static_cast<size_t>(row) * static_cast<size_t>(view.columns) + static_cast<size_t>(column)];
  };
  std::vector<std::uint32_t> joined;
  const std::vector<std::uint32_t>* all = &cell(first_row, first_column);
  if (first_row != last_row || first_column != last_column) {
    for (int row = first_row; row <= last_row; ++row)
      for (int column = first_column; column <= last_column; ++column)
        joined.insert(joined.end(), cell(row, column).begin(), cell(row, column).end());
    std::sort(joined.begin(), joined.end());
    joined.erase(std::unique(joined.begin(), joined.end()), joined.end());
    all = &joined;
  }
  for (const std::uint32_t k : *all)
    if (is_seen(k) && !take(size_t{k})) return;
}

}  // namespace

SceneExtent scene_extent(const SceneModel& model) {
  SceneExtent extent;
  for (const Surface& surface : model.surfaces) {
    if (surface.bounds.empty()) continue;
    if (!surface.bounds.finite()) {
      extent.bounded = false;
      continue;
    }
    const glm::dvec3 corner = glm::max(glm::abs(surface.bounds.lower), glm::abs(surface.bounds.upper));
    extent.radius = std::max(extent.radius, 1.01 * glm::length(corner));
  }
  return extent;
}

ModelView view_model(const SceneModel& model, const ViewRequest& request) {
  ModelView view;
  for (const Surface& surface : model.surfaces) {
    view.surfaces.push_back(surface.view ? surface.view(surface.state, request) : SurfaceView{});
    view.covered.push_back(covered_pixels(surface.bounds, request));
  }
  view.turned = turned_surfaces(model.surfaces, request.camera);
  if (view.surfaces.size() > kManySurfaces) list_by_cells(request, view);
  return view;
}

bool touches(const ModelView& view, const PixelTile& tile) {
  bool any = false;
  visit_surfaces(view, tile, [&any](size_t) {
    any = true;
    return false;
  });
  return any;
}

void trace_scene(const SceneModel& model, std::span<const char> turned, PointRays how, RayBatch& rays, SceneHits& found) {
  const auto visit = [&](const auto& take) {
    for (size_t k = 0; k < model.surfaces.size(); ++k) take(k);
  };
  trace_all(model.surfaces.size(), {&rays, 1}, {&found, 1}, visit, [&](size_t k, std::span<const SampleHits> samples) {
    const Surface& surface = model.surfaces[k];
    const bool packets = how == PointRays::in_packets && surface.trace_packets != nullptr;
    (packets ? surface.trace_packets : surface.trace)(surface.state.get(), rays, *samples[0].hits);
  });
  turn_normals(turned, rays, found);
}

void trace_scene(const SceneModel& model, const ModelView& view, const PixelTile& tile, std::span<RayBatch> rays,
                 std::span<SceneHits> found) {
  const auto visit = [&](const auto& take) {
    visit_surfaces(view, tile, [&take](size_t k) {
      take(k);
      return true;
    });
  };
  trace_all(model.surfaces.size(), rays, found, visit, [&](size_t k, std::span<const SampleHits> samples) {
    const SurfaceView& surface = view.surfaces[k];
    if (!touches(surface, view.covered[k], tile)) return;
    if (samples.size() > 1)
      surface.trace_samples(surface.state.get(), tile, samples);
    else if (surface.trace)
      surface.trace(surface.state.get(), tile, rays[0], *samples[0].hits);
    else
      model.surfaces[k].trace(model.surfaces[k].state.get(), rays[0], *samples[0].hits);
  });
  for (size_t k = 0; k < rays.size(); ++k) turn_normals(view.turned, rays[k], found[k]);
}

}  // namespace limn
