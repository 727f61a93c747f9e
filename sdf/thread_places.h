#pragma once
// Internal: on which processors the threads of loops run.
//
// A new thread starts on the processor of the one that makes it, and where the system moves it late (virtual machines with few processors
// do: after 10 to 40 ms) a whole call may be over before its second thread has a processor to itself. Where a program asks for it, the
// first thread that begins a loop makes way until others have started, and TBB's own threads keep to the other processors from then on.

namespace limn {

/// For programs, before their first loop: a library leaves alone what its host shares with it.
void keep_threads_apart();

namespace parallel_detail {

/// Of the thread. Below 0: it has neither begun a loop nor run a part of one. Above 0: in so many parts at most it still makes way.
inline thread_local int unplaced = -1;

int places_to_make();  ///< What `unplaced` becomes in a thread that begins a loop.
void place_thread();   ///< In a part of a loop, where `unplaced` is not 0.

/// At the beginning of every loop, and of every part of one.
inline void begin_loop() {
  if (unplaced < 0) unplaced = places_to_make();
}
inline void begin_part() {
  if (unplaced != 0) place_thread();
}

}  // namespace parallel_detail
}  // namespace limn
