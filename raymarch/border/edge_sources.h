#pragma once
// What the methods `roberts` and `sobel` share: sources, thresholds, the two modulations of the depth threshold, the debug view.

#include "raymarch/border.h"

namespace limn {

/// Both answer a straight step of height 1 along an axis with 1:
/// roberts  sqrt(h^2 + v^2) / sqrt(2), h and v the differences along the two diagonals of the pixels (x, y) .. (x+1, y+1);
/// sobel    sqrt(gx^2 + gy^2) / 4, with the 3x3 kernels [1 2 1] x [-1 0 1] about the pixel.
/// Pixels beyond the picture repeat its border. Vector sources add the squares of their components.
enum class EdgeOperator { roberts, sobel };

/// The factor of the depth threshold at grazing angles:
/// 1 + strength * smoothstep(0, 1 - hardness, saturate((fresnel + p - 1) / p)), fresnel = (1 - N.V)^power.
struct GrazingModulation {
  double p = 1.0, hardness = 0.0, power = 5.0, strength = 12.0;
};
double grazing_factor(const GrazingModulation& modulation, double n_dot_v);

/// How strongly the operator answers a slope of 1 per pixel, and so what depth threshold (in pixels) a plane calls for:
///
/// A plane n.p = k seen through the pixel ray Z d, d = (x/f, -y/f, -1), has 1/Z = n.d / k: linear in the image. Its gradient times f Z is
/// |n_xy| / (n.d) <= 1 / cos(theta), theta the angle at which that pixel's ray meets the plane; without perspective the slope of Z in
/// pixels is tan(theta). So with the operator applied to 1/Z (perspective) or Z (orthographic), the depth threshold `t` growing as Z
/// (which makes it a number of pixel sizes at that depth) and the grazing factor `m`, a plane gives no line wherever
///     t m(theta) >= slope_gain / cos(theta),
/// whatever the picture's size and the focal length. The default t = 5 slope_gain needs no factor up to 78 degrees, so that normals which
/// are off (averaged over a hard edge) do little harm; from there m >= 1/(5 cos(theta)) is asked for. Power 5 (Schlick's) with p = 1 and
/// hardness 0 keeps above that curve up to 89 degrees with a strength of 10.7; the default is 12. With a strength of 1, a factor of two
/// at most, t would have to be 29 slope_gain.
double slope_gain(EdgeOperator edge_operator);

std::vector<Parameter> edge_parameters(EdgeOperator edge_operator);
Border draw_edges(EdgeOperator edge_operator, const std::string& name, const BorderInput& input, const Parameters& parameters);

}  // namespace limn
