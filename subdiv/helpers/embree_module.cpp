// limn-embree.so: Embree's functions as the table of subdiv/embree_module.h, loaded when they are needed.

#include "subdiv/embree_module.h"

#include "sdf/version.h"

extern "C" __attribute__((visibility("default"))) void limn_embree_module(limn::EmbreeModule& module) {
  module.version = limn::kVersion;
#define LIMN_EMBREE_FUNCTION(name) module.name = ::name;
  LIMN_EMBREE_FUNCTIONS(LIMN_EMBREE_FUNCTION)
#undef LIMN_EMBREE_FUNCTION
}
