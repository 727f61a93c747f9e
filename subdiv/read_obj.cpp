#include "subdiv/read_obj.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>

#include "sdf/error.h"
#include "subdiv/mesh_bytes.h"

namespace limn {
namespace {

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f'; }

/// One statement, word by word.
class Words {
 public:
  explicit Words(std::string_view line) : rest_(line) {}
  bool next(std::string_view& word) {
    while (!rest_.empty() && is_space(rest_.front())) rest_.remove_prefix(1);
    size_t length = 0;
    while (length < rest_.size() && !is_space(rest_[length])) ++length;
    word = rest_.substr(0, length);
    rest_.remove_prefix(length);
    return !word.empty();
  }
  /// What is left, without the spaces around it: names may hold spaces.
  std::string remainder() const {
    std::string_view text = rest_;
    while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
    return std::string(text);
  }

 private:
  std::string_view rest_;
};

template <class T>
bool parse(std::string_view word, T& value) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto result = std::from_chars(word.data(), word.data() + word.size(), value);
  return result.ec == std::errc() && result.ptr == word.data() + word.size();
}

class ObjReader {
 public:
  ObjReader(std::string_view text, const std::string& file, std::int64_t max_elements)
      : text_(text), file_(file), max_elements_(max_elements) {}

  Mesh run() {
    if (text_.find('\0') != std::string_view::npos)
      throw InputError({file_, "", "", "is not a Wavefront OBJ: it holds binary data", "a text file with lines 'v x y z' and 'f a b c'"});
    std::string joined;
    for (size_t at = 0; at < text_.size();) {
      std::string_view line = next_line(at);
      // A backslash at the end of a line goes on in the next.
      if (!line.empty() && line.back() == '\\') {
        joined.clear();
        while (!line.empty() && line.back() == '\\') {
          joined.append(line.substr(0, line.size() - 1)).push_back(' ');
          line = at < text_.size() ? next_line(at) : std::string_view();
        }
        joined.append(line);
        line = joined;
      }
      statement(line);
    }
    return finish();
  }

 private:
  std::string_view next_line(size_t& at) {
    const size_t end = std::min(text_.find('\n', at), text_.size());
    std::string_view line = text_.substr(at, end - at);
    at = end + 1;
    ++line_number_;
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    return line;
  }

  [[noreturn]] void refuse(std::string_view field, std::string_view value, std::string problem, std::string expected) const {
    throw InputError({fmt::format("{}:{}", file_, line_number_), std::string(field), std::string(value.substr(0, 80)), std::move(problem),
                      std::move(expected)});
  }

  void statement(std::string_view line) {
    Words words(line);
    std::string_view keyword;
    if (!words.next(keyword) || keyword.front() == '#') return;
    if (keyword == "v") return vertex(words);
    if (keyword == "vn") return normal(words);
    if (keyword == "f" || keyword == "fo") return face(words);
    if (keyword == "g" || keyword == "o") current_group_ = named(words.remainder(), group_numbers_, mesh_.group_names);
    if (keyword == "usemtl") current_material_ = named(words.remainder(), material_numbers_, mesh_.material_names);
    if (keyword == "t") tag(words);
  }

  static std::int32_t named(const std::string& name, std::map<std::string, std::int32_t>& numbers, std::vector<std::string>& names) {
    const auto [at, is_new] = numbers.emplace(name, static_cast<std::int32_t>(names.size()));
    if (is_new) names.push_back(name);
    return at->second;
  }

  double number(std::string_view word, std::string_view field) const {
    double value = 0.0;
    if (!parse(word, value)) refuse(field, word, "is not a number", "decimal numbers within the range of double precision");
    return value;
  }

  void vertex(Words& words) {
    double values[8];
    size_t count = 0;
    std::string_view word;
    while (count < 8 && words.next(word)) values[count++] = number(word, "v");
    if (count < 3) refuse("v", fmt::format("{} numbers", count), "a vertex without three coordinates", "v x y z");
    mesh_.positions.emplace_back(values[0], values[1], values[2]);
    if (!std::isfinite(values[0]) || !std::isfinite(values[1]) || !std::isfinite(values[2]))
      refuse("v", fmt::format("{}, {}, {}", values[0], values[1], values[2]), "the position is not a finite number", "finite coordinates");
    if (count == 6 || count == 7) {
      const double* rgb = values + count - 3;
      mesh_.vertex_colors.emplace_back(linear(rgb[0]), linear(rgb[1]), linear(rgb[2]));
    }
    count_elements(1);
  }

  static float linear(double value) { return linear_from_srgb(static_cast<float>(std::clamp(value, 0.0, 1.0))); }

  void count_elements(std::int64_t more) {
    elements_ += more;
    if (elements_ > max_elements_)
      refuse("", fmt::format("{}", elements_), "more vertices and corners than allowed", fmt::format("at most {}", max_elements_));
  }

  void normal(Words& words) {
    glm::vec3 n(0.0f);
    std::string_view word;
    for (int i = 0; i < 3; ++i) {
      if (!words.next(word)) refuse("vn", "", "a normal without three components", "vn x y z");
      n[i] = static_cast<float>(number(word, "vn"));
    }
    normals_.push_back(n);
  }

  /// Numbers count from 1, negative ones back from the last.
  std::int32_t index(std::string_view word, size_t count, const char* what) const {
    std::int64_t value = 0;
    if (!parse(word, value)) refuse("f", word, fmt::format("is not a {} number", what), "whole numbers counted from 1, or from -1 back");
    const std::int64_t zero_based = value > 0 ? value - 1 : value < 0 ? static_cast<std::int64_t>(count) + value : -1;
    if (zero_based < 0 || zero_based >= static_cast<std::int64_t>(count)) late_.push_back({zero_based, value, line_number_, what});
    return static_cast<std::int32_t>(std::clamp<std::int64_t>(zero_based, 0, INT32_MAX));
  }

  void corner(std::string_view word) {
    const size_t first = word.find('/');
    mesh_.corner_vertices.push_back(index(word.substr(0, first), mesh_.positions.size(), "vertex"));
    std::int32_t normal_index = -1;
    if (first != std::string_view::npos) {
      const size_t second = word.find('/', first + 1);
      if (second != std::string_view::npos && second + 1 < word.size())
        normal_index = index(word.substr(second + 1), normals_.size(), "normal");
    }
    corner_normals_.push_back(normal_index);
  }

  void face(Words& words) {
    std::string_view word;
    std::int32_t corners = 0;
    while (words.next(word)) corner(word), ++corners;
    if (corners < 3) refuse("f", fmt::format("{} corners", corners), "a face with fewer than 3 corners", "f a b c ...");
    mesh_.face_sizes.push_back(corners);
    face_materials_.push_back(current_material_);
    face_groups_.push_back(current_group_);
    count_elements(corners);
  }

  /// `t name integers/reals/strings ...`, indices counted from 0.
  void tag(Words& words) {
    std::string_view name, sizes;
    if (!words.next(name) || !words.next(sizes)) return;
    int counts[3] = {0, 0, 0};
    for (int i = 0; i < 3; ++i) {
      const size_t slash = std::min(sizes.find('/'), sizes.size());
      if (!parse(sizes.substr(0, slash), counts[i]) || counts[i] < 0 || counts[i] > 100'000'000)
        refuse("t", sizes, "the counts of a tag cannot be read", "integers/reals/strings, as in 't crease 2/1/0 0 1 2.5'");
      sizes.remove_prefix(std::min(slash + 1, sizes.size()));
    }
    std::vector<std::int32_t> integers;
    std::vector<float> reals;
    std::string_view word;
    for (int i = 0; i < counts[0]; ++i) {
      std::int32_t value = 0;
      if (!words.next(word) || !parse(word, value)) refuse("t", word, "a tag with too few or damaged integers", "as many as it announces");
      integers.push_back(value);
    }
    for (int i = 0; i < counts[1]; ++i) {
      if (!words.next(word)) refuse("t", "", "a tag with too few numbers", "as many as it announces");
      reals.push_back(static_cast<float>(number(word, "t")));
    }
    apply(name, integers, reals);
  }

  void apply(std::string_view name, const std::vector<std::int32_t>& integers, const std::vector<float>& reals) {
    // One sharpness for all, or one each.
    const auto sharpness = [&](size_t i) { return reals[reals.size() == 1 ? 0 : i]; };
    if (name == "crease") {
      if (integers.size() < 2 || (reals.size() != 1 && reals.size() != integers.size() - 1))
        refuse("t crease", fmt::format("{} vertices, {} sharpnesses", integers.size(), reals.size()), "the counts do not fit",
               "2 or more vertices and one sharpness, or one for each edge");
      for (size_t i = 0; i + 1 < integers.size(); ++i) mesh_.creases.push_back({integers[i], integers[i + 1], sharpness(i)});
    } else if (name == "corner") {
      if (integers.empty() || (reals.size() != 1 && reals.size() != integers.size()))
        refuse("t corner", fmt::format("{} vertices, {} sharpnesses", integers.size(), reals.size()), "the counts do not fit",
               "1 or more vertices and one sharpness, or one for each");
      for (size_t i = 0; i < integers.size(); ++i) mesh_.corners.push_back({integers[i], sharpness(i)});
    } else if (name == "interpolateboundary") {
      // RenderMan's numbers: 0 none, 1 edges and corners, 2 edges only.
      const std::int32_t rule = integers.empty() ? -1 : integers[0];
      if (rule < 0 || rule > 2)
        refuse("t interpolateboundary", fmt::format("{}", rule), "unknown rule", "0 none, 1 edges and corners, 2 edges");
      mesh_.boundary = rule == 0 ? BoundaryRule::none : rule == 1 ? BoundaryRule::edge_and_corner : BoundaryRule::edge_only;
    }
  }

  /// A face may name a vertex that comes later in the file; only now is it known what is out of range.
  void check_late_indices() {
    for (const Late& late : late_) {
      const size_t count = std::string_view(late.what) == "normal" ? normals_.size() : mesh_.positions.size();
      if (late.zero_based >= 0 && late.zero_based < static_cast<std::int64_t>(count)) continue;
      line_number_ = late.line;
      refuse("f", fmt::format("{}", late.value), fmt::format("{} index out of range", late.what),
             count == 0 ? std::string("there are none") : fmt::format("1 to {0}, or -1 to -{0}", count));
    }
  }

  Mesh finish() {
    if (mesh_.face_sizes.empty()) throw InputError({file_, "", "", "the mesh has no faces", "at least one line 'f a b c'"});
    check_late_indices();
    if (mesh_.vertex_colors.size() != mesh_.positions.size()) mesh_.vertex_colors.clear();
    if (std::find(corner_normals_.begin(), corner_normals_.end(), -1) == corner_normals_.end())
      for (const std::int32_t n : corner_normals_) mesh_.corner_normals.push_back(normals_[static_cast<size_t>(n)]);
    assign_names(face_materials_, mesh_.material_names, mesh_.face_materials);
    assign_names(face_groups_, mesh_.group_names, mesh_.face_groups);
    return std::move(mesh_);
  }

  /// Faces before the first name belong to a nameless one.
  static void assign_names(std::vector<std::int32_t>& of_face, std::vector<std::string>& names, std::vector<std::int32_t>& result) {
    if (names.empty()) return;
    if (std::find(of_face.begin(), of_face.end(), -1) != of_face.end()) {
      std::replace(of_face.begin(), of_face.end(), -1, static_cast<std::int32_t>(names.size()));
      names.emplace_back();
    }
    result = std::move(of_face);
  }

  struct Late {
    std::int64_t zero_based, value;
    std::int64_t line;
    const char* what;
  };

  std::string_view text_;
  const std::string& file_;
  std::int64_t max_elements_, elements_ = 0;
  std::int64_t line_number_ = 0;
  Mesh mesh_;
  std::vector<glm::vec3> normals_;
  std::vector<std::int32_t> corner_normals_, face_materials_, face_groups_;
  std::map<std::string, std::int32_t> material_numbers_, group_numbers_;
  std::int32_t current_material_ = -1, current_group_ = -1;
  mutable std::vector<Late> late_;
};

}  // namespace

Mesh parse_obj(std::string_view text, const std::string& file, std::int64_t max_elements) {
  return ObjReader(text, file, max_elements).run();
}

}  // namespace limn
