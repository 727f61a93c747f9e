#include "samples/input/toml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "sdf/color_text.h"

namespace limn {

toml::table parse_toml(const std::string& text, const std::string& file) {
  try {
    return toml::parse(text, file);
  } catch (const toml::parse_error& error) {
    const toml::source_position at = error.source().begin;
    throw InputError({fmt::format("{}:{}:{}", file, at.line, at.column), "", "", std::string(error.description()), "valid TOML"});
  }
}

namespace {

std::optional<double> finite_number(const toml::node& node) {
  if (!node.is_number()) return std::nullopt;
  const double value = node.is_integer() ? static_cast<double>(node.as_integer()->get()) : node.as_floating_point()->get();
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

// False where something in it is not a finite number.
bool flatten(const toml::array& array, std::vector<double>& numbers) {
  for (const toml::node& item : array) {
    if (const toml::array* nested = item.as_array()) {
      if (!flatten(*nested, numbers)) return false;
      continue;
    }
    const auto value = finite_number(item);
    if (!value) return false;
    numbers.push_back(*value);
  }
  return true;
}

}  // namespace

// Not by the library's own formatter: it converts negative numbers within lists to unsigned ones, and writes 0.1 with 17 digits.
std::string value_text(const toml::node& node) {
  constexpr size_t kLongest = 60;
  std::ostringstream text;
  size_t count = 0;
  if (const toml::array* const list = node.as_array()) {
    for (const toml::node& item : *list) {
      if (static_cast<size_t>(text.tellp()) > kLongest) break;
      text << (count++ == 0 ? "[ " : ", ") << value_text(item);
    }
    text << (count == 0 ? "[]" : " ]");
  } else if (const toml::table* const table = node.as_table()) {
    for (const auto& [key, item] : *table) {
      if (static_cast<size_t>(text.tellp()) > kLongest) break;
      text << (count++ == 0 ? "{ " : ", ") << key.str() << " = " << value_text(item);
    }
    text << (count == 0 ? "{}" : " }");
  } else if (const toml::value<double>* const number = node.as_floating_point()) {
    text << fmt::format("{:#}", number->get());
  } else {
    text << toml::node_view<const toml::node>(node);
  }
  std::string out = text.str();
  if (out.size() > kLongest) out = out.substr(0, kLongest) + "...";
  return out;
}

std::string TomlReader::where(const toml::node& node) const {
  const toml::source_position at = node.source().begin;
  return at.line == 0 ? file_ : fmt::format("{}:{}:{}", file_, at.line, at.column);
}

void TomlReader::fail(const toml::node& node, const std::string& key, const std::string& problem, const std::string& expected) const {
  throw InputError({where(node), field(key), value_text(node), problem, expected});
}

void TomlReader::fail(const std::string& problem, const std::string& expected) const {
  std::string name = prefix_;
  if (!name.empty()) name.pop_back();
  throw InputError({where(*table_), name, "", problem, expected});
}

bool TomlReader::taken(const std::string& key) const { return std::find(known_.begin(), known_.end(), key) != known_.end(); }

const toml::node* TomlReader::take(const std::string& key) {
  if (!taken(key)) known_.push_back(key);
  return table_->get(key);
}

std::optional<std::string> TomlReader::text(const std::string& key) {
  const toml::node* node = take(key);
  if (node == nullptr) return std::nullopt;
  const auto* value = node->as_string();
  if (value == nullptr) fail(*node, key, "not text", "a word in quotes");
  return value->get();
}

std::optional<double> TomlReader::number(const std::string& key, double min, double max, const std::string& expected) {
  const toml::node* node = take(key);
  if (node == nullptr) return std::nullopt;
  const auto value = finite_number(*node);
  if (!value) fail(*node, key, "not a finite number", expected);
  if (*value < min || *value > max) fail(*node, key, "out of range", expected);
  return value;
}

std::optional<double> TomlReader::number_between(const std::string& key, double min, double max, const std::string& expected) {
  const auto value = number(key, min, max, expected);
  if (value && (*value == min || *value == max)) fail(*table_->get(key), key, "out of range", expected);
  return value;
}

std::optional<int> TomlReader::integer(const std::string& key, int min, int max) {
  const toml::node* node = take(key);
  if (node == nullptr) return std::nullopt;
  const std::string expected = fmt::format("a whole number from {} to {}", min, max);
  const auto value = finite_number(*node);
  if (!value || *value != std::floor(*value)) fail(*node, key, "not a whole number", expected);
  if (*value < min || *value > max) fail(*node, key, "out of range", expected);
  return static_cast<int>(*value);
}

std::optional<std::vector<double>> TomlReader::numbers(const std::string& key, size_t count, const std::string& expected) {
  const toml::node* node = take(key);
  if (node == nullptr) return std::nullopt;
  std::vector<double> values;
  const toml::array* array = node->as_array();
  if (array == nullptr || !flatten(*array, values) || values.size() != count) {
    fail(*node, key, fmt::format("not {} finite numbers", count), expected);
  }
  return values;
}

std::optional<glm::dvec3> TomlReader::vector3(const std::string& key) {
  const auto values = numbers(key, 3, "[x, y, z]");
  if (!values) return std::nullopt;
  return glm::dvec3((*values)[0], (*values)[1], (*values)[2]);
}

std::optional<glm::vec3> TomlReader::color(const std::string& key) {
  const std::string expected = fmt::format("[r, g, b], linear, each from 0 up, or \"{}\"", kColorTexts);
  if (const toml::node* node = take(key); node != nullptr && node->is_string()) {
    const auto named = color_from_text(node->as_string()->get());
    if (!named) fail(*node, key, "not a color", expected);
    return glm::vec3(*named);
  }
  const auto values = numbers(key, 3, expected);
  if (!values) return std::nullopt;
  if (std::any_of(values->begin(), values->end(), [](double c) { return c < 0.0 || c > 1e6; })) {
    fail(*table_->get(key), key, "out of range", expected);
  }
  return glm::vec3((*values)[0], (*values)[1], (*values)[2]);
}

std::vector<const toml::table*> TomlReader::tables(const std::string& key) {
  const toml::node* node = take(key);
  if (node == nullptr) return {};
  if (const toml::table* table = node->as_table()) return {table};
  std::vector<const toml::table*> found;
  const toml::array* array = node->as_array();
  if (array != nullptr) {
    for (const toml::node& item : *array) {
      if (!item.is_table()) fail(item, key, "not a table", "{ key = value, … }");
      found.push_back(item.as_table());
    }
  }
  if (found.empty()) fail(*node, key, "not a table or an array of tables", "[" + key + "] or [[" + key + "]]");
  return found;
}

ParameterInput parameter_input(const TomlReader& reader, const std::string& key, const toml::node& node) {
  ParameterInput input;
  input.where = reader.where(node);
  if (const auto* word = node.as_string()) {
    input.word = word->get();
  } else if (const auto* flag = node.as_boolean()) {
    input.numbers = {flag->get() ? 1.0 : 0.0};
  } else if (const toml::array* array = node.as_array()) {
    if (!flatten(*array, input.numbers)) reader.fail(node, key, "not finite numbers", "an array of finite numbers");
  } else {
    const auto value = finite_number(node);
    if (!value) reader.fail(node, key, "not a finite number", "a finite number, an array of them or a word in quotes");
    input.numbers = {*value};
  }
  return input;
}

std::map<std::string, ParameterInput> TomlReader::parameters(std::span<const Parameter> parameters) {
  std::map<std::string, ParameterInput> values;
  for (const Parameter& parameter : parameters) {
    const toml::node* node = take(parameter.name);
    if (node != nullptr) values.emplace(parameter.name, parameter_input(*this, parameter.name, *node));
  }
  return values;
}

void TomlReader::finish() const {
  const toml::key* first = nullptr;
  for (const auto& [key, node] : *table_) {
    if (taken(std::string(key.str()))) continue;
    // Tables are sorted by key; the message is about the one that stands first in the file.
    if (first == nullptr || key.source().begin < first->source().begin) first = &key;
  }
  if (first == nullptr) return;
  const toml::source_position at = first->source().begin;
  const std::string name(first->str());
  throw InputError({fmt::format("{}:{}:{}", file_, at.line, at.column), field(name), "", "unknown key", known_names(name, known_)});
}

}  // namespace limn
