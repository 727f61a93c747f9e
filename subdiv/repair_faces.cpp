#include "subdiv/repair_faces.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>

#include "sdf/error.h"

namespace limn {
namespace {

enum class Fault : char { none, out_of_range, too_few_corners, repeated };

using Corners = std::span<const std::int32_t>;

Fault fault_of(Corners corners, std::uint32_t vertices) {
  for (const std::int32_t v : corners)
    if (static_cast<std::uint32_t>(v) >= vertices) return Fault::out_of_range;
  size_t second = 1;
  while (second < corners.size() && corners[second] == corners[0]) ++second;
  for (size_t i = second + 1; i < corners.size(); ++i)
    if (corners[i] != corners[0] && corners[i] != corners[second]) return Fault::none;
  return Fault::too_few_corners;
}

/// A face's corners from its smallest on: the same for every place that the same face may start at.
struct Cycle {
  Corners corners;
  size_t start;
  explicit Cycle(Corners of) : corners(of), start(static_cast<size_t>(std::min_element(of.begin(), of.end()) - of.begin())) {}
  std::int32_t operator[](size_t i) const { return corners[start + i < corners.size() ? start + i : start + i - corners.size()]; }
  std::uint64_t hash() const {
    std::uint64_t sum = corners.size();
    for (size_t i = 0; i < corners.size(); ++i) {  // splitmix64's mixer (Steele, Lea & Flood 2014)
      sum += static_cast<std::uint64_t>((*this)[i]) + 0x9e3779b97f4a7c15ull;
      sum = (sum ^ (sum >> 30)) * 0xbf58476d1ce4e5b9ull;
      sum ^= sum >> 27;
    }
    return sum;
  }
  bool operator==(const Cycle& other) const {
    if (corners.size() != other.corners.size()) return false;
    for (size_t i = 0; i < corners.size(); ++i)
      if ((*this)[i] != other[i]) return false;
    return true;
  }
};

class Repair {
 public:
  Repair(Mesh& mesh, const RepairWords& words) : mesh_(mesh), words_(words) {}

  void run() {
    if (mesh_.face_sizes.empty()) refuse_without_faces();
    find_impossible();
    if (!words_.keep_equal) find_repeated();
    const auto dropped = mesh_.face_count() - static_cast<size_t>(std::count(faults_.begin(), faults_.end(), Fault::none));
    if (dropped == 0) return;
    if (dropped == mesh_.face_count()) refuse();
    say(Fault::out_of_range);
    say(Fault::too_few_corners);
    say(Fault::repeated);
    compact();
  }

 private:
  Corners corners(size_t face) const {
    return Corners(mesh_.corner_vertices).subspan(first_[face], static_cast<size_t>(mesh_.face_sizes[face]));
  }

  void find_impossible() {
    const auto vertices = static_cast<std::uint32_t>(std::min<size_t>(mesh_.vertex_count(), INT32_MAX));
    first_.resize(mesh_.face_count());
    faults_.resize(mesh_.face_count());
    size_t first = 0;
    for (size_t f = 0; f < mesh_.face_count(); ++f) {
      first_[f] = static_cast<std::uint32_t>(first);
      first += static_cast<size_t>(mesh_.face_sizes[f]);
      faults_[f] = fault_of(corners(f), vertices);
    }
  }

  /// Faces are sorted by their smallest vertex, which takes no comparison; the few that share it are compared by hash.
  void find_repeated() {
    std::vector<std::uint32_t> ends(mesh_.vertex_count() + 1, 0), smallest(mesh_.face_count());
    for (size_t f = 0; f < mesh_.face_count(); ++f) {
      if (faults_[f] != Fault::none) continue;
      const Corners own = corners(f);
      smallest[f] = static_cast<std::uint32_t>(*std::min_element(own.begin(), own.end()));
      ++ends[smallest[f] + 1];
    }
    for (size_t v = 1; v < ends.size(); ++v) ends[v] += ends[v - 1];
    std::vector<std::uint32_t> order(ends.back());
    for (size_t f = 0; f < mesh_.face_count(); ++f)
      if (faults_[f] == Fault::none) order[ends[smallest[f]]++] = static_cast<std::uint32_t>(f);
    // Each end has moved up to the next one's beginning.
    for (size_t v = 0, begin = 0; v + 1 < ends.size(); begin = ends[v++])
      if (ends[v] > begin + 1) compare(std::span(order).subspan(begin, ends[v] - begin));
  }

  void compare(std::span<const std::uint32_t> faces) {
    hashes_.clear();
    for (const std::uint32_t f : faces) hashes_.push_back({Cycle(corners(f)).hash(), f});
    std::sort(hashes_.begin(), hashes_.end(),
              [](const Hashed& a, const Hashed& b) { return std::pair(a.hash, a.face) < std::pair(b.hash, b.face); });
    for (size_t i = 1; i < hashes_.size(); ++i) {
      const Hashed& a = hashes_[i - 1];
      const Hashed& b = hashes_[i];
      if (a.hash == b.hash && Cycle(corners(a.face)) == Cycle(corners(b.face))) faults_[b.face] = Fault::repeated;
    }
  }

  std::string place(size_t face) const { return words_.place ? words_.place(face) : fmt::format("face {}", face + 1); }

  std::int32_t missing_vertex(size_t face) const {
    for (const std::int32_t v : corners(face))
      if (v < 0 || static_cast<size_t>(v) >= mesh_.vertex_count()) return v;
    return 0;
  }

  std::string vertex_name(std::int32_t v) const {
    return v < 0 ? fmt::format("one before the first, {}", words_.first_index)
                 : std::to_string(static_cast<std::int64_t>(v) + words_.first_index);
  }

  [[noreturn]] void refuse_without_faces() const {
    std::string problem = "the mesh has no faces";
    if (!words_.instead.empty()) {
      problem += ", only " + words_.instead;
    } else if (!mesh_.positions.empty()) {
      problem = fmt::format("a point cloud of {}: the mesh has no faces",
                            counted(static_cast<std::int64_t>(mesh_.vertex_count()), "vertex", "vertices"));
    }
    throw InputError({words_.file, "", "", problem, "at least one face with 3 or more corners"});
  }

  [[noreturn]] void refuse() const {
    const std::string where = place(0);
    const std::string file = words_.place ? words_.file + ":" + where.substr(where.find_last_of(' ') + 1) : words_.file;
    const std::string field = words_.place ? "f" : where;
    if (faults_[0] == Fault::out_of_range) {
      const std::string range = mesh_.vertex_count() == 0 ? std::string("a file with vertices")
                                                          : fmt::format("{} to {}", words_.first_index,
                                                                        mesh_.vertex_count() - 1 + static_cast<size_t>(words_.first_index));
      throw InputError({file, field, vertex_name(missing_vertex(0)), "vertex index out of range, and no other face can be drawn", range});
    }
    throw InputError({file, field, fmt::format("{} corners", mesh_.face_sizes[0]),
                      "a face with fewer than 3 corners that differ, and no other face can be drawn", "3 or more corners"});
  }

  void say(Fault fault) {
    const auto count = std::count(faults_.begin(), faults_.end(), fault);
    if (count == 0) return;
    const auto first = static_cast<size_t>(std::find(faults_.begin(), faults_.end(), fault) - faults_.begin());
    const bool one = count == 1;
    std::string text;
    if (fault == Fault::out_of_range) {
      text = fmt::format("{} a vertex that is not there (vertex {} of {})", counted(count, "face names", "faces name"),
                         vertex_name(missing_vertex(first)), mesh_.vertex_count());
    } else if (fault == Fault::too_few_corners) {
      text = counted(count, "face has fewer than 3 corners that differ, and so has no area",
                     "faces have fewer than 3 corners that differ, and so have no area");
    } else {
      text = counted(count, "face has the same vertices in the same order as another",
                     "faces have the same vertices in the same order as another");
    }
    mesh_.warnings.push_back(fmt::format("{}: dropped ({}{})", text, one ? "" : "first: ", place(first)));
  }

  template <class T>
  void keep_by_face(std::vector<T>& values) const {
    if (values.empty()) return;
    size_t to = 0;
    for (size_t f = 0; f < faults_.size(); ++f)
      if (faults_[f] == Fault::none) values[to++] = values[f];
    values.resize(to);
  }

  template <class T>
  void keep_by_corner(std::vector<T>& values) const {
    if (values.empty()) return;
    size_t to = 0;
    for (size_t f = 0; f < faults_.size(); ++f)
      for (size_t i = 0; i < static_cast<size_t>(mesh_.face_sizes[f]) && faults_[f] == Fault::none; ++i)
        values[to++] = values[first_[f] + i];
    values.resize(to);
  }

  void compact() {
    std::vector<std::int32_t> holes;
    size_t seen = 0;
    for (size_t f = 0, next = 0; f < faults_.size() && next < mesh_.holes.size(); ++f) {
      const bool hole = mesh_.holes[next] == static_cast<std::int32_t>(f);
      if (hole && faults_[f] == Fault::none) holes.push_back(static_cast<std::int32_t>(seen));
      next += hole;
      seen += faults_[f] == Fault::none;
    }
    mesh_.holes = std::move(holes);
    keep_by_corner(mesh_.corner_vertices);
    keep_by_corner(mesh_.corner_normals);
    keep_by_face(mesh_.face_materials);
    keep_by_face(mesh_.face_groups);
    keep_by_face(mesh_.face_smoothing);
    keep_by_face(mesh_.face_sizes);
  }

  struct Hashed {
    std::uint64_t hash;
    std::uint32_t face;
  };
  Mesh& mesh_;
  const RepairWords& words_;
  std::vector<std::uint32_t> first_{};
  std::vector<Fault> faults_{};
  std::vector<Hashed> hashes_{};
};

}  // namespace

void repair_faces(Mesh& mesh, const RepairWords& words) { Repair(mesh, words).run(); }

std::string counted(std::int64_t count, const char* one, const char* many) { return fmt::format("{} {}", count, count == 1 ? one : many); }

}  // namespace limn
