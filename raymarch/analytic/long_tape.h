#pragma once
// Internal: rays through a field of many parts, a short way at a time with the few parts that matter there.

#include "raymarch/analytic/tile.h"

namespace limn {

/// Tapes of fewer leaves are evaluated as fast as they are pruned.
inline constexpr size_t kLongTape = 8;

/// What isolate() and then polish() do, with a tape pruned for sixteen stretches at a time: neighbouring rays are best next to each other.
/// The same hits, to the last bit. `list` is used up.
void isolate_in_parts(const FieldTape& tape, const MarchLimits& limits, const RayBatch& rays, ViewScratch& scratch, StretchList& list,
                      HitBatch& hits);

}  // namespace limn
