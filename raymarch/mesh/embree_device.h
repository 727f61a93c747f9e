#pragma once
// Internal: the one device of Embree.

struct RTCDeviceTy;

namespace limn {

/// One device serves all meshes, as long as the process lives: each takes a key of thread storage, of which a process has 1024. Retained
/// for the caller, who releases it. Throws MachineError.
RTCDeviceTy* shared_embree_device();

}  // namespace limn
