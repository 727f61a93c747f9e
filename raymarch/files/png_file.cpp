#include "raymarch/files/png_file.h"

#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <numeric>

#include "raymarch/files/deflate.h"
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

/// PNG's filters 0, 1 and 2: a row itself, less the pixel to the left, less the row above.
constexpr size_t kFilters = 3;

size_t cost_of(std::span<const std::uint8_t> row) {
  // The usual heuristic (PNG specification, 12.8): the least sum of the bytes as signed numbers.
  return std::transform_reduce(row.begin(), row.end(), std::uint32_t{0}, std::plus<>(),
                               [](std::uint8_t byte) -> std::uint32_t { return byte < 128 ? byte : 256u - byte; });
}

/// A row by each filter.
using TriedRows = std::array<std::vector<std::uint8_t>, kFilters>;

/// The row whose filtered bytes are the smallest, its filter before it. Average and Paeth gain nothing on flat and shaded surfaces, and
/// take as long again.
void filter_row(const PngPicture& picture, int row, TriedRows& tried, std::uint8_t* to) {
  const size_t count = static_cast<size_t>(picture.width) * static_cast<size_t>(picture.channels);
  const size_t left = static_cast<size_t>(picture.channels);
  const std::uint8_t* const bytes = picture.pixels.data() + static_cast<size_t>(row) * count;
  // As most rows of background are, empty or the same as the row above: no other filter leaves less than nothing, and what is found first
  // stays. A row is empty where each byte is the one before it, and the first is nought.
  const bool is_empty = bytes[0] == 0 && std::memcmp(bytes, bytes + 1, count - 1) == 0;
  if (is_empty || (row > 0 && std::memcmp(bytes, bytes - count, count) == 0)) {
    *to = is_empty ? 0 : 2;
    std::fill_n(to + 1, count, std::uint8_t{0});
    return;
  }
  // By pointers: bytes may alias what a vector keeps of itself, and then nothing is vectorised.
  std::uint8_t *const plain = tried[0].data(), *const beside = tried[1].data(), *const below = tried[2].data();
  std::copy_n(bytes, count, plain);
  std::copy_n(bytes, left, beside);
  for (size_t i = left; i < count; ++i) beside[i] = static_cast<std::uint8_t>(bytes[i] - bytes[i - left]);
  if (row == 0) {
    std::copy_n(bytes, count, below);
  } else {
    const std::uint8_t* const above = bytes - count;
    for (size_t i = 0; i < count; ++i) below[i] = static_cast<std::uint8_t>(bytes[i] - above[i]);
  }
  size_t best = 0, least = cost_of(tried[0]);
  for (size_t filter = 1; filter < kFilters; ++filter) {
    const size_t cost = cost_of(tried[filter]);
    if (cost >= least) continue;
    least = cost;
    best = filter;
  }
  *to = static_cast<std::uint8_t>(best);
  std::copy(tried[best].begin(), tried[best].end(), to + 1);
}

/// What one thread needs to filter and compress block after block.
class Compressor {
 public:
  Compressor(const PngPicture& picture, int block_rows) : picture_(picture), row_bytes_(row_bytes(picture)) {
    for (std::vector<std::uint8_t>& row : tried_) row.resize(row_bytes_ - 1);
    filtered_.resize(static_cast<size_t>(block_rows) * row_bytes_);
  }

  static size_t row_bytes(const PngPicture& picture) {
    return static_cast<size_t>(picture.width) * static_cast<size_t>(picture.channels) + 1;
  }

  void compress(Block& block, bool last) {
    for (int row = block.first_row; row < block.last_row; ++row)
      filter_row(picture_, row, tried_, &filtered_[static_cast<size_t>(row - block.first_row) * row_bytes_]);
    const std::span filtered(filtered_.data(), static_cast<size_t>(block.last_row - block.first_row) * row_bytes_);
    block.filtered_bytes = filtered.size();
    block.checksum = adler32_of(filtered);
    const std::span compressed = deflater_.compress(filtered, last ? DeflatePart::last : DeflatePart::inner);
    block.compressed.assign(compressed.begin(), compressed.end());
  }

 private:
  const PngPicture& picture_;
  size_t row_bytes_ = 0;
  Deflater deflater_{};
  TriedRows tried_{};
  std::vector<std::uint8_t> filtered_{};
};

std::vector<Block> compressed_blocks(const PngPicture& picture) {
  const int rows = static_cast<int>(std::max<size_t>(1, kBlockBytes / Compressor::row_bytes(picture)));
  std::vector<Block> blocks;
  for (int row = 0; row < picture.height; row += rows) blocks.push_back({row, std::min(row + rows, picture.height)});
  parallel_parts(blocks.size(), size_t{1}, [&](const IndexRange<size_t>& part) {
    Compressor compressor(picture, std::min(rows, picture.height));
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
