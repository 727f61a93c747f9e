#include "raymarch/surface/field_parts.h"

#include "sdf/shape.h"

namespace limn {
namespace {

struct State {
  Surface surface;  ///< As it was modelled.
  FieldParts parts;
  int material;  ///< The object's.
};

struct ViewState {
  std::shared_ptr<const State> whole;
  SurfaceView view;
};

void find_materials(const State& state, const RayBatch& rays, HitBatch& hits) {
  FieldParts::Place place;
  for (int i = 0; i < rays.count; ++i) {
    if (hits.status[i] != HitStatus::hit) continue;
    const glm::dvec3 p = glm::dvec3(rays.origin(i)) + static_cast<double>(hits.t[i]) * glm::dvec3(rays.direction(i));
    const int own = state.parts.leaf(state.parts.owner(p, place)).material;
    if (own != kNoMaterial) hits.material[i] = own - state.material;
  }
}

void trace(const void* of, const RayBatch& rays, HitBatch& hits) {
  const State& state = *static_cast<const State*>(of);
  state.surface.trace(state.surface.state.get(), rays, hits);
  find_materials(state, rays, hits);
}

void trace_packets(const void* of, const RayBatch& rays, HitBatch& hits) {
  const State& state = *static_cast<const State*>(of);
  state.surface.trace_packets(state.surface.state.get(), rays, hits);
  find_materials(state, rays, hits);
}

bool touches_tile(const void* of, const PixelTile& tile) {
  const SurfaceView& view = static_cast<const ViewState*>(of)->view;
  return view.touches(view.state.get(), tile);
}

void trace_tile(const void* of, const PixelTile& tile, const RayBatch& rays, HitBatch& hits) {
  const ViewState& state = *static_cast<const ViewState*>(of);
  state.view.trace(state.view.state.get(), tile, rays, hits);
  find_materials(*state.whole, rays, hits);
}

void trace_samples(const void* of, const PixelTile& tile, std::span<const SampleHits> samples) {
  const ViewState& state = *static_cast<const ViewState*>(of);
  state.view.trace_samples(state.view.state.get(), tile, samples);
  for (const SampleHits& sample : samples) find_materials(*state.whole, *sample.rays, *sample.hits);
}

SurfaceView view(const std::shared_ptr<const void>& of, const ViewRequest& request) {
  auto whole = std::static_pointer_cast<const State>(of);
  SurfaceView made = whole->surface.view(whole->surface.state, request);
  SurfaceView result{nullptr, made.touches ? touches_tile : nullptr, made.trace ? trace_tile : nullptr,
                     made.trace_samples ? trace_samples : nullptr};
  result.state = std::make_shared<const ViewState>(ViewState{std::move(whole), std::move(made)});
  return result;
}

}  // namespace

Surface with_field_parts(const SceneObject& object, Surface surface, const glm::dvec3& render_origin) {
  const auto* field = std::get_if<Field>(&object.source);
  if (field == nullptr || (!has_materials(*field) && !has_colors(*field))) return surface;
  Surface result = surface;
  result.state = std::make_shared<const State>(State{std::move(surface), FieldParts(translate(*field, -render_origin)), object.material});
  result.trace = trace;
  if (result.trace_packets) result.trace_packets = trace_packets;
  if (result.view) result.view = view;
  return result;
}

const FieldParts* parts_of(const Surface& surface) {
  return surface.trace == trace ? &static_cast<const State*>(surface.state.get())->parts : nullptr;
}

}  // namespace limn
