#include "subdiv/read_stl.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "sdf/error.h"
#include "subdiv/repair_faces.h"
#include "subdiv/text_cursor.h"

namespace limn {
namespace {

constexpr size_t kHeaderBytes = 80, kCountBytes = 4, kFacetBytes = 50, kDataBegin = kHeaderBytes + kCountBytes;

/// Gives corners with equal coordinates one number, in the order in which they are first met: a hash table with open addressing.
class Welder {
 public:
  explicit Welder(std::vector<glm::dvec3>& positions) : positions_(positions) {}

  void reserve(size_t vertices) { grow(std::bit_ceil(2 * vertices + 16)); }

  std::int32_t vertex(const glm::dvec3& p) {
    if (2 * (positions_.size() + 1) > slots_.size()) grow(std::max<size_t>(64, 2 * slots_.size()));
    size_t at = slot(p);
    while (slots_[at] >= 0 && positions_[static_cast<size_t>(slots_[at])] != p) at = (at + 1) & (slots_.size() - 1);
    if (slots_[at] < 0) {
      slots_[at] = static_cast<std::int32_t>(positions_.size());
      positions_.push_back(p);
    }
    return slots_[at];
  }

 private:
  size_t slot(const glm::dvec3& p) const {
    std::uint64_t hash = 0;
    for (int i = 0; i < 3; ++i) {
      // Adding 0 makes -0 and 0 one number, as comparing them does.
      hash = (hash ^ std::bit_cast<std::uint64_t>(p[i] + 0.0)) * 0x9e3779b97f4a7c15ull;
      hash ^= hash >> 32;
    }
    return hash & (slots_.size() - 1);
  }
  void grow(size_t size) {
    slots_.assign(size, -1);
    for (size_t v = 0; v < positions_.size(); ++v) {
      size_t at = slot(positions_[v]);
      while (slots_[at] >= 0) at = (at + 1) & (size - 1);
      slots_[at] = static_cast<std::int32_t>(v);
    }
  }
  std::vector<glm::dvec3>& positions_;
  std::vector<std::int32_t> slots_{};
};

/// What both kinds of file have in common.
class StlMesh {
 public:
  StlMesh(const std::string& file, std::int64_t max_elements) : file_(file), most_(std::min<std::int64_t>(max_elements, INT32_MAX)) {}

  /// Counted from the facets, so that a file with too many is refused before memory is taken; three corners a facet.
  void count_facets(std::int64_t facets) {
    elements_ += 3 * facets;
    if (elements_ > most_)
      throw InputError(
          {file_, "", fmt::format("{}", elements_), "more vertices and corners than allowed", fmt::format("at most {}", most_)});
  }
  /// What is no number equals nothing, not even itself: it would never be welded, and be compared with all that came before it.
  void add_corner(const glm::dvec3& p) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      throw InputError({file_, fmt::format("facet {}", mesh.corner_vertices.size() / 3 + 1), fmt::format("{}, {}, {}", p.x, p.y, p.z),
                        "the position is not a finite number", "finite coordinates"});
    mesh.corner_vertices.push_back(welder.vertex(p));
  }
  Mesh finish() {
    if (mesh.group_names.size() < 2) mesh.group_names.clear(), mesh.face_groups.clear();
    repair_faces(mesh, {.file = file_});
    return std::move(mesh);
  }

  Mesh mesh{};
  Welder welder{mesh.positions};

 private:
  const std::string& file_;
  std::int64_t most_, elements_ = 0;
};

std::uint32_t facets_announced(std::string_view bytes) {
  std::uint32_t count = 0;
  if (bytes.size() >= kDataBegin) std::memcpy(&count, bytes.data() + kHeaderBytes, kCountBytes);
  return count;
}

bool has_exact_size(std::string_view bytes) {
  return bytes.size() >= kDataBegin && bytes.size() == kDataBegin + kFacetBytes * std::uint64_t{facets_announced(bytes)};
}

Mesh parse_binary(std::string_view bytes, const std::string& file, std::int64_t max_elements) {
  if (bytes.size() < kDataBegin)
    throw InputError({file, "", fmt::format("{} bytes", bytes.size()), "is not an STL file, or breaks off within its header",
                      "a text that begins with 'solid', or a header of 84 bytes"});
  StlMesh stl(file, max_elements);
  const size_t held = (bytes.size() - kDataBegin) / kFacetBytes, rest = (bytes.size() - kDataBegin) % kFacetBytes;
  size_t facets = facets_announced(bytes);
  if (facets > held)
    throw InputError({file, "", fmt::format("{} bytes: {} whole facets", bytes.size(), held), "the file breaks off, or is no STL file",
                      fmt::format("{} facets, as its header says", facets)});
  if (facets == 0 && rest == 0 && held > 0) {
    // Some programs never come back to write the count.
    stl.mesh.warnings.push_back(fmt::format("the header announces 0 facets, {} follow: all are read", held));
    facets = held;
  } else if (held > facets || rest > 0) {
    stl.mesh.warnings.push_back(fmt::format("{} bytes after the {} facets that the header announces: ignored",
                                            bytes.size() - kDataBegin - kFacetBytes * facets, facets));
  }
  stl.count_facets(static_cast<std::int64_t>(facets));
  stl.mesh.corner_vertices.reserve(3 * facets);
  stl.mesh.positions.reserve(facets / 2 + 16);
  stl.welder.reserve(facets / 2);
  const char* at = bytes.data() + kDataBegin + 12;  // past the normal
  for (size_t f = 0; f < facets; ++f, at += kFacetBytes) {
    float p[9];
    std::memcpy(p, at, sizeof p);
    for (int i = 0; i < 9; i += 3) stl.add_corner({p[i], p[i + 1], p[i + 2]});
  }
  stl.mesh.face_sizes.assign(facets, 3);
  return stl.finish();
}

class AsciiReader {
 public:
  AsciiReader(std::string_view text, const std::string& file, std::int64_t max_elements)
      : text_(text), file_(file), cursor_(text), stl_(file, max_elements) {}

  Mesh run() {
    while (cursor_.skip()) {
      const std::string_view word = cursor_.word();
      if (same_word(word, "solid")) {
        solid();
      } else {
        refuse(word, "unexpected word", "'solid NAME' or the end of the file");
      }
    }
    return stl_.finish();
  }

 private:
  [[noreturn]] void refuse(std::string_view word, std::string problem, std::string expected) const {
    if (word.empty())
      throw InputError({file_, "", fmt::format("{} whole facets", stl_.mesh.face_count()), "the file breaks off", std::move(expected)});
    throw InputError({place_in(file_, text_, word.data()), "", shown_word(word), std::move(problem), std::move(expected)});
  }

  void expect(const char* keyword) {
    const std::string_view word = cursor_.word();
    if (!same_word(word, keyword)) refuse(word, "unexpected word", fmt::format("'{}'", keyword));
  }

  void solid() {
    const auto group = static_cast<std::int32_t>(stl_.mesh.group_names.size());
    stl_.mesh.group_names.emplace_back(cursor_.rest_of_line());
    while (true) {
      const std::string_view word = cursor_.word();
      if (same_word(word, "facet")) {
        facet();
        stl_.mesh.face_groups.push_back(group);
      } else if (same_word(word, "endsolid")) {
        cursor_.rest_of_line();
        break;
      } else if (same_word(word, "end") && same_word(cursor_.word(), "solid")) {
        cursor_.rest_of_line();
        break;
      } else {
        refuse(word, "unexpected word", "'facet' or 'endsolid'");
      }
    }
    // A solid without facets is no group.
    if (stl_.mesh.face_groups.empty() || stl_.mesh.face_groups.back() != group) stl_.mesh.group_names.pop_back();
  }

  /// The normal is not kept: it says nothing that the corners do not.
  void facet() {
    std::string_view word = cursor_.word();
    while (!word.empty() && !same_word(word, "outer") && !same_word(word, "outerloop")) {
      if (same_word(word, "vertex") || same_word(word, "endfacet")) refuse(word, "unexpected word", "'outer loop'");
      word = cursor_.word();
    }
    if (!same_word(word, "outerloop")) expect("loop");
    std::int32_t corners = 0;
    for (word = cursor_.word(); same_word(word, "vertex"); word = cursor_.word(), ++corners) {
      glm::dvec3 p(0.0);
      for (int i = 0; i < 3; ++i)
        if (!read_real(cursor_, p[i])) refuse(cursor_.word(), "is not a number", "vertex x y z");
      stl_.add_corner(p);
    }
    if (!same_word(word, "endloop")) refuse(word, "unexpected word", "'vertex x y z' or 'endloop'");
    expect("endfacet");
    stl_.mesh.face_sizes.push_back(corners);
    stl_.count_facets(1);
  }

  std::string_view text_;
  const std::string& file_;
  TextCursor cursor_;
  StlMesh stl_;
};

/// Binary headers may begin with "solid" too; text holds no zero bytes, and a facet soon or none at all.
bool is_text(std::string_view text) {
  TextCursor cursor(text);
  if (!same_word(cursor.word(), "solid")) return false;
  return text.substr(0, 4096).find('\0') == std::string_view::npos;
}

}  // namespace

Mesh parse_stl(std::string_view bytes, const std::string& file, std::int64_t max_elements) {
  std::string converted;
  const std::string_view text = plain_text(bytes, converted);
  if (!has_exact_size(bytes) && is_text(text)) return AsciiReader(text, file, max_elements).run();
  return parse_binary(bytes, file, max_elements);
}

}  // namespace limn
