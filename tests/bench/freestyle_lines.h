#pragma once
// The silhouette of a sphere by Blender's Freestyle, where `blender` is on the PATH.

#include <optional>

namespace limn::bench {

/// How long it took, and how far it lies from the circle.
struct Silhouette {
  double ms = 0.0, worst_px = 0.0, rms_px = 0.0;
};
/// Of a mesh with about `faces` faces, by parallel projection into a picture of `size_px` squared that is 2.4 radii wide.
std::optional<Silhouette> freestyle_silhouette(int faces, int size_px);
/// The same sphere, as a formula, by limn.
Silhouette limn_silhouette(int size_px, int threads);

}  // namespace limn::bench
