// Embree, the Vulkan device and the scalar build of its kernels compared: the same lines, the same
// counts. Runs on lavapipe with validation (tdpt_software_vulkan in CMakeLists.txt).
#include "tools/lightgrid/line_tracer.h"

#include <cstring>
#include <filesystem>

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/gpu/kernel.h"
#include "libcommon/testing/scalar_tracer.h"
#include "libcommon/trace/bvh.h"
#include "shaders/shared/grid_walk.h"
#include "shaders/shared/rng.h"
#include "shaders/special_segments_test.h"
#include "tools/lightgrid/testing/lines.h"

namespace tdpt::testing::line_tracer_test {

TEST_F(LineTracers, device_and_twin_count_the_same_in_every_voxel_of_rooms) {
  for (const char* name : {"two-rooms", "door-ajar", "window"}) {
    SCOPED_TRACE(name);
    const Case c = room(name);
    const LightGrid grid = empty_grid(c.scene, 64);
    expect_same(on_device(c, grid, 20000), on_scalar_build(c, grid, 20000));
  }
}

TEST_F(LineTracers, device_and_twin_count_the_same_at_128_and_256) {
  const Case c = two_rooms();
  for (const int resolution : {128, 256}) {
    SCOPED_TRACE(resolution);
    const LightGrid grid = empty_grid(c.scene, resolution);
    expect_same(on_device(c, grid, 10000), on_scalar_build(c, grid, 10000));
  }
}

TEST_F(LineTracers, device_and_twin_count_the_same_in_veach_ajar) {
  const std::string path = TDPT_SHARED "/scenes/veach-ajar.glb";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const Case c = halved(read_gltf(path));
  for (const int resolution : {64, 128, 256}) {
    SCOPED_TRACE(resolution);
    const LightGrid grid = empty_grid(c.scene, resolution);
    expect_same(on_device(c, grid, 20000), on_scalar_build(c, grid, 20000));
  }
}

TEST_F(LineTracers, device_and_twin_count_the_same_in_odd_scenes) {
  const Scene room = two_rooms_scene();
  Scene flat = room;  // one voxel high
  for (Vec3f& p : flat.positions) p.y *= 0.01f;
  Scene tiny = room;
  for (Vec3f& p : tiny.positions) p *= 1e-5f;
  Scene degenerate = room;  // with each triangle twice, and triangles without area
  for (const Triangle& t : room.triangles) {
    const auto [a, b, c] = t.vertex;
    degenerate.triangles.push_back(t);
    degenerate.triangles.push_back({{a, a, b}, t.material});
    degenerate.triangles.push_back({{c, c, c}, t.material});
  }
  int i = 0;
  for (const Scene& scene : {flat, tiny, degenerate}) {
    SCOPED_TRACE(i++);
    const Case c = halved(scene);
    const LightGrid grid = empty_grid(c.scene, 37);
    EXPECT_EQ(grid.dim[1] == 1, i == 1);
    expect_same(on_device(c, grid, 10000), on_scalar_build(c, grid, 10000));
  }
}

// Twin: the compared results can differ.
TEST_F(LineTracers, another_seed_gives_other_lines) {
  const Case c = two_rooms();
  const LightGrid grid = empty_grid(c.scene, 64);
  const Outcome a = on_device(c, grid, 2000), b = on_device(c, grid, 2000, kSeed + (1ull << 32));
  EXPECT_GT(differences(a.segments, b.segments), 1000u);
  EXPECT_FALSE(a.count == b.count);
}

TEST_F(LineTracers, short_submissions_change_nothing) {
  const Case c = two_rooms();
  const LightGrid grid = empty_grid(c.scene, 64);
  expect_same(on_device(c, grid, 5000), on_device(c, grid, 5000, kSeed, 777));
}

TEST_F(LineTracers, counts_start_again_when_cleared) {
  const Case c = two_rooms();
  const LightGrid grid = empty_grid(c.scene, 32);
  const auto tracer = make_gpu_lines(*device, c.scene, c.tables, grid, kSeed);
  const Outcome first = outcome_of(*tracer, grid, 3000);
  expect_same(first, outcome_of(*tracer, grid, 3000));
}

TEST_F(LineTracers, forget_directions_when_cleared) {
  const Case c = two_rooms();
  const LightGrid grid = empty_grid(c.scene, 32);
  for (const auto& tracer : {make_embree_lines(c.scene, c.tables, grid, kSeed),
                             make_gpu_lines(*device, c.scene, c.tables, grid, kSeed)}) {
    TracedLines lines;
    std::vector<Vec3d> sum(grid.count.size());
    tracer->between_pivots(0, 0, 1000, lines);
    tracer->clear();
    tracer->take_directions(sum);
    EXPECT_EQ(std::count(sum.begin(), sum.end(), Vec3d()), static_cast<long>(sum.size()));
    tracer->between_pivots(0, 0, 1000, lines);
    tracer->take_directions(sum);
    EXPECT_LT(std::count(sum.begin(), sum.end(), Vec3d()), static_cast<long>(sum.size()));  // twin
  }
}

TEST_F(LineTracers, make_the_same_file) {
  const Case c = two_rooms();
  LightGridOptions options;
  options.resolution = 48;
  options.samples = 1 << 15;
  options.lines = 500;
  const auto bytes = [&](const MakeLineTracer& make) {
    LightGridReport report;
    return light_grid_bytes(make_light_grid(c.scene, c.cut, "a.cut", options, report, {}, make));
  };
  const std::string scalar = bytes(make_scalar_lines);
  EXPECT_TRUE(scalar == bytes([&](const Scene& scene, const LineTables& tables,
                                  const LightGrid& grid, uint64_t seed) {
                return make_gpu_lines(*device, scene, tables, grid, seed);
              }));
}

// Share of segments for which Embree's answer differs from the scalar build's. `shift` [voxels of
// 1/256] moves every triangle of the scalar build's scene.
double share_unlike_embree(const Case& c, uint32_t n, float shift = 0) {
  const LightGrid grid = empty_grid(c.scene, 64);
  Scene moved = c.scene;
  for (Vec3f& p : moved.positions) p.x += shift / 256;
  const auto embree = make_embree_lines(c.scene, c.tables, grid, kSeed);
  const auto scalar = make_scalar_lines(moved, c.tables, grid, kSeed);
  size_t different = 0;
  TracedLines a, b;
  embree->between_pivots(0, 0, n, a);
  scalar->between_pivots(0, 0, n, b);
  for (size_t i = 0; i < n; ++i) {
    different += a.fate[i] != b.fate[i];
    EXPECT_EQ(a.ends[i].light, b.ends[i].light);
    EXPECT_EQ(a.ends[i].camera, b.ends[i].camera);
  }
  return static_cast<double>(different) / n;
}

TEST(LinesOfEmbree, differ_from_the_scalar_build_in_one_of_10000_at_most) {
  for (const char* name : {"two-rooms", "three-rooms", "door-ajar", "window", "half-metre-hole"}) {
    const double share = share_unlike_embree(room(name), 100000);
    RecordProperty(name, std::to_string(share * 1e6) + "e-6");
    EXPECT_LE(share, 1e-4) << name;
  }
  EXPECT_GT(share_unlike_embree(two_rooms(), 20000, 1), 1e-3);  // twin
}

TEST(LinesOfEmbree, differ_from_the_scalar_build_in_one_of_10000_at_most_in_veach_ajar) {
  const std::string path = TDPT_SHARED "/scenes/veach-ajar.glb";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const double share = share_unlike_embree(halved(read_gltf(path)), 100000);
  RecordProperty("share", std::to_string(share * 1e6) + "e-6");
  EXPECT_LE(share, 1e-4);
}

TEST_F(LineTracers, agree_on_what_is_there_with_a_probability) {
  const std::vector<Material> all = sheet_materials();
  const size_t open = [&] {
    const Case c = two_rooms();
    return joining(on_device(c, empty_grid(c.scene, 16), 20000).segments);
  }();
  for (size_t i = 0; i < all.size(); ++i) {
    SCOPED_TRACE(i);
    const Case c = two_rooms(with_sheet(all[i], small_image()));
    const LightGrid grid = empty_grid(c.scene, 16);
    const Outcome device_outcome = on_device(c, grid, 20000);
    expect_same(device_outcome, on_scalar_build(c, grid, 20000));
    // The sheet blocks some of the light.
    EXPECT_LT(joining(device_outcome.segments), 0.9 * static_cast<double>(open));
    EXPECT_LE(share_unlike_embree(c, 100000), 1e-4);
  }
}

// Segments most sensitive to rounding, in a closed room from -1 to 1: along axes and edges, in the
// plane of walls, through corners of voxels and of triangles, of zero length, out of the scene.
std::vector<shader::LineEnds> special_segments(const Scene& scene) {
  std::vector<shader::LineEnds> out;
  const auto add = [&](const Vec3f& a, const Vec3f& b) { out.push_back({a, 0, b, 0}); };
  Rng rng(6, 0, 0);
  const auto corner = [&] {  // of a voxel of 64
    const float x = static_cast<float>(rng.below(65)), y = static_cast<float>(rng.below(65)),
                z = static_cast<float>(rng.below(65));
    return Vec3f(x, y, z) * (1 / 32.0f) - Vec3f(1);
  };
  const auto place = [&] {
    const float x = rng.uniform_float(), y = rng.uniform_float(), z = rng.uniform_float();
    return Vec3f(x, y, z) * 2 - Vec3f(1);
  };
  for (int i = 0; i < 2000; ++i) {
    const Vec3f a = corner(), b = corner(), p = place(), q = place();
    add(a, b);
    add(a, a);
    add(p, p);
    Vec3f c = p;
    c[i % 3] = q[i % 3];
    add(p, c);  // along an axis
    c = a;
    c[i % 3] = b[i % 3];
    add(a, c);  // along an edge of voxels
    c[i % 3] = a[i % 3] + 1e-7f;
    add(a, c);  // hardly any length
    c = b;
    c[i % 3] = a[i % 3];
    add(a, c);  // in a plane between voxels
    const uint32_t t = rng.below(static_cast<uint32_t>(scene.triangles.size()));
    const uint32_t s = rng.below(static_cast<uint32_t>(scene.triangles.size()));
    const Vec3f u = scene.vertex(t, i % 3), v = scene.vertex(t, (i + 1) % 3);
    add(p, u);               // to a corner
    add(u, u * 2 - p);       // from one
    add(p, u + u - p);       // through one
    add(u, v);               // along an edge
    add(u, (u + v) * 0.5f);  // and part of it
    add(u, scene.vertex(s, 0));
    add(v + (v - u), u + (u - v));  // beyond both its ends: grazing
    add(p, q * 30);                 // out of the scene
    add(p * 30, q * 30);
    c = p;
    c.x = std::nextafter(1.0f, i % 2 ? 0.0f : 2.0f);
    Vec3f d = q;
    d.x = c.x;
    add(c, d);  // beside a wall
  }
  return out;
}

TEST_F(LineTracers, device_and_twin_agree_on_special_segments) {
  const Scene scene = read_gltf(TDPT_TESTDATA "/scenes/furnace.glb");
  const Bvh bvh = build_bvh(scene);
  const std::vector<shader::LineEnds> segments = special_segments(scene);
  const auto n = static_cast<uint32_t>(segments.size());
  shader::LightParameters p{};
  p.grid_corner = Vec3f(-1);
  p.voxels_per_unit = 32;
  p.dim = {64, 64, 64};
  p.count = n;

  const gpu::Buffer nodes(*device, bvh.nodes), triangles(*device, bvh.triangles),
      given(*device, segments), blocked(*device, n * sizeof(uint32_t)),
      hits(*device, n * sizeof(shader::SurfaceHit));
  const gpu::Image3D image(*device, {64, 64, 64});
  const gpu::Kernel kernel(*device, shader::special_segments_test_spv,
                           {nodes, triangles, given, blocked, hits, image}, sizeof p);
  device->run([&](gpu::Commands& c) { c.dispatch(kernel, gpu::push(p), (n + 63) / 64); });
  const std::vector<uint32_t> device_blocked = blocked.download<uint32_t>(n),
                              device_count = image.download();
  const auto device_hits = hits.download<shader::SurfaceHit>(n);

  const shader::ScalarTracer tracer(bvh);
  std::vector<uint32_t> count(64 * 64 * 64);
  size_t stopped = 0, hit = 0, different = 0;
  for (uint32_t i = 0; i < n; ++i) {
    const Vec3f a = segments[i].light, b = segments[i].camera;
    const bool is_blocked = tracer.segment_blocked(a, b, i);
    stopped += is_blocked;
    different += is_blocked != (device_blocked[i] != 0);
    shader::SurfaceHit mine;
    const bool found = tracer.first_hit(a, b - a, i, mine);
    const shader::SurfaceHit& theirs = device_hits[i];
    hit += found;
    if (!found) {
      different += theirs.triangle != ~0u;
    } else {
      different += std::memcmp(&mine, &theirs, sizeof mine) != 0;
    }
    auto walk = shader::voxel_walk((a - p.grid_corner) * p.voxels_per_unit,
                                   (b - p.grid_corner) * p.voxels_per_unit, p.dim);
    do {
      ++count[static_cast<size_t>(walk.at.x + 64 * (walk.at.y + 64 * walk.at.z))];
    } while (shader::next_voxel(walk));
  }
  EXPECT_EQ(different, 0u);
  EXPECT_TRUE(count == device_count);
  EXPECT_GT(stopped, n / 20);
  EXPECT_GT(hit, n / 20);
}

}  // namespace tdpt::testing::line_tracer_test
