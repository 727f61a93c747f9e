#include "raymarch/analytic/march_field.h"

#include <cmath>

#include "raymarch/analytic/block.h"

namespace limn {
namespace {

void put_ray(const RayBatch& rays, int lane, int i, LaneRays& packet) {
  packet.origin[0][i] = rays.origin_x[lane];
  packet.origin[1][i] = rays.origin_y[lane];
  packet.origin[2][i] = rays.origin_z[lane];
  packet.direction[0][i] = rays.direction_x[lane];
  packet.direction[1][i] = rays.direction_y[lane];
  packet.direction[2][i] = rays.direction_z[lane];
}

// Outside this share of the extent a step |f|/L is cheaper than an interval; inside it intervals converge faster.
constexpr double kIsolationDistance = 0.02;
constexpr int kMaxSphereSteps = 64;
// Stretches are not cut below this share of the extent: whether a ray touches within it is decided by the sign of f at the ends.
constexpr double kResolution = 1e-10;
// Rounding noise of f, as a share of Lipschitz constant times extent.
constexpr double kNoise = 1e-13;
constexpr double kRootTolerance = 1e-12;

void write_out_of_steps(int lane, double t, HitBatch& hits) {
  hits.status[lane] = HitStatus::out_of_steps;
  hits.t[lane] = static_cast<float>(t);
  hits.face[lane] = -1;
  hits.material[lane] = 0;
}

double extent_of(const MarchLimits& limits, const RayBatch& rays, int lane) {
  if (limits.extent > 0.0) return limits.extent;
  return std::max(glm::length(glm::dvec3(rays.origin(lane))),
                  1e-5 * (static_cast<double>(rays.t_max[lane]) - static_cast<double>(rays.t_min[lane])));
}

/// Sixteen rays of a list at a time; `t` repeats the first lane's in lanes that are not used.
struct Packet {
  LaneRays rays;
  LaneArray t;
  int lane[kLanes];
  int count = 0;
};

void take(const RayBatch& rays, StretchList& list, int first, Packet& packet) {
  packet.count = std::min(kLanes, list.count - first);
  for (int i = 0; i < kLanes; ++i) {
    const Stretch& s = list[first + (i < packet.count ? i : 0)];
    packet.lane[i] = s.lane;
    packet.t[i] = s.t;
  }
  packet.rays = gather_rays(rays, packet.lane, kLanes);
}

}  // namespace

LaneRays gather_rays(const RayBatch& rays, const int* lane, int count) {
  LaneRays packet;
  for (int i = 0; i < kLanes; ++i) put_ray(rays, lane[i < count ? i : 0], i, packet);
  return packet;
}

// Hart 1996.
void sphere_trace(const MarchTape& march, const MarchLimits& limits, const RayBatch& rays, TapeScratch& scratch, StretchList& list,
                  HitBatch& hits) {
  StretchList near;
  for (int step = 0; list.count > 0; ++step) {
    int kept = 0;
    for (int first = 0; first < list.count; first += kLanes) {
      Packet packet;
      take(rays, list, first, packet);
      LaneArray values;
      tape_values(*march.tape, march.steps, packet.rays, packet.t, scratch, values);
      for (int i = 0; i < packet.count; ++i) {
        Stretch s = list[first + i];
        if (s.sign == 0.0) s.sign = values[i] < 0.0 ? -1.0 : 1.0;
        const double advance = s.sign * values[i] / limits.lipschitz;
        if (++s.steps > limits.max_steps) {
          write_out_of_steps(s.lane, s.t, hits);
        } else if (advance > kIsolationDistance * extent_of(limits, rays, s.lane) && step < kMaxSphereSteps) {
          s.t += advance;
          if (s.t < s.t_end) list[kept++] = s;
        } else {
          near.add(s);
        }
      }
    }
    list.count = kept;
  }
  std::copy_n(near.items.begin(), near.count, list.items.begin());
  list.count = near.count;
}

namespace {

/// Sixteen rays being isolated; a lane that is done takes the next of the list.
struct IsolationPacket {
  LaneRays rays;
  LaneArray t, f, length, sign, t_end, end, value_at_end, extent;
  int item[kLanes];  ///< Index in the list; -1: idle.
  bool fresh[kLanes];
  int steps[kLanes];
};

bool refill(const RayBatch& rays, const MarchLimits& limits, StretchList& list, int& next, IsolationPacket& p) {
  bool any = false;
  for (int i = 0; i < kLanes; ++i) {
    if (p.item[i] < 0 && next < list.count) {
      const Stretch& s = list[next];
      p.item[i] = next++;
      p.fresh[i] = true;
      put_ray(rays, s.lane, i, p.rays);
      p.t[i] = s.t;
      p.t_end[i] = s.t_end;
      p.sign[i] = s.sign;
      p.steps[i] = s.steps;
      p.extent[i] = extent_of(limits, rays, s.lane);
    }
    any = any || p.item[i] >= 0;
  }
  return any;
}

/// True where f > 0 on the whole stretch: f lies above the line that falls from fa with the steepest slope and above the one that
/// rises to fb with it (the piecewise-linear bound of Lipschitz optimisation, Piyavskii 1972, with one constant for each side).
bool positive_between(double fa, double fb, double length, double least, double most) {
  if (least >= 0.0) return fa > 0.0;
  if (most <= 0.0) return fb > 0.0;
  const double x = std::clamp((most * length - fb + fa) / (most - least), 0.0, length);
  return fa + least * x > 0.0;
}

enum class Verdict { advance, step, bracket, miss, out_of_steps };

/// What bounds and value at the end say of one lane's stretch [t, end]; `step` moves `t` by an interval Newton step, and f there is due.
Verdict judge(const MarchLimits& limits, const LaneBounds& bounds, int i, IsolationPacket& p, double& b) {
  const double lipschitz = limits.lipschitz;
  const double noise = kNoise * lipschitz * (p.extent[i] + std::abs(p.t[i]));
  const double resolution = kResolution * p.extent[i] + 1e-14 * std::abs(p.t[i]);
  const double fb = p.value_at_end[i];
  double lower = bounds.lower[i], least = bounds.slope_lower[i], most = bounds.slope_upper[i];
  if (p.sign[i] < 0.0) {
    lower = -bounds.upper[i];
    least = -bounds.slope_upper[i];
    most = -bounds.slope_lower[i];
  }
  // The comparisons are false for NaN, which then bounds nothing.
  if (!(least > -lipschitz)) least = -lipschitz;
  if (!(most < lipschitz)) most = lipschitz;
  b = p.end[i];
  const double a = p.t[i];
  if (lower > 0.0 || (fb > 0.0 && positive_between(p.f[i], fb, b - a, least, most))) {
    p.f[i] = std::max(fb, 0.0);
    p.t[i] = b;
    p.length[i] *= 2.0;
    return p.t[i] < p.t_end[i] ? Verdict::advance : Verdict::miss;
  }
  if (most < 0.0 && fb <= 0.0) return Verdict::bracket;
  if (b - a <= resolution) {
    if (fb <= 0.0 || std::min(p.f[i], fb) <= noise) return Verdict::bracket;
    p.t[i] = b;
    p.f[i] = fb;
    p.length[i] *= 2.0;
    return p.t[i] < p.t_end[i] ? Verdict::advance : Verdict::miss;
  }
  p.length[i] = 0.5 * (b - a);
  const double steepest = std::max(-least, 1e-30 * lipschitz);
  p.t[i] = std::min(a + (1.0 - 1e-12) * p.f[i] / steepest, b);
  return p.t[i] < p.t_end[i] ? Verdict::step : Verdict::miss;
}

/// Takes a lane's verdict to its stretch; the lane is free afterwards unless it goes on.
void settle(Verdict verdict, double b, int i, StretchList& list, IsolationPacket& p, std::array<bool, kRayBatchSize>& found,
            HitBatch& hits) {
  if (verdict == Verdict::advance || verdict == Verdict::step) return;
  Stretch& s = list[p.item[i]];
  s.t = p.t[i];
  s.t_end = b;
  s.sign = p.sign[i];
  found[static_cast<size_t>(p.item[i])] = verdict == Verdict::bracket;
  if (verdict == Verdict::out_of_steps) write_out_of_steps(s.lane, s.t, hits);
  p.item[i] = -1;
}

}  // namespace

// By interval Newton steps from the left and bisection (Moore 1966; for rays: Mitchell 1990). Nothing before t holds a root at any time.
void isolate(const MarchTape& march, const MarchLimits& limits, const RayBatch& rays, TapeScratch& scratch, StretchList& list,
             HitBatch& hits) {
  if (list.count == 0) return;
  std::array<bool, kRayBatchSize> found{};
  IsolationPacket p;
  std::fill_n(p.item, kLanes, -1);
  // Idle lanes run along with some ray.
  for (int i = 0; i < kLanes; ++i) {
    put_ray(rays, list[0].lane, i, p.rays);
    p.t[i] = p.end[i] = list[0].t;
    p.length[i] = p.f[i] = 0.0;
    p.sign[i] = p.extent[i] = 1.0;
  }
  int next = 0;
  LaneBeams beams;
  LaneBounds bounds;
  LaneArray values;
  bool due = true;
  while (refill(rays, limits, list, next, p)) {
    for (int i = 0; i < kLanes; ++i) due = due || (p.item[i] >= 0 && p.fresh[i]);
    if (due) {
      tape_values(*march.tape, march.steps, p.rays, p.t, scratch, values);
      for (int i = 0; i < kLanes; ++i) {
        if (p.item[i] < 0) continue;
        if (p.sign[i] == 0.0) p.sign[i] = values[i] < 0.0 ? -1.0 : 1.0;
        p.f[i] = p.sign[i] * values[i];
        if (p.fresh[i]) {
          p.length[i] = std::max(4.0 * p.f[i] / limits.lipschitz, kResolution * p.extent[i] + 1e-14 * std::abs(p.t[i]));
          p.fresh[i] = false;
        }
        if (p.f[i] <= 0.0) settle(Verdict::bracket, p.t[i], i, list, p, found, hits);
      }
    }
    beams.rays = p.rays;
    for (int i = 0; i < kLanes; ++i) {
      if (p.item[i] >= 0) p.end[i] = std::min(p.t[i] + p.length[i], p.t_end[i]);
      beams.middle[i] = 0.5 * (p.t[i] + p.end[i]);
      beams.half[i] = std::max(p.end[i] - beams.middle[i], beams.middle[i] - p.t[i]);
      beams.radius[i] = beams.half[i] * limits.direction_length;
    }
    tape_values(*march.tape, march.steps, p.rays, p.end, scratch, p.value_at_end);
    tape_slope_bounds(*march.tape, march.steps, beams, scratch, bounds);
    due = false;
    for (int i = 0; i < kLanes; ++i) {
      if (p.item[i] < 0) continue;
      p.value_at_end[i] *= p.sign[i];
      double b = p.t[i];
      Verdict verdict = Verdict::out_of_steps;
      if (++p.steps[i] <= limits.max_steps) verdict = judge(limits, bounds, i, p, b);
      due = due || verdict == Verdict::step;
      settle(verdict, b, i, list, p, found, hits);
    }
  }
  int kept = 0;
  for (int k = 0; k < list.count; ++k) {
    if (found[static_cast<size_t>(k)]) list[kept++] = list[k];
  }
  list.count = kept;
}

void polish(const MarchTape& march, const MarchLimits& limits, const RayBatch& rays, TapeScratch& scratch, StretchList& list,
            HitBatch& hits) {
  for (int first = 0; first < list.count; first += kLanes) {
    Packet packet;
    take(rays, list, first, packet);
    LaneArray a, b, step, sign, values, slopes, tolerance;
    unsigned going = (1u << packet.count) - 1u;
    const unsigned lanes = going;
    for (int i = 0; i < kLanes; ++i) {
      const Stretch& s = list[first + (i < packet.count ? i : 0)];
      a[i] = s.t;
      b[i] = s.t_end;
      sign[i] = s.sign;
      packet.t[i] = 0.5 * (a[i] + b[i]);
      step[i] = 2.0 * (b[i] - a[i]);
      tolerance[i] = kRootTolerance * (extent_of(limits, rays, s.lane) + std::abs(packet.t[i]));
    }
    // 200 halvings exhaust any bracket; the bound only guards against NaN.
    for (int round = 0; going != 0 && round < 200; ++round) {
      tape_slopes(*march.tape, march.steps, packet.rays, packet.t, scratch, values, slopes);
      for (int i = 0; i < packet.count; ++i) {
        if (!(going >> i & 1u)) continue;
        const double f = sign[i] * values[i], slope = sign[i] * slopes[i];
        (f > 0.0 ? a[i] : b[i]) = packet.t[i];
        // Newton's point where it stays in the bracket and shrinks the steps, else the middle.
        const double newton = packet.t[i] - f / slope;
        const bool inside = newton >= a[i] - tolerance[i] && newton <= b[i] + tolerance[i];
        const double to = inside && 2.0 * std::abs(newton - packet.t[i]) <= step[i] ? newton : 0.5 * (a[i] + b[i]);
        step[i] = std::abs(to - packet.t[i]);
        packet.t[i] = to;
        if (step[i] <= tolerance[i]) going &= ~(1u << i);
      }
    }
    write_roots(march, rays, packet.rays, packet.t, sign, packet.lane, 0, lanes, scratch, hits);
  }
}

}  // namespace limn
