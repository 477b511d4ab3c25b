// Embree, the Vulkan device and the device's scalar twin against each other: the same lines, the
// same counts. Runs on lavapipe and under validation (tdpt_software_vulkan in CMakeLists.txt).
#include "tools/lightgrid/line_tracer.h"

#include <cstring>
#include <filesystem>
#include <functional>

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/gpu/kernel.h"
#include "libcommon/scene/texture.h"
#include "libcommon/testing/chi_square.h"
#include "libcommon/trace/bvh.h"
#include "libcommon/trace/scalar_tracer.h"
#include "shaders/special_segments_test.h"
#include "tools/lightgrid/gpu_lines.h"
#include "tools/lightgrid/lightgrid.h"
#include "tools/lightgrid/line_kernel.h"
#include "tools/lightgrid/scalar_lines.h"
#include "tools/lightgrid/test_cut.h"
#include "tools/lightgrid/veils.h"

namespace tdpt {
namespace {

constexpr uint64_t kSeed = 0x1234'5678'9abc'def0;

// A scene cut in two by a plane.
struct Case {
  Scene scene;
  CutFile cut;
  LineTables tables;

  Case(Scene s, const std::function<bool(const Vec3d&)>& is_source) : scene(std::move(s)) {
    open_glass(scene);
    cut = testing::perfect_cut(scene, 30000, is_source);
    tables = make_line_tables(scene, cut, "a.cut");
  }
};

// Cut across its longest side.
Case halved(const Scene& scene) {
  const LightGrid box = empty_grid(scene, 64);
  int axis = 0;
  for (int c = 1; c < 3; ++c)
    if (box.dim[static_cast<size_t>(c)] > box.dim[static_cast<size_t>(axis)]) axis = c;
  const double middle = box.origin[axis] + 32.4 * box.voxel;
  return {scene, [=](const Vec3d& p) { return p[axis] > middle; }};
}

Case room(const std::string& name) {
  return halved(read_gltf(TDPT_TESTDATA "/scenes/" + name + ".glb"));
}

Scene two_rooms_scene() {
  return read_gltf(TDPT_TESTDATA "/scenes/two-rooms.glb");
}
// Cut at its wall.
Case two_rooms(const Scene& scene = two_rooms_scene()) {
  return {scene, [](const Vec3d& p) { return p.x > 2.05; }};
}

// What a tracer makes of segments and tries.
struct Outcome {
  TracedLines segments, tries;
  std::vector<uint32_t> count;
  std::vector<Vec3d> direction;
};

Outcome outcome_of(LineTracer& tracer, const LightGrid& grid, uint32_t segments) {
  Outcome out;
  tracer.clear();
  TracedLines first, second;
  tracer.between_pivots(0, 0, segments / 3, first);
  tracer.between_pivots(0, segments / 3, segments - segments / 3, second);
  out.segments = first;
  out.segments.ends.insert(out.segments.ends.end(), second.ends.begin(), second.ends.end());
  out.segments.fate.insert(out.segments.fate.end(), second.fate.begin(), second.fate.end());
  tracer.counts(out.count);
  out.direction.resize(grid.count.size());
  tracer.take_directions(out.direction);
  // Lines through the middles of lines that join, in any direction, and some tries that are none.
  std::vector<shader::LineTry> tries(4096);
  for (size_t i = 0; i < tries.size(); ++i) {
    const shader::LineEnds& line = out.segments.ends[i % out.segments.size()];
    Rng rng(5, 0, i);
    const double u = rng.uniform(), v = rng.uniform();
    tries[i].place = (line.light + line.camera) * 0.5f;
    if (i % 16 == 3) continue;
    if (i % 16 == 5)
      tries[i].direction[static_cast<int>(i / 16 % 3)] = 1;
    else
      tries[i].direction = Vec3f(cosine_hemisphere(u, v)) * (i % 2 ? 1.0f : -1.0f);
  }
  tracer.through(0, 7, tries, out.tries);
  std::vector<uint32_t> after;
  tracer.counts(after);
  EXPECT_TRUE(after == out.count);  // tries are not counted
  return out;
}

size_t differences(const TracedLines& a, const TracedLines& b) {
  EXPECT_EQ(a.size(), b.size());
  size_t n = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    n += a.fate[i] != b.fate[i];
    if (a.fate[i] == LineFate::none || b.fate[i] == LineFate::none) continue;
    n += a.ends[i].light != b.ends[i].light || a.ends[i].camera != b.ends[i].camera ||
         a.ends[i].light_face != b.ends[i].light_face ||
         a.ends[i].camera_face != b.ends[i].camera_face;
  }
  return n;
}

size_t joining(const TracedLines& lines) {
  return static_cast<size_t>(std::count(lines.fate.begin(), lines.fate.end(), LineFate::joins));
}

void expect_same(const Outcome& a, const Outcome& b) {
  EXPECT_EQ(differences(a.segments, b.segments), 0u);
  EXPECT_EQ(differences(a.tries, b.tries), 0u);
  EXPECT_TRUE(a.count == b.count);
  EXPECT_TRUE(a.direction == b.direction);
  // Of something.
  EXPECT_GT(joining(a.segments), 20u);
  EXPECT_GT(joining(a.tries), 10u);
  EXPECT_GT(std::count(a.tries.fate.begin(), a.tries.fate.end(), LineFate::same_side), 10);
}

class LineTracers : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* on = getenv("TDPT_VULKAN_VALIDATION");
    ASSERT_TRUE(on && std::string(on) == "1") << "run it with ctest, or set what ctest sets";
    device = std::make_unique<gpu::Device>(gpu::Device::open());
  }
  void TearDown() override {
    device.reset();  // what is left over is told now
    EXPECT_EQ(gpu::take_validation_messages(), std::vector<std::string>());
  }
  Outcome on_device(const Case& c, const LightGrid& grid, uint32_t n, uint64_t seed = kSeed,
                    const GpuLineBounds& bounds = {}) {
    const auto tracer = make_gpu_lines(*device, c.scene, c.tables, grid, seed, bounds);
    return outcome_of(*tracer, grid, n);
  }
  Outcome on_twin(const Case& c, const LightGrid& grid, uint32_t n) {
    return outcome_of(*make_scalar_lines(c.scene, c.tables, grid, kSeed), grid, n);
  }
  std::unique_ptr<gpu::Device> device;
};

TEST_F(LineTracers, device_and_twin_count_the_same_in_every_voxel_of_rooms) {
  for (const char* name : {"two-rooms", "door-ajar", "window"}) {
    SCOPED_TRACE(name);
    const Case c = room(name);
    const LightGrid grid = empty_grid(c.scene, 64);
    expect_same(on_device(c, grid, 20000), on_twin(c, grid, 20000));
  }
}

TEST_F(LineTracers, device_and_twin_count_the_same_at_128_and_256) {
  const Case c = two_rooms();
  for (const int resolution : {128, 256}) {
    SCOPED_TRACE(resolution);
    const LightGrid grid = empty_grid(c.scene, resolution);
    expect_same(on_device(c, grid, 10000), on_twin(c, grid, 10000));
  }
}

TEST_F(LineTracers, device_and_twin_count_the_same_in_veach_ajar) {
  const std::string path = TDPT_SHARED "/scenes/veach-ajar.glb";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const Case c = halved(read_gltf(path));
  for (const int resolution : {64, 128, 256}) {
    SCOPED_TRACE(resolution);
    const LightGrid grid = empty_grid(c.scene, resolution);
    expect_same(on_device(c, grid, 20000), on_twin(c, grid, 20000));
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
    expect_same(on_device(c, grid, 10000), on_twin(c, grid, 10000));
  }
}

// Twin: what is compared can differ.
TEST_F(LineTracers, another_seed_gives_other_lines) {
  const Case c = two_rooms();
  const LightGrid grid = empty_grid(c.scene, 64);
  const Outcome a = on_device(c, grid, 2000), b = on_device(c, grid, 2000, kSeed + (1ull << 32));
  EXPECT_GT(differences(a.segments, b.segments), 1000u);
  EXPECT_FALSE(a.count == b.count);
}

TEST_F(LineTracers, slabs_and_short_submissions_change_nothing) {
  const Case c = two_rooms();
  const LightGrid grid = empty_grid(c.scene, 64);
  const Outcome whole = on_device(c, grid, 5000);
  const auto layer = static_cast<uint64_t>(grid.dim[0] * grid.dim[1]);
  GpuLineBounds bounds;
  bounds.voxels = 7 * layer;
  expect_same(whole, on_device(c, grid, 5000, kSeed, bounds));
  bounds.voxels = 1;  // never less than a layer
  bounds.lines = 777;
  expect_same(whole, on_device(c, grid, 5000, kSeed, bounds));
}

TEST_F(LineTracers, counts_start_again_when_cleared) {
  const Case c = two_rooms();
  const LightGrid grid = empty_grid(c.scene, 32);
  for (const bool slabs : {false, true}) {
    GpuLineBounds bounds;
    if (slabs) bounds.voxels = 1;
    const auto tracer = make_gpu_lines(*device, c.scene, c.tables, grid, kSeed, bounds);
    const Outcome first = outcome_of(*tracer, grid, 3000);
    expect_same(first, outcome_of(*tracer, grid, 3000));
  }
}

TEST_F(LineTracers, forget_directions_when_cleared) {
  const Case c = two_rooms();
  const LightGrid grid = empty_grid(c.scene, 32);
  GpuLineBounds slabs;
  slabs.voxels = 1;
  for (const auto& tracer : {make_embree_lines(c.scene, c.tables, grid, kSeed),
                             make_gpu_lines(*device, c.scene, c.tables, grid, kSeed),
                             make_gpu_lines(*device, c.scene, c.tables, grid, kSeed, slabs)}) {
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
  const std::string twin = bytes(make_scalar_lines);
  EXPECT_TRUE(twin == bytes([&](const Scene& scene, const LineTables& tables, const LightGrid& grid,
                                uint64_t seed) {
                return make_gpu_lines(*device, scene, tables, grid, seed);
              }));
}

// Share of segments, and of tries, that Embree answers otherwise than the twin. `shift` [voxels
// of 1/256] moves every triangle of the twin's scene.
double share_unlike_embree(const Case& c, uint32_t n, float shift = 0) {
  const LightGrid grid = empty_grid(c.scene, 64);
  Scene moved = c.scene;
  for (Vec3f& p : moved.positions) p.x += shift / 256;
  const auto embree = make_embree_lines(c.scene, c.tables, grid, kSeed);
  const auto twin = make_scalar_lines(moved, c.tables, grid, kSeed);
  size_t different = 0;
  TracedLines a, b;
  embree->between_pivots(0, 0, n, a);
  twin->between_pivots(0, 0, n, b);
  for (size_t i = 0; i < n; ++i) {
    different += a.fate[i] != b.fate[i];
    EXPECT_EQ(a.ends[i].light, b.ends[i].light);
    EXPECT_EQ(a.ends[i].camera, b.ends[i].camera);
  }
  return static_cast<double>(different) / n;
}

TEST(LinesOfEmbree, differ_from_the_twin_in_one_of_10000_at_most) {
  for (const char* name : {"two-rooms", "three-rooms", "door-ajar", "window", "half-metre-hole"}) {
    const double share = share_unlike_embree(room(name), 100000);
    RecordProperty(name, std::to_string(share * 1e6) + "e-6");
    EXPECT_LE(share, 1e-4) << name;
  }
  EXPECT_GT(share_unlike_embree(two_rooms(), 20000, 1), 1e-3);  // twin
}

TEST(LinesOfEmbree, differ_from_the_twin_in_one_of_10000_at_most_in_veach_ajar) {
  const std::string path = TDPT_SHARED "/scenes/veach-ajar.glb";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const double share = share_unlike_embree(halved(read_gltf(path)), 100000);
  RecordProperty("share", std::to_string(share * 1e6) + "e-6");
  EXPECT_LE(share, 1e-4);
}

// A sheet across the hole of two-rooms.glb that is there as its alpha says.
Scene with_veil(Material veil, const Image& image) {
  Scene scene = two_rooms_scene();
  const auto first = static_cast<uint32_t>(scene.positions.size());
  for (const Vec3d& p : {Vec3d(2.05, 0.8, -0.2), Vec3d(2.05, 1.2, -0.2), Vec3d(2.05, 1.2, 0.2),
                         Vec3d(2.05, 0.8, 0.2)})
    scene.positions.push_back(Vec3f(scene.frame.to_canonical(p)));
  const auto material = static_cast<uint32_t>(scene.materials.size());
  scene.triangles.push_back({{first, first + 1, first + 2}, material});
  scene.triangles.push_back({{first, first + 2, first + 3}, material});
  scene.normals.clear(), scene.smooth.clear(), scene.tangents.clear();
  scene.uv[1].assign(scene.positions.size(), {0, 0});
  scene.colours.assign(scene.positions.size(), {1, 1, 1, 1});
  const float uv[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (uint32_t i = 0; i < 4; ++i) {
    scene.uv[1][first + i] = {uv[i][0], uv[i][1]};
    scene.colours[first + i][3] = i < 2 ? 1.0f : 0.75f;
  }
  veil.plain = false;
  veil.base_map.uv_set = 1;
  scene.images = {image};
  scene.materials.push_back(veil);
  return scene;
}

Image small_image() {
  Image image{5, 3, {}};
  for (int i = 0; i < 15; ++i)
    for (int c = 0; c < 4; ++c) image.texels.push_back(static_cast<uint8_t>(i * 53 % 256));
  return image;
}

// Alpha alone, and with textures wrapped and looked up in every way.
std::vector<Material> veil_materials() {
  using Wrap = TextureMap::Wrap;
  Material m;
  m.alpha_mode = Material::Alpha::blend;
  m.alpha = 0.6f;
  std::vector<Material> all;
  all.push_back(m);  // no texture
  m.alpha = 1;
  m.base_map.image = 0;
  m.base_map.transform = {80, 3, -0.3f, -2, 7, 0.2f};
  m.base_map.wrap_u = Wrap::repeat;
  m.base_map.wrap_v = Wrap::mirror;
  all.push_back(m);
  m.base_map.wrap_u = Wrap::clamp;
  m.base_map.wrap_v = Wrap::repeat;
  m.base_map.transform = {2, 0, -0.5f, 0, 4, 0};
  m.alpha_mode = Material::Alpha::mask;
  m.alpha_cutoff = 0.4f;
  all.push_back(m);
  m.base_map.nearest = true;
  m.base_map.wrap_u = Wrap::mirror;
  all.push_back(m);
  return all;
}

TEST_F(LineTracers, agree_on_what_is_there_with_a_probability) {
  const std::vector<Material> all = veil_materials();
  const size_t open = [&] {
    const Case c = two_rooms();
    return joining(on_device(c, empty_grid(c.scene, 16), 20000).segments);
  }();
  for (size_t i = 0; i < all.size(); ++i) {
    SCOPED_TRACE(i);
    const Case c = two_rooms(with_veil(all[i], small_image()));
    const LightGrid grid = empty_grid(c.scene, 16);
    const Outcome device_outcome = on_device(c, grid, 20000);
    expect_same(device_outcome, on_twin(c, grid, 20000));
    // The sheet takes some of the light.
    EXPECT_LT(joining(device_outcome.segments), 0.9 * static_cast<double>(open));
    EXPECT_LE(share_unlike_embree(c, 100000), 1e-4);
  }
}

namespace veils {
using namespace shader;
struct Kernel {
  const uint* veil_of;
  const Veil* veils;
  const float* texels;
  bool scene_has_veils, veils_have_textures;
#include "shaders/shared/veil.h"
};
}  // namespace veils

// Share of places on the sheet where coverage is another than coverage_at() says, by more than a
// thousandth; `shift` moves the texture.
double share_of_other_coverage(const Material& material, float shift) {
  Scene scene = with_veil(material, small_image());
  const VeilTables tables = make_veils(scene);
  const veils::Kernel kernel{tables.veil_of.data(), tables.veils.data(), tables.texels.data(), true,
                             true};
  scene.materials.back().base_map.transform[2] += shift;
  int different = 0;
  for (uint64_t i = 0; i < 100000; ++i) {
    Rng rng(8, 0, i);
    const float u = rng.uniform_float();
    const float v = rng.uniform_float() * (1 - u);
    const auto triangle = static_cast<uint32_t>(scene.triangles.size() - 1 - i % 2);
    const float mine = kernel.veil_coverage(tables.veils[tables.veil_of[triangle]], u, v);
    different += std::abs(mine - coverage_at(scene, {triangle, u, v})) > 1e-3f;
  }
  return different / 1e5;
}

TEST(Veils, cover_what_textures_say) {
  const std::vector<Material> all = veil_materials();
  for (size_t i = 0; i < all.size(); ++i) {
    EXPECT_LT(share_of_other_coverage(all[i], 0), 3e-4) << i;
    if (i == 0) continue;                                         // no texture
    EXPECT_GT(share_of_other_coverage(all[i], 0.1f), 0.01) << i;  // twin
  }
}

// Share of places on the sheet that it does not cover.
double share_uncovered(const Material& material, const Image& image, bool with_uv = true) {
  Scene scene = with_veil(material, image);
  for (auto& colour : scene.colours) colour[3] = 1;
  if (!with_uv) scene.uv[1].clear();
  const VeilTables tables = make_veils(scene);
  const veils::Kernel kernel{tables.veil_of.data(), tables.veils.data(), tables.texels.data(), true,
                             true};
  int uncovered = 0;
  for (uint64_t i = 0; i < 10000; ++i) {
    Rng rng(8, 0, i);
    const float u = rng.uniform_float();
    const float v = rng.uniform_float() * (1 - u);
    const auto triangle = static_cast<uint32_t>(scene.triangles.size() - 1 - i % 2);
    uncovered += kernel.veil_coverage(tables.veils[tables.veil_of[triangle]], u, v) < 1;
    EXPECT_EQ(kernel.veil_coverage(tables.veils[tables.veil_of[triangle]], u, v),
              coverage_at(scene, {triangle, u, v}));
  }
  return uncovered / 1e4;
}

TEST(Veils, masks_are_there_at_their_cutoff) {
  Material m;
  m.alpha_mode = Material::Alpha::mask;
  for (const float alpha : {1.0f, 0.9f, 0.5f, 0.3f}) {
    m.alpha = m.alpha_cutoff = alpha;
    EXPECT_EQ(share_uncovered(m, small_image()), 0) << alpha;
    m.alpha_cutoff = std::nextafter(alpha, 2.0f);
    EXPECT_EQ(share_uncovered(m, small_image()), 1) << alpha;  // twin
  }
}

TEST(Veils, without_texture_coordinates_have_the_texel_of_the_transform) {
  Material m;
  m.alpha_mode = Material::Alpha::mask;
  m.alpha_cutoff = 0.5f;
  m.base_map.image = 0;
  m.base_map.nearest = true;
  const Image halves{2, 1, {0, 0, 0, 0, 255, 255, 255, 255}};  // alpha 0, then 1
  EXPECT_EQ(share_uncovered(m, halves, false), 1);
  m.base_map.transform = {1, 0, 0.75f, 0, 1, 0};
  EXPECT_EQ(share_uncovered(m, halves, false), 0);
}

// Segments that rounding likes least, in a closed room from -1 to 1: along axes and edges, in the
// plane of walls, through corners of voxels and of triangles, of no length, out of the scene.
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
    shader::VoxelWalk walk = shader::voxel_walk((a - p.grid_corner) * p.voxels_per_unit,
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

TEST(SlabDepth, KeepsToTheDevicesLimits) {
  gpu::Limits limits;
  limits.memory = 1ull << 30;
  limits.image = 1ull << 28;
  limits.image_side = 256;
  LightGrid grid;
  grid.dim = {128, 100, 50};
  EXPECT_EQ(slab_depth("a device", limits, grid), 50u);
  limits.image = 4 * 128 * 100 * 7 + 1;
  EXPECT_EQ(slab_depth("a device", limits, grid), 7u);
  limits.memory = 2 * 16 * 128 * 100 * 5;
  EXPECT_EQ(slab_depth("a device", limits, grid), 5u);
  limits.memory = 1;
  EXPECT_EQ(slab_depth("a device", limits, grid), 1u);
  grid.dim = {128, 300, 50};
  try {
    slab_depth("a device", limits, grid);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code, Exit::no_device);
    EXPECT_STREQ(
        e.what(),
        "a device: the grid has 300 voxels along one side, the device's images at most 256");
  }
}

// Rays that meet triangle 0 after 1 in +x and triangle 1 after 1 in -x.
struct BetweenTwo {
  bool ahead = true, behind = true;
  mutable std::vector<uint32_t> coins;
  bool segment_blocked(const Vec3f&, const Vec3f&, uint32_t) const { return false; }
  bool first_hit(const Vec3f&, const Vec3f& w, uint32_t coin, shader::SurfaceHit& hit) const {
    coins.push_back(coin);
    hit = {1, w.x > 0 ? 0u : 1u, 0, 0, 0};
    return w.x > 0 ? ahead : behind;
  }
};

TEST(LineKernel, lines_through_a_place_lead_from_light_to_camera) {
  LineTables tables;
  tables.normals = {{{-1, 0, 0}, 0}, {{-1, 0, 0}, 0}};  // faces 0 and 3 are met
  tables.first_cell = {0, 1, 1, 1, 2};
  VoxelSums sums(1);
  BetweenTwo rays;
  shader::LineEnds line;
  // Regions ahead and behind; which cut.
  const auto fate = [&](uint32_t ahead, uint32_t behind, uint32_t c, Vec3f direction) {
    tables.cells = {{{0, 0, 0}, ahead}, {{0, 0, 0}, behind}};
    shader::LightParameters p{};
    p.cell_corner = {-50, -50, -50};
    p.cells_per_unit = 0.01f;
    p.levels = 1;
    p.cut = c;
    rays.coins.clear();
    shader::LineKernel<BetweenTwo> kernel(rays, tables, p, sums);
    const uint32_t out = kernel.line_through({{0, 2, 3}, 0, direction, 0}, 9, line);
    for (const uint32_t coin : rays.coins) EXPECT_EQ(coin, kernel.coin_of_line(9));
    return out;
  };
  const Vec3f right(1, 0, 0);
  for (const float turned : {1.0f, -1.0f}) {
    SCOPED_TRACE(turned);
    EXPECT_EQ(fate(0, 1, 0, right * turned), FATE_JOINS);
    EXPECT_NEAR(line.light.x, 1, 1e-5);
    EXPECT_NEAR(line.camera.x, -1, 1e-5);
    EXPECT_EQ(line.light.y, 2);
    EXPECT_EQ(line.camera.z, 3);
    EXPECT_EQ(line.light_face, 0u);
    EXPECT_EQ(line.camera_face, 3u);
    EXPECT_EQ(fate(2, 1, 1, right * turned), FATE_JOINS);
    EXPECT_NEAR(line.light.x, -1, 1e-5);
    EXPECT_EQ(line.light_face, 3u);
    EXPECT_EQ(line.camera_face, 0u);
    EXPECT_EQ(fate(2, 1, 0, right * turned), FATE_SAME_SIDE);
    EXPECT_EQ(fate(0, 1, 1, right * turned), FATE_SAME_SIDE);
  }
  EXPECT_EQ(fate(0, 1, 0, Vec3f(0)), FATE_NONE);
  EXPECT_TRUE(rays.coins.empty());
  rays.ahead = false;
  EXPECT_EQ(fate(0, 1, 0, right), FATE_NONE);
  rays.ahead = true, rays.behind = false;
  EXPECT_EQ(fate(0, 1, 0, right), FATE_NONE);
  rays.behind = true;
  tables.first_cell = {0, 1, 1, 2, 2};  // no patch on face 3
  EXPECT_EQ(fate(0, 1, 0, right), FATE_NONE);
}

// What a tracer is asked for.
class AskedTracer : public LineTracer {
 public:
  AskedTracer(const Scene& scene, const LineTables& tables, const LightGrid& grid, uint64_t seed)
      : LineTracer(scene, tables, grid, seed) {}
  void clear() override {}
  void counts(std::vector<uint32_t>&) override {}
  void take_directions(std::vector<Vec3d>&) override {}
  shader::LightParameters asked{};

 protected:
  void trace_segments(const shader::LightParameters& p, TracedLines&) override { asked = p; }
  void trace_tries(const shader::LightParameters& p, std::span<const shader::LineTry>,
                   TracedLines&) override {
    asked = p;
  }
};

TEST(LineTracer, asks_for_random_numbers_of_its_own_for_each_cut_and_pass) {
  const Case c = two_rooms();
  LineTables tables = c.tables;
  for (uint32_t k = 0; k < kMostCuts; ++k) tables.cuts.push_back({k, 7 + k});
  tables.cuts.erase(tables.cuts.begin());
  const LightGrid grid = empty_grid(c.scene, 32);
  AskedTracer tracer(c.scene, tables, grid, kSeed);
  TracedLines lines;
  std::vector<uint32_t> streams;
  const auto add = [&](uint32_t k) {
    const shader::LightParameters& p = tracer.asked;
    EXPECT_EQ(uint64_t{p.seed.y} << 32 | p.seed.x, kSeed);
    EXPECT_EQ(p.cut, k);
    EXPECT_EQ(p.first_arc, k);
    EXPECT_EQ(p.arcs, 7 + k);
    EXPECT_EQ(p.slab_low, 0);
    EXPECT_EQ(p.slab_high, grid.dim[2]);
    for (const uint32_t of : {0u, LINE_VOTES_OF_LIGHT, LINE_VOTES_OF_CAMERA})
      streams.push_back(p.stream + of);
  };
  for (uint32_t k = 0; k < kMostCuts; ++k) {
    tracer.between_pivots(k, ~0u - 5, 3, lines);
    EXPECT_EQ(tracer.asked.first, ~0u - 5);
    EXPECT_EQ(tracer.asked.count, 3u);
    add(k);
    tracer.through(k, 47, std::vector<shader::LineTry>(5), lines);
    EXPECT_EQ(tracer.asked.round, 47u);
    EXPECT_EQ(tracer.asked.count, 5u);
    add(k);
  }
  std::sort(streams.begin(), streams.end());
  EXPECT_EQ(std::unique(streams.begin(), streams.end()), streams.end());
}

// The tables themselves.

// The kernel's functions over a scene without rays.
struct NoRays {
  bool segment_blocked(const Vec3f&, const Vec3f&, uint32_t) const { return false; }
  bool first_hit(const Vec3f&, const Vec3f&, uint32_t, shader::SurfaceHit&) const { return false; }
};

// Everything that tells lines apart tells their coins apart, so that other lines meet other veils.
TEST(LineKernel, coins_are_of_one_line_only) {
  const LineTables tables;
  VoxelSums sums(1);
  const NoRays none;
  std::vector<uint32_t> coins;
  for (int i = 0; i < 7; ++i) {
    shader::LightParameters p{};
    p.seed = {i == 1, i == 2};
    p.stream = i == 3;
    p.round = i == 4;
    shader::LineKernel<NoRays> kernel(none, tables, p, sums);
    coins.push_back(kernel.coin_of_line(i == 5));
  }
  EXPECT_EQ(coins[0], coins[6]);
  coins.pop_back();
  std::sort(coins.begin(), coins.end());
  EXPECT_EQ(std::unique(coins.begin(), coins.end()), coins.end());
}

// p of the faces that lines of the second of two cuts end on, against capacities and areas;
// `wrong` is added to a capacity.
double p_of_faces(double wrong) {
  Scene scene;
  for (const float side : {1.0f, 0.5f, 0.7f, 0.2f}) {
    const auto first = static_cast<uint32_t>(scene.positions.size());
    scene.positions.insert(scene.positions.end(), {{0, 0, side}, {side, 0, side}, {0, side, side}});
    scene.triangles.push_back({{first, first + 1, first + 2}, 0});
  }
  CutFile cut;
  cut.grid = {Vec3d(-50), 100};
  cut.patches.resize(4);
  cut.patches[0].faces = {0, 2};
  cut.patches[1].faces = {4};
  cut.patches[2].faces = {6};
  cut.patches[3].faces = {1, 5, 7};
  cut.region = {0, 1, 2, 2};
  cut.cuts.resize(2);
  cut.arcs = {{0, 2, 1}, {0, 3, 2}, {1, 2, 5}, {1, 3, 0.5}};
  std::vector<double> probability(64, 0);  // light's face * 8 + camera's
  for (const CutArc& arc : cut.arcs) {
    const auto area = [&](uint32_t face) { return shape_of(scene, face / 2).area; };
    double all = 0;
    for (const uint32_t a : cut.patches[arc.from].faces)
      for (const uint32_t b : cut.patches[arc.to].faces) all += area(a) * area(b);
    for (const uint32_t a : cut.patches[arc.from].faces)
      for (const uint32_t b : cut.patches[arc.to].faces)
        probability[8 * a + b] += arc.capacity / 8.5 * area(a) * area(b) / all;
  }
  cut.arcs[1].capacity += wrong;
  const LineTables tables = make_line_tables(scene, cut, "a.cut");
  shader::LightParameters p{};
  p.seed = {3, 0};
  p.first_arc = tables.cuts[1].first;
  p.arcs = tables.cuts[1].count;
  EXPECT_EQ(p.first_arc, 2u);
  EXPECT_EQ(p.arcs, 4u);
  VoxelSums sums(1);
  const NoRays none;
  shader::LineKernel<NoRays> kernel(none, tables, p, sums);
  return chi_square_of_samples(100000, probability,
                               [&](uint64_t i) {
                                 const auto line = kernel.draw_line(static_cast<uint32_t>(i));
                                 return size_t{8} * line.light_face + line.camera_face;
                               })
      .p;
}

TEST(LineKernel, lines_end_on_pairs_by_capacity_and_on_faces_by_area) {
  EXPECT_GT(p_of_faces(0), 1e-4);
  EXPECT_LT(p_of_faces(0.3), 1e-9);  // twin
}

TEST(LineKernel, lines_are_free_when_both_faces_look_along) {
  LineTables tables;
  tables.normals = {{{0, 0, 1}, 0}, {{0, 0.6f, -0.8f}, 0}};
  VoxelSums sums(1);
  const NoRays none;
  shader::LineKernel<NoRays> kernel(none, tables, {}, sums);
  const Vec3f up(0, 0, 0.5f);
  const auto is_free = [&](const Vec3f& to, uint32_t light_face, uint32_t camera_face) {
    return kernel.line_is_free({{}, light_face, to, camera_face}, 0);
  };
  EXPECT_TRUE(is_free(up, 0, 2));    // from a front to a front
  EXPECT_FALSE(is_free(up, 1, 2));   // from the back of it
  EXPECT_FALSE(is_free(up, 0, 3));   // to the back
  EXPECT_FALSE(is_free(-up, 0, 2));  // the other way
  EXPECT_TRUE(is_free(-up, 1, 3));
  EXPECT_FALSE(is_free({0.5f, 0, 0}, 0, 2));  // within the plane of one
}

TEST(LineKernel, marches_through_voxels_of_the_slab_towards_the_camera) {
  const LineTables tables;
  const NoRays none;
  shader::LightParameters p{};
  p.grid_corner = {-1, 0, 1};
  p.voxels_per_unit = 2;
  p.dim = {3, 2, 4};
  p.slab_low = 1;
  p.slab_high = 3;
  VoxelSums sums(24);
  shader::LineKernel<NoRays> kernel(none, tables, p, sums);
  kernel.march({{-0.9f, 0.6f, 2.9f}, 0, {-0.9f, 0.6f, 1.1f}, 0});  // down voxel (0,1)
  kernel.march({{0.4f, 0.1f, 1.7f}, 0, {-0.9f, 0.1f, 1.7f}, 0});   // along row (y,z) = (0,1)
  std::vector<Vec3d> direction(24);
  sums.take_directions(direction);
  for (size_t i = 0; i < 24; ++i) {
    const size_t x = i % 3, y = i / 3 % 2, z = i / 6;
    const bool first = x == 0 && y == 1 && (z == 1 || z == 2), second = y == 0 && z == 1;
    EXPECT_EQ(sums.counts()[i], first || second ? 1u : 0u) << i;
    EXPECT_EQ(direction[i], first ? Vec3d(0, 0, -1) : second ? Vec3d(-1, 0, 0) : Vec3d()) << i;
  }
}

TEST(LineKernel, directions_are_rounded_to_the_nearest_unit) {
  const LineTables tables;
  VoxelSums sums(1);
  const NoRays none;
  shader::LineKernel<NoRays> kernel(none, tables, {}, sums);
  Vec3d off;
  for (uint64_t i = 0; i < 10000; ++i) {
    Rng rng(9, 0, i);
    const float x = rng.uniform_float(), y = rng.uniform_float(), z = rng.uniform_float();
    const Vec3f w = Vec3f(x, y, z) * 2 - Vec3f(1);
    const Vec3d d =
        Vec3d(kernel.direction_in_units(w)) - normalize(Vec3d(w)) * double{LIGHT_DIRECTION_UNITS};
    for (int c = 0; c < 3; ++c) EXPECT_LE(std::abs(d[c]), 0.501);
    off += d * 1e-4;
  }
  EXPECT_LT(length(off), 0.02);  // no bias: 0.29 / 100 along each axis
  EXPECT_EQ(kernel.direction_in_units(Vec3f(0)), shader::ivec3(0));
}

// Two triangles without place, whose fronts look along +z. Rays meet what the ballot says, one
// after the other; behind its end, nothing.
enum class Ballot { nothing, own, other };
struct Ballots {
  std::vector<Ballot> of_rays;
  mutable std::vector<uint32_t> coins;
  bool segment_blocked(const Vec3f&, const Vec3f&, uint32_t) const { return false; }
  bool first_hit(const Vec3f&, const Vec3f&, uint32_t coin, shader::SurfaceHit& hit) const {
    const size_t i = coins.size();
    coins.push_back(coin);
    if (i >= of_rays.size() || of_rays[i] == Ballot::nothing) return false;
    hit = {1, of_rays[i] == Ballot::own ? 0u : 1u, 0, 0, 0};
    return true;
  }
};

// Whether the ends of a line win their votes; the coins of the rays that were asked.
bool win(const std::vector<Ballot>& of_rays, std::vector<uint32_t>& coins, uint32_t number = 0,
         uint32_t round = 0, uint32_t stream = 0x10000) {
  Scene scene;
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.triangles = {{{0, 1, 2}, 0}, {{0, 1, 2}, 0}};
  CutFile cut;
  cut.grid = {Vec3d(-50), 100};
  Patch light{}, camera{};
  light.faces = {0, 3};  // the light's end looks down, at the fronts
  camera.faces = {1, 2};
  cut.patches = {light, camera};
  cut.region = {0, 1};
  cut.cuts.resize(1);
  const LineTables tables = make_line_tables(scene, cut, "a.cut");
  shader::LightParameters p{};
  p.cell_corner = tables.cell_corner;
  p.cells_per_unit = tables.cells_per_unit;
  p.levels = tables.levels;
  p.round = round;
  p.stream = stream;
  VoxelSums sums(1);
  const Ballots rays{of_rays, {}};
  shader::LineKernel<Ballots> kernel(rays, tables, p, sums);
  const bool won = kernel.ends_see_their_sides({{}, 1, {}, 0}, number);
  coins = rays.coins;
  return won;
}

TEST(LineKernel, ends_win_by_a_lead_of_four_or_by_more_of_sixteen) {
  std::vector<uint32_t> coins;
  const auto votes = [](size_t own, size_t other) {
    std::vector<Ballot> v(own, Ballot::own);
    v.insert(v.end(), other, Ballot::other);
    return v;
  };
  // Both ends, at once: four rays each.
  EXPECT_TRUE(win(votes(8, 0), coins));
  EXPECT_EQ(coins.size(), 8u);
  // One end, then none for the other.
  EXPECT_FALSE(win(votes(0, 4), coins));
  EXPECT_EQ(coins.size(), 4u);
  EXPECT_FALSE(win(votes(4, 4), coins));
  EXPECT_EQ(coins.size(), 8u);
  // Three votes are too few, and 16 rays are all.
  EXPECT_FALSE(win(votes(3, 0), coins));
  EXPECT_EQ(coins.size(), 16u);
  // A tie is none; nine of sixteen win.
  std::vector<Ballot> tie;
  for (int i = 0; i < 8; ++i) tie.insert(tie.end(), {Ballot::own, Ballot::other});
  EXPECT_FALSE(win(tie, coins));
  EXPECT_EQ(coins.size(), 16u);
  tie[15] = Ballot::own;
  tie.resize(20, Ballot::own);
  EXPECT_TRUE(win(tie, coins));
  EXPECT_EQ(coins.size(), 20u);
}

// No random number is drawn twice: not by both ends, nor by the line itself, nor by another one.
TEST(LineKernel, votes_have_numbers_of_their_own) {
  std::vector<uint32_t> all, coins;
  const std::vector<Ballot> mine(8, Ballot::own);
  const uint32_t segments = 0x10000, tries = 0x20000;
  for (const auto& [number, round, stream] :
       std::vector<std::array<uint32_t, 3>>{{0, 0, segments},
                                            {1, 0, segments},
                                            {0, 1, segments},
                                            {0, 0, tries},
                                            {0, 0, segments + kMostCuts - 1},
                                            {0, 0, tries + kMostCuts - 1}}) {
    ASSERT_TRUE(win(mine, coins, number, round, stream));
    all.insert(all.end(), coins.begin(), coins.end());
    shader::RandomNumbers line = shader::random_numbers({0, 0}, stream, number, round);
    for (int i = 0; i < 64; ++i) all.push_back(shader::random_word(line));
  }
  EXPECT_EQ(all.size(), 6 * 72u);
  std::sort(all.begin(), all.end());
  EXPECT_EQ(std::unique(all.begin(), all.end()), all.end());
}

TEST(LineTables, CellsShareATriangleOut) {
  Scene scene;
  scene.frame = {{10, 0, 0}, 0.5};
  scene.positions = {{-0.9f, -0.8f, 0.3f}, {0.8f, -0.5f, -0.4f}, {0.1f, 0.9f, 0.2f}};
  scene.triangles = {{{0, 1, 2}, 0}};
  CutFile cut;
  cut.grid.origin = {8.1, -2.03, -1.01};
  cut.grid.base_cell = 0.61;
  cut.cuts.resize(1);
  for (int32_t x = 0; x < 8; ++x)
    for (int32_t y = 0; y < 8; ++y)
      for (int32_t z = 0; z < 5; ++z) {
        Patch patch{};
        patch.cell = {x, y, z};
        patch.faces = {1};
        cut.patches.push_back(patch);
        cut.region.push_back(0);
        cut.arcs.push_back({0, static_cast<uint32_t>(cut.patches.size() - 1), 1});
      }
  const LineTables tables = make_line_tables(scene, cut, "a.cut");
  double total = 0;
  int used = 0;
  for (size_t i = 0; i < cut.patches.size(); ++i) {
    const shader::PatchPieces& of = tables.patches[i];
    used += of.count > 0;
    for (uint32_t k = of.first; k < of.first + of.count; ++k) {
      const shader::Piece& piece = tables.pieces[k];
      EXPECT_EQ(piece.face, 1u);
      EXPECT_LT(piece.alias - of.first, of.count);
      total += 0.5 * length(cross(Vec3d(piece.b - piece.a), Vec3d(piece.c - piece.a)));
      for (const Vec3f& p : {piece.a, piece.b, piece.c}) {
        const Vec3d q = (scene.frame.to_metres(Vec3d(p)) - cut.grid.origin) / cut.grid.base_cell;
        for (int c = 0; c < 3; ++c) {
          EXPECT_GE(q[c], cut.patches[i].cell[static_cast<size_t>(c)] - 1e-6);
          EXPECT_LE(q[c], cut.patches[i].cell[static_cast<size_t>(c)] + 1 + 1e-6);
        }
      }
    }
  }
  EXPECT_GT(used, 10);
  EXPECT_NEAR(total, shape_of(scene, 0).area, 1e-6);
}

TEST(LineTables, FinerPatchesComeFirst) {
  Scene scene;
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.triangles = {{{0, 1, 2}, 0}};
  CutFile cut;
  cut.grid.base_cell = 4;
  Patch coarse{}, fine{};
  coarse.faces = fine.faces = {0};
  fine.level = 2;  // cells of 0.25
  cut.patches = {coarse, fine};
  cut.region = {0, 1};
  cut.cuts.resize(1);
  const LineTables tables = make_line_tables(scene, cut, "a.cut");
  shader::LightParameters p{};
  p.cell_corner = tables.cell_corner;
  p.cells_per_unit = tables.cells_per_unit;
  p.levels = tables.levels;
  VoxelSums sums(1);
  const NoRays none;
  shader::LineKernel<NoRays> kernel(none, tables, p, sums);
  const auto region = [&](uint32_t face, const Vec3f& at) {
    uint32_t r = 9;
    return kernel.region_at(face, at, r) ? static_cast<int>(r) : -1;
  };
  EXPECT_EQ(region(0, {0.1f, 0.1f, 0}), 1);
  EXPECT_EQ(region(0, {0.5f, 0.1f, 0}), 0);
  EXPECT_EQ(region(1, {0.5f, 0.1f, 0}), -1);
  EXPECT_EQ(region(0, {5, 0.1f, 0}), -1);
}

TEST(LineTables, CellsTooSmallForFloatsHoldNothing) {
  Scene scene;
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.triangles = {{{0, 1, 2}, 0}};
  CutFile cut;
  cut.grid.base_cell = 1e-45;
  Patch patch{};
  patch.faces = {0};
  patch.cell = {INT32_MIN, INT32_MIN, INT32_MIN};
  cut.patches = {patch};
  cut.region = {0};
  const LineTables tables = make_line_tables(scene, cut, "a.cut");
  shader::LightParameters p{};
  p.cells_per_unit = tables.cells_per_unit;
  p.levels = tables.levels;
  VoxelSums sums(1);
  const NoRays none;
  shader::LineKernel<NoRays> kernel(none, tables, p, sums);
  uint32_t region;
  for (const Vec3f& at : {Vec3f(0), Vec3f(0.1f), Vec3f(-0.1f, 0, 0)})  // 0 * infinity
    EXPECT_FALSE(kernel.region_at(0, at, region));
}

}  // namespace
}  // namespace tdpt
