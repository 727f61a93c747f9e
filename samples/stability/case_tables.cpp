#include "samples/stability/case_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "raymarch/border.h"
#include "samples/input/toml_reader.h"
#include "samples/stability/case.h"
#include "samples/stability/checks/check.h"
#include "samples/stability/mesh_makers.h"
#include "subdiv/read_obj.h"

namespace limn {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<std::string> words(TomlReader& reader, const std::string& key) {
  const toml::node* node = reader.take(key);
  if (node == nullptr) return {};
  if (const auto* word = node->as_string()) return {word->get()};
  std::vector<std::string> found;
  const toml::array* array = node->as_array();
  if (array == nullptr) reader.fail(*node, key, "neither text nor a list of texts", "\"…\" or [\"…\", …]");
  for (const toml::node& item : *array) {
    const auto* word = item.as_string();
    if (word == nullptr) reader.fail(item, key, "not text", "words in quotes");
    found.push_back(word->get());
  }
  return found;
}

std::string required(TomlReader& reader, const std::string& key) {
  const auto text = reader.text(key);
  if (!text) reader.fail("no " + key, key + " = \"…\"");
  return *text;
}

std::optional<bool> flag(TomlReader& reader, const std::string& key) {
  const toml::node* node = reader.take(key);
  if (node == nullptr) return std::nullopt;
  const auto* value = node->as_boolean();
  if (value == nullptr) reader.fail(*node, key, "not a truth value", "true or false");
  return value->get();
}

std::vector<std::string> surfaces(TomlReader& reader) {
  std::vector<std::string> names = words(reader, "surfaces");
  for (const std::string& name : names) find_surface(name, reader.where(*reader.take("surfaces")), reader.field("surfaces"));
  return names;
}

/// A method's name, or that and parameters behind it ("extrude direction=position").
void check_methods(TomlReader& reader, const std::vector<std::string>& names, const std::string& key = "methods") {
  for (const std::string& name : names) {
    if (name != "all") find_border_method(name.substr(0, name.find(' ')), reader.where(*reader.take(key)), reader.field(key));
  }
}

std::map<std::string, double> numbers(const toml::table& table, const TomlReader& reader) {
  std::map<std::string, double> values;
  for (const auto& [key, node] : table) {
    const ParameterInput value = parameter_input(reader, std::string(key.str()), node);
    if (value.numbers.size() != 1) reader.fail(node, std::string(key.str()), "not a number", "a finite number");
    values[std::string(key.str())] = value.numbers[0];
  }
  return values;
}

std::vector<glm::ivec2> sizes(TomlReader& reader) {
  const toml::node* node = reader.take("sizes");
  if (node == nullptr) return {{160, 120}};
  const std::string expected = "[[width, height], …] in whole pixels, 1 to 16384 each";
  const ParameterInput sides = parameter_input(reader, "sizes", *node);
  if (sides.numbers.empty() || sides.numbers.size() % 2 != 0) reader.fail(*node, "sizes", "no pairs", expected);
  std::vector<glm::ivec2> found;
  for (size_t i = 0; i < sides.numbers.size(); i += 2) {
    const glm::dvec2 size(sides.numbers[i], sides.numbers[i + 1]);
    if (size != glm::floor(size) || glm::any(glm::lessThan(size, glm::dvec2(1.0))) || glm::any(glm::greaterThan(size, glm::dvec2(16384.0))))
      reader.fail(*node, "sizes", "out of range", expected);
    found.emplace_back(size);
  }
  return found;
}

void read_case_table(TomlReader& reader, StabilityCase& one) {
  one.text.row = required(reader, "row");
  one.text.breaks = required(reader, "breaks");
  one.text.holds = required(reader, "holds");
  one.text.check = required(reader, "check");
  const StabilityCheck& check = find_stability_check(one.text.check, reader.where(*reader.take("check")), reader.field("check"));
  one.text.looks = check.about.help;
  one.surfaces = surfaces(reader);
  if (one.surfaces.empty()) {
    for (const SurfaceDescriptor& kind : surface_kinds()) one.surfaces.push_back(kind.about.name);
  }
  one.methods = words(reader, "methods");
  check_methods(reader, one.methods);
  one.without = words(reader, "without");
  check_methods(reader, one.without, "without");
  if (!one.without.empty() && std::find(one.methods.begin(), one.methods.end(), "all") == one.methods.end())
    reader.fail("without methods = \"all\"", "methods that \"all\" leaves out");
  one.views = reader.integer("views", 1, 100).value_or(1);
  one.sizes_px = sizes(reader);
  one.draws = reader.integer("draws", 1, 1000).value_or(1);
  one.bound = reader.number("bound", -kInfinity, kInfinity, "a number").value_or(0.0);
  one.outer = reader.number("outer", one.bound, kInfinity, "a number not below the bound").value_or(one.bound);
  one.says = words(reader, "says");
  reader.finish();
}

StabilityVariant read_variant(TomlReader& reader, const toml::table& table) {
  StabilityVariant variant;
  variant.scale = reader.number_between("scale", 0.0, kInfinity, "a number above 0").value_or(1.0);
  variant.translate = reader.vector3("translate").value_or(glm::dvec3(0.0));
  variant.turned = flag(reader, "turned").value_or(false);
  variant.reversed = flag(reader, "reversed").value_or(false);
  variant.threads = reader.integer("threads", 0, 64).value_or(0);
  variant.tile_px = reader.integer("tile", 1, 16).value_or(16);
  if (const auto simd = reader.text("simd")) {
    if (*simd != "least") reader.fail("no such simd", "simd = \"least\"");
    variant.least_simd = true;
  }
  if (const toml::node* node = reader.take("set"); node != nullptr && node->is_table()) variant.set = numbers(*node->as_table(), reader);
  reader.finish();
  for (const auto& [key, node] : table) {
    variant.words += (variant.words.empty() ? "" : ", ") + std::string(key.str()) + " " + value_text(node);
  }
  return variant;
}

StabilityExpectation read_expectation(TomlReader& reader) {
  StabilityExpectation expect;
  expect.surfaces = surfaces(reader);
  expect.methods = words(reader, "methods");
  check_methods(reader, expect.methods);
  expect.bound = reader.number("bound", -kInfinity, kInfinity, "a number");
  expect.outer = reader.number("outer", -kInfinity, kInfinity, "a number");
  if (const auto range = reader.numbers("fails", 2, "[lowest, highest]")) expect.fails.emplace((*range)[0], (*range)[1]);
  expect.says = words(reader, "says");
  expect.refused = reader.text("refused").value_or("");
  reader.finish();
  if (expect.fails && expect.says.empty()) reader.fail("fails without says", "what the program says of it");
  return expect;
}

Mesh read_own_mesh(TomlReader& reader, const std::string& name, const std::string& file) {
  if (const auto text = reader.text("text")) {
    Mesh mesh = parse_obj(*text, file + ":" + name, 1'000'000);
    validate(mesh, file + ":" + name);
    return mesh;
  }
  const std::string maker = required(reader, "maker");
  const MeshMaker& found = find_mesh_maker(maker, reader.where(*reader.take("maker")), reader.field("maker"));
  return found.make(resolve(found.parameters, reader.parameters(found.parameters), file, reader.field("")));
}

}  // namespace

CaseSources read_sources(const std::string& text, const std::string& file) {
  const toml::table root = parse_toml(text, file);
  TomlReader reader(root, file, "");
  CaseSources sources;
  for (const toml::table* table : reader.tables("mesh")) {
    TomlReader own(*table, file, "mesh.");
    const std::string name = required(own, "file");
    sources.meshes[name] = read_own_mesh(own, name, file);
    own.finish();
  }
  for (const toml::table* table : reader.tables("volume")) {
    TomlReader own(*table, file, "volume.");
    sources.volume.emplace();
    sources.volume->voxels = own.integer("voxels", 4, 512).value_or(48);
    sources.volume->half_width_voxels = own.number("half_width", 1.8, 100.0, "1.8 to 100 voxels").value_or(3.0);
    own.finish();
  }
  return sources;
}

StabilityCase parse_case(const std::string& text, const std::string& file) {
  const toml::table root = parse_toml(text, file);
  TomlReader reader(root, file, "");
  StabilityCase one;
  one.text.name = std::filesystem::path(file).stem().string();
  one.source = text;
  one.file = file;
  one.has_borders = root.contains("border");
  const auto own = reader.tables("case");
  if (own.size() != 1) throw InputError({file, "case", "", "no case", "one [case] table"});
  TomlReader head(*own[0], file, "case.");
  read_case_table(head, one);
  for (const toml::table* table : reader.tables("with")) {
    TomlReader with(*table, file, "with.");
    one.with = with.parameters(find_stability_check(one.text.check).parameters);
    with.finish();
  }
  for (const toml::table* table : reader.tables("set")) one.set = numbers(*table, TomlReader(*table, file, "set."));
  for (const toml::table* table : reader.tables("random")) {
    TomlReader random(*table, file, "random.");
    for (const auto& [key, node] : *table) {
      const std::string name(key.str());
      const auto range = random.numbers(name, 2, "[low, high]");
      const toml::array& ends = *node.as_array();
      one.random[name] = {(*range)[0], (*range)[1], ends[0].is_integer() && ends[1].is_integer()};
    }
  }
  for (const toml::table* table : reader.tables("variant")) {
    TomlReader variant(*table, file, "variant.");
    one.variants.push_back(read_variant(variant, *table));
  }
  for (const toml::table* table : reader.tables("expect")) {
    TomlReader expect(*table, file, "expect.");
    one.expectations.push_back(read_expectation(expect));
  }
  // Values once, so that a slip in the scene is told before anything runs.
  const bool refused =
      std::any_of(one.expectations.begin(), one.expectations.end(), [](const auto& expect) { return !expect.refused.empty(); });
  if (!refused) scene_of_case(one, drawn_parameters(one, 0, 0));
  return one;
}

}  // namespace limn
