#include "samples/page/glyphs.h"

#include <ft2build.h>

#include FT_FREETYPE_H

#include <map>
#include <memory>
#include <mutex>

#include "samples/spec/utf8.h"

namespace limn {
namespace {

/// A font at one size. Null where it cannot be read.
class Face {
 public:
  Face(FT_Library library, const std::string& file, int size_px) {
    if (library == nullptr || FT_New_Face(library, file.c_str(), 0, &face_) != 0) face_ = nullptr;
    if (face_ != nullptr && FT_Set_Pixel_Sizes(face_, 0, static_cast<FT_UInt>(size_px)) != 0) {
      FT_Done_Face(face_);
      face_ = nullptr;
    }
  }
  ~Face() {
    if (face_ != nullptr) FT_Done_Face(face_);
  }
  Face(const Face&) = delete;
  Face& operator=(const Face&) = delete;

  bool usable() const { return face_ != nullptr; }

  const Glyph& of(char32_t letter) {
    const auto [found, is_new] = glyphs_.try_emplace(letter);
    if (is_new) found->second = drawn(letter);
    return found->second;
  }

 private:
  /// Empty where the font fails.
  Glyph drawn(char32_t letter) {
    if (FT_Load_Char(face_, letter, FT_LOAD_RENDER) != 0) return {};
    const FT_GlyphSlot slot = face_->glyph;
    const FT_Bitmap& bitmap = slot->bitmap;
    constexpr int kFraction = 64;  // FreeType's units of a pixel
    Glyph glyph{slot->bitmap_left,
                slot->bitmap_top,
                static_cast<int>(bitmap.width),
                static_cast<int>(bitmap.rows),
                static_cast<int>(slot->advance.x / kFraction),
                {}};
    for (unsigned row = 0; row < bitmap.rows; ++row) {
      const unsigned char* const first = bitmap.buffer + static_cast<std::ptrdiff_t>(row) * bitmap.pitch;
      glyph.coverage.insert(glyph.coverage.end(), first, first + bitmap.width);
    }
    return glyph;
  }

  FT_Face face_ = nullptr;
  std::map<char32_t, Glyph> glyphs_{};  // nodes stay where they are
};

/// Of valid UTF-8.
std::u32string letters_of(const std::string& text) {
  std::u32string letters;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    constexpr unsigned kContinues = 0x80, kFirst = 0xc0, kBits = 6;
    if ((byte & kFirst) == kContinues) {
      letters.back() = letters.back() << kBits | (byte & 0x3fu);
    } else {
      letters.push_back(byte < kContinues ? byte : byte < 0xe0 ? byte & 0x1fu : byte < 0xf0 ? byte & 0x0fu : byte & 0x07u);
    }
  }
  return letters;
}

/// All fonts and sizes that were asked for.
struct Faces {
  FT_Library library = nullptr;
  std::map<std::pair<std::string, int>, std::unique_ptr<Face>> faces{};
  std::mutex mutex{};

  Faces() {
    if (FT_Init_FreeType(&library) != 0) library = nullptr;
  }
};

}  // namespace

std::vector<const Glyph*> glyphs_of(const std::string& text, const std::string& font_file, int size_px) {
  // Never destroyed: its letters may be in use when the program ends. Reading a font takes longer than a line of letters.
  static Faces* const all = new Faces;
  const std::lock_guard lock(all->mutex);
  std::unique_ptr<Face>& face = all->faces[{font_file, size_px}];
  if (face == nullptr) face = std::make_unique<Face>(all->library, font_file, size_px);
  std::vector<const Glyph*> glyphs;
  if (!face->usable()) return glyphs;
  for (const char32_t letter : letters_of(valid_utf8(text))) glyphs.push_back(&face->of(letter));
  return glyphs;
}

}  // namespace limn
