#pragma once
// Internal: looking things up in a glTF document. What geometry needs is refused with its place where it has the wrong type; everything
// else that has the wrong type counts as absent.

#include <cstdint>
#include <glm/glm.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace limn::gltf {

using Json = nlohmann::json;

/// InputError without a file, which whoever asked for the file adds. `where` names the part: "meshes[2].primitives[0]".
[[noreturn]] void refuse(const std::string& where, const std::string& problem, const std::string& expected, const std::string& value = {});

/// "accessors[3]"
std::string element(const char* list, size_t index);

/// Null where `object` is no object or has no such key.
const Json* find(const Json& object, const char* key);
/// Null where it is absent or no object.
const Json* find_object(const Json& object, const char* key);
/// Null where there is no list of that name, it is no list, or is shorter; `where` (empty: no refusal) says what asked for it.
const Json* find_element(const Json& root, const char* list, std::uint64_t index);
/// How long the list is; 0 where there is none.
size_t length(const Json& root, const char* list);

/// Empty where it is absent or no text.
std::string text(const Json& object, const char* key);
/// An index or a count: a whole number of 0 or more. Absent: nullopt; anything else is refused.
std::optional<std::uint64_t> whole_number(const Json& object, const char* key, const std::string& where);
/// The same, but what is no whole number counts as absent, and `wrong` is set.
std::optional<std::uint64_t> lenient_number(const Json& object, const char* key, bool& wrong);
/// `count` finite numbers. Absent: empty; anything else is refused.
std::vector<double> numbers(const Json& object, const char* key, size_t count, const std::string& where);
/// A color's first three parts, from 0 to 1. What is no list of three or more numbers counts as absent.
std::optional<glm::vec3> color(const Json& object, const char* key);

}  // namespace limn::gltf
