// What there is to choose from.

#include <pybind11/stl.h>

#include "raymarch/border.h"
#include "raymarch/lines.h"
#include "raymarch/look.h"
#include "raymarch/metric.h"
#include "samples/python/bindings.h"
#include "samples/scenes/scenes.h"
#include "sdf/error.h"
#include "sdf/shape.h"

namespace limn::python {
namespace {

namespace py = pybind11;

/// Name and help of each entry.
using Entries = std::vector<std::pair<std::string, std::string>>;

template <class Registry>
Entries entries_of(const Registry& registry) {
  Entries entries;
  for (const auto& one : registry) entries.emplace_back(one.about.name, one.about.help);
  return entries;
}

Entries entries(const std::string& kind) {
  const std::map<std::string, Entries (*)()> kinds = {
      {"shapes", [] { return entries_of(shapes()); }},       {"surfaces", [] { return entries_of(surface_kinds()); }},
      {"gradients", [] { return entries_of(gradients()); }}, {"methods", [] { return entries_of(border_methods()); }},
      {"metrics", [] { return entries_of(metrics()); }},     {"scenes", [] { return entries_of(scenes()); }},
      {"lines", [] { return entries_of(line_classes()); }},  {"looks", [] { return entries_of(looks()); }},
      {"shadings", [] { return entries_of(shadings()); }}};
  std::vector<std::string> names;
  names.reserve(kinds.size());
  for (const auto& [name, list] : kinds) names.push_back(name);
  const auto found = kinds.find(kind);
  if (found == kinds.end()) throw InputError({"", "kind", kind, "there is no such list", known_names(kind, names)});
  return found->second();
}

}  // namespace

void bind_lists(py::module_& module) { module.def("entries", entries); }

}  // namespace limn::python
