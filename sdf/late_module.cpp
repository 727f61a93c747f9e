#include "sdf/late_module.h"

#include <dlfcn.h>

#include <new>

#include "sdf/error.h"
#include "sdf/guard.h"

namespace limn {

void want_memory(std::size_t bytes) {
  void* memory = ::operator new(bytes);
  asm volatile("" : "+r"(memory));  // else the compiler may leave out both
  ::operator delete(memory);
}

void refuse_late_module(const std::string& file, const std::string& problem) {
  throw MachineError("the module " + file + " cannot be loaded: " + problem);
}

void* find_late_function(const std::string& file, const std::string& function) {
  const std::string path = find_helper(file).string();
  void* const module = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) refuse_late_module(path, ::dlerror());
  void* const found = ::dlsym(module, function.c_str());
  if (found == nullptr) refuse_late_module(path, ::dlerror());
  return found;
}

}  // namespace limn
