// An angle bracket bent from sheet metal, with two bolt holes and a flanged one: a grid of quads along the bent sheet, cells left out
// for the holes, front and back joined by walls. Closed, of genus 3, all outlines semi-sharp.

#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "samples/scenes/cage_builder.h"
#include "samples/scenes/cage_scene.h"
#include "samples/scenes/scenes.h"

namespace limn {
namespace {

constexpr double kThickness = 0.16;
constexpr double kBend = 0.40;   ///< Radius of the sheet's middle.
constexpr double kStart = 1.62;  ///< Where along the sheet the bend starts.
const double kEnd = kStart + kBend * std::numbers::pi / 2.0;
constexpr float kEdge = 2.5f;

// Along the sheet, and across it.
const std::array<double, 14> kAlong = {0.0,           0.34, 0.62,        0.90,        1.30,        kStart,      kStart + 0.21,
                                       kStart + 0.42, kEnd, kEnd + 0.42, kEnd + 0.70, kEnd + 0.98, kEnd + 1.26, kEnd + 1.70};
const std::array<double, 8> kAcross = {-1.05, -0.72, -0.45, -0.15, 0.15, 0.45, 0.72, 1.05};

struct Hole {
  int along, across, cells;  ///< First cell left out, and how many each way.
  double radius;
  double collar;  ///< How far its front rim stands out.
  double center_along() const { return 0.5 * (kAlong[static_cast<size_t>(along)] + kAlong[static_cast<size_t>(along + cells)]); }
  double center_across() const { return 0.5 * (kAcross[static_cast<size_t>(across)] + kAcross[static_cast<size_t>(across + cells)]); }
};
const std::array<Hole, 3> kHoles = {{{1, 0 + 1, 2, 0.24, 0.0}, {1, 4, 2, 0.24, 0.0}, {9, 2, 3, 0.46, 0.20}}};

bool left_out(int i, int j) {
  if (i < 0 || j < 0 || i + 1 >= static_cast<int>(kAlong.size()) || j + 1 >= static_cast<int>(kAcross.size())) return true;
  for (const Hole& hole : kHoles) {
    if (i >= hole.along && i < hole.along + hole.cells && j >= hole.across && j < hole.across + hole.cells) return true;
  }
  return false;
}

// A point of the bent sheet: base towards -z, then a quarter turn, then up. `height` above the sheet's middle, towards the inside.
glm::dvec3 on_sheet(double along, double across, double height) {
  const glm::dvec3 start(across, 0.0, -kStart);
  if (along <= kStart) return {across, height, -along};
  if (along >= kEnd) return start + glm::dvec3(0.0, kBend + along - kEnd, -kBend) + glm::dvec3(0.0, 0.0, height);
  const double angle = (along - kStart) / kBend;
  return start + glm::dvec3(0.0, kBend, 0.0) + (kBend - height) * glm::dvec3(0.0, -std::cos(angle), -std::sin(angle));
}

class Sheet {
 public:
  Mesh make() {
    for (int i = 0; i + 1 < static_cast<int>(kAlong.size()); ++i) {
      for (int j = 0; j + 1 < static_cast<int>(kAcross.size()); ++j) {
        if (!left_out(i, j)) add_cell(i, j);
      }
    }
    return cage_.mesh();
  }

 private:
  std::int32_t at(int i, int j, bool front) {
    const std::array<int, 3> key = {i, j, front ? 1 : 0};
    if (const auto found = vertices_.find(key); found != vertices_.end()) return found->second;
    double along = kAlong[static_cast<size_t>(i)], across = kAcross[static_cast<size_t>(j)];
    double height = front ? 0.5 * kThickness : -0.5 * kThickness;
    for (const Hole& hole : kHoles) {
      // Vertices around a hole go onto its circle.
      if (i < hole.along || i > hole.along + hole.cells || j < hole.across || j > hole.across + hole.cells) continue;
      const glm::dvec2 center(hole.center_along(), hole.center_across());
      glm::dvec2 index(i - hole.along - 0.5 * hole.cells, j - hole.across - 0.5 * hole.cells);
      // Twelve vertices stand 30 degrees apart, so the two between corners are 15 degrees off the axis.
      if (hole.cells == 3 && std::abs(index.x) != std::abs(index.y)) {
        double& lesser = std::abs(index.x) < std::abs(index.y) ? index.x : index.y;
        lesser = std::copysign(1.5 * std::tan(std::numbers::pi / 12.0), lesser);
      }
      const glm::dvec2 on_circle = center + hole.radius * glm::normalize(index);
      along = on_circle.x;
      across = on_circle.y;
      if (front) height += hole.collar;
    }
    return vertices_[key] = cage_.vertex(on_sheet(along, across, height));
  }

  void add_wall(int i, int j, int next_i, int next_j) {
    const std::int32_t a = at(i, j, true), b = at(next_i, next_j, true);
    const std::int32_t below_a = at(i, j, false), below_b = at(next_i, next_j, false);
    cage_.face({b, a, below_a, below_b});
    cage_.crease(a, b, kEdge);
    cage_.crease(below_a, below_b, kEdge);
  }

  void add_cell(int i, int j) {
    cage_.face({at(i, j, true), at(i, j + 1, true), at(i + 1, j + 1, true), at(i + 1, j, true)});
    cage_.face({at(i + 1, j, false), at(i + 1, j + 1, false), at(i, j + 1, false), at(i, j, false)});
    if (left_out(i - 1, j)) add_wall(i, j, i, j + 1);
    if (left_out(i, j + 1)) add_wall(i, j + 1, i + 1, j + 1);
    if (left_out(i + 1, j)) add_wall(i + 1, j + 1, i + 1, j);
    if (left_out(i, j - 1)) add_wall(i + 1, j, i, j);
  }

  CageBuilder cage_;
  std::map<std::array<int, 3>, std::int32_t> vertices_;
};

Scene make() {
  Scene scene;
  scene.objects.push_back(cage_object("bracket", Sheet().make(), {0.34f, 0.42f, 0.50f}));
  scene.camera = look_at({0.0, 0.72, -1.1}, {0.75, 0.62, 1.0}, 5.7);
  return scene;
}

}  // namespace

SceneDescriptor bracket_scene() {
  return {{"bracket", "an angle bracket bent from sheet metal, with three holes: a subdivision cage with semi-sharp outlines", "limn"},
          make};
}

}  // namespace limn
