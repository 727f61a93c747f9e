#include "sdf/error.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <numeric>

namespace limn {
namespace {

std::string one_line(const InputFault& fault) {
  std::string text = fault.file;
  if (!fault.field.empty()) text += (text.empty() ? "" : ":") + fault.field;
  if (!text.empty()) text += ": ";
  text += fault.problem;
  std::string details = fault.value.empty() ? "" : "got " + fault.value;
  if (!fault.expected.empty()) details += (details.empty() ? "expected " : ", expected ") + fault.expected;
  if (!details.empty()) text += " (" + details + ")";
  // The promise is one line, whatever a file name or a library's message holds.
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  return text;
}

size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 1; i <= a.size(); ++i) {
    size_t diagonal = row[0];
    row[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      const size_t substituted = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substituted});
    }
  }
  return row.back();
}

}  // namespace

InputError::InputError(InputFault fault) : std::runtime_error(one_line(fault)), fault_(std::move(fault)) {}

std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates) {
  std::string best;
  size_t best_distance = std::max<size_t>(2, name.size() / 2);
  for (const std::string& candidate : candidates) {
    const bool begins = !name.empty() && std::string_view(candidate).starts_with(name);
    const size_t distance = begins ? 0 : edit_distance(name, candidate);
    if (distance > best_distance || (distance == best_distance && !best.empty())) continue;
    best = candidate;
    best_distance = distance;
  }
  return best;
}

std::string known_names(std::string_view name, const std::vector<std::string>& candidates) {
  if (candidates.size() == 1) return "'" + candidates.front() + "'";
  std::string text = "one of";
  for (const std::string& candidate : candidates) text += (&candidate == &candidates.front() ? " " : ", ") + candidate;
  if (const std::string near = nearest_name(name, candidates); !near.empty()) text += "; did you mean '" + near + "'?";
  return text;
}

void check_failed(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "limn: internal check failed: %s at %s:%d\n", condition, file, line);
  std::abort();
}

}  // namespace limn
