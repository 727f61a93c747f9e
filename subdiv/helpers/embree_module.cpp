// limn-embree.so: Embree's functions as the table of subdiv/embree_module.h, loaded when they are needed.

#include "subdiv/embree_module.h"

#include "sdf/version.h"

extern "C" __attribute__((visibility("default"))) void limn_embree_module(limn::EmbreeModule& module) {
  module = {limn::kVersion,
            rtcNewDevice,
            rtcRetainDevice,
            rtcReleaseDevice,
            rtcGetDeviceError,
            rtcNewScene,
            rtcReleaseScene,
            rtcSetSceneFlags,
            rtcSetSceneBuildQuality,
            rtcCommitScene,
            rtcNewGeometry,
            rtcReleaseGeometry,
            rtcCommitGeometry,
            rtcAttachGeometry,
            rtcSetNewGeometryBuffer,
            rtcSetGeometryBuildQuality,
            rtcSetGeometryUserData,
            rtcSetGeometryUserPrimitiveCount,
            rtcSetGeometryBoundsFunction,
            rtcSetGeometryIntersectFunction,
            rtcSetGeometryPointQueryFunction,
            rtcIntersect1,
            rtcPointQuery};
}
