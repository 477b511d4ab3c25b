#include "tools/tdpt-render/portals/portals.h"

#include <algorithm>
#include <numbers>

#include <gtest/gtest.h>

namespace tdpt::portals_test {

// Unit square in the plane z = 0 with normal +z.
Portal square() {
  return {"a", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}, {}};
}
const Frame kMetres{};
// C of a rectangle within it, and beside it in its surround.
const double kShare = shader::kSurroundShare, kLarger = 1 + 2 * double{shader::kSurroundMargin};
const double kBeside = kShare / (kLarger * kLarger), kWithin = 1 - kShare + kBeside;

TEST(portals, one_behind_the_other_has_segments_drawn_through_both) {
  Portal above = square();
  for (Vec3d& v : above.vertices) v.z += 0.5;
  const PortalSet set({square(), above}, kMetres);
  EXPECT_EQ(set.pairs(), 1u);
  // Three quarters of two portals, and a quarter of a pair half a metre apart.
  EXPECT_DOUBLE_EQ(set.density({0.3, 0.2, -1}, {0.3, 0.2, 1}),
                   0.75 * kWithin / std::numbers::pi + 0.25 * kWithin * kWithin * 0.5 * 0.5);
  EXPECT_DOUBLE_EQ(set.density({0.3, 0.2, -1}, {0.3, 0.2, 0.2}),
                   0.75 * kWithin / (2 * std::numbers::pi));
  // At an angle of 45 degrees: d^2 = 0.5, cosines 1 / sqrt 2.
  EXPECT_NEAR(set.density({-0.7, 0.2, -1}, {1.3, 0.2, 1}),
              0.75 * kWithin / std::numbers::pi + 0.25 * kWithin * kWithin * 0.5 / 0.5, 1e-12);
  // A segment drawn through both and stopped in between does not span the pair.
  EXPECT_TRUE(set.segment_spans({0, 3}, {0.3, 0.2, -1}, {0.3, 0.2, 1}));
  EXPECT_FALSE(set.segment_spans({0, 3}, {0.3, 0.2, -1}, {0.3, 0.2, 0.2}));
  EXPECT_FALSE(set.segment_spans({0, 3}, {0.3, 0.2, 0.1}, {0.3, 0.2, 1}));
  EXPECT_TRUE(set.segment_spans({0, -1}, {0.3, 0.2, -1}, {0.3, 0.2, 0.2}));
}

// Whatever the outline, its surround is a rectangle that holds all corners with a tenth of a side
// to spare, and the smallest of a side along one of the outline's.
TEST(portals, the_surround_is_a_rectangle_a_tenth_larger_on_all_sides) {
  const Onb<double> onb(normalize(Vec3d(0.3, 0.8, -0.5)));
  Portal bent = square();  // an L, and a triangle far from it
  bent.vertices = {{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}, {4, 2, 0}};
  bent.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {1, 6, 2}};
  for (Vec3d& v : bent.vertices) v = onb.to_world(v);
  const PortalSet set({bent}, kMetres);
  const PortalSet::Polygon& r = set.polygon(5);
  ASSERT_TRUE(r.surround && set.size() == 6);
  EXPECT_NEAR(dot(r.e1, r.e2), 0, 1e-12);
  EXPECT_NEAR(r.area, 4 * 2 * kLarger * kLarger, 1e-12);
  for (const Vec3d& v : bent.vertices) {
    const double b1 = dot(r.grad1, v - r.p0), b2 = dot(r.grad2, v - r.p0);
    EXPECT_GT(std::min(b1, b2), shader::kSurroundMargin / kLarger - 1e-12);
    EXPECT_LT(std::max(b1, b2), 1 - shader::kSurroundMargin / kLarger + 1e-12);
  }
}

TEST(portals, the_sampled_polygon_is_always_counted) {
  const PortalSet set({square()}, kMetres);
  EXPECT_DOUBLE_EQ(set.density({1.0000001, 0.2, -1}, {1.0000001, 0.2, 1}, {0, -1}),
                   kWithin / std::numbers::pi);
  EXPECT_DOUBLE_EQ(set.density({1.1000001, 0.2, -1}, {1.1000001, 0.2, 1}, {2, -1}),
                   kBeside / std::numbers::pi);
  // One drawn in the surround may cross the border of two triangles anywhere.
  EXPECT_DOUBLE_EQ(set.density({0.50001, 0.5, -1}, {0.50001, 0.5, 1}, {2, -1}),
                   kWithin / std::numbers::pi);
}

TEST(portals, a_segment_that_ends_in_the_portals_plane_has_no_density) {
  const PortalSet set({square()}, kMetres);
  EXPECT_EQ(set.density({0.3, 0.2, -1}, {0.3, 0.2, 1e-7}, {0, -1}), 0);
  EXPECT_EQ(set.density({0.3, 0.2, -1e-7}, {0.3, 0.2, 1}, {0, -1}), 0);
  EXPECT_GT(set.density({0.3, 0.2, -1e-5}, {0.3, 0.2, 1}, {0, -1}), 0);
}

// A slit of 3 cm x 2 m at `distance` m from the origin, tilted, of `strips` strips one after the
// other. Vertices are single-precision.
Portal slit(double distance, int strips) {
  const Vec3d middle = Vec3d(1, -0.4, 0.3) * (distance / std::sqrt(1.25));
  const Onb<double> onb(normalize(Vec3d(0.3, 0.8, -0.5)));
  Portal p{"slit", {}, {}, {}};
  for (int i = 0; i <= strips; ++i) {
    const double along = 2.0 * i / strips - 1;
    for (const double across : {-0.015, 0.015})
      p.vertices.push_back(Vec3d(Vec3f(middle + onb.to_world({across, along, 0}))));
  }
  for (uint32_t i = 0; i < static_cast<uint32_t>(strips); ++i) {
    p.triangles.push_back({2 * i, 2 * i + 1, 2 * i + 3});
    p.triangles.push_back({2 * i, 2 * i + 3, 2 * i + 2});
  }
  return p;
}

TEST(portals, a_polygon_of_single_precision_vertices_is_one_facet) {
  for (const double distance : {5.0, 50.0})
    for (const int strips : {1, 2, 8}) {
      Portal portal = slit(distance, strips);
      Frame frame;
      frame.centre = {2, -1, 0.5};
      frame.scale = 0.125;
      const PortalSet set({portal}, frame);
      EXPECT_EQ(set.facets(), 1u) << distance << " m, strips " << strips;
      // Now all of it lies in one plane, and neighbours still share their corners.
      const PortalSet::Polygon& first = set.polygon(0);
      for (int i = 0; i < static_cast<int>(set.size()); ++i) {
        const PortalSet::Polygon& q = set.polygon(i);
        EXPECT_EQ(length(q.normal - first.normal), 0);
        for (const Vec3d& corner : {q.p0, q.p0 + q.e1, q.p0 + q.e2})
          EXPECT_NEAR(dot(first.normal, corner - first.p0), 0, 1e-15);
      }
      EXPECT_LT(
          length(set.polygon(0).p0 + set.polygon(0).e2 - (set.polygon(1).p0 + set.polygon(1).e1)),
          1e-15);
      const double area = 0.06 * frame.scale * frame.scale;
      const Vec3d through = first.p0 + (first.e1 + first.e2) / 3;
      EXPECT_NEAR(set.density(through - first.normal, through + first.normal),
                  kWithin / (area * std::numbers::pi), 1e-3 / area);
      // In any order.
      std::rotate(portal.triangles.begin(), portal.triangles.begin() + 1, portal.triangles.end());
      for (size_t i = 0; i + 3 < portal.triangles.size(); i += 2)
        std::swap(portal.triangles[i], portal.triangles[portal.triangles.size() - 1 - i]);
      EXPECT_EQ(PortalSet({portal}, frame).facets(), 1u);
    }
}

TEST(portals, a_portal_lies_in_the_mean_plane_of_its_triangles_and_faces_as_most_of_them) {
  Portal p = square();
  p.vertices[2].z = 0.3;
  const FlatPortal flat = flattened(p, kMetres);
  EXPECT_NEAR(flat.off, 0.3 / 3, 0.01);
  EXPECT_NEAR(flat.width, std::sqrt(2), 0.1);
  for (const Corners& t : flat.triangles)
    for (const Vec3d& corner : t)
      EXPECT_NEAR(dot(flat.normal, corner - flat.triangles[0][0]), 0, 1e-15);
  p = square();
  p.vertices.push_back({0.5, 0.5, 0});
  p.triangles = {{0, 1, 4}, {1, 4, 2}, {2, 3, 4}, {3, 0, 4}};  // the second faces back
  EXPECT_EQ(flattened(p, kMetres).normal, Vec3d(0, 0, 1));
  EXPECT_DOUBLE_EQ(PortalSet({p}, kMetres).density({0.9, 0.5, -1}, {0.9, 0.5, 1}),
                   kWithin / std::numbers::pi);
  for (auto& t : p.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(flattened(p, kMetres).normal, Vec3d(0, 0, -1));
  EXPECT_TRUE(flattened({"none", {}, {}, {}}, kMetres).triangles.empty());
}

// Two layers of small squares; light crosses the lower before the upper.
std::vector<Portal> layers(int of_each) {
  std::vector<Portal> portals;
  for (int i = 0; i < 2 * of_each; ++i) {
    Portal p = square();
    const int place = i / 2;
    for (Vec3d& v : p.vertices)
      v = Vec3d(v.x * 0.2 + 0.3 * (place % 5), v.y * 0.1 + 0.2 * (place / 5), i % 2);
    portals.push_back(p);
  }
  return portals;
}

// Samples of `set`, each counted 1 / D for every triangle it crosses: their mean is pi A_q,
// whatever the mixture. Largest deviation for one triangle or for all together [standard errors];
// `fault`: factor of D.
double worst_of_triangles(const PortalSet& set, double fault) {
  constexpr int kSamples = 60000;
  std::vector<double> sum(set.size() + 1), squares(set.size() + 1), expected(set.size() + 1);
  const auto add = [&](size_t k, double value) {
    sum[k] += value;
    squares[k] += value * value;
  };
  for (uint64_t i = 0; i < kSamples; ++i) {
    Rng rng(12, 0, i);
    const PortalSet::SegmentDraw s = set.sample(rng);
    const Vec3d from = s.position - s.direction * 50, to = s.position + s.direction * 50;
    const double value = 1 / (fault * set.density(from, to, s.drawn));
    double all = 0;
    for (size_t k = 0; k < set.size(); ++k) {
      const PortalSet::Polygon& q = set.polygon(static_cast<int>(k));
      const double slope = dot(q.normal, to - from);
      const Vec3d at = from + (to - from) * (dot(q.normal, q.p0 - from) / slope);
      if (!(slope > 0) || !set.holds(q, at)) continue;
      if (!q.surround) add(k, value);  // few samples are beside one portal
      all += value;
    }
    add(set.size(), all);
  }
  for (size_t k = 0; k < set.size(); ++k) {
    const PortalSet::Polygon& q = set.polygon(static_cast<int>(k));
    expected[k] = q.area * std::numbers::pi;
    expected.back() += expected[k];
  }
  double worst = 0;
  for (size_t k = 0; k < expected.size(); ++k) {
    if (!(sum[k] > 0)) continue;
    const double mean = sum[k] / kSamples;
    const double error = std::sqrt((squares[k] / kSamples - mean * mean) / kSamples);
    worst = std::max(worst, std::abs(mean - expected[k]) / error);
  }
  return worst;
}

TEST(portals, of_many_portals_the_strongest_pairs_are_drawn) {
  const PortalSet twenty(layers(10), kMetres);
  EXPECT_EQ(twenty.pairs(), 100u);
  const PortalSet sixty(layers(30), kMetres);  // 900 pairs
  EXPECT_EQ(sixty.pairs(), PortalSet::kMostPairs);
  for (const PortalSet* set : {&twenty, &sixty}) {
    uint64_t paired = 0;
    Rng rng(13, 0, 0);
    for (int i = 0; i < 4000; ++i) paired += set->sample(rng).drawn.second >= 0;
    EXPECT_NEAR(static_cast<double>(paired), 1000, 120);
    EXPECT_LT(worst_of_triangles(*set, 1), 4.5);
    EXPECT_GT(worst_of_triangles(*set, 1.05), 8);
  }
  // The pairs straight above each other are the strongest and are kept.
  const auto pairs_of = [&](const Vec3d& from, const Vec3d& to) {
    return sixty.density(from, to) - 2 * kWithin / (1 - kShare) * sixty.polygon(0).density > 1e-6;
  };
  for (int place = 0; place < 30; ++place) {
    const Vec3d at(0.1 + 0.3 * (place % 5), 0.04 + 0.2 * (place / 5), 0);
    EXPECT_TRUE(pairs_of(at - Vec3d(0, 0, 1), at + Vec3d(0, 0, 2))) << place;
  }
  // From one corner to the opposite one there is no pair.
  const Vec3d low(0.1, 0.04, 0), high(1.3, 1.04, 1);
  EXPECT_GT(sixty.density(low - (high - low), high + (high - low)), 0);
  EXPECT_FALSE(pairs_of(low - (high - low), high + (high - low)));
}

TEST(portals, degenerate_triangles_are_dropped_and_no_portal_is_empty) {
  const Portal line{"l", {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}, {}};
  EXPECT_TRUE(PortalSet({line}, kMetres).empty());
  EXPECT_TRUE(PortalSet({}, kMetres).empty());
}

}  // namespace tdpt::portals_test
