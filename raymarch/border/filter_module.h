#pragma once
// Filters of pictures, OpenCV's, in a module of their own (helpers/filters_module.cpp): one method uses them, and loading OpenCV with what
// it stands on takes 4 ms, as long as all else that a call starts with.

#include <span>

namespace limn {

/// Lines of a picture of `width` pixels: `rows` that are filtered, and `radius_px` above and below them that the filter looks at.
struct FilterBand {
  const float* source = nullptr;  ///< rows + 2 radius_px lines, one after another.
  float* blurred = nullptr;       ///< rows lines.
  int width = 0, rows = 0, radius_px = 0;
};

struct FilterModule {
  const char* version = nullptr;  ///< Of limn: another one's module may have other functions.

  /// Means of squares of 2 radius_px + 1 pixels. To the left and right of the picture its border pixels repeat.
  void (*blur_box)(const FilterBand& band) = nullptr;
  /// Along the lines and along the columns with the same 2 radius_px + 1 weights.
  void (*blur_separably)(const FilterBand& band, std::span<const float> weights) = nullptr;
};

/// What the module exports: void limn_filter_module(FilterModule&), which fills in its functions.
inline constexpr const char* kFilterModuleFile = "limn-filters.so";
inline constexpr const char* kFilterModuleFunction = "limn_filter_module";

/// Loaded once. Throws MachineError where it is not there or is another version's.
const FilterModule& filter_module();

}  // namespace limn
