#pragma once
// Internal: what surface_notes() reads of a picture, a byte a pixel, gathered tile by tile while the picture is traced: its normals need
// not be kept for them.

#include <atomic>
#include <string>
#include <vector>

#include "raymarch/gbuffer.h"

namespace limn {

/// Bits of SurfaceTally::facts.
enum SurfaceFact : std::uint8_t {
  kIsHit = 1,         ///< The pixel shows an object,
  kSameAsLeft = 2,    ///< with the same normal and object as the pixel to the left,
  kSameAsAbove = 4,   ///< and as the pixel above.
  kInkedByFirst = 8,  ///< More than half of it is ink of the first method; of the next one the next bit.
};
inline constexpr size_t kMostTalliedMethods = 5;

/// Of a picture with ids from 1 to `objects`, traced in cells of `cell_px` that begin at its corner.
struct SurfaceTally {
  SurfaceTally(size_t objects, const glm::ivec2& size_px, const glm::ivec2& cell);

  glm::ivec2 cell_px;
  Image<std::uint8_t> facts;
  /// N and id of the first and the last line, and column, of each row, and column, of cells.
  GBuffer lines{}, columns{};
  std::atomic<std::int64_t> same_pairs{0};             ///< Bits kSameAsLeft and kSameAsAbove.
  std::vector<std::atomic<std::int64_t>> seen,         ///< Pixels, by id.
      turned;                                          ///< Of them, those whose normals point away.
  std::atomic<std::int64_t> hits{0}, out_of_steps{0};  ///< Pixels.
};

/// Adds pixels of one cell. The layers N (without it no normal is the same), N.V, id and status begin at the picture's pixel `first`.
void add_pixels(const GBuffer& layers, const glm::ivec2& first, const PixelTile& pixels, SurfaceTally& tally);
/// Adds pixels that show nothing.
void add_nothing(const PixelTile& pixels, SurfaceTally& tally);
/// Adds the ink of a method, from 0 on, at pixels side by side that were added before; `at`: the index of the first of them.
void add_ink(std::span<const float> coverage, size_t method, size_t at, SurfaceTally& tally);
/// Adds what neighbours in different cells have in common. Once, after all pixels.
void join_cells(SurfaceTally& tally);

/// As surface_notes() of the whole picture.
std::vector<std::string> surface_notes(const std::string& name, const SurfaceTally& tally, size_t method);

}  // namespace limn
