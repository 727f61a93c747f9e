#pragma once
// Internal: where the true border is not determined well enough to judge a model by it.

#include <span>

#include "raymarch/curves/border_match.h"

namespace limn {

/// One for each sample of `truth`. Nothing but truth and camera decides.
std::vector<IllReason> ill_places(const BorderCurves& truth, std::span<const BorderSample> samples, const Camera& camera);

}  // namespace limn
