#pragma once
// How far a model's normals move the inner border: to where the changed N.V meets the threshold, on straight lines across the true border.

#include <span>
#include <vector>

#include "raymarch/gbuffer.h"

namespace limn {

/// A line across the true border.
struct ShiftLine {
  glm::dvec2 px{0.0}, outward{0.0};  ///< Image point of the true border; unit, px, y down: to where N.V is above the threshold.
  glm::dvec3 position{0.0};          ///< World, of the true border.
  double px_per_unit = 0.0;          ///< Pixels for each world unit at its depth.
  int object = 0;                    ///< Index from 1: the border's own sheet.
  double n_dot_v = 0.0;              ///< Of the true surface there: the threshold, in (0, 1).
  double px_per_radian = 0.0;        ///< How far the border moves for each radian of normal error, to first order.
  size_t curve = 0;                  ///< Of the true border; lines of one curve follow each other, along it.
};

/// Which assumption fails where no shift is predicted.
enum class ShiftFault {
  none,
  outside,     ///< The model shows its surface where the true border is: it shows another sheet there, or none.
  covered,     ///< The surface goes on: it ends, or another sheet covers it, before N.V meets the threshold.
  turns_back,  ///< N.V meets the threshold: it turns back before that, or gets there too slowly for a few image points to tell.
};

/// Where the border is expected on one line.
struct SolvedShift {
  double shift_px = 0.0;        ///< Positive outwards. With a fault: as far as the surface and the search go.
  double uncertainty_px = 0.0;  ///< The border is expected within so much of it.
  double first_order_px = 0.0;  ///< eps * px_per_radian.
  double normal_error = 0.0;    ///< eps at the true border, radians, positive where N.V is too low.
  ShiftFault fault = ShiftFault::none;
};

/// Asks `model` for its normals at eleven image points of each line: the true border's own, four where the answers so far put the border,
/// and six around them that tell whether N.V meets the threshold more than once. Its N.V between them, squared, is taken as a parabola.
/// Where it meets the threshold several times, as beside a seam that a model rounds, the places that follow each other most closely along
/// the true border are taken, as a measured border is matched. No shift is larger than `reach_px`.
/// The uncertainty is what the last image point changed, and of what is between them a share that was found on models whose border was
/// measured (docs/accuracy.md), at least what a measured border is precise to; and as far as the next place where N.V meets the threshold.
std::vector<SolvedShift> solve_shifts(const SceneModel& model, const Camera& camera, std::span<const ShiftLine> lines, double reach_px);

}  // namespace limn
