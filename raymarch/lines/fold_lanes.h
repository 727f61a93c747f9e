#pragma once
// Internal: which of many folds may reach a step, several at a time.

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace limn {

/// Folds in the image, in float. Each array has kFoldPadding more elements than there are folds.
struct FoldLanes {
  std::vector<float> ax{}, ay{}, bx{}, by{};  ///< Their ends.
  std::vector<float> margin{};                ///< How far their lines, and rounding, may leave them.
  std::vector<float> depth{};                 ///< No more than that of either end.
};
inline constexpr size_t kFoldPadding = 16;

/// What a fold has to reach to matter: a step of which its line, and rounding, stray by up to `within`.
struct FoldSearch {
  glm::vec2 from{0.0f}, to{0.0f};  ///< The step's ends.
  glm::vec2 across{0.0f};          ///< Unit, across the step; 0 where it has no direction.
  float within = 0.0f;
  float depth = 0.0f;  ///< No less than that of either end: what lies behind both is left out.
};

/// Writes the indices of the folds from `begin` to `end` that may come as near to the step as the two stray together, in order; what is not
/// parallel to it and lies wholly on one side is left out. Returns their number; `found` has room for kFoldPadding more than are asked.
size_t folds_in_reach(const FoldLanes& folds, const FoldSearch& search, std::uint32_t begin, std::uint32_t end, std::uint32_t* found);

}  // namespace limn
