// From where windows are seen: two rooms in a row with a hole between them, with the last one or
// both open at their ends, compared with lines traced from each point.
#include "tools/tdpt-render/path/light/window_sky.h"

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "tools/tdpt-render/path/sample/world.h"
#include "tools/tdpt-render/testing/known_windows.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/told.h"

namespace tdpt::window_views_test {

// Light goes to -x through the end and the hole, to +x through the beginning.
const Portal kEnd = rectangle({4.1, 0, -1}, {0, 0, 2}, {0, 2, 0});
const Portal kBeginning = rectangle({0, 0, -1}, {0, 2, 0}, {0, 0, 2});

struct House {
  Scene scene;
  Vista vista;
  explicit House(Scene s, const std::vector<Portal>& portals)
      : scene(std::move(s)), vista(scene, scene.camera(""), 4, 4, portals) {}
  void open(const std::vector<Portal>& portals) {
    vista.openings = Openings(*vista.world, portals, {}, vista.openings.windows);
  }

  // Whether a point [m] sees the window whose centre is that of `portal`.
  bool shows(const Portal& portal, const Vec3d& place) const {
    return vista.openings.windows.windows_in_view(scene.frame.to_canonical(place)) >>
               window(portal) &
           1u;
  }
  // Share of the window that the point sees.
  double share(const Portal& portal, const Vec3d& place, uint64_t seed) const {
    const Vec3d p = scene.frame.to_canonical(place);
    const auto corner = [&](int i) {
      return scene.frame.to_canonical(portal.vertices[static_cast<size_t>(i)]);
    };
    constexpr int kLines = 200;
    int seen = 0;
    for (int i = 0; i < kLines; ++i) {
      Rng rng(7, seed, static_cast<uint64_t>(i));
      const double u = rng.uniform(), v = rng.uniform();
      const Vec3d at = corner(0) + (corner(1) - corner(0)) * u + (corner(3) - corner(0)) * v;
      const Vec3d normal = cross(corner(1) - corner(0), corner(3) - corner(0));
      seen += dot(normal, p - at) > 0 && vista.world->tracer.visible({p}, {at});
    }
    return static_cast<double>(seen) / kLines;
  }

 private:
  size_t window(const Portal& portal) const {
    Vec3d centre;
    for (const Vec3d& corner : portal.vertices) centre += scene.frame.to_canonical(corner) * 0.25;
    const auto& all = vista.openings.windows.windows();
    for (size_t i = 0; i < all.size(); ++i)
      if (length(all[i].centre - centre) < 1e-6) return i;
    ADD_FAILURE() << "no such window";
    return 0;
  }
};

Scene open_at_the_end() {
  return under(open_end(read_gltf(two_rooms_path()), 4.09), one_colour_sky({1, 1, 1}));
}
Scene open_at_both_ends() {
  return without(open_at_the_end(), [](const Vec3d& p) { return p.x < 0.01; });
}

// The window's own room, and what sees it through the hole in the next.
TEST(window_views, are_from_where_lines_find_the_window) {
  const House house(open_at_the_end(), {kEnd});
  int seen = 0, missed = 0, unseen = 0, too_many = 0;
  for (uint64_t i = 0; i < 700; ++i) {
    Rng rng(8, 0, i);
    const double x = rng.uniform(), y = rng.uniform(), z = rng.uniform();
    const Vec3d p(0.05 + 4 * x, 0.05 + 1.9 * y, -0.95 + 1.9 * z);
    if (p.x > 1.95 && p.x < 2.15) continue;
    const double share = house.share(kEnd, p, i);
    const bool shown = house.shows(kEnd, p);
    if (p.x > 2) seen += share > 0.02, missed += share > 0.02 && !shown;
    unseen += share == 0;
    too_many += share == 0 && shown;
  }
  EXPECT_GT(seen, 250);
  EXPECT_EQ(missed, 0);
  EXPECT_GT(unseen, 60);
  EXPECT_LT(too_many, unseen / 4);  // besides those that see it
}

TEST(window_views, nothing_is_seen_from_outside) {
  const House house(open_at_both_ends(), {kEnd, kBeginning});
  for (const Portal* portal : {&kEnd, &kBeginning}) {
    EXPECT_TRUE(house.shows(*portal, portal == &kEnd ? Vec3d(3, 0.5, 0) : Vec3d(1, 0.5, 0)));
    // On the inner side of the plane of either window, on all sides of the house.
    for (const Vec3d& p : {Vec3d(-1, 1, 0), Vec3d(5.5, 1, 0), Vec3d(2, 3, 0), Vec3d(2, -1, 0.5),
                           Vec3d(1, 1, 4), Vec3d(3, 1, -4), Vec3d(1e9, 1, 1), Vec3d(-1e9, 0, 0)})
      EXPECT_FALSE(house.shows(*portal, p)) << p.x << " " << p.y << " " << p.z;
  }
  // So next events look everywhere there.
  for (const Vec3d& p : {Vec3d(1, 0, 0), Vec3d(3, 0, 0), Vec3d(-2, 0, 0), Vec3d(2, 2.5, 0)}) {
    Vertex v;
    v.position = house.scene.frame.to_canonical(p);
    v.normal = {0, 1, 0};
    v.material = &house.scene.materials[0];
    house.vista.next_events().look_out(v.normal, v);
    EXPECT_EQ(v.light_context.seen > 0, p.x > 0 && p.y < 2) << p.x;
  }
}

TEST(window_views, are_of_the_windows_that_there_are) {
  House house(open_at_both_ends(), {kEnd});
  const Vec3d place(3, 0.5, 0);
  EXPECT_TRUE(house.shows(kEnd, place));
  EXPECT_FALSE(house.shows(kEnd, {5.5, 1, 0}));
  house.open({kBeginning});
  EXPECT_TRUE(house.shows(kBeginning, {1, 0.5, 0}));
  EXPECT_FALSE(house.shows(kBeginning, {3, 1.9, 0.9}));  // the other room's corner
  house.open({kEnd});
  house.open({kEnd});  // the same again
  EXPECT_TRUE(house.shows(kEnd, place));
  EXPECT_FALSE(house.shows(kEnd, {5.5, 1, 0}));
}

// No light that comes straight in is lost: every point that sees a sliver of the sky through a
// window looks there. Testing for sky behind the window, line by line, left a gain of 2.8 instead
// of 26.
TEST(window_views, what_comes_straight_in_is_found_through_the_windows) {
  const RoomWithWindows room(testing::RoomKind::sky_windows, 2);
  const Vista vista(room.scene, room.scene.camera(""), 24, 18, room.windows);
  Integrator everywhere = nee;
  everywhere.mixture.through_windows = 0;
  const double with = error_of_pictures(vista, nee, 2);
  const double without = error_of_pictures(vista, everywhere, 2);
  std::printf("error without windows %g, with %g: %g times\n", without, with, without / with);
  EXPECT_GT(without, 10 * with);
}

}  // namespace tdpt::window_views_test
