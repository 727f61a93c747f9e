#include "tests/raymarch/awkward_cages.h"

#include <algorithm>

namespace limn::test {
namespace {

using Cages = std::vector<AwkwardCage>;
constexpr BoundaryRule kNone = BoundaryRule::none, kEdges = BoundaryRule::edge_only, kCorners = BoundaryRule::edge_and_corner;

void add_valence_two(Cages& out) {
  const std::string kind = "valence 2";
  const Mesh cube = cube_cage(11);
  out.push_back({kind, "cube, one face split", with_valence_two(cube, 1, 0.3)});
  out.push_back({kind, "cube, one face split and pressed in", with_valence_two(cube, 3, -0.4)});
  out.push_back({kind, "cube, two faces split", with_valence_two(with_valence_two(cube, 0, 0.2), 0, 0.2)});
  Mesh all = cube;
  for (int i = 0; i < 6; ++i) all = with_valence_two(all, 0, 0.25);
  out.push_back({kind, "cube, all faces split", all});
  out.push_back({kind, "wave, one face split", with_valence_two(wave_cage(4, 4, 3), 5, 0.25)});
  out.push_back({kind, "open cube, split", with_valence_two(without_faces(cube, {5}), 0, 0.3)});
  out.push_back({kind, "creased edges at the vertex", creased(with_valence_two(cube, 1, 0.3), {{4, 8, 10.0f}, {8, 7, 10.0f}})});
  out.push_back({kind, "a dart at the vertex", creased(with_valence_two(cube, 1, 0.3), {{4, 8, 10.0f}})});
  out.push_back({kind, "a soft crease at the vertex", creased(with_valence_two(cube, 1, 0.3), {{4, 8, 1.5f}})});
  Mesh prism = mesh_of({}, {});
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < 6; ++i) prism.positions.emplace_back(std::cos(1.047 * i), std::sin(1.047 * i), 1.4 * k - 0.7);
  add_face(prism, {5, 4, 3, 2, 1, 0});
  for (int i = 0; i < 6; ++i) add_face(prism, {i, (i + 1) % 6, 6 + (i + 1) % 6, 6 + i});
  add_face(prism, {6, 7, 8, 9, 10, 11});
  out.push_back({kind, "hexagon split in pentagons", with_valence_two(shaken(prism, 0.08, 5), 7, 0.4)});
  out.push_back({kind, "bilinear", with_valence_two(cube, 1, 0.3), Scheme::bilinear});
  out.push_back({kind, "loop, three triangles of a tetrahedron",
                 mesh_of({{1, 0, 0}, {-0.6, 0.8, 0}, {-0.5, -0.9, 0.1}, {0, 0.1, 1.2}}, {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {0, 2, 1}}),
                 Scheme::loop});
}

void add_shared_edges(Cages& out) {
  const std::string kind = "two shared edges";
  out.push_back({kind, "tube of two hexagons", two_sided_tube(1)});
  out.push_back({kind, "long tube", two_sided_tube(3)});
  out.push_back({kind, "tube with sharp corners", ruled(two_sided_tube(2), kCorners)});
}

void add_darts_and_corners(Cages& out) {
  const Mesh cube = cube_cage(21), wave = wave_cage(4, 4, 7);
  out.push_back({"darts", "one sharp edge", creased(cube, {{0, 1, 10.0f}})});
  out.push_back({"darts", "one soft edge", creased(cube, {{0, 1, 2.4f}})});
  out.push_back({"darts", "two edges", creased(cube, {{0, 1, 10.0f}, {1, 3, 10.0f}})});
  out.push_back({"darts", "a crease across half a sheet", creased(wave, {{2, 7, 10.0f}, {7, 12, 10.0f}})});
  out.push_back({"darts", "loop", creased(octahedron_cage(), {{0, 2, 10.0f}}), Scheme::loop});
  out.push_back({"creases", "a sharp ring", creased(cube, {{4, 5, 10.0f}, {5, 7, 10.0f}, {7, 6, 10.0f}, {6, 4, 10.0f}})});
  out.push_back({"creases", "a soft ring", creased(cube, {{4, 5, 2.0f}, {5, 7, 3.3f}, {7, 6, 2.0f}, {6, 4, 1.2f}})});
  out.push_back({"creases", "through an open edge", creased(wave, {{10, 11, 10.0f}, {11, 12, 10.0f}, {12, 13, 10.0f}, {13, 14, 10.0f}})});
  Mesh chaikin = creased(cube, {{4, 5, 2.0f}, {5, 7, 3.3f}, {7, 6, 2.0f}, {6, 4, 1.2f}});
  chaikin.crease_method = CreaseMethod::chaikin;
  out.push_back({"chaikin", "a soft ring", chaikin});
  Mesh corner = cube;
  corner.corners = {{0, 10.0f}, {7, 10.0f}};
  out.push_back({"corners", "two sharp corners", corner});
  corner.corners = {{0, 1.6f}, {3, 3.0f}};
  out.push_back({"corners", "two soft corners", corner});
  out.push_back({"corners", "three creases", creased(cube, {{0, 1, 10.0f}, {0, 2, 10.0f}, {0, 4, 10.0f}})});
  corner = octahedron_cage();
  corner.corners = {{2, 10.0f}};
  out.push_back({"corners", "loop", corner, Scheme::loop});
}

void add_boundaries(Cages& out) {
  const Mesh cube = cube_cage(31);
  const std::pair<BoundaryRule, std::string> rules[] = {{kNone, "none"}, {kEdges, "edges"}, {kCorners, "edges and corners"}};
  for (const auto& [rule, name] : rules) {
    const std::string kind = "open, " + name;
    if (rule != kNone) out.push_back({kind, "cube without a face", ruled(without_faces(cube, {1}), rule)});
    if (rule != kNone) out.push_back({kind, "cube without two faces", ruled(without_faces(cube, {0, 1}), rule)});
    if (rule != kNone) out.push_back({kind, "cube without two faces that touch", ruled(without_faces(cube, {0, 2}), rule)});
    out.push_back({kind, "wave", ruled(wave_cage(4, 4, 9), rule)});
    out.push_back({kind, "wave seen upside down", ruled(wave_cage(5, 3, 10), rule)});
    Mesh turned = wave_cage(4, 4, 12);
    for (size_t f = 0; f < turned.face_count(); ++f) turned = turned_face(turned, f);
    out.push_back({kind, "wave turned round", ruled(turned, rule)});
    const auto bowl = [](double x, double y) { return 1.1 * (x * x + y * y); };
    out.push_back({kind, "bowl", ruled(shaken(grid_cage(4, 4, bowl), 0.04, 5), rule)});
    if (rule != kNone)
      out.push_back({kind, "strip", ruled(shaken(grid_cage(5, 1, [](double x, double) { return std::sin(3.0 * x); }), 0.1, 6), rule)});
    out.push_back({kind, "loop wave", ruled(halved(wave_cage(4, 4, 8)), rule), Scheme::loop});
    out.push_back({kind, "bilinear wave", ruled(wave_cage(3, 3, 8), rule), Scheme::bilinear});
  }
}

void add_non_manifold(Cages& out) {
  const std::string edges = "edges with three faces", vertices = "touching in a vertex";
  out.push_back({edges, "book of three sheets", book_cage({0.0, 130.0, 250.0})});
  out.push_back({edges, "book of four sheets", book_cage({10.0, 95.0, 190.0, 280.0})});
  out.push_back({edges, "three sheets to one side", book_cage({0.0, 40.0, 75.0})});
  out.push_back({edges, "book of three quads rows", ruled(book_cage({0.0, 120.0, 240.0}, 1), kEdges)});
  const Mesh two = block_cage({{0, 0, 0}, {1, 0, 0}});
  Mesh wall = two;
  const auto at = [&](const glm::dvec3& p) {
    return static_cast<std::int32_t>(std::find(wall.positions.begin(), wall.positions.end(), p) - wall.positions.begin());
  };
  add_face(wall, {at({1, 0, 0}), at({1, 1, 0}), at({1, 1, 1}), at({1, 0, 1})});
  out.push_back({edges, "two cubes and the wall between", shaken(wall, 0.08, 41)});
  Mesh fin = cube_cage(43);
  fin.positions.emplace_back(-0.9, 0.9, 2.0);
  fin.positions.emplace_back(1.1, 0.9, 1.9);
  add_face(fin, {6, 7, 9, 8});
  out.push_back({edges, "cube with a fin", fin});
  out.push_back({edges, "two cubes at an edge", shaken(block_cage({{0, 0, 0}, {1, 1, 0}}), 0.06, 44)});
  out.push_back({edges, "sheets that disagree", turned_face(wave_cage(3, 3, 45), 4)});
  out.push_back({edges, "halves that disagree", turned_face(shaken(grid_cage(2, 1, [](double x, double) { return x * x; }), 0.1, 46), 1)});
  out.push_back({edges, "loop book", halved(book_cage({0.0, 130.0, 250.0})), Scheme::loop});
  out.push_back({edges, "bilinear book", book_cage({0.0, 130.0, 250.0}), Scheme::bilinear});
  out.push_back({edges, "a soft crease into the spine", creased(book_cage({0.0, 130.0, 250.0}), {{1, 4, 2.0f}})});
  out.push_back({vertices, "two cubes", shaken(block_cage({{0, 0, 0}, {1, 1, 1}}), 0.06, 47)});
  out.push_back({vertices, "two sheets", merged(joined(wave_cage(2, 2, 48), wave_cage(2, 2, 49), {2.1, 2.0, 0.4}), 8, 9)});
  out.push_back(
      {vertices, "two fans", merged(joined(fan_cage(4, true, true, 1.0), fan_cage(5, false, true, -1.0), {0.0, 0.0, 2.0}), 0, 9)});
  out.push_back({vertices, "two quads", merged(joined(single_face(4), single_face(4), {1.9, 0.5, 0.3}), 0, 6)});
}

void add_single_faces_and_fans(Cages& out) {
  for (const int corners : {3, 4, 5, 6}) {
    out.push_back({"single faces", "corners " + std::to_string(corners), single_face(corners)});
    out.push_back({"single faces", "edges " + std::to_string(corners), ruled(single_face(corners), kEdges)});
  }
  out.push_back({"single faces", "loop", single_face(3), Scheme::loop});
  out.push_back({"single faces", "bilinear", single_face(4), Scheme::bilinear});
  for (const int sides : {3, 4, 6}) {
    out.push_back({"fans", "closed, quads", fan_cage(sides, true, true, 0.9)});
    out.push_back({"fans", "open, quads", fan_cage(sides, true, false, 0.9)});
    out.push_back({"fans", "open, triangles", fan_cage(sides, false, false, 0.7)});
    out.push_back({"fans", "closed, loop", fan_cage(sides, false, true, 0.8), Scheme::loop});
  }
  out.push_back({"bow ties", "a face that passes a vertex twice",
                 mesh_of({{0, 0, 0}, {1, 0.2, 0.3}, {1, 1, 0}, {0.2, 1, 0.4}, {-1, -0.1, 0.2}, {-1, -1, 0.1}, {-0.1, -1, 0.5}},
                         {{0, 1, 2, 3, 0, 4, 5, 6}})});
  out.push_back({"bow ties", "two triangles", merged(joined(single_face(3), single_face(3), {1.7, 0.4, 0.2}), 0, 4)});
}

void add_others(Cages& out) {
  Mesh holes = cube_cage(51);
  holes.holes = {2};
  out.push_back({"holes", "cube", holes});
  holes = wave_cage(5, 5, 52);
  holes.holes = {6, 12, 13};
  out.push_back({"holes", "wave", holes});
  holes = octahedron_cage();
  holes.holes = {1, 6};
  out.push_back({"holes", "loop", holes, Scheme::loop});
  out.push_back({"genus", "one", shaken(slab_cage(1), 0.07, 53)});
  out.push_back({"genus", "three", shaken(slab_cage(3), 0.07, 54)});
  out.push_back({"repeated corners", "globe", globe_cage(5, 4)});
  Mesh smooth = octahedron_cage();
  smooth.triangle_rule = TriangleRule::smooth;
  out.push_back({"triangles", "smooth rule", smooth});
  out.push_back({"triangles", "octahedron", octahedron_cage()});
}

}  // namespace

std::vector<AwkwardCage> awkward_cages() {
  Cages out;
  add_valence_two(out);
  add_shared_edges(out);
  add_darts_and_corners(out);
  add_boundaries(out);
  add_non_manifold(out);
  add_single_faces_and_fans(out);
  add_others(out);
  return out;
}

}  // namespace limn::test
