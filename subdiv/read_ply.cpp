#include "subdiv/read_ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "sdf/color.h"
#include "sdf/error.h"
#include "subdiv/ply_header.h"
#include "subdiv/repair_faces.h"
#include "subdiv/text_cursor.h"

namespace limn {
namespace {

static_assert(std::endian::native == std::endian::little, "binary values are read as they lie in memory");

/// Values of a binary file, one after the other. `next` is false where the file ends.
class BinaryValues {
 public:
  BinaryValues(std::string_view bytes, bool swapped) : at_(bytes.data()), end_(bytes.data() + bytes.size()), swapped_(swapped) {}

  bool next(PlyType type, double& value) {
    switch (type) {
      case PlyType::int8:
        return take<std::int8_t>(value);
      case PlyType::uint8:
        return take<std::uint8_t>(value);
      case PlyType::int16:
        return take<std::int16_t>(value);
      case PlyType::uint16:
        return take<std::uint16_t>(value);
      case PlyType::int32:
        return take<std::int32_t>(value);
      case PlyType::uint32:
        return take<std::uint32_t>(value);
      case PlyType::float32:
        return take<float>(value);
      case PlyType::float64:
        break;
    }
    return take<double>(value);
  }
  /// A whole list of 32-bit numbers in one go; false where the list is of another kind or breaks off.
  bool next_list(PlyType type, size_t count, std::vector<std::int32_t>& list) {
    if (swapped_ || is_real(type) || bytes_of(type) != 4 || count > left() / 4) return false;
    const size_t old = list.size();
    list.resize(old + count);
    if (count > 0) std::memcpy(list.data() + old, at_, 4 * count);
    at_ += 4 * count;
    return true;
  }
  bool skip(size_t bytes) {
    if (bytes > left()) return false;
    at_ += bytes;
    return true;
  }
  size_t left() const { return static_cast<size_t>(end_ - at_); }
  size_t room_for(const PlyElement& element) const { return left() / std::max<size_t>(element.least_bytes(), 1); }
  std::string end_of_element() const { return {}; }
  std::string value_place() const { return {}; }
  size_t rest() const { return left(); }

 private:
  template <class T>
  bool take(double& value) {
    if (sizeof(T) > left()) return false;
    std::array<char, sizeof(T)> raw;
    std::memcpy(raw.data(), at_, sizeof(T));
    at_ += sizeof(T);
    if (swapped_) std::reverse(raw.begin(), raw.end());
    value = static_cast<double>(std::bit_cast<T>(raw));
    return true;
  }
  const char* at_;
  const char* end_;
  bool swapped_;
};

/// Values of an ASCII file: words, an element a line.
class TextValues {
 public:
  TextValues(std::string_view text, const std::string& file, size_t data)
      : text_(text), file_(file), cursor_(text.substr(data), kNoComments) {}

  bool next(PlyType, double& value) {
    if (!cursor_.skip()) return false;
    if (read_real(cursor_, value)) return true;
    const std::string place = value_place();
    throw InputError({place, "", shown_word(cursor_.word()), "is not a number", "decimal numbers within the range of double precision"});
  }
  bool next_list(PlyType, size_t, std::vector<std::int32_t>&) { return false; }
  bool skip(size_t) { return false; }
  /// Every value takes a digit and a space at least.
  size_t left() const { return cursor_.left() / 2 + 1; }
  size_t room_for(const PlyElement& element) const { return left() / std::max<size_t>(element.properties.size(), 1); }
  /// The first word that is left on an element's line: the header names fewer values than there are.
  std::string end_of_element() { return cursor_.skip_in_line() ? shown_word(cursor_.word()) : std::string(); }
  std::string value_place() const { return place_in(file_, text_, cursor_.at()); }
  size_t rest() { return cursor_.skip() ? cursor_.left() : 0; }

 private:
  std::string_view text_;
  const std::string& file_;
  TextCursor cursor_;
};

/// What a vertex's properties are: indices into its nine values.
constexpr int kPosition = 0, kNormal = 3, kColor = 6, kValues = 9;
constexpr std::string_view kVertexNames[kValues] = {"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue"};

int role_of(const PlyProperty& property) {
  if (property.is_list) return -1;
  std::string_view name = property.name;
  if (name.starts_with("diffuse_")) name.remove_prefix(8);
  for (int i = 0; i < kValues; ++i)
    if (name == kVertexNames[i] || (i >= kColor && name == kVertexNames[i].substr(0, 1))) return i;
  return -1;
}

double largest_of(PlyType type) {
  if (is_real(type)) return 1.0;
  const bool is_signed = type == PlyType::int8 || type == PlyType::int16 || type == PlyType::int32;
  return std::exp2(static_cast<double>(8 * bytes_of(type) - (is_signed ? 1 : 0))) - 1.0;
}

template <class Values>
class PlyBody {
 public:
  PlyBody(const PlyHeader& header, Values values, const std::string& file, std::int64_t max_elements)
      : header_(header), values_(std::move(values)), file_(file), most_(std::min<std::int64_t>(max_elements, INT32_MAX)) {}

  Mesh run() {
    mesh_.warnings = header_.warnings;
    for (const PlyElement& element : header_.elements) {
      if (static_cast<std::uint64_t>(element.count) > values_.room_for(element) && !element.properties.empty()) break_off(element, -1);
      if (element.name == "vertex") {
        vertices(element);
      } else if (element.name == "face" || element.name == "tristrips") {
        faces(element);
      } else if (!element.properties.empty()) {
        skip(element);
      }
    }
    if (const size_t rest = values_.rest(); rest > 0)
      mesh_.warnings.push_back(fmt::format("{} bytes after the last element that the header names: ignored", rest));
    give_normals_to_corners();
    if (mesh_.vertex_colors.size() != mesh_.positions.size()) mesh_.vertex_colors.clear();
    repair_faces(mesh_, {.file = file_});
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void break_off(const PlyElement& element, std::int64_t read) const {
    const std::string got = read < 0 ? fmt::format("room for {}", values_.room_for(element)) : fmt::format("{}", read);
    throw InputError({file_, "element " + element.name, got, "the file breaks off", fmt::format("{}, as its header says", element.count)});
  }
  [[noreturn]] void refuse(const PlyElement& element, std::int64_t index, double value, std::string problem, std::string expected) const {
    const std::string place = values_.value_place();
    throw InputError({place.empty() ? file_ : place, fmt::format("{} {}", element.name, index + 1), fmt::format("{:.17g}", value),
                      std::move(problem), std::move(expected)});
  }

  void count(std::int64_t more) {
    elements_ += more;
    if (elements_ > most_)
      throw InputError(
          {file_, "", fmt::format("{}", elements_), "more vertices and corners than allowed", fmt::format("at most {}", most_)});
  }

  void finish_element(const PlyElement& element, std::int64_t index) {
    const std::string extra = values_.end_of_element();
    if (!extra.empty())
      throw InputError({values_.value_place(), fmt::format("{} {}", element.name, index + 1), extra,
                        "the line goes on after the last property",
                        fmt::format("{} properties, as the header says", element.properties.size())});
  }

  size_t list_length(const PlyElement& element, const PlyProperty& property, std::int64_t index) {
    double length = 0.0;
    if (!values_.next(property.count_type, length)) break_off(element, index);
    if (!(length >= 0.0) || length != std::floor(length)) refuse(element, index, length, "is not the length of a list", "0 or more");
    if (length > static_cast<double>(values_.left())) break_off(element, index);
    return static_cast<size_t>(length);
  }

  /// Reads past a property that is not kept.
  void skip_property(const PlyElement& element, const PlyProperty& property, std::int64_t index) {
    const size_t values = property.is_list ? list_length(element, property, index) : 1;
    if (values_.skip(values * bytes_of(property.type))) return;
    double ignored = 0.0;
    for (size_t i = 0; i < values; ++i)
      if (!values_.next(property.type, ignored)) break_off(element, index);
  }

  void skip(const PlyElement& element) {
    for (std::int64_t i = 0; i < element.count; ++i) {
      for (const PlyProperty& property : element.properties) skip_property(element, property, i);
      finish_element(element, i);
    }
  }

  void vertices(const PlyElement& element) {
    std::vector<int> roles;
    std::array<double, kValues> scale{};
    for (const PlyProperty& property : element.properties) {
      const int role = role_of(property);
      roles.push_back(role);
      if (role >= 0) scale[static_cast<size_t>(role)] = largest_of(property.type);
    }
    const auto has = [&](int first) { return scale[static_cast<size_t>(first)] > 0.0 && scale[static_cast<size_t>(first) + 1] > 0.0; };
    if (!has(kPosition)) throw InputError({file_, "element vertex", "", "the vertices have no x and y", "properties x, y and z"});
    const bool normals = has(kNormal) && scale[kNormal + 2] > 0.0, colors = has(kColor) && scale[kColor + 2] > 0.0;
    count(element.count);
    const auto size = mesh_.positions.size() + static_cast<size_t>(element.count);
    mesh_.positions.reserve(size);
    if (normals) normals_.reserve(size);
    if (colors) mesh_.vertex_colors.reserve(size);
    std::array<double, kValues> v{};
    for (std::int64_t i = 0; i < element.count; ++i) {
      for (size_t p = 0; p < roles.size(); ++p) {
        if (roles[p] < 0) {
          skip_property(element, element.properties[p], i);
        } else if (!values_.next(element.properties[p].type, v[static_cast<size_t>(roles[p])])) {
          break_off(element, i);
        }
      }
      finish_element(element, i);
      mesh_.positions.emplace_back(v[0], v[1], v[2]);
      if (normals) normals_.push_back(unit(glm::vec3(v[kNormal], v[kNormal + 1], v[kNormal + 2])));
      if (colors) add_color(v.data() + kColor);
    }
    if (colors) take_colors(scale[kColor], mesh_.vertex_colors.size() - static_cast<size_t>(element.count));
  }

  static glm::vec3 unit(const glm::vec3& n) {
    const float length = glm::length(n);
    return length > 0.0f && std::isfinite(length) ? n / length : glm::vec3(0.0f);
  }

  void add_color(const double* value) { mesh_.vertex_colors.emplace_back(value[0], value[1], value[2]); }

  /// As a screen shows them, up to the largest number of their type; reals beyond 16, and whole numbers of 32 bits, up to 255 where none is
  /// larger.
  void take_colors(double largest_of_type, size_t first) {
    float largest = 0.0f;
    for (size_t i = first; i < mesh_.vertex_colors.size(); ++i)
      for (int k = 0; k < 3; ++k) largest = std::max(largest, mesh_.vertex_colors[i][k]);
    const bool real = largest_of_type == 1.0, wide = largest_of_type > 65535.0;
    const bool bytes = (real && largest > 16.0f) || (wide && largest <= 255.0f);
    const float white = bytes ? 255.0f : static_cast<float>(largest_of_type);
    for (size_t i = first; i < mesh_.vertex_colors.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const float shown = mesh_.vertex_colors[i][k] / white;
        mesh_.vertex_colors[i][k] = linear_from_srgb(std::isfinite(shown) ? std::clamp(shown, 0.0f, 1.0f) : 1.0f);
      }
  }

  /// The list of a face's vertices: by its usual names, else the only list of whole numbers that there is.
  size_t find_indices(const PlyElement& element) const {
    size_t found = element.properties.size(), lists = 0;
    for (size_t p = 0; p < element.properties.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      if (!property.is_list) continue;
      if (property.name == "vertex_indices" || property.name == "vertex_index") return p;
      if (!is_real(property.type)) found = p, ++lists;
    }
    if (lists != 1 && element.count > 0)
      throw InputError({file_, "element " + element.name, "", "the faces have no list of vertices", "a property list vertex_indices"});
    return found;
  }

  void faces(const PlyElement& element) {
    const size_t indices = find_indices(element);
    const bool strips = element.name == "tristrips";
    if (!strips) mesh_.face_sizes.reserve(mesh_.face_sizes.size() + static_cast<size_t>(std::min(element.count, most_)));
    std::vector<std::int32_t> strip;
    for (std::int64_t i = 0; i < element.count; ++i) {
      for (size_t p = 0; p < element.properties.size(); ++p) {
        if (p != indices) {
          skip_property(element, element.properties[p], i);
        } else if (strips) {
          strip.clear();
          list(element, element.properties[p], i, strip);
          add_strip(strip);
        } else {
          const size_t size = list(element, element.properties[p], i, mesh_.corner_vertices);
          mesh_.face_sizes.push_back(static_cast<std::int32_t>(size));
        }
      }
      finish_element(element, i);
    }
  }

  size_t list(const PlyElement& element, const PlyProperty& property, std::int64_t index, std::vector<std::int32_t>& to) {
    const size_t length = list_length(element, property, index);
    count(static_cast<std::int64_t>(length));
    if (values_.next_list(property.type, length, to)) return length;
    for (size_t k = 0; k < length; ++k) {
      double value = 0.0;
      if (!values_.next(property.type, value)) break_off(element, index);
      if (value != std::floor(value)) refuse(element, index, value, "is not a vertex number", "whole numbers, counted from 0");
      // Beyond 32 bits no vertex can be: such numbers are out of range whatever they are.
      // The largest of unsigned 32 bits is -1 to most: it begins a new strip.
      to.push_back(value == 4294967295.0 ? -1 : static_cast<std::int32_t>(std::clamp(value, -1.0, static_cast<double>(INT32_MAX))));
    }
    return length;
  }

  /// Triangles of a strip, every other one turned; -1 begins a new strip. Triangles with a repeated corner only lead from one to the next.
  void add_strip(const std::vector<std::int32_t>& strip) {
    size_t start = 0;
    for (size_t k = 0; k < strip.size(); ++k) {
      if (strip[k] < 0) {
        start = k + 1;
        continue;
      }
      if (k < start + 2) continue;
      const std::int32_t a = strip[k - 2], b = strip[k - 1], c = strip[k];
      if (a == b || b == c || c == a) continue;
      count(3);
      const bool turned = (k - start) % 2 == 1;
      mesh_.face_sizes.push_back(3);
      mesh_.corner_vertices.insert(mesh_.corner_vertices.end(), {turned ? b : a, turned ? a : b, c});
    }
  }

  void give_normals_to_corners() {
    if (normals_.empty() || normals_.size() != mesh_.positions.size()) return;
    mesh_.corner_normals.reserve(mesh_.corner_vertices.size());
    for (const std::int32_t v : mesh_.corner_vertices) {
      const bool there = v >= 0 && static_cast<size_t>(v) < normals_.size();
      mesh_.corner_normals.push_back(there ? normals_[static_cast<size_t>(v)] : glm::vec3(0.0f));
    }
  }

  const PlyHeader& header_;
  Values values_;
  const std::string& file_;
  std::int64_t most_, elements_ = 0;
  Mesh mesh_{};
  std::vector<glm::vec3> normals_{};
};

}  // namespace

Mesh parse_ply(std::string_view bytes, const std::string& file, std::int64_t max_elements) {
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  const PlyHeader header = read_ply_header(bytes, file);
  if (header.encoding == PlyEncoding::ascii) return PlyBody(header, TextValues(bytes, file, header.data), file, max_elements).run();
  const BinaryValues values(bytes.substr(header.data), header.encoding == PlyEncoding::big_endian);
  return PlyBody(header, values, file, max_elements).run();
}

}  // namespace limn
