#include "samples/spec/parse.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>

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
  if (!value) fail(field, text, "not a number", "a number such as 0.5");
  if (!std::isfinite(*value)) fail(field, text, "not finite", "a finite number");
  return *value;
}

double parse_number_above(const std::string& field, std::string_view text, double min, bool inclusive, const std::string& expected) {
  const double value = parse_number(field, text);
  if (value < min || (!inclusive && value <= min)) fail(field, text, "out of range", expected);
  return value;
}

int parse_integer(const std::string& field, std::string_view text, int min, int max) {
  const std::string expected = fmt::format("a whole number from {} to {}", min, max);
  const auto value = to_number(text);
  if (!value || !std::isfinite(*value) || *value != std::floor(*value)) fail(field, text, "not a whole number", expected);
  if (*value < min || *value > max) fail(field, text, "out of range", expected);
  return static_cast<int>(*value);
}

glm::dvec3 parse_vector3(const std::string& field, std::string_view text) {
  const auto parts = split(text, ',');
  if (parts.size() != 3) fail(field, text, "not a vector", "three numbers such as 1,0.5,-2");
  return {parse_number(field, parts[0]), parse_number(field, parts[1]), parse_number(field, parts[2])};
}

glm::dvec3 parse_direction(const std::string& field, std::string_view text) {
  const std::string_view axis = text.starts_with('-') ? text.substr(1) : text;
  const size_t index = axis.size() == 1 ? std::string_view("xyz").find(axis) : std::string_view::npos;
  if (index != std::string_view::npos) {
    glm::dvec3 direction(0.0);
    direction[static_cast<int>(index)] = text.starts_with('-') ? -1.0 : 1.0;
    return direction;
  }
  if (split(text, ',').size() != 3) fail(field, text, "not a direction", "an axis such as z or -y, or three numbers such as 1,0.5,-2");
  return parse_vector3(field, text);
}

glm::ivec2 parse_size(const std::string& field, std::string_view text) {
  const auto parts = split(text, 'x');
  if (parts.size() != 2) fail(field, text, "not a size", "WxH in pixels such as 1280x720");
  return {parse_integer(field, parts[0], 1, 16384), parse_integer(field, parts[1], 1, 16384)};
}

ParameterSetting parse_key_value(const std::string& field, std::string_view text) {
  const size_t at = text.find('=');
  if (at == std::string_view::npos || at == 0) fail(field, text, "not a pair", "key=value such as threshold=0.4");
  return {std::string(text.substr(0, at)), parse_parameter(text.substr(at + 1))};
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

std::vector<std::string> parse_names(const std::string& text) {
  std::vector<std::string> names;
  for (const std::string_view part : split(text, ',')) names.emplace_back(part);
  return names;
}

std::vector<int> parse_integers(const std::string& text, const std::function<int(const std::string&)>& read,
                                const std::function<int(int)>& next) {
  std::set<int> all;
  for (const std::string& part : parse_names(text)) {
    const size_t dots = part.find("..");
    if (dots == std::string::npos) {
      all.insert(read(part));
      continue;
    }
    const int first = read(part.substr(0, dots)), last = read(part.substr(dots + 2));
    for (int value = std::min(first, last); value <= std::max(first, last); value = next(value)) all.insert(value);
  }
  return {all.begin(), all.end()};
}

std::vector<double> parse_thresholds(const std::string& field, const std::string& text) {
  std::set<double> all;
  for (const std::string& part : parse_names(text)) {
    const double value = parse_number(field, part);
    if (value < 0.0 || value >= 1.0) fail(field, part, "out of range", "numbers from 0 up and below 1, such as 0.2,0.4");
    all.insert(value);
  }
  return {all.begin(), all.end()};
}

std::vector<double> parse_tolerances(const std::string& field, const std::string& text) {
  std::set<double> all;
  for (const std::string& part : parse_names(text)) {
    const double value = parse_number(field, part);
    if (!(value > 0.0) || !std::isfinite(value)) fail(field, part, "out of range", "numbers of pixels above 0, such as 1,0.5,0.25");
    all.insert(value);
  }
  return {all.begin(), all.end()};
}

std::int64_t parse_bytes(const std::string& field, const std::string& text, double least) {
  const std::string expected = "a size such as 500M, 4G or 2000000";
  const std::string_view units = "kMGT";
  std::string_view number = text;
  if (number.ends_with('B')) number.remove_suffix(1);
  const char last = number.empty() ? '\0' : number.back();
  const size_t unit = units.find(last == 'K' ? 'k' : last);
  const bool has_unit = unit != std::string_view::npos;
  if (has_unit) number.remove_suffix(1);
  const auto value = to_number(number);
  if (!value || !std::isfinite(*value)) fail(field, text, "not a size in bytes", expected);
  const double bytes = *value * (has_unit ? std::pow(1000.0, static_cast<double>(unit) + 1.0) : 1.0);
  if (bytes < least || bytes > 1e18) fail(field, text, "out of range", least < 1e6 ? "at least 1k" : "at least 1M");
  return static_cast<std::int64_t>(bytes);
}

double parse_milliseconds(const std::string& field, const std::string& text) {
  const std::string expected = "a time such as 200ms, 90s, 10m or 2h";
  const std::pair<const char*, double> units[] = {{"ms", 1.0}, {"s", 1e3}, {"m", 6e4}, {"h", 3.6e6}};
  for (const auto& [unit, milliseconds] : units) {
    if (!text.ends_with(unit)) continue;
    const auto value = to_number(std::string_view(text).substr(0, text.size() - std::string_view(unit).size()));
    if (!value || !std::isfinite(*value)) continue;
    if (!(*value > 0.0) || *value * milliseconds > 1e12) fail(field, text, "out of range", expected);
    return *value * milliseconds;
  }
  fail(field, text, "not a time", expected);
}

bool parse_plan_metric(const std::string& field, const std::string& text) {
  if (text != "border" && text != "silhouette") fail(field, text, "unknown metric", known_names(text, {"border", "silhouette"}));
  return text == "silhouette";
}

std::pair<int, int> parse_shard(const std::string& field, const std::string& text) {
  const auto parts = split(text, '/');
  if (parts.size() != 2) fail(field, text, "not a part", "I/N such as 2/8, the second part of eight");
  const int count = parse_integer(field, parts[1], 1, 10'000);
  return {parse_integer(field, parts[0], 1, count), count};
}

glm::dvec2 parse_page(const std::string& field, std::string_view text) {
  const char* const expected = "WIDTHxHEIGHTmm, such as 210x297mm, each above 0 and up to 10000";
  const std::string whole(text);
  const bool in_mm = whole.size() > 2 && whole.substr(whole.size() - 2) == "mm";
  const std::string numbers = in_mm ? whole.substr(0, whole.size() - 2) : whole;
  const auto parts = split(numbers, 'x');
  if (!in_mm || parts.size() != 2) fail(field, whole, "not a page", expected);
  const glm::dvec2 page(parse_number_above(field, parts[0], 0.0, false, expected),
                        parse_number_above(field, parts[1], 0.0, false, expected));
  if (page.x > 10'000.0 || page.y > 10'000.0) fail(field, whole, "out of range", expected);
  return page;
}

std::pair<int, int> parse_layers(const std::string& field, const std::string& text) {
  constexpr int kMost = 1'000'000;
  const size_t dots = text.find("..");
  const auto layers = [&](const std::string& part) { return parse_integer(field, part, 0, kMost); };
  if (dots == std::string::npos) return {layers(text), layers(text)};
  const std::string last = text.substr(dots + 2);
  const std::pair<int, int> range{layers(text.substr(0, dots)), last.empty() ? kMost : layers(last)};
  if (range.first > range.second) fail(field, text, "not a range", "the lesser number first, such as 0..2");
  return range;
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
