#include "sdf/late_module.h"
#include "subdiv/embree_module.h"

namespace limn {

const EmbreeModule& embree() {
  static const EmbreeModule module = load_late_module<EmbreeModule>(kEmbreeModuleFile, kEmbreeModuleFunction, 0);
  return module;
}

}  // namespace limn
