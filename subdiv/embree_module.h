#pragma once
// Internal: Embree's functions, in a module of their own (helpers/embree_module.cpp), loaded when the first tree over triangles is made:
// a call that makes none need not wait for it.

#include <embree3/rtcore.h>

namespace limn {

/// Those that limn calls.
#define LIMN_EMBREE_FUNCTIONS(X)      \
  X(rtcNewDevice)                     \
  X(rtcRetainDevice)                  \
  X(rtcReleaseDevice)                 \
  X(rtcGetDeviceError)                \
  X(rtcNewScene)                      \
  X(rtcReleaseScene)                  \
  X(rtcSetSceneFlags)                 \
  X(rtcSetSceneBuildQuality)          \
  X(rtcCommitScene)                   \
  X(rtcNewGeometry)                   \
  X(rtcReleaseGeometry)               \
  X(rtcCommitGeometry)                \
  X(rtcAttachGeometry)                \
  X(rtcSetNewGeometryBuffer)          \
  X(rtcSetGeometryBuildQuality)       \
  X(rtcSetGeometryUserData)           \
  X(rtcSetGeometryUserPrimitiveCount) \
  X(rtcSetGeometryBoundsFunction)     \
  X(rtcSetGeometryIntersectFunction)  \
  X(rtcSetGeometryPointQueryFunction) \
  X(rtcIntersect1)                    \
  X(rtcPointQuery)

/// Under their own names.
struct EmbreeModule {
  const char* version = nullptr;  ///< Of limn: another one's module may have other functions.

#define LIMN_EMBREE_FUNCTION(name) decltype(&::name) name = nullptr;  // NOLINT(bugprone-macro-parentheses): declares it
  LIMN_EMBREE_FUNCTIONS(LIMN_EMBREE_FUNCTION)
#undef LIMN_EMBREE_FUNCTION
};

/// What the module exports: void limn_embree_module(EmbreeModule&), which fills in its functions.
inline constexpr const char* kEmbreeModuleFile = "limn-embree.so";
inline constexpr const char* kEmbreeModuleFunction = "limn_embree_module";

/// Loaded once. Throws MachineError where it is not there or is another version's.
const EmbreeModule& embree();

/// After a tree over triangles was made: throws std::bad_alloc where its memory ended, and MachineError where anything else failed.
void check_tree(RTCDevice device);

}  // namespace limn
