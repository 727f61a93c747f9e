#pragma once
// What a helper program sends and what becomes of it (sdf/guard.h): bytes one after the other, little-endian, with bounds checked on
// reading. They lie in pages that both sides see, so that hundreds of megabytes of a volume are written and read where they are.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace limn {

/// The whole of a file, as it was when it was mapped; the owner of its pages.
class MappedBytes {
 public:
  MappedBytes() = default;                               ///< Nothing.
  explicit MappedBytes(int file);                        ///< A file descriptor, not kept. Throws MachineError where it cannot be mapped.
  static MappedBytes copied(int file);                   ///< The same in memory of its own, which later writing cannot change.
  MappedBytes(MappedBytes&& other) noexcept;             ///< What `other` has, which then has nothing.
  MappedBytes& operator=(MappedBytes&& other) noexcept;  ///< As two that change places.
  ~MappedBytes();                                        ///< Gives the pages back.

  const std::byte* data() const { return data_; }  ///< The first byte; at a page's beginning. Null of nothing.
  std::size_t size() const { return size_; }       ///< Bytes.
  /// All bytes.
  operator std::span<const std::byte>() const { return {data_, size_}; }  // NOLINT(google-explicit-constructor): bytes are what it is

 private:
  std::byte* data_ = nullptr;
  std::size_t size_ = 0;
};

/// Elements that follow their count begin at a multiple of this, counted from the first byte of all.
inline constexpr std::size_t kAnswerAlignment = 64;

/// Puts an answer together.
class ByteWriter {
 public:
  ByteWriter() = default;         ///< In memory of its own.
  explicit ByteWriter(int file);  ///< In the pages of a file from its beginning, or, where it has none, written to it by finish().
  ByteWriter(const ByteWriter&) = delete;
  ByteWriter& operator=(const ByteWriter&) = delete;
  ~ByteWriter();  ///< Of a file: does not finish it.

  /// The bytes of a trivially copyable value.
  template <class T>
  void put(const T& value) {
    append(&value, sizeof value);
  }
  /// The count as 64 bits, then the elements.
  template <class T>
  void put_span(std::span<const T> values) {
    put(static_cast<std::uint64_t>(values.size()));
    append(values.data(), values.size_bytes());
  }
  void put_text(const std::string& text) { put_span(std::span<const char>(text)); }  ///< As put_span.
  /// The count, and room for the elements at a multiple of kAnswerAlignment: to be filled before the next put(). For
  /// ByteReader::get_in_place.
  template <class T>
  std::span<T> put_room(std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kAnswerAlignment);
    put(static_cast<std::uint64_t>(count));
    align();
    return {reinterpret_cast<T*>(room(count * sizeof(T))), count};
  }
  /// Begins a part that ByteReader::get_bytes takes: itself an answer. Returns what end_part wants.
  std::size_t begin_part();
  void end_part(std::size_t begun);  ///< `begun` is what begin_part returned.
  /// Room for so many bytes more, which put() then finds: growing takes up to twice as much. Throws std::bad_alloc.
  void reserve(std::size_t more);
  /// Takes back all but the first `size` bytes.
  void shrink(std::size_t size) { size_ = size; }

  std::size_t size() const { return size_; }                           ///< Of what was put so far.
  std::span<const std::byte> bytes() const { return {data_, size_}; }  ///< What was put so far; until the next put().
  /// Of a file: as long as what was put, from now on nothing may be. False where it cannot be written.
  bool finish();

 private:
  void append(const void* data, std::size_t size) {
    if (size > 0) std::memcpy(room(size), data, size);
  }
  /// Unset, behind what is there. Throws std::bad_alloc.
  std::byte* room(std::size_t size);
  void align();
  void grow(std::size_t least);
  bool resize(std::size_t capacity);

  int file_ = -1;
  bool mapped_ = false;
  std::byte* data_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;
};

/// Takes apart what a ByteWriter put together, in the same order.
class ByteReader {
 public:
  /// `bytes` must outlive the reader and begin where a ByteWriter did; `file` goes into messages.
  ByteReader(std::span<const std::byte> bytes, std::string file) : all_(bytes), bytes_(bytes), file_(std::move(file)) {}
  /// What ByteWriter::put put. Throws InputError at the end of the bytes.
  template <class T>
  T get() {
    T value;
    take(&value, sizeof value);
    return value;
  }
  /// What ByteWriter::put_span put. Throws InputError where the count is larger than what is left.
  template <class T>
  std::vector<T> get_vector() {
    const auto count = get<std::uint64_t>();
    if (count > bytes_.size() / sizeof(T)) damaged();
    std::vector<T> values(static_cast<std::size_t>(count));
    take(values.data(), values.size() * sizeof(T));
    return values;
  }
  /// What was put into ByteWriter::put_room, where it lies. Throws as get_vector does, and where the bytes begin at no such multiple.
  template <class T>
  std::span<const T> get_in_place() {
    const auto count = get<std::uint64_t>();
    align();
    if (count > bytes_.size() / sizeof(T) || reinterpret_cast<std::uintptr_t>(bytes_.data()) % alignof(T) != 0) damaged();
    const auto* const first = reinterpret_cast<const T*>(bytes_.data());
    bytes_ = bytes_.subspan(static_cast<std::size_t>(count) * sizeof(T));
    return {first, static_cast<std::size_t>(count)};
  }
  /// What ByteWriter::put_text put. Throws InputError where the count is larger than what is left.
  std::string get_text() {
    const std::vector<char> text = get_vector<char>();
    return std::string(text.begin(), text.end());
  }
  std::span<const std::byte> get_bytes() { return get_in_place<std::byte>(); }  ///< A part, from begin_part to end_part.
  bool done() const { return bytes_.empty(); }                                  ///< True where nothing is left.

 private:
  void take(void* target, std::size_t size);
  void align();
  [[noreturn]] void damaged() const;

  std::span<const std::byte> all_, bytes_;  ///< From the beginning; what is left.
  std::string file_{};
};

}  // namespace limn
