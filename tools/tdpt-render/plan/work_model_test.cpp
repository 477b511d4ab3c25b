#include "tools/tdpt-render/plan/work_model.h"

#include <gtest/gtest.h>

#include "tools/tdpt-render/integrators/integrator.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::work_model_test {

constexpr uint64_t kSamples = 100;
constexpr RayCounts kRays{1000, 500, 2000, 300};

class WorkModelTest : public ::testing::Test {
 protected:
  double of(const std::vector<Portal>& portals, const Integrator& integrator,
            const RayCounts& rays = kRays, bool on_device = false) const {
    const Vista vista(scene_, scene_.camera(""), 8, 6, portals);
    const Mixture& m = integrator.mixture;
    return sample_work(vista, m, work_costs(vista, m, on_device), rays, kSamples);
  }
  const Scene scene_ = read_gltf(two_rooms_path());
  const std::vector<Portal> one_{portal_in_the_hole()}, two_ = two_crossing_portals();
};

TEST_F(WorkModelTest, more_for_edges_of_directed_walks_and_more_again_with_facets_to_choose_among) {
  const WorkCosts& c = kWorkWithPortals;
  EXPECT_NEAR(of(one_, tdpt_guided) - of(one_, tdpt_org), 20 * c.directed, 1e-9);
  EXPECT_NEAR(of(two_, tdpt_guided) - of(two_, tdpt_org),
              20 * (c.directed + c.facets + 2 * c.facet), 1e-9);
  EXPECT_NEAR(of(two_, tdpt_org) - of(one_, tdpt_org), 20 * 2 * c.portal_triangle, 1e-9);
}

TEST_F(WorkModelTest, of_what_has_no_use_for_portals_has_a_table_of_its_own) {
  const WorkCosts& c = kWorkWithoutPortals;
  const RayCounts none{};
  EXPECT_EQ(of(one_, bdpt, none), c.sample);
  EXPECT_NEAR(of(one_, bdpt, {0, kSamples, 0}), c.sample + c.shadow, 1e-9);
  EXPECT_EQ(of({}, tdpt_guided), of({}, bdpt));
  EXPECT_EQ(of(two_, bdpt), of({}, bdpt));
  // A device has tables of its own.
  EXPECT_EQ(of(one_, bdpt, {0, kSamples, 0}, true), kDeviceWorkWithoutPortals.shadow);
  EXPECT_EQ(of(one_, tdpt_guided, {0, kSamples, 0}, true), kDeviceWorkWithPortals.shadow);
}

// work_model_bench gets each term of the model this way.
TEST_F(WorkModelTest, is_linear_in_its_table) {
  const Vista vista(scene_, scene_.camera(""), 8, 6, two_);
  const auto cost = [&](const WorkCosts& c) {
    return sample_work(vista, tdpt_guided.mixture, c, kRays, kSamples);
  };
  EXPECT_EQ(cost({}), 0);
  EXPECT_NEAR(cost({.sample = 3}) + cost({.closest = 7}) + cost({.facet = 5}),
              cost({.sample = 3, .closest = 7, .facet = 5}), 1e-9);
  EXPECT_NEAR(cost({.closest = 1}), 10, 1e-12);
  EXPECT_NEAR(cost({.facet = 1}), 40, 1e-12);
  EXPECT_NEAR(cost({.connect = 1}), 3, 1e-12);
}

}  // namespace tdpt::work_model_test
