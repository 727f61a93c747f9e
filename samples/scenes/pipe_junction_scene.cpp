// A hollow pipe junction: outer and inner hub are cubes of 2 x 2 quads a side; four sides go out into flanged pipes and come back in
// as their bores. Closed, of genus 3; where pipes meet, vertices have three, five and six edges.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "samples/scenes/cage_builder.h"
#include "samples/scenes/cage_scene.h"
#include "samples/scenes/scenes.h"

namespace limn {
namespace {

// A side of the cube by its normal and two axes with u x v = n.
struct Side {
  glm::ivec3 n, u, v;
  bool pipe;
};
const std::array<Side, 6> kSides = {{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, true},
                                     {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}, true},
                                     {{0, 1, 0}, {0, 0, 1}, {1, 0, 0}, true},
                                     {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}, false},
                                     {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}, true},
                                     {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}, false}}};
const std::array<glm::ivec2, 8> kRim = {{{-1, -1}, {0, -1}, {1, -1}, {1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}}};

// Vertices of a hub on the sphere of `radius`, by their place in {-1, 0, 1}^3.
class Hub {
 public:
  Hub(CageBuilder& cage, double radius) : cage_(&cage), radius_(radius) {}
  std::int32_t at(const glm::ivec3& place) {
    const std::array<int, 3> key = {place.x, place.y, place.z};
    if (const auto found = vertices_.find(key); found != vertices_.end()) return found->second;
    return vertices_[key] = cage_->vertex(radius_ * glm::normalize(glm::dvec3(place)));
  }
  CageBuilder::Loop rim(const Side& side) {
    CageBuilder::Loop loop;
    for (const glm::ivec2& p : kRim) loop.push_back(at(side.n + p.x * side.u + p.y * side.v));
    return loop;
  }
  void close(const Side& side, bool inside_out) {
    for (int i = -1; i < 1; ++i) {
      for (int j = -1; j < 1; ++j) {
        const auto corner = [&](int a, int b) { return at(side.n + (i + a) * side.u + (j + b) * side.v); };
        CageBuilder::Loop quad = {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
        if (inside_out) std::reverse(quad.begin(), quad.end());
        cage_->face(quad);
      }
    }
  }

 private:
  CageBuilder* cage_;
  double radius_;
  std::map<std::array<int, 3>, std::int32_t> vertices_;
};

struct PipePoint {
  double along, radius;
  float sharpness;
};
// Out along the wall, over the flange, back in along the bore.
const std::array<PipePoint, 9> kPipe = {{{0.90, 0.50, 0.0f},
                                         {1.15, 0.44, 0.0f},
                                         {1.36, 0.44, 1.5f},
                                         {1.38, 0.74, 3.0f},
                                         {1.56, 0.74, 3.0f},
                                         {1.56, 0.40, 3.0f},
                                         {1.40, 0.34, 0.0f},
                                         {1.10, 0.34, 0.0f},
                                         {0.80, 0.36, 0.0f}}};

void add_pipe(CageBuilder& cage, const Side& side, Hub& outer, Hub& inner) {
  CageBuilder::Loop loop = outer.rim(side);
  for (const PipePoint& point : kPipe) {
    CageBuilder::Loop ring;
    for (const glm::ivec2& p : kRim) {
      const glm::dvec2 d = glm::normalize(glm::dvec2(p));
      ring.push_back(cage.vertex(point.along * glm::dvec3(side.n) + point.radius * (d.x * glm::dvec3(side.u) + d.y * glm::dvec3(side.v))));
    }
    cage.band(loop, ring);
    if (point.sharpness > 0.0f) cage.crease_loop(ring, point.sharpness);
    loop = ring;
  }
  cage.band(loop, inner.rim(side));
}

Mesh junction() {
  CageBuilder cage;
  Hub outer(cage, 0.86), inner(cage, 0.66);
  for (const Side& side : kSides) {
    if (side.pipe) {
      add_pipe(cage, side, outer, inner);
    } else {
      outer.close(side, false);
      inner.close(side, true);
    }
  }
  return cage.mesh();
}

Scene make() {
  Scene scene;
  scene.objects.push_back(cage_object("junction", junction(), {0.62f, 0.30f, 0.12f}));
  scene.camera = look_at({0.0, 0.28, 0.1}, {0.62, 0.62, 1.0}, 5.9);
  return scene;
}

}  // namespace

SceneDescriptor pipe_junction_scene() {
  return {{"pipe_junction", "a hollow junction of four flanged pipes: a subdivision cage of genus 3 with creased rims", "limn"}, make};
}

}  // namespace limn
