#include <opensubdiv/far/error.h>

#include <cstdio>
#include <exception>
#include <new>

#include "raymarch/gbuffer.h"
#include "samples/commands/program.h"
#include "samples/output/interrupt.h"
#include "samples/output/standard_streams.h"
#include "samples/spec/flags.h"
#include "sdf/error.h"
#include "sdf/thread_places.h"

int main(int argc, char** argv) {
  limn::keep_standard_streams();
  limn::install_interrupt_handlers();
  limn::keep_threads_apart();
  // It would print lines of its own about meshes that the audit and our errors speak of.
  OpenSubdiv::Far::SetWarningCallback([](const char*) {});
  try {
    return limn::run_program(argc, argv);
  } catch (const limn::Cancelled&) {
    return limn::interrupt_exit_code();
  } catch (const limn::InputError& error) {
    // Whatever failed after the interrupt failed because of it: a child process ended, a file was not written.
    if (limn::interrupted()) return limn::interrupt_exit_code();
    std::fprintf(stderr, "limn: %s\n", limn::InputError(limn::in_flags(error.fault())).what());
    return 2;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "limn: out of memory; use fewer voxels or a lower level\n");
  } catch (const std::exception& error) {
    if (limn::interrupted()) return limn::interrupt_exit_code();
    std::fprintf(stderr, "limn: %s\n", error.what());
  }
  return 1;
}
