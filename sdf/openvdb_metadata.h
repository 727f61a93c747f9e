#pragma once
// Internal to the sdf/openvdb_*.cpp files: a grid's metadata as plain bytes.

#include <openvdb/openvdb.h>

#include "sdf/level_set_metadata.h"

namespace limn {

/// All but what writing sets itself: name, class, statistics (file_...) and whether it is saved as half.
std::vector<GridMetadata> plain_metadata(const openvdb::MetaMap& map);

/// Puts them back. Entries whose bytes are no value of their type are left out; types that OpenVDB does not know keep their bytes.
void add_metadata(const std::vector<GridMetadata>& entries, openvdb::MetaMap& map);

}  // namespace limn
