// What a document's buffers are: the binary chunk, data in the URI, or files in its folder.

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <system_error>

#include "subdiv/gltf/document.h"

namespace limn::gltf {
namespace {

namespace fs = std::filesystem;

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

constexpr std::array<std::int8_t, 256> base64_table() {
  std::array<std::int8_t, 256> table{};
  for (auto& entry : table) entry = -1;
  for (int i = 0; i < 26; ++i) {
    table[static_cast<size_t>('A' + i)] = static_cast<std::int8_t>(i);
    table[static_cast<size_t>('a' + i)] = static_cast<std::int8_t>(26 + i);
  }
  for (int i = 0; i < 10; ++i) table[static_cast<size_t>('0' + i)] = static_cast<std::int8_t>(52 + i);
  table['+'] = table['-'] = 62;
  table['/'] = table['_'] = 63;
  return table;
}

/// Beginnings such as "http:": a letter, then letters, digits, + - . up to a colon.
bool has_scheme(const std::string& uri) {
  const size_t colon = uri.find(':');
  // One letter is a drive of Windows, which is no file beside this one either.
  return colon != std::string::npos && colon > 0 && colon < uri.find('/') && colon < uri.find('%');
}

bool outside(const fs::path& file, const fs::path& folder) {
  std::error_code error;
  const fs::path home = fs::weakly_canonical(folder.empty() ? fs::path(".") : folder, error);
  const fs::path relative = fs::weakly_canonical(file, error).lexically_relative(home);
  return error || relative.empty() || *relative.begin() == "..";
}

std::string shortened(const std::string& uri) { return uri.size() > 100 ? uri.substr(0, 100) + "..." : uri; }

fs::path file_of(const std::string& uri, const fs::path& folder, const std::string& where) {
  const std::string beside = "a file in the folder of the .gltf or below";
  if (has_scheme(uri)) refuse(where, "only files beside this one are read", beside, shortened(uri));
  const std::string decoded = percent_decoded(uri);
  if (decoded.find('\0') != std::string::npos) refuse(where, "a file name that holds a zero byte", beside, shortened(uri));
  const fs::path named(decoded);
  fs::path file = folder / named;
  if (named.is_absolute() || outside(file, folder)) refuse(where, "the file lies outside the folder of the .gltf", beside, shortened(uri));
  std::error_code error;
  // Some exporters do not encode what they write.
  if (!fs::exists(file, error) && uri != decoded && !outside(folder / uri, folder) && fs::exists(folder / uri, error)) file = folder / uri;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status)) refuse(where, "no such file", beside, shortened(decoded));
  if (!fs::is_regular_file(status)) refuse(where, "is not a regular file", beside, shortened(decoded));
  return file;
}

std::vector<std::byte> data_of(const std::string& uri, const std::string& where) {
  const size_t comma = uri.find(',');
  if (comma == std::string::npos) refuse(where, "a data URI without data", "data:...;base64,...", shortened(uri));
  const std::string_view head = std::string_view(uri).substr(0, comma), data = std::string_view(uri).substr(comma + 1);
  if (head.ends_with(";base64")) {
    if (data.find('%') == std::string_view::npos) return base64_decoded(data, where);
    return base64_decoded(percent_decoded(data), where);
  }
  const std::string plain = percent_decoded(data);
  const auto* first = reinterpret_cast<const std::byte*>(plain.data());
  return {first, first + plain.size()};
}

}  // namespace

MappedFile::MappedFile(const fs::path& file, const std::string& where) {
  const auto fail = [&](const char* what) {
    refuse(where, std::string(what) + " (" + std::generic_category().message(errno) + ")", "a file that may be read",
           file.filename().string());
  };
  const int handle = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (handle < 0) fail("cannot be opened");
  struct stat about {};
  const bool known = ::fstat(handle, &about) == 0;
  if (!known || !S_ISREG(about.st_mode)) {
    ::close(handle);
    refuse(where, "is not a regular file", "a file that may be read", file.filename().string());
  }
  size_ = static_cast<size_t>(about.st_size);
  if (size_ > 0) data_ = ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, handle, 0);
  ::close(handle);
  if (data_ == MAP_FAILED) {
    data_ = nullptr;
    fail("cannot be read");
  }
}

MappedFile::~MappedFile() {
  if (data_) ::munmap(data_, size_);
}

std::string percent_decoded(std::string_view uri) {
  std::string decoded;
  decoded.reserve(uri.size());
  for (size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] != '%') {
      decoded.push_back(uri[i]);
      continue;
    }
    const int high = i + 1 < uri.size() ? hex_digit(uri[i + 1]) : -1, low = i + 2 < uri.size() ? hex_digit(uri[i + 2]) : -1;
    // A bare % stands in a name that nobody encoded.
    if (high < 0 || low < 0) {
      decoded.push_back('%');
      continue;
    }
    decoded.push_back(static_cast<char>(16 * high + low));
    i += 2;
  }
  return decoded;
}

std::vector<std::byte> base64_decoded(std::string_view coded, const std::string& where) {
  static constexpr std::array<std::int8_t, 256> kTable = base64_table();
  std::vector<std::byte> bytes;
  bytes.reserve(coded.size() / 4 * 3 + 3);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : coded) {
    if (c == '=') break;
    if (c == '\n' || c == '\r' || c == ' ' || c == '\t') continue;
    const std::int8_t value = kTable[static_cast<unsigned char>(c)];
    if (value < 0)
      refuse(where, "the data are not base64", "A-Z a-z 0-9 + / and = at the end",
             fmt::format("byte {}", int{static_cast<unsigned char>(c)}));
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::byte>(bits >> count & 0xff));
  }
  return bytes;
}

Document::Kept Document::read_buffer(std::uint64_t index) const {
  const std::string where = element("buffers", index);
  const Json* about = find_element(root, "buffers", index);
  if (!about) refuse(where, "there is no such buffer", fmt::format("{} buffers", length(root, "buffers")));
  Kept kept;
  const Json* uri = find(*about, "uri");
  if (uri && !uri->is_string()) refuse(where + ".uri", "not a text", "a URI");
  if (!uri) {
    if (!has_binary || index != 0)
      refuse(where, "the buffer has no data: neither a uri nor a binary part of the file", "a uri, or a .glb with its binary part");
    kept.bytes = binary;
  } else if (const auto& name = uri->get_ref<const std::string&>(); name.starts_with("data:")) {
    kept.decoded = data_of(name, where + ".uri");
    kept.bytes = kept.decoded;
  } else {
    kept.mapped = std::make_unique<MappedFile>(file_of(name, folder, where + ".uri"), where + ".uri");
    kept.bytes = kept.mapped->bytes();
  }
  const std::uint64_t promised = whole_number(*about, "byteLength", where).value_or(kept.bytes.size());
  if (promised > kept.bytes.size())
    refuse(where, fmt::format("its data are cut short: {} bytes of {}", kept.bytes.size(), promised), "all of its data");
  kept.bytes = kept.bytes.first(static_cast<size_t>(promised));
  return kept;
}

std::span<const std::byte> Document::buffer(std::uint64_t index) {
  auto at = kept_.find(index);
  if (at == kept_.end()) at = kept_.emplace(index, read_buffer(index)).first;
  return at->second.bytes;
}

}  // namespace limn::gltf
