#include "samples/spec/flags.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "samples/spec/surface_setting.h"

namespace limn {
namespace {

constexpr std::string_view kParameters = "parameters.";

/// Fields that are options of the same name, beside the settings of surfaces; the underscore is a dash there.
constexpr std::array<std::string_view, 57> kFields = {"azimuth",
                                                      "look",
                                                      "shading",
                                                      "transparent",
                                                      "ink_only",
                                                      "elevation",
                                                      "roll",
                                                      "zoom",
                                                      "margin",
                                                      "background",
                                                      "budget",
                                                      "draws",
                                                      "eye",
                                                      "flicker",
                                                      "fov",
                                                      "frames",
                                                      "turntable",
                                                      "fresh",
                                                      "local",
                                                      "gradients",
                                                      "levels",
                                                      "max_memory",
                                                      "max_time",
                                                      "method",
                                                      "methods",
                                                      "metric",
                                                      "no_clobber",
                                                      "ortho",
                                                      "output",
                                                      "path_step",
                                                      "refined",
                                                      "samples",
                                                      "seed",
                                                      "shard",
                                                      "size",
                                                      "surface",
                                                      "surfaces",
                                                      "target",
                                                      "threads",
                                                      "thresholds",
                                                      "tolerance",
                                                      "up",
                                                      "views",
                                                      "case",
                                                      "json",
                                                      "brick",
                                                      "dump",
                                                      "reference",
                                                      "ink",
                                                      "alpha",
                                                      "mask",
                                                      "style",
                                                      "crease_angle",
                                                      "suggestive_angle",
                                                      "suggestive_slope",
                                                      "ridge_strength",
                                                      "fair"};

/// Whose name is another one.
constexpr std::array<std::pair<std::string_view, std::string_view>, 2> kOthers = {{{"grids", "grid"}, {"cases", "case"}}};

bool is_field(std::string_view name) {
  const auto other = [&](const auto& pair) { return pair.first == name; };
  return std::find(kFields.begin(), kFields.end(), name) != kFields.end() || look_up_surface_setting(name) != nullptr ||
         std::any_of(kOthers.begin(), kOthers.end(), other);
}

bool is_name_character(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.';
}

/// These are no words of a sentence, so that they are fields wherever they stand.
bool is_never_a_word(std::string_view name) { return name == "max_memory" || name == "max_time"; }

}  // namespace

std::string flag_of(const std::string& field) {
  if (field.starts_with(kParameters)) return "--set " + field.substr(kParameters.size());
  if (!is_field(field)) return field;
  std::string name = field;
  for (const auto& [from, to] : kOthers)
    if (field == from) name = to;
  std::replace(name.begin(), name.end(), '_', '-');
  return name.insert(0, "--");
}

std::string in_flags(const std::string& text) {
  constexpr std::string_view kIs = " = ", kTrue = "true";
  std::string out;
  for (size_t at = 0; at < text.size();) {
    if (!is_name_character(text[at])) {
      out += text[at++];
      continue;
    }
    size_t end = at;
    while (end < text.size() && is_name_character(text[end])) ++end;
    const std::string name = text.substr(at, end - at);
    at = end;
    const bool is_set = std::string_view(text).substr(end).starts_with(kIs);
    const bool quoted = end < text.size() && (text[end] == '\'' || text[end] == '"');
    if (quoted || !(is_never_a_word(name) || (is_set && (is_field(name) || name.starts_with(kParameters))))) {
      out += name;
      continue;
    }
    out += flag_of(name);
    if (!is_set) continue;
    at = end + kIs.size();
    const std::string_view rest = std::string_view(text).substr(at);
    const bool is_switch = rest.starts_with(kTrue) && (rest.size() == kTrue.size() || !is_name_character(rest[kTrue.size()]));
    if (is_switch)
      at += kTrue.size();
    else
      out += name.starts_with(kParameters) ? '=' : ' ';
  }
  return out;
}

InputFault in_flags(InputFault fault) {
  if (is_of_specification(fault)) fault.field = flag_of(fault.field);
  fault.problem = in_flags(fault.problem);
  fault.expected = in_flags(fault.expected);
  return fault;
}

bool is_of_specification(const InputFault& fault) {
  // These are named with the file that they are about; all others are keys there.
  if (!fault.file.empty() && fault.field != "output" && fault.field != "no_clobber" && fault.field != "level") return false;
  return is_field(fault.field) || fault.field.starts_with(kParameters) || fault.field.starts_with("-");
}

void CallText::add(const std::string& field, const std::string& value) {
  text_.append(" ").append(flag_of(field)).append(field.starts_with(kParameters) ? "=" : " ").append(value);
}

void CallText::add(const std::string& field) { text_.append(" ").append(flag_of(field)); }

std::map<std::string, std::string> settings_of_call(const std::string& call) {
  constexpr std::string_view kNext = " --";
  std::map<std::string, std::string> settings;
  for (size_t at = call.find(kNext); at != std::string::npos;) {
    const size_t next = call.find(kNext, at + 1);
    const std::string one = call.substr(at + 1, next == std::string::npos ? next : next - at - 1);
    const size_t split = one.starts_with("--set ") ? one.find('=') : one.find(' ');
    settings[one.substr(0, split)] = split == std::string::npos ? "given" : one.substr(split + 1);
    at = next;
  }
  return settings;
}

}  // namespace limn
