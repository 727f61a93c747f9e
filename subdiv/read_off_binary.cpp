// Geomview's binary OFF: numbers of 32 bits, the highest byte first, behind a line that ends in BINARY.

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "sdf/error.h"
#include "subdiv/off_contents.h"
#include "subdiv/text_cursor.h"

namespace limn {
namespace {

class OffBinaryReader {
 public:
  OffBinaryReader(const OffBinary& binary, const std::string& file, std::int64_t max_elements)
      : layout_(binary.layout), data_(binary.data), file_(file), limits_(file, max_elements) {}

  Mesh run() {
    header();
    vertices();
    faces();
    if (at_ < data_.size())
      contents_.mesh.warnings.push_back(
          fmt::format("{} bytes behind the last of the {} faces that the header announces were ignored", data_.size() - at_, face_count_));
    return finished(std::move(contents_), file_);
  }

 private:
  bool has(size_t numbers) const { return (data_.size() - at_) / 4 >= numbers; }
  std::uint32_t bits() {
    std::uint32_t value = 0;
    for (int k = 0; k < 4; ++k) value = value << 8 | static_cast<unsigned char>(data_[at_++]);
    return value;
  }
  std::int32_t whole() { return static_cast<std::int32_t>(bits()); }
  double real() { return static_cast<double>(std::bit_cast<float>(bits())); }

  void header() {
    if (!has(layout_.any_dimension ? 4 : 3))
      throw InputError({file_, "header", "", "the file breaks off within its header", "three counts"});
    if (layout_.any_dimension) dimension_ = whole();
    if (dimension_ < 1 || dimension_ > 3)
      throw InputError({file_, "header", fmt::format("{}", dimension_), "vertices with that many coordinates are not read", "1 to 3"});
    vertex_count_ = whole();
    face_count_ = whole();
    whole();  // edges: the number means nothing
    if (vertex_count_ < 0 || face_count_ < 0)
      throw InputError({file_, "header", fmt::format("{} vertices, {} faces", vertex_count_, face_count_), "these are no counts",
                        "numbers of 32 bits, the highest byte first"});
  }

  void vertices() {
    const auto dimension = static_cast<size_t>(dimension_);
    const size_t numbers =
        dimension + (layout_.homogeneous ? 1 : 0) + (layout_.normal ? 3 : 0) + (layout_.color ? 4 : 0) + (layout_.texture ? 2 : 0);
    const auto there = static_cast<std::int64_t>((data_.size() - at_) / 4 / numbers);
    if (vertex_count_ > there) limits_.break_off("vertices", there, vertex_count_);
    limits_.count(vertex_count_);
    contents_.mesh.positions.reserve(static_cast<size_t>(vertex_count_));
    for (std::int64_t i = 0; i < vertex_count_; ++i) {
      glm::dvec3 position(0.0);
      for (int k = 0; k < dimension_; ++k) position[k] = real();
      contents_.mesh.positions.push_back(layout_.homogeneous ? position / real() : position);
      if (layout_.normal) contents_.normals.emplace_back(triple());
      if (layout_.color) contents_.colors.push_back(triple()), real();
      if (layout_.texture) real(), real();
    }
  }
  glm::dvec3 triple() {
    const double x = real(), y = real();
    return {x, y, real()};
  }

  void faces() {
    Mesh& mesh = contents_.mesh;
    for (std::int64_t i = 0; i < face_count_; ++i) {
      if (!has(1)) limits_.break_off("faces", i, face_count_);
      const std::int32_t corners = length(i, "is not a number of corners");
      limits_.count(corners);
      for (std::int32_t k = 0; k < corners; ++k) mesh.corner_vertices.push_back(std::max(whole(), -1));
      mesh.face_sizes.push_back(corners);
      if (!has(1)) limits_.break_off("faces", i, face_count_);
      at_ += 4 * static_cast<size_t>(length(i, "is not a number of colour components"));
    }
  }
  /// Of what follows; there is as much.
  std::int32_t length(std::int64_t face, const char* problem) {
    const std::int32_t numbers = whole();
    if (numbers < 0) throw InputError({file_, fmt::format("face {}", face), fmt::format("{}", numbers), problem, "0 or more"});
    if (!has(static_cast<size_t>(numbers))) limits_.break_off("faces", face, face_count_);
    return numbers;
  }

  OffLayout layout_;
  std::string_view data_;
  const std::string& file_;
  OffLimits limits_;
  size_t at_ = 0;
  std::int64_t dimension_ = 3, vertex_count_ = 0, face_count_ = 0;
  OffContents contents_{};
};

}  // namespace

std::optional<OffBinary> find_off_binary(std::string_view bytes) {
  constexpr size_t kLongestLine = 256;
  const std::string_view start = bytes.substr(0, kLongestLine);
  TextCursor cursor(start);
  OffBinary binary;
  if (!read_off_word(cursor.word(), binary.layout) || !same_word(cursor.word_in_line(), "BINARY")) return {};
  const size_t end = start.find('\n', static_cast<size_t>(cursor.at() - start.data()));
  binary.data = bytes.substr(end == std::string_view::npos ? bytes.size() : end + 1);
  return binary;
}

Mesh parse_off_binary(const OffBinary& binary, const std::string& file, std::int64_t max_elements) {
  return OffBinaryReader(binary, file, max_elements).run();
}

}  // namespace limn
