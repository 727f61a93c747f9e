#include "raymarch/mesh/embree_device.h"

#include "sdf/error.h"
#include "subdiv/embree_module.h"

namespace limn {

RTCDeviceTy* shared_embree_device() {
  static const RTCDevice device = embree().rtcNewDevice(nullptr);
  if (device == nullptr) throw MachineError("Embree could not start: out of memory, most likely");
  embree().rtcRetainDevice(device);
  return device;
}

}  // namespace limn
