#pragma once
// Sizes and places that arithmetic can hold.

#include "raymarch/scene.h"

namespace limn {

/// Longest sides that rays of single precision can be traced against: squares and products of lengths neither overflow nor vanish.
inline constexpr double kLeastSide = 1e-12, kMostSide = 1e12;
/// An object must be so many steps of double precision wide where it lies.
inline constexpr double kLeastSteps = 1024.0;

/// Throws InputError, naming the object's file, where an object is too large, too small, or so far from the origin that the coordinates
/// there do not hold its shape. Unbounded fields and empty objects pass.
void check_extent(const Scene& scene);

}  // namespace limn
