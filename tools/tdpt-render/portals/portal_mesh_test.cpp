// What artists draw is flattened into planes, or recognised as no opening.
#include "tools/tdpt-render/portals/portal_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::portal_mesh_test {

Portal square() {
  return rectangle({2, 0, 0}, {0, 0, 1}, {0, 1, 0});
}
/// n x n cells, each with its own vertices as flat shading exports them; at x = depth(y, z), y and
/// z in 0..1.
Portal sheet(int n, const std::function<double(double, double)>& depth) {
  Portal p{"sheet", {}, {}, {}};
  for (int i = 0; i < n * n; ++i) {
    const auto base = static_cast<uint32_t>(p.vertices.size());
    for (const auto& [y, z] :
         {std::pair(0, 0), std::pair(0, 1), std::pair(1, 1), std::pair(1, 0)}) {
      const double v = static_cast<double>(i / n + y) / n, w = static_cast<double>(i % n + z) / n;
      p.vertices.push_back({depth(v, w), v, w});
    }
    p.triangles.push_back({base, base + 1, base + 2});
    p.triangles.push_back({base, base + 2, base + 3});
  }
  return p;
}
Vec3d mean_normal(const Portal& p) {
  Vec3d sum;
  for (const auto& t : p.triangles)
    sum += cross(p.vertices[t[1]] - p.vertices[t[0]], p.vertices[t[2]] - p.vertices[t[0]]);
  return normalize(sum);
}

TEST(portal_mesh, what_is_well_drawn_is_left_as_it_is) {
  Portal portal = square();
  const PortalMesh found = tidy(portal);
  EXPECT_EQ(found.shape, PortalMesh::planar);
  EXPECT_EQ(found.planes, 1u);
  EXPECT_FALSE(found.turned);
  EXPECT_EQ(portal.vertices, square().vertices);
  EXPECT_EQ(portal.triangles, square().triangles);
}

TEST(portal_mesh, two_hundred_triangles_in_one_plane_become_two) {
  Portal portal = sheet(10, [](double, double) { return 2.0; });
  const Vec3d normal = mean_normal(portal);
  const PortalMesh found = tidy(portal);
  EXPECT_EQ(found.shape, PortalMesh::planar);
  EXPECT_EQ(found.triangles, 200u);
  EXPECT_EQ(portal.triangles.size(), 2u);
  EXPECT_NEAR(area_of(portal), 1, 1e-9);
  EXPECT_NEAR(dot(mean_normal(portal), normal), 1, 1e-9);
}

TEST(portal_mesh, a_vertex_moved_a_little_is_laid_into_the_plane) {
  Portal portal = square();
  portal.vertices[2].x += 0.05;
  const PortalMesh found = tidy(portal);
  EXPECT_EQ(found.shape, PortalMesh::flattened);
  EXPECT_EQ(found.planes, 1u);
  EXPECT_GT(found.off, 0.01);
  EXPECT_LT(found.off, 0.04);
  EXPECT_NEAR(area_of(portal), 1, 0.01);
  EXPECT_EQ(PortalMesh(tidy(portal)).shape, PortalMesh::planar);
}

TEST(portal_mesh, a_vertex_moved_far_makes_planes) {
  Portal portal = square();
  portal.vertices[2].x += 0.4;
  EXPECT_EQ(tidy(portal).shape, PortalMesh::bent);
  // A bay of 800 triangles: three panes.
  Portal bay = sheet(20, [](double, double z) { return std::min({z, 0.25, 1 - z}); });
  const PortalMesh found = tidy(bay);
  EXPECT_EQ(found.shape, PortalMesh::bent);
  EXPECT_EQ(found.planes, 3u);
  EXPECT_EQ(bay.triangles.size(), 6u);
  EXPECT_NEAR(area_of(bay), 0.5 + std::sqrt(0.5), 1e-9);
}

// A line that passes a dome passes its rim.
TEST(portal_mesh, a_dome_is_replaced_by_its_rim) {
  const auto dome = [](double y, double z) {
    return 2 + 0.3 * std::sin(std::numbers::pi * y) * std::sin(std::numbers::pi * z);
  };
  Portal portal = sheet(10, dome);
  const Vec3d normal = mean_normal(portal);
  const PortalMesh found = tidy(portal);
  EXPECT_EQ(found.shape, PortalMesh::lid);
  EXPECT_EQ(found.planes, 1u);
  EXPECT_EQ(portal.triangles.size(), 2u);
  EXPECT_NEAR(area_of(portal), 1, 1e-9);
  EXPECT_NEAR(dot(mean_normal(portal), normal), 1, 1e-9);
  // Half a dome: its rim is not planar.
  Portal half = sheet(10, [&](double y, double z) { return dome(0.5 * y, z); });
  EXPECT_NE(tidy(half).shape, PortalMesh::lid);
}

// Too many planes to use.
TEST(portal_mesh, a_crumpled_sheet_is_laid_into_a_plane) {
  const auto waves = [](double height) {
    return sheet(24, [height](double y, double z) {
      return 2 + height * std::sin(20 * y) * std::sin(17 * z);
    });
  };
  Portal sheet = waves(0.05);
  const PortalMesh found = tidy(sheet);
  EXPECT_EQ(found.shape, PortalMesh::flattened);
  EXPECT_LT(sheet.triangles.size(), 60u);
  EXPECT_GT(found.off, 0.04);
  EXPECT_LT(found.off, 0.1);
  EXPECT_NEAR(area_of(sheet), 1, 0.02);
  // Crumpled more, it faces many ways.
  sheet = waves(0.2);
  EXPECT_EQ(tidy(sheet).shape, PortalMesh::folded);
  EXPECT_EQ(sheet.triangles.size(), 1152u);
}

TEST(portal_mesh, what_is_folded_or_closed_is_no_opening) {
  Portal folded = sheet(4, [](double, double z) { return 2 * std::abs(z - 0.5); });
  EXPECT_EQ(tidy(folded).shape, PortalMesh::folded);
  EXPECT_EQ(folded.triangles.size(), 32u);
  // A gentler fold is only bent.
  folded = sheet(4, [](double, double z) { return std::abs(z - 0.5); });
  EXPECT_EQ(tidy(folded).shape, PortalMesh::bent);
  Portal body{"box", {}, {}, {}};
  for (uint32_t i = 0; i < 8; ++i)
    body.vertices.push_back({i & 1 ? 1.0 : 0.0, i & 2 ? 1.0 : 0.0, i & 4 ? 1.0 : 0.0});
  for (const auto& f : {std::array<uint32_t, 4>{0, 2, 3, 1},
                        {4, 5, 7, 6},
                        {0, 1, 5, 4},
                        {2, 6, 7, 3},
                        {0, 4, 6, 2},
                        {1, 3, 7, 5}}) {
    body.triangles.push_back({f[0], f[1], f[2]});
    body.triangles.push_back({f[0], f[2], f[3]});
  }
  EXPECT_EQ(tidy(body).shape, PortalMesh::body);
  EXPECT_EQ(body.triangles.size(), 12u);
  body.triangles.resize(10);  // without its lid
  EXPECT_EQ(tidy(body).shape, PortalMesh::folded);
}

// Two openings drawn as one mesh, in walls that face each other.
TEST(portal_mesh, parts_apart_may_face_all_ways) {
  Portal portal = square();
  const Portal other = rectangle({5, 0, 0}, {0, 1, 0}, {0, 0, 1});
  for (const Vec3d& v : other.vertices) portal.vertices.push_back(v);
  portal.triangles.push_back({4, 5, 6});
  portal.triangles.push_back({4, 6, 7});
  const Portal drawn = portal;
  const PortalMesh found = tidy(portal);
  EXPECT_EQ(found.shape, PortalMesh::planar);
  EXPECT_EQ(found.planes, 2u);
  EXPECT_EQ(portal.triangles, drawn.triangles);
}

TEST(portal_mesh, neighbours_are_turned_to_agree_with_the_larger_part) {
  Portal portal = sheet(4, [](double, double) { return 2.0; });
  const Vec3d normal = mean_normal(portal);
  for (size_t t = 0; t < 10; ++t) std::swap(portal.triangles[t][1], portal.triangles[t][2]);
  EXPECT_TRUE(tidy(portal).turned);
  EXPECT_EQ(portal.triangles.size(), 2u);
  EXPECT_NEAR(dot(mean_normal(portal), normal), 1, 1e-9);
  EXPECT_FALSE(portal.both_ways);
}

TEST(portal_mesh, copies_count_once_and_two_faces_back_to_back_work_both_ways) {
  Portal portal = square();
  for (const auto& t : square().triangles) portal.triangles.push_back(t);
  EXPECT_EQ(tidy(portal).triangles, 2u);
  EXPECT_EQ(portal.triangles.size(), 2u);
  EXPECT_FALSE(portal.both_ways);
  for (const auto& t : square().triangles) portal.triangles.push_back({t[0], t[2], t[1]});
  EXPECT_EQ(tidy(portal).shape, PortalMesh::planar);
  EXPECT_EQ(portal.triangles.size(), 2u);
  EXPECT_TRUE(portal.both_ways);
}

}  // namespace tdpt::portal_mesh_test
