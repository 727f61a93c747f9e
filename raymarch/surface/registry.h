#pragma once
// The list of surface representations. A new one is a file in this folder and a line in registry.cpp.

#include "raymarch/surface.h"

namespace limn {

SurfaceDescriptor analytic_surface();
SurfaceDescriptor level_set_surface();
SurfaceDescriptor mesh_surface();
SurfaceDescriptor mesh_level_set_surface();

}  // namespace limn
