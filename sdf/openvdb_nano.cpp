// The grids of a .nvdb file: NanoVDB's own, which is what renderers write.

#include <iostream>  // GridValidator.h leaves it out

#include <nanovdb/NanoVDB.h>
#include <nanovdb/util/GridValidator.h>
#include <nanovdb/util/IO.h>
#include <nanovdb/util/NanoToOpenVDB.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>

#include "sdf/error.h"
#include "sdf/openvdb_grid.h"
#include "sdf/openvdb_stored.h"

namespace limn {
namespace {

namespace fs = std::filesystem;
using Handle = nanovdb::GridHandle<nanovdb::HostBuffer>;

/// Where one grid lies in the file.
struct Place {
  std::int64_t offset = 0;
  nanovdb::io::Codec codec = nanovdb::io::Codec::NONE;
  nanovdb::io::GridMetaData meta;
};

std::string version_text(const nanovdb::Version& version) { return version.c_str(); }

/// NanoVDB's own reader says what is wrong in several lines, and to a person who builds it.
void check_header(const nanovdb::io::Header& header) {
  if (std::memcmp(&header.magic, "NanoVDB", 7) != 0)
    refuse_volume("", "", "cannot be read as a volume: it does not start as a .nvdb", "an undamaged .nvdb");
  if (header.magic != NANOVDB_MAGIC_NUMBER)
    refuse_volume("", "", "is of a later format of NanoVDB than this program reads", "a .nvdb of version 32.4 or older, or a .vdb");
  if (header.version.getMajor() != NANOVDB_MAJOR_VERSION_NUMBER)
    refuse_volume("", version_text(header.version), "is of another version of NanoVDB", "a .nvdb of version 32, or a .vdb");
  if (header.codec >= nanovdb::io::Codec::END)
    refuse_volume("", "", "is compressed in a way that NanoVDB does not know", "an undamaged .nvdb");
}

std::vector<Place> places_in(const fs::path& file, std::istream& stream) {
  const auto size = static_cast<std::int64_t>(fs::file_size(file));
  std::vector<Place> places;
  while (stream.peek() != std::char_traits<char>::eof()) {
    nanovdb::io::Header header;
    const std::int64_t start = static_cast<std::int64_t>(stream.tellg());
    stream.read(reinterpret_cast<char*>(&header), sizeof header);
    check_header(header);
    stream.seekg(start);
    nanovdb::io::Segment segment;
    segment.read(stream);
    std::int64_t offset = static_cast<std::int64_t>(stream.tellg());
    for (const nanovdb::io::GridMetaData& meta : segment.meta) {
      if (meta.fileSize > static_cast<std::uint64_t>(size - offset)) throw std::ios::failure("breaks off");
      places.push_back({offset, segment.header.codec, meta});
      offset += static_cast<std::int64_t>(meta.fileSize);
    }
    stream.seekg(offset);
  }
  return places;
}

std::string type_name(nanovdb::GridType type) {
  switch (type) {
    case nanovdb::GridType::Fp4:
      return "Fp4";
    case nanovdb::GridType::Fp8:
      return "Fp8";
    case nanovdb::GridType::Fp16:
      return "Fp16";
    case nanovdb::GridType::FpN:
      return "FpN";
    default:
      return type < nanovdb::GridType::End ? nanovdb::toStr(type) : "unknown";
  }
}

std::string class_name(nanovdb::GridClass grid_class) {
  if (grid_class == nanovdb::GridClass::LevelSet) return "level set";
  if (grid_class == nanovdb::GridClass::FogVolume) return "fog volume";
  return "unknown";
}

bool is_distance(nanovdb::GridType type) {
  constexpr std::array<nanovdb::GridType, 6> kReadable{nanovdb::GridType::Float, nanovdb::GridType::Double, nanovdb::GridType::Fp4,
                                                       nanovdb::GridType::Fp8,   nanovdb::GridType::Fp16,   nanovdb::GridType::FpN};
  return std::find(kReadable.begin(), kReadable.end(), type) != kReadable.end();
}

template <class Value>
openvdb::GridBase::Ptr converted(const Handle& handle) {
  const auto* grid = handle.grid<Value>();
  if (grid == nullptr) refuse_volume("", "", "cannot be read as a volume: its table and its grid differ in type", "an undamaged .nvdb");
  const std::string fault = nanovdb::GridValidator<Value>::check(*grid, true);
  if (!fault.empty()) refuse_volume("", "", "cannot be read as a volume: " + fault, "an undamaged .nvdb");
  const auto result = nanovdb::NanoToOpenVDB<Value>{}(*grid);
  // NanoVDB's converter takes the map's matrix transposed, which turns a rotated grid the other way round.
  const nanovdb::Map& map = reinterpret_cast<const nanovdb::GridData*>(grid)->mMap;
  openvdb::math::Mat4d matrix = openvdb::math::Mat4d::identity();
  // OpenVDB multiplies row vectors from the left: its rows are NanoVDB's columns.
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) matrix(column, row) = map.mMatD[3 * row + column];
  matrix.setTranslation(openvdb::Vec3d(map.mVecD));
  result->setTransform(openvdb::math::Transform::createLinearTransform(matrix));
  return result;
}

openvdb::GridBase::Ptr read_one(std::istream& stream, const Place& place) {
  if (place.meta.gridSize < sizeof(nanovdb::GridData)) refuse_volume("", "", "holds a grid without a head", "an undamaged .nvdb");
  stream.seekg(place.offset);
  Handle handle(nanovdb::HostBuffer::create(place.meta.gridSize));
  nanovdb::io::Internal::read(stream, handle, place.codec);
  const nanovdb::GridMetaData* head = handle.gridMetaData();
  if (head == nullptr || head->gridSize() != handle.size())
    refuse_volume("", "", "cannot be read as a volume: a grid is not as large as it says", "an undamaged .nvdb");
  switch (head->gridType()) {
    case nanovdb::GridType::Float:
      return converted<float>(handle);
    case nanovdb::GridType::Double:
      return converted<double>(handle);
    case nanovdb::GridType::Fp4:
      return converted<nanovdb::Fp4>(handle);
    case nanovdb::GridType::Fp8:
      return converted<nanovdb::Fp8>(handle);
    case nanovdb::GridType::Fp16:
      return converted<nanovdb::Fp16>(handle);
    case nanovdb::GridType::FpN:
      return converted<nanovdb::FpN>(handle);
    default:
      refuse_volume("grid", type_name(head->gridType()), "does not hold distances", "a level set of float, double or half");
  }
}

StoredGrid stored(const Place& place) {
  const nanovdb::io::GridMetaData& meta = place.meta;
  return {.name = meta.gridName,
          .value_type = type_name(meta.gridType),
          .grid_class = class_name(meta.gridClass),
          .voxels = static_cast<std::int64_t>(meta.voxelCount),
          .voxel_size = std::min({meta.voxelSize[0], meta.voxelSize[1], meta.voxelSize[2]}),
          .is_distance = is_distance(meta.gridType)};
}

}  // namespace

bool is_nvdb(const fs::path& file) {
  char start[7] = {};
  std::ifstream stream(file, std::ios::binary);
  return stream.read(start, sizeof start) && std::memcmp(start, "NanoVDB", sizeof start) == 0;
}

StoredGrids stored_in_nvdb(const fs::path& file) {
  initialize_openvdb();
  const auto stream = std::make_shared<std::ifstream>(file, std::ios::binary);
  stream->exceptions(std::ios::failbit | std::ios::badbit);
  const auto places = std::make_shared<const std::vector<Place>>(places_in(file, *stream));
  StoredGrids grids;
  for (const Place& place : *places) grids.list.push_back(stored(place));
  number_equal_names(grids.list);
  grids.read = [stream, places](size_t i) {
    stream->clear();
    return read_one(*stream, (*places)[i]);
  };
  return grids;
}

}  // namespace limn
