#pragma once
// Offset surfaces of what knows distances: fields and level sets.

#include <functional>

#include "raymarch/level_set/level_set_marcher.h"

namespace limn {

/// Of a field in render space. Exact distances are taken as they are, others computed to third order from value, gradient and Hessian.
SurfaceOffset field_offset(const Field& render_field, int max_steps);

/// Boxes that hold all places within `clip` where rays meet the field's offset (Surface::where_met).
std::vector<Box> field_meeting_places(const Field& field, const Box& clip, const OffsetWidth& width, const MeetingRequest& request);

/// What a level set's offset needs: a band that reaches as far as the width. `widen` makes the same level set with a band of so many
/// voxels; empty where only the file knows it.
struct LevelSetOffsetSource {
  LevelSet level_set;
  Affine world_from_object{};
  glm::dvec3 render_origin{0.0};
  int max_steps = 0;
  std::string file{};
  std::function<LevelSet(double half_width_voxels)> widen{};
};
SurfaceOffset level_set_offset(LevelSetOffsetSource source);

}  // namespace limn
