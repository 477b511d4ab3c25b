// A portal may be anywhere: a bad one costs time but never changes the picture.
//
// Each picture is compared with the same integrator's without portals. Both use the same walks, so
// that run by run only the light that segments add, and that the other weights lose, differs.
#include <gtest/gtest.h>

#include <map>
#include <numbers>

#include "tools/tdpt-render/testing/agreement.h"
#include "tools/tdpt-render/testing/faults.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::misplaced_portals_test {

// Enough to detect 10 % of a portal's density, sample by sample; 5 %: path_test.
constexpr AgreementSettings kSettings{.max_depth = 4, .runs = 32, .spp = 6};

/// In the plane of the window, light going to -x; y and z extents.
Portal across(double x, double y0, double y1, double z0, double z1) {
  return rectangle({x, y0, z0}, {0, 0, z1 - z0}, {0, y1 - y0, 0});
}
Portal in_the_window() {
  return across(2.05, 0.2, 1.8, -0.8, 0.8);
}

/// Rotated about the horizontal axis through the window's centre.
Portal turned(double degrees) {
  const double a = degrees * std::numbers::pi / 180, h = 0.7;
  const Vec3d up = Vec3d(std::sin(a), std::cos(a), 0) * h, side{0, 0, h};
  return rectangle(Vec3d(2.05, 1, 0) - up - side, side * 2, up * 2);
}

Portal reversed(Portal p) {
  for (auto& t : p.triangles) std::swap(t[1], t[2]);
  return p;
}

std::vector<Portal> for_both_ways(std::vector<Portal> portals) {
  for (Portal& p : portals) p.both_ways = true;
  return portals;
}

/// A disc of n triangles, light going to -x.
Portal fan(int n) {
  Portal p{"fan", {{2.05, 1, 0}}, {}, {}};
  for (int i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n;
    p.vertices.push_back({2.05, 1 + 0.75 * std::sin(a), 0.75 * std::cos(a)});
    const auto v = [&](int k) { return static_cast<uint32_t>(1 + k % n); };
    p.triangles.push_back({0, v(i), v(i + 1)});
  }
  return p;
}

struct Case {
  const char* what;
  std::vector<Portal> portals;
};
class misplaced_portals : public ::testing::Test {
 protected:
  Vista world_with(const std::vector<Portal>& portals) const {
    return Vista(scene_, scene_.camera(""), 32, 24, portals);
  }
  /// Expects the picture without portals, by the same walks.
  void expect_harmless(const char* what, const std::vector<Portal>& portals,
                       const Integrator& integrator = tdpt_ref) {
    const DepthRuns runs = render_runs(world_with(portals), integrator, kSettings);
    EXPECT_EQ(runs.not_finite, 0u);
    EXPECT_TRUE(holds(judge(runs, reference(integrator), testing::compare_paired),
                      std::string(what) + ", " + integrator.name, runs, reference(integrator)));
  }
  bool caught(const Vista& faulty) {
    const DepthRuns runs = render_runs(faulty, tdpt_ref, kSettings);
    return !judge(runs, reference(tdpt_ref), testing::compare_paired).holds();
  }

  const Scene scene_ = read_gltf(TDPT_TESTDATA "/scenes/window.glb");

 private:
  const DepthRuns& reference(const Integrator& integrator) {
    DepthRuns& runs = references_[&integrator];
    if (runs.of_depth.empty()) runs = render_runs(world_with({}), integrator, kSettings);
    return runs;
  }
  std::map<const Integrator*, DepthRuns> references_;
};
class long_misplaced_portals : public misplaced_portals {};

const std::vector<Case> kSets{
    {"half beside it", {across(2.05, 0.2, 1.8, -1.6, 0)}},
    {"a tenth too narrow", {across(2.05, 0.2, 1.8, -0.8, 0.64)}},
    {"in the wall", {across(2.05, 1.85, 1.95, -0.5, 0.5)}},
    {"in the camera's room", {rectangle({0.5, 0.4, -0.9}, {0.9, 0, 0.4}, {0, 1, 0})}},
    {"by 60 degrees", {turned(60)}},
    {"by 90 degrees", {turned(90)}},
    {"by 150 degrees", {turned(150)}},
    {"the room's section", {across(1.2, 0, 2, -1, 1)}},
    {"reaching outside", {across(1.5, -6, 7, -7, 6)}},
    {"through the camera", {across(0.15, -1, 3, -2, 2)}},
    {"a millimetre", {across(2.05, 1, 1.001, 0, 0.001)}},
    {"a sliver", {across(2.05, 0.2, 1.8, 0, 0.0005)}},
    {"reversed", {reversed(in_the_window())}},
    {"both ways", {in_the_window(), reversed(in_the_window())}},
    {"in the wall's face", {across(2.1, 0, 2, -1, 1)}},
    {"through the floor", {rectangle({1, -1, -1}, {0.9, 0, 2}, {0.3, 2, 0})}},
    {"through the lamp", {rectangle({3.1, 1.5, -0.6}, {0, 0, 1.2}, {0.2, 1, 0})}},
    {"three times the same", {in_the_window(), in_the_window(), in_the_window()}},
    {"a fan of 48", {fan(48)}},
    {"crossing each other", {in_the_window(), turned(45), turned(-45)}},
    {"one behind another",
     {across(1.9, 0, 2, -1, 1), across(1.4, 0, 2, -1, 1), across(0.9, 0, 2, -1, 1)}}};

// One of each kind: half outside, through everything, a point, copies, crossings.
TEST_F(misplaced_portals, are_harmless) {
  for (const Case& c : kSets)
    for (const char* what : {"a tenth too narrow", "by 60 degrees", "reaching outside",
                             "a millimetre", "both ways", "one behind another"})
      if (c.what == std::string_view(what)) expect_harmless(what, c.portals);
  expect_harmless("copies, a fan", {in_the_window(), in_the_window(), fan(48)});
  // Light crosses the middle of the camera's room in both directions.
  expect_harmless("two for both ways",
                  for_both_ways({in_the_window(), across(0.8, 0.02, 1.98, -0.98, 0.98)}));
}
TEST_F(long_misplaced_portals, are_harmless) {
  for (const Case& c : kSets)
    for (const Integrator* integrator : {&tdpt_ref, &tdpt_org})
      expect_harmless(c.what, c.portals, *integrator);
}

// Guided walks differ from unguided ones, so these are compared with bdpt, unpaired.
TEST_F(long_misplaced_portals, directed_walks_are_harmless_too) {
  constexpr AgreementSettings kUnpaired{.max_depth = 6, .runs = 32, .spp = 8};
  const DepthRuns expected = render_runs(world_with({}), bdpt, kUnpaired.of_reference());
  const auto compared = [&](const char* what, const std::vector<Portal>& portals,
                            const Variant& variant) {
    const DepthRuns runs = render_runs(world_with(portals), variant, kUnpaired);
    EXPECT_EQ(runs.not_finite, 0u);
    return holds(judge(runs, expected), what, runs, expected);
  };
  for (const Case& c : kSets) EXPECT_TRUE(compared(c.what, c.portals, tdpt_guided));
  const Variant faulty{tdpt_guided, run_twice<Technique::portal>};
  EXPECT_FALSE(compared("twin, segments twice", {in_the_window()}, faulty));
}

// Less light crosses a portal across the room.
TEST_F(misplaced_portals, twin_a_density_that_is_off_is_caught) {
  for (const auto& [portal, factor] :
       {std::pair(in_the_window(), 1.1), std::pair(across(1.2, 0, 2, -1, 1), 1.2)}) {
    Vista vista = world_with({portal});
    vista.openings.portals = PortalSetFaults::scaled(vista.openings.portals, factor);
    EXPECT_TRUE(caught(vista));
  }
  // Most light goes to -x: along the normal of one, against that of the other.
  for (const Portal& portal : {in_the_window(), reversed(in_the_window())}) {
    Vista vista = world_with(for_both_ways({portal}));
    PortalSetFaults::scale_one_way(vista.openings.portals, -1, 1.1);
    EXPECT_TRUE(caught(vista));
  }
}

}  // namespace tdpt::misplaced_portals_test
