// Styles out of .css files: the same selectors and properties that an SVG of limn's carries.

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "samples/lines/drawing.h"
#include "samples/spec/parse.h"
#include "samples/spec/parse_color.h"
#include "sdf/color.h"
#include "sdf/error.h"

namespace limn {
namespace {

constexpr std::uintmax_t kMostBytes = 1 << 20;

std::string trimmed(const std::string& text) {
  const auto is_space = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
  const auto first = std::find_if_not(text.begin(), text.end(), is_space);
  const auto last = std::find_if_not(text.rbegin(), std::make_reverse_iterator(first), is_space).base();
  return {first, last};
}

std::vector<std::string> parts_of(const std::string& text, const std::string& separators) {
  std::vector<std::string> parts;
  size_t from = 0;
  for (;;) {
    const size_t at = text.find_first_of(separators, from);
    parts.push_back(trimmed(text.substr(from, at - from)));
    if (at == std::string::npos) return parts;
    from = at + 1;
  }
}

/// Which lines a rule is about.
struct Selector {
  std::optional<LineClass> line_class{};
  std::optional<bool> visible{};
};

class StyleSheet {
 public:
  StyleSheet(std::string file, std::string text) : file_(std::move(file)), text_(std::move(text)) {}

  DrawingStyle read() {
    DrawingStyle style = built_in_style("plain");
    style.name = file_;
    drop_comments();
    for (size_t at = 0;;) {
      const size_t open = text_.find('{', at);
      if (trimmed(text_.substr(at, open - at)).empty() && open == std::string::npos) return style;
      const size_t close = open == std::string::npos ? open : text_.find('}', open);
      if (close == std::string::npos) fail(at, trimmed(text_.substr(at, 40)), "a rule that does not end", "SELECTOR { property: value; }");
      add_rule(at, text_.substr(at, open - at), open + 1, text_.substr(open + 1, close - open - 1), style);
      at = close + 1;
    }
  }

 private:
  [[noreturn]] void fail(size_t at, const std::string& value, const std::string& problem, const std::string& expected) const {
    const auto line = 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(std::min(at, text_.size())), '\n');
    throw InputError({fmt::format("{}:{}", file_, line), "", value, problem, expected});
  }

  void drop_comments() {
    for (size_t at = text_.find("/*"); at != std::string::npos; at = text_.find("/*", at)) {
      const size_t end = text_.find("*/", at + 2);
      if (end == std::string::npos) fail(at, "/*", "a comment that does not end", "*/");
      for (size_t i = at; i < end + 2; ++i) {
        if (text_[i] != '\n') text_[i] = ' ';
      }
    }
  }

  void add_rule(size_t at, const std::string& selectors, size_t body_at, const std::string& body, DrawingStyle& style) const {
    for (const std::string& text : parts_of(selectors, ",")) {
      const Selector selector = selector_of(at, text);
      for (const LineClassDescriptor& one : line_classes()) {
        if (selector.line_class && *selector.line_class != one.line_class) continue;
        if (selector.visible.value_or(true)) set_properties(body_at, body, style.visible[one.line_class]);
        if (!selector.visible.value_or(false)) set_properties(body_at, body, style.hidden[one.line_class]);
      }
    }
  }

  Selector selector_of(size_t at, const std::string& text) const {
    Selector selector;
    std::string rest = text;
    // ".contour.visible path" is how the SVG has it; "path" alone is every line.
    if (rest.size() >= 4 && rest.substr(rest.size() - 4) == "path") rest = trimmed(rest.substr(0, rest.size() - 4));
    if (rest.empty() && !text.empty()) return selector;
    if (rest.empty() || rest[0] != '.') fail(at, text, "not a selector", "a class such as .contour, .hidden or .crease.visible, or path");
    for (const std::string& name : parts_of(rest.substr(1), ".")) {
      if (name == "visible" || name == "hidden") {
        selector.visible = name == "visible";
        continue;
      }
      const LineClassDescriptor* const found = line_classes().look_up(name);
      if (found == nullptr) {
        std::vector<std::string> known = line_classes().names();
        known.insert(known.end(), {"visible", "hidden"});
        fail(at, name, "there is no such class of lines", known_names(name, known));
      }
      selector.line_class = found->line_class;
    }
    return selector;
  }

  void set_properties(size_t at, const std::string& body, StrokeStyle& style) const {
    for (const std::string& text : parts_of(body, ";")) {
      if (text.empty()) continue;
      const size_t colon = text.find(':');
      if (colon == std::string::npos) fail(at, text, "not a property", "property: value");
      set_property(at, trimmed(text.substr(0, colon)), trimmed(text.substr(colon + 1)), style);
    }
  }

  double length_of(size_t at, const std::string& name, std::string text) const {
    if (text.size() > 2 && text.substr(text.size() - 2) == "px") text.resize(text.size() - 2);
    try {
      return parse_number_above(name, text, 0.0, true, "a number of pixels");
    } catch (const InputError&) {
      fail(at, name + ": " + text, "not a length", "a number of pixels of at least 0");
    }
  }

  void set_property(size_t at, const std::string& name, const std::string& value, StrokeStyle& style) const {
    if (name == "stroke") {
      try {
        const glm::dvec3 linear = parse_color("stroke", value);
        style.color = "#";
        for (int i = 0; i < 3; ++i)
          style.color += fmt::format("{:02x}", std::lround(255.0f * srgb_from_linear(static_cast<float>(linear[i]))));
      } catch (const InputError&) {
        fail(at, value, "not a colour", "#rrggbb, #rgb or a name such as black");
      }
    } else if (name == "stroke-width") {
      style.width_px = length_of(at, name, value);
    } else if (name == "stroke-dasharray") {
      style.dash_px.clear();
      if (value == "none") return;
      for (const std::string& part : parts_of(value, ", ")) {
        if (!part.empty()) style.dash_px.push_back(length_of(at, name, part));
      }
      // An odd list is repeated, as in SVG.
      if (style.dash_px.size() % 2 == 1) style.dash_px.insert(style.dash_px.end(), style.dash_px.begin(), style.dash_px.end());
    } else if (name == "taper") {
      if (value != "none" && value != "ends") fail(at, value, "not a taper", "none or ends");
      style.taper = value == "ends";
    } else {
      fail(at, name, "unknown property", known_names(name, {"stroke", "stroke-width", "stroke-dasharray", "taper"}));
    }
  }

  std::string file_, text_;
};

}  // namespace

DrawingStyle read_style(const std::string& name_or_file) {
  const std::filesystem::path file(name_or_file);
  if (file.extension() != ".css") return built_in_style(name_or_file);
  std::error_code fault;
  const std::uintmax_t bytes = std::filesystem::file_size(file, fault);
  std::ifstream stream(file, std::ios::binary);
  if (fault || !stream) throw InputError({name_or_file, "", "", "cannot be read", "a style sheet"});
  if (bytes > kMostBytes) throw InputError({name_or_file, "", fmt::format("{} bytes", bytes), "too large", "a style sheet of up to 1 MiB"});
  return StyleSheet(name_or_file, {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()}).read();
}

}  // namespace limn
