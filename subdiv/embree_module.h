#pragma once
// Internal: Embree's functions, in a module of their own (helpers/embree_module.cpp), loaded when the first tree over triangles is made:
// Embree's library takes 2 ms to load, a third of all that limn takes until it reads its first argument.

#include <embree3/rtcore.h>

namespace limn {

/// Those that limn calls, under their own names.
struct EmbreeModule {
  const char* version = nullptr;  ///< Of limn: another one's module may have other functions.

  decltype(&::rtcNewDevice) rtcNewDevice = nullptr;
  decltype(&::rtcRetainDevice) rtcRetainDevice = nullptr;
  decltype(&::rtcReleaseDevice) rtcReleaseDevice = nullptr;
  decltype(&::rtcGetDeviceError) rtcGetDeviceError = nullptr;
  decltype(&::rtcNewScene) rtcNewScene = nullptr;
  decltype(&::rtcReleaseScene) rtcReleaseScene = nullptr;
  decltype(&::rtcSetSceneFlags) rtcSetSceneFlags = nullptr;
  decltype(&::rtcSetSceneBuildQuality) rtcSetSceneBuildQuality = nullptr;
  decltype(&::rtcCommitScene) rtcCommitScene = nullptr;
  decltype(&::rtcNewGeometry) rtcNewGeometry = nullptr;
  decltype(&::rtcReleaseGeometry) rtcReleaseGeometry = nullptr;
  decltype(&::rtcCommitGeometry) rtcCommitGeometry = nullptr;
  decltype(&::rtcAttachGeometry) rtcAttachGeometry = nullptr;
  decltype(&::rtcSetNewGeometryBuffer) rtcSetNewGeometryBuffer = nullptr;
  decltype(&::rtcSetGeometryBuildQuality) rtcSetGeometryBuildQuality = nullptr;
  decltype(&::rtcSetGeometryUserData) rtcSetGeometryUserData = nullptr;
  decltype(&::rtcSetGeometryUserPrimitiveCount) rtcSetGeometryUserPrimitiveCount = nullptr;
  decltype(&::rtcSetGeometryBoundsFunction) rtcSetGeometryBoundsFunction = nullptr;
  decltype(&::rtcSetGeometryIntersectFunction) rtcSetGeometryIntersectFunction = nullptr;
  decltype(&::rtcSetGeometryPointQueryFunction) rtcSetGeometryPointQueryFunction = nullptr;
  decltype(&::rtcIntersect1) rtcIntersect1 = nullptr;
  decltype(&::rtcPointQuery) rtcPointQuery = nullptr;
};

/// What the module exports: void limn_embree_module(EmbreeModule&), which fills in its functions.
inline constexpr const char* kEmbreeModuleFile = "limn-embree.so";
inline constexpr const char* kEmbreeModuleFunction = "limn_embree_module";

/// Loaded once. Throws MachineError where it is not there or is another version's.
const EmbreeModule& embree();

/// After a tree over triangles was made: throws std::bad_alloc where its memory ended, and MachineError where anything else failed.
void check_tree(RTCDevice device);

}  // namespace limn
