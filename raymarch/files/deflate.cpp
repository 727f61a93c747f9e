#include "raymarch/files/deflate.h"

#include <isa-l/igzip_lib.h>

#include <array>
#include <limits>

#include "sdf/error.h"

namespace limn {

struct Deflater::State {
  isal_zstream stream{};
  std::array<std::uint8_t, ISAL_DEF_LVL1_SMALL> tables{};  // more of them gain nothing on pictures
};

Deflater::Deflater() : state_(std::make_unique<State>()) {}
Deflater::~Deflater() = default;

std::span<const std::uint8_t> Deflater::compress(std::span<const std::uint8_t> bytes, DeflatePart part) {
  LIMN_CHECK(bytes.size() < std::numeric_limits<std::uint32_t>::max() / 2);
  // Bytes that cannot be compressed are stored, in pieces with headers of a few bytes.
  constexpr size_t kAround = 1024, kLargestShare = 16;
  compressed_.resize(bytes.size() + bytes.size() / kLargestShare + kAround);
  isal_zstream& stream = state_->stream;
  isal_deflate_init(&stream);
  stream.level = 1;
  stream.level_buf = state_->tables.data();
  stream.level_buf_size = static_cast<std::uint32_t>(state_->tables.size());
  stream.gzip_flag = part == DeflatePart::whole_stream ? IGZIP_ZLIB : IGZIP_DEFLATE;
  stream.flush = part == DeflatePart::inner ? SYNC_FLUSH : NO_FLUSH;
  stream.end_of_stream = part == DeflatePart::inner ? 0 : 1;
  stream.next_in = const_cast<std::uint8_t*>(bytes.data());  // the library reads it only
  stream.avail_in = static_cast<std::uint32_t>(bytes.size());
  stream.next_out = compressed_.data();
  stream.avail_out = static_cast<std::uint32_t>(compressed_.size());
  // Room left tells that nothing is waiting to be written.
  if (isal_deflate(&stream) != COMP_OK || stream.avail_in != 0 || stream.avail_out == 0)
    throw MachineError("cannot compress a picture: ISA-L gave up");
  return {compressed_.data(), stream.total_out};
}

std::uint32_t adler32_of(std::span<const std::uint8_t> bytes) { return isal_adler32(1, bytes.data(), bytes.size()); }

}  // namespace limn
