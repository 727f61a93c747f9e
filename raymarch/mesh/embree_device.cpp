#include "raymarch/mesh/embree_device.h"

#include <embree3/rtcore.h>

#include "sdf/error.h"

namespace limn {

RTCDeviceTy* shared_embree_device() {
  static const RTCDevice device = rtcNewDevice(nullptr);
  if (device == nullptr) throw MachineError("Embree could not start: out of memory, most likely");
  rtcRetainDevice(device);
  return device;
}

}  // namespace limn
