#include "tools/lightgrid/preview.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "libcommon/scene/scene.h"
#include "libcommon/testing/files/read_png.h"
#include "libcommon/testing/files/temp_folder.h"
#include "tools/lightgrid/lightgrid.h"
#include "tools/lightgrid/testing/perfect_cut.h"

namespace tdpt::preview_test {

// The hole of two-rooms: x 2..2.1, y 0.875..1.125, z -0.125..0.125.
const LightGrid& two_rooms_grid() {
  static const LightGrid grid = [] {
    const Scene scene = read_gltf(TDPT_TESTDATA "/scenes/two-rooms.glb");
    LightGridOptions how;
    how.resolution = 64;
    how.samples = 1 << 15;
    how.lines = 1000;
    LightGridReport report;
    return make_light_grid(
        scene, testing::perfect_cut(scene, 100000, [](const Vec3d& p) { return p.x > 2.05; }),
        "room.cut", how, report);
  }();
  return grid;
}

// Whether the fullest pixel of the view along x lies within the hole, within one voxel.
bool fullest_in_the_hole(const LightGrid& grid) {
  const FlatGrid flat = flattened(grid, 0);
  const auto at =
      static_cast<int>(std::max_element(flat.most.begin(), flat.most.end()) - flat.most.begin());
  const double y = grid.origin.y + grid.voxel * (at % flat.width + 0.5),
               z = grid.origin.z + grid.voxel * (at / flat.width + 0.5);
  return std::abs(y - 1) < 0.125 + grid.voxel && std::abs(z) < 0.125 + grid.voxel;
}

TEST(grid_preview, the_view_along_the_light_is_fullest_in_the_hole) {
  ASSERT_TRUE(two_rooms_grid().bottleneck);
  EXPECT_TRUE(fullest_in_the_hole(two_rooms_grid()));
  // Twin: the same counts shifted by half a metre in y.
  LightGrid shifted = two_rooms_grid();
  const int by = static_cast<int>(0.5 / shifted.voxel);
  for (int k = 0; k < shifted.dim[2]; ++k)
    for (int j = 0; j < shifted.dim[1]; ++j)
      for (int i = 0; i < shifted.dim[0]; ++i)
        shifted.count[shifted.index(i, j, k)] =
            two_rooms_grid().count[shifted.index(i, (j + by) % shifted.dim[1], k)];
  EXPECT_FALSE(fullest_in_the_hole(shifted));
}

TEST(grid_preview, is_a_png_also_without_a_bottleneck) {
  LightGrid grid = two_rooms_grid();
  const auto width = [&] {
    return testing::read_png(draw::draw(grid_preview(grid, "two-rooms.glb")).png()).width;
  };
  EXPECT_EQ(width(), 1600);
  EXPECT_NEAR(grid_preview(grid, "two-rooms.glb").labels.at(0).place.x, 2.05, 0.3);
  grid.bottleneck = false;
  grid.count.clear(), grid.lines.clear();
  EXPECT_EQ(width(), 1600);
}

TEST(grid_debug_glb, shows_the_fullest_voxels_as_cubes_at_their_places) {
  LightGrid grid;
  grid.origin = {1, 2, 3};
  grid.voxel = 0.5;
  grid.dim = {4, 4, 4};
  grid.count.assign(64, 0);
  grid.count[grid.index(3, 0, 2)] = 100;
  grid.count[grid.index(0, 0, 0)] = 5;  // a point
  grid.lines = {{{0, 0, 0}, {1, 1, 1}, 0}};
  const testing::TempFolder folder;
  const Scene scene = read_gltf(folder.write("grid.glb", grid_debug_glb(grid)));
  ASSERT_EQ(scene.triangles.size(), 12u);
  for (const Triangle& t : scene.triangles)
    for (const uint32_t v : t.vertex) {
      const Vec3d d = scene.frame.to_metres(Vec3d(scene.positions[v])) - Vec3d{2.75, 2.25, 4.25};
      EXPECT_NEAR(max_component(max(d, -d)), 0.2, 1e-6);
    }
}

}  // namespace tdpt::preview_test
