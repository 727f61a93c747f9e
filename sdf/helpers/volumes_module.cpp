// limn-volumes.so: OpenVDB behind the functions of sdf/volume_module.h, loaded when they are needed.

#include "sdf/version.h"
#include "sdf/volume_module.h"

extern "C" __attribute__((visibility("default"))) void limn_volume_module(limn::VolumeModule& module) {
  using namespace limn;
  module = {
      kVersion, volumes::rebuild, volumes::with_filled_nodes, volumes::moved, volumes::mesh_from_level_set, volumes::write_level_sets};
}
