#include "subdiv/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "sdf/error.h"
#include "subdiv/text_cursor.h"

namespace limn {
namespace {

struct TypeName {
  std::string_view name;
  PlyType type;
};
constexpr TypeName kTypes[] = {
    {"char", PlyType::int8},   {"uchar", PlyType::uint8},   {"short", PlyType::int16},     {"ushort", PlyType::uint16},
    {"int", PlyType::int32},   {"uint", PlyType::uint32},   {"float", PlyType::float32},   {"double", PlyType::float64},
    {"int8", PlyType::int8},   {"uint8", PlyType::uint8},   {"int16", PlyType::int16},     {"uint16", PlyType::uint16},
    {"int32", PlyType::int32}, {"uint32", PlyType::uint32}, {"float32", PlyType::float32}, {"float64", PlyType::float64},
};
/// A header is text of a few lines; what goes on for longer than this without an end is none.
constexpr size_t kLongestHeader = size_t{1} << 20;

class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::string& file) : bytes_(bytes.substr(0, kLongestHeader)), file_(file) {}

  PlyHeader run() {
    TextCursor first(next_line());
    if (!same_word(first.word(), "ply")) refuse("", "is not a PLY file", "a first line 'ply'");
    bool has_format = false;
    while (true) {
      if (at_ >= bytes_.size())
        throw InputError({file_, "header", "", "the file breaks off within its header", "a line 'end_header' before the data"});
      const std::string_view line = next_line();
      TextCursor words(line, kNoComments);
      const std::string_view keyword = words.word();
      if (keyword == "end_header") break;
      if (keyword == "format") {
        format(words);
        has_format = true;
      } else if (keyword == "element") {
        element(words);
      } else if (keyword == "property") {
        property(words);
      } else if (keyword != "comment" && keyword != "obj_info" && !keyword.empty()) {
        // Old exporters forget the word 'comment'; what else it could be, the elements' sizes would tell.
        header_.warnings.push_back(fmt::format("line {} is no statement of a PLY header ({}): ignored", line_, shown_word(keyword)));
      }
    }
    if (!has_format) refuse("", "the header has no format", "a line 'format ascii 1.0', binary_little_endian or binary_big_endian");
    header_.data = std::min(at_, bytes_.size());
    return std::move(header_);
  }

 private:
  /// A line ends as the first one does: binary data may begin with any byte, a line feed among them.
  std::string_view next_line() {
    const size_t begin = at_;
    while (at_ < bytes_.size() && !is_line_end(bytes_[at_])) ++at_;
    const std::string_view line = bytes_.substr(begin, at_ - begin);
    if (line_++ == 0) crlf_ = bytes_.substr(at_, 2) == "\r\n";
    at_ += crlf_ && bytes_.substr(at_, 2) == "\r\n" ? 2 : 1;
    return line;
  }

  [[noreturn]] void refuse(std::string_view value, std::string problem, std::string expected) const {
    throw InputError({fmt::format("{}:{}", file_, line_), "header", shown_word(value), std::move(problem), std::move(expected)});
  }

  void format(TextCursor& words) {
    const std::string_view name = words.word();
    if (name == "ascii") {
      header_.encoding = PlyEncoding::ascii;
    } else if (name == "binary_little_endian") {
      header_.encoding = PlyEncoding::little_endian;
    } else if (name == "binary_big_endian") {
      header_.encoding = PlyEncoding::big_endian;
    } else {
      refuse(name, "unknown format", "ascii, binary_little_endian or binary_big_endian");
    }
  }

  void element(TextCursor& words) {
    PlyElement element;
    element.name = words.word();
    if (!words.skip() || !words.number(element.count) || element.count < 0)
      refuse(words.word(), "an element without a count", "element NAME COUNT");
    header_.elements.push_back(std::move(element));
  }

  PlyType type(std::string_view name) const {
    for (const TypeName& known : kTypes)
      if (known.name == name) return known.type;
    refuse(name, "unknown type", "char, uchar, short, ushort, int, uint, float or double");
  }

  void property(TextCursor& words) {
    if (header_.elements.empty()) refuse("", "a property before the first element", "element NAME COUNT");
    PlyProperty property;
    std::string_view word = words.word();
    property.is_list = word == "list";
    if (property.is_list) {
      property.count_type = type(words.word());
      if (is_real(property.count_type)) refuse("", "a list whose length is no whole number", "uchar, int or another whole type");
      word = words.word();
    }
    property.type = type(word);
    property.name = words.word();
    if (property.name.empty()) refuse("", "a property without a name", "property TYPE NAME");
    header_.elements.back().properties.push_back(std::move(property));
  }

  std::string_view bytes_;
  const std::string& file_;
  size_t at_ = 0;
  int line_ = 0;
  bool crlf_ = false;
  PlyHeader header_{};
};

}  // namespace

size_t bytes_of(PlyType type) {
  static constexpr std::array<size_t, 8> kBytes = {1, 1, 2, 2, 4, 4, 4, 8};
  return kBytes[static_cast<size_t>(type)];
}

size_t PlyElement::least_bytes() const {
  size_t sum = 0;
  for (const PlyProperty& property : properties) sum += bytes_of(property.is_list ? property.count_type : property.type);
  return sum;
}

PlyHeader read_ply_header(std::string_view bytes, const std::string& file) { return HeaderReader(bytes, file).run(); }

}  // namespace limn
