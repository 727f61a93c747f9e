#include "subdiv/read_obj.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>

#include "sdf/color.h"
#include "sdf/error.h"
#include "subdiv/obj_tags.h"
#include "subdiv/repair_faces.h"
#include "subdiv/text_cursor.h"

namespace limn {
namespace {

/// Index of a corner that has none, or one before the first.
constexpr std::int32_t kNone = INT32_MIN;

/// Statements of the format that make no surface and say nothing of one.
constexpr std::string_view kSkipped[] = {
    "vt",    "vp",         "l",         "p",    "mtllib", "maplib", "usemap", "mg",  "lod",  "bevel", "end",      "deg",   "bmat",
    "step",  "cstype",     "parm",      "trim", "hole",   "scrv",   "sp",     "con", "call", "csh",   "c_interp", "ctech", "d_interp",
    "stech", "shadow_obj", "trace_obj", "bzp",  "bsp",    "cdc",    "cdp",    "res", "wn",   "ka",    "kd"};

/// Lines, joined where a backslash at the end says so.
class Statements {
 public:
  explicit Statements(std::string_view text) : text_(text) {
    // Files of old machines end their lines with a carriage return alone.
    if (text.find('\n') == std::string_view::npos) line_end_ = '\r';
  }
  bool next(std::string_view& statement) {
    if (at_ >= text_.size()) return false;
    statement = next_line();
    first_line_ = line_;
    if (!statement.empty() && statement.back() == '\\' && !is_comment(statement)) {
      joined_.clear();
      while (!statement.empty() && statement.back() == '\\') {
        joined_.append(statement.substr(0, statement.size() - 1)).push_back(' ');
        statement = at_ < text_.size() ? next_line() : std::string_view();
      }
      statement = joined_.append(statement);
    }
    return true;
  }
  std::int64_t line() const { return first_line_; }
  /// True where the last statement has no line end: the file may break off within it.
  bool is_unfinished() const { return at_ > text_.size(); }

 private:
  static bool is_comment(std::string_view line) {
    const size_t first = line.find_first_not_of(" \t");
    return first != std::string_view::npos && line[first] == '#';
  }
  /// Ends at a line feed, a carriage return or both: files that several programs wrote to have all of them.
  std::string_view next_line() {
    const void* found = std::memchr(text_.data() + at_, line_end_, text_.size() - at_);
    const size_t end = found == nullptr ? text_.size() : static_cast<size_t>(static_cast<const char*>(found) - text_.data());
    std::string_view line = text_.substr(at_, end - at_);
    at_ = end + 1;
    ++line_;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    const void* inner = line.empty() ? nullptr : std::memchr(line.data(), '\r', line.size());
    if (inner != nullptr) {
      line = line.substr(0, static_cast<size_t>(static_cast<const char*>(inner) - line.data()));
      at_ = static_cast<size_t>(line.data() - text_.data()) + line.size() + 1;
    }
    return line;
  }
  std::string_view text_;
  std::string joined_{};
  size_t at_ = 0;
  std::int64_t line_ = 0, first_line_ = 0;
  char line_end_ = '\n';
};

/// A number for each face that changes seldom: kept where it changes.
struct FaceRuns {
  std::vector<std::pair<size_t, std::int32_t>> changes{};
  void set(size_t face, std::int32_t value) { changes.emplace_back(face, value); }
  std::vector<std::int32_t> of_faces(size_t faces, std::int32_t before) const {
    std::vector<std::int32_t> values(faces, before);
    for (size_t i = 0; i < changes.size(); ++i) {
      const size_t end = i + 1 < changes.size() ? changes[i + 1].first : faces;
      std::fill(values.begin() + static_cast<std::ptrdiff_t>(changes[i].first), values.begin() + static_cast<std::ptrdiff_t>(end),
                changes[i].second);
    }
    return values;
  }
};

/// Names in the order of their first mention, and which face has which.
struct FaceNames {
  std::map<std::string, std::int32_t, std::less<>> numbers{};
  std::vector<std::string> names{};
  FaceRuns runs{};
  void set(size_t face, std::string_view name) {
    auto at = numbers.find(name);
    if (at == numbers.end()) {
      at = numbers.emplace(name, static_cast<std::int32_t>(names.size())).first;
      names.emplace_back(name);
    }
    runs.set(face, at->second);
  }
  /// Faces before the first name belong to a nameless one.
  void finish(size_t faces, std::vector<std::string>& all_names, std::vector<std::int32_t>& of_faces) {
    if (names.empty()) return;
    if (runs.changes.front().first > 0) names.emplace_back();
    of_faces = runs.of_faces(faces, static_cast<std::int32_t>(names.size()) - 1);
    all_names = std::move(names);
  }
};

class ObjReader {
 public:
  ObjReader(std::string_view text, const std::string& file, std::int64_t max_elements)
      : text_(text), file_(file), statements_(text), most_(std::min<std::int64_t>(max_elements, INT32_MAX)) {}

  Mesh run() {
    if (text_.find('\0') != std::string_view::npos)
      throw InputError({file_, "", "", "is not a Wavefront OBJ: it holds binary data", "a text file with lines 'v x y z' and 'f a b c'"});
    for (std::string_view line; statements_.next(line);) statement(line);
    return finish();
  }

 private:
  std::string place() const { return fmt::format("{}:{}", file_, statements_.line()); }
  [[noreturn]] void refuse(std::string_view field, std::string_view value, std::string problem, std::string expected) const {
    throw InputError({place(), std::string(field), shown_word(value), std::move(problem), std::move(expected)});
  }

  void statement(std::string_view line) {
    TextCursor cursor(line);
    const std::string_view keyword = cursor.word();
    if (keyword.empty()) return;
    if (keyword == "v") return vertex(cursor);
    if (keyword == "f" || keyword == "fo") return face(cursor);
    if (keyword == "vn") return normal(cursor);
    if (keyword == "vt") {
      ++texture_coordinates_;
    } else if (keyword == "g" || keyword == "o") {
      groups_.set(mesh_.face_count(), cursor.rest_of_line());
    } else if (keyword == "usemtl") {
      materials_.set(mesh_.face_count(), cursor.rest_of_line());
    } else if (keyword == "s") {
      smoothing(cursor);
    } else if (keyword == "t") {
      read_obj_tag(cursor.rest_of_line(), place(), mesh_, tags_);
    } else if (keyword == "l" || keyword == "p") {
      ++lines_and_points_;
    } else if (keyword == "curv" || keyword == "curv2" || keyword == "surf") {
      ++free_form_;
    } else if (std::find(std::begin(kSkipped), std::end(kSkipped), keyword) == std::end(kSkipped) && unknown_++ == 0) {
      first_unknown_ = fmt::format("first: '{}' in line {}", shown_word(keyword), statements_.line());
    }
  }

  double number(TextCursor& cursor, std::string_view field) const {
    double value = 0.0;
    if (!cursor.number(value) && !read_real(cursor, value))
      refuse(field, cursor.word(), "is not a number", "decimal numbers within the range of double precision");
    return value;
  }

  void vertex(TextCursor& cursor) {
    double values[8];
    size_t count = 0;
    while (count < 8 && cursor.skip_in_line()) values[count++] = number(cursor, "v");
    if (count < 2) refuse("v", fmt::format("{} numbers", count), "a vertex without three coordinates", "v x y z");
    if (count == 2) {
      if (flat_vertices_++ == 0) first_flat_line_ = statements_.line();
      values[2] = 0.0;
    }
    mesh_.positions.emplace_back(values[0], values[1], values[2]);
    if (!std::isfinite(values[0]) || !std::isfinite(values[1]) || !std::isfinite(values[2]))
      refuse("v", fmt::format("{}, {}, {}", values[0], values[1], values[2]), "the position is not a finite number", "finite coordinates");
    // A seventh number is alpha.
    if (count >= 6) mesh_.vertex_colors.emplace_back(values[3], values[4], values[5]);
    count_elements(1);
  }

  /// Up to 1 (brighter than white up to 16), or up to 255; both as a screen shows them.
  void take_colors() {
    float largest = 0.0f;
    for (const glm::vec3& color : mesh_.vertex_colors) largest = std::max({largest, color.r, color.g, color.b});
    const float white = largest > 16.0f ? 255.0f : 1.0f;
    for (glm::vec3& color : mesh_.vertex_colors)
      for (int k = 0; k < 3; ++k) color[k] = linear_from_srgb(std::clamp(color[k] / white, 0.0f, 1.0f));
  }

  void count_elements(std::int64_t more) {
    elements_ += more;
    if (elements_ > most_)
      refuse("", fmt::format("{}", elements_), "more vertices and corners than allowed", fmt::format("at most {}", most_));
  }

  /// A normal that is no number costs the surface nothing: it is counted, and found again from the faces.
  void normal(TextCursor& cursor) {
    glm::vec3 n(0.0f);
    bool good = true;
    for (int i = 0; i < 3 && good; ++i) {
      double value = 0.0;
      good = cursor.skip_in_line() && read_real(cursor, value) && std::isfinite(value);
      n[i] = static_cast<float>(value);
    }
    bad_normals_ += !good;
    normals_.push_back(good ? n : glm::vec3(0.0f));
  }

  /// Numbers count from 1, negative ones back from the last.
  std::int32_t index(TextCursor& cursor, size_t count, const char* what) {
    std::int64_t value = 0;
    if (!cursor.number(value, '/'))
      refuse("f", cursor.word(), fmt::format("is not a {} number", what), "whole numbers counted from 1, or from -1 back");
    if (value < 0) {
      counts_back_ = true;
      const std::int64_t back = static_cast<std::int64_t>(count) + value;
      return back < 0 ? kNone : static_cast<std::int32_t>(back);
    }
    return static_cast<std::int32_t>(std::min<std::int64_t>(value - 1, INT32_MAX));
  }

  /// v, v/t, v//n or v/t/n; a slash may have nothing behind it.
  void corner(TextCursor& cursor) {
    mesh_.corner_vertices.push_back(index(cursor, mesh_.positions.size(), "vertex"));
    std::int32_t normal_index = kNone;
    const auto has_number = [&cursor] { return cursor.left() > 0 && !cursor.ends_word(*cursor.at()) && !cursor.is_at('/'); };
    if (cursor.is_at('/')) {
      cursor.step();
      if (has_number()) {
        index(cursor, static_cast<size_t>(texture_coordinates_), "texture coordinate");
        ++texture_corners_;
      }
      if (cursor.is_at('/')) {
        cursor.step();
        if (has_number()) normal_index = index(cursor, normals_.size(), "normal"), ++normal_corners_;
      }
    }
    // Nothing is kept of meshes without normals.
    if (normal_index == kNone && corner_normals_.empty()) return;
    if (corner_normals_.empty()) corner_normals_.assign(mesh_.corner_vertices.size() - 1, kNone);
    corner_normals_.push_back(normal_index);
  }

  void face(TextCursor& cursor) {
    std::int32_t corners = 0;
    for (; cursor.skip_in_line(); ++corners) corner(cursor);
    if (corners < 3 && statements_.is_unfinished())
      refuse("f", fmt::format("{} corners", corners), "the file breaks off within a face with fewer than 3 corners", "f a b c ...");
    mesh_.face_sizes.push_back(corners);
    count_elements(corners);
  }

  void smoothing(TextCursor& cursor) {
    const std::string_view word = cursor.word();
    TextCursor digits(word);
    std::int64_t group = 0;
    if (!digits.number(group)) group = same_word(word, "on") ? 1 : 0;
    smoothing_.set(mesh_.face_count(), static_cast<std::int32_t>(std::clamp<std::int64_t>(group, 0, INT32_MAX)));
  }

  void warn(std::string text) { mesh_.warnings.push_back(std::move(text)); }

  void check_flat() {
    if (flat_vertices_ == 0 || flat_vertices_ == mesh_.vertex_count()) return;
    throw InputError({fmt::format("{}:{}", file_, first_flat_line_), "v", "2 numbers", "a vertex without three coordinates", "v x y z"});
  }

  /// Some programs count from 0. Where 0 occurs and the last vertex is never named, nothing else is possible.
  void count_from_zero() {
    const auto [least, most] = std::minmax_element(mesh_.corner_vertices.begin(), mesh_.corner_vertices.end());
    if (least == mesh_.corner_vertices.end() || *least != -1 || counts_back_) return;
    if (static_cast<std::int64_t>(*most) + 1 >= static_cast<std::int64_t>(mesh_.vertex_count())) return;
    for (std::int32_t& v : mesh_.corner_vertices) ++v;
    for (std::int32_t& n : corner_normals_) n += n != kNone;
    warn(fmt::format("faces count their {} vertices from 0 instead of 1: read so", mesh_.vertex_count()));
  }

  void take_normals() {
    if (texture_corners_ > 0 && texture_coordinates_ == 0 && normal_corners_ > 0 && normals_.empty()) {
      warn(fmt::format("{} corners name normals and texture coordinates, of which the file has none: ignored", normal_corners_));
      return;
    }
    if (texture_corners_ > 0 && texture_coordinates_ == 0)
      warn(fmt::format("{} corners name texture coordinates, of which the file has none: ignored", texture_corners_));
    if (normal_corners_ == 0) return;
    const auto count = static_cast<std::int64_t>(normals_.size());
    const auto there = std::count_if(corner_normals_.begin(), corner_normals_.end(), [&](std::int32_t n) { return n >= 0 && n < count; });
    const auto corners = static_cast<std::int64_t>(corner_normals_.size());
    if (there < corners) {
      warn(there == 0 ? fmt::format("{} corners name normals that the file does not have: ignored", normal_corners_)
                      : fmt::format("{} of {} corners have no normal: the others' are ignored", corners - there, corners));
      return;
    }
    if (bad_normals_ > 0) warn(fmt::format("{} of {} normals are not finite numbers: ignored", bad_normals_, count));
    mesh_.corner_normals.reserve(corner_normals_.size());
    for (const std::int32_t n : corner_normals_) mesh_.corner_normals.push_back(normals_[static_cast<size_t>(n)]);
  }

  std::string line_of_face(size_t wanted) const {
    Statements again(text_);
    size_t face = 0;
    for (std::string_view line; again.next(line);) {
      const std::string_view keyword = TextCursor(line).word();
      if ((keyword == "f" || keyword == "fo") && face++ == wanted) return fmt::format("line {}", again.line());
    }
    return fmt::format("face {}", wanted + 1);
  }

  Mesh finish() {
    check_flat();
    finish_obj_tags(tags_, file_, mesh_);
    count_from_zero();
    take_normals();
    if (mesh_.vertex_colors.size() != mesh_.positions.size()) {
      if (!mesh_.vertex_colors.empty())
        warn(fmt::format("{} of {} vertices have a colour: none is used", mesh_.vertex_colors.size(), mesh_.vertex_count()));
      mesh_.vertex_colors.clear();
    }
    take_colors();
    materials_.finish(mesh_.face_count(), mesh_.material_names, mesh_.face_materials);
    groups_.finish(mesh_.face_count(), mesh_.group_names, mesh_.face_groups);
    if (!smoothing_.changes.empty()) mesh_.face_smoothing = smoothing_.of_faces(mesh_.face_count(), 0);
    if (free_form_ > 0) warn(fmt::format("{} free-form curves and surfaces: not read", free_form_));
    if (unknown_ > 0) warn(fmt::format("{} lines are no statements of an OBJ: ignored ({})", unknown_, first_unknown_));
    std::string instead;
    if (free_form_ > 0) instead = fmt::format("{} free-form curves and surfaces", free_form_);
    if (lines_and_points_ > 0) instead = fmt::format("{} statements of lines and points", lines_and_points_);
    repair_faces(mesh_, {file_, 1, [this](size_t face) { return line_of_face(face); }, instead});
    return std::move(mesh_);
  }

  std::string_view text_;
  const std::string& file_;
  Statements statements_;
  std::int64_t most_, elements_ = 0;
  Mesh mesh_{};
  std::vector<glm::vec3> normals_{};
  std::vector<std::int32_t> corner_normals_{};
  FaceNames materials_{}, groups_{};
  FaceRuns smoothing_{};
  ObjTags tags_{};
  size_t flat_vertices_ = 0;
  std::int64_t first_flat_line_ = 0, texture_coordinates_ = 0, texture_corners_ = 0, normal_corners_ = 0, bad_normals_ = 0;
  std::int64_t lines_and_points_ = 0, free_form_ = 0, unknown_ = 0;
  bool counts_back_ = false;
  std::string first_unknown_{};
};

}  // namespace

Mesh parse_obj(std::string_view bytes, const std::string& file, std::int64_t max_elements) {
  std::string converted;
  return ObjReader(plain_text(bytes, converted), file, max_elements).run();
}

}  // namespace limn
