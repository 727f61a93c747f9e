#pragma once
// Internal: what one frame of a sequence leaves to the next.

#include <span>

#include "raymarch/picture.h"

namespace limn {

/// True where a method's ink depends on that of the frame before.
bool holds_ink(std::span<const MethodCall> methods);

/// Hands a sample's inks of the frame before on, and where they were.
SampleInks inks_before(FrameHistory& history, size_t sample, const GBuffer& gbuffer, const Camera& camera);

/// Keeps a sample for the next frame, with inks_before() of it. Unless `copied` the history takes the G-buffer, and `gbuffer` is that of
/// the frame before: memory to draw into.
void keep(FrameHistory& history, size_t sample, bool copied, GBuffer& gbuffer, SampleInks& inks);

/// Both of a frame whose methods do not hold on to their ink: of its first sample, without inks.
void follow(FrameHistory& history, bool copied, const Camera& camera, GBuffer& gbuffer);

}  // namespace limn
