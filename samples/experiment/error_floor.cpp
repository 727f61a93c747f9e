#include "samples/experiment/error_floor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace limn {
namespace {

/// Two digits; a floor is rounded up, so that nothing below it is quoted.
std::string px_text(double px) { return px >= 99.5 ? fmt::format("{:.0f} px", px) : fmt::format("{:.2g} px", px); }
double rounded_up(double px) {
  if (!(px > 0.0) || !std::isfinite(px)) return px;
  const double unit = std::pow(10.0, std::floor(std::log10(px)) - 1.0);
  return std::ceil(px / unit - 1e-9) * unit;
}

double doubt_px(const ErrorFloor& floor) { return floor.exact ? 0.0 : floor.truth_bound_px; }

}  // namespace

double ErrorFloor::px() const { return std::max({kPrecision_px, std::isnan(reference_px) ? 0.0 : std::abs(reference_px), truth_bound_px}); }

Verdict judge(double error_px, double tolerance_px, const ErrorFloor& floor) {
  if (std::isnan(error_px)) return Verdict::not_to_be_told;
  if (error_px - doubt_px(floor) > tolerance_px) return Verdict::wrong;
  return error_px <= largest_right_px(tolerance_px, floor) ? Verdict::right : Verdict::not_to_be_told;
}

double largest_right_px(double tolerance_px, const ErrorFloor& floor) {
  return floor.px() <= tolerance_px ? tolerance_px - doubt_px(floor) : -std::numeric_limits<double>::infinity();
}

std::string error_text(double error_px, const ErrorFloor& floor) {
  const double least = floor.px();
  if (!std::isfinite(least)) return px_text(error_px);
  return error_px < least ? "less than " + px_text(rounded_up(least)) : px_text(error_px);
}

std::string bound_text(const ErrorFloor& floor) { return px_text(rounded_up(floor.truth_bound_px)); }

std::string why_not_to_be_told(double tolerance_px, const ErrorFloor& floor) {
  if (floor.truth_bound_px > tolerance_px) {
    return std::isfinite(floor.truth_bound_px) ? "the true border itself may be " + bound_text(floor) + " off"
                                               : "nobody knows how far the true border itself is off";
  }
  if (floor.px() > tolerance_px) return "the reference itself scores " + px_text(rounded_up(floor.px()));
  return "";
}

}  // namespace limn
