#include "samples/judge/helpers/svg_style.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>

namespace limn {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

std::string without_comments(std::string_view text) {
  std::string result;
  for (size_t i = 0; i < text.size();) {
    if (text.substr(i, 2) == "/*") {
      const size_t end = text.find("*/", i + 2);
      if (end == std::string_view::npos) break;
      i = end + 2;
    } else {
      result += text[i++];
    }
  }
  return result;
}

CssDeclarations declarations_of(std::string_view block) {
  CssDeclarations result;
  while (!block.empty()) {
    const size_t end = std::min(block.find(';'), block.size());
    const std::string_view one = block.substr(0, end);
    block.remove_prefix(std::min(end + 1, block.size()));
    const size_t colon = one.find(':');
    if (colon == std::string_view::npos) continue;
    std::string_view value = trimmed(one.substr(colon + 1));
    if (const size_t important = value.find("!important"); important != std::string_view::npos) value = trimmed(value.substr(0, important));
    result.emplace_back(trimmed(one.substr(0, colon)), value);
  }
  return result;
}

bool is_name(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || static_cast<unsigned char>(c) >= 0x80;
}

/// False for what is not understood.
bool read_compound(std::string_view& text, CssCompound& compound) {
  bool any = false;
  while (!text.empty() && !is_space(text.front()) && text.front() != '>') {
    char kind = ' ';
    if (text.front() == '.' || text.front() == '#') {
      kind = text.front();
      text.remove_prefix(1);
    } else if (text.front() == '*') {
      text.remove_prefix(1);
      any = true;
      continue;
    }
    size_t length = 0;
    while (length < text.size() && is_name(text[length])) ++length;
    if (length == 0) return false;
    const std::string name(text.substr(0, length));
    text.remove_prefix(length);
    if (kind == '.')
      compound.classes.push_back(name);
    else
      (kind == '#' ? compound.id : compound.tag) = name;
    any = true;
  }
  return any;
}

bool read_selector(std::string_view text, CssRule& rule) {
  constexpr size_t kMostCompounds = 16;
  text = trimmed(text);
  bool child = false;
  while (!text.empty()) {
    CssCompound compound;
    compound.child = child;
    if (rule.selector.size() == kMostCompounds || !read_compound(text, compound)) return false;
    rule.specificity += (compound.id.empty() ? 0 : 10'000) + 100 * static_cast<int>(std::min<size_t>(compound.classes.size(), 50)) +
                        (compound.tag.empty() ? 0 : 1);
    rule.selector.push_back(std::move(compound));
    text = trimmed(text);
    child = !text.empty() && text.front() == '>';
    if (child) text = trimmed(text.substr(1));
    if (child && text.empty()) return false;
  }
  return !rule.selector.empty();
}

/// Where the block that starts at `open` ends: the place of its brace, or the end.
size_t end_of_block(std::string_view text, size_t open) {
  int depth = 0;
  for (size_t i = open; i < text.size(); ++i) {
    if (text[i] == '{') ++depth;
    if (text[i] == '}' && --depth == 0) return i;
  }
  return text.size();
}

bool has_class(std::string_view classes, std::string_view name) {
  for (size_t at = 0; at < classes.size();) {
    while (at < classes.size() && is_space(classes[at])) ++at;
    size_t end = at;
    while (end < classes.size() && !is_space(classes[end])) ++end;
    if (classes.substr(at, end - at) == name) return true;
    at = end;
  }
  return false;
}

bool matches_one(const CssCompound& compound, const pugi::xml_node& node) {
  if (!compound.tag.empty() && compound.tag != local_name(node.name())) return false;
  if (!compound.id.empty() && compound.id != node.attribute("id").value()) return false;
  const std::string_view classes = node.attribute("class").value();
  return std::all_of(compound.classes.begin(), compound.classes.end(), [&](const std::string& name) { return has_class(classes, name); });
}

bool matches(const std::vector<CssCompound>& selector, size_t last, const pugi::xml_node& node) {
  if (!matches_one(selector[last], node)) return false;
  if (last == 0) return true;
  for (pugi::xml_node above = node.parent(); above.type() == pugi::node_element; above = above.parent()) {
    if (matches(selector, last - 1, above)) return true;
    if (selector[last].child) return false;
  }
  return false;
}

std::vector<double> dashes_of(std::string_view text) {
  constexpr size_t kMostDashes = 64;
  std::vector<double> dash;
  double sum = 0.0;
  while (dash.size() < kMostDashes) {
    while (!text.empty() && (is_space(text.front()) || text.front() == ',')) text.remove_prefix(1);
    if (text.empty()) break;
    size_t length = 0;
    while (length < text.size() && !is_space(text[length]) && text[length] != ',') ++length;
    const double one = svg_length(text.substr(0, length), 1.0);
    if (!(one >= 0.0)) return {};
    dash.push_back(one);
    sum += one;
    text.remove_prefix(length);
  }
  if (!(sum > 0.0)) return {};
  if (dash.size() % 2 == 1) dash.insert(dash.end(), dash.begin(), dash.end());
  return dash;
}

double share_of(std::string_view text) {
  const double value = svg_length(text, 1.0);
  return std::isfinite(value) ? std::clamp(value, 0.0, 1.0) : 1.0;
}

void set_property(std::string_view name, std::string_view value, double above_opacity, SvgStyle& style) {
  value = trimmed(value);
  if (value == "inherit" || value.empty()) return;
  if (name == "stroke") style.stroke = value.substr(0, 64);
  if (name == "fill") style.fill = value.substr(0, 64);
  if (name == "stroke-width") {
    const double width = svg_length(value, 100.0);
    if (width >= 0.0) style.stroke_width = width;
  }
  if (name == "stroke-dasharray") style.dash = dashes_of(value);
  if (name == "stroke-dashoffset") {
    const double offset = svg_length(value, 100.0);
    style.dash_offset = std::isfinite(offset) ? offset : 0.0;
  }
  if (name == "opacity") style.opacity = above_opacity * share_of(value);
  if (name == "stroke-opacity") style.stroke_opacity = share_of(value);
  if (name == "fill-opacity") style.fill_opacity = share_of(value);
  if (name == "visibility") style.visible = value == "visible";
  if (name == "display") style.displayed = value != "none";
}

}  // namespace

std::string_view local_name(const char* name) {
  const char* const colon = std::strchr(name, ':');
  return colon != nullptr ? colon + 1 : name;
}

double svg_length(std::string_view text, double whole) {
  const std::string copy(text.substr(0, 64));
  char* end = nullptr;
  const double value = std::strtod(copy.c_str(), &end);
  const double none = std::numeric_limits<double>::quiet_NaN();
  if (end == copy.c_str() || !std::isfinite(value)) return none;
  const std::string_view unit = trimmed(end);
  constexpr std::pair<std::string_view, double> kUnits[] = {{"", 1.0},    {"px", 1.0},         {"mm", 96.0 / 25.4}, {"cm", 96.0 / 2.54},
                                                            {"in", 96.0}, {"pt", 96.0 / 72.0}, {"pc", 16.0},        {"Q", 96.0 / 101.6},
                                                            {"em", 16.0}, {"ex", 8.0}};
  if (unit == "%") return value * whole / 100.0;
  for (const auto& [name, factor] : kUnits)
    if (unit == name) return value * factor;
  return none;
}

void add_css(std::string_view sheet, std::vector<CssRule>& rules) {
  constexpr size_t kMostRules = 20'000;
  const std::string clean = without_comments(sheet);
  std::string_view text = clean;
  while (rules.size() < kMostRules) {
    text = trimmed(text);
    const size_t open = text.find('{');
    if (open == std::string_view::npos) return;
    // "@import ...;" has no block.
    const size_t semicolon = text.find(';');
    if (text.front() == '@' && semicolon < open) {
      text.remove_prefix(semicolon + 1);
      continue;
    }
    const size_t close = end_of_block(text, open);
    std::string_view selectors = text.substr(0, open);
    const CssDeclarations declarations = declarations_of(text.substr(open + 1, close - open - 1));
    const bool at_rule = text.front() == '@';
    text.remove_prefix(std::min(close + 1, text.size()));
    while (!at_rule && !selectors.empty()) {
      const size_t comma = std::min(selectors.find(','), selectors.size());
      CssRule rule;
      if (read_selector(selectors.substr(0, comma), rule)) {
        rule.declarations = declarations;
        rules.push_back(std::move(rule));
      }
      selectors.remove_prefix(std::min(comma + 1, selectors.size()));
    }
  }
}

void sort_css(std::vector<CssRule>& rules) {
  std::stable_sort(rules.begin(), rules.end(), [](const CssRule& a, const CssRule& b) { return a.specificity < b.specificity; });
}

SvgStyle style_of(const pugi::xml_node& element, const SvgStyle& inherited, const std::vector<CssRule>& rules) {
  SvgStyle style = inherited;
  style.displayed = true;
  for (const pugi::xml_attribute& attribute : element.attributes())
    set_property(attribute.name(), attribute.value(), inherited.opacity, style);
  for (const CssRule& rule : rules) {
    if (!matches(rule.selector, rule.selector.size() - 1, element)) continue;
    for (const auto& [name, value] : rule.declarations) set_property(name, value, inherited.opacity, style);
  }
  for (const auto& [name, value] : declarations_of(element.attribute("style").value())) set_property(name, value, inherited.opacity, style);
  return style;
}

}  // namespace limn
