#pragma once
// The frames of `limn contours --frames`: a camera for every time, and the lines in between.

#include <functional>

#include "raymarch/framing.h"
#include "samples/commands/options.h"

namespace limn {

/// The camera at a time; frames are 1 apart. With --turn it goes round the target, else it wanders from each frame's place to the next.
using CameraAt = std::function<Camera(double time)>;
CameraAt cameras_of_frames(const Options& options, const CameraSettings& settings, const FramedSurface& framed);

}  // namespace limn
