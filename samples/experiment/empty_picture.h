#pragma once

#include <string>
#include <vector>

#include "raymarch/gbuffer.h"

namespace limn {

/// Why a picture shows nothing, or next to nothing of what its objects' bounds promise, in sentences; none where it shows what it should.
/// The objects are looked at one by one: behind the camera, outside the frame, too small, without a surface.
std::vector<std::string> why_empty(const Scene& scene, const SceneModel& model, const Camera& camera, const HitCounts& counts);

/// True for the sentences of why_empty among other warnings.
bool says_empty(const std::string& warning);

}  // namespace limn
