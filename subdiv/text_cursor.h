#pragma once
// Text as the mesh formats hold it: words between white space, comments from '#' to the end of the line, numbers as std::from_chars reads
// them. Errors are located by counting lines when one is reported, so that reading itself counts nothing.

#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>

namespace limn {

/// White space within a line.
inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
inline bool is_line_end(char c) { return c == '\n' || c == '\r'; }
inline bool is_space(char c) { return is_blank(c) || is_line_end(c); }

/// For formats without comments: a line's end is no word anyway.
inline constexpr char kNoComments = '\n';

class TextCursor {
 public:
  explicit TextCursor(std::string_view text, char comment = '#') : at_(text.data()), end_(text.data() + text.size()), comment_(comment) {}

  const char* at() const { return at_; }
  size_t left() const { return static_cast<size_t>(end_ - at_); }
  /// Over white space, line ends and comments to the next word; false where none is left.
  bool skip() {
    if (skip_in_line()) return true;
    while (at_ != end_) {
      ++at_;  // the line end that stopped it
      if (skip_in_line()) return true;
    }
    return false;
  }
  /// Over white space and a comment to the next word of this line; false at its end.
  bool skip_in_line() {
    while (at_ != end_ && is_blank(*at_)) ++at_;
    if (at_ != end_ && *at_ == comment_)
      while (at_ != end_ && !is_line_end(*at_)) ++at_;
    return at_ != end_ && !is_line_end(*at_);
  }
  /// The next word, which the cursor moves past; empty where none is left.
  std::string_view word() { return skip() ? take_word() : std::string_view(); }
  std::string_view word_in_line() { return skip_in_line() ? take_word() : std::string_view(); }
  /// What is left of the line without white space around it; a '#' in it is no comment, since names may hold one.
  std::string_view rest_of_line();
  /// The next word as a number; false, and nothing taken, where it is none. `stop` is a character that may end it besides white space.
  template <class T>
  bool number(T& value, char stop = ' ') {
    const char* first = at_;
    if (first != end_ && *first == '+' && first + 1 != end_ && first[1] != '-') ++first;
    const std::from_chars_result result = std::from_chars(first, end_, value);
    if (result.ec != std::errc() || !(result.ptr == end_ || ends_word(*result.ptr) || *result.ptr == stop)) return false;
    at_ = result.ptr;
    return true;
  }
  /// Moves past one character.
  void step() { ++at_; }
  /// A comment may begin right behind a word.
  bool ends_word(char c) const { return is_space(c) || c == comment_; }
  bool is_at(char c) const { return at_ != end_ && *at_ == c; }

 private:
  std::string_view take_word() {
    const char* first = at_;
    while (at_ != end_ && !ends_word(*at_)) ++at_;
    return {first, static_cast<size_t>(at_ - first)};
  }
  const char* at_;
  const char* end_;
  char comment_;
};

/// The next word as a real number: beyond from_chars it takes what is too small for double precision as 0.
bool read_real(TextCursor& cursor, double& value);

/// Number of the line that `at` is in, from 1.
std::int64_t line_of(std::string_view text, const char* at);

/// "FILE:LINE", the place of an error.
std::string place_in(const std::string& file, std::string_view text, const char* at);

/// At most 40 characters of it, printable, for a message.
std::string shown_word(std::string_view word);

/// The text of a file: without byte order mark and without the zero bytes that some programs pad with; UTF-16 (by its mark) as UTF-8 in
/// `converted`, whose view is returned then.
std::string_view plain_text(std::string_view bytes, std::string& converted);

/// Letters of either case are the same.
bool same_word(std::string_view a, std::string_view b);

}  // namespace limn
