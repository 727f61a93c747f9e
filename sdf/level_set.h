#pragma once
// Narrow-band level sets: built and edited with OpenVDB, read through NanoVDB. No OpenVDB type leaves this folder's .cpp files.

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sdf/field.h"
#include "sdf/geometry.h"
#include "sdf/registry.h"

namespace limn {

struct LevelSetData;  // sdf/level_set_data.h

/// What the band holds where it matters: at the cells that the surface crosses, whose eight nodes differ in sign.
struct BandFacts {
  std::int64_t crossed_cells = 0;  ///< Cells whose eight nodes differ in sign.
  /// By gradient, in the order of gradients(): the crossed cells for which it reads a node outside the band, where there is no distance.
  std::vector<std::int64_t> lacking{};
  /// Nodes of the band that are within half a voxel of the surface by their own value; not counted (0) in level sets that limn made.
  std::int64_t near_nodes = 0;
  std::int64_t unsigned_nodes = 0;  ///< Those of them without a neighbour of the other sign: surface that no change of sign shows.
};

/// What a level set is, and what was found of it when it was made.
struct LevelSetInfo {
  std::string name{};                 ///< The grid's name.
  Affine world_from_index{};          ///< Voxel (i, j, k) has its node at world_from_index.point(i, j, k).
  double voxel_size = 0.0;            ///< World; the smallest of the three where they differ.
  double half_width_voxels = 0.0;     ///< Of the band that is really there, inside and outside (the smaller), over most of the surface.
  BandFacts band{};                   ///< See BandFacts.
  std::int64_t active_voxels = 0;     ///< Nodes of the band.
  std::int64_t bytes = 0;             ///< Of the NanoVDB grid that is read.
  Box bounds{};                       ///< World, around the zero crossings; empty where there are none.
  double build_ms = 0.0;              ///< Time of building or reading it.
  std::vector<std::string> warnings;  ///< What a person should know before trusting it, each with its number.
};

/// An immutable grid; copying copies a pointer.
class LevelSet {
 public:
  /// For makers of level sets in limn itself; `data` is not null.
  explicit LevelSet(std::shared_ptr<const LevelSetData> data) : data_(std::move(data)) {}
  const LevelSetData& data() const { return *data_; }  ///< Valid as long as a copy of the level set is.
  const LevelSetInfo& info() const;                    ///< Valid as long as a copy of the level set is.

 private:
  std::shared_ptr<const LevelSetData> data_{};
};

/// The nodes that a gradient reads for points of one cell: bit dz + 2 of [dx + 2][dy + 2] for the node (dx, dy, dz) from the cell's first.
using Stencil = std::array<std::array<std::uint8_t, 6>, 6>;

/// How a gradient is read from a grid: one file in sdf/gradients/ and one line in sdf/gradients/all_gradients.cpp.
struct GradientDescriptor {
  Description about{};       ///< Name, help and source.
  double half_width_voxels;  ///< Of the band it needs around a surface point, so that no stencil leaves the band.
  Stencil stencil;           ///< The nodes it reads.
  int order;                 ///< Of the normal's angle, by voxel size.
  /// That angle, radians, is about normal_constant * (curvature * voxel)^order: measured on the unit sphere at a tenth.
  double normal_constant = 0.0;
  /// Gradients (world, not normalised) at world points within one voxel of the surface; sizes equal.
  void (*gradients)(const LevelSetData&, std::span<const glm::dvec3> points, std::span<glm::dvec3> gradients);
  /// The reconstruction's own values at such points: hits go to its root. Null where it is the trilinear interpolant, whose root they are.
  void (*values)(const LevelSetData&, std::span<const glm::dvec3> points, std::span<double> values);
  /// The Hessian too, or null where the reconstruction has none worth having.
  void (*hessians)(const LevelSetData&, std::span<const glm::dvec3> points, std::span<FieldJet> jets);
};

/// All gradients, in the order of sdf/gradients/all_gradients.cpp.
const Registry<GradientDescriptor>& gradients();
/// Throws InputError naming the nearest known gradient. `file` and `field` go into the message.
inline const GradientDescriptor& find_gradient(const std::string& name, const std::string& file = {}, const std::string& field = {}) {
  return gradients().find(name, file, field);
}

/// How a level set is built.
struct LevelSetSettings {
  double voxel_size = 0.0;                         ///< World, > 0.
  double half_width_voxels = 3.0;                  ///< At least 1.8 (so that every cell on the surface lies in the band).
  std::int64_t max_bytes = std::int64_t{8} << 30;  ///< Refuses (InputError, with the estimate) what would be larger.
  std::function<void(double)> progress{};          ///< Called with 0..1 from any one thread at a time; may be empty.
};

/// Samples the field where |distance| <= half width and nowhere else: blocks that interval bounds prove empty are never evaluated.
/// A field that is not an exact distance is turned into one to third order from value, gradient and Hessian.
/// Throws InputError for an unbounded field (with `bounds` to give), a surface thinner than nothing, or a grid beyond max_bytes.
LevelSet level_set_from_field(const Field& field, const LevelSetSettings& settings);

/// Values at the nodes of a band given as blocks of 8^3, for makers that compute distances themselves (mesh to level set).
struct LevelSetBlock {
  glm::ivec3 origin{};      ///< Index coordinates, multiples of 8.
  std::uint64_t active[8];  ///< Bit (x*64 + y*8 + z), as OpenVDB numbers leaf nodes: word x, bit y*8+z.
  float values[512];        ///< World distance, negative inside; inactive ones hold +-background.
};
/// Joins blocks into a level set, flood-filling the sign; the background is the half width. Blocks are unique by origin; those without
/// an active voxel are dropped. `origin` (world) is where the node (0, 0, 0) stands.
LevelSet level_set_from_blocks(std::span<const LevelSetBlock> blocks, double voxel_size, double half_width_voxels, const std::string& name,
                               const glm::dvec3& origin = glm::dvec3(0.0));

/// One grid of a .vdb file, as `limn info` and error messages list them.
struct GridSummary {
  std::string name,                ///< As in the file; may be empty.
      value_type,                  ///< OpenVDB's or NanoVDB's name: "float", "half", "Fp8".
      grid_class;                  ///< "level set", "fog volume", "unknown".
  std::int64_t active_voxels = 0;  ///< -1 where the file does not say.
  double voxel_size = 0.0;         ///< World.
};

/// Guarded: the file is read by a child process with limits on memory and time (sdf/guard.h).
std::vector<GridSummary> list_grids(const std::filesystem::path& file);

/// `grid` empty: the only level set, or InputError with the names. Reads float, double and half; refuses, saying what is expected: a fog
/// volume, an empty or uninitialised grid, other value types, frustum transforms, a grid without a surface. What is wrong with a band that
/// is drawn all the same is in the info's warnings.
LevelSet read_level_set(const std::filesystem::path& file, const std::string& grid);

/// Writes one grid, 32-bit, class "level set", zipped with active-mask compression; whole or not at all.
void write_level_set(const LevelSet& level_set, const std::filesystem::path& file);

/// Of the crossed cells, those for which `gradient` reads a node outside the band.
std::int64_t cells_lacking(const LevelSet& level_set, const GradientDescriptor& gradient);

/// The level set with distances at the nodes outside the band that `gradient` reads, filled in from the surface that the grid holds; the
/// band's own values stay as they are. What was done is the last of its warnings. Where nothing lacks it is the same level set. Cells that
/// lack distances even so lie where a band breaks off, so that there is a sign and no surface: they are to take the next lower gradient.
LevelSet complete_band(const LevelSet& level_set, const GradientDescriptor& gradient);

/// Trilinear value at world points (background outside the band).
void level_set_values(const LevelSet& level_set, std::span<const glm::dvec3> points, std::span<double> values);

/// The zero surface as polygons, by dual contouring on the grid (OpenVDB volumeToMesh): positions in world, faces wound outwards.
struct PolygonSoup {
  std::vector<glm::dvec3> positions{};          ///< World.
  std::vector<std::int32_t> face_sizes{};       ///< Corners of each face, 3 or 4.
  std::vector<std::int32_t> corner_vertices{};  ///< All faces' corners one after the other, as indices into `positions`.
};
/// The zero surface of a level set. See PolygonSoup.
PolygonSoup mesh_from_level_set(const LevelSet& level_set);

}  // namespace limn
