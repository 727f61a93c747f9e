#include "raymarch/border/object_groups.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "raymarch/scene/threads.h"

namespace limn {
namespace {

// Normals at a contour say nothing of how far the surface goes on; beyond this slope its plane is not followed.
constexpr double kSteepest = 8.0;
// Surfaces whose planes come this near between two pixels touch there, in pixel sizes at their depth; times one and their slope, since that
// is what a pixel's width makes of depth, and more where they are compared farther away, where they bend off their planes.
constexpr double kNear = 1.0, kNearPerPixel = 0.5;
// A group is in front of another on the whole where it is at this share of the places where they meet: what a few places say is chance.
constexpr double kInFrontShare = 0.1;
// Longer side of the picture of the whole scene in which that is looked for.
constexpr double kOrderSide_px = 384.0;

/// Depth of the plane through what pixel i shows, `offset_px` away in the image (y down).
double plane_depth(const Camera& camera, const GBuffer& seen, size_t i, const glm::dvec2& offset_px) {
  const double z = seen.depth.pixels[i], pixel = 1.0 / pixels_per_unit_at(camera, z);
  const glm::dvec3 normal = glm::transpose(camera.world_from_camera) * glm::dvec3(seen.normal.pixels[i]);
  const double most = kSteepest * glm::length(offset_px) * pixel;
  double change = 0.0;
  if (camera.projection == Projection::orthographic) {
    change = glm::dot(glm::dvec2(normal), glm::dvec2(offset_px.x, -offset_px.y)) * pixel / normal.z;
  } else {
    const auto width = static_cast<size_t>(seen.width);
    const size_t row = i / width;
    const glm::dvec2 from(static_cast<double>(i % width) + seen.sample.x, static_cast<double>(row) + seen.sample.y);
    const auto ray = [&](const glm::dvec2& at) {
      return glm::dvec3((at.x - 0.5 * camera.width_px) / camera.focal_px, (0.5 * camera.height_px - at.y) / camera.focal_px, -1.0);
    };
    const double there = glm::dot(normal, ray(from + offset_px)), here = glm::dot(normal, ray(from));
    change = z * here / there - z;
    // Beyond where the plane is seen edge on it comes back from behind.
    if (here * there <= 0.0) change = most;
  }
  return z + (std::isfinite(change) ? std::clamp(change, -most, most) : most);
}

Meeting meeting_of(const Camera& camera, const GBuffer& seen, size_t first, size_t second, bool at_first) {
  const auto width = static_cast<size_t>(seen.width);
  const auto place = [width](size_t i) {
    const size_t row = i / width;
    return glm::dvec2(static_cast<double>(i % width), static_cast<double>(row));
  };
  const glm::dvec2 between = place(second) - place(first);
  const double share = at_first ? 0.0 : 0.5, away = glm::length(between);
  const double a = plane_depth(camera, seen, first, share * between);
  const double b = plane_depth(camera, seen, second, (share - 1.0) * between);
  const double pixel = 1.0 / pixels_per_unit_at(camera, std::min(a, b));
  const auto slope = [&](size_t i, double moved, double by) {
    return by > 0.0 ? std::abs(moved - double{seen.depth.pixels[i]}) / (by * pixel) : 0.0;
  };
  const double steeper = std::max(slope(first, a, share * away), slope(second, b, (1.0 - share) * away));
  const double near = (kNear + kNearPerPixel * away) * (1.0 + steeper) * pixel;
  if (std::abs(a - b) <= near) return Meeting::touching;
  return a < b ? Meeting::first_in_front : Meeting::second_in_front;
}

/// Calls visit(i, j) for neighbouring pixels that show different objects.
template <class Visit>
void visit_meetings(const Image<std::int32_t>& id, const Visit& visit) {
  const auto look = [&](size_t i, size_t j) {
    if (id.pixels[i] != id.pixels[j] && id.pixels[i] != 0 && id.pixels[j] != 0) visit(i, j);
  };
  for (int y = 0; y < id.height; ++y) {
    for (int x = 0; x < id.width; ++x) {
      const size_t i = id.index(x, y);
      if (x + 1 < id.width) look(i, i + 1);
      if (y + 1 < id.height) look(i, i + static_cast<size_t>(id.width));
    }
  }
}

/// The same eye with all of the scene in the frame, about the same axis; nothing where parts of it lie beside or behind the eye.
std::optional<Camera> camera_of_everything(const Camera& camera, const SceneModel& model) {
  const Camera from_here = moved(camera, model.render_origin);
  const glm::dvec2 centre(0.5 * camera.width_px, 0.5 * camera.height_px);
  glm::dvec2 half(0.0);
  for (const Surface& surface : model.surfaces) {
    if (surface.bounds.empty()) continue;
    if (!surface.bounds.finite()) return std::nullopt;
    for (int corner = 0; corner < 8; ++corner) {
      const Box& box = surface.bounds;
      const glm::dvec3 at = project(from_here, {corner & 1 ? box.upper.x : box.lower.x, corner & 2 ? box.upper.y : box.lower.y,
                                                corner & 4 ? box.upper.z : box.lower.z});
      if (camera.projection == Projection::perspective && !(at.z > 1e-3 * box.radius())) return std::nullopt;
      half = glm::max(half, glm::abs(glm::dvec2(at) - centre));
    }
  }
  const double scale = 0.5 * kOrderSide_px / std::max(half.x, half.y);
  if (!(scale > 0.0) || !std::isfinite(scale)) return std::nullopt;
  Camera out = camera;
  out.focal_px *= scale, out.pixels_per_unit *= scale;
  out.width_px = std::max(1, static_cast<int>(std::ceil(2.0 * scale * half.x)));
  out.height_px = std::max(1, static_cast<int>(std::ceil(2.0 * scale * half.y)));
  return out;
}

}  // namespace

std::vector<Parameter> group_parameters(GroupBy by) {
  return {a_choice("group", {"all", "object", "material"})
              .chosen(static_cast<double>(by))
              .help("what an outline goes around: all objects together, each object, or what has the same material; between two the one in "
                    "front is "
                    "outlined"),
          a_choice("hidden", {"none", "drawn"}).help("drawn: also the outline of what other objects hide, seen through them"),
          a_color("hidden_color", {0.6, 0.6, 0.6}).help("ink of hidden outlines, linear RGB")};
}

GroupSettings group_settings(const Parameters& parameters) {
  const std::string& by = parameters.choice("group");
  return {by == "all"      ? GroupBy::all
          : by == "object" ? GroupBy::object
                           : GroupBy::material,
          parameters.choice("hidden") == "drawn", glm::vec3(parameters.vector3("hidden_color"))};
}

std::vector<std::string> group_inputs(const BorderMethod& method, const Parameters& parameters) {
  const auto own = [](const Parameter& parameter) { return parameter.name == "group"; };
  if (std::none_of(method.parameters.begin(), method.parameters.end(), own)) return {};
  const GroupBy by = group_settings(parameters).by;
  if (by == GroupBy::material) return {"Z", "N", "material"};
  if (by == GroupBy::object) return {"Z", "N"};
  return {};
}

PixelWindow grown(const PixelWindow& window, int by, int width, int height, int step) {
  const int x0 = std::max(0, window.x0 - by), y0 = std::max(0, window.y0 - by);
  return {x0 - x0 % step, y0 - y0 % step, std::min(width, window.x1 + by), std::min(height, window.y1 + by)};
}

PictureGroups::PictureGroups(const BorderInput& input, GroupBy by) : input_(input), by_(by) {
  const GBuffer& seen = input.gbuffer;
  group_ = {seen.width, seen.height, 0};
  for (size_t i = 0; i < seen.id.size(); ++i) {
    if (seen.id.pixels[i] != 0 && (keys_.empty() || keys_.back() != key_of(seen, i))) keys_.push_back(key_of(seen, i));
  }
  std::sort(keys_.begin(), keys_.end());
  keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
  windows_.assign(keys_.size(), {seen.width, seen.height, 0, 0});
  std::int32_t last_key = 0, last_group = 0;
  for (int y = 0; y < seen.height; ++y) {
    for (int x = 0; x < seen.width; ++x) {
      const size_t i = group_.index(x, y);
      if (seen.id.pixels[i] == 0) continue;
      const std::int32_t key = key_of(seen, i);
      if (last_group == 0 || key != last_key) last_key = key, last_group = group_of_key(key);
      group_.pixels[i] = last_group;
      PixelWindow& window = windows_[static_cast<size_t>(last_group - 1)];
      window = {std::min(window.x0, x), std::min(window.y0, y), std::max(window.x1, x + 1), std::max(window.y1, y + 1)};
    }
  }
  if (!any_touching()) return;
  SharedFindings none;
  SharedFindings& shared = input.shared != nullptr ? *input.shared : none;
  std::shared_ptr<const GroupOrders>& orders = by == GroupBy::material ? shared.of_materials : shared.of_objects;
  if (orders == nullptr) orders = find_orders();
  orders_ = orders;
}

std::int32_t PictureGroups::key_of(const GBuffer& seen, size_t i) const {
  return by_ == GroupBy::material ? seen.material.pixels[i] : seen.id.pixels[i];
}

std::shared_ptr<const GroupOrders> PictureGroups::find_orders() const {
  auto orders = std::make_shared<GroupOrders>();
  const auto count = [&](const Camera& camera, const GBuffer& seen) {
    visit_meetings(seen.id, [&](size_t i, size_t j) {
      const std::int32_t a = key_of(seen, i), b = key_of(seen, j);
      if (a == b) return;
      GroupOrder& order = (*orders)[{std::min(a, b), std::max(a, b)}];
      ++order.places;
      const Meeting found = meeting_of(camera, seen, i, j, false);
      if (found != Meeting::touching) order.lower_in_front += (found == Meeting::first_in_front) == (a < b) ? 1.0 : -1.0;
    });
  };
  const std::optional<Camera> everything = camera_of_everything(input_.camera, input_.model);
  if (!everything) {
    count(input_.camera, input_.gbuffer);
    return orders;
  }
  GBuffer whole;
  GBufferLayers layers;
  layers.position = layers.n_dot_v = layers.face = layers.status = false;
  render_gbuffer(input_.model, *everything, {.threads = kSurroundingThreads}, {0.5, 0.5}, layers, whole);
  count(*everything, whole);
  return orders;
}

bool PictureGroups::any_touching() const {
  bool any = false;
  visit_meetings(input_.gbuffer.id, [&](size_t i, size_t j) { any = any || touching(i, j); });
  return any;
}

Meeting PictureGroups::meeting(size_t first, size_t second, bool at_first) const {
  return meeting_of(input_.camera, input_.gbuffer, first, second, at_first);
}

bool PictureGroups::in_front(size_t first, size_t second, bool at_first) const {
  const std::int32_t a = group_.pixels[first], b = group_.pixels[second];
  if (b == 0) return true;
  const Meeting found = meeting(first, second, at_first);
  if (found != Meeting::touching) return found == Meeting::first_in_front;
  // Groups are numbered in the order of their keys. Without orders no neighbouring pixels touch.
  if (orders_ == nullptr) return a < b;
  const auto order = orders_->find({key(std::min(a, b)), key(std::max(a, b))});
  const bool lower = order == orders_->end() || order->second.lower_in_front >= -kInFrontShare * static_cast<double>(order->second.places);
  return (a < b) == lower;
}

bool PictureGroups::touching(size_t first, size_t second) const {
  return group_.pixels[first] != 0 && group_.pixels[second] != 0 && group_.pixels[first] != group_.pixels[second] &&
         meeting(first, second) == Meeting::touching;
}

std::int64_t object_boundaries(const GBuffer& gbuffer) {
  std::int64_t count = 0;
  visit_meetings(gbuffer.id, [&count](size_t, size_t) { ++count; });
  return count;
}

void add_group_note(const std::string& method, const BorderInput& input, std::vector<std::string>& notes) {
  if (input.model.surfaces.size() < 2) return;
  const std::int64_t pairs = object_boundaries(input.gbuffer);
  if (pairs == 0) return;
  notes.push_back(fmt::format(
      "{}: no line between objects that meet in the picture ({} pairs of neighbouring pixels); group = object draws one", method, pairs));
}

}  // namespace limn
