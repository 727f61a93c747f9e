#include "raymarch/border/object_groups.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "raymarch/gbuffer_window.h"
#include "raymarch/threads.h"
#include "raymarch/trace_scene.h"

namespace limn {
namespace {

// Normals at a contour say nothing of how far the surface goes on; beyond this slope its plane is not followed.
constexpr double kSteepest = 8.0;
// Surfaces whose planes come this near between two pixels touch there, in pixel sizes at their depth; times one and their slope, since that
// is what a pixel's width makes of depth, and more where they are compared farther away, where they bend off their planes.
constexpr double kNear = 1.0, kNearPerPixel = 0.5;
// A group is in front of another on the whole where it is at this share of the places where they meet: what a few places say is chance.
constexpr double kInFrontShare = 0.1;

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
    const glm::dvec2 from(static_cast<double>(i % width) + seen.sample.x, static_cast<double>(i / width) + seen.sample.y);
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

PictureGroups::PictureGroups(const BorderInput& input, GroupBy by) : input_(input) {
  const GBuffer& seen = input.gbuffer;
  group_ = {seen.width, seen.height, 0};
  std::map<std::int32_t, std::int32_t> of_key;
  for (size_t i = 0; i < group_.size(); ++i) {
    if (seen.id.pixels[i] == 0) continue;
    const std::int32_t key = by == GroupBy::material ? seen.material.pixels[i] : seen.id.pixels[i];
    of_key.emplace(key, 0);
    group_.pixels[i] = key;
  }
  std::int32_t next = 0;
  for (auto& [key, group] : of_key) {
    group = ++next;
    keys_.push_back(key);
  }
  windows_.assign(of_key.size(), {seen.width, seen.height, 0, 0});
  std::int32_t last_key = 0, last_group = 0;
  for (int y = 0; y < seen.height; ++y) {
    for (int x = 0; x < seen.width; ++x) {
      const size_t i = group_.index(x, y);
      if (seen.id.pixels[i] == 0) continue;
      if (last_group == 0 || group_.pixels[i] != last_key) last_key = group_.pixels[i], last_group = of_key.at(last_key);
      group_.pixels[i] = last_group;
      PixelWindow& window = windows_[static_cast<size_t>(last_group - 1)];
      window = {std::min(window.x0, x), std::min(window.y0, y), std::max(window.x1, x + 1), std::max(window.y1, y + 1)};
    }
  }
  find_order();
}

void PictureGroups::find_order() {
  const auto compare = [this](size_t i, size_t j) {
    const std::int32_t a = group_.pixels[i], b = group_.pixels[j];
    if (a == b || a == 0 || b == 0) return;
    Order& order = order_[{std::min(a, b), std::max(a, b)}];
    ++order.places;
    const Meeting found = meeting(i, j);
    if (found != Meeting::touching) order.lower_in_front += (found == Meeting::first_in_front) == (a < b) ? 1.0 : -1.0;
  };
  for (int y = 0; y < group_.height; ++y) {
    for (int x = 0; x < group_.width; ++x) {
      const size_t i = group_.index(x, y);
      if (x + 1 < group_.width) compare(i, i + 1);
      if (y + 1 < group_.height) compare(i, i + static_cast<size_t>(group_.width));
    }
  }
}

Meeting PictureGroups::meeting(size_t first, size_t second, bool at_first) const {
  const GBuffer& seen = input_.gbuffer;
  const auto width = static_cast<size_t>(seen.width);
  const auto place = [width](size_t i) { return glm::dvec2(static_cast<double>(i % width), static_cast<double>(i / width)); };
  const glm::dvec2 between = place(second) - place(first);
  const double share = at_first ? 0.0 : 0.5, away = glm::length(between);
  const double a = plane_depth(input_.camera, seen, first, share * between);
  const double b = plane_depth(input_.camera, seen, second, (share - 1.0) * between);
  const double pixel = 1.0 / pixels_per_unit_at(input_.camera, std::min(a, b));
  const auto slope = [&](size_t i, double moved, double by) {
    return by > 0.0 ? std::abs(moved - double{seen.depth.pixels[i]}) / (by * pixel) : 0.0;
  };
  const double steeper = std::max(slope(first, a, share * away), slope(second, b, (1.0 - share) * away));
  const double near = (kNear + kNearPerPixel * away) * (1.0 + steeper) * pixel;
  if (std::abs(a - b) <= near) return Meeting::touching;
  return a < b ? Meeting::first_in_front : Meeting::second_in_front;
}

bool PictureGroups::in_front(size_t first, size_t second, bool at_first) const {
  const std::int32_t a = group_.pixels[first], b = group_.pixels[second];
  if (b == 0) return true;
  const Meeting found = meeting(first, second, at_first);
  if (found != Meeting::touching) return found == Meeting::first_in_front;
  const auto order = order_.find({std::min(a, b), std::max(a, b)});
  const bool lower = order == order_.end() || order->second.lower_in_front >= -kInFrontShare * static_cast<double>(order->second.places);
  return (a < b) == lower;
}

bool PictureGroups::touching(size_t first, size_t second) const {
  return group_.pixels[first] != 0 && group_.pixels[second] != 0 && group_.pixels[first] != group_.pixels[second] &&
         meeting(first, second) == Meeting::touching;
}

std::int64_t object_boundaries(const GBuffer& gbuffer) {
  std::int64_t count = 0;
  const Image<std::int32_t>& id = gbuffer.id;
  const auto differ = [&id](size_t i, size_t j) { return id.pixels[i] != id.pixels[j] && id.pixels[i] != 0 && id.pixels[j] != 0; };
  for (int y = 0; y < id.height; ++y) {
    for (int x = 0; x < id.width; ++x) {
      const size_t i = id.index(x, y);
      count += x + 1 < id.width && differ(i, i + 1);
      count += y + 1 < id.height && differ(i, i + static_cast<size_t>(id.width));
    }
  }
  return count;
}

void add_group_note(const std::string& method, const BorderInput& input, std::vector<std::string>& notes) {
  if (input.model.surfaces.size() < 2) return;
  const std::int64_t pairs = object_boundaries(input.gbuffer);
  if (pairs == 0) return;
  notes.push_back(fmt::format(
      "{}: no line between objects that meet in the picture ({} pairs of neighbouring pixels); group = object draws one", method, pairs));
}

std::vector<HiddenGroup> hidden_groups(const BorderInput& input, GroupBy by) {
  const size_t objects = input.model.surfaces.size();
  std::vector<HiddenGroup> all;
  std::map<int, size_t> of_material;
  for (size_t k = 0; k < objects; ++k) {
    size_t group = all.size();
    if (by == GroupBy::material) group = of_material.emplace(input.model.materials[k], group).first->second;
    if (group == all.size()) all.emplace_back();
    all[group].objects.push_back(k);
  }
  const GBuffer& seen = input.gbuffer;
  const ViewRequest request{moved(input.camera, input.model.render_origin), seen.sample};
  std::erase_if(all, [&](const HiddenGroup& group) {
    for (const size_t k : group.objects) {
      const PixelTile covered = covered_pixels(input.model.surfaces[k].bounds, request);
      for (int y = covered.y; y < covered.y + covered.height; ++y) {
        for (int x = covered.x; x < covered.x + covered.width; ++x) {
          if (group.hides(seen, seen.id.index(x, y))) return false;
        }
      }
    }
    return true;
  });
  return all;
}

namespace {

PixelWindow window_of(const PixelTile& tile) { return {tile.x, tile.y, tile.x + tile.width, tile.y + tile.height}; }

PixelWindow united(const PixelWindow& a, const PixelWindow& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

/// Gives ids the numbers they have in the whole scene, and finds the pixels that have one.
PixelWindow rename_and_find(const HiddenGroup& group, const PixelWindow& drawn, GBuffer& seen) {
  PixelWindow found{seen.width, seen.height, 0, 0};
  for (int y = drawn.y0; y < drawn.y1; ++y) {
    for (int x = drawn.x0; x < drawn.x1; ++x) {
      std::int32_t& id = seen.id.at(x, y);
      if (id == 0) continue;
      id = static_cast<std::int32_t>(group.objects[static_cast<size_t>(id - 1)]) + 1;
      found = {std::min(found.x0, x), std::min(found.y0, y), std::max(found.x1, x + 1), std::max(found.y1, y + 1)};
    }
  }
  return found.empty() ? PixelWindow{} : found;
}

}  // namespace

void render_alone(const BorderInput& input, const HiddenGroup& group, GroupAlone& alone) {
  SceneModel model;
  model.render_origin = input.model.render_origin;
  model.bounds = input.model.bounds;
  for (const size_t k : group.objects) {
    model.surfaces.push_back(input.model.surfaces[k]);
    model.colors.push_back(input.model.colors[k]);
    model.materials.push_back(input.model.materials[k]);
  }
  Camera camera = input.camera;
  camera.width_px = input.gbuffer.width;
  camera.height_px = input.gbuffer.height;
  const ViewRequest request{moved(camera, model.render_origin), input.gbuffer.sample};
  PixelWindow covered;
  for (const Surface& surface : model.surfaces) covered = united(covered, window_of(covered_pixels(surface.bounds, request)));
  const ExecutionSettings how{.threads = kSurroundingThreads};
  if (alone.seen.id.pixels.empty()) {
    render_gbuffer(model, camera, how, request.sample, {}, alone.seen);
  } else {
    const PixelWindow drawn = united(covered, alone.window);
    render_window(model, camera, how, request.sample, {drawn.x0, drawn.y0, drawn.width(), drawn.height()}, alone.seen);
  }
  alone.window = rename_and_find(group, covered, alone.seen);
}

void lay_hidden_ink(const Image<float>& hidden, const glm::vec3& color, Border& border) {
  if (border.colors.pixels.empty()) border.colors = {border.coverage.width, border.coverage.height, border.color};
  for (size_t i = 0; i < hidden.size(); ++i) {
    const float own = border.coverage.pixels[i], more = (1.0f - own) * hidden.pixels[i];
    if (!(more > 0.0f)) continue;
    border.colors.pixels[i] = (own * border.colors.pixels[i] + more * color) / (own + more);
    border.coverage.pixels[i] = own + more;
  }
}

}  // namespace limn
