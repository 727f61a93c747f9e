#pragma once
// Internal: Cairo's functions, in a module of their own (helpers/cairo_module.cpp), loaded when the first chart or PDF is drawn: Cairo
// stands on a dozen libraries of the window system, which take 2 ms to load, a third of all that limn takes until it reads its first
// argument.

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>

namespace limn {

/// Those that limn calls, without the cairo_ of their names.
struct CairoModule {
  const char* version = nullptr;  ///< Of limn: another one's module may have other functions.

  decltype(&::cairo_surface_destroy) surface_destroy = nullptr;
  decltype(&::cairo_destroy) destroy = nullptr;
  decltype(&::cairo_new_path) new_path = nullptr;
  decltype(&::cairo_move_to) move_to = nullptr;
  decltype(&::cairo_line_to) line_to = nullptr;
  decltype(&::cairo_curve_to) curve_to = nullptr;
  decltype(&::cairo_arc) arc = nullptr;
  decltype(&::cairo_arc_negative) arc_negative = nullptr;
  decltype(&::cairo_close_path) close_path = nullptr;
  decltype(&::cairo_set_source_rgb) set_source_rgb = nullptr;
  decltype(&::cairo_fill) fill = nullptr;
  decltype(&::cairo_set_line_width) set_line_width = nullptr;
  decltype(&::cairo_set_dash) set_dash = nullptr;
  decltype(&::cairo_stroke) stroke = nullptr;
  decltype(&::cairo_pdf_surface_create) pdf_surface_create = nullptr;
  decltype(&::cairo_pdf_surface_set_metadata) pdf_surface_set_metadata = nullptr;
  decltype(&::cairo_create) create = nullptr;
  decltype(&::cairo_translate) translate = nullptr;
  decltype(&::cairo_scale) scale = nullptr;
  decltype(&::cairo_set_line_join) set_line_join = nullptr;
  decltype(&::cairo_set_line_cap) set_line_cap = nullptr;
  decltype(&::cairo_surface_finish) surface_finish = nullptr;
  decltype(&::cairo_surface_status) surface_status = nullptr;
  decltype(&::cairo_status_to_string) status_to_string = nullptr;
  decltype(&::cairo_status) status = nullptr;
  decltype(&::cairo_rectangle) rectangle = nullptr;
  decltype(&::cairo_svg_surface_create_for_stream) svg_surface_create_for_stream = nullptr;
  decltype(&::cairo_svg_surface_set_document_unit) svg_surface_set_document_unit = nullptr;
  decltype(&::cairo_image_surface_create) image_surface_create = nullptr;
  decltype(&::cairo_surface_flush) surface_flush = nullptr;
  decltype(&::cairo_image_surface_get_data) image_surface_get_data = nullptr;
  decltype(&::cairo_image_surface_get_stride) image_surface_get_stride = nullptr;
  decltype(&::cairo_select_font_face) select_font_face = nullptr;
  decltype(&::cairo_set_font_size) set_font_size = nullptr;
  decltype(&::cairo_set_source_rgba) set_source_rgba = nullptr;
  decltype(&::cairo_fill_preserve) fill_preserve = nullptr;
  decltype(&::cairo_text_extents) text_extents = nullptr;
  decltype(&::cairo_save) save = nullptr;
  decltype(&::cairo_rotate) rotate = nullptr;
  decltype(&::cairo_show_text) show_text = nullptr;
  decltype(&::cairo_restore) restore = nullptr;
  decltype(&::cairo_clip) clip = nullptr;
};

/// What the module exports: void limn_cairo_module(CairoModule&), which fills in its functions.
inline constexpr const char* kCairoModuleFile = "limn-cairo.so";
inline constexpr const char* kCairoModuleFunction = "limn_cairo_module";

/// Loaded once. Throws MachineError where it is not there or is another version's.
const CairoModule& cairo();

}  // namespace limn
