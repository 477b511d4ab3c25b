// Estimates of connections in columns, compared with connect() itself.
#include "tools/tdpt-render/path/sample/connect.h"

#include <gtest/gtest.h>

#include "libcommon/math/rng.h"
#include "tools/tdpt-render/testing/bsdfs.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::connection_estimates_test {

Vec3d direction(Rng& rng) {
  const double u = rng.uniform();
  const double v = rng.uniform();
  const Vec3d w = cosine_hemisphere(u, v);
  return rng.uniform() < 0.5 ? w : -w;
}
Vec3d place(Rng& rng) {
  const double x = rng.uniform();
  const double y = rng.uniform();
  const double z = rng.uniform();
  return {x, y, z};
}

// Surfaces at random places, seen from either side, with these kinds in turn; without kinds:
// simple.
class Surfaces {
 public:
  Surfaces(const std::vector<Bsdf>& kinds, size_t n) : vertices_(n) {
    Rng rng(5, kinds.size(), 0);
    for (size_t i = 0; i < n; ++i) {
      Vertex& v = vertices_[i];
      v.position = place(rng);
      v.normal = direction(rng);
      v.material = &material_;
      v.simple = kinds.empty();
      v.color = {0.8f, 0.5f, 0.2f};
      v.shading = normalize(v.normal * 4.0 + direction(rng));
      if (!v.simple) v.bsdf = kinds[i % kinds.size()];
      const Vec3d back = normalize(v.normal * (rng.uniform() < 0.5 ? 1.5 : -1.5) + direction(rng));
      ends_.emplace_back(v, back, Rgb(Vec3f(place(rng))));
    }
  }
  const std::vector<End>& ends() const { return ends_; }

 private:
  Material material_;
  std::vector<Vertex> vertices_;
  std::vector<End> ends_;
};

struct Compared {
  size_t pairs = 0, missed = 0;    // missed: a connection carries light, but the estimate is 0
  size_t other_bits = 0, far = 0;  // far: off by more than a factor of three
};

// Compares each end with all others; `fault`: factor of the columns' `facing`.
Compared compare(const Surfaces& surfaces, double fault = 1) {
  const Scene scene = read_gltf(two_rooms_path());
  const Vista vista(scene, scene.camera(""), 8, 8, {});
  const std::vector<End>& ends = surfaces.ends();
  const Rgb light(0.5f, 2.0f, 1.0f);
  Ends columns;
  for (End end : ends) {
    end.facing *= fault;
    columns.add(end);
    columns.set_light(columns.size() - 1, light);
  }
  std::vector<double> all(Ends::room(ends.size())), few(Ends::kLanes);
  Compared out;
  for (const End& c : ends) {
    columns.estimate(c, all.data());
    for (size_t i = 0; i < ends.size(); ++i) {
      if (&ends[i] == &c || !Ends::has(ends[i]) || !Ends::has(c)) continue;
      const double exact = luminance(connect(*vista.world, ends[i], c) * light), told = all[i];
      EXPECT_GE(told, 0);
      ++out.pairs;
      out.missed += exact > 0 && !(told > 0);
      out.other_bits += exact != told;
      out.far += exact > 0 && (told > 3 * exact || told < exact / 3);
    }
    std::array<int, Ends::kLanes> chosen{};
    for (size_t i = 0; i < chosen.size(); ++i)
      chosen[i] = static_cast<int>((7 * i + 3) % ends.size());
    columns.estimate(c, chosen, few.data());
    for (size_t i = 0; i < chosen.size(); ++i) {
      const double whole = all[static_cast<size_t>(chosen[i])];
      EXPECT_TRUE(few[i] == whole || (std::isnan(few[i]) && std::isnan(whole)));
    }
  }
  return out;
}

TEST(connections, between_simple_surfaces_are_estimated_to_the_bit) {
  const Compared c = compare(Surfaces({}, 77));
  EXPECT_EQ(c.pairs, 77u * 76);
  EXPECT_EQ(c.other_bits, 0u);
}

TEST(connections, of_glossy_surfaces_are_estimated_about_right_and_none_is_missed) {
  const Compared c = compare(Surfaces({test::plastic(0.3f), test::metal(0.2f), test::plastic(0.9f),
                                       test::metal(0.6f), test::make(Rgb(0.5f), {}, 0, {}, 1)},
                                      150));
  EXPECT_EQ(c.pairs, 150u * 149);
  EXPECT_EQ(c.missed, 0u);
  EXPECT_LT(c.far, c.pairs / 50);
}

TEST(connections, what_lets_light_through_has_no_estimate) {
  EXPECT_EQ(compare(Surfaces({test::glass(0.3f)}, 10)).pairs, 0u);
}

TEST(connections, twin_ends_that_face_the_other_side_miss_what_is_connected) {
  EXPECT_GT(compare(Surfaces({}, 77), -1).other_bits, 500u);
  EXPECT_GT(compare(Surfaces({test::plastic(0.3f)}, 77), -1).missed, 500u);
}

}  // namespace tdpt::connection_estimates_test
