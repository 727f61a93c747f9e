#pragma once
// What contact sheets are made of: framed pictures and lines of text on paper.

#include <string>
#include <vector>

#include "samples/compare/comparison.h"
#include "samples/page/text.h"

namespace limn {

inline constexpr int kSheetGap = 24;  ///< Between columns and around everything, px.
inline constexpr glm::vec3 kPaper{0.93f}, kCard{1.0f}, kFrame{0.62f}, kText{0.012f}, kSoftText{0.13f};  // linear

inline const TextStyle kTitle{26, true, kText, TextAlign::left};
inline const TextStyle kBody{16, false, kSoftText, TextAlign::left};
inline const TextStyle kHead{18, true, kText, TextAlign::left};
inline const TextStyle kCaption{15, false, kText, TextAlign::left};
inline const TextStyle kNote{14, false, kSoftText, TextAlign::left};

using Canvas = Image<glm::vec4>;

void fill(Canvas& canvas, int x, int y, int width, int height, const glm::vec3& color);
/// Centred in a framed box of the given size, over white where it lets light through.
void place(Canvas& canvas, const Canvas& picture, int x, int y, int width, int height);
/// Lines of text below y.
void draw_captions(Canvas& canvas, int x, int y, const std::vector<std::string>& lines);
/// A title and a line of details below it.
void draw_head(Canvas& canvas, int x, int y, const std::string& title, const std::string& details);

/// What is not shown and why, in lines no wider than `width`.
std::vector<std::string> skipped_lines(const Comparison& comparison, int width);

/// The sheet of several methods: a row each, a column for each model.
Image<glm::u8vec4> matrix_sheet(const Comparison& comparison);

}  // namespace limn
