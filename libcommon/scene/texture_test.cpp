// Look-ups against values computed by hand.
#include "libcommon/scene/texture.h"

#include <gtest/gtest.h>
#include <cmath>
#include <limits>

namespace tdpt::texture_test {

using Wrap = TextureMap::Wrap;
using Bytes = std::vector<uint8_t>;

/// One triangle whose barycentrics b1, b2 are its texture coordinates u, v, also outside of it.
Scene triangle() {
  Scene s;
  s.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  s.triangles = {{{0, 1, 2}, 0}};
  s.uv[0] = {{0, 0}, {1, 0}, {0, 1}};
  s.materials.resize(1);
  s.materials[0].plain = false;
  return s;
}

int add_image(Scene& s, int width, int height, const Bytes& texels) {
  s.images.push_back({width, height, texels});
  return static_cast<int>(s.images.size()) - 1;
}

/// Red of a row of texels, black and white, at u.
float row(Wrap wrap, double u, bool nearest = false) {
  Scene s = triangle();
  TextureMap map;
  map.image = add_image(s, 2, 1, {0, 0, 0, 255, 255, 255, 255, 255});
  map.wrap_u = map.wrap_v = wrap;
  map.nearest = nearest;
  return lookup(s, map, {0, u, 0.5})[0];
}

TEST(Lookup, IsBilinearBetweenTexelsWhichRepeatMirrorOrStop) {
  for (const auto& [u, expected] :
       {std::pair{0.25, 0.0f}, {0.375, 0.25f}, {0.5, 0.5f}, {0.7, 0.9f}, {0.75, 1.0f}})
    for (Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp})
      EXPECT_NEAR(row(wrap, u), expected, 1e-6) << u;
  const auto expect = [](Wrap wrap, const std::vector<double>& u, const std::vector<float>& reds) {
    for (size_t i = 0; i < u.size(); ++i) EXPECT_NEAR(row(wrap, u[i]), reds[i], 1e-6) << u[i];
  };
  expect(Wrap::repeat, {0, 0.125, 1, 1.25, -0.25, -0.75, -1e-20, 79.75, 80.375},
         {0.5f, 0.25f, 0.5f, 0, 1, 0, 0.5f, 1, 0.25f});
  expect(Wrap::mirror, {0, 1, 1.25, 1.375, 1.75, 2, 2.75, -0.25, -0.75, -1e-20},
         {0, 1, 1, 0.75f, 0, 0, 1, 0, 1, 0});
  expect(Wrap::clamp, {0, -7, 1, 80.25, 0.5}, {0, 0, 1, 1, 0.5f});
}

TEST(Lookup, NearestTakesOneTexel) {
  const auto expect = [](Wrap wrap, const std::vector<double>& u, const std::vector<float>& reds) {
    for (size_t i = 0; i < u.size(); ++i) EXPECT_EQ(row(wrap, u[i], true), reds[i]) << u[i];
  };
  // -1e-20 rounds to 1, which is 0 again.
  expect(Wrap::repeat, {0.49, 0.51, 1, -1e-20}, {0, 1, 0, 0});
  expect(Wrap::mirror, {0.49, 0.51, 1.1, 2, -1e-20}, {0, 1, 1, 0, 0});
  expect(Wrap::clamp, {0.49, 0.51, 1}, {0, 1, 1});
}

TEST(Lookup, RowZeroIsAtTheTop) {
  Scene s = triangle();
  TextureMap map;
  map.image = add_image(s, 1, 2, {255, 0, 0, 255, 0, 0, 255, 255});
  EXPECT_EQ(lookup(s, map, {0, 0.5, 0.25}), (std::array<float, 4>{1, 0, 0, 1}));
  EXPECT_EQ(lookup(s, map, {0, 0.5, 0.75}), (std::array<float, 4>{0, 0, 1, 1}));
}

TEST(Lookup, SrgbIsDecodedBeforeMixingAlphaIsNot) {
  Scene s = triangle();
  TextureMap map;
  map.image = add_image(s, 2, 1, {10, 128, 255, 128, 0, 0, 0, 0});
  map.srgb = true;
  map.wrap_u = Wrap::clamp;
  const auto left = lookup(s, map, {0, 0.0, 0.5}), middle = lookup(s, map, {0, 0.5, 0.5});
  EXPECT_NEAR(left[0], 0.00303527, 1e-7);  // 10 / 255 / 12.92
  EXPECT_NEAR(left[1], 0.21586050, 1e-6);  // ((128 / 255 + 0.055) / 1.055) ^ 2.4
  EXPECT_EQ(left[2], 1);
  EXPECT_NEAR(left[3], 128 / 255.0, 1e-6);
  for (size_t c = 0; c < 4; ++c) EXPECT_NEAR(middle[c], left[c] / 2, 1e-7);
}

TEST(Lookup, TheTransformComesFirst) {
  Scene s = triangle();
  TextureMap map;
  map.image = add_image(s, 2, 2, {0, 0, 0, 255, 85, 0, 0, 255, 170, 0, 0, 255, 255, 0, 0, 255});
  map.nearest = true;
  map.transform = {0, 0.5f, 0.5f, -0.5f, 0, 0.5f};  // u' = v/2 + 1/2, v' = 1/2 - u/2
  EXPECT_NEAR(lookup(s, map, {0, 0.2, 0.4})[0], 85 / 255.0, 1e-6);    // (0.7, 0.4)
  EXPECT_NEAR(lookup(s, map, {0, 0.2, -0.4})[0], 0, 1e-6);            // (0.3, 0.4)
  EXPECT_NEAR(lookup(s, map, {0, -0.2, 0.4})[0], 255 / 255.0, 1e-6);  // (0.7, 0.6)
}

TEST(Lookup, TheSetOfCoordinatesIsTheMaps) {
  Scene s = triangle();
  s.uv[1] = {{0.75f, 0.5f}, {0.75f, 0.5f}, {0.75f, 0.5f}};
  TextureMap map;
  map.image = add_image(s, 2, 1, {0, 0, 0, 255, 255, 255, 255, 255});
  EXPECT_EQ(lookup(s, map, {0, 0.25, 0.5})[0], 0);
  map.uv_set = 1;
  EXPECT_EQ(lookup(s, map, {0, 0.25, 0.5})[0], 1);
  s.uv[1].clear();  // no coordinates: (0, 0)
  map.nearest = true;
  EXPECT_EQ(lookup(s, map, {0, 0.75, 0.5})[0], 0);
  EXPECT_EQ(lookup(s, {}, {0, 0.1, 0.2}), (std::array<float, 4>{1, 1, 1, 1})) << "no image";
}

TEST(Lookup, NoCoordinatesMakeItFail) {
  const float inf = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Scene s = triangle();
  TextureMap map;
  map.image = add_image(s, 3, 2, Bytes(24, 77));
  for (Wrap wrap : {Wrap::repeat, Wrap::mirror, Wrap::clamp})
    for (bool nearest : {false, true})
      for (float u : {nan, inf, -inf, 3e38f, -3e38f, 1e9f, -1e9f, 9.99e8f, -9.99e8f, 1e-45f})
        for (float v : {0.0f, u}) {
          map.wrap_u = map.wrap_v = wrap;
          map.nearest = nearest;
          s.uv[0] = {{u, v}, {v, u}, {-u, v}};
          for (float c : lookup(s, map, {0, 0.3, 0.3})) EXPECT_NEAR(c, 77 / 255.0, 1e-6) << u;
          map.transform[0] = 1e30f;
          for (float c : lookup(s, map, {0, 0.3, 0.3})) EXPECT_NEAR(c, 77 / 255.0, 1e-6) << u;
          map.transform[0] = 1;
        }
}

TEST(BaseColour, IsFactorTimesTextureTimesVertexColour) {
  Scene s = triangle();
  Material& m = s.materials[0];
  m.base_color = {0.5f, 1, 0.25f};
  m.alpha = 0.5f;
  m.maps[MAP_BASE].image = add_image(s, 1, 1, {255, 51, 102, 204});
  s.colours = {{1, 1, 1, 1}, {0, 0.5f, 8, 1}, {1, 1, 1, 0}};
  const auto c = base_color_at(s, {0, 0.5, 0.25});
  EXPECT_NEAR(c[0], 0.5 * 1 * 0.5, 1e-6);
  EXPECT_NEAR(c[1], 1 * 0.2 * 0.75, 1e-6);
  EXPECT_NEAR(c[2], 0.25 * 0.4 * 4.5, 1e-6);
  EXPECT_NEAR(c[3], 0.5 * 0.8 * 0.75, 1e-6);
  EXPECT_EQ(base_color_at(s, {0, 1, 0})[2], 0.8f);
  m.base_color.z = 1;
  EXPECT_EQ(base_color_at(s, {0, 1, 0})[2], 1);  // clamped to white
  m.plain = true;
  EXPECT_EQ(base_color_at(s, {0, 1, 0}), (std::array<float, 4>{0.5f, 1, 1, 0.5f}));
}

TEST(Emission, IsFactorTimesTexture) {
  Scene s = triangle();
  s.materials[0].emission = {10, 20, 30};
  EXPECT_EQ(emission_at(s, {0, 0.1, 0.1}), Rgb(10, 20, 30));
  s.materials[0].maps[MAP_EMISSION].image = add_image(s, 1, 1, {255, 51, 0, 0});
  const Rgb e = emission_at(s, {0, 0.1, 0.1});
  EXPECT_NEAR(e.x, 10, 1e-5);
  EXPECT_NEAR(e.y, 4, 1e-5);
  EXPECT_EQ(e.z, 0);
}

TEST(Coverage, FollowsTheMode) {
  Scene s = triangle();
  Material& m = s.materials[0];
  m.maps[MAP_BASE].image = add_image(s, 2, 1, {0, 0, 0, 0, 0, 0, 0, 255});
  m.maps[MAP_BASE].wrap_u = Wrap::clamp;
  const SurfacePlace quarter{0, 0.375, 0.5}, half{0, 0.5, 0.5}, all{0, 0.75, 0.5};
  EXPECT_EQ(coverage_at(s, quarter), 1);
  m.alpha_mode = Material::Alpha::blend;
  EXPECT_NEAR(coverage_at(s, quarter), 0.25, 1e-6);
  EXPECT_NEAR(coverage_at(s, all), 1, 1e-6);
  m.alpha = 0.5f;
  EXPECT_NEAR(coverage_at(s, quarter), 0.125, 1e-6);
  m.alpha = 1;
  m.alpha_mode = Material::Alpha::mask;
  EXPECT_EQ(coverage_at(s, quarter), 0);
  EXPECT_EQ(coverage_at(s, half), 1);  // at the cutoff the surface is present
  m.alpha_cutoff = 0.2f;
  EXPECT_EQ(coverage_at(s, quarter), 1);
}

const Vec3d kUp(0, 0, 1);

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance = 1e-6) {
  EXPECT_LT(length(a - b), tolerance)
      << a.x << " " << a.y << " " << a.z << ", expected " << b.x << " " << b.y << " " << b.z;
}

TEST(ShadingNormal, IsInterpolatedWhereTheTriangleIsSmooth) {
  Scene s = triangle();
  EXPECT_EQ(shading_normal_at(s, {0, 0.2, 0.2}, kUp), kUp);
  s.normals = {{0, 0, 1}, {0.6f, 0, 0.8f}, {0, -0.6f, 0.8f}};
  s.smooth = {0};
  EXPECT_EQ(shading_normal_at(s, {0, 0.2, 0.2}, kUp), kUp);
  s.smooth = {1};
  expect_near(shading_normal_at(s, {0, 0.5, 0.25}, kUp), normalize(Vec3d(0.3, -0.15, 0.85)));
  s.smooth = {2};  // those of the back are turned round
  s.normals.assign(3, {0.6f, 0, -0.8f});
  expect_near(shading_normal_at(s, {0, 0.2, 0.2}, kUp), {-0.6, 0, 0.8});
}

TEST(ShadingNormal, IsNeverBehindTheSurface) {
  Scene s = triangle();
  s.smooth = {1};
  s.normals.assign(3, {0.6f, 0, -0.8f});  // equal at all corners: mirrored at the surface
  expect_near(shading_normal_at(s, {0, 0.2, 0.2}, kUp), {0.6, 0, 0.8});
  s.normals.assign(3, {1, 0, 0});
  const Vec3d along = shading_normal_at(s, {0, 0.2, 0.2}, kUp);
  EXPECT_GE(dot(along, kUp), 0.999e-3);
  EXPECT_NEAR(length(along), 1, 1e-12);
  s.normals = {{1, 0, 0}, {-1, 0, 0}, {0, 0, 1}};  // they cancel: the geometric one
  expect_near(shading_normal_at(s, {0, 0.5, 0}, kUp), kUp);
  s.normals.assign(3, {0, 0, -1});
  expect_near(shading_normal_at(s, {0, 0.2, 0.2}, kUp), kUp);
}

/// (0.6, 0, 0.8) as bytes: 2 * 204 / 255 - 1 is 0.6, 128 is 0.0039, 230 is 0.8039.
const Bytes kBentRight = {204, 128, 230, 255}, kBentUp = {128, 204, 230, 255};
const double kZero = 2 * 128 / 255.0 - 1, kHigh = 2 * 204 / 255.0 - 1, kZ = 2 * 230 / 255.0 - 1;

/// The triangle with a normal map of one texel; `u`, `v` map x, y to its corners' coordinates.
Vec3d bent(const Bytes& texel, std::array<float, 3> u, std::array<float, 3> v,
           const std::vector<std::array<float, 4>>& tangents = {}, float scale = 1) {
  Scene s = triangle();
  for (size_t k = 0; k < 3; ++k) s.uv[0][k] = {u[k], v[k]};
  s.materials[0].maps[MAP_NORMAL].image = add_image(s, 1, 1, texel);
  s.materials[0].normal_scale = scale;
  s.tangents = tangents;
  return shading_normal_at(s, {0, 0.2, 0.2}, kUp);
}

TEST(NormalMaps, AxesComeFromTheTextureCoordinatesAndScaleBends) {
  // u to the right (x), v down (-y): the orientation of images.
  expect_near(bent(kBentRight, {0, 1, 0}, {1, 1, 0}), normalize(Vec3d(kHigh, kZero, kZ)));
  expect_near(bent(kBentUp, {0, 1, 0}, {1, 1, 0}), normalize(Vec3d(kZero, kHigh, kZ)));
  // v up: the image is upside down.
  expect_near(bent(kBentUp, {0, 1, 0}, {0, 0, 1}), normalize(Vec3d(kZero, -kHigh, kZ)));
  // u to the left: mirrored.
  expect_near(bent(kBentRight, {1, 0, 1}, {1, 1, 0}), normalize(Vec3d(-kHigh, kZero, kZ)));
  expect_near(bent(kBentRight, {0, 1, 0}, {1, 1, 0}, {}, 0.5f),
              normalize(Vec3d(kHigh / 2, kZero / 2, kZ)));
  expect_near(bent(kBentRight, {0, 1, 0}, {1, 1, 0}, {}, -1), normalize(Vec3d(-kHigh, -kZero, kZ)));
  // u up, v to the right: rotated by a quarter.
  expect_near(bent(kBentRight, {0, 0, 1}, {0, 1, 0}), normalize(Vec3d(-kZero, kHigh, kZ)));
}

TEST(NormalMaps, TangentsOfTheMeshComeFirst) {
  const auto all = [](std::array<float, 4> t) { return std::vector<std::array<float, 4>>(3, t); };
  const std::array<float, 3> u{0, 1, 0}, v{1, 1, 0};
  expect_near(bent(kBentRight, u, v, all({0, 1, 0, 1})), normalize(Vec3d(-kZero, kHigh, kZ)));
  expect_near(bent(kBentUp, u, v, all({1, 0, 0, 1})), normalize(Vec3d(kZero, kHigh, kZ)));
  expect_near(bent(kBentUp, u, v, all({1, 0, 0, -1})), normalize(Vec3d(kZero, -kHigh, kZ)));
  // Not perpendicular to the normal: orthogonalised.
  expect_near(bent(kBentUp, u, v, all({0.8f, 0, 0.6f, 1})), normalize(Vec3d(kZero, kHigh, kZ)));
  // Absent here: derived from the coordinates.
  expect_near(bent(kBentUp, u, v, all({0, 0, 0, 1})), normalize(Vec3d(kZero, kHigh, kZ)));
}

TEST(NormalMaps, WithoutAnyFrameTheNormalStays) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  expect_near(bent(kBentRight, {0, 0, 0}, {0, 0, 0}), kUp);
  expect_near(bent(kBentRight, {0, 1, 2}, {0, 1, 2}), kUp);
  expect_near(bent(kBentRight, {nan, 1, 2}, {0, 1, 0}), kUp);
  const Vec3d n = bent(kBentRight, {3e38f, -3e38f, 2}, {0, 1, 3e38f});
  EXPECT_NEAR(length(n), 1, 1e-12);
  EXPECT_GT(n.z, 0.7);
  // What is bent behind the surface, to (1, 0, -1), comes back.
  const Vec3d behind = bent({255, 128, 0, 255}, {0, 1, 0}, {1, 1, 0});
  EXPECT_GT(behind.z, 0.7);
  EXPECT_GT(behind.x, 0.7);
}

}  // namespace tdpt::texture_test
