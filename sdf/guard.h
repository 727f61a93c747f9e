#pragma once
// Reading files that nobody vouches for: a helper program reads, under limits, and sends back plain bytes that we then validate.

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace limn {

/// What a helper program may take.
struct GuardLimits {
  std::int64_t memory_bytes = std::int64_t{6} << 30;  ///< Address space of the helper, beyond what it starts with.
  std::int64_t answer_bytes = std::int64_t{4} << 30;  ///< Size of its answer.
  std::chrono::milliseconds time{120'000};            ///< Wall clock.
};

/// Where a helper program or module is: in $LIMN_HELPERS, beside the running program, in the installed libexec folder or in the build tree.
/// Throws MachineError that says where it was looked for.
std::filesystem::path find_helper(const std::string& name);

/// Runs the helper program `name` with `arguments`, and returns all that it wrote to its answer pipe.
/// The helper's exit codes: 0 answer complete; 2 the file is at fault, its one-line reason being the answer.
/// Throws InputError (file = `file`) for exit 2, a crash, a timeout or exhausted limits, each in its own words; MachineError where the
/// helper cannot be started.
std::vector<std::byte> run_guarded(const std::string& name, std::span<const std::string> arguments, const std::filesystem::path& file,
                                   const GuardLimits& limits = {});

/// Bytes in and out of the pipe, little-endian, with bounds checked on reading (InputError naming `file`).
class ByteWriter {
 public:
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
  std::vector<std::byte> bytes{};                                                    ///< What was put so far.

 private:
  void append(const void* data, size_t size) {
    const auto* first = static_cast<const std::byte*>(data);
    bytes.insert(bytes.end(), first, first + size);
  }
};

/// Takes apart what a ByteWriter put together, in the same order.
class ByteReader {
 public:
  /// `bytes` must outlive the reader; `file` goes into messages.
  ByteReader(std::span<const std::byte> bytes, std::string file) : bytes_(bytes), file_(std::move(file)) {}
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
    std::vector<T> values(static_cast<size_t>(count));
    take(values.data(), values.size() * sizeof(T));
    return values;
  }
  /// What ByteWriter::put_text put. Throws InputError where the count is larger than what is left.
  std::string get_text() {
    const std::vector<char> text = get_vector<char>();
    return std::string(text.begin(), text.end());
  }
  /// A part that was put as a span of bytes, where it lies.
  std::span<const std::byte> get_bytes() {
    const auto count = get<std::uint64_t>();
    if (count > bytes_.size()) damaged();
    const std::span<const std::byte> part = bytes_.first(static_cast<size_t>(count));
    bytes_ = bytes_.subspan(part.size());
    return part;
  }
  bool done() const { return bytes_.empty(); }  ///< True where nothing is left.

 private:
  void take(void* target, size_t size);
  [[noreturn]] void damaged() const;
  std::span<const std::byte> bytes_;
  std::string file_{};
};

/// For the helper programs: sends the answer and returns the program's exit code.
int send_answer(std::span<const std::byte> answer);
/// For the helper programs: sends why the file is at fault (one line; control characters become spaces) and returns the program's exit
/// code.
int send_refusal(const std::string& reason);

/// Plain checks every reader makes first: exists, is a regular file, is not empty, is readable. Throws InputError.
void check_readable(const std::filesystem::path& file, const std::string& what);

}  // namespace limn
