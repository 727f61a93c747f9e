#include "subdiv/obj_tags.h"

#include <fmt/format.h>

#include <algorithm>

#include "sdf/error.h"
#include "subdiv/text_cursor.h"

namespace limn {
namespace {

constexpr int kMostValues = 100'000'000;

class TagReader {
 public:
  TagReader(std::string_view text, const std::string& place, Mesh& mesh) : cursor_(text), place_(place), mesh_(mesh) {}

  /// False for a tag that is not known.
  bool run(std::string& name) {
    name = cursor_.word();
    if (name.empty()) refuse("t", "", "a tag without a name", "t NAME integers/reals/strings values");
    if (name == "facevaryinginterpolateboundary" || name == "facevaryingpropagatecorners") return true;
    const bool method = name == "creasemethod" || name == "smoothtriangles";
    if (!method && name != "crease" && name != "corner" && name != "hole" && name != "interpolateboundary") return false;
    TextCursor ahead = cursor_;
    if (!method || ahead.word().find('/') != std::string_view::npos) read_values();
    if (method) {
      read_method(name);
    } else if (name == "crease") {
      read_crease();
    } else if (name == "corner") {
      read_corner();
    } else if (name == "hole") {
      mesh_.holes.insert(mesh_.holes.end(), integers_.begin(), integers_.end());
    } else {
      read_boundary();
    }
    return true;
  }

 private:
  [[noreturn]] void refuse(std::string field, std::string_view value, std::string problem, std::string expected) const {
    throw InputError({place_, std::move(field), shown_word(value), std::move(problem), std::move(expected)});
  }

  void read_values() {
    const std::string_view sizes = cursor_.word();
    TextCursor parts(sizes);
    int counts[3] = {0, 0, 0};
    for (int& count : counts) {
      if (!parts.number(count, '/') || count < 0 || count > kMostValues)
        refuse("t", sizes, "the counts of a tag cannot be read", "integers/reals/strings, as in 't crease 2/1/0 0 1 2.5'");
      if (parts.left() == 0) break;
      parts.step();
    }
    for (int i = 0; i < counts[0]; ++i) {
      std::int32_t value = 0;
      if (!cursor_.skip() || !cursor_.number(value))
        refuse("t", cursor_.word(), "a tag with too few or damaged integers", "as many as it announces");
      integers_.push_back(value);
    }
    for (int i = 0; i < counts[1]; ++i) {
      double value = 0.0;
      if (!read_real(cursor_, value)) refuse("t", cursor_.word(), "a tag with too few or damaged numbers", "as many as it announces");
      reals_.push_back(static_cast<float>(value));
    }
  }

  /// One sharpness for all, or one each.
  float sharpness(size_t i) const { return reals_[reals_.size() == 1 ? 0 : i]; }

  void check_counts(const char* field, size_t least, size_t sharpnesses, const char* expected) const {
    if (integers_.size() >= least && (reals_.size() == 1 || reals_.size() == sharpnesses)) return;
    refuse(field, fmt::format("{} vertices, {} sharpnesses", integers_.size(), reals_.size()), "the counts do not fit", expected);
  }

  void read_crease() {
    check_counts("t crease", 2, integers_.size() - 1, "2 or more vertices and one sharpness, or one for each edge");
    for (size_t i = 0; i + 1 < integers_.size(); ++i) mesh_.creases.push_back({integers_[i], integers_[i + 1], sharpness(i)});
  }

  void read_corner() {
    check_counts("t corner", 1, integers_.size(), "1 or more vertices and one sharpness, or one for each");
    for (size_t i = 0; i < integers_.size(); ++i) mesh_.corners.push_back({integers_[i], sharpness(i)});
  }

  /// RenderMan's numbers: 0 none, 1 edges and corners, 2 edges only.
  void read_boundary() {
    const std::int32_t rule = integers_.empty() ? -1 : integers_[0];
    if (rule < 0 || rule > 2)
      refuse("t interpolateboundary", fmt::format("{}", rule), "unknown rule", "0 none, 1 edges and corners, 2 edges");
    mesh_.boundary = rule == 0 ? BoundaryRule::none : rule == 1 ? BoundaryRule::edge_and_corner : BoundaryRule::edge_only;
  }

  void read_method(const std::string& name) {
    const std::string_view method = cursor_.word();
    const bool normal = method == "normal";
    if (name == "creasemethod") {
      if (!normal && method != "uniform" && method != "chaikin") refuse("t creasemethod", method, "unknown method", "normal or chaikin");
      mesh_.crease_method = method == "chaikin" ? CreaseMethod::chaikin : CreaseMethod::uniform;
    } else {
      if (!normal && method != "catmark" && method != "smooth") refuse("t smoothtriangles", method, "unknown rule", "normal or smooth");
      mesh_.triangle_rule = method == "smooth" ? TriangleRule::smooth : TriangleRule::catmark;
    }
  }

  TextCursor cursor_;
  const std::string& place_;
  Mesh& mesh_;
  std::vector<std::int32_t> integers_{};
  std::vector<float> reals_{};
};

}  // namespace

void read_obj_tag(std::string_view text, const std::string& place, Mesh& mesh, ObjTags& tags) {
  std::string name;
  if (!TagReader(text, place, mesh).run(name)) ++tags.unknown[shown_word(name)];
}

void finish_obj_tags(const ObjTags& tags, const std::string& file, Mesh& mesh) {
  for (const auto& [name, count] : tags.unknown)
    mesh.warnings.push_back(fmt::format("'t {}' ({} time{}) is no tag that limn knows: ignored", name, count, count == 1 ? "" : "s"));
  std::sort(mesh.holes.begin(), mesh.holes.end());
  mesh.holes.erase(std::unique(mesh.holes.begin(), mesh.holes.end()), mesh.holes.end());
  for (const std::int32_t hole : mesh.holes)
    if (hole < 0 || static_cast<size_t>(hole) >= mesh.face_count())
      throw InputError({file, "t hole", fmt::format("{}", hole), "face index out of range",
                        mesh.face_count() == 0 ? "a mesh with faces" : fmt::format("0 to {}", mesh.face_count() - 1)});
}

}  // namespace limn
