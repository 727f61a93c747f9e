// Every check fires on an input made for it, with the right number, and is silent on a clean one.

#include "raymarch/audit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <numeric>
#include <random>
#include <set>

#include "raymarch/audit/facts.h"
#include "scenes.h"
#include "sdf/shape.h"
#include "subdiv/import.h"
#include "tests/random_seed.h"
#include "tests/sdf/level_set_maker.h"
#include "tests/subdiv/test_meshes.h"

namespace limn {
namespace {

using test::object_of;

constexpr double kDegrees = 180.0 / std::numbers::pi;

const std::vector<std::string> kAllMethods = [] {
  std::vector<std::string> names;
  for (const BorderMethod& method : border_methods()) names.push_back(method.about.name);
  return names;
}();

AuditSettings thorough(int voxels = 256) {
  AuditSettings settings{.surface = {}, .thorough = true};
  settings.surface.voxels = voxels;
  settings.surface.gradient.clear();
  return settings;
}

/// The finding of a check; a failure and an empty one where there is none.
Finding finding_of(const SceneObject& object, const std::string& check, const AuditSettings& settings = thorough()) {
  for (const Finding& finding : audit(object, settings))
    if (finding.check == check) return finding;
  ADD_FAILURE() << "no finding '" << check << "'";
  return {};
}

std::vector<std::string> warnings_of(const SceneObject& object, const std::vector<std::string>& surfaces,
                                     const AuditSettings& settings = thorough()) {
  std::vector<std::string> checks;
  for (const Finding& finding : audit(object, settings))
    if (matters(finding, surfaces, kAllMethods)) checks.push_back(finding.check);
  return checks;
}

using Names = std::vector<std::string>;

/// Through memory: GCC 12 leaves the rounding out where it vectorises conversions there and back.
double rounded_to_single(double x) {
  volatile float single = static_cast<float>(x);
  return static_cast<double>(single);
}

Mesh moved(Mesh mesh, const glm::dvec3& by, bool to_single) {
  for (glm::dvec3& p : mesh.positions) {
    p += by;
    if (to_single) p = {rounded_to_single(p.x), rounded_to_single(p.y), rounded_to_single(p.z)};
  }
  return mesh;
}

/// Schwarz's lantern: a cylinder of radius 1 and height 2 in `bands` bands of 2 n triangles, each ring turned by half a facet.
Mesh lantern(int n, int bands) {
  Mesh mesh;
  for (int k = 0; k <= bands; ++k)
    for (int i = 0; i < n; ++i) {
      const double a = 2.0 * std::numbers::pi * (i + 0.5 * (k % 2)) / n;
      mesh.positions.emplace_back(std::cos(a), 2.0 * k / bands - 1.0, std::sin(a));
    }
  for (int k = 0; k < bands; ++k)
    for (int i = 0; i < n; ++i) {
      const int next = (i + 1) % n, shift = k % 2, low = k * n, high = low + n;
      // The ring above stands half a facet further on where k is even, half a facet back where it is odd.
      const int above = shift ? next : i, above_next = (above + 1) % n;
      test::add_face(mesh, {low + i, high + above, low + next});
      test::add_face(mesh, {low + next, high + above, high + above_next});
    }
  return mesh;
}

/// Angle between the normals of two triangles of a band that share a side. Each leans by the same angle from the cylinder's normal, one up
/// and one down; across the edge of a ring the angle is a little less, but the triangles at the ends have no neighbour there.
double lantern_angle(int n, int bands) {
  const double lean = std::atan2(1.0 - std::cos(std::numbers::pi / n), 2.0 / bands);
  return std::acos(std::cos(lean) * std::cos(lean) * std::cos(std::numbers::pi / n) - std::sin(lean) * std::sin(lean));
}

Field box(const glm::dvec3& half) { return make_shape("box", {{"half", {half.x, half.y, half.z}}}); }

TEST(Audit, ChecksHaveNamesAndHelpAndCleanInputGivesNoWarning) {
  std::set<std::string> names;
  for (const AuditCheck& check : audit_checks()) {
    EXPECT_FALSE(check.about.help.empty()) << check.about.name;
    EXPECT_TRUE(names.insert(check.about.name).second) << check.about.name;
    EXPECT_NE(check.look, nullptr) << check.about.name;
  }
  const Names surfaces{"analytic", "level_set", "mesh", "mesh_level_set"};
  EXPECT_EQ(warnings_of(object_of(test::sphere(3)), surfaces), Names{});
  EXPECT_EQ(warnings_of(object_of(test::torus(48, 24, 1.0, 0.4)), surfaces), Names{});
  EXPECT_EQ(warnings_of(object_of(test::torus(12, 6, 1.0, 0.4), Scheme::catmark), surfaces), Names{});
  EXPECT_EQ(warnings_of(object_of(make_shape("torus", {})), surfaces), Names{});
  EXPECT_EQ(warnings_of(object_of(make_shape("ellipsoid", {})), surfaces), Names{});
}

TEST(Audit, WhatAReaderRepairedIsSaidForEverySurfaceAndMethod) {
  Mesh mesh = test::cube();
  mesh.warnings = {"2 faces name a vertex that is not there: dropped", "7 normals: ignored"};
  std::vector<Finding> found = audit(object_of(mesh), {});
  std::erase_if(found, [](const Finding& finding) { return finding.check != "file"; });
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[1].message, mesh.warnings[1]);
  EXPECT_FALSE(found[0].remedy.empty());
  const Names grid{"mesh_level_set"}, blur{"blur"};
  EXPECT_TRUE(matters(found[0], grid, blur));
}

TEST(Audit, WhatIsWrongIsSaidWithAMessageAndARemedyAndForWhom) {
  Mesh open = test::cube();
  open.face_sizes.pop_back(), open.corner_vertices.resize(20);
  const Finding finding = finding_of(object_of(open), "open edges");
  EXPECT_EQ(finding.severity, Severity::warning);
  EXPECT_EQ(finding.value, 4.0);
  EXPECT_NE(finding.message.find("4 edges"), std::string::npos) << finding.message;
  EXPECT_NE(finding.remedy.find("mesh_level_set"), std::string::npos) << finding.remedy;
  const Names mesh{"mesh"}, grid{"mesh_level_set"}, rim{"rim"}, blur{"blur"};
  EXPECT_TRUE(matters(finding, mesh, rim));
  EXPECT_FALSE(matters(finding, grid, rim)) << "its sign is the winding number's";
  EXPECT_FALSE(matters(finding, mesh, blur)) << "it reads no normals";
  EXPECT_EQ(finding_of(object_of(open), "inside").value, 0.0);
  EXPECT_EQ(finding_of(object_of(test::cube()), "inside").value, 1.0);
}

TEST(Audit, SchwarzsLanternIsToldFromSliversThatDoNoHarm) {
  for (const int n : {12, 24, 48}) {
    const int bands = n * n / 3;
    const Finding finding = finding_of(object_of(lantern(n, bands)), "sliver normals");
    EXPECT_EQ(finding.severity, Severity::warning) << n;
    EXPECT_NEAR(finding.value, lantern_angle(n, bands) * kDegrees, 1e-6) << "it does not fall with finer faces: " << n;
    EXPECT_NE(finding.message.find("100 %"), std::string::npos) << finding.message;
  }
  EXPECT_EQ(finding_of(object_of(lantern(48, 48)), "sliver normals").severity, Severity::info) << "as many bands as facets converges";
  // Needles in a plane, beside a crease.
  Mesh strip;
  for (int i = 0; i <= 40; ++i) strip.positions.emplace_back(0.1 * i, 0.0, i % 2 ? 0.004 : 0.0);
  for (int i = 0; i + 2 <= 40; ++i) {
    if (i % 2)
      test::add_face(strip, {i, i + 2, i + 1});
    else
      test::add_face(strip, {i, i + 1, i + 2});
  }
  EXPECT_EQ(finding_of(object_of(strip), "sliver normals").value, 0.0);
  EXPECT_GT(mesh_facts(strip).smallest_angle, 0.0);
}

TEST(Audit, OrientationCountsInvertedPartsAndNotTheWallsOfCavities) {
  const Mesh inverted = test::turned_inside_out(test::cube());
  EXPECT_EQ(finding_of(object_of(inverted), "inverted parts").value, 1.0);
  // A cube without normals is drawn with its facets, on which N.V hardly changes.
  EXPECT_EQ(warnings_of(object_of(inverted), {"mesh"}), (Names{"inverted parts", "flat regions"}));
  EXPECT_EQ(warnings_of(object_of(inverted), {"mesh_level_set"}), Names{"flat regions"}) << "as a whole it is turned back";

  // As every file comes: turned round, and told.
  const SceneObject turned{.name = "mesh", .source = mesh_source(inverted, {}, "cube.obj")};
  EXPECT_EQ(finding_of(turned, "inverted parts").value, 1.0);
  EXPECT_NE(finding_of(turned, "inverted parts").message.find("turned round"), std::string::npos);
  EXPECT_EQ(mesh_facts(std::get<MeshSource>(turned.source).mesh).inverted_parts, 0);

  Mesh hollow = test::cube();
  test::append(hollow, test::turned_inside_out(test::box_at(glm::dvec3(0.5), glm::dvec3(0.0))));
  EXPECT_EQ(finding_of(object_of(hollow), "inverted parts").value, 0.0);
  EXPECT_EQ(mesh_facts(hollow).cavities, 1);

  // Within the box of an L, but not within the L.
  Mesh beside = test::box_at({2.0, 0.2, 0.2}, {0.0, -2.0, 0.0});
  const Mesh leg = test::box_at({0.2, 2.0, 0.2}, {-1.8, 0.2, 0.0});
  test::append(beside, leg);
  test::append(beside, test::turned_inside_out(test::box_at(glm::dvec3(0.1), {1.0, 1.0, 0.0})));
  EXPECT_EQ(mesh_facts(beside).inverted_parts, 1);
  EXPECT_EQ(mesh_facts(beside).cavities, 0);

  Mesh flipped = test::cube();
  std::reverse(flipped.corner_vertices.begin(), flipped.corner_vertices.begin() + 4);
  EXPECT_EQ(finding_of(object_of(flipped), "inconsistent orientation").value, 4.0);
}

TEST(Audit, FacesTwiceThereAreWrongAndFacesWithoutAreaAreOnlyCounted) {
  Mesh twice = test::cube();
  test::add_face(twice, {2, 3, 1, 0});
  EXPECT_EQ(finding_of(object_of(twice), "duplicate faces").value, 1.0);
  EXPECT_EQ(finding_of(object_of(twice), "duplicate faces").severity, Severity::warning);
  EXPECT_GT(finding_of(object_of(twice), "non-manifold edges").value, 0.0);

  // Random faces about few vertices: as many sorted corner lists as there are, less the different ones.
  const unsigned seed = random_seed();
  SCOPED_TRACE(testing::Message() << "seed " << seed);
  std::mt19937 random(seed);
  Mesh mesh;
  for (int i = 0; i < 12; ++i) mesh.positions.emplace_back(std::sin(i), std::cos(2 * i), 0.1 * i);
  std::set<std::vector<std::int32_t>> different;
  for (int f = 0; f < 300; ++f) {
    std::vector<std::int32_t> corners(12);
    std::iota(corners.begin(), corners.end(), 0);
    std::shuffle(corners.begin(), corners.end(), random);
    corners.resize(3 + random() % 2);
    mesh.face_sizes.push_back(static_cast<std::int32_t>(corners.size()));
    mesh.corner_vertices.insert(mesh.corner_vertices.end(), corners.begin(), corners.end());
    std::sort(corners.begin(), corners.end());
    different.insert(corners);
  }
  EXPECT_EQ(mesh_facts(mesh).duplicate_faces, 300 - static_cast<std::int64_t>(different.size()));

  Mesh flat = test::sphere(2);
  test::add_face(flat, {0, 1, 0});
  const Finding zero = finding_of(object_of(flat), "zero-area faces");
  EXPECT_EQ(zero.value, 1.0);
  EXPECT_EQ(zero.severity, Severity::info);
}

TEST(Audit, PrecisionIsMeasuredOnTheFilesOwnDigits) {
  const Mesh sphere = test::sphere(3);
  const glm::dvec3 far(1e6, 0.0, 0.0);
  const Finding lost = finding_of(object_of(moved(sphere, far, true)), "precision");
  EXPECT_EQ(lost.severity, Severity::warning);
  const MeshFacts facts = mesh_facts(moved(sphere, far, true));
  EXPECT_EQ(facts.coordinate_step, 0.0625);
  EXPECT_NEAR(lost.value, 0.0625 / facts.median_edge, 1e-12);
  EXPECT_EQ(finding_of(object_of(moved(sphere, far, false)), "precision").severity, Severity::info) << "double keeps the digits";
  EXPECT_EQ(finding_of(object_of(moved(test::cube(), far, true)), "precision").severity, Severity::info) << "whole numbers lose none";
  EXPECT_EQ(finding_of(object_of(moved(sphere, glm::dvec3(10.0), true)), "precision").severity, Severity::info);
}

TEST(Audit, ThinWallsSayTheirShareAndHowManyVoxelsWouldHoldThem) {
  const double thickness = 0.02;
  const Field plate = box({1.0, 0.5 * thickness, 1.0});
  const SceneObject objects[] = {object_of(plate), object_of(test::box_at({1.0, 0.5 * thickness, 1.0}, glm::dvec3(0.0)))};
  for (const SceneObject& object : objects) {
    const Finding coarse = finding_of(object, "thin walls", thorough(64));
    EXPECT_EQ(coarse.severity, Severity::warning);
    EXPECT_GT(coarse.value, 0.9);
    EXPECT_NE(coarse.remedy.find("voxels = 200 "), std::string::npos) << coarse.remedy;
    EXPECT_NE(coarse.message.find("0.02, 0.64 voxels"), std::string::npos) << coarse.message;
    EXPECT_EQ(finding_of(object, "thin walls", thorough(256)).severity, Severity::info);
    EXPECT_EQ(finding_of(object, "narrow gaps", thorough(64)).value, 0.0);
  }
}

TEST(Audit, NarrowGapsAreToldFromWalls) {
  const double gap = 0.02;
  const auto half = [&](double side) { return translate(box({1.0, 0.5, 1.0}), {0.0, side * (0.5 + 0.5 * gap), 0.0}); };
  const std::vector<Field> both{half(-1.0), half(1.0)};
  const SceneObject object = object_of(combine(Csg::union_, both));
  const Finding coarse = finding_of(object, "narrow gaps", thorough(64));
  EXPECT_EQ(coarse.severity, Severity::warning);
  // Two of twelve sides of 2 x 2 and 2 x 1 face each other: 8 of 32.
  EXPECT_NEAR(coarse.value, 0.25, 0.04);
  EXPECT_EQ(finding_of(object, "thin walls", thorough(64)).value, 0.0);
  EXPECT_EQ(finding_of(object, "narrow gaps", thorough(128)).severity, Severity::info);
}

TEST(Audit, FlatRegionsAreAShareOfTheArea) {
  // Caps of a cylinder: 2 pi r^2 of 2 pi r^2 + 4 pi r h.
  const SceneObject cylinder = object_of(make_shape("cylinder", {{"radius", {1.0}}, {"half_height", {1.0}}}));
  const Finding caps = finding_of(cylinder, "flat regions");
  EXPECT_EQ(caps.severity, Severity::warning);
  EXPECT_NEAR(caps.value, 1.0 / 3.0, 0.03);
  EXPECT_EQ(finding_of(object_of(box(glm::dvec3(1.0))), "flat regions").value, 1.0);
  EXPECT_EQ(finding_of(object_of(make_shape("torus", {})), "flat regions").value, 0.0);
  EXPECT_NE(std::find(caps.methods.begin(), caps.methods.end(), "rim"), caps.methods.end());
  EXPECT_EQ(std::find(caps.methods.begin(), caps.methods.end(), "edge_quads"), caps.methods.end());

  // A grid of squares in a plane, its normals all the same; a sphere's differ even across one face.
  EXPECT_EQ(finding_of(object_of(test::grid(6, 6)), "flat regions").value, 1.0);
  EXPECT_EQ(finding_of(object_of(test::sphere(1)), "flat regions").value, 0.0);
}

TEST(Audit, FieldsTellTheirSlopeAndWhereTheyHaveNoNormal) {
  const testing_tools::Ellipsoid ellipsoid{.radii = {1.0, 0.7, 0.5}};
  const Finding slope = finding_of(object_of(ellipsoid.field()), "slope");
  EXPECT_EQ(slope.severity, Severity::info);
  EXPECT_GT(slope.value, 0.5 - 1e-9);
  EXPECT_LT(slope.value, 1.0 + 1e-9);
  EXPECT_NEAR(finding_of(object_of(make_shape("torus", {})), "slope").value, 1.0, 1e-9);
}

TEST(Audit, UnboundedFieldsAreToldToWhatNeedsBounds) {
  const SceneObject plane = object_of(make_shape("plane", {}));
  EXPECT_EQ(warnings_of(plane, {"level_set"}), Names{"unbounded"});
  EXPECT_EQ(warnings_of(plane, {"analytic"}), Names{});
}

LevelSet scaled_ball(double slope) {
  constexpr double voxel = 0.05, half_width = 3.0 * voxel;
  std::vector<LevelSetBlock> blocks;
  for (int x = -4; x < 4; ++x)
    for (int y = -4; y < 4; ++y)
      for (int z = -4; z < 4; ++z) {
        LevelSetBlock block{8 * glm::ivec3(x, y, z), {}, {}};
        for (int n = 0; n < 512; ++n) {
          const glm::dvec3 p = voxel * glm::dvec3(block.origin + glm::ivec3(n >> 6, (n >> 3) & 7, n & 7));
          const double distance = glm::length(p) - 1.0;
          const bool active = std::abs(distance) <= half_width;
          if (active) block.active[n >> 6] |= std::uint64_t{1} << (n & 63);
          block.values[n] = static_cast<float>(slope * std::clamp(distance, -half_width, half_width));
        }
        blocks.push_back(block);
      }
  return level_set_from_blocks(blocks, voxel, 3.0, "ball");
}

TEST(Audit, AVolumeThatIsNoDistanceFieldIsToldToThoseWhoNeedDistances) {
  const auto object = [](double slope) { return SceneObject{.name = "ball", .source = LevelSetSource{scaled_ball(slope), ""}}; };
  const Finding good = finding_of(object(1.0), "slope"), bad = finding_of(object(0.5), "slope");
  EXPECT_EQ(good.severity, Severity::info);
  EXPECT_NEAR(good.value, 1.0, 0.01);
  EXPECT_EQ(bad.severity, Severity::warning);
  EXPECT_NEAR(bad.value, 0.5, 0.01);
  EXPECT_EQ(bad.methods, Names{"extrude"});
  EXPECT_NE(bad.message.find("2 times as wide"), std::string::npos) << bad.message;
}

TEST(Audit, ABandTooThinForAGradientIsNamedWithHowManyCellsLackDistances) {
  const LevelSet thin = level_set_from_field(make_shape("sphere", {}), {.voxel_size = 0.1, .half_width_voxels = 1.8});
  const SceneObject object{.name = "ball", .source = LevelSetSource{thin, ""}};
  int named = 0;
  for (const GradientDescriptor& gradient : gradients()) {
    const Finding finding = finding_of(object, "band for " + gradient.about.name);
    EXPECT_EQ(finding.value, static_cast<double>(cells_lacking(thin, gradient)));
    EXPECT_EQ(finding.severity, Severity::info) << gradient.about.name;
    const bool enough = thin.info().half_width_voxels >= gradient.half_width_voxels;
    EXPECT_EQ(finding.value == 0.0, enough) << gradient.about.name;
    named += !enough;
    AuditSettings asked = thorough();
    asked.surface.gradient = gradient.about.name;
    EXPECT_EQ(finding_of(object, "band for " + gradient.about.name, asked).severity, enough ? Severity::info : Severity::warning);
  }
  EXPECT_GT(named, 0);
}

TEST(Audit, QuickChecksArePartOfTheThoroughOnesAndSayTheSame) {
  for (const SceneObject& object : {object_of(lantern(12, 48)), object_of(box(glm::dvec3(1.0)))}) {
    const std::vector<Finding> quick = audit(object, {}), all = audit(object, thorough());
    EXPECT_LT(quick.size(), all.size());
    for (const Finding& one : quick) {
      const auto same = std::find_if(all.begin(), all.end(), [&](const Finding& other) { return other.check == one.check; });
      ASSERT_NE(same, all.end()) << one.check;
      EXPECT_EQ(same->message, one.message);
      EXPECT_EQ(same->value, one.value);
    }
  }
}

TEST(Audit, EveryCheckThatRanSaysWhatItTook) {
  for (const bool all : {false, true}) {
    std::vector<AuditCost> costs;
    audit(object_of(lantern(12, 48)), {.thorough = all}, &costs);
    std::vector<AuditCheck> ran(audit_checks().begin(), audit_checks().end());
    std::erase_if(ran, [&](const AuditCheck& check) { return !all && !check.quick; });
    ASSERT_EQ(costs.size(), ran.size());
    for (size_t i = 0; i < ran.size(); ++i) {
      EXPECT_EQ(costs[i].check, ran[i].about.name);
      EXPECT_EQ(costs[i].quick, ran[i].quick);
      EXPECT_GE(costs[i].ms, 0.0);
    }
  }
}

TEST(Audit, AChecksThatNothingAskedForIsConcernedByIsNotRun) {
  const SceneObject object = object_of(lantern(12, 48));
  const auto ran = [&](AuditSettings settings) {
    std::vector<AuditCost> costs;
    audit(object, settings, &costs);
    std::set<std::string> names;
    for (const AuditCost& cost : costs) names.insert(cost.check);
    return names;
  };
  EXPECT_TRUE(ran({.thorough = true}).contains("parts"));
  const std::set<std::string> drawn = ran({.surfaces = {"mesh"}, .methods = {"rim"}});
  EXPECT_FALSE(drawn.contains("parts")) << "it never warns";
  EXPECT_TRUE(drawn.contains("slivers"));
  EXPECT_FALSE(ran({.surfaces = {"analytic"}, .methods = {"rim"}}).contains("open edges"));
  EXPECT_FALSE(ran({.thorough = true, .surfaces = {"mesh"}, .methods = {"rim"}}).contains("thin"));
  EXPECT_TRUE(ran({.thorough = true, .surfaces = {"mesh_level_set"}, .methods = {"rim"}}).contains("thin"));
  // What is left out would not have mattered.
  for (const char* surface : {"mesh", "mesh_level_set"}) {
    const AuditSettings asked{.surfaces = {surface}, .methods = {"rim"}};
    std::vector<std::string> all, some;
    for (const Finding& finding : audit(object, {}))
      if (matters(finding, asked.surfaces, asked.methods)) all.push_back(finding.message);
    for (const Finding& finding : audit(object, asked))
      if (matters(finding, asked.surfaces, asked.methods)) some.push_back(finding.message);
    EXPECT_EQ(all, some) << surface;
  }
}

/// A sheet of triangles with every tenth one missing, so that open edges are everywhere.
Mesh holed_sheet(int side) {
  Mesh mesh;
  for (int y = 0; y <= side; ++y)
    for (int x = 0; x <= side; ++x) mesh.positions.emplace_back(x, y, 0.1 * std::sin(0.3 * x) * std::cos(0.2 * y));
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      const int a = y * (side + 1) + x, b = a + 1, c = a + side + 1, d = c + 1;
      if ((7 * x + 3 * y) % 10 != 0) test::add_face(mesh, {a, b, d});
      test::add_face(mesh, {a, d, c});
    }
  return mesh;
}

TEST(Audit, OfALargeMeshASampleTellsWhatAllOfItDoes) {
  const Mesh mesh = holed_sheet(280);
  ASSERT_GT(mesh.face_count(), 100'000u);
  const MeshFacts all = mesh_facts(mesh), some = sampled_mesh_facts(mesh, 20'000);
  EXPECT_EQ(some.faces, all.faces);
  EXPECT_EQ(some.looked_at, 20'000);
  EXPECT_EQ(all.looked_at, all.faces);
  // Of edges as many are open as among all; edges of sampled faces are looked at once each.
  EXPECT_NEAR(static_cast<double>(some.open_edges) / 20'000.0, static_cast<double>(all.open_edges) / static_cast<double>(all.faces), 0.03);
  EXPECT_EQ(some.non_manifold_edges, 0);
  EXPECT_EQ(some.inconsistent_edges, 0);
  EXPECT_NEAR(some.median_edge, all.median_edge, 0.05 * all.median_edge);
  EXPECT_EQ(some.largest_coordinate, all.largest_coordinate);
  // Sampling all of it is looking at all.
  const MeshFacts every = sampled_mesh_facts(mesh, mesh.face_count());
  EXPECT_EQ(every.open_edges, all.open_edges);
  EXPECT_EQ(every.slivers, all.slivers);
  EXPECT_EQ(every.zero_area_faces, all.zero_area_faces);
  EXPECT_EQ(every.smallest_angle, all.smallest_angle);
  EXPECT_EQ(every.off_normal_faces, all.off_normal_faces);
  EXPECT_EQ(every.median_edge, all.median_edge);

  const auto open = [&](const AuditSettings& settings) { return finding_of(object_of(mesh), "open edges", settings); };
  const AuditSettings quick{.surfaces = {"mesh"}, .methods = {"rim"}};
  EXPECT_EQ(open(quick).severity, Severity::warning);
  EXPECT_NE(open(quick).message.find("20000 of its " + std::to_string(all.faces) + " faces"), std::string::npos) << open(quick).message;
  EXPECT_EQ(open(thorough()).value, static_cast<double>(all.open_edges));
}

/// "thin walls" of the audit, and whether the level set that is drawn warns of them.
testing::AssertionResult agree_on(const SceneObject& object, int voxels) {
  AuditSettings settings = thorough(voxels);
  settings.surface.level = 2;
  const Finding walls = finding_of(object, "thin walls", settings), gaps = finding_of(object, "narrow gaps", settings);
  SurfaceSettings drawn = settings.surface;
  drawn.kind = "mesh_level_set";
  drawn.gradient = "central";
  std::string warnings;
  const SceneModel model = build_model(test::scene_of({object}), drawn);
  for (const std::string& warning : model.surfaces[0].info.warnings) warnings += warning + "\n";
  const bool thin = warnings.find("walls thinner than two voxels") != std::string::npos;
  const bool narrow = warnings.find("gaps narrower than one voxel") != std::string::npos;
  if (thin == (walls.severity == Severity::warning) && narrow == (gaps.severity == Severity::warning)) return testing::AssertionSuccess();
  return testing::AssertionFailure() << object.name << " " << voxels << ": " << walls.message << "; " << gaps.message << "\n" << warnings;
}

TEST(Audit, InfoAndAPictureSayTheSameOfThinWallsAndGaps) {
  std::vector<SceneObject> objects{object_of(test::box_at({1.0, 0.04, 1.0}, glm::dvec3(0.0))), object_of(test::torus(24, 12, 2.0, 0.3)),
                                   object_of(lantern(6, 24)), object_of(test::cube(), Scheme::catmark)};
  for (const std::string name : {"spot_control_mesh", "pig_quad_controlmesh"}) {
    objects.push_back(object_of(load_mesh(std::filesystem::path(LIMN_TEST_DATA) / (name + ".obj"))));
    objects.back().name = name;
  }
  for (const SceneObject& object : objects) EXPECT_TRUE(agree_on(object, 40));
}

}  // namespace
}  // namespace limn
