#include "tools/ffgraph/preview.h"

#include <gtest/gtest.h>

#include "libcommon/testing/files/read_png.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::preview_test {

const Scene& two_rooms() {
  static const Scene scene = read_gltf(TDPT_TESTDATA "/scenes/two-rooms.glb");
  return scene;
}

// Every face is a patch; those beyond x = 2.05 are reached from the light to `light`, the others
// from the camera to `camera`, as shares of their 4 samples.
DimacsFile network(double light, double camera) {
  const Scene& scene = two_rooms();
  DimacsFile file;
  file.has_patches = true;
  file.scale = 1000;
  file.scene_hash = scene.hash;
  file.grid = {{-100, -100, -100}, 1000};
  file.network.source = 0;
  file.network.sink = 1;
  for (uint32_t face = 0; face < 2 * scene.triangles.size(); ++face) {
    const TriangleShape t = shape_of(scene, face / 2);
    Patch p;
    p.node = face + 3;
    p.samples = 4;
    p.centre = scene.frame.to_metres(t.p0 + (t.e1 + t.e2) / 3.0);
    p.normal = face % 2 == 0 ? t.normal : -t.normal;
    p.faces = {face};
    if (p.centre.x > 2.05)
      file.network.arcs.push_back({0, face + 2, std::llround(4000 * light)});
    else
      file.network.arcs.push_back({face + 2, 1, std::llround(4000 * camera)});
    file.patches.push_back(p);
  }
  file.network.nodes = static_cast<uint32_t>(file.patches.size()) + 2;
  return file;
}

TEST(network_preview, floors_have_the_colour_of_who_reaches_them) {
  const Scene& scene = two_rooms();
  // Twin: half as strong is seen; more than a whole share is one.
  for (const double light : {1.0, 0.5}) {
    const draw::Drawing drawing =
        network_preview(scene, scene.camera(""), network(light, 1.5), false);
    const draw::Panel& plan = drawing.panels.at(1);
    const auto is = [&](const Vec3d& metres, const draw::Ink& c) {
      const draw::Pixel p = plan.view.project(metres);
      return length(plan.backdrop.at(static_cast<int>(p.x - plan.view.panel.x),
                                     static_cast<int>(p.y - plan.view.panel.y)) -
                    c) < 0.01f;
    };
    EXPECT_EQ(is({3.6, 0, 0.7}, draw::kLight), light == 1);
    EXPECT_TRUE(is({0.5, 0, -0.7}, draw::kCamera));
    if (light == 1)
      EXPECT_EQ(testing::read_png(draw::draw(drawing).png()).width, draw::kSheetWidth);
  }
}

TEST(network_debug_glb, has_squares_for_patches_and_the_triangles_themselves) {
  const testing::TempFolder folder;
  DimacsFile file = network(1, 1);
  file.grid.base_cell = 0.3;
  const Scene patches =
      read_gltf(folder.write("patches.glb", network_debug_glb(two_rooms(), file, false)));
  EXPECT_EQ(patches.triangles.size(), 2 * file.patches.size());
  const Scene triangles =
      read_gltf(folder.write("triangles.glb", network_debug_glb(two_rooms(), file, true)));
  ASSERT_EQ(triangles.triangles.size(), file.patches.size());
  double area = 0, expected = 0;
  for (uint32_t t = 0; t < triangles.triangles.size(); ++t)
    area += shape_of(triangles, t).area / (triangles.frame.scale * triangles.frame.scale);
  for (uint32_t t = 0; t < two_rooms().triangles.size(); ++t)
    expected +=
        2 * shape_of(two_rooms(), t).area / (two_rooms().frame.scale * two_rooms().frame.scale);
  EXPECT_NEAR(area, expected, 1e-4 * expected);
}

}  // namespace tdpt::preview_test
