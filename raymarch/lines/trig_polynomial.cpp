#include "raymarch/lines/trig_polynomial.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace limn {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kNarrow = 1e-7;    // zeros nearer to each other are one
constexpr double kTouches = 3e-14;  // of the polynomial's size

double bisected(const TrigPolynomial& f, double a, double b) {
  const bool below = f.value(a) < 0.0;
  for (int step = 0; step < 60 && b - a > 1e-16 * b; ++step) {
    const double middle = 0.5 * (a + b), value = f.value(middle);
    // Newton's step from the middle, where it stays within.
    const double newton = middle - value / f.slope(middle);
    ((value < 0.0) == below ? a : b) = middle;
    if (!(newton > a && newton < b)) continue;
    const double near = std::clamp(std::fabs(newton - middle) * 0.01, 1e-16, b - a);
    for (const double u : {newton - near, newton + near}) {
      if (u > a && u < b) ((f.value(u) < 0.0) == below ? a : b) = u;
    }
  }
  return 0.5 * (a + b);
}

/// By Taylor's theorem about the middle: no zero, one at most, or two halves.
struct ZeroSearch {
  const TrigPolynomial& f;
  double bend, touch;
  std::vector<double> found{};

  void run(double a, double fa, double b, double fb) {
    const double middle = 0.5 * (a + b), half = 0.5 * (b - a), value = f.value(middle), slope = std::fabs(f.slope(middle));
    if (std::fabs(value) > slope * half + 0.5 * bend * half * half) return;
    const bool differ = (fa < 0.0) != (fb < 0.0);
    if (slope > bend * half) {
      if (differ) found.push_back(bisected(f, a, b));
      return;
    }
    if (half < kNarrow) {
      if (differ || std::fabs(value) < touch) found.push_back(middle);
      return;
    }
    run(a, fa, middle, value);
    run(middle, value, b, fb);
  }
};

}  // namespace

double TrigPolynomial::value(double u) const {
  const double c = std::cos(u), s = std::sin(u);
  return constant + cosine * c + sine * s + cosine2 * (c * c - s * s) + sine2 * 2.0 * s * c;
}
double TrigPolynomial::slope(double u) const {
  const double c = std::cos(u), s = std::sin(u);
  return sine * c - cosine * s + 2.0 * (sine2 * (c * c - s * s) - cosine2 * 2.0 * s * c);
}
double TrigPolynomial::size() const {
  return std::fabs(constant) + std::fabs(cosine) + std::fabs(sine) + std::fabs(cosine2) + std::fabs(sine2);
}

TrigPolynomial trig_through(const std::function<double(double)>& f) {
  TrigPolynomial result;
  for (int i = 0; i < 5; ++i) {
    const double u = kTurn * i / 5.0, value = f(u);
    result.constant += 0.2 * value;
    result.cosine += 0.4 * value * std::cos(u);
    result.sine += 0.4 * value * std::sin(u);
    result.cosine2 += 0.4 * value * std::cos(2.0 * u);
    result.sine2 += 0.4 * value * std::sin(2.0 * u);
  }
  return result;
}

std::vector<double> zeros_of(const TrigPolynomial& f) {
  const double bend = std::fabs(f.cosine) + std::fabs(f.sine) + 4.0 * (std::fabs(f.cosine2) + std::fabs(f.sine2));
  ZeroSearch search{f, bend, kTouches * f.size()};
  if (std::fabs(f.constant) > f.size() - std::fabs(f.constant)) return {};
  constexpr int kParts = 4;
  for (int i = 0; i < kParts; ++i) {
    const double a = kTurn * i / kParts, b = kTurn * (i + 1) / kParts;
    search.run(a, f.value(a), b, i + 1 == kParts ? f.value(0.0) : f.value(b));
  }
  for (double& u : search.found) {
    if (u >= kTurn) u -= kTurn;
  }
  std::sort(search.found.begin(), search.found.end());
  return std::move(search.found);
}

PositiveRanges positive_ranges(const TrigPolynomial& f) {
  PositiveRanges result;
  const std::vector<double> zeros = zeros_of(f);
  if (zeros.empty()) {
    result.everywhere = f.value(0.0) > 0.0;
    return result;
  }
  for (size_t i = 0; i < zeros.size(); ++i) {
    const double from = zeros[i], to = i + 1 < zeros.size() ? zeros[i + 1] : zeros[0] + kTurn;
    if (to - from > 2.0 * kNarrow && f.value(0.5 * (from + to)) > kTouches * f.size()) result.ranges.push_back({from, to});
  }
  return result;
}

}  // namespace limn
