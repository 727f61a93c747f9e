// limn-cairo.so: Cairo's functions as the table of samples/output/cairo_module.h, loaded when they are needed.

#include "samples/output/cairo_module.h"

#include "sdf/version.h"

extern "C" __attribute__((visibility("default"))) void limn_cairo_module(limn::CairoModule& module) {
  module.version = limn::kVersion;
#define LIMN_CAIRO_FUNCTION(name) module.name = ::cairo_##name;
  LIMN_CAIRO_FUNCTIONS(LIMN_CAIRO_FUNCTION)
#undef LIMN_CAIRO_FUNCTION
}
