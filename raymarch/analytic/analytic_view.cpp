#include "raymarch/analytic/analytic_view.h"

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "raymarch/analytic/long_tape.h"
#include "raymarch/analytic/tile.h"
#include "raymarch/scene/covered_pixels.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr int kBigCell_px = 256;  // Where the tape is long it is pruned for these first.

/// The segments within `within` where the surface may be, for the beam of a smaller rectangle.
void refine(const FieldView& view, const PixelTile& rectangle, const TapeSegment& within, ViewScratch& scratch,
            std::vector<TapeSegment>& found, bool& closed) {
  SlabRuns runs;
  find_runs(view, rectangle, within, within.steps, scratch, runs);
  for (int k = 0; k < runs.count; ++k) {
    const SlabRun& run = runs.runs[static_cast<size_t>(k)];
    TapeSegment segment{run.z0, run.z1, run.sign, run.sign_from, {}, {}};
    prune_tape(within.steps, scratch.tape.choices, run.lanes, view.tape->registers, TapeUse::bounds, segment.steps);
    find_balls(*view.tape, segment.steps, segment.balls);
    found.push_back(std::move(segment));
  }
  closed = runs.closed;
}

std::vector<TapeSegment> refine_all(const FieldView& view, const PixelTile& rectangle, std::span<const TapeSegment> within) {
  std::vector<TapeSegment> found;
  ViewScratch& scratch = view.scratch->views.local();
  bool closed = false;
  for (size_t k = 0; k < within.size() && !closed; ++k) refine(view, rectangle, within[k], scratch, found, closed);
  return found;
}

/// The cells of a picture that some of its pixels lie in.
struct Grid {
  int side_px = 1, first_column = 0, first_row = 0, columns = 0, rows = 0;
  Grid(const PixelTile& covered, int side) : side_px(side), first_column(covered.x / side), first_row(covered.y / side) {
    if (covered.width <= 0 || covered.height <= 0) return;
    columns = (covered.x + covered.width - 1) / side - first_column + 1;
    rows = (covered.y + covered.height - 1) / side - first_row + 1;
  }
  PixelTile cell(int k, const Camera& camera) const {
    const int x = (first_column + k % columns) * side_px, y = (first_row + k / columns) * side_px;
    return {x, y, std::min(side_px, camera.width_px - x), std::min(side_px, camera.height_px - y)};
  }
  size_t index_at(int x_px, int y_px) const {
    return static_cast<size_t>(y_px / side_px - first_row) * static_cast<size_t>(columns) +
           static_cast<size_t>(x_px / side_px - first_column);
  }
};

/// All that may be seen, as one segment.
std::vector<TapeSegment> whole(const FieldView& view, const Box& bounds) {
  double z0 = std::numeric_limits<double>::infinity(), z1 = -z0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::dvec3 p(corner & 1 ? bounds.upper.x : bounds.lower.x, corner & 2 ? bounds.upper.y : bounds.lower.y,
                       corner & 4 ? bounds.upper.z : bounds.lower.z);
    const double z = glm::dot(p - view.beams.eye, view.beams.forward);
    z0 = std::min(z0, z);
    z1 = std::max(z1, z);
  }
  const double room = view.beams.slack + 1e-3 * bounds.radius();
  z0 -= room;
  z1 += room;
  if (!(z1 > 0.0)) return {};
  // Outside the bounds f is positive, and every ray starts outside if the first does.
  const glm::dvec3 outside = glm::max(bounds.lower - view.beams.eye, view.beams.eye - bounds.upper);
  const bool before = view.beams.perspective ? std::max({outside.x, outside.y, outside.z}) > room : z0 > 0.0;
  TapeSegment all{std::max(z0, 0.0), z1, before ? 1.0 : 0.0, before ? std::numeric_limits<double>::infinity() : 0.0, {}, {}};
  all.steps = view.tape->steps;
  return {all};
}

bool touches(const void* opaque, const PixelTile& tile) {
  const FieldView& view = *static_cast<const FieldView*>(opaque);
  for (int row = tile.y / kCell_px; row <= (tile.y + tile.height - 1) / kCell_px; ++row) {
    for (int column = tile.x / kCell_px; column <= (tile.x + tile.width - 1) / kCell_px; ++column) {
      if (!view.cell(column, row).empty()) return true;
    }
  }
  return false;
}

}  // namespace

void find_balls(const FieldTape& tape, std::span<const TapeStep> steps, std::vector<std::uint32_t>& leaves) {
  leaves.clear();
  for (const TapeStep& step : steps) {
    bool fine = step.inside_shape || step.operation == TapeOperation::minimum || step.operation == TapeOperation::multiply_constant ||
                step.operation == TapeOperation::narrow;
    if (step.operation == TapeOperation::coordinates) {
      fine = tape.leaves[step.leaf].ball_from_object.x != 0.0;
      leaves.push_back(step.leaf);
    }
    if (!fine) {
      leaves.clear();
      return;
    }
  }
}

SurfaceView view_field(std::shared_ptr<const void> keep, const FieldTape& tape, const MarchLimits& limits, const RayTracer& tracer,
                       const std::shared_ptr<FieldScratch>& scratch, const ViewRequest& request) {
  const Camera& camera = request.camera;
  const Box& bounds = tape.field.traits().bounds;
  auto view = std::make_shared<FieldView>();
  view->keep = std::move(keep);
  view->tape = &tape;
  view->limits = limits;
  view->tracer = tracer;
  view->scratch = scratch;
  // Rays are float: half a millionth of where they are; more where a pixel is wider than that anyway.
  view->reach = bounds.empty() ? 0.0 : glm::length(glm::max(glm::abs(bounds.lower), glm::abs(bounds.upper)));
  const double distance = glm::length(camera.eye - bounds.center());
  const double pixel = camera.projection == Projection::perspective ? distance / camera.focal_px : 1.0 / camera.pixels_per_unit;
  view->beams = view_beams(request, std::max(4e-6 * view->reach, 0.25 * std::min(pixel, 0.1 * bounds.radius())));
  const PixelTile covered = covered_pixels(bounds, request);
  const Grid grid(covered, kCell_px), big(covered, kBigCell_px);
  view->first_column = grid.first_column, view->first_row = grid.first_row;
  view->columns = grid.columns, view->rows = grid.rows;
  view->cells.resize(static_cast<size_t>(grid.columns) * static_cast<size_t>(grid.rows));
  const std::vector<TapeSegment> all = bounds.empty() ? std::vector<TapeSegment>{} : whole(*view, bounds);
  std::vector<std::vector<TapeSegment>> parents;
  if (tape.leaves.size() >= kLongTape) {
    parents.resize(static_cast<size_t>(big.columns) * static_cast<size_t>(big.rows));
    parallel_for(0, big.columns * big.rows, [&](int k) { parents[static_cast<size_t>(k)] = refine_all(*view, big.cell(k, camera), all); });
  }
  parallel_for(0, grid.columns * grid.rows, [&](int k) {
    const PixelTile cell = grid.cell(k, camera);
    view->cells[static_cast<size_t>(k)] = refine_all(*view, cell, parents.empty() ? all : parents[big.index_at(cell.x, cell.y)]);
  });
  return {view, touches, trace_tile, trace_tile_samples};
}

}  // namespace limn
