#include "sdf/guard_helper.h"

#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

#include "sdf/error.h"
#include "sdf/guard.h"

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

bool send(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(kAnswerHandle, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes = bytes.subspan(static_cast<size_t>(count));
  }
  return true;
}

}  // namespace

int send_answer(std::span<const std::byte> answer) { return send(answer) ? kExitAnswer : 1; }

int send_refusal(const std::string& reason) {
  std::string line = reason;
  std::replace_if(
      line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  return send(std::as_bytes(std::span(line))) ? kExitRefusal : 1;
}

int run_helper(const std::function<std::vector<std::byte>()>& read) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  limit_own_memory();
  // Libraries catch bad_alloc and go on with half an object; ending at once tells what happened.
  std::set_new_handler([] { ::_exit(kExitMemory); });
  try {
    return send_answer(read());
  } catch (const std::bad_alloc&) {
    return kExitMemory;
  } catch (const std::exception& problem) {
    return send_refusal(problem.what());
  } catch (...) {
    return send_refusal("cannot be read");
  }
}

}  // namespace limn
