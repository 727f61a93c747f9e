#include "samples/page/html.h"

#include <fmt/format.h>

#include <cstddef>
#include <vector>

#include "raymarch/image_io.h"
#include "samples/spec/utf8.h"

namespace limn {
std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : valid_utf8(text)) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        // HTML and SVG allow no other control characters.
        out += static_cast<unsigned char>(c) < ' ' && c != '\n' && c != '\t' ? ' ' : c;
    }
  }
  return out;
}

std::string base64(std::string_view bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const auto at = [&](size_t k) { return i + k < bytes.size() ? static_cast<unsigned>(static_cast<unsigned char>(bytes[i + k])) : 0u; };
    const unsigned word = at(0) << 16 | at(1) << 8 | at(2);
    out += kDigits[word >> 18 & 63];
    out += kDigits[word >> 12 & 63];
    out += i + 1 < bytes.size() ? kDigits[word >> 6 & 63] : '=';
    out += i + 2 < bytes.size() ? kDigits[word & 63] : '=';
  }
  return out;
}

namespace {

template <class Color>
std::string image_tag(const Image<Color>& picture, const std::string& alternative, const char* attributes) {
  const std::vector<std::byte> png = encode_png(picture);
  return fmt::format("<img {}width=\"{}\" height=\"{}\" alt=\"{}\" src=\"data:image/png;base64,{}\">\n", attributes, picture.width,
                     picture.height, escaped(alternative), base64({reinterpret_cast<const char*>(png.data()), png.size()}));
}

}  // namespace

std::string picture_tag(const Image<glm::vec4>& picture, const std::string& alternative, const char* attributes) {
  return image_tag(picture, alternative, attributes);
}

std::string picture_tag(const Image<glm::u8vec4>& srgb, const std::string& alternative) { return image_tag(srgb, alternative, ""); }

}  // namespace limn
