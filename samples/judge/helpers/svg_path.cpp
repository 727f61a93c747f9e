#include "samples/judge/helpers/svg_path.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "samples/judge/helpers/svg_curves.h"
#include "samples/judge/helpers/svg_style.h"

namespace limn {
namespace {

bool is_separator(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f' || c == ','; }

/// Path data, read from front to back.
struct PathReader {
  std::string_view text{};

  void skip() {
    while (!text.empty() && is_separator(text.front())) text.remove_prefix(1);
  }
  bool number(double& value) {
    skip();
    std::string_view rest = text;
    if (!rest.empty() && rest.front() == '+') rest.remove_prefix(1);
    const auto result = std::from_chars(rest.data(), rest.data() + rest.size(), value);
    // from_chars reads "inf" and "nan", which SVG does not know.
    if (result.ec != std::errc{} || !std::isfinite(value)) return false;
    text.remove_prefix(static_cast<size_t>(result.ptr - text.data()));
    return true;
  }
  bool point(glm::dvec2& p) { return number(p.x) && number(p.y); }
  /// Flags of arcs may stand without anything between them: "a1 1 0 00 1 1".
  bool flag(bool& value) {
    skip();
    if (text.empty() || (text.front() != '0' && text.front() != '1')) return false;
    value = text.front() == '1';
    text.remove_prefix(1);
    return true;
  }
};

/// Where a path stands.
struct PathState {
  glm::dvec2 at{0.0}, start{0.0};
  glm::dvec2 control{0.0};  ///< The last one of the curve before.
  char before = 'M';        ///< The command before, upper case.
};

class PathMaker {
 public:
  explicit PathMaker(const SvgTransform& transform) : curves_{transform} {}

  std::vector<SvgPolyline> make(std::string_view data) {
    PathReader reader{data};
    char command = 0;
    while (true) {
      reader.skip();
      if (reader.text.empty()) break;
      const char next = reader.text.front();
      if (std::isalpha(static_cast<unsigned char>(next)) != 0) {
        command = next;
        reader.text.remove_prefix(1);
      } else if (command == 0 || command == 'Z' || command == 'z') {
        break;
      }
      if (!step(reader, command)) break;
      // Further coordinates of a move are lines.
      if (command == 'M') command = 'L';
      if (command == 'm') command = 'l';
    }
    finish(false);
    return std::move(lines_);
  }

 private:
  bool step(PathReader& reader, char command) {
    const char kind = static_cast<char>(std::toupper(static_cast<unsigned char>(command)));
    const glm::dvec2 base = command == kind ? glm::dvec2(0.0) : state_.at;
    bool good = false;
    if (kind == 'M' || kind == 'L' || kind == 'H' || kind == 'V' || kind == 'Z')
      good = straight(reader, kind, base);
    else if (kind == 'C' || kind == 'S' || kind == 'Q' || kind == 'T')
      good = curve(reader, kind, base);
    else if (kind == 'A')
      good = arc(reader, base);
    state_.before = kind;
    return good;
  }

  bool straight(PathReader& reader, char kind, const glm::dvec2& base) {
    if (kind == 'Z') {
      finish(true);
      state_.at = state_.start;
      return true;
    }
    glm::dvec2 to = state_.at;
    if (kind == 'H' || kind == 'V') {
      double value = 0.0;
      if (!reader.number(value)) return false;
      (kind == 'H' ? to.x : to.y) = value + (kind == 'H' ? base.x : base.y);
    } else {
      if (!reader.point(to)) return false;
      to += base;
    }
    if (kind == 'M') {
      finish(false);
      state_.start = to;
    } else {
      begin();
      curves_.line(to, points_);
    }
    state_.at = to;
    return true;
  }

  bool curve(PathReader& reader, char kind, const glm::dvec2& base) {
    const bool cubic = kind == 'C' || kind == 'S';
    const bool smooth = kind == 'S' || kind == 'T';
    const bool follows = cubic ? state_.before == 'C' || state_.before == 'S' : state_.before == 'Q' || state_.before == 'T';
    glm::dvec2 first = follows ? 2.0 * state_.at - state_.control : state_.at, second(0.0), to(0.0);
    if (!smooth) {
      if (!reader.point(first)) return false;
      first += base;
    }
    if (cubic) {
      if (!reader.point(second)) return false;
      second += base;
    }
    if (!reader.point(to)) return false;
    to += base;
    begin();
    if (cubic)
      curves_.cubic({state_.at, first, second, to}, points_);
    else
      curves_.cubic({state_.at, state_.at + (first - state_.at) * (2.0 / 3.0), to + (first - to) * (2.0 / 3.0), to}, points_);
    state_.control = cubic ? second : first;
    state_.at = to;
    return true;
  }

  bool arc(PathReader& reader, const glm::dvec2& base) {
    EllipticArc one;
    one.from = state_.at;
    if (!reader.point(one.radii) || !reader.number(one.rotation_deg) || !reader.flag(one.large) || !reader.flag(one.sweep) ||
        !reader.point(one.to))
      return false;
    one.to += base;
    begin();
    curves_.arc(one, points_);
    state_.at = one.to;
    return true;
  }

  void begin() {
    if (points_.empty()) curves_.line(state_.at, points_);
  }
  void finish(bool closed) {
    if (points_.size() > 1) lines_.push_back({points_, closed});
    points_.clear();
    if (closed) state_.at = state_.start;
  }

  CurveFlattener curves_;
  PathState state_{};
  std::vector<glm::dvec2> points_{};
  std::vector<SvgPolyline> lines_{};
};

}  // namespace

std::vector<double> svg_numbers(std::string_view text) {
  PathReader reader{text};
  std::vector<double> numbers;
  for (double value = 0.0; reader.number(value);) numbers.push_back(value);
  return numbers;
}

std::vector<SvgPolyline> svg_path(std::string_view data, const SvgTransform& transform) { return PathMaker(transform).make(data); }

}  // namespace limn
