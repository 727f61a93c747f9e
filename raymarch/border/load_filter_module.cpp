#include "raymarch/border/filter_module.h"
#include "sdf/late_module.h"

namespace limn {

const FilterModule& filter_module() {
  static const FilterModule module = load_late_module<FilterModule>(kFilterModuleFile, kFilterModuleFunction, 0);
  return module;
}

}  // namespace limn
