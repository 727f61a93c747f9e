#pragma once
// Outlines of several objects: which pixels belong together, which of two groups is in front where they meet in the picture, and what a
// group shows without the others. Methods with the parameters `group` and `hidden` share all of it.

#include <algorithm>

#include "raymarch/border.h"
#include "raymarch/border/pixel_window.h"

namespace limn {

enum class GroupBy { all, object, material };

struct GroupSettings {
  GroupBy by = GroupBy::all;
  bool hidden = false;  ///< Draw the outline of what other groups hide (with GroupBy::all: of what other objects hide).
  glm::vec3 hidden_color{0.0f};
};

/// `group`, `hidden` and `hidden_color`, for a method's own list.
std::vector<Parameter> group_parameters(GroupBy by);
GroupSettings group_settings(const Parameters& parameters);
/// Layers that a method with these parameters reads besides its own inputs when it is called with `parameters`; none for other methods.
std::vector<std::string> group_inputs(const BorderMethod& method, const Parameters& parameters);

/// What two neighbouring pixels of different groups show of each other: one lies in front, or the surfaces touch there.
enum class Meeting { first_in_front, second_in_front, touching };

class PictureGroups {
 public:
  /// Reads id, Z and N, and material for GroupBy::material. With GroupBy::all every object is a group: who asks has no use for one group.
  PictureGroups(const BorderInput& input, GroupBy by);

  std::int32_t count() const { return static_cast<std::int32_t>(windows_.size()); }
  /// Group that pixel i shows, from 1; 0: nothing.
  std::int32_t of(size_t i) const { return group_.pixels[i]; }
  const PixelWindow& window(std::int32_t group) const { return windows_[static_cast<size_t>(group - 1)]; }
  /// The object (from 1) or material that the group is.
  std::int32_t key(std::int32_t group) const { return keys_[static_cast<size_t>(group - 1)]; }
  /// 0 where nothing of it is seen.
  std::int32_t group_of_key(std::int32_t key) const {
    const auto found = std::lower_bound(keys_.begin(), keys_.end(), key);
    return found != keys_.end() && *found == key ? static_cast<std::int32_t>(found - keys_.begin()) + 1 : 0;
  }
  const GBuffer& seen() const { return input_.gbuffer; }

  /// The planes of both surfaces, brought to the image point between the pixels (`at_first`: to that of the first).
  Meeting meeting(size_t first, size_t second, bool at_first = false) const;
  /// The outline between the two belongs to the first's group: nothing lies behind it, or the first does not; where they touch, the group
  /// that is in front of the other where they do not, and if neither is the first in the scene. Which one that is hangs on the eye and the
  /// scene alone: a line must not change sides with the frame that cuts it or the picture's size.
  bool in_front(size_t first, size_t second, bool at_first = false) const;
  bool touching(size_t first, size_t second) const;

 private:
  std::shared_ptr<const GroupOrders> find_orders() const;
  bool any_touching() const;
  std::int32_t key_of(const GBuffer& seen, size_t i) const;
  const BorderInput& input_;
  GroupBy by_;
  Image<std::int32_t> group_{};
  std::vector<PixelWindow> windows_{};
  std::vector<std::int32_t> keys_{};
  std::shared_ptr<const GroupOrders> orders_{};
};

/// Pairs of neighbouring pixels that show different objects.
std::int64_t object_boundaries(const GBuffer& gbuffer);
/// A note for GroupBy::all: between objects there is no line. Nothing where objects do not meet in the picture.
void add_group_note(const std::string& method, const BorderInput& input, std::vector<std::string>& notes);

/// Objects (indices from 0) that have an outline of their own where something else hides them.
struct HiddenGroup {
  std::vector<size_t> objects{};  ///< In order.
  /// Pixel i shows another object.
  bool hides(const GBuffer& seen, size_t i) const { return seen.id.pixels[i] != 0 && !member(static_cast<size_t>(seen.id.pixels[i] - 1)); }
  bool member(size_t object) const { return std::binary_search(objects.begin(), objects.end(), object); }
};
/// Of those whose place in the picture shows others too.
std::vector<HiddenGroup> hidden_groups(const BorderInput& input, GroupBy by);
/// A group as if nothing else were there.
struct GroupAlone {
  GBuffer seen{};        ///< Of the whole picture; ids as there.
  PixelWindow window{};  ///< Holds all pixels that show the group.
};
/// Draws into `alone`, which is empty or shows another group of the same picture: the cost is that of the pixels that either can cover.
void render_alone(const BorderInput& input, const HiddenGroup& group, GroupAlone& alone);

/// Lays ink of another colour beneath a border's own.
void lay_hidden_ink(const Image<float>& hidden, const glm::vec3& color, Border& border);

}  // namespace limn
