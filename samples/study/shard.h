#pragma once
// Which cells a part of a study does: the same on every machine, by expected cost alone.

#include "samples/study/study.h"

namespace limn {

/// Part (from 1) of each cell. Each cell is in one part; a model stays in one part unless it is heavier than half a part's fair share, and
/// then falls apart by views.
std::vector<int> shards_of(const Study& study, int count);

/// Indices of the cells of one part, rising.
std::vector<size_t> cells_of_shard(const Study& study, int shard, int count);

/// Expected cost of each part, ms.
std::vector<double> shard_costs(const Study& study, const std::vector<int>& shards, int count);

}  // namespace limn
