#pragma once
// One table of a TOML file, read key by key. It knows which keys were asked for, so that the rest can be refused.

#include <toml++/toml.h>
#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sdf/descriptor.h"
#include "sdf/error.h"

namespace limn {

class TomlReader {
 public:
  /// `prefix` names the table in messages: "camera.", "object[1].".
  TomlReader(const toml::table& table, std::string file, std::string prefix)
      : table_(&table), file_(std::move(file)), prefix_(std::move(prefix)) {}

  const std::string& file() const { return file_; }
  bool has(const std::string& key) const { return table_->contains(key); }
  /// file:line:column of a node.
  std::string where(const toml::node& node) const;
  std::string field(const std::string& key) const { return prefix_ + key; }

  /// Each marks `key` as known; nothing where the table has no such key. Throws InputError for the wrong type or a value out of range.
  const toml::node* take(const std::string& key);
  std::optional<std::string> text(const std::string& key);
  std::optional<double> number(const std::string& key, double min, double max, const std::string& expected);
  /// Open interval: min < x < max.
  std::optional<double> number_between(const std::string& key, double min, double max, const std::string& expected);
  std::optional<int> integer(const std::string& key, int min, int max);
  /// `count` finite numbers.
  std::optional<std::vector<double>> numbers(const std::string& key, size_t count, const std::string& expected);
  std::optional<glm::dvec3> vector3(const std::string& key);
  std::optional<glm::vec3> color(const std::string& key);
  /// A sub-table, or an array of tables; a plain table counts as an array of one.
  std::vector<const toml::table*> tables(const std::string& key);

  /// The values that the table gives to the parameters of a shape or a method.
  std::map<std::string, ParameterInput> parameters(std::span<const Parameter> parameters);
  /// Throws for the first key in the file that nobody took.
  void finish() const;

  [[noreturn]] void fail(const toml::node& node, const std::string& key, const std::string& problem, const std::string& expected) const;
  /// Of the table as a whole.
  [[noreturn]] void fail(const std::string& problem, const std::string& expected) const;

 private:
  bool taken(const std::string& key) const;
  const toml::table* table_;
  std::string file_, prefix_;
  std::vector<std::string> known_;
};

/// The node as it stands in the file, shortened: for messages.
std::string value_text(const toml::node& node);
/// Numbers (nested arrays flattened), a truth value or a word; throws where it is something else.
ParameterInput parameter_input(const TomlReader& reader, const std::string& key, const toml::node& node);

}  // namespace limn
