#include "raymarch/files/png_file.h"

#include <png.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <numeric>

#include "sdf/error.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

/// Of rows before they are compressed: enough of them that a block's end costs nothing, few enough that all threads have some.
constexpr size_t kBlockBytes = size_t{1} << 18;

struct Block {
  int first_row = 0, last_row = 0;
  std::vector<std::uint8_t> compressed{};
  uLong checksum = 0;  // Adler-32 of the filtered rows
  uLong filtered_bytes = 0;
};

/// PNG's filters 0, 1 and 2: a row itself, less the pixel to the left, less the row above.
constexpr size_t kFilters = 3;

size_t cost_of(std::span<const std::uint8_t> row) {
  // The usual heuristic (PNG specification, 12.8): the least sum of the bytes as signed numbers.
  return std::transform_reduce(row.begin(), row.end(), std::uint32_t{0}, std::plus<>(),
                               [](std::uint8_t byte) -> std::uint32_t { return byte < 128 ? byte : 256u - byte; });
}

/// The row whose filtered bytes are the smallest, its filter before it. Average and Paeth gain nothing on flat and shaded surfaces, and
/// take as long again.
void filter_row(const PngPicture& picture, int row, std::array<std::vector<std::uint8_t>, kFilters>& tried, std::uint8_t* to) {
  const size_t count = static_cast<size_t>(picture.width) * static_cast<size_t>(picture.channels);
  const size_t left = static_cast<size_t>(picture.channels);
  const std::uint8_t* const bytes = picture.pixels.data() + static_cast<size_t>(row) * count;
  const auto is_zero = [](std::uint8_t byte) { return byte == 0; };
  // As most rows of background are: no other filter leaves less than nothing, and what is found first stays.
  if (row > 0 && std::memcmp(bytes, bytes - count, count) == 0 && !std::all_of(bytes, bytes + count, is_zero)) {
    *to = 2;
    std::fill_n(to + 1, count, std::uint8_t{0});
    return;
  }
  std::copy_n(bytes, count, tried[0].begin());
  std::copy_n(bytes, left, tried[1].begin());
  for (size_t i = left; i < count; ++i) tried[1][i] = static_cast<std::uint8_t>(bytes[i] - bytes[i - left]);
  if (row == 0) {
    tried[2] = tried[0];
  } else {
    const std::uint8_t* const above = bytes - count;
    for (size_t i = 0; i < count; ++i) tried[2][i] = static_cast<std::uint8_t>(bytes[i] - above[i]);
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

std::vector<std::uint8_t> filtered_rows(const PngPicture& picture, int first, int last) {
  const size_t count = static_cast<size_t>(picture.width) * static_cast<size_t>(picture.channels);
  std::vector<std::uint8_t> rows(static_cast<size_t>(last - first) * (count + 1));
  std::array<std::vector<std::uint8_t>, kFilters> tried;
  for (std::vector<std::uint8_t>& row : tried) row.resize(count);
  for (int row = first; row < last; ++row) filter_row(picture, row, tried, &rows[static_cast<size_t>(row - first) * (count + 1)]);
  return rows;
}

/// One part of a raw deflate stream that ends at a byte. Only runs are looked for, which a filtered picture is full of: on pictures of
/// surfaces smaller than zlib's level 3, in half its time. A run never reaches back over a block's beginning, so that blocks need nothing
/// of each other.
void compress(Block& block, std::span<const std::uint8_t> rows, bool last) {
  block.filtered_bytes = rows.size();
  block.checksum = adler32(adler32(0, nullptr, 0), rows.data(), static_cast<uInt>(rows.size()));
  z_stream stream{};
  constexpr int kRawWindow = -15, kMemory = 9;
  if (deflateInit2(&stream, 6, Z_DEFLATED, kRawWindow, kMemory, Z_RLE) != Z_OK) throw MachineError("cannot write a PNG: zlib gave up");
  constexpr size_t kEnd = 16;  // of a block that is flushed
  block.compressed.resize(deflateBound(&stream, static_cast<uLong>(rows.size())) + kEnd);
  stream.next_in = const_cast<Bytef*>(rows.data());  // zlib does not write there
  stream.avail_in = static_cast<uInt>(rows.size());
  stream.next_out = block.compressed.data();
  stream.avail_out = static_cast<uInt>(block.compressed.size());
  const int result = deflate(&stream, last ? Z_FINISH : Z_SYNC_FLUSH);
  block.compressed.resize(block.compressed.size() - stream.avail_out);
  const bool all = stream.avail_in == 0 && result == (last ? Z_STREAM_END : Z_OK);
  deflateEnd(&stream);
  if (!all) throw MachineError("cannot write a PNG: zlib gave up");
}

std::vector<Block> compressed_blocks(const PngPicture& picture) {
  const size_t row_bytes = static_cast<size_t>(picture.width) * static_cast<size_t>(picture.channels) + 1;
  const int rows = static_cast<int>(std::max<size_t>(1, kBlockBytes / row_bytes));
  std::vector<Block> blocks;
  for (int row = 0; row < picture.height; row += rows) blocks.push_back({row, std::min(row + rows, picture.height)});
  parallel_for(size_t{0}, blocks.size(), [&](size_t i) {
    Block& block = blocks[i];
    compress(block, filtered_rows(picture, block.first_row, block.last_row), i + 1 == blocks.size());
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
  uLong checksum = adler32(0, nullptr, 0);
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
