#include "raymarch/files/deflate.h"

#include <isa-l/igzip_lib.h>
#include <zlib.h>

#include <limits>
#include <string>

#include "sdf/error.h"

namespace limn {
namespace {

[[noreturn]] void give_up(const char* library) { throw MachineError(std::string("cannot compress a picture: ") + library + " gave up"); }

}  // namespace

struct Deflater::State {
  isal_zstream stream{};
  isal_huff_histogram histogram{};
  isal_hufftables codes{};
};

Deflater::Deflater() : state_(std::make_unique<State>()) {}
Deflater::~Deflater() = default;

std::span<const std::uint8_t> Deflater::compress(std::span<const std::uint8_t> bytes, DeflatePart part) {
  LIMN_CHECK(bytes.size() < std::numeric_limits<std::uint32_t>::max() / 4);
  // The codes are made for these bytes, so that noise grows by little; beside them come a table of codes and a checksum.
  constexpr size_t kAround = 1024, kLargestShare = 8;
  compressed_.resize(bytes.size() + bytes.size() / kLargestShare + kAround);
  auto* const from = const_cast<std::uint8_t*>(bytes.data());  // the library reads it only
  state_->histogram = {};
  isal_update_histogram(from, static_cast<int>(bytes.size()), &state_->histogram);
  isal_zstream& stream = state_->stream;
  isal_deflate_init(&stream);
  if (isal_create_hufftables(&state_->codes, &state_->histogram) != 0 ||
      isal_deflate_set_hufftables(&stream, &state_->codes, IGZIP_HUFFTABLE_CUSTOM) != COMP_OK)
    give_up("ISA-L");
  stream.level = 0;
  stream.gzip_flag = part == DeflatePart::whole_stream ? IGZIP_ZLIB : IGZIP_DEFLATE;
  stream.flush = part == DeflatePart::inner ? SYNC_FLUSH : NO_FLUSH;
  stream.end_of_stream = part == DeflatePart::inner ? 0 : 1;
  stream.next_in = from;
  stream.avail_in = static_cast<std::uint32_t>(bytes.size());
  stream.next_out = compressed_.data();
  stream.avail_out = static_cast<std::uint32_t>(compressed_.size());
  // Room left tells that nothing is waiting to be written.
  if (isal_deflate(&stream) != COMP_OK || stream.avail_in != 0 || stream.avail_out == 0) give_up("ISA-L");
  return {compressed_.data(), stream.total_out};
}

std::vector<std::uint8_t> compress_runs(std::span<const std::uint8_t> bytes) {
  constexpr int kLevel = 6, kRawWindow = -15, kMemory = 9;
  constexpr size_t kFlush = 16;
  z_stream stream{};
  if (deflateInit2(&stream, kLevel, Z_DEFLATED, kRawWindow, kMemory, Z_RLE) != Z_OK) give_up("zlib");
  const std::unique_ptr<z_stream, decltype(&deflateEnd)> ending(&stream, deflateEnd);
  std::vector<std::uint8_t> compressed(deflateBound(&stream, static_cast<uLong>(bytes.size())) + kFlush);
  stream.next_in = const_cast<std::uint8_t*>(bytes.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = compressed.data();
  stream.avail_out = static_cast<uInt>(compressed.size());
  if (deflate(&stream, Z_SYNC_FLUSH) != Z_OK || stream.avail_in != 0 || stream.avail_out == 0) give_up("zlib");
  compressed.resize(stream.total_out);
  return compressed;
}

std::uint32_t adler32_of(std::span<const std::uint8_t> bytes) { return isal_adler32(1, bytes.data(), bytes.size()); }

}  // namespace limn
