#include "subdiv/snap_vertex.h"

#include <algorithm>
#include <array>

#include "subdiv/surface_snap.h"

namespace limn {
namespace {

/// A side that looks away from a vertex's faces by more (148 degrees) is the other one of a wall.
constexpr double kWallCosine = -0.85;

/// Sampled off the surface, and therefore stricter (10 degrees).
const double kPlainlySmoothCosine = std::cos(10.0 * std::numbers::pi / 180.0);

/// In a thin wall the nearest sheet may be the wrong one, whose outside is the other way. Along the outward direction the right one is
/// where the field turns from negative to positive; the crossing nearest to `start` within one edge length is taken.
bool project_along(LocalField& field, glm::dvec3& point, const Surroundings& around) {
  constexpr int kSteps = 24;
  const double step = around.edge_length / kSteps;
  const auto at = [&](double t) { return point + t * around.outward; };
  double best = 2.0 * around.edge_length;
  double previous = field.value(at(-around.edge_length));
  for (int i = -kSteps + 1; i <= kSteps; ++i) {
    const double value = field.value(at(i * step));
    if (previous < 0.0 && value >= 0.0) {
      double in = (i - 1) * step, out = i * step;
      for (int k = 0; k < 60; ++k) {
        const double middle = 0.5 * (in + out);
        (field.value(at(middle)) < 0.0 ? in : out) = middle;
      }
      if (std::abs(out) < std::abs(best)) best = out;
    }
    previous = value;
  }
  if (best > around.edge_length) return false;
  point = at(best);
  return true;
}

/// Where a vertex comes to lie if the surface is smooth there.
struct Plain {
  glm::dvec3 position{0.0};
  bool reached = false;
  double off = 0.0;
};

/// Onto the sheet of the surface that looks the same way as the faces around the vertex; `landing` is the nearest one.
Plain onto_own_sheet(LocalField& field, const SnapTask& task, const Landing& landing) {
  const Plain nearest{landing.position, landing.reached, distance_by(landing.value, landing.gradient)};
  if (landing.reached && glm::dot(direction_of(landing.gradient), task.around->outward) > -0.1) return nearest;
  glm::dvec3 along = task.start;
  if (!project_along(field, along, *task.around)) return nearest;
  return {along, true, field.distance_off(along)};
}

/// Points of the surface beside a vertex, with their normals.
struct Sides {
  std::vector<glm::dvec3> points{}, normals{};

  Sides(std::span<const Landing> landings, const Surroundings& around) {
    for (const Landing& landing : landings) {
      if (!landing.reached) continue;
      const glm::dvec3 normal = direction_of(landing.gradient);
      // The other side of a thin wall does not count; the other side of a sharp edge does.
      if (normal == glm::dvec3(0.0) || glm::dot(normal, around.outward) < kWallCosine) continue;
      points.push_back(landing.position), normals.push_back(normal);
    }
  }

  /// Whether the normals differ as at a crease.
  bool differ() const {
    for (size_t i = 1; i < normals.size(); ++i)
      for (size_t j = 0; j < i; ++j)
        if (glm::dot(normals[i], normals[j]) < kCreaseCosine) return true;
    return false;
  }
};

/// Vertices of more faces are looked at closely.
constexpr size_t kMostFaces = 8;

/// Whether gradients half way to the faces' middles turn less than a crease does.
bool turn_little(std::span<glm::dvec3> gradients) {
  for (size_t i = 0; i < gradients.size(); ++i) {
    gradients[i] = direction_of(gradients[i]);
    if (gradients[i] == glm::dvec3(0.0)) return false;
    for (size_t j = 0; j < i; ++j)
      if (glm::dot(gradients[i], gradients[j]) < kPlainlySmoothCosine) return false;
  }
  return true;
}

/// Without any projection: most vertices are let off with this.
std::vector<bool> plainly_smooth(LocalField& field, std::span<const SnapTask> tasks, const std::vector<Plain>& plain) {
  const auto asked = [&](size_t i) { return plain[i].reached && tasks[i].around->middles.size() <= kMostFaces; };
  std::vector<glm::dvec3> points;
  for (size_t i = 0; i < tasks.size(); ++i) {
    if (!asked(i)) continue;
    for (const glm::dvec3& middle : tasks[i].around->middles) points.push_back(0.5 * (tasks[i].start + middle));
  }
  std::vector<double> values(points.size());
  std::vector<glm::dvec3> gradients(points.size());
  field.gradients(points, values, gradients);
  std::vector<bool> smooth(tasks.size(), false);
  std::span<glm::dvec3> left(gradients);
  for (size_t i = 0; i < tasks.size(); ++i) {
    if (!asked(i)) continue;
    const size_t count = tasks[i].around->middles.size();
    smooth[i] = turn_little(left.first(count));
    left = left.subspan(count);
  }
  return smooth;
}

/// A vertex on its way to where the sides around it meet.
struct CreaseSearch {
  size_t task = 0;
  glm::dvec3 x{0.0};
  bool creased = true;  ///< As far as is known.

  /// One step, by what lies beside x.
  void go_on(const Sides& sides, const SnapTask& of) {
    creased = sides.differ();
    if (!creased) return;
    const glm::dvec3 next = meet_planes(sides.points, sides.normals, x);
    // Planes that nearly agree meet far away: that is no crease of this vertex. Half way along an edge or a diagonal that was refined, a
    // crease across it may be as far as its half, which is one and a half of the new edges.
    creased = glm::distance(next, of.start) < 1.5 * of.around->edge_length;
    if (creased) x = next;
  }
};

/// From closer and closer beside the vertices, all of them together.
void search_creases(LocalField& field, std::span<const SnapTask> tasks, std::vector<CreaseSearch>& searches) {
  std::vector<glm::dvec3> starts;
  const auto goes_on = [](const CreaseSearch& search) { return search.creased; };
  for (const double fraction : {0.5, 0.2, 0.05, 0.01, 1e-3, 1e-5, 1e-7}) {
    if (std::none_of(searches.begin(), searches.end(), goes_on)) return;
    starts.clear();
    for (const CreaseSearch& search : searches) {
      if (!search.creased) continue;
      for (const glm::dvec3& middle : tasks[search.task].around->middles) starts.push_back(search.x + fraction * (middle - search.x));
    }
    const std::vector<Landing> landings = field.project(starts);
    std::span<const Landing> left(landings);
    for (CreaseSearch& search : searches) {
      if (!search.creased) continue;
      const SnapTask& task = tasks[search.task];
      search.go_on(Sides(left.first(task.around->middles.size()), *task.around), task);
      left = left.subspan(task.around->middles.size());
    }
  }
}

/// Of those that are not where the surface was reached.
void find_distances_off(LocalField& field, const std::vector<Plain>& plain, std::vector<Snapped>& snapped) {
  std::vector<size_t> which;
  std::vector<glm::dvec3> points;
  for (size_t i = 0; i < snapped.size(); ++i)
    if (snapped[i].feature || !plain[i].reached) which.push_back(i), points.push_back(snapped[i].position);
  const std::vector<double> off = field.distances_off(points);
  for (size_t k = 0; k < which.size(); ++k) snapped[which[k]].off = off[k];
}

}  // namespace

std::vector<Snapped> snap(LocalField& field, std::span<const SnapTask> tasks) {
  std::vector<glm::dvec3> starts;
  for (const SnapTask& task : tasks) starts.push_back(task.start);
  const std::vector<Landing> landings = field.project(starts);
  std::vector<Plain> plain;
  for (size_t i = 0; i < tasks.size(); ++i) plain.push_back(onto_own_sheet(field, tasks[i], landings[i]));
  const std::vector<bool> smooth = plainly_smooth(field, tasks, plain);
  std::vector<CreaseSearch> searches;
  for (size_t i = 0; i < tasks.size(); ++i)
    if (!smooth[i]) searches.push_back({i, tasks[i].start});
  search_creases(field, tasks, searches);
  std::vector<Snapped> snapped;
  for (size_t i = 0; i < tasks.size(); ++i) snapped.push_back({plain[i].reached ? plain[i].position : tasks[i].start, false, plain[i].off});
  for (const CreaseSearch& search : searches)
    if (search.creased) snapped[search.task] = {search.x, true, 0.0};
  find_distances_off(field, plain, snapped);
  return snapped;
}

Snapped snap(LocalField& field, const glm::dvec3& start, const Surroundings& around) {
  const SnapTask task{start, &around};
  return snap(field, std::span(&task, 1)).front();
}

}  // namespace limn
