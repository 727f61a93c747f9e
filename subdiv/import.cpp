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

Mesh read_in_helper(const std::filesystem::path& file, const ImportSettings& settings) {
  const std::string arguments[] = {file.string(), std::to_string(settings.max_elements)};
  const std::vector<std::byte> answer = run_guarded("limn-read-mesh", arguments, file, settings.limits);
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
