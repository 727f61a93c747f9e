#pragma once
// A field's program as a tree, and the parts of a field: which of its shapes owns a place of its surface.

#include <optional>
#include <span>
#include <vector>

#include "sdf/field_program.h"

namespace limn {

/// An instruction, and which instructions made what it reads.
struct FieldNode {
  FieldInstruction instruction{};
  int left = -1, right = -1;  ///< -1 where it reads none.
  int parent = -1;            ///< -1 of the root.
};

/// Takes two values.
bool is_binary(FieldOperation operation);

/// Children before parents; the last is the root.
std::vector<FieldNode> tree_of(const FieldProgram& program);

/// Appends the instructions below a node, whose value comes to slot `target`, with the leaves that they read. Traits are the caller's.
void append_subtree(const FieldProgram& program, std::span<const FieldNode> tree, int node, std::uint32_t target, FieldProgram& out);

/// The node's value as a field. Its traits are those of the whole, which are no narrower, without exact distances.
Field subtree(const Field& field, std::span<const FieldNode> tree, int node);

/// The field with a material, and a colour, on every shape in it that has none yet.
Field with_material(const Field& field, int material, const std::optional<glm::vec3>& color);

/// Some shape in it has a material of its own.
bool has_materials(const Field& field);
/// Some shape in it has a colour of its own.
bool has_colors(const Field& field);

/// Which shape of a field owns a place: of a union the one of lower value, of an intersection the one of higher; what is taken away owns
/// the face that it leaves. A smooth blend belongs to the nearer one, so that two parts meet where their values are equal.
class FieldParts {
 public:
  explicit FieldParts(const Field& field);

  const Field& field() const { return field_; }
  std::span<const FieldNode> tree() const { return tree_; }
  const FieldLeaf& leaf(std::uint32_t index) const { return field_.program().leaves[index]; }

  /// At one place, of every node: its value, and the shape below it that owns it. Memory to be used again.
  struct Place {
    std::vector<double> values{};
    std::vector<std::uint32_t> owners{};
    std::uint32_t owner() const { return owners.back(); }
  };
  /// From any number of threads, each with a place of its own.
  void look(const glm::dvec3& p, Place& place) const;
  /// The shape that owns the place, as an index into the program's leaves.
  std::uint32_t owner(const glm::dvec3& p, Place& place) const {
    look(p, place);
    return place.owner();
  }
  /// Above 0 where the owner of the whole is below `node`; as steep as twice the field at most.
  double ownership(const Place& place, int node) const;

 private:
  Field field_;
  std::vector<FieldNode> tree_;
  /// Faces that coincide belong to one of the two shapes all over: of a union to the first, of an intersection to the second, as where
  /// sharp edges are followed (raymarch/truth/branches.h).
  double epsilon_ = 0.0;
};

/// a - b: 0 where two fields have the same value. It bounds nothing, and is a distance to nothing.
Field difference_of_values(const Field& a, const Field& b);

}  // namespace limn
