#include "raymarch/files/deflate.h"

#include <isa-l/igzip_lib.h>
#include <zlib.h>

#include <limits>
#include <optional>
#include <string>

#include "sdf/error.h"

namespace limn {
namespace {

[[noreturn]] void give_up(const char* library) { throw MachineError(std::string("cannot compress a picture: ") + library + " gave up"); }

/// Raw parts, or streams of their own. zlib's tables take a quarter of a megabyte, which the system clears: made where there are runs.
class RunCoder {
 public:
  explicit RunCoder(bool wrapped) {
    constexpr int kLevel = 6, kWindowBits = 15, kMemory = 9;
    if (deflateInit2(&stream_, kLevel, Z_DEFLATED, wrapped ? kWindowBits : -kWindowBits, kMemory, Z_RLE) != Z_OK) give_up("zlib");
  }
  ~RunCoder() { deflateEnd(&stream_); }
  RunCoder(const RunCoder&) = delete;
  RunCoder& operator=(const RunCoder&) = delete;

  void compress(std::span<const std::uint8_t> bytes, bool last, std::vector<std::uint8_t>& to) {
    constexpr size_t kFlush = 16;
    if (deflateReset(&stream_) != Z_OK) give_up("zlib");
    to.resize(deflateBound(&stream_, static_cast<uLong>(bytes.size())) + kFlush);
    stream_.next_in = const_cast<std::uint8_t*>(bytes.data());
    stream_.avail_in = static_cast<uInt>(bytes.size());
    stream_.next_out = to.data();
    stream_.avail_out = static_cast<uInt>(to.size());
    const int result = deflate(&stream_, last ? Z_FINISH : Z_SYNC_FLUSH);
    if (stream_.avail_in != 0 || result != (last ? Z_STREAM_END : Z_OK)) give_up("zlib");
    to.resize(stream_.total_out);
  }

 private:
  z_stream stream_{};
};

}  // namespace

struct Deflater::State {
  isal_zstream stream{};
  isal_huff_histogram histogram{};
  isal_hufftables codes{};
  std::optional<RunCoder> raw_runs{}, wrapped_runs{};
};

Deflater::Deflater() : state_(std::make_unique<State>()) {}
Deflater::~Deflater() = default;

std::span<const std::uint8_t> Deflater::compress(std::span<const std::uint8_t> bytes, DeflatePart part, DeflateContent content) {
  LIMN_CHECK(bytes.size() < std::numeric_limits<std::uint32_t>::max() / 4);
  return content == DeflateContent::runs ? compress_runs(bytes, part) : compress_mixed(bytes, part);
}

std::span<const std::uint8_t> Deflater::compress_runs(std::span<const std::uint8_t> bytes, DeflatePart part) {
  const bool wrapped = part == DeflatePart::whole_stream;
  std::optional<RunCoder>& coder = wrapped ? state_->wrapped_runs : state_->raw_runs;
  if (!coder) coder.emplace(wrapped);
  coder->compress(bytes, part != DeflatePart::inner, compressed_);
  return compressed_;
}

std::span<const std::uint8_t> Deflater::compress_mixed(std::span<const std::uint8_t> bytes, DeflatePart part) {
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

std::uint32_t adler32_of(std::span<const std::uint8_t> bytes) { return isal_adler32(1, bytes.data(), bytes.size()); }

}  // namespace limn
