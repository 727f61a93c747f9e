#pragma once
// Internal: bricks as text, for debugging: a header with counts, then one line a brick; and the values of one brick. Nothing is an address
// or a time, so that `diff` of two dumps shows what differs and nothing else. Values are the steps that are stored, whole numbers;
// `world_per_step` in the header makes world units of them. Other numbers have the fewest digits that read back as the same number.
//   brick 3: origin [-16 -8 0], values -3021 to 2945, crossed 93, cells [5 0 0] to [8 8 8], slab 131.25

#include <string>

#include "raymarch/level_set/bricks.h"

namespace limn {

/// Cells of the brick that the surface crosses, of 512.
int crossed_cells_in(const RayBricks& bricks, size_t brick);

/// Every brick in order: its first node in index coordinates, the least and the largest of its values, how many cells the surface
/// crosses and around which cells they lie (local), and how thick the slab about its plane is, in steps.
std::string text_of(const RayBricks& bricks);

/// A brick's line, then its values: for z = 0 to 8 a slice of nine rows (y = 0 to 8) of nine numbers (x = 0 to 8), or of
/// dots where no value is kept. Throws InputError
/// (field "brick") where there is no such brick.
std::string text_of_brick(const RayBricks& bricks, size_t brick);

}  // namespace limn
