#include "sdf/answer.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <new>
#include <utility>

#include "sdf/error.h"

namespace limn {
namespace {

/// Of files that grow: whole pages, and as much again as there is.
constexpr std::size_t kLeastRoom = std::size_t{1} << 16;

std::size_t to_alignment(std::size_t at) { return (kAnswerAlignment - at % kAnswerAlignment) % kAnswerAlignment; }

bool write_all(int file, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file, bytes.data(), bytes.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return true;
}

[[noreturn]] void throw_unreadable() { throw MachineError(std::string("cannot read a helper's answer: ") + std::strerror(errno)); }

std::size_t size_of(int file) {
  struct stat status {};
  if (::fstat(file, &status) != 0) throw_unreadable();
  return static_cast<std::size_t>(status.st_size);
}

/// One byte less than the limit: what is as long as that was cut off (sdf/guard.cpp).
std::size_t longest_file() {
  rlimit longest{};
  if (::getrlimit(RLIMIT_FSIZE, &longest) != 0 || longest.rlim_cur == RLIM_INFINITY || longest.rlim_cur == 0) return SIZE_MAX;
  return static_cast<std::size_t>(longest.rlim_cur) - 1;
}

bool has_pages(int file) {
  struct stat status {};
  return ::fstat(file, &status) == 0 && S_ISREG(status.st_mode) && (::fcntl(file, F_GETFL) & O_ACCMODE) == O_RDWR;
}

}  // namespace

MappedBytes::MappedBytes(int file) {
  const std::size_t size = size_of(file);
  if (size == 0) return;
  void* const pages = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file, 0);
  if (pages == MAP_FAILED) throw_unreadable();
  data_ = static_cast<std::byte*>(pages);
  size_ = size;
}

MappedBytes MappedBytes::copied(int file) {
  MappedBytes result;
  const std::size_t size = size_of(file);
  if (size == 0) return result;
  void* const pages = ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (pages == MAP_FAILED) throw_unreadable();
  result.data_ = static_cast<std::byte*>(pages);
  result.size_ = size;
  // Where the file has become shorter, the rest stays 0.
  for (std::size_t at = 0; at < size;) {
    const ssize_t count = ::pread(file, result.data_ + at, size - at, static_cast<off_t>(at));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw_unreadable();
    if (count == 0) break;
    at += static_cast<std::size_t>(count);
  }
  return result;
}

MappedBytes::MappedBytes(MappedBytes&& other) noexcept : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}

MappedBytes& MappedBytes::operator=(MappedBytes&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  return *this;
}

MappedBytes::~MappedBytes() {
  if (data_ != nullptr) ::munmap(data_, size_);
}

ByteWriter::ByteWriter(int file) : file_(file), mapped_(has_pages(file)) {}

ByteWriter::~ByteWriter() {
  if (data_ != nullptr && mapped_)
    ::munmap(data_, capacity_);
  else
    std::free(data_);
}

void ByteWriter::grow(std::size_t least) {
  // As much again as there is, but no longer than a file may be: growing beyond that would end the process. Else what has to be.
  const std::size_t more = std::min(std::max(2 * capacity_, kLeastRoom), mapped_ ? longest_file() : SIZE_MAX);
  for (const std::size_t wanted : {std::max(least, more), least})
    if (resize(wanted)) return;
  throw std::bad_alloc();
}

bool ByteWriter::resize(std::size_t capacity) {
  void* memory = nullptr;
  if (!mapped_) {
    memory = std::realloc(data_, capacity);
    if (memory == nullptr) return false;
  } else {
    // Only what is written to takes memory.
    if (::ftruncate(file_, static_cast<off_t>(capacity)) != 0) return false;
    memory = data_ == nullptr ? ::mmap(nullptr, capacity, PROT_READ | PROT_WRITE, MAP_SHARED, file_, 0)
                              : ::mremap(data_, capacity_, capacity, MREMAP_MAYMOVE);
    if (memory == MAP_FAILED) return false;
  }
  data_ = static_cast<std::byte*>(memory);
  capacity_ = capacity;
  return true;
}

void ByteWriter::reserve(std::size_t more) {
  if (more > capacity_ - size_ && (more > SIZE_MAX / 2 - size_ || !resize(size_ + more))) throw std::bad_alloc();
}

std::byte* ByteWriter::room(std::size_t size) {
  if (size > capacity_ - size_) {
    if (size > SIZE_MAX / 2 - size_) throw std::bad_alloc();
    grow(size_ + size);
  }
  std::byte* const first = data_ + size_;
  size_ += size;
  return first;
}

void ByteWriter::align() {
  const std::size_t padding = to_alignment(size_);
  if (padding > 0) std::memset(room(padding), 0, padding);
}

std::size_t ByteWriter::begin_part() {
  const std::size_t begun = size_;
  put(std::uint64_t{0});
  align();
  return begun;
}

void ByteWriter::end_part(std::size_t begun) {
  const std::size_t first = begun + sizeof(std::uint64_t);
  const std::uint64_t count = size_ - (first + to_alignment(first));
  std::memcpy(data_ + begun, &count, sizeof count);
}

bool ByteWriter::finish() {
  if (file_ < 0) return false;
  if (mapped_ && ::ftruncate(file_, static_cast<off_t>(size_)) != 0) return false;
  return mapped_ || write_all(file_, bytes());
}

void ByteReader::take(void* target, std::size_t size) {
  if (size > bytes_.size()) damaged();
  if (size > 0) std::memcpy(target, bytes_.data(), size);
  bytes_ = bytes_.subspan(size);
}

void ByteReader::align() {
  const std::size_t padding = to_alignment(all_.size() - bytes_.size());
  if (padding > bytes_.size()) damaged();
  bytes_ = bytes_.subspan(padding);
}

void ByteReader::damaged() const {
  throw InputError({.file = file_,
                    .field = {},
                    .value = {},
                    .problem = "the reader's answer breaks off; the file is damaged",
                    .expected = "an undamaged file"});
}

}  // namespace limn
