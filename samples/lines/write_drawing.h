#pragma once
// Drawings as files.

#include <filesystem>

#include "samples/lines/drawing.h"

namespace limn {

/// One group a class and visibility, as layers of Inkscape whose labels begin with a number.
std::string svg_text(const LineDrawing& drawing, const std::string& title);
/// All drawings in turn, again and again (CSS animations: browsers play them, and programs without them show the first). At least one; of
/// one size and style.
std::string animated_svg_text(const std::vector<LineDrawing>& drawings, const std::string& title, double frames_per_second);
/// Throws MachineError.
void write_pdf(const LineDrawing& drawing, const std::string& title, const std::filesystem::path& file);
/// Release 12, ASCII.
std::string dxf_text(const LineDrawing& drawing);

/// How a stroke is drawn.
const StrokeStyle& style_of(const LineDrawing& drawing, const Stroke& stroke);

}  // namespace limn
