#include "subdiv/import.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <system_error>

#include "sdf/error.h"
#include "subdiv/mesh_bytes.h"
#include "subdiv/read_obj.h"

namespace limn {
namespace {

constexpr std::array kExtensions = {".obj", ".ply", ".stl", ".off", ".gltf", ".glb"};
constexpr const char* kExpected = "a mesh: .obj, .ply, .stl, .off, .gltf or .glb";

std::string extension_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return extension;
}

std::string read_text(const std::filesystem::path& file, std::int64_t max_bytes) {
  std::error_code error;
  const auto size = static_cast<std::int64_t>(std::filesystem::file_size(file, error));
  if (error || size > max_bytes)
    throw InputError({file.string(), "", error ? error.message() : fmt::format("{} bytes", size), "the file cannot be read into memory",
                      fmt::format("at most {} bytes", max_bytes)});
  std::ifstream stream(file, std::ios::binary);
  std::string text(static_cast<size_t>(size), '\0');
  stream.read(text.data(), size);
  if (!stream) throw InputError({file.string(), "", "", "the file cannot be read", kExpected});
  return text;
}

/// assimp looks for the end of a PLY's header for ever where there is none.
void check_ply_header(const std::filesystem::path& file) {
  constexpr std::streamsize kLongestHeader = 1 << 20;
  std::ifstream stream(file, std::ios::binary);
  std::string head(kLongestHeader, '\0');
  stream.read(head.data(), kLongestHeader);
  head.resize(static_cast<size_t>(stream.gcount()));
  if (head.find("end_header") == std::string::npos)
    throw InputError({file.string(), "header", "", "the file breaks off within its header", "a line 'end_header' before the data"});
}

/// In proportion to the file: what takes longer is no honest mesh of that size. A .gltf's data lie in files beside it.
GuardLimits limits_for(const std::filesystem::path& file, const GuardLimits& most) {
  constexpr std::int64_t kBytesPerSecond = 500'000;
  GuardLimits limits = most;
  const auto bytes = static_cast<std::int64_t>(std::filesystem::file_size(file));
  if (extension_of(file) != ".gltf")
    limits.time = std::min<std::chrono::milliseconds>(most.time, std::chrono::seconds(20 + bytes / kBytesPerSecond));
  return limits;
}

Mesh read_in_helper(const std::filesystem::path& file, const ImportSettings& settings) {
  if (extension_of(file) == ".ply") check_ply_header(file);
  const std::string arguments[] = {file.string(), std::to_string(settings.max_elements)};
  const std::vector<std::byte> answer = run_guarded("limn-read-mesh", arguments, file, limits_for(file, settings.limits));
  ByteReader reader(answer, file.string());
  return get_mesh(reader);
}

}  // namespace

bool is_mesh_file(const std::filesystem::path& file) {
  return std::find(kExtensions.begin(), kExtensions.end(), extension_of(file)) != kExtensions.end();
}

Mesh load_mesh(const std::filesystem::path& file, const ImportSettings& settings) {
  check_readable(file, kExpected);
  if (!is_mesh_file(file))
    throw InputError({file.string(), "", file.extension().string(), "the extension is not that of a mesh", kExpected});
  Mesh mesh = extension_of(file) == ".obj" ? parse_obj(read_text(file, settings.limits.memory_bytes), file.string(), settings.max_elements)
                                           : read_in_helper(file, settings);
  const auto elements = static_cast<std::int64_t>(mesh.vertex_count() + mesh.corner_vertices.size());
  if (elements > settings.max_elements)
    throw InputError({file.string(), "", fmt::format("{}", elements), "more vertices and corners than allowed",
                      fmt::format("at most {}", settings.max_elements)});
  validate(mesh, file.string());
  return mesh;
}

}  // namespace limn
