// The scenes in testdata are those that the program writes, and match their README.
#include "libcommon/testing/rooms/rooms.h"

#include <gtest/gtest.h>
#include <filesystem>
#include <numbers>
#include <set>

#include "libcommon/base/file.h"
#include "libcommon/math/rng.h"
#include "libcommon/scene/scene.h"
#include "libcommon/trace/tracer.h"

namespace tdpt::testing::rooms_test {

const std::string kScenes = std::string(TDPT_TESTDATA) + "/scenes/";

TEST(Rooms, FilesAreThoseThatTheProgramWrites) {
  std::set<std::string> names = {"README.md"};
  for (const NamedScene& s : make_scenes()) {
    EXPECT_EQ(read_file(kScenes + s.file), s.bytes) << s.file;
    names.insert(s.file);
  }
  for (const auto& entry : std::filesystem::directory_iterator(kScenes))
    EXPECT_TRUE(names.contains(entry.path().filename())) << entry.path();
}

struct Walked {
  int escaped = 0;             ///< rays that hit nothing
  int behind = 0;              ///< hits on the back of a surface other than a lamp
  int lamp = 0;                ///< hits on an emitter
  Vec3d low{1e9}, high{-1e9};  ///< metres, of hits
};

/// Diffuse walks from the camera.
Walked walk(const Scene& scene) {
  const Tracer tracer(scene);
  Walked out;
  for (uint64_t i = 0; i < 5000; ++i) {
    Rng rng(1, 0, i);
    const double z = 2 * rng.uniform() - 1, r = std::sqrt(1 - z * z);
    const double phi = 2 * std::numbers::pi * rng.uniform();
    Vec3d w(r * std::cos(phi), r * std::sin(phi), z);
    Tracer::Origin from{scene.camera("").position};
    for (int bounce = 0; bounce < 20; ++bounce) {
      Hit hit;
      if (!tracer.closest(from, w, hit)) {
        ++out.escaped;
        break;
      }
      const bool emits = max_component(scene.material_of(hit.triangle).emission) > 0;
      const bool back = dot(hit.normal, w) > 0;
      out.behind += back && !emits;
      out.lamp += emits;
      const Vec3d p = scene.frame.to_metres(hit.position);
      out.low = min(out.low, p), out.high = max(out.high, p);
      const Vec3d n = back ? -hit.normal : hit.normal;
      const double u = rng.uniform(), v = rng.uniform();
      w = Onb<double>(n).to_world(cosine_hemisphere(u, v));
      from = {hit.position, n};
    }
  }
  return out;
}

TEST(Rooms, AreClosedConnectedAndFaceInwards) {
  for (const NamedScene& s : make_scenes()) {
    const Scene scene = read_gltf(kScenes + s.file);
    EXPECT_TRUE(scene.warnings.empty()) << s.file;
    const Walked w = walk(scene);
    EXPECT_EQ(w.escaped, 0) << s.file;
    EXPECT_EQ(w.behind, 0) << s.file;
    EXPECT_GT(w.lamp, 0) << s.file;
    const bool furnace = s.file == "furnace.glb";
    EXPECT_NEAR(w.low.x, furnace ? -1 : 0, 1e-6) << s.file;
    EXPECT_NEAR(w.high.x, furnace ? 1 : s.file == "three-rooms.glb" ? 6.2 : 4.1, 1e-6) << s.file;
    EXPECT_NEAR(w.high.y, 2, 1e-6) << s.file;
  }
}

TEST(Rooms, AMissingTriangleIsNoticed) {
  Scene scene = read_gltf(kScenes + "two-rooms.glb");
  scene.triangles.erase(scene.triangles.begin());
  EXPECT_GT(walk(scene).escaped, 0);
  scene = read_gltf(kScenes + "two-rooms.glb");
  std::swap(scene.triangles[0].vertex[0], scene.triangles[0].vertex[1]);
  EXPECT_GT(walk(scene).behind, 0);
}

TEST(Rooms, TheHoleOfTwoRoomsIsWhereTheReadmeSays) {
  const Scene scene = read_gltf(kScenes + "two-rooms.glb");
  const Tracer tracer(scene);
  const auto through = [&](double y, double z) {
    Tracer::Origin a{scene.frame.to_canonical({1.9, y, z})},
        b{scene.frame.to_canonical({2.2, y, z})};
    return tracer.visible(a, b);
  };
  const double e = 1e-4;
  for (double y : {0.875, 1.125})
    for (double z : {-0.125, 0.125}) {
      const double iy = y < 1 ? e : -e, iz = z < 0 ? e : -e;
      EXPECT_TRUE(through(y + iy, z + iz));
      EXPECT_FALSE(through(y - iy, z + iz));
      EXPECT_FALSE(through(y + iy, z - iz));
    }
}

}  // namespace tdpt::testing::rooms_test
