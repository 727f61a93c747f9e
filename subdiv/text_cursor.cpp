#include "subdiv/text_cursor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace limn {
namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

void append_utf8(std::string& text, std::uint32_t code) {
  const auto put = [&text](std::uint32_t byte) { text.push_back(static_cast<char>(byte)); };
  if (code < 0x80) return put(code);
  if (code < 0x800) {
    put(0xC0 | code >> 6);
  } else if (code < 0x10000) {
    put(0xE0 | code >> 12);
    put(0x80 | (code >> 6 & 0x3F));
  } else {
    put(0xF0 | code >> 18);
    put(0x80 | (code >> 12 & 0x3F));
    put(0x80 | (code >> 6 & 0x3F));
  }
  put(0x80 | (code & 0x3F));
}

std::string utf8_from_utf16(std::string_view bytes, bool big_endian) {
  const auto unit = [&](size_t i) {
    const auto a = static_cast<unsigned char>(bytes[i]), b = static_cast<unsigned char>(bytes[i + 1]);
    return static_cast<std::uint32_t>(big_endian ? a << 8 | b : b << 8 | a);
  };
  std::string text;
  for (size_t i = 0; i + 1 < bytes.size(); i += 2) {
    std::uint32_t code = unit(i);
    if (code >= 0xD800 && code < 0xDC00 && i + 3 < bytes.size()) {
      const std::uint32_t second = unit(i + 2);
      if (second >= 0xDC00 && second < 0xE000) code = 0x10000 + ((code - 0xD800) << 10) + (second - 0xDC00), i += 2;
    }
    append_utf8(text, code);
  }
  return text;
}

}  // namespace

std::string_view TextCursor::rest_of_line() {
  const char* first = at_;
  while (at_ != end_ && !is_line_end(*at_)) ++at_;
  const char* last = at_;
  while (first != last && is_blank(*first)) ++first;
  while (last != first && is_blank(last[-1])) --last;
  return {first, static_cast<size_t>(last - first)};
}

bool read_real(TextCursor& cursor, double& value) {
  if (!cursor.skip()) return false;
  if (cursor.number(value)) return true;
  // Too large or too small, or no number at all: strtod tells them apart, and seldom has to.
  TextCursor ahead = cursor;
  const std::string word(ahead.word());
  char* end = nullptr;
  const double found = std::strtod(word.c_str(), &end);
  const bool decimal = word.find_first_not_of("+-.0123456789eE") == std::string::npos;
  if (end != word.c_str() + word.size() || !decimal || std::abs(found) > 1.0) return false;
  value = found;
  cursor = ahead;
  return true;
}

std::int64_t line_of(std::string_view text, const char* at) {
  std::int64_t line = 1;
  for (const char* c = text.data(); c != at; ++c) line += *c == '\n' || (*c == '\r' && (c + 1 == at || c[1] != '\n'));
  return line;
}

std::string place_in(const std::string& file, std::string_view text, const char* at) {
  return fmt::format("{}:{}", file, line_of(text, at));
}

std::string shown_word(std::string_view word) {
  std::string text(word.substr(0, 40));
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return text + (word.size() > 40 ? "..." : "");
}

std::string_view plain_text(std::string_view bytes, std::string& converted) {
  if (bytes.starts_with("\xFF\xFE") || bytes.starts_with("\xFE\xFF")) {
    converted = utf8_from_utf16(bytes.substr(2), bytes.front() == '\xFE');
    bytes = converted;
  } else if (bytes.starts_with("\xEF\xBB\xBF")) {
    bytes.remove_prefix(3);
  }
  while (!bytes.empty() && bytes.back() == '\0') bytes.remove_suffix(1);
  return bytes;
}

bool same_word(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return lower(x) == lower(y); });
}

}  // namespace limn
