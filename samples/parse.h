#pragma once
// Text of the command line into values. Every function throws InputError naming `field` ("--voxels").

#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "sdf/descriptor.h"
#include "subdiv/refine.h"

namespace limn {

double parse_number(const std::string& field, std::string_view text);
/// A finite number, min < x (or <=, where `inclusive`) and x <= max; `expected` is what the message says would be right.
double parse_number_above(const std::string& field, std::string_view text, double min, bool inclusive, const std::string& expected);
int parse_integer(const std::string& field, std::string_view text, int min, int max);
glm::dvec3 parse_vector3(const std::string& field, std::string_view text);
/// "1280x720".
glm::ivec2 parse_size(const std::string& field, std::string_view text);
/// `key=value`, where a value is a number, numbers with commas between them, true, false or a word.
struct KeyValue {
  std::string key, value;
};
KeyValue parse_key_value(const std::string& field, std::string_view text);
ParameterInput parse_parameter(std::string_view text);

/// `file` empty: a command-line option.
Scheme parse_scheme(const std::string& name, const std::string& file, const std::string& field);
NormalKind parse_normals(const std::string& name, const std::string& file, const std::string& field);
const char* name_of(NormalKind kind);

}  // namespace limn
