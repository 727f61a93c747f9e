#include "samples/parse.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <optional>

#include "sdf/error.h"

namespace limn {
namespace {

std::optional<double> to_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (size_t begin = 0;;) {
    const size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end == std::string_view::npos ? end : end - begin));
    if (end == std::string_view::npos) return parts;
    begin = end + 1;
  }
}

[[noreturn]] void fail(const std::string& field, std::string_view value, const std::string& problem, const std::string& expected) {
  throw InputError({"", field, value.empty() ? "nothing" : std::string(value), problem, expected});
}

}  // namespace

double parse_number(const std::string& field, std::string_view text) {
  const auto value = to_number(text);
  if (!value) fail(field, text, "not a number", "a number such as 0.5 would be right");
  if (!std::isfinite(*value)) fail(field, text, "not finite", "a finite number would be right");
  return *value;
}

double parse_number_above(const std::string& field, std::string_view text, double min, bool inclusive, const std::string& expected) {
  const double value = parse_number(field, text);
  if (value < min || (!inclusive && value <= min)) fail(field, text, "out of range", expected);
  return value;
}

int parse_integer(const std::string& field, std::string_view text, int min, int max) {
  const std::string expected = fmt::format("a whole number from {} to {} would be right", min, max);
  const auto value = to_number(text);
  if (!value || !std::isfinite(*value) || *value != std::floor(*value)) fail(field, text, "not a whole number", expected);
  if (*value < min || *value > max) fail(field, text, "out of range", expected);
  return static_cast<int>(*value);
}

glm::dvec3 parse_vector3(const std::string& field, std::string_view text) {
  const auto parts = split(text, ',');
  if (parts.size() != 3) fail(field, text, "not a vector", "three numbers such as 1,0.5,-2 would be right");
  return {parse_number(field, parts[0]), parse_number(field, parts[1]), parse_number(field, parts[2])};
}

glm::ivec2 parse_size(const std::string& field, std::string_view text) {
  const auto parts = split(text, 'x');
  if (parts.size() != 2) fail(field, text, "not a size", "WxH in pixels such as 1280x720 would be right");
  return {parse_integer(field, parts[0], 1, 16384), parse_integer(field, parts[1], 1, 16384)};
}

KeyValue parse_key_value(const std::string& field, std::string_view text) {
  const size_t at = text.find('=');
  if (at == std::string_view::npos || at == 0) fail(field, text, "not a pair", "key=value such as threshold=0.4 would be right");
  return {std::string(text.substr(0, at)), std::string(text.substr(at + 1))};
}

ParameterInput parse_parameter(std::string_view text) {
  ParameterInput input;
  if (text == "true" || text == "false") {
    input.numbers = {text == "true" ? 1.0 : 0.0};
    return input;
  }
  for (const std::string_view part : split(text, ',')) {
    const auto value = to_number(part);
    if (!value) {
      input.numbers.clear();
      input.word = std::string(text);
      return input;
    }
    input.numbers.push_back(*value);
  }
  return input;
}

Scheme parse_scheme(const std::string& name, const std::string& file, const std::string& field) {
  std::vector<std::string> known;
  for (const Scheme scheme : {Scheme::catmark, Scheme::loop, Scheme::bilinear}) {
    if (name == name_of(scheme)) return scheme;
    known.emplace_back(name_of(scheme));
  }
  throw InputError({file, field, name, "unknown subdivision scheme", known_names(name, known)});
}

const char* name_of(NormalKind kind) {
  switch (kind) {
    case NormalKind::flat:
      return "flat";
    case NormalKind::vertex:
      return "vertex";
    case NormalKind::limit:
      break;
  }
  return "limit";
}

NormalKind parse_normals(const std::string& name, const std::string& file, const std::string& field) {
  std::vector<std::string> known;
  for (const NormalKind kind : {NormalKind::flat, NormalKind::vertex, NormalKind::limit}) {
    if (name == name_of(kind)) return kind;
    known.emplace_back(name_of(kind));
  }
  throw InputError({file, field, name, "unknown kind of normals", known_names(name, known)});
}

}  // namespace limn
