#include "sdf/openvdb_metadata.h"

#include <cstring>
#include <sstream>

namespace limn {
namespace {

using openvdb::GridBase;

bool is_set_by_writing(const std::string& name) {
  return name.starts_with("file_") || name == GridBase::META_GRID_NAME || name == GridBase::META_GRID_CLASS ||
         name == GridBase::META_SAVE_HALF_FLOAT;
}

/// The length in front must be that of the rest: OpenVDB makes room for as much as it says.
bool has_length(const std::string& bytes) {
  std::uint32_t length = 0;
  if (bytes.size() < sizeof length) return false;
  std::memcpy(&length, bytes.data(), sizeof length);
  return length == bytes.size() - sizeof length;
}

}  // namespace

std::vector<GridMetadata> plain_metadata(const openvdb::MetaMap& map) {
  std::vector<GridMetadata> entries;
  for (auto entry = map.beginMeta(); entry != map.endMeta(); ++entry) {
    if (!entry->second || is_set_by_writing(entry->first)) continue;
    std::ostringstream bytes;
    entry->second->write(bytes);
    entries.push_back({entry->first, entry->second->typeName(), bytes.str()});
  }
  return entries;
}

void add_metadata(const std::vector<GridMetadata>& entries, openvdb::MetaMap& map) {
  for (const GridMetadata& entry : entries) {
    if (entry.name.empty() || !has_length(entry.bytes)) continue;
    const openvdb::Metadata::Ptr value = openvdb::Metadata::isRegisteredType(entry.type)
                                             ? openvdb::Metadata::createMetadata(entry.type)
                                             : std::make_shared<openvdb::UnknownMetadata>(entry.type);
    std::istringstream bytes(entry.bytes);
    value->read(bytes);
    // Read to its last byte and not beyond.
    if (bytes && bytes.peek() == std::char_traits<char>::eof()) map.insertMeta(entry.name, *value);
  }
}

}  // namespace limn
