// The kernel's functions one by one on artificial rays; what is asked of tracers; the tables.
#include "tools/lightgrid/line_kernel.h"

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "libcommon/testing/statistics/chi_square.h"
#include "tools/lightgrid/lightgrid.h"

namespace tdpt::line_kernel_test {

// Packed neighbouring sums of both signs do not disturb each other, up to their maximum.
TEST(VoxelSums, keep_what_they_pack_apart) {
  VoxelSums sums(2);
  constexpr int32_t kMost = 2048;
  for (int i = 0; i < LIGHT_MOST_SUMMED; ++i) {
    sums.add(0, {-kMost, kMost, -kMost});
    sums.add(1, {i % 2, -(i % 4), i % 8});
  }
  std::vector<uint32_t> count;
  sums.counts(count);
  EXPECT_EQ(count, (std::vector<uint32_t>{LIGHT_MOST_SUMMED, LIGHT_MOST_SUMMED}));
  std::vector<Vec3d> direction(2);
  sums.take_directions(direction);
  EXPECT_EQ(direction[0], Vec3d(-1, 1, -1) * double{LIGHT_MOST_SUMMED});
  EXPECT_EQ(direction[1], Vec3d(0.5, -1.5, 3.5) * (LIGHT_MOST_SUMMED / 2048.0));
  sums.add(1, {1, -1, 1});
  sums.counts(count);
  EXPECT_EQ(count[1], LIGHT_MOST_SUMMED + 1u);
  sums.take_directions(direction);
  EXPECT_EQ(direction[1].y, -1.5 * (LIGHT_MOST_SUMMED / 2048.0) - 1 / 2048.0);
}

shader::LightParameters parameters_of(const LineTables& tables) {
  shader::LightParameters p{};
  p.first_sky_face = UINT32_MAX;
  p.cell_corner = tables.cell_corner;
  p.cells_per_unit = tables.cells_per_unit;
  p.levels = tables.levels;
  return p;
}

// Two triangles in one place, and a cut with these patches, one on each side.
Scene two_triangles() {
  Scene scene;
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  scene.triangles = {{{0, 1, 2}, 0}, {{0, 1, 2}, 0}};
  return scene;
}
LineTables tables_of(const Patch& light, const Patch& camera, const PatchGrid& grid) {
  CutFile cut;
  cut.grid = grid;
  cut.patches = {light, camera};
  cut.sides = {0, 1};
  cut.cuts.resize(1);
  return make_line_tables(two_triangles(), cut, "a.cut");
}

// A scene without rays.
struct NoRays {
  bool segment_blocked(const Vec3f&, const Vec3f&, uint32_t) const { return false; }
  bool first_hit(const Vec3f&, const Vec3f&, uint32_t, shader::SurfaceHit&) const { return false; }
};

// Records what a tracer is asked for.
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
  const Scene scene = two_triangles();
  const uint64_t seed = 0x1234'5678'9abc'def0;
  LineTables tables;
  for (uint32_t k = 0; k < kMostCuts; ++k) tables.cuts.push_back({k, 7 + k, {}});
  const LightGrid grid = empty_grid(scene, 32);
  AskedTracer tracer(scene, tables, grid, seed);
  TracedLines lines;
  std::vector<uint32_t> streams;
  const auto add = [&](uint32_t k) {
    const shader::LightParameters& p = tracer.asked;
    EXPECT_EQ(std::tuple(p.seed, p.cut, p.first_arc, p.arcs), std::tuple(seed, k, k, 7 + k));
    for (const uint32_t of : {0u, LINE_VOTES_OF_LIGHT, LINE_VOTES_OF_CAMERA, LINE_COIN})
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

// p-value of the end faces of lines of the second of two cuts, against capacities and areas;
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
  cut.sides = {0, 1, 3, 3};
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
  p.first_sky_face = UINT32_MAX;
  p.seed = 3;
  p.first_arc = tables.cuts[1].first;
  p.arcs = tables.cuts[1].count;
  EXPECT_EQ(p.first_arc, 2u);
  EXPECT_EQ(p.arcs, 4u);
  VoxelSums sums(1);
  const NoRays none;
  shader::LineKernel<NoRays> kernel(none, tables, p, sums);
  return chi_square_of_samples(20000, probability,
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
  tables.face_normals = {{{0, 0, 1}, 0}, {{0, 0.6f, -0.8f}, 0}};
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
  EXPECT_LT(length(off), 0.02);  // unbiased: 0.29 / 100 along each axis
  EXPECT_EQ(kernel.direction_in_units(Vec3f(0)), shader::ivec3(0));
}

// Two triangles without position, whose fronts face +z. Rays hit what the ballot says, in order;
// after its end, nothing.
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

// Whether the ends of a line win their votes; also returns the coins of the rays. The
// last is the line's own.
bool win(const std::vector<Ballot>& of_rays, std::vector<uint32_t>& coins, uint32_t number = 0,
         uint32_t round = 0, uint32_t stream = 0x10000, uint64_t seed = 0) {
  Patch light{}, camera{};
  light.faces = {0, 3};  // the light's end looks down, at the fronts
  camera.faces = {1, 2};
  const LineTables tables = tables_of(light, camera, {Vec3d(-50), 100});
  shader::LightParameters p = parameters_of(tables);
  p.round = round;
  p.stream = stream;
  p.seed = seed;
  VoxelSums sums(1);
  const Ballots rays{of_rays, {}};
  shader::LineKernel<Ballots> kernel(rays, tables, p, sums);
  const bool won = kernel.ends_see_their_sides({{}, 1, {}, 0}, number);
  coins = rays.coins;
  coins.push_back(kernel.coin_of_line(number));
  return won;
}

TEST(LineKernel, ends_win_by_a_lead_of_four_or_by_more_of_sixteen) {
  std::vector<uint32_t> coins;
  const auto votes = [](size_t own, size_t other) {
    std::vector<Ballot> v(own, Ballot::own);
    v.insert(v.end(), other, Ballot::other);
    return v;
  };
  // Both ends at once: four rays each.
  EXPECT_TRUE(win(votes(8, 0), coins));
  EXPECT_EQ(coins.size(), 9u);
  // One end, then none for the other.
  EXPECT_FALSE(win(votes(0, 4), coins));
  EXPECT_EQ(coins.size(), 5u);
  EXPECT_FALSE(win(votes(4, 4), coins));
  EXPECT_EQ(coins.size(), 9u);
  // Three votes are too few, and 16 rays are the maximum.
  EXPECT_FALSE(win(votes(3, 0), coins));
  EXPECT_EQ(coins.size(), 17u);
  // A tie does not win; nine of sixteen do.
  std::vector<Ballot> tie;
  for (int i = 0; i < 8; ++i) tie.insert(tie.end(), {Ballot::own, Ballot::other});
  EXPECT_FALSE(win(tie, coins));
  EXPECT_EQ(coins.size(), 17u);
  tie[15] = Ballot::own;
  tie.resize(20, Ballot::own);
  EXPECT_TRUE(win(tie, coins));
  EXPECT_EQ(coins.size(), 21u);
}

// No random number is used twice: not by both ends, nor by the line itself, nor by another line.
TEST(LineKernel, votes_have_numbers_of_their_own) {
  std::vector<uint32_t> all, coins;
  const std::vector<Ballot> mine(8, Ballot::own);
  const uint32_t segments = 0x10000, tries = 0x20000, last = kMostCuts - 1;
  const uint64_t high = shader::word64_of(1, 0), low = shader::word64_of(0, 1);
  for (const auto& [number, round, stream, seed] :
       std::vector<std::tuple<uint32_t, uint32_t, uint32_t, uint64_t>>{{0, 0, segments, 0},
                                                                       {1, 0, segments, 0},
                                                                       {0, 1, segments, 0},
                                                                       {0, 0, segments, high},
                                                                       {0, 0, segments, low},
                                                                       {0, 0, tries, 0},
                                                                       {0, 0, segments + last, 0},
                                                                       {0, 0, tries + last, 0}}) {
    ASSERT_TRUE(win(mine, coins, number, round, stream, seed));
    all.insert(all.end(), coins.begin(), coins.end());
    shader::Rng line = shader::rng_of(seed, stream, number, round);
    for (int i = 0; i < 64; ++i) all.push_back(shader::random_word(line));
  }
  EXPECT_EQ(all.size(), 8 * 73u);
  std::sort(all.begin(), all.end());
  EXPECT_EQ(std::unique(all.begin(), all.end()), all.end());
}

// The tables themselves.

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
        cut.sides.push_back(0);
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

// Each cut has its own sides, also in the second of a region's two words.
TEST(LineTables, RegionsHaveASideOfEachCut) {
  CutFile cut;
  cut.grid = {Vec3d(-50), 100};
  cut.patches.resize(2);
  cut.patches[0].faces = {0};
  cut.patches[1].faces = {1};
  cut.sides = {0b01, uint64_t{1} << 40};
  cut.cuts.resize(41);
  const LineTables tables = make_line_tables(two_triangles(), cut, "a.cut");
  VoxelSums sums(1);
  const NoRays none;
  for (const uint32_t c : {0u, 1u, 40u}) {
    shader::LightParameters p = parameters_of(tables);
    p.cut = c;
    shader::LineKernel<NoRays> kernel(none, tables, p, sums);
    for (uint32_t face = 0; face < 2; ++face) {
      uint32_t region;
      ASSERT_TRUE(kernel.region_at(face, Vec3f(0.1f, 0.1f, 0), region));
      EXPECT_EQ(kernel.side_of_region(region), cut.sides[face] >> c & 1);
    }
  }
}

TEST(LineTables, FinerPatchesComeFirst) {
  Patch coarse{}, fine{};
  coarse.faces = fine.faces = {0};
  fine.level = 2;  // cells of 0.25
  const auto region = [&](double cell, uint32_t face, const Vec3f& at) {
    const LineTables tables = tables_of(coarse, fine, {{}, cell});
    VoxelSums sums(1);
    const NoRays none;
    shader::LineKernel<NoRays> kernel(none, tables, parameters_of(tables), sums);
    uint32_t r = 9;
    return kernel.region_at(face, at, r) ? static_cast<int>(r) : -1;
  };
  EXPECT_EQ(region(4, 0, {0.1f, 0.1f, 0}), 1);
  EXPECT_EQ(region(4, 0, {0.5f, 0.1f, 0}), 0);
  EXPECT_EQ(region(4, 1, {0.5f, 0.1f, 0}), -1);
  EXPECT_EQ(region(4, 0, {5, 0.1f, 0}), -1);
  // Cells too small for floats hold nothing: 0 * infinity.
  coarse.cell = fine.cell = {INT32_MIN, INT32_MIN, INT32_MIN};
  for (const Vec3f& at : {Vec3f(0), Vec3f(0.1f), Vec3f(-0.1f, 0, 0)})
    EXPECT_EQ(region(1e-45, 0, at), -1);
}

}  // namespace tdpt::line_kernel_test
