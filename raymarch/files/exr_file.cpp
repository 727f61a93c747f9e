#include "raymarch/files/exr_file.h"

#include <fcntl.h>
#include <openexr.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <memory>
#include <span>
#include <system_error>

#include "raymarch/files/deflate.h"
#include "raymarch/files/exr_lanes.h"
#include "sdf/error.h"
#include "sdf/parallel.h"

namespace limn {
namespace {

static_assert(std::endian::native == std::endian::little, "EXR files are little-endian; numbers are copied as they are");

using Bytes = std::vector<std::uint8_t>;

constexpr size_t kShortName = 31;  // bytes; longer ones need a flag of the file

size_t bytes_of(ExrType type) { return type == ExrType::half ? 2 : 4; }

exr_pixel_type_t pixel_type(ExrType type) {
  return type == ExrType::half ? EXR_PIXEL_HALF : type == ExrType::full ? EXR_PIXEL_FLOAT : EXR_PIXEL_UINT;
}

/// A file that the library writes. It is written to by our own function, because the library's would say no more than "unable to open", and
/// its handler of errors may ask nothing of it without waiting for itself for ever (3.1.5).
class File {
 public:
  File(const std::filesystem::path& file, const std::string& name)
      : name_(name), handle_(::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)) {
    if (handle_ < 0) fail(std::generic_category().message(errno));
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.user_data = this;
    settings.write_fn = [](exr_const_context_t, void* self, const void* bytes, std::uint64_t count, std::uint64_t at,
                           exr_stream_error_func_ptr_t) { return static_cast<File*>(self)->write(bytes, count, at); };
    settings.error_handler_fn = [](exr_const_context_t, exr_result_t, const char*) {};  // said by check(), not on stderr
    try {
      check(exr_start_write(&context_, file.c_str(), EXR_WRITE_FILE_DIRECTLY, &settings));
    } catch (...) {
      ::close(handle_);
      throw;
    }
  }
  ~File() {
    if (context_ != nullptr) exr_finish(&context_);
    ::close(handle_);
  }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  exr_context_t context() const { return context_; }
  void check(exr_result_t result) const {
    if (result == EXR_ERR_SUCCESS) return;
    fail(error_ != 0 ? std::generic_category().message(error_) : exr_get_default_error_message(result));
  }
  /// The table of chunks is written.
  void finish() {
    const exr_result_t result = exr_finish(&context_);
    context_ = nullptr;
    check(error_ != 0 ? EXR_ERR_WRITE_IO : result);
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const { throw MachineError("cannot write " + name_ + ": " + problem); }

  /// -1 where the disk fails.
  std::int64_t write(const void* bytes, std::uint64_t count, std::uint64_t at) {
    for (std::uint64_t done = 0; done < count;) {
      const ssize_t written = ::pwrite(handle_, static_cast<const char*>(bytes) + done, count - done, static_cast<off_t>(at + done));
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) {
        if (error_ == 0) error_ = written < 0 ? errno : EIO;
        return -1;
      }
      done += static_cast<std::uint64_t>(written);
    }
    return static_cast<std::int64_t>(count);
  }

  std::string name_{};
  int handle_ = -1;
  int error_ = 0;  // errno of the first write that failed; 0: none
  exr_context_t context_ = nullptr;
};

void write_header(const File& file, const ExrPicture& picture, std::span<const ExrChannel* const> channels) {
  const exr_context_t context = file.context();
  const auto is_long = [](const auto& named) { return named.name.size() > kShortName; };
  const bool has_long = std::any_of(picture.channels.begin(), picture.channels.end(), is_long) ||
                        std::any_of(picture.attributes.begin(), picture.attributes.end(), is_long);
  file.check(exr_set_longname_support(context, has_long ? 1 : 0));
  int part = 0;
  file.check(exr_add_part(context, nullptr, EXR_STORAGE_SCANLINE, &part));
  file.check(exr_initialize_required_attr_simple(context, part, picture.width_px, picture.height_px, EXR_COMPRESSION_ZIP));
  for (const ExrChannel* channel : channels)
    file.check(exr_add_channel(context, part, channel->name.c_str(), pixel_type(channel->type), EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1));
  for (const ExrAttribute& attribute : picture.attributes) {
    if (const auto* text = std::get_if<std::string>(&attribute.value)) {
      file.check(exr_attr_set_string(context, part, attribute.name.c_str(), text->c_str()));
      continue;
    }
    exr_attr_m44f_t matrix;
    std::copy_n(std::get<1>(attribute.value).begin(), 16, matrix.m);
    file.check(exr_attr_set_m44f(context, part, attribute.name.c_str(), &matrix));
  }
  file.check(exr_write_header(context));
}

/// Of pixels of one channel, as they are read and as halves.
struct RowBuffer {
  std::vector<float> values{};
  std::vector<std::uint16_t> halves{};
};

/// Values of pixels [first, last) of one channel. Returns where they end.
std::uint8_t* put_values(const ExrChannel& channel, size_t first, size_t last, RowBuffer& row, std::uint8_t* to) {
  channel.read(first, last, row.values.data());
  const size_t count = last - first;
  if (channel.type == ExrType::half) {
    to_halves(row.values.data(), count, row.halves.data());
    std::memcpy(to, row.halves.data(), count * sizeof(std::uint16_t));
  } else if (channel.type == ExrType::full) {
    std::memcpy(to, row.values.data(), count * sizeof(float));
  } else {
    for (size_t i = 0; i < count; ++i) {
      const auto whole = static_cast<std::uint32_t>(row.values[i]);
      std::memcpy(to + 4 * i, &whole, sizeof whole);
    }
  }
  return to + count * bytes_of(channel.type);
}

std::uint8_t difference(std::uint8_t value, std::uint8_t before) {
  constexpr int kMiddle = 128;
  return static_cast<std::uint8_t>(value - before + kMiddle);
}

/// What one thread needs to make chunk after chunk.
class ChunkMaker {
 public:
  ChunkMaker(const ExrPicture& picture, std::span<const ExrChannel* const> channels)
      : channels_(channels), width_(static_cast<size_t>(picture.width_px)) {
    buffer_.values.resize(width_);
    buffer_.halves.resize(width_);
    size_t pixel_bytes = 0;
    for (const ExrChannel* channel : channels) pixel_bytes += bytes_of(channel->type);
    row_.resize(width_ * pixel_bytes);
  }

  /// Rows [first, last) as they are in the file: zipped, but where that does not make them smaller.
  Bytes make(size_t first, size_t last) {
    prepared_.resize(row_.size() * (last - first));
    prepare(first, last);
    const std::span zipped = deflater_.compress(prepared_, DeflatePart::whole_stream);
    if (zipped.size() < prepared_.size()) return {zipped.begin(), zipped.end()};
    Bytes plain;
    for (size_t row = first; row < last; ++row) {
      read_row(row);
      plain.insert(plain.end(), row_.begin(), row_.end());
    }
    return plain;
  }

 private:
  void read_row(size_t row) {
    std::uint8_t* at = row_.data();
    for (const ExrChannel* channel : channels_) at = put_values(*channel, row * width_, (row + 1) * width_, buffer_, at);
  }

  /// The format's preparation for zip: bytes at even places before those at odd places, and then each one's difference from the one before,
  /// about 128 (OpenEXR, "File Layout", and its ImfZip). A row has an even number of bytes; it stays in the cache.
  void prepare(size_t first, size_t last) {
    const size_t pairs = row_.size() / 2, middle = prepared_.size() / 2;
    std::uint8_t last_even = 0, last_odd = 0;
    for (size_t row = first; row < last; ++row) {
      read_row(row);
      const std::uint8_t* const from = row_.data();
      std::uint8_t *const even = prepared_.data() + (row - first) * pairs, *const odd = even + middle;
      even[0] = difference(from[0], last_even);
      odd[0] = difference(from[1], last_odd);
      split_differences(from, pairs, even, odd);
      if (row == first) prepared_[0] = from[0];
      last_even = from[2 * pairs - 2];
      last_odd = from[2 * pairs - 1];
    }
    // The first of the odd ones follows the last of the even ones, which was not known yet.
    prepared_[middle] = static_cast<std::uint8_t>(prepared_[middle] - last_even);
  }

  std::span<const ExrChannel* const> channels_;
  size_t width_ = 0;
  RowBuffer buffer_{};
  Bytes row_{}, prepared_{};
  Deflater deflater_{};
};

}  // namespace

void write_exr_file(const std::filesystem::path& file, const std::string& name, const ExrPicture& picture) {
  std::vector<const ExrChannel*> channels;
  for (const ExrChannel& channel : picture.channels) channels.push_back(&channel);
  std::sort(channels.begin(), channels.end(), [](const ExrChannel* a, const ExrChannel* b) { return a->name < b->name; });
  File output(file, name);
  write_header(output, picture, channels);
  constexpr int kRows = 16;      // of a chunk, as the format has it
  constexpr int kTogether = 32;  // chunks that are kept until they are written in their order
  const int chunks = (picture.height_px + kRows - 1) / kRows;
  std::vector<Bytes> made(static_cast<size_t>(std::min(kTogether, chunks)));
  for (int begin = 0; begin < chunks; begin += kTogether) {
    const int end = std::min(chunks, begin + kTogether);
    parallel_parts(end - begin, 1, [&](const IndexRange<int>& part) {
      ChunkMaker maker(picture, channels);
      for (int i = part.first; i < part.last; ++i) {
        const int row = (begin + i) * kRows;
        made[static_cast<size_t>(i)] = maker.make(static_cast<size_t>(row), static_cast<size_t>(std::min(row + kRows, picture.height_px)));
      }
    });
    for (int i = 0; i < end - begin; ++i) {
      const Bytes& chunk = made[static_cast<size_t>(i)];
      output.check(exr_write_scanline_chunk(output.context(), 0, (begin + i) * kRows, chunk.data(), chunk.size()));
    }
  }
  output.finish();
}

}  // namespace limn
