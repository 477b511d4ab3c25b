#include "libcommon/testing/files/split.h"

#include <gtest/gtest.h>

#include "libcommon/scene/scene.h"
#include "libcommon/testing/files/glb_builder.h"
#include "libcommon/testing/files/reencode.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::testing::split_test {

struct Shape {
  size_t triangles = 0, vertices = 0;
  double area = 0;     // canonical
  Vec3d moment{};      // area times centroid
  double largest = 0;  // area of a triangle
};

Shape shape_of_glb(const std::string& glb) {
  const TempFolder folder;
  const std::string path = folder.write("scene.glb", glb);
  const Scene scene = read_gltf(path);
  Shape s{scene.triangles.size(), scene.positions.size(), 0, {}, 0};
  for (uint32_t t = 0; t < s.triangles; ++t) {
    const TriangleShape shape = shape_of(scene, t);
    s.area += shape.area;
    s.moment += (shape.p0 + (shape.e1 + shape.e2) / 3.0) * shape.area;
    s.largest = std::max(s.largest, shape.area);
  }
  return s;
}

bool is_split_of(const Shape& fine, const Shape& whole) {
  return fine.triangles == 4 * whole.triangles &&
         std::abs(fine.area - whole.area) < 1e-5 * whole.area &&
         length(fine.moment - whole.moment) < 1e-5 * whole.area &&
         std::abs(4 * fine.largest - whole.largest) < 1e-5 * whole.largest;
}

std::string room(Encoding encoding = Encoding::indices_u16) {
  const EncodedScene scene = encode(simple_room(), encoding);
  return scene.files.at(scene.file);
}

TEST(split, keeps_the_surface) {
  const std::string whole = room(), fine = split_in_four(whole);
  EXPECT_TRUE(is_split_of(shape_of_glb(fine), shape_of_glb(whole)));
  EXPECT_TRUE(is_split_of(shape_of_glb(split_in_four(fine)), shape_of_glb(fine)));
}

TEST(split, knows_all_ways_of_writing_indices) {
  for (const Encoding e : {Encoding::indices_u8, Encoding::indices_u32, Encoding::no_indices,
                           Encoding::interleaved, Encoding::many_primitives})
    EXPECT_TRUE(is_split_of(shape_of_glb(split_in_four(room(e))), shape_of_glb(room(e))));
}

TEST(split, neighbours_share_their_midpoint) {
  // A quad has 4 corners, 4 edges around it and the diagonal.
  QuadPart quad;
  quad.add({0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  const EncodedScene scene = encode({quad}, Encoding::indices_u16);
  EXPECT_EQ(shape_of_glb(split_in_four(scene.files.at(scene.file))).vertices, 9u);
}

TEST(split, the_check_finds_a_triangle_that_was_left_out_or_bent) {
  const Shape whole = shape_of_glb(room());
  Shape fine = shape_of_glb(split_in_four(room()));
  ASSERT_TRUE(is_split_of(fine, whole));
  Shape bent = fine;
  bent.moment.x += 0.001 * fine.area;
  EXPECT_FALSE(is_split_of(bent, whole));
  fine.triangles -= 1;
  EXPECT_FALSE(is_split_of(fine, whole));
  EXPECT_FALSE(is_split_of(whole, whole));
}

TEST(split, refuses_what_it_does_not_know) {
  EXPECT_THROW(split_in_four("glTF"), std::invalid_argument);
  EXPECT_THROW(split_in_four(room(Encoding::sparse)), std::invalid_argument);
  EXPECT_THROW(split_in_four(room(Encoding::strip)), std::invalid_argument);
  EXPECT_THROW(split_in_four(room(Encoding::quantized)), std::invalid_argument);
}

}  // namespace tdpt::testing::split_test
