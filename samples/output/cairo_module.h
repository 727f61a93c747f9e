#pragma once
// Internal: Cairo's functions, in a module of their own (helpers/cairo_module.cpp), loaded when the first chart or PDF is drawn: Cairo
// stands on a dozen libraries of the window system, which take 2 ms to load.

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>

namespace limn {

/// Those that limn calls, without the cairo_ of their names.
#define LIMN_CAIRO_FUNCTIONS(X)    \
  X(surface_destroy)               \
  X(destroy)                       \
  X(new_path)                      \
  X(move_to)                       \
  X(line_to)                       \
  X(curve_to)                      \
  X(arc)                           \
  X(arc_negative)                  \
  X(close_path)                    \
  X(set_source_rgb)                \
  X(fill)                          \
  X(set_line_width)                \
  X(set_dash)                      \
  X(stroke)                        \
  X(pdf_surface_create)            \
  X(pdf_surface_set_metadata)      \
  X(create)                        \
  X(translate)                     \
  X(scale)                         \
  X(set_line_join)                 \
  X(set_line_cap)                  \
  X(surface_finish)                \
  X(surface_status)                \
  X(status_to_string)              \
  X(status)                        \
  X(rectangle)                     \
  X(svg_surface_create_for_stream) \
  X(svg_surface_set_document_unit) \
  X(image_surface_create)          \
  X(surface_flush)                 \
  X(image_surface_get_data)        \
  X(image_surface_get_stride)      \
  X(select_font_face)              \
  X(set_font_size)                 \
  X(set_source_rgba)               \
  X(fill_preserve)                 \
  X(text_extents)                  \
  X(save)                          \
  X(rotate)                        \
  X(show_text)                     \
  X(restore)                       \
  X(clip)

/// Under those names.
struct CairoModule {
  const char* version = nullptr;  ///< Of limn: another one's module may have other functions.

#define LIMN_CAIRO_FUNCTION(name) decltype(&::cairo_##name) name = nullptr;  // NOLINT(bugprone-macro-parentheses): declares it
  LIMN_CAIRO_FUNCTIONS(LIMN_CAIRO_FUNCTION)
#undef LIMN_CAIRO_FUNCTION
};

/// What the module exports: void limn_cairo_module(CairoModule&), which fills in its functions.
inline constexpr const char* kCairoModuleFile = "limn-cairo.so";
inline constexpr const char* kCairoModuleFunction = "limn_cairo_module";

/// Loaded once. Throws MachineError where it is not there or is another version's.
const CairoModule& cairo();

}  // namespace limn
