#pragma once
// Internal: what the two ways to draw a picture share, sample by sample and tile by tile.

#include <string>
#include <vector>

#include "raymarch/picture.h"

namespace limn {

/// What either asks for.
GBufferLayers joined(const GBufferLayers& a, const GBufferLayers& b);

/// Of open meshes that show their back.
void add_turned_notes(const BorderInput& input, std::vector<std::string>& notes);

/// With the progress of some of `samples` samples, from one on, as a part of the whole. Refers to `how`.
ExecutionSettings of_samples(const ExecutionSettings& how, int from, int count, int samples);

}  // namespace limn
