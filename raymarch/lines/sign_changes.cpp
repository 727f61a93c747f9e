#include "raymarch/lines/sign_changes.h"

#include <algorithm>

namespace limn {
namespace {

constexpr double kLeastBend = 1e-7;  // of the radial curvature times the scene's radius: less is rounding
// Changes closer together are one: along a curve that is known between its samples all that are wider apart can be told from each other.
constexpr double kOneCusp_px = 0.03, kKnownCusp_px = 0.002;

class SignChangeFinder {
 public:
  SignChangeFinder(const SurfaceCurve& curve, const CurveWalk& walk, const Camera& camera, double extent)
      : curve_(curve), walk_(walk), camera_(camera), extent_(extent) {}

  SignChanges run() {
    find();
    return std::move(found_);
  }

 private:
  /// Where the radial curvature changes its sign, but for rounding.
  void find() {
    const auto sign_of = [&](size_t i) {
      const double bend = walk_.at(i).radial_curvature * extent_;
      return bend > kLeastBend ? 1 : bend < -kLeastBend ? -1 : 0;
    };
    size_t first = 0;
    while (first < walk_.size() && sign_of(first) == 0) ++first;
    size_t last = first;
    for (size_t k = first + 1; k < first + walk_.size() + (curve_.closed ? 1 : 0) && (curve_.closed || k < walk_.size()); ++k) {
      if (sign_of(k) == 0) continue;
      if (sign_of(k) != sign_of(last)) changes_.push_back({last, k});
      last = k;
    }
    join_near();
  }

  SignChange located(SignChange change) const {
    const double a = walk_.at(change.before).radial_curvature, b = walk_.at(change.after).radial_curvature;
    double t = a / (a - b);
    change.jump = jump_at({curve_, change.before, change.after, camera_});
    if (change.jump) t = change.jump->t;
    change.place = glm::mix(static_cast<double>(change.before), static_cast<double>(change.after), std::clamp(t, 0.0, 1.0 - 1e-9));
    change.turn = change.jump ? turn_of(change) : change.place;
    return change;
  }
  double turn_of(const SignChange& change) const {
    double turn = change.place, least = 0.0;
    const size_t n = walk_.size();
    for (size_t i = change.before; i <= change.after; ++i) {
      if (!curve_.closed && (i == 0 || i + 1 >= n)) continue;
      const glm::dvec2 comes = walk_.at(i).px - walk_.at(i + n - 1).px, goes = walk_.at(i + 1).px - walk_.at(i).px;
      const double lengths = glm::length(comes) * glm::length(goes);
      if (!(lengths > 0.0) || glm::dot(comes, goes) >= least * lengths) continue;
      least = glm::dot(comes, goes) / lengths;
      turn = static_cast<double>(i);
    }
    return turn;
  }
  /// Image length from one change to the next.
  double length_between(const SignChange& one, const SignChange& next) const {
    return walk_.length_to(static_cast<double>(next.before)) - walk_.length_to(static_cast<double>(one.after));
  }
  /// Changes so close to each other that nobody can tell them apart are one, or none where the last undoes the first.
  void join_near() {
    const size_t n = walk_.size();
    if (curve_.closed && !changes_.empty()) {
      // Around the curve from the widest gap on.
      size_t start = 0;
      double widest = length_between(changes_.back(), {changes_[0].before + n, changes_[0].after + n});
      for (size_t k = 1; k < changes_.size(); ++k) {
        if (const double gap = length_between(changes_[k - 1], changes_[k]); gap > widest) start = k, widest = gap;
      }
      for (size_t k = 0; k < start; ++k) changes_.push_back({changes_[k].before + n, changes_[k].after + n});
      changes_.erase(changes_.begin(), changes_.begin() + static_cast<std::ptrdiff_t>(start));
    }
    for (size_t k = 0; k < changes_.size();) {
      size_t end = k + 1;
      while (end < changes_.size() && length_between(changes_[end - 1], changes_[end]) < (curve_.between ? kKnownCusp_px : kOneCusp_px))
        ++end;
      if ((end - k) % 2 == 1)
        found_.apart.push_back(located({changes_[k].before, changes_[end - 1].after}));
      else
        found_.undone.push_back({changes_[k].before, changes_[end - 1].after});
      k = end;
    }
  }

  const SurfaceCurve& curve_;
  const CurveWalk& walk_;
  const Camera& camera_;
  double extent_;
  std::vector<SignChange> changes_{};
  SignChanges found_{};
};

}  // namespace

SignChanges sign_changes_of(const SurfaceCurve& curve, const CurveWalk& walk, const Camera& camera, double extent) {
  return SignChangeFinder(curve, walk, camera, extent).run();
}

}  // namespace limn
