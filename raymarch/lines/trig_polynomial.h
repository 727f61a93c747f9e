#pragma once
// Internal: trigonometric polynomials of degree 2 and where they vanish.

#include <functional>
#include <vector>

namespace limn {

/// constant + cosine cos u + sine sin u + cosine2 cos 2u + sine2 sin 2u
struct TrigPolynomial {
  double constant = 0.0, cosine = 0.0, sine = 0.0, cosine2 = 0.0, sine2 = 0.0;
  double value(double u) const;
  double slope(double u) const;
  double size() const;  ///< No value is larger.
};

/// That of degree 2 through `f` at five angles.
TrigPolynomial trig_through(const std::function<double(double)>& f);

/// In [0, 2 pi), in order; places that the polynomial touches to rounding are among them once or twice.
std::vector<double> zeros_of(const TrigPolynomial& f);

/// Where it is above 0: from an angle to a larger one, the last of which may be beyond 2 pi.
struct AngleRange {
  double from = 0.0, to = 0.0;
};
struct PositiveRanges {
  bool everywhere = false;
  std::vector<AngleRange> ranges{};
};
PositiveRanges positive_ranges(const TrigPolynomial& f);

}  // namespace limn
