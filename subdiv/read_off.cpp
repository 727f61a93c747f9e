#include "subdiv/read_off.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "sdf/error.h"
#include "subdiv/off_contents.h"
#include "subdiv/text_cursor.h"

namespace limn {
namespace {

class OffReader {
 public:
  OffReader(std::string_view text, const std::string& file, std::int64_t max_elements)
      : text_(text), file_(file), cursor_(text), limits_(file, max_elements) {}

  Mesh run() {
    header();
    vertices();
    faces();
    if (cursor_.skip() && lines_left() != edges_)
      mesh_.warnings.push_back(fmt::format("line {}: what follows the last of the {} faces that the header announces was ignored",
                                           line_of(text_, cursor_.at()), face_count_));
    return finished(std::move(contents_), file_);
  }

 private:
  [[noreturn]] void refuse(std::string_view value, std::string problem, std::string expected) const {
    throw InputError({place_in(file_, text_, cursor_.at()), "", shown_word(value), std::move(problem), std::move(expected)});
  }
  std::int64_t whole(const char* what) {
    std::int64_t value = 0;
    if (!cursor_.skip()) throw InputError({file_, "header", "", "the file breaks off within its header", what});
    if (!cursor_.number(value) || value < 0) {
      TextCursor ahead = cursor_;
      refuse(ahead.word(), "is not a count", what);
    }
    return value;
  }

  void header() {
    TextCursor ahead(text_);
    const std::string_view word = ahead.word();
    if (read_off_word(word, layout_)) {
      cursor_ = ahead;
    } else if (word.empty() || word.find_first_not_of("0123456789") != std::string_view::npos) {
      layout_ = {};
      throw InputError({place_in(file_, text_, word.empty() ? cursor_.at() : word.data()), "", shown_word(word), "is not an OFF file",
                        "a first word 'OFF', or one of its kind (COFF, NOFF, STOFF, 4OFF, nOFF)"});
    } else {
      layout_ = {};  // Geomview lets the word be absent
    }
    if (layout_.any_dimension) dimension_ = whole("the number of dimensions");
    if (dimension_ < 1 || dimension_ > 3)
      refuse(fmt::format("{}", dimension_), "vertices with that many coordinates are not read", "1 to 3 dimensions");
    vertex_count_ = whole("the numbers of vertices, faces and edges");
    face_count_ = whole("the numbers of vertices, faces and edges");
    edge_count();
  }

  /// Geomview lets edges follow, a line each.
  std::int64_t lines_left() const {
    std::int64_t lines = 0;
    for (TextCursor ahead = cursor_; ahead.skip(); ++lines)
      while (!ahead.word_in_line().empty()) continue;
    return lines;
  }

  /// The number of edges means nothing, and some files leave it out: it is there when it is on the line of the others, or alone on the
  /// next.
  void edge_count() {
    TextCursor ahead = cursor_;
    const bool same_line = ahead.skip_in_line();
    if (!ahead.skip()) return;
    std::int64_t value = 0;
    if (ahead.number(value) && (same_line || !ahead.skip_in_line())) {
      cursor_ = ahead;
      edges_ = value;
    }
  }

  void reals(size_t values, std::array<double, 4>& to) {
    for (size_t i = 0; i < values; ++i) {
      if (!cursor_.skip()) limits_.break_off("vertices", static_cast<std::int64_t>(mesh_.positions.size()), vertex_count_);
      if (!read_real(cursor_, to[i])) {
        TextCursor ahead = cursor_;
        refuse(ahead.word(), "is not a number", "decimal numbers within the range of double precision");
      }
    }
  }

  void vertices() {
    // A number and a space take two bytes: what announces more than the file can hold is refused before memory is taken.
    if (vertex_count_ > static_cast<std::int64_t>(text_.size())) limits_.break_off("vertices", 0, vertex_count_);
    limits_.count(vertex_count_);
    find_unnamed_colors();
    mesh_.positions.reserve(static_cast<size_t>(vertex_count_));
    std::array<double, 4> v{}, extra{};
    const auto dimension = static_cast<size_t>(dimension_);
    for (std::int64_t i = 0; i < vertex_count_; ++i) {
      reals(dimension + (layout_.homogeneous ? 1 : 0), v);
      const double w = layout_.homogeneous ? v[dimension] : 1.0;
      mesh_.positions.emplace_back(v[0] / w, dimension > 1 ? v[1] / w : 0.0, dimension > 2 ? v[2] / w : 0.0);
      if (layout_.normal) {
        reals(3, extra);
        contents_.normals.emplace_back(extra[0], extra[1], extra[2]);
      }
      if (layout_.color) vertex_color();
      if (layout_.texture) reals(2, extra);
    }
  }

  /// Some programs write colours under a plain OFF: so it is where every vertex has a line with three or four numbers more.
  void find_unnamed_colors() {
    if (layout_.color || layout_.normal || layout_.texture || vertex_count_ == 0) return;
    const auto own = static_cast<size_t>(dimension_) + (layout_.homogeneous ? 1 : 0);
    TextCursor ahead = cursor_;
    size_t first = 0;
    for (std::int64_t i = 0; i < vertex_count_; ++i) {
      size_t words = 0;
      if (!ahead.skip()) return;
      while (!ahead.word_in_line().empty()) ++words;
      if (i == 0) first = words;
      if (words != first || (words != own + 3 && words != own + 4)) return;
    }
    layout_.color = true;
    color_values_ = first - own;
    mesh_.warnings.push_back(fmt::format("vertices have {} numbers more than 'OFF' announces: read as colours (COFF)", color_values_));
  }

  /// Three or four numbers: how many, the rest of the first vertex's line says.
  void vertex_color() {
    if (color_values_ == 0) {
      TextCursor ahead = cursor_;
      size_t words = 0;
      while (!ahead.word_in_line().empty()) ++words;
      color_values_ = words - std::min<size_t>(words, layout_.texture ? 2 : 0) == 3 ? 3 : 4;
    }
    std::array<double, 4> rgba{};
    reals(color_values_, rgba);
    contents_.colors.emplace_back(rgba[0], rgba[1], rgba[2]);
  }

  void faces() {
    if (face_count_ > static_cast<std::int64_t>(text_.size())) limits_.break_off("faces", 0, face_count_);
    mesh_.face_sizes.reserve(static_cast<size_t>(face_count_));
    for (std::int64_t i = 0; i < face_count_; ++i) {
      const std::int64_t corners = corner_number(i, "is not a number of corners", 0);
      limits_.count(corners);
      for (std::int64_t k = 0; k < corners; ++k) {
        const std::int64_t v = corner_number(i, "is not a vertex number", INT64_MIN);
        mesh_.corner_vertices.push_back(static_cast<std::int32_t>(std::clamp<std::int64_t>(v, -1, INT32_MAX)));
      }
      mesh_.face_sizes.push_back(static_cast<std::int32_t>(corners));
      // The rest of the line is the face's colour.
      while (cursor_.skip_in_line()) face_color_word();
    }
  }

  std::int64_t corner_number(std::int64_t face, const char* problem, std::int64_t least) {
    std::int64_t value = 0;
    if (!cursor_.skip()) limits_.break_off("faces", face, face_count_);
    if (!cursor_.number(value) || value < least) {
      TextCursor ahead = cursor_;
      refuse(ahead.word(), problem, "whole numbers: a face's number of corners, and its vertices counted from 0");
    }
    return value;
  }

  void face_color_word() {
    double ignored = 0.0;
    TextCursor ahead = cursor_;
    if (!read_real(cursor_, ignored)) refuse(ahead.word(), "is not part of a colour", "numbers, or the end of the line");
  }

  std::string_view text_;
  const std::string& file_;
  TextCursor cursor_;
  OffLimits limits_;
  OffLayout layout_{};
  std::int64_t dimension_ = 3, vertex_count_ = 0, face_count_ = 0, edges_ = 0;
  size_t color_values_ = 0;
  OffContents contents_{};
  Mesh& mesh_ = contents_.mesh;
};

}  // namespace

Mesh parse_off(std::string_view bytes, const std::string& file, std::int64_t max_elements) {
  if (const std::optional<OffBinary> binary = find_off_binary(bytes)) return parse_off_binary(*binary, file, max_elements);
  std::string converted;
  return OffReader(plain_text(bytes, converted), file, max_elements).run();
}

}  // namespace limn
