#pragma once
// Internal to limn-read-svg: how an element is painted, from attributes, style sheets and what it inherits.

#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace limn {

/// What matters of an element's style.
struct SvgStyle {
  std::string stroke = "none", fill = "black";
  double stroke_width = 1.0;   ///< User units.
  std::vector<double> dash{};  ///< User units; empty: solid.
  double dash_offset = 0.0;
  double opacity = 1.0;  ///< Of the groups and the element, multiplied.
  double stroke_opacity = 1.0, fill_opacity = 1.0;
  bool visible = true;
  bool displayed = true;
};

/// One compound selector: "path.visible#a".
struct CssCompound {
  std::string tag{}, id{};
  std::vector<std::string> classes{};
  bool child = false;  ///< The compound before it must match the parent, not any ancestor.
};

using CssDeclarations = std::vector<std::pair<std::string, std::string>>;

struct CssRule {
  std::vector<CssCompound> selector{};
  CssDeclarations declarations{};
  int specificity = 0;
};

/// Adds the rules of a style sheet. Selectors beyond tags, classes, ids and their descendants match nothing; blocks of @ are left out.
void add_css(std::string_view sheet, std::vector<CssRule>& rules);
/// Stable by specificity: later rules win among equals.
void sort_css(std::vector<CssRule>& rules);

/// The element's style: attributes over what it inherits, rules over these, its style attribute on top.
SvgStyle style_of(const pugi::xml_node& element, const SvgStyle& inherited, const std::vector<CssRule>& rules);

/// A length in user units: "2", "2px", "1.5mm". `whole` is what percentages are of. NaN where it is none.
double svg_length(std::string_view text, double whole);

/// Without its namespace's prefix: "path" of "svg:path".
std::string_view local_name(const char* name);

}  // namespace limn
