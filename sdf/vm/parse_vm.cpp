#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <unordered_map>

#include "sdf/error.h"
#include "sdf/vm/vm_program.h"

namespace limn::vm {
namespace {

struct Known {
  const char* name;
  Operation operation;
};
constexpr std::array kKnown = {
    Known{"var-x", Operation::x},          Known{"var-y", Operation::y},          Known{"var-z", Operation::z},
    Known{"const", Operation::constant},   Known{"neg", Operation::negate},       Known{"abs", Operation::absolute},
    Known{"square", Operation::square},    Known{"sin", Operation::sine},         Known{"cos", Operation::cosine},
    Known{"sqrt", Operation::square_root}, Known{"tan", Operation::tangent},      Known{"asin", Operation::arc_sine},
    Known{"acos", Operation::arc_cosine},  Known{"atan", Operation::arc_tangent}, Known{"exp", Operation::exponential},
    Known{"ln", Operation::logarithm},     Known{"log", Operation::logarithm},    Known{"recip", Operation::reciprocal},
    Known{"add", Operation::add},          Known{"sub", Operation::subtract},     Known{"mul", Operation::multiply},
    Known{"div", Operation::divide},       Known{"min", Operation::minimum},      Known{"max", Operation::maximum}};
constexpr std::array kJumping = {"compare", "mod", "and", "or", "not", "floor", "ceil", "round", "atan2"};

/// The words of a line, up to a comment.
std::vector<std::string_view> words_of(std::string_view line) {
  line = line.substr(0, line.find('#'));
  std::vector<std::string_view> words;
  constexpr std::string_view kBlank = " \t\r";
  for (size_t at = line.find_first_not_of(kBlank); at != std::string_view::npos;) {
    const size_t end = std::min(line.find_first_of(kBlank, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(kBlank, end);
  }
  return words;
}

class Parser {
 public:
  explicit Parser(const std::string& file) : file_(file) {}

  Program run(std::string_view text) {
    while (!text.empty()) {
      ++line_;
      const size_t end = text.find('\n');
      take(words_of(text.substr(0, end)));
      if (end == std::string_view::npos) break;
      text.remove_prefix(end + 1);
    }
    if (program_.empty()) throw InputError({file_, "", "", "the file has no operations", "lines such as '_1 var-x'"});
    return std::move(program_);
  }

 private:
  [[noreturn]] void fail(std::string_view got, const std::string& problem, const std::string& expected) const {
    constexpr size_t kShown = 60;
    throw InputError({fmt::format("{}:{}", file_, line_), "", std::string(got.substr(0, kShown)), problem, expected});
  }

  Operation operation_of(std::string_view name) const {
    for (const Known& known : kKnown) {
      if (name == known.name) return known.operation;
    }
    for (const char* jumping : kJumping) {
      if (name == jumping) fail(name, "an operation with jumps, which is not read", "operations without jumps");
    }
    std::vector<std::string> names;
    for (const Known& known : kKnown) names.emplace_back(known.name);
    fail(name, "an unknown operation", known_names(name, names));
  }

  std::uint32_t value_of(std::string_view name) const {
    const auto at = names_.find(std::string(name));
    if (at == names_.end()) fail(name, "no line before this one has that name", "the name of an earlier line");
    return at->second;
  }

  double number(std::string_view word) const {
    double value = 0.0;
    const char* const first = word.data() + (word.size() > 1 && word[0] == '+' ? 1 : 0);
    const auto [end, error] = std::from_chars(first, word.data() + word.size(), value);
    if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) fail(word, "not a finite number", "such as 0.5");
    return value;
  }

  void take(const std::vector<std::string_view>& words) {
    if (words.empty()) return;
    if (words.size() < 2) fail(words[0], "a name without an operation", "NAME OPERATION OPERANDS");
    if (program_.size() == kMostOperations) fail(words[0], "too many operations", fmt::format("at most {}", kMostOperations));
    Step step;
    step.operation = operation_of(words[1]);
    step.line = line_;
    const size_t wanted = step.operation == Operation::constant ? 1 : static_cast<size_t>(operands(step.operation));
    if (words.size() != wanted + 2) fail(words[1], fmt::format("{} operands", words.size() - 2), fmt::format("{} of them", wanted));
    if (step.operation == Operation::constant) step.constant = number(words[2]);
    if (step.operation != Operation::constant && wanted > 0) step.a = value_of(words[2]);
    if (wanted > 1) step.b = value_of(words[3]);
    if (!names_.emplace(std::string(words[0]), static_cast<std::uint32_t>(program_.size())).second)
      fail(words[0], "two lines have the same name", "a name of its own for each line");
    program_.push_back(step);
  }

  const std::string& file_;
  std::uint32_t line_ = 0;
  Program program_;
  std::unordered_map<std::string, std::uint32_t> names_;
};

}  // namespace

int operands(Operation operation) {
  switch (operation) {
    case Operation::x:
    case Operation::y:
    case Operation::z:
    case Operation::constant:
      return 0;
    case Operation::add:
    case Operation::subtract:
    case Operation::multiply:
    case Operation::divide:
    case Operation::minimum:
    case Operation::maximum:
    case Operation::norm2:
      return 2;
    case Operation::norm3:
      return 3;
    default:
      return 1;
  }
}

Program parse(std::string_view text, const std::string& file) { return Parser(file).run(text); }

}  // namespace limn::vm
