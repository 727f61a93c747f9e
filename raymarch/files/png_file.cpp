#include "raymarch/files/png_file.h"

#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>

#include "raymarch/files/deflate.h"
#include "raymarch/files/png_filter.h"
#include "sdf/error.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

/// Of rows before they are compressed: enough of them that a block's end costs nothing, few enough that all threads have some.
constexpr size_t kBlockBytes = size_t{1} << 18;

struct Block {
  int first_row = 0, last_row = 0;
  std::vector<std::uint8_t> compressed{};
  std::uint32_t checksum = 0;  // Adler-32 of the filtered rows
  size_t filtered_bytes = 0;
};

/// Blocks of a background, of which most pictures have many: all rows are empty, by the same filter. Compressed once for a picture.
class EmptyBlocks {
 public:
  EmptyBlocks(int rows, size_t row_bytes) : rows_(rows), row_bytes_(row_bytes) {}

  /// Of a block in the middle of the stream, of as many rows as all but the last have; null where there is none such.
  const Block* of(const Block& block, bool last, const std::uint8_t* filtered, int empty_rows) {
    if (last || empty_rows != rows_ || block.last_row - block.first_row != rows_) return nullptr;
    for (int row = 1; row < rows_; ++row)
      if (filtered[static_cast<size_t>(row) * row_bytes_] != filtered[0]) return nullptr;
    Made& made = made_[filtered[0] == 0 ? 0 : 1];
    std::call_once(made.once, [&] {
      const std::span bytes(filtered, static_cast<size_t>(rows_) * row_bytes_);
      made.block = {0, rows_, compress_runs(bytes), adler32_of(bytes), bytes.size()};
    });
    return &made.block;
  }

 private:
  struct Made {
    std::once_flag once{};
    Block block{};
  };
  int rows_ = 0;
  size_t row_bytes_ = 0;
  std::array<Made, 2> made_{};  // by filter 0, by filter 2
};

/// What one thread needs to filter and compress block after block.
class Compressor {
 public:
  Compressor(const PngPicture& picture, int block_rows, EmptyBlocks& empty_blocks)
      : picture_(picture), row_bytes_(row_bytes(picture)), empty_blocks_(empty_blocks) {
    filtered_.resize(static_cast<size_t>(block_rows) * row_bytes_);
  }

  static size_t row_bytes(const PngPicture& picture) {
    return static_cast<size_t>(picture.width) * static_cast<size_t>(picture.channels) + 1;
  }

  void compress(Block& block, bool last) {
    const size_t count = row_bytes_ - 1;
    int empty_rows = 0;
    for (int row = block.first_row; row < block.last_row; ++row) {
      const std::uint8_t* const bytes = picture_.pixels.data() + static_cast<size_t>(row) * count;
      empty_rows += filter_png_row({bytes, count}, row > 0 ? bytes - count : nullptr, static_cast<size_t>(picture_.channels),
                                   &filtered_[static_cast<size_t>(row - block.first_row) * row_bytes_]);
    }
    if (const Block* const empty = empty_blocks_.of(block, last, filtered_.data(), empty_rows)) {
      block.compressed = empty->compressed;
      block.checksum = empty->checksum;
      block.filtered_bytes = empty->filtered_bytes;
      return;
    }
    const std::span filtered(filtered_.data(), static_cast<size_t>(block.last_row - block.first_row) * row_bytes_);
    const std::span compressed = deflater_.compress(filtered, last ? DeflatePart::last : DeflatePart::inner);
    block.compressed.assign(compressed.begin(), compressed.end());
    block.checksum = adler32_of(filtered);
    block.filtered_bytes = filtered.size();
  }

 private:
  const PngPicture& picture_;
  size_t row_bytes_ = 0;
  EmptyBlocks& empty_blocks_;
  Deflater deflater_{};
  std::vector<std::uint8_t> filtered_{};
};

std::vector<Block> compressed_blocks(const PngPicture& picture) {
  const size_t row_bytes = Compressor::row_bytes(picture);
  const int rows = static_cast<int>(std::max<size_t>(1, kBlockBytes / row_bytes));
  std::vector<Block> blocks;
  for (int row = 0; row < picture.height; row += rows) blocks.push_back({row, std::min(row + rows, picture.height)});
  EmptyBlocks empty_blocks(rows, row_bytes);
  parallel_parts(blocks.size(), size_t{1}, [&](const IndexRange<size_t>& part) {
    Compressor compressor(picture, std::min(rows, picture.height), empty_blocks);
    for (size_t i = part.first; i < part.last; ++i) compressor.compress(blocks[i], i + 1 == blocks.size());
  });
  return blocks;
}

/// What libpng writes into.
struct Sink {
  std::vector<std::byte> bytes{};
  std::string problem{};
};

void append(png_structp png, png_bytep data, size_t count) {
  auto& bytes = static_cast<Sink*>(png_get_io_ptr(png))->bytes;
  const auto* first = reinterpret_cast<const std::byte*>(data);
  bytes.insert(bytes.end(), first, first + count);
}
void flush(png_structp) {}

[[noreturn]] void fail(png_structp, png_const_charp message) { throw MachineError(std::string("cannot write a PNG: ") + message); }
void ignore(png_structp, png_const_charp) {}

void write_chunk(png_structp png, const char* name, std::span<const std::uint8_t> data) {
  png_write_chunk(png, reinterpret_cast<png_const_bytep>(name), data.data(), data.size());
}

void write_header(png_structp png, png_infop info, const PngPicture& picture) {
  png_set_IHDR(png, info, static_cast<png_uint_32>(picture.width), static_cast<png_uint_32>(picture.height), 8,
               picture.channels == 4 ? PNG_COLOR_TYPE_RGB_ALPHA : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_BASE,
               PNG_FILTER_TYPE_BASE);
  png_set_sRGB_gAMA_and_cHRM(png, info, PNG_sRGB_INTENT_ABSOLUTE);
  std::string key = "Software", text = picture.software;
  png_text about{};
  about.compression = PNG_TEXT_COMPRESSION_NONE;
  about.key = key.data();
  about.text = text.data();
  about.text_length = text.size();
  png_set_text(png, info, &about, 1);
  png_write_info(png, info);
}

/// The blocks as one zlib stream (RFC 1950): its two bytes, the blocks, their checksum.
void write_blocks(png_structp png, std::vector<Block>& blocks) {
  constexpr std::array<std::uint8_t, 2> kZlibHeader = {0x78, 0x9c};
  blocks.front().compressed.insert(blocks.front().compressed.begin(), kZlibHeader.begin(), kZlibHeader.end());
  uLong checksum = adler32_of({});
  for (const Block& block : blocks) checksum = adler32_combine(checksum, block.checksum, static_cast<z_off_t>(block.filtered_bytes));
  for (const int shift : {24, 16, 8, 0}) blocks.back().compressed.push_back(static_cast<std::uint8_t>(checksum >> shift & 0xff));
  for (const Block& block : blocks) write_chunk(png, "IDAT", block.compressed);
}

}  // namespace

std::vector<std::byte> png_file(const PngPicture& picture) {
  LIMN_CHECK(picture.width > 0 && picture.height > 0 && (picture.channels == 3 || picture.channels == 4));
  LIMN_CHECK(picture.pixels.size() ==
             static_cast<size_t>(picture.width) * static_cast<size_t>(picture.height) * static_cast<size_t>(picture.channels));
  std::vector<Block> blocks = compressed_blocks(picture);
  Sink sink;
  // libpng calls fail(), which throws through it: it holds nothing but what is destroyed here.
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail, ignore);
  if (png == nullptr) throw MachineError("cannot write a PNG: out of memory");
  png_infop info = png_create_info_struct(png);
  const auto destroy = [&](png_structp made) { png_destroy_write_struct(&made, &info); };
  const std::unique_ptr<png_struct, decltype(destroy)> owner(png, destroy);
  if (info == nullptr) throw MachineError("cannot write a PNG: out of memory");
  png_set_write_fn(png, &sink, append, flush);
  write_header(png, info, picture);
  write_blocks(png, blocks);
  write_chunk(png, "IEND", {});
  return std::move(sink.bytes);
}

}  // namespace limn
