#include "raymarch/files/hash_module.h"
#include "sdf/late_module.h"

namespace limn {

const HashModule& hash_module() {
  static const HashModule module = load_late_module<HashModule>(kHashModuleFile, kHashModuleFunction, 0);
  return module;
}

}  // namespace limn
