#include "raymarch/truth/cell_models.h"

#include <algorithm>
#include <cmath>

#include "sdf/number_interval.h"
#include "sdf/tape_curvature.h"

namespace limn {
namespace {

constexpr double kViewMargin = 1e-9;  // of the view vector: more than the viewer is turned by (locate.h)
constexpr double kRounding = 1e-12;
constexpr double kUp = 1.0 + 1e-6, kLeast = 1e-35;                                            // what rounding to floats takes
constexpr int kAcross = 4;                                                                    // parts of a cell
constexpr double kWider = 1.0 + 1e-8;                                                         // parts, for the rounding of their corners
constexpr std::array<std::array<size_t, 3>, 3> kEntry = {{{0, 1, 2}, {1, 3, 4}, {2, 4, 5}}};  // of a symmetric matrix

double sum(const glm::dvec3& v) { return v.x + v.y + v.z; }

/// No less than x.
float rounded_up(double x) { return static_cast<float>(x * kUp + kLeast); }

/// How far the gradient goes from that of the middle, by the Hessian.
glm::dvec3 reach_of(const CellModel& model, double half) {
  glm::dvec3 reach(0.0);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      const size_t k = kEntry[static_cast<size_t>(i)][static_cast<size_t>(j)];
      reach[i] += half * (std::fabs(double{model.hessian[k]}) + double{model.hessian_reach[k]});
    }
  }
  return reach;
}

/// Taylor's remainder of first order, or the gradient's bounds where there is none.
LinearForm field_form(const CellModel& model, double half) {
  return {model.value, model.gradient, double{model.slack} + (model.smooth ? 0.5 : 1.0) * half * sum(glm::dvec3(model.gradient_reach))};
}

/// b minus the multiple of a that leaves no change along a's slope: it vanishes where both do.
LinearForm across(const LinearForm& a, const LinearForm& b) {
  const double squared = glm::dot(a.slope, a.slope), share = squared > 0.0 ? glm::dot(a.slope, b.slope) / squared : 0.0;
  if (!std::isfinite(share)) return b;
  return {b.value - share * a.value, b.slope - share * a.slope, b.remainder + std::fabs(share) * a.remainder};
}

bool may_vanish(const LinearForm& form, double half) {
  return !(std::fabs(form.value) > half * sum(glm::abs(form.slope)) * (1.0 + kRounding) + form.remainder);
}

/// Bit 16 x + 4 y + z of those parts in which the form may be 0.
std::uint64_t parts_of(const LinearForm& form, double half) {
  const double reach = half / kAcross * kWider * sum(glm::abs(form.slope)) + form.remainder, step = 2.0 * half / kAcross;
  std::uint64_t bits = 0;
  for (int x = 0; x < kAcross; ++x) {
    for (int y = 0; y < kAcross; ++y) {
      const double at = form.value + step * ((x - 1.5) * form.slope.x + (y - 1.5) * form.slope.y);
      for (int z = 0; z < kAcross; ++z) {
        const bool open = !(std::fabs(at + step * (z - 1.5) * form.slope.z) > reach);
        bits |= std::uint64_t{open} << (16 * x + 4 * y + z);
      }
    }
  }
  return bits;
}

CellModel model_of(const LaneCurvature& curvature, size_t at, int lane, double half, double slack) {
  CellModel model;
  model.at = static_cast<std::uint32_t>(at);
  model.value = curvature.middle[lane];
  model.slack = rounded_up(slack);
  model.smooth = curvature.known[static_cast<size_t>(lane)] == CurvatureKnown::all;
  for (int i = 0; i < 3; ++i) {
    const double lower = curvature.gradient_lower[i][lane], upper = curvature.gradient_upper[i][lane];
    model.gradient[i] = model.smooth ? curvature.gradient[i][lane] : 0.5 * (lower + upper);
    model.gradient_reach[i] = rounded_up(0.5 * (upper - lower) + kRounding * std::fabs(model.gradient[i]));
  }
  if (!model.smooth) return model;
  for (int k = 0; k < 6; ++k) {
    const double lower = curvature.hessian_lower[k][lane], upper = curvature.hessian_upper[k][lane];
    const float middle = static_cast<float>(0.5 * (lower + upper));
    model.hessian[static_cast<size_t>(k)] = middle;
    model.hessian_reach[static_cast<size_t>(k)] =
        rounded_up(std::max(upper - double{middle}, double{middle} - lower) + kRounding * std::fabs(double{middle}));
  }
  const glm::dvec3 reach = reach_of(model, half) + kRounding * glm::abs(model.gradient);
  for (int i = 0; i < 3; ++i) model.gradient_reach[i] = rounded_up(reach[i]);
  return model;
}

/// Seams of one child, and the parts of it that they may be in.
void find_seams(size_t child, double half, ModelledCells& cells) {
  const std::span<const CellModel> models = cells.of(child);
  for (size_t k = 1; k < models.size(); ++k) {
    const LinearForm b = field_form(models[k], half);
    for (size_t j = 0; j < k; ++j) {
      const std::uint64_t open = open_parts(field_form(models[j], half), b, half);
      if (open == 0) continue;
      cells.seams.push_back({child, {models[j].at, models[k].at}});
      cells.open_seam_parts[child] |= open;
    }
  }
}

}  // namespace

size_t ModelledCells::bytes() const {
  size_t sum = sizeof(*this) + models.capacity() * sizeof(CellModel) + seams.capacity() * sizeof(ModelledSeam);
  for (const CellScope& scope : inside) {
    sum += sizeof(scope) + scope.branches.capacity() * sizeof(int) + scope.tree.nodes.capacity() * sizeof(ScopeNode);
    for (const SharedSteps& steps : scope.steps) sum += sizeof(steps) + (steps.use_count() == 1 ? steps->size() * sizeof(TapeStep) : 0);
  }
  return sum;
}

std::uint64_t open_parts(const LinearForm& a, const LinearForm& b, double half) {
  return parts_of(a, half) & parts_of(b, half) & parts_of(across(a, b), half);
}

// With v = eye - m, d = p - m and H the Hessian: h(p) = grad f(p) . (eye - p) has the gradient H(p) (eye - p) - grad f(p), which is
// H(m) v - grad f(m) but for (H(p) - H(m)) v, H d and the change of grad f.
SeenModel seen_model(const CellSearch& search, const CellModel& model, const glm::dvec3& middle, double half) {
  SeenModel seen;
  seen.field = field_form(model, half);
  const bool perspective = search.camera.projection == Projection::perspective;
  const glm::dvec3 view = perspective ? search.camera.eye - middle : search.camera.world_from_camera[2], &g = model.gradient;
  const double steepest = search.sharp.branches[0].traits().lipschitz + glm::length(g);
  const double margin = kViewMargin * steepest * (glm::length(view) + half);
  const glm::dvec3 sides = glm::abs(view) + (perspective ? half : 0.0);
  if (model.smooth) {
    std::array<double, 6> h, r;
    std::copy(model.hessian.begin(), model.hessian.end(), h.begin());
    std::copy(model.hessian_reach.begin(), model.hessian_reach.end(), r.begin());
    const glm::dvec3 bent(h[0] * view.x + h[1] * view.y + h[2] * view.z, h[1] * view.x + h[3] * view.y + h[4] * view.z,
                          h[2] * view.x + h[4] * view.y + h[5] * view.z);
    const glm::dvec3 aside = glm::abs(view);
    glm::dvec3 off(r[0] * aside.x + r[1] * aside.y + r[2] * aside.z, r[1] * aside.x + r[3] * aside.y + r[4] * aside.z,
                   r[2] * aside.x + r[4] * aside.y + r[5] * aside.z);
    if (perspective) off += 2.0 * glm::dvec3(model.gradient_reach);
    seen.facing = {glm::dot(g, view), perspective ? bent - g : bent, half * sum(off) + margin};
  } else {
    seen.facing = {glm::dot(g, view), perspective ? -g : glm::dvec3(0.0), glm::dot(glm::dvec3(model.gradient_reach), sides) + margin};
  }
  seen.live = may_vanish(seen.field, half) && may_vanish(seen.facing, half) && may_vanish(across(seen.field, seen.facing), half);
  return seen;
}

/// Branches that matter in each of the boxes, and of these the ones that may be 0 there.
void CellBounds::find_zeros(const CellScope& scope, size_t lanes, std::array<std::vector<size_t>, 8>& relevant,
                            std::array<std::vector<size_t>, 8>& zero) {
  for (size_t at = 0; at < scope.branches.size(); ++at) bound_branch(scope, at, false);
  for (size_t lane = 0; lane < lanes; ++lane) {
    relevant[lane].clear();
    zero[lane].clear();
    if (!values_hold_surface(scope, lane)) continue;
    for (size_t at = 0; at < values_.size(); ++at) {
      if (!nodes_.relevant[at]) continue;
      relevant[lane].push_back(at);
      if (values_[at].contains(0.0)) zero[lane].push_back(at);
    }
  }
}

bool CellBounds::model(const CellScope& scope, std::span<const glm::dvec3> lower, double side, bool innermost, ModelledCells& out) {
  set_boxes(lower, side);
  bounds_.resize(std::max(bounds_.size(), scope.branches.size()));
  std::array<std::vector<size_t>, 8> relevant, zero;
  find_zeros(scope, lower.size(), relevant, zero);
  std::array<std::vector<CellModel>, 8> models;
  LaneCurvature curvature;
  for (size_t at = 0; at < scope.branches.size(); ++at) {
    const auto holds = [at](const std::vector<size_t>& branches) { return std::binary_search(branches.begin(), branches.end(), at); };
    if (std::none_of(zero.begin(), zero.end(), holds)) continue;
    const auto branch = static_cast<size_t>(scope.branches[at]);
    tape_curvature(tapes_.tapes[branch], *scope.steps[at], beams_, scratch_, curvature);
    const double lipschitz = search_.sharp.branches[branch].traits().lipschitz;
    for (size_t lane = 0; lane < lower.size(); ++lane) {
      if (!holds(zero[lane])) continue;
      if (curvature.known[lane] == CurvatureKnown::nothing) return false;
      const auto i = static_cast<int>(lane);
      const double extent = std::fabs(curvature.middle[i]) + lipschitz * (sum(glm::abs(lower[lane])) + 4.0 * half_);
      const CellModel model = model_of(curvature, at, i, half_, kRounding * extent);
      if (may_vanish(field_form(model, half_), half_)) models[lane].push_back(model);
    }
  }
  size_t count = 0;
  for (const std::vector<CellModel>& of : models) count += of.size();
  out.models.reserve(count);
  if (!innermost) out.inside.resize(lower.size());
  for (size_t lane = 0; lane < 8; ++lane) {
    out.models.insert(out.models.end(), models[lane].begin(), models[lane].end());
    out.first[lane + 1] = static_cast<std::uint32_t>(out.models.size());
    find_seams(lane, half_, out);
    if (!innermost && !models[lane].empty()) out.inside[lane] = inside(scope, {relevant[lane], {}, {}}, lane);
  }
  return true;
}

}  // namespace limn
