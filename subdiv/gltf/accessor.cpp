#include "subdiv/gltf/accessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

namespace limn::gltf {
namespace {

enum Component : std::uint64_t { kInt8 = 5120, kUint8 = 5121, kInt16 = 5122, kUint16 = 5123, kUint32 = 5125, kFloat = 5126 };

size_t size_of(std::uint64_t component, const std::string& where) {
  switch (component) {
    case kInt8:
    case kUint8:
      return 1;
    case kInt16:
    case kUint16:
      return 2;
    case kUint32:
    case kFloat:
      return 4;
    default:
      refuse(where + ".componentType", "an unknown type of number", "5120 to 5123, 5125 or 5126", fmt::format("{}", component));
  }
}

int components_in(const std::string& type) {
  constexpr std::array kTypes = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  for (size_t i = 0; i < kTypes.size(); ++i) {
    if (type == kTypes[i]) return static_cast<int>(i) + 1;
  }
  return 0;
}

/// Elements in a buffer: `count` of them, `stride` bytes apart.
struct Run {
  const std::byte* first = nullptr;  ///< Null: all are 0.
  size_t count = 0, stride = 0;
};

void check_meshopt(const Json& view, const std::string& where) {
  const Json* extensions = find_object(view, "extensions");
  if (!extensions) return;
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    if (find(*extensions, name))
      refuse(where, "the data are compressed with meshopt, which is not read", "a file that is not compressed with meshopt", name);
  }
}

/// A view's bytes from `offset`, checked to hold `count` elements of `size` bytes.
Run run_of(Document& document, std::uint64_t view_index, std::uint64_t offset, size_t count, size_t size, const std::string& where) {
  const Json* view = find_element(document.root, "bufferViews", view_index);
  if (!view)
    refuse(where, "there is no such buffer view", fmt::format("{} buffer views", length(document.root, "bufferViews")),
           fmt::format("{}", view_index));
  const std::string at = element("bufferViews", view_index);
  const auto buffer_index = whole_number(*view, "buffer", at);
  if (!buffer_index) refuse(at, "names no buffer", "a buffer");
  // Where the compressed data are an addition, the buffer holds the plain ones, unless it is a placeholder.
  const Json* buffer = find_element(document.root, "buffers", *buffer_index);
  if (buffer && !find(*buffer, "uri") && !(document.has_binary && *buffer_index == 0)) check_meshopt(*view, at);
  const std::span<const std::byte> bytes = document.buffer(*buffer_index);
  const std::uint64_t start = whole_number(*view, "byteOffset", at).value_or(0);
  const std::uint64_t length_in_view = whole_number(*view, "byteLength", at).value_or(0);
  if (start > bytes.size() || length_in_view > bytes.size() - start)
    refuse(at, "reaches beyond the end of its buffer", fmt::format("within {} bytes", bytes.size()),
           fmt::format("{} + {}", start, length_in_view));
  const std::uint64_t stride = whole_number(*view, "byteStride", at).value_or(0);
  Run run{nullptr, count, stride == 0 ? size : static_cast<size_t>(stride)};
  if (run.stride < size || run.stride > 65536)
    refuse(at + ".byteStride", "out of range", fmt::format("{} to 65536", size), fmt::format("{}", stride));
  if (count == 0) return run;
  if (offset > length_in_view || size > length_in_view - offset || (count - 1) > (length_in_view - offset - size) / run.stride)
    refuse(where, "its elements reach beyond the end of its buffer view",
           fmt::format("{} elements within {} bytes", count, length_in_view));
  run.first = bytes.data() + start + offset;
  return run;
}

template <class T>
void copy_as(const Run& run, int components, bool normalized, double* out) {
  const double scale = normalized && std::numeric_limits<T>::is_integer ? 1.0 / static_cast<double>(std::numeric_limits<T>::max()) : 1.0;
  for (size_t i = 0; i < run.count; ++i) {
    T values[4];
    std::memcpy(values, run.first + i * run.stride, sizeof(T) * static_cast<size_t>(components));
    for (int k = 0; k < components; ++k) {
      // Of -128 to 127 both -128 and -127 stand for -1.
      *out++ = normalized ? std::max(static_cast<double>(values[k]) * scale, -1.0) : static_cast<double>(values[k]);
    }
  }
}

void copy(const Run& run, std::uint64_t component, int components, bool normalized, double* out) {
  switch (component) {
    case kInt8:
      return copy_as<std::int8_t>(run, components, normalized, out);
    case kUint8:
      return copy_as<std::uint8_t>(run, components, normalized, out);
    case kInt16:
      return copy_as<std::int16_t>(run, components, normalized, out);
    case kUint16:
      return copy_as<std::uint16_t>(run, components, normalized, out);
    case kUint32:
      return copy_as<std::uint32_t>(run, components, normalized, out);
    default:
      return copy_as<float>(run, components, false, out);
  }
}

template <class T>
void widen(const Run& run, std::vector<std::uint32_t>& out) {
  for (size_t i = 0; i < run.count; ++i) {
    T value;
    std::memcpy(&value, run.first + i * run.stride, sizeof value);
    out[i] = value;
  }
}

/// Unsigned whole numbers of the type `component`.
std::vector<std::uint32_t> unsigned_numbers(const Run& run, std::uint64_t component, const std::string& where) {
  std::vector<std::uint32_t> numbers(run.count);
  if (!run.first) return numbers;
  if (component == kUint8)
    widen<std::uint8_t>(run, numbers);
  else if (component == kUint16)
    widen<std::uint16_t>(run, numbers);
  else if (component == kUint32)
    widen<std::uint32_t>(run, numbers);
  else
    refuse(where + ".componentType", "indices of a wrong type", "5121, 5123 or 5125 (unsigned)", fmt::format("{}", component));
  return numbers;
}

/// The elements that the accessor gives one by one, over those of its view.
void lay_sparse(Document& document, const Json& sparse, std::uint64_t component, bool normalized, const std::string& where, Elements& all) {
  const size_t count = static_cast<size_t>(std::min<std::uint64_t>(whole_number(sparse, "count", where).value_or(0), all.count));
  const Json *indices = find_object(sparse, "indices"), *values = find_object(sparse, "values");
  const auto index_view = indices ? whole_number(*indices, "bufferView", where + ".indices") : std::nullopt;
  const auto value_view = values ? whole_number(*values, "bufferView", where + ".values") : std::nullopt;
  if (!index_view || !value_view) refuse(where, "has no indices or no values", "a bufferView for each");
  const std::uint64_t index_type = whole_number(*indices, "componentType", where + ".indices").value_or(0);
  const Run index_run = run_of(document, *index_view, whole_number(*indices, "byteOffset", where).value_or(0), count,
                               size_of(index_type, where + ".indices"), where + ".indices");
  const std::vector<std::uint32_t> places = unsigned_numbers(index_run, index_type, where + ".indices");
  const Run value_run = run_of(document, *value_view, whole_number(*values, "byteOffset", where).value_or(0), count,
                               size_of(component, where) * all.stride(), where + ".values");
  std::vector<double> numbers(count * all.stride());
  if (value_run.first) copy(value_run, component, all.components, normalized, numbers.data());
  for (size_t i = 0; i < count; ++i) {
    if (places[i] >= all.count)
      refuse(where + ".indices", "an index is out of range", fmt::format("below {}", all.count), fmt::format("{}", places[i]));
    std::copy_n(numbers.begin() + static_cast<std::ptrdiff_t>(i * all.stride()), all.components,
                all.values.begin() + static_cast<std::ptrdiff_t>(places[i] * all.stride()));
  }
}

const Json& accessor_at(const Document& document, std::uint64_t index, const std::string& where) {
  const Json* accessor = find_element(document.root, "accessors", index);
  if (!accessor)
    refuse(where, "there is no such accessor", fmt::format("{} accessors", length(document.root, "accessors")), fmt::format("{}", index));
  return *accessor;
}

size_t checked_count(const Document& document, const Json& accessor, const std::string& where) {
  const std::uint64_t count = whole_number(accessor, "count", where).value_or(0);
  if (count > static_cast<std::uint64_t>(document.max_elements))
    refuse(where + ".count", "more vertices and corners than allowed", fmt::format("at most {}", document.max_elements),
           fmt::format("{}", count));
  return static_cast<size_t>(count);
}

}  // namespace

int components_of(const Document& document, std::uint64_t accessor) {
  const Json* about = find_element(document.root, "accessors", accessor);
  return about ? components_in(text(*about, "type")) : 0;
}

std::uint64_t count_of(const Document& document, std::uint64_t accessor) {
  const Json* about = find_element(document.root, "accessors", accessor);
  return about ? whole_number(*about, "count", element("accessors", accessor)).value_or(0) : 0;
}

Elements read_elements(Document& document, std::uint64_t index, const std::string& where) {
  const Json& accessor = accessor_at(document, index, where);
  const std::string at = element("accessors", index);
  Elements all;
  all.components = components_of(document, index);
  if (all.components == 0) refuse(at + ".type", "of a wrong type", "SCALAR, VEC2, VEC3 or VEC4", text(accessor, "type"));
  all.count = checked_count(document, accessor, at);
  const std::uint64_t component = whole_number(accessor, "componentType", at).value_or(0);
  const size_t size = size_of(component, at) * all.stride();
  const Json* flag = find(accessor, "normalized");
  const bool normalized = flag && flag->is_boolean() && flag->get<bool>() && component != kFloat;
  all.values.assign(all.count * all.stride(), 0.0);
  if (const auto view = whole_number(accessor, "bufferView", at)) {
    const Run run = run_of(document, *view, whole_number(accessor, "byteOffset", at).value_or(0), all.count, size, at);
    if (run.first) copy(run, component, all.components, normalized, all.values.data());
  }
  if (const Json* sparse = find_object(accessor, "sparse")) lay_sparse(document, *sparse, component, normalized, at + ".sparse", all);
  return all;
}

std::vector<std::uint32_t> read_indices(Document& document, std::uint64_t index, const std::string& where) {
  const Json& accessor = accessor_at(document, index, where);
  const std::string at = element("accessors", index);
  const std::uint64_t component = whole_number(accessor, "componentType", at).value_or(0);
  if (find_object(accessor, "sparse")) {
    const Elements all = read_elements(document, index, where);
    if (component == kFloat) refuse(at + ".componentType", "indices of a wrong type", "5121, 5123 or 5125 (unsigned)");
    std::vector<std::uint32_t> numbers;
    for (const double value : all.values) numbers.push_back(static_cast<std::uint32_t>(std::clamp(value, 0.0, 4294967295.0)));
    return numbers;
  }
  const size_t count = checked_count(document, accessor, at);
  const auto view = whole_number(accessor, "bufferView", at);
  if (!view) return std::vector<std::uint32_t>(count, 0);
  const Run run = run_of(document, *view, whole_number(accessor, "byteOffset", at).value_or(0), count, size_of(component, at), at);
  return unsigned_numbers(run, component, at);
}

}  // namespace limn::gltf
