#pragma once
// Internal: a glTF 2.0 document, its binary chunk and its buffers.

#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "subdiv/gltf/json.h"

namespace limn::gltf {

/// A file's bytes, mapped: a buffer of a gigabyte takes no memory of ours.
class MappedFile {
 public:
  /// Refuses (naming `where`) what is no regular file or cannot be read: a pipe is never waited for.
  MappedFile(const std::filesystem::path& file, const std::string& where);
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  ~MappedFile();
  std::span<const std::byte> bytes() const { return {static_cast<const std::byte*>(data_), size_}; }

 private:
  void* data_ = nullptr;
  size_t size_ = 0;
};

/// Where the JSON and the binary chunk of a file are. A file that does not begin as a GLB is JSON from end to end.
struct Container {
  std::span<const std::byte> json{}, binary{};
  bool has_binary = false;
  std::uint32_t version = 0;  ///< Of the GLB container; 0: plain JSON.
};
/// Refuses what is cut short. Bytes after the end are left alone.
Container open_container(std::span<const std::byte> file);

Json parse_json(std::span<const std::byte> json);
/// True for glTF 1.0, whose document is laid out in another way.
bool is_version_1(const Container& container, const Json& root);
/// Refuses versions that are not 2.x and required extensions that change what the geometry is and are not read.
void check_version_and_extensions(const Json& root, std::vector<std::string>& warnings);

/// What a URI stands for: '%20' and the like decoded.
std::string percent_decoded(std::string_view uri);
std::vector<std::byte> base64_decoded(std::string_view text, const std::string& where);

struct Document {
  Json root{};
  std::filesystem::path folder{};  ///< Where the file lies; its buffers lie there or below.
  std::span<const std::byte> binary{};
  bool has_binary = false;
  std::int64_t max_elements = 0;
  std::vector<std::string> warnings{};

  /// Read when first asked for: what nothing drawn needs may be missing.
  std::span<const std::byte> buffer(std::uint64_t index);

 private:
  struct Kept {
    std::vector<std::byte> decoded{};
    std::unique_ptr<MappedFile> mapped{};
    std::span<const std::byte> bytes{};
  };
  std::map<std::uint64_t, Kept> kept_{};
  Kept read_buffer(std::uint64_t index) const;
};

}  // namespace limn::gltf
