// Groups of points that ask only the parts of a field near them: every point once, and the whole field's numbers to the last bit.

#include "subdiv/local_field.h"

#include <gtest/gtest.h>

#include <random>

#include "sdf/shape.h"

namespace limn {
namespace {

TEST(LocalField, VisitsEachNamedPointOnceAndAnswersAsTheWholeFieldInsideItsBoxAndOutside) {
  std::vector<Field> balls;
  for (int i = 0; i < 12; ++i) balls.push_back(translate(make_shape("sphere", {{"radius", {0.6}}}), {double(i), 0.3 * (i % 3), 0.0}));
  const Field field = combine(Csg::union_, balls, 0.1);
  std::mt19937_64 random(20261121);
  std::uniform_real_distribution<double> in(-1.0, 12.0);
  std::vector<glm::dvec3> points(500);
  for (glm::dvec3& p : points) p = {in(random), 0.2 * in(random), 0.1 * in(random)};
  points[7] = points[8] = points[9];
  std::vector<std::uint32_t> which;
  for (std::uint32_t i = 0; i < points.size(); i += 2) which.push_back(i);
  std::vector<int> visits(points.size(), 0), right(points.size(), 0);
  visit_groups(field, points, std::vector<double>(points.size(), 0.05), which,
               [&](LocalField& local, std::span<const std::uint32_t> members) {
                 FieldEvaluator whole(field);
                 std::vector<glm::dvec3> starts;
                 for (const std::uint32_t i : members) starts.insert(starts.end(), {points[i], points[i] + glm::dvec3(5.0, 0.0, 0.0)});
                 const std::vector<Landing> together = local.project(starts);
                 const auto same = [&](const Landing& landing, glm::dvec3 point) {
                   const bool reached = project_to_surface(whole, point);
                   double value = 0.0;
                   glm::dvec3 gradient;
                   whole.gradients(std::span(&point, 1), std::span(&value, 1), std::span(&gradient, 1));
                   return landing.reached == reached && landing.position == point && landing.value == value && landing.gradient == gradient;
                 };
                 for (size_t k = 0; k < starts.size(); ++k) right[members[k / 2]] += same(together[k], starts[k]);
                 for (const std::uint32_t i : members) {
                   ++visits[i];
                   for (const glm::dvec3& p : {points[i], points[i] + 0.04, points[i] + glm::dvec3(5.0, 0.0, 0.0)}) {
                     glm::dvec3 here, there;
                     double value = 0.0, other = 0.0;
                     local.gradient(p, value, here);
                     whole.gradients(std::span(&p, 1), std::span(&other, 1), std::span(&there, 1));
                     right[i] += value == other && here == there && local.value(p) == whole.value(p);
                     right[i] += same(local.project(p), p);
                   }
                 }
               });
  for (size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(visits[i], i % 2 == 0 ? 1 : 0) << i;
    EXPECT_EQ(right[i], i % 2 == 0 ? 8 : 0) << i;
  }
}

TEST(LocalField, SaysOfManyPointsWhatTheWholeFieldSaysOfEach) {
  std::vector<Field> parts;
  for (int i = 0; i < 12; ++i) parts.push_back(translate(make_shape("box", {{"half", {0.6, 0.4, 0.5}}}), {double(i), 0.3 * (i % 3), 0.0}));
  const Field field = combine(Csg::union_, parts, 0.0);
  std::mt19937_64 random(20261129);
  std::uniform_real_distribution<double> in(-1.0, 12.0);
  std::vector<glm::dvec3> points(300);
  for (glm::dvec3& p : points) p = {in(random), 0.2 * in(random), 0.1 * in(random)};
  std::vector<int> right(points.size(), 0);
  visit_groups(field, points, 0.05, [&](LocalField& local, std::span<const std::uint32_t> members) {
    std::vector<glm::dvec3> held = members_of(points, members);
    // All within the group's box, some without, none within.
    std::vector<glm::dvec3> some = held, none = held;
    for (size_t i = 0; i < some.size(); i += 3) some[i].x += 4.0;
    for (glm::dvec3& p : none) p.x += 40.0;
    FieldEvaluator whole(field);
    for (const std::vector<glm::dvec3>* asked : {&held, &some, &none}) {
      std::vector<double> values(asked->size()), with_gradients(asked->size());
      std::vector<glm::dvec3> gradients(asked->size());
      local.values(*asked, values);
      local.gradients(*asked, with_gradients, gradients);
      const std::vector<glm::dvec3> directions = local.unit_gradients(*asked);
      const std::vector<double> off = local.distances_off(*asked);
      for (size_t i = 0; i < asked->size(); ++i) {
        const glm::dvec3& p = (*asked)[i];
        double value = 0.0;
        glm::dvec3 gradient;
        whole.gradients(std::span(&p, 1), std::span(&value, 1), std::span(&gradient, 1));
        right[members[i]] += values[i] == whole.value(p) && with_gradients[i] == value && gradients[i] == gradient;
        right[members[i]] += directions[i] == direction_of(gradient) && off[i] == distance_by(value, gradient);
      }
    }
  });
  for (size_t i = 0; i < points.size(); ++i) EXPECT_EQ(right[i], 6) << i;
}

}  // namespace
}  // namespace limn
