#pragma once
// Text of the command line into values. Every function throws InputError naming `field` ("voxels").

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "samples/spec/spec.h"
#include "sdf/descriptor.h"
#include "subdiv/refine.h"

namespace limn {

double parse_number(const std::string& field, std::string_view text);
/// A finite number, min < x (or <=, where `inclusive`) and x <= max; `expected` is what the message says would be right.
double parse_number_above(const std::string& field, std::string_view text, double min, bool inclusive, const std::string& expected);
int parse_integer(const std::string& field, std::string_view text, int min, int max);
glm::dvec3 parse_vector3(const std::string& field, std::string_view text);
/// Three numbers, or the name of an axis: x, -x, y, -y, z or -z.
glm::dvec3 parse_direction(const std::string& field, std::string_view text);
/// "1280x720".
glm::ivec2 parse_size(const std::string& field, std::string_view text);
/// `key=value`, where a value is a number, numbers with commas between them, true, false or a word.
ParameterSetting parse_key_value(const std::string& field, std::string_view text);
ParameterInput parse_parameter(std::string_view text);

/// "a,b,c"; empty names are kept, so that they are complained about.
std::vector<std::string> parse_names(const std::string& text);
/// "0,2,4" or "0..6", mixed at will, each number read by `read`; `next` gives the number after one in a range. Rising, each once.
std::vector<int> parse_integers(const std::string& text, const std::function<int(const std::string&)>& read,
                                const std::function<int(int)>& next);
/// Numbers from 0 to 1, commas between them; rising, each once.
std::vector<double> parse_thresholds(const std::string& field, const std::string& text);
/// Numbers of pixels above 0, rising.
std::vector<double> parse_tolerances(const std::string& field, const std::string& text);
/// "500M", "4GB", "1.5T", or bytes: decimal units; at least `least`.
std::int64_t parse_bytes(const std::string& field, const std::string& text, double least = 1e6);
/// A plan's models may be small.
inline constexpr double kLeastBudget = 1e3;
/// "200ms", "90s", "10m", "2h"; above 0.
double parse_milliseconds(const std::string& field, const std::string& text);
/// True for "silhouette", false for "border".
bool parse_plan_metric(const std::string& field, const std::string& text);
/// "2/8": part and count.
std::pair<int, int> parse_shard(const std::string& field, const std::string& text);

/// "210x297mm": width and height, millimetres.
glm::dvec2 parse_page(const std::string& field, std::string_view text);
/// "0", "1..3" or "1..": from and to, both included.
std::pair<int, int> parse_layers(const std::string& field, const std::string& text);

/// `file` empty: a command-line option.
Scheme parse_scheme(const std::string& name, const std::string& file, const std::string& field);
NormalKind parse_normals(const std::string& name, const std::string& file, const std::string& field);
const char* name_of(NormalKind kind);

}  // namespace limn
