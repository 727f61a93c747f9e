#include "raymarch/lines/form_trimming.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <numbers>

#include "raymarch/analytic/clip_ray.h"
#include "raymarch/lines/trig_polynomial.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr int kPieces = 64;  // of a curve whose zeros are searched for along it
constexpr int kValidityPieces = 256;
constexpr double kBulge = 0.05;  // of a step's length, so that arcs are little longer than their chords
constexpr double kLonger = 1.05;
constexpr double kFarLonger = 1e3;
constexpr double kUneven = 4.0;                   // times as long as the other half of a step in the parameter
constexpr int kDeepest = 48;                      // halvings of a piece
constexpr double kLong = 100.0;                   // times the extent
constexpr int kHalvings = 8, kLongHalvings = 14;  // of a step in which zeros are looked for; where two pieces are all of a run
constexpr double kFinest = 1e-7;                  // of the extent: no zeros are looked for between places nearer to each other

double box_value(const Box& box, const glm::dvec3& p) {
  const glm::dvec3 beyond = glm::max(box.lower - p, p - box.upper);
  return std::max({beyond.x, beyond.y, beyond.z});
}

/// A place on the curve and the length of the curve up to it.
struct Station {
  double s = 0.0;
  glm::dvec3 p{0.0};
  double length = 0.0;
  bool far = false;  ///< The step up to it bends beside the box and does not come near: its length is more than is known.
};

class Trimmer {
 public:
  Trimmer(const FormBody& body, const FormCurve& curve, const Box& box, const FormTree& tree)
      : body_(body), curve_(curve), box_(dilate(box, 1e-9 * body.extent)), tree_(tree) {}

  std::vector<FormArc> run() {
    if (tree_.nodes.empty() || !find_range()) return {};
    for (const FormNode& node : tree_.nodes) {
      if (node.surface >= 0 && node.surface != curve_.first && node.surface != curve_.second) add_breaks(node.surface);
    }
    return arcs();
  }

 private:
  /// Limits of the parameter, and breaks where the curve leaves the box.
  bool find_range() {
    begin_ = curve_.begin;
    end_ = curve_.end;
    switch (curve_.kind) {
      case FormCurve::Kind::line:
        return clip_ray(box_, curve_.origin, curve_.x, begin_, end_);
      case FormCurve::Kind::ellipse:
        for (int axis = 0; axis < 3; ++axis) {
          for (const double side : {box_.lower[axis], box_.upper[axis]})
            add_zeros({curve_.origin[axis] - side, curve_.x[axis], curve_.y[axis], 0.0, 0.0});
        }
        if (is_long()) find_stations_within();
        return true;
      default:
        find_stations();
        add_breaks_along([&](const glm::dvec3& p) { return box_value(box_, p); });
        return true;
    }
  }

  void add_zeros(const TrigPolynomial& f) {
    for (const double u : zeros_of(f)) breaks_.push_back(u);
  }

  void add_breaks(int number) {
    const FormSurface& surface = body_.surfaces[static_cast<size_t>(number)];
    if (surface.kind != ClosedFormKind::torus && curve_.kind == FormCurve::Kind::line) {
      std::array<double, 2> roots{};
      const int count = along_line(surface, curve_.origin, curve_.x).quadratic.roots(roots);
      for (int i = 0; i < count; ++i) breaks_.push_back(roots[static_cast<size_t>(i)]);
    } else if (surface.kind != ClosedFormKind::torus && curve_.kind == FormCurve::Kind::ellipse && !is_long()) {
      add_zeros(along_ellipse(surface));
    } else {
      if (stations_.empty() && !is_long()) find_stations();
      add_breaks_along([&](const glm::dvec3& p) { return signed_value(surface, p); });
    }
  }

  /// On an ellipse a hundred times as long as the body the terms of a quadratic's polynomial are so large that their sum has lost half its
  /// digits: zeros are looked for along what of it lies in the box.
  bool is_long() const {
    return curve_.kind == FormCurve::Kind::ellipse && std::max(glm::length(curve_.x), glm::length(curve_.y)) > kLong * body_.extent;
  }

  TrigPolynomial along_ellipse(const FormSurface& surface) const {
    const glm::dvec3 o = surface.form_from_world.point(curve_.origin), x = surface.form_from_world.vector(curve_.x),
                     y = surface.form_from_world.vector(curve_.y);
    if (surface.kind == ClosedFormKind::half_space) return {o.y, x.y, y.y, 0.0, 0.0};
    const auto form = [&](const glm::dvec3& a, const glm::dvec3& b) { return bilinear(surface.kind, a, b); };
    const double xx = form(x, x), yy = form(y, y);
    return {form(o, o) - bilinear_constant(surface.kind) + 0.5 * (xx + yy), 2.0 * form(o, x), 2.0 * form(o, y), 0.5 * (xx - yy),
            form(x, y)};
  }

  /// Runs of stations where the curve is valid, and breaks at their ends.
  void find_stations() {
    if (curve_.kind != FormCurve::Kind::ruled) {
      add_run(begin_, end_);
      return;
    }
    const auto place = [&](int i) { return begin_ + (end_ - begin_) * i / kValidityPieces; };
    double from = begin_;
    bool valid = validity(curve_, begin_) > 0.0;
    for (int i = 1; i <= kValidityPieces; ++i) {
      const bool next = validity(curve_, place(i)) > 0.0;
      if (next == valid) continue;
      double in = place(valid ? i - 1 : i), out = place(valid ? i : i - 1);
      for (int step = 0; step < 60; ++step) (validity(curve_, 0.5 * (in + out)) > 0.0 ? in : out) = 0.5 * (in + out);
      if (valid) add_run(from, in);
      from = in;
      breaks_.push_back(in);
      valid = next;
    }
    if (valid) add_run(from, end_);
  }
  /// The same of a long ellipse, given the breaks where it leaves the box.
  void find_stations_within() {
    std::sort(breaks_.begin(), breaks_.end());
    const size_t count = breaks_.size();
    for (size_t i = 0; i < count; ++i) {
      const double from = breaks_[i], to = i + 1 < count ? breaks_[i + 1] : breaks_[0] + kTurn;
      if (box_value(box_, point_of(curve_, 0.5 * (from + to))) <= 0.0) add_run(from, to);
    }
  }
  void add_run(double from, double to) {
    run_begins_.push_back(stations_.size());
    Station a{from, point_of(curve_, from), 0.0};
    stations_.push_back(a);
    const int pieces = std::max(2, static_cast<int>(std::ceil(kPieces * (to - from) / (end_ - begin_))));
    for (int i = 1; i <= pieces; ++i) {
      const double s = from + (to - from) * i / pieces;
      const Station b{s, point_of(curve_, s), 0.0};
      add_between(a, b, kDeepest);
      a = b;
    }
  }
  void add_between(const Station& a, const Station& b, int depth) {
    const double s = 0.5 * (a.s + b.s), chord = glm::distance(a.p, b.p);
    const Station middle{s, point_of(curve_, s), 0.0};
    const double one = glm::distance(a.p, middle.p), other = glm::distance(middle.p, b.p);
    const bool far = std::min(box_value(box_, a.p), box_value(box_, b.p)) > 2.0 * (one + other);
    const bool bent = one + other > (1.0 + kBulge) * chord && one + other > kFinest * body_.extent;
    const bool uneven = std::max(one, other) > kUneven * std::min(one, other) && one + other > kFinest * body_.extent;
    if (depth > 0 && !far && (bent || uneven)) {
      add_between(a, middle, depth - 1);
      add_between(middle, b, depth - 1);
      return;
    }
    const bool unknown = far && bent;
    stations_.push_back({b.s, b.p, stations_.back().length + (unknown ? kFarLonger : 1.0) * (one + other), unknown});
  }

  template <class Value>
  void add_breaks_along(const Value& value) {
    for (size_t run = 0; run < run_begins_.size(); ++run) {
      const size_t first = run_begins_[run], last = run + 1 < run_begins_.size() ? run_begins_[run + 1] - 1 : stations_.size() - 1;
      search(value, first, value(stations_[first].p), last, value(stations_[last].p));
    }
  }
  /// Between two stations there is no zero where the value cannot reach it, as steep as it is.
  template <class Value>
  void search(const Value& value, size_t i, double fi, size_t j, double fj) {
    const Station &a = stations_[i], &b = stations_[j];
    const bool differ = (fi <= 0.0) != (fj <= 0.0);
    if (!differ && std::fabs(fi) + std::fabs(fj) > kLonger * (b.length - a.length)) return;
    if (j - i > 1) {
      const size_t middle = (i + j) / 2;
      const double f = value(stations_[middle].p);
      search(value, i, fi, middle, f);
      search(value, middle, f, j, fj);
    } else if (!b.far) {
      search_step(value, {a.s, a.p, 0.0}, fi, {b.s, b.p, 0.0}, fj, is_long() ? kLongHalvings : kHalvings);
    }
  }
  template <class Value>
  void search_step(const Value& value, const Station& a, double fa, const Station& b, double fb, int depth) {
    const bool differ = (fa <= 0.0) != (fb <= 0.0);
    if (!differ && (depth == 0 || std::fabs(fa) + std::fabs(fb) > kLonger * glm::distance(a.p, b.p))) return;
    if (depth == 0) {
      const double zero = zero_between(value, a.s, fa, b.s);
      breaks_.push_back(curve_.closed && zero >= end_ ? zero - kTurn : zero);
      return;
    }
    const double s = 0.5 * (a.s + b.s);
    const Station middle{s, point_of(curve_, s), 0.0};
    const double f = value(middle.p);
    search_step(value, a, fa, middle, f, depth - 1);
    search_step(value, middle, f, b, fb, depth - 1);
  }
  template <class Value>
  double zero_between(const Value& value, double a, double fa, double b) const {
    for (int step = 0; step < 60 && b - a > 1e-15 * (std::fabs(a) + std::fabs(b)); ++step) {
      const double middle = 0.5 * (a + b), f = value(point_of(curve_, middle));
      ((f <= 0.0) == (fa <= 0.0) ? a : b) = middle;
    }
    return 0.5 * (a + b);
  }

  /// 0: not on the surface; 1: on it; 2: on it, and concave.
  int state_at(double s) {
    if (curve_.closed && s > curve_.end) s -= kTurn;
    if (!(validity(curve_, s) > 0.0)) return 0;
    const glm::dvec3 p = point_of(curve_, s);
    if (box_value(box_, p) > 0.0) return 0;
    const unsigned sides = outcomes(body_, tree_, p, curve_.first, curve_.second, scratch_);
    if (curve_.second < 0) return sides == 12u ? 1 : 0;
    return sides == 8u ? 1 : sides == 14u ? 2 : 0;
  }

  std::vector<FormArc> arcs() {
    std::vector<FormArc> result;
    std::sort(breaks_.begin(), breaks_.end());
    std::vector<double> ends;
    if (!curve_.closed) ends.push_back(begin_);
    for (const double s : breaks_) {
      if (s > begin_ - (curve_.closed ? 1e-300 : 0.0) && s < end_ && (ends.empty() || s > ends.back())) ends.push_back(s);
    }
    if (!curve_.closed) ends.push_back(end_);
    if (ends.empty()) {
      if (const int state = state_at(0.37 * begin_ + 0.63 * end_)) result.push_back({begin_, end_, true, state == 2});
      return result;
    }
    if (curve_.closed) ends.push_back(ends.front() + kTurn);
    for (size_t i = 0; i + 1 < ends.size(); ++i) {
      const int state = state_at(0.5 * (ends[i] + ends[i + 1]));
      if (state == 0) continue;
      if (!result.empty() && result.back().to == ends[i]) {
        result.back().to = ends[i + 1];
      } else {
        result.push_back({ends[i], ends[i + 1], false, state == 2});
      }
    }
    if (curve_.closed && !result.empty() && result.back().to == ends.back() && result.front().from == ends.front()) {
      if (result.size() == 1) {
        result[0].closed = true;
      } else {
        // Over the first break.
        result.back().to = result.front().to + kTurn;
        result.erase(result.begin());
      }
    }
    return result;
  }

  const FormBody& body_;
  const FormCurve& curve_;
  Box box_;
  const FormTree& tree_;
  double begin_ = 0.0, end_ = 0.0;
  std::vector<double> breaks_{};
  std::vector<Station> stations_{};
  std::vector<size_t> run_begins_{};
  std::vector<unsigned> scratch_{};
};

/// Surfaces that matter in one cell, and pairs of them, with the box around all such cells.
std::map<std::pair<int, int>, Box> meetings_in(const FormBody& body) {
  std::map<std::pair<int, int>, Box> meetings;
  for (const FormCell& cell : body.cells) {
    if (cell.lower >= 0) continue;
    std::vector<int> here;
    for (const FormNode& node : cell.tree.nodes) {
      if (node.surface >= 0) here.push_back(node.surface);
    }
    std::sort(here.begin(), here.end());
    for (size_t j = 0; j < here.size(); ++j) {
      const auto add = [&](int second) {
        Box& box = meetings[{here[j], second}];
        box = merge(box, cell.box);
      };
      add(-1);
      for (size_t k = j + 1; k < here.size(); ++k) add(here[k]);
    }
  }
  return meetings;
}

}  // namespace

std::vector<FormArc> trimmed(const FormBody& body, const FormCurve& curve, const Box& box, const FormTree& tree) {
  return Trimmer(body, curve, box, tree).run();
}

FormMeetings form_meetings(FormBody body, const ExecutionSettings& execution) {
  FormMeetings result;
  for (const auto& [pair, box] : meetings_in(body)) result.all.push_back({pair.first, pair.second, box});
  std::atomic<bool> known = true;
  parallel_for(size_t{0}, result.all.size(), [&](size_t i) {
    if (execution.cancelled && execution.cancelled()) throw Cancelled{};
    if (!known) return;
    FormMeeting& meeting = result.all[i];
    meeting.tree = tree_in(body, meeting.box);
    if (meeting.second < 0) return;
    const auto curves = seams_of(body, meeting.first, meeting.second);
    if (!curves) known = false;
    if (!curves) return;
    for (const FormCurve& curve : *curves) {
      std::vector<FormArc> arcs = trimmed(body, curve, meeting.box, meeting.tree);
      if (!arcs.empty()) meeting.seams.push_back({curve, std::move(arcs)});
    }
  });
  result.known = known;
  result.body = std::move(body);
  return result;
}

}  // namespace limn
