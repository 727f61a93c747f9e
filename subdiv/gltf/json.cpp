#include "subdiv/gltf/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sdf/error.h"

namespace limn::gltf {
namespace {

/// A message shows no more of a value than this.
constexpr size_t kShown = 60;

std::string shown(const Json& value) {
  // What is nested deep would take as deep a stack.
  if (value.is_structured()) return value.is_array() ? "a list" : "an object";
  std::string all = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (all.size() > kShown) all = all.substr(0, kShown) + "...";
  return all;
}

/// Exporters write whole numbers as 3.0, too.
std::optional<std::uint64_t> as_whole(const Json& value) {
  if (value.is_number_unsigned()) return value.get<std::uint64_t>();
  if (!value.is_number_float()) return std::nullopt;
  const double number = value.get<double>();
  if (!(number >= 0.0 && number < 9e15) || number != std::floor(number)) return std::nullopt;
  return static_cast<std::uint64_t>(number);
}

}  // namespace

void refuse(const std::string& where, const std::string& problem, const std::string& expected, const std::string& value) {
  throw InputError({{}, where, value, problem, expected});
}

std::string element(const char* list, size_t index) { return fmt::format("{}[{}]", list, index); }

const Json* find(const Json& object, const char* key) {
  if (!object.is_object()) return nullptr;
  const auto at = object.find(key);
  return at == object.end() ? nullptr : &*at;
}

const Json* find_object(const Json& object, const char* key) {
  const Json* value = find(object, key);
  return value && value->is_object() ? value : nullptr;
}

const Json* find_element(const Json& root, const char* list, std::uint64_t index) {
  const Json* all = find(root, list);
  return all && all->is_array() && index < all->size() ? &(*all)[static_cast<size_t>(index)] : nullptr;
}

size_t length(const Json& root, const char* list) {
  const Json* all = find(root, list);
  return all && all->is_array() ? all->size() : 0;
}

std::string text(const Json& object, const char* key) {
  const Json* value = find(object, key);
  return value && value->is_string() ? value->get<std::string>() : std::string();
}

std::optional<std::uint64_t> whole_number(const Json& object, const char* key, const std::string& where) {
  const Json* value = find(object, key);
  if (!value) return std::nullopt;
  const std::optional<std::uint64_t> number = as_whole(*value);
  if (!number) refuse(where + "." + key, "not a whole number of 0 or more", "a number such as 0", shown(*value));
  return number;
}

std::optional<std::uint64_t> lenient_number(const Json& object, const char* key, bool& wrong) {
  const Json* value = find(object, key);
  if (!value) return std::nullopt;
  const std::optional<std::uint64_t> number = as_whole(*value);
  wrong |= !number;
  return number;
}

std::vector<double> numbers(const Json& object, const char* key, size_t count, const std::string& where) {
  const Json* value = find(object, key);
  if (!value) return {};
  std::vector<double> all;
  if (value->is_array()) {
    for (const Json& item : *value) {
      if (item.is_number() && std::isfinite(item.get<double>())) all.push_back(item.get<double>());
    }
  }
  if (!value->is_array() || all.size() != count || value->size() != count)
    refuse(where + "." + key, "wrong type", fmt::format("a list of {} finite numbers", count), shown(*value));
  return all;
}

std::optional<glm::vec3> color(const Json& object, const char* key) {
  const Json* value = find(object, key);
  if (!value || !value->is_array() || value->size() < 3) return std::nullopt;
  glm::vec3 result(0.0f);
  for (int i = 0; i < 3; ++i) {
    const Json& part = (*value)[static_cast<size_t>(i)];
    if (!part.is_number() || !std::isfinite(part.get<double>())) return std::nullopt;
    result[i] = static_cast<float>(std::clamp(part.get<double>(), 0.0, 1.0));
  }
  return result;
}

}  // namespace limn::gltf
