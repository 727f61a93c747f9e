#include "samples/output/cairo_module.h"
#include "sdf/late_module.h"

namespace limn {

const CairoModule& cairo() {
  static const CairoModule module = load_late_module<CairoModule>(kCairoModuleFile, kCairoModuleFunction, 0);
  return module;
}

}  // namespace limn
