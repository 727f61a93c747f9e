#pragma once
// Errors: InputError for what a user can cause, LIMN_CHECK for what only we can.

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace limn {

/// What is wrong with something a user gave us, in the words of the one line that the command line prints.
struct InputFault {
  std::string file{};      ///< Path as the user gave it, with line and column where known; empty for a setting of a call.
  std::string field{};     ///< Setting, key or part of the file ("fov", "object[1].radius", "grid"); may be empty.
  std::string value{};     ///< The offending value as text; may be empty.
  std::string problem{};   ///< What is wrong: "not a number", "no such file".
  std::string expected{};  ///< What would be right: "above 0 and below 180 degrees".
};

/// Thrown for every fault that input can cause; caught once, in main (exit code 2).
/// what() is one line: `file:field: problem (got value); expected`.
class InputError : public std::runtime_error {
 public:
  explicit InputError(InputFault fault);              ///< what() is made from the fault.
  const InputFault& fault() const { return fault_; }  ///< The parts that what() is made from.

 private:
  InputFault fault_;
};

/// Thrown where the machine failed us: a disk is full, memory ran out, a child process could not start (exit code 1).
class MachineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The candidate nearest to `name` by edit distance, or an empty string where none is near enough to be a slip of the hand.
std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates);

/// "; did you mean 'sphere'? known: box, sphere" for a fault's `expected`.
std::string known_names(std::string_view name, const std::vector<std::string>& candidates);

/// What LIMN_CHECK calls: prints the condition and its place on stderr, and aborts.
[[noreturn]] void check_failed(const char* condition, const char* file, int line);

}  // namespace limn

/// A fault of our own: aborts with the place. Never used for what a user can cause.
#define LIMN_CHECK(condition) ((condition) ? void(0) : ::limn::check_failed(#condition, __FILE__, __LINE__))
