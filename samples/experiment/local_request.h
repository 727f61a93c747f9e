#pragma once
// What `local` asks for, resolved.

#include "raymarch/local_model.h"
#include "raymarch/picture.h"
#include "samples/spec/spec.h"

namespace limn {

/// For the pictures of `cameras`: the inner borders of the methods that have one by a threshold, else of the usual method; none where the
/// silhouette alone counts.
LocalSettings local_settings(double tolerance_px, bool silhouette, const std::vector<MethodCall>& methods, std::vector<Camera> cameras);

/// Throws InputError where `local` changes nothing of what is built, one of `kinds` (an empty name: each object's natural one), and for a
/// level beside it, which it has none of.
void refuse_local_without_effect(const ExperimentSpec& spec, const Scene& scene, const SurfaceSettings& settings,
                                 const std::vector<std::string>& kinds);

}  // namespace limn
