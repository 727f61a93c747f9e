#pragma once
// What may be said of a border's error: right, wrong, or not to be told. One rule for comparisons, studies and plans.

#include <string>

namespace limn {

/// Crossings are bracketed to less than this (MeasuredBorderSettings::precision_px on both sides).
inline constexpr double kPrecision_px = 0.005;

/// Reports call a model right whose border is this near to truth.
inline constexpr double kTolerancePx = 0.5;

/// How small an error can be told from none.
struct ErrorFloor {
  double reference_px = 0.0;    ///< What the reference scores through the same measurement.
  double truth_bound_px = 0.0;  ///< BorderTruth::bound_px, the worst of all views.
  bool exact = true;            ///< BorderTruth::exact of all views.

  /// Less than this says nothing, px: infinite where nobody knows how far off truth is.
  double px() const;
};

/// not_to_be_told: the tolerance lies below the floor, or truth is a stand-in that may itself be that far off.
enum class Verdict { right, wrong, not_to_be_told };

/// Of an error against a tolerance, both px. What a truth that is not exact may be off counts against either answer.
Verdict judge(double error_px, double tolerance_px, const ErrorFloor& floor);

/// The largest error that is right to the tolerance; below 0 where none can be called so.
double largest_right_px(double tolerance_px, const ErrorFloor& floor);

/// "0.13 px"; "less than 0.006 px" for what lies below the floor.
std::string error_text(double error_px, const ErrorFloor& floor);

/// How far off the true border may be: "0.13 px", rounded up.
std::string bound_text(const ErrorFloor& floor);

/// Why nothing can be called right to a tolerance; empty where it can.
std::string why_not_to_be_told(double tolerance_px, const ErrorFloor& floor);

}  // namespace limn
