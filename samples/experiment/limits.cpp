#include "samples/experiment/limits.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <thread>

#include "samples/output/interrupt.h"
#include "samples/output/output.h"
#include "samples/spec/flags.h"
#include "sdf/error.h"
#include "sdf/guard_helper.h"

namespace limn {
namespace {

/// Of the stacks of the threads that libraries start later: counted as allocated, hardly touched.
constexpr double kStackBytes = 8e6;
/// Work that cannot be done with less on top of what is there.
constexpr double kLeastBytes = 10e6;

/// The number in the file's first line, or behind `key` ("VmData:"); infinite where there is none ("max").
double number_in(const std::string& file, const std::string& key = {}) {
  std::ifstream stream(file);
  std::string line;
  while (std::getline(stream, line)) {
    if (!line.starts_with(key)) continue;
    double value = 0.0;
    if (std::istringstream(line.substr(key.size())) >> value) return value;
    break;
  }
  return std::numeric_limits<double>::infinity();
}

/// Memory limit of the control groups that we are in, and of those above them.
double control_group_memory() {
  double least = std::min(number_in("/sys/fs/cgroup/memory.max"), number_in("/sys/fs/cgroup/memory/memory.limit_in_bytes"));
  std::ifstream stream("/proc/self/cgroup");
  std::string line;
  while (std::getline(stream, line)) {
    if (!line.starts_with("0::")) continue;
    std::string path = line.substr(3);
    while (path.size() > 1) {
      least = std::min(least, number_in("/sys/fs/cgroup" + path + "/memory.max"));
      path.resize(path.rfind('/') == std::string::npos ? 0 : path.rfind('/'));
    }
  }
  return least;
}

void limit_memory(const LimitSpec& limits) {
  const double wanted = static_cast<double>(*limits.max_memory);
  const double resident = 1024.0 * number_in("/proc/self/status", "VmRSS:"), data = 1024.0 * number_in("/proc/self/status", "VmData:");
  if (wanted < resident + kLeastBytes) {
    throw InputError({"", "max_memory", bytes_text(wanted), fmt::format("too little; the program itself takes {}", bytes_text(resident)),
                      fmt::format("at least {}", bytes_text(std::ceil((resident + kLeastBytes) / 1e7) * 1e7))});
  }
  if (!kAddressSpaceCanBeLimited || !std::isfinite(data)) return;
  const double stacks = 2.0 * kStackBytes * std::max(1u, std::thread::hardware_concurrency());
  rlimit limit{};
  ::getrlimit(RLIMIT_DATA, &limit);
  // A helper program inherits it.
  limit.rlim_cur = std::min(limit.rlim_max, static_cast<rlim_t>(data + wanted - resident + std::min(stacks, 0.25 * wanted)));
  ::setrlimit(RLIMIT_DATA, &limit);
}

}  // namespace

double machine_memory() {
  const double physical = static_cast<double>(::sysconf(_SC_PHYS_PAGES)) * static_cast<double>(::sysconf(_SC_PAGESIZE));
  return std::min(physical, control_group_memory());
}

std::int64_t model_bytes_left(const LimitSpec& limits, double other_bytes) {
  constexpr double kDefault = 8.0 * 1024 * 1024 * 1024;
  const double allowed = limits.max_memory ? static_cast<double>(*limits.max_memory) : std::min(kDefault, machine_memory());
  return static_cast<std::int64_t>(std::max(1e6, allowed - kProgramBytes - other_bytes));
}

void hold_limits(const LimitSpec& limits, bool goes_on) {
  if (limits.max_time_ms)
    stop_after(*limits.max_time_ms, in_flags(fmt::format("max_time: stopped after {}", time_text(*limits.max_time_ms))));
  const std::string less = "use fewer voxels, a lower level or a smaller picture";
  if (limits.max_memory) limit_memory(limits);
  if (goes_on) return go_on_when_out_of_memory();
  end_when_out_of_memory(in_flags(limits.max_memory ? fmt::format("max_memory: the limit of {} was reached; {}",
                                                                  bytes_text(static_cast<double>(*limits.max_memory)), less)
                                                    : "out of memory; " + less));
}

}  // namespace limn
