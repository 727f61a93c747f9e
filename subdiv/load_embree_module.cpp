#include <new>

#include "sdf/error.h"
#include "sdf/late_module.h"
#include "subdiv/embree_module.h"

namespace limn {

const EmbreeModule& embree() {
  static const EmbreeModule module = load_late_module<EmbreeModule>(kEmbreeModuleFile, kEmbreeModuleFunction, 0);
  return module;
}

void check_tree(RTCDevice device) {
  const RTCError error = embree().rtcGetDeviceError(device);
  if (error == RTC_ERROR_OUT_OF_MEMORY) throw std::bad_alloc();
  if (error != RTC_ERROR_NONE) throw MachineError("Embree could not build its tree over the triangles");
}

}  // namespace limn
