#include "raymarch/lines/form_layers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "raymarch/analytic/clip_ray.h"
#include "raymarch/lines/field_layers.h"

namespace limn {
namespace {

constexpr double kOn = 1e-9;  // of the extent: a sample so near to a surface lies on it

/// One ray through the cells.
class RayCount {
 public:
  RayCount(const FormBody& body, const LayerRay& ray, double on, const glm::dvec3& sample, bool on_edge)
      : body_(body), ray_(ray), on_(on), sample_(sample), on_edge_(on_edge) {}

  int run() {
    double t0 = 0.0, t1 = ray_.end;
    if (!clip_ray(body_.cells[0].box, ray_.origin, ray_.direction, t0, t1)) return 0;
    if (t0 > 0.0) inside_ = 0;
    go(0, t0, t1);
    // Beyond the last cell is outside.
    if (inside_ == 1 && t1 < ray_.end) ++changes_;
    return changes_;
  }

 private:
  void go(int at, double t0, double t1) {
    const FormCell& cell = body_.cells[static_cast<size_t>(at)];
    if (cell.lower < 0) {
      count(cell.tree, t0, t1);
      return;
    }
    const Box &lower = body_.cells[static_cast<size_t>(cell.lower)].box, &upper = body_.cells[static_cast<size_t>(cell.upper)].box;
    const int axis = lower.upper.x < cell.box.upper.x ? 0 : lower.upper.y < cell.box.upper.y ? 1 : 2;
    const double wall = upper.lower[axis], o = ray_.origin[axis], d = ray_.direction[axis];
    const bool lower_first = d > 0.0 || (d == 0.0 && o < wall);
    const double t = d != 0.0 ? (wall - o) / d : t1;
    const int first = lower_first ? cell.lower : cell.upper, second = lower_first ? cell.upper : cell.lower;
    if (t >= t1) return go(first, t0, t1);
    if (t <= t0) return go(second, t0, t1);
    go(first, t0, t);
    go(second, t, t1);
  }

  void count(const FormTree& tree, double t0, double t1) {
    if (tree.nodes.empty()) return see(tree.inside);
    sides_.resize(tree.nodes.size());
    inside_nodes_.resize(tree.nodes.size());
    roots_.assign({t0, t1});
    for (size_t i = 0; i < tree.nodes.size(); ++i) {
      const int number = tree.nodes[i].surface;
      if (number < 0) continue;
      const FormSurface& surface = body_.surfaces[static_cast<size_t>(number)];
      sides_[i] = along_line(surface, ray_.origin, ray_.direction);
      if (on_edge_ && std::fabs(signed_value(surface, sample_)) < on_) sides_[i].quadratic.c = 0.0;
      std::array<double, 2> roots{};
      const int found = sides_[i].quadratic.roots(roots);
      for (int k = 0; k < found; ++k) {
        if (roots[static_cast<size_t>(k)] > t0 && roots[static_cast<size_t>(k)] < t1) roots_.push_back(roots[static_cast<size_t>(k)]);
      }
    }
    std::sort(roots_.begin(), roots_.end());
    for (size_t k = 0; k + 1 < roots_.size(); ++k) {
      if (roots_[k + 1] > roots_[k]) see(inside_at(tree, 0.5 * (roots_[k] + roots_[k + 1])));
    }
  }
  bool inside_at(const FormTree& tree, double t) {
    for (size_t i = 0; i < tree.nodes.size(); ++i) {
      const FormNode& node = tree.nodes[i];
      if (node.surface >= 0) {
        inside_nodes_[i] = sides_[i].inside(t);
      } else {
        const bool a = inside_nodes_[static_cast<size_t>(node.left)], b = inside_nodes_[static_cast<size_t>(node.right)];
        inside_nodes_[i] = node.intersection ? a && b : a || b;
      }
    }
    return inside_nodes_.back();
  }
  void see(bool inside) {
    if (inside_ >= 0 && inside_ != static_cast<int>(inside)) ++changes_;
    inside_ = inside ? 1 : 0;
  }

  const FormBody& body_;
  const LayerRay& ray_;
  double on_;
  glm::dvec3 sample_;
  bool on_edge_;
  int inside_ = -1;  ///< Of the stretch before; -1: there is none.
  int changes_ = 0;
  std::vector<LineSide> sides_{};
  std::vector<bool> inside_nodes_{};
  std::vector<double> roots_{};
};

}  // namespace

bool has_ray_roots(const FormBody& body) {
  return std::none_of(body.surfaces.begin(), body.surfaces.end(),
                      [](const FormSurface& surface) { return surface.kind == ClosedFormKind::torus; });
}

namespace {

/// Two surfaces of the body go through the point: most often two of those that matter in its cell.
bool lies_on_two(const FormBody& body, const glm::dvec3& p, double on) {
  int own = 0;
  for (const FormNode& node : tree_at(body, p).nodes) {
    own += node.surface >= 0 && std::fabs(signed_value(body.surfaces[static_cast<size_t>(node.surface)], p)) < on;
    if (own == 2) return true;
  }
  own = 0;
  for (const FormSurface& surface : body.surfaces) {
    own += std::fabs(signed_value(surface, p)) < on;
    if (own == 2) return true;
  }
  return false;
}

}  // namespace

int layers_before(const FormBody& body, const Camera& camera, double extent, const CurveSample& sample) {
  LayerRay ray = layer_ray(camera, extent, sample);
  const bool crease = std::isnan(sample.radial_curvature), on_edge = crease && lies_on_two(body, sample.p, kOn * extent);
  if (on_edge) {
    CurveSample there = sample;
    there.on_chord = false;
    there.lift = glm::dvec3(0.0);
    ray = layer_ray(camera, extent, there);
  }
  return RayCount(body, ray, kOn * extent, sample.p, on_edge).run();
}

}  // namespace limn
