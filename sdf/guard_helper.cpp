#include "sdf/guard_helper.h"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

namespace limn {
namespace {

std::int64_t address_space_now() {
  std::FILE* file = std::fopen("/proc/self/statm", "r");
  if (!file) return 0;
  long long pages = 0;
  const bool found = std::fscanf(file, "%lld", &pages) == 1;
  std::fclose(file);
  return found ? static_cast<std::int64_t>(pages) * ::sysconf(_SC_PAGESIZE) : 0;
}

void limit_own_memory() {
  const char* text = std::getenv(kMemoryVariable);
  if (!text || !kAddressSpaceCanBeLimited) return;
  const auto bytes = static_cast<rlim_t>(address_space_now() + std::max(0LL, std::atoll(text)));
  rlimit limit{};
  ::getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = limit.rlim_max == RLIM_INFINITY ? bytes : std::min(bytes, limit.rlim_max);
  ::setrlimit(RLIMIT_AS, &limit);
}

int finish(ByteWriter& answer, int code) { return answer.finish() ? code : 1; }

int refuse(ByteWriter& answer, const std::string& reason) {
  answer.shrink(0);
  for (const char c : reason) answer.put(static_cast<unsigned char>(c) < ' ' ? ' ' : c);
  return finish(answer, kExitRefusal);
}

}  // namespace

int run_helper(const std::function<void(ByteWriter& answer)>& write) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  limit_own_memory();
  // Libraries catch bad_alloc and go on with half an object; ending at once tells what happened.
  std::set_new_handler([] { ::_exit(kExitMemory); });
  ByteWriter answer(kAnswerHandle);
  try {
    write(answer);
    return finish(answer, kExitAnswer);
  } catch (const std::bad_alloc&) {
    return kExitMemory;
  } catch (const std::exception& problem) {
    return refuse(answer, problem.what());
  } catch (...) {
    return refuse(answer, "cannot be read");
  }
}

}  // namespace limn
