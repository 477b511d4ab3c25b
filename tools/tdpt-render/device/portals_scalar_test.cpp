// Portals and guiding in floats against PortalSet and Guide in doubles, and their samples against
// their densities.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libcommon/math/rng.h"
#include "libcommon/scene/scene.h"
#include "libcommon/testing/statistics/chi_square.h"
#include "tools/tdpt-render/testing/rooms.h"
#include "tools/tdpt-render/testing/scalar_portals.h"

namespace tdpt::portals_scalar_test {

using shader::CrossingDensity;
using shader::Drawn;
using shader::drawn_otherwise;
using shader::FROM_CAMERA;
using shader::FROM_LIGHT;
using shader::ScalarPortals;
using shader::SegmentDraw;
using shader::vec3;

constexpr double kLevel = 1e-3;  // a correct program fails with this probability
constexpr double kWrong = 1e-9;  // a wrong one is below this

float number(Rng& rng) {
  return static_cast<float>(rng.bits() >> 40) * 0x1p-24f;
}
vec3 place(Rng& rng, double size = 1) {
  Vec3d p;
  for (int i = 0; i < 3; ++i) p[i] = size * (2 * rng.uniform() - 1);
  return vec3(p);
}
vec3 direction(Rng& rng) {
  return vec3(normalize(Vec3d(place(rng))));
}
SegmentDraw draw(const ScalarPortals& scalar, std::array<float, 7>& u, Rng& rng) {
  for (float& x : u) x = number(rng);
  return scalar.sample_segment(u[0], u[1], u[2], u[3], u[4], u[5], u[6]);
}
SegmentDraw draw(const ScalarPortals& scalar, Rng& rng) {
  std::array<float, 7> u;
  return draw(scalar, u, rng);
}
// An edge that is likely to cross a portal, or ends just before it.
std::pair<vec3, vec3> edge(const ScalarPortals& scalar, Rng& rng) {
  const SegmentDraw s = draw(scalar, rng);
  const vec3 aside = place(rng, 0.05);
  const auto t = [&] { return static_cast<float>(rng.uniform() * 1.2 - 0.2); };
  const vec3 a = s.position + aside - s.direction * t(), b = s.position + aside + s.direction * t();
  return {a, b};
}

std::vector<NamedPortals> all_portals() {
  std::vector<NamedPortals> all = portals_to_try();
  const Scene rooms = read_gltf(two_rooms_path());
  all.push_back({"rooms", PortalSet(two_crossing_portals(), rooms.frame)});
  return all;
}

struct Differences {
  double share = 0;  // of edges for which only one of the two counts some triangle
  double worst = 0;  // of the others, relative, over the rounding bound
  double crossed = 0;
};

// Rounding bound of a portal crossing: positions relative to a plane have an error of 18 e
// [portal_layout.h] at most, mostly 4; heights and cosines have that over their size, and the
// density goes as height^2 / cos^3, that of pairs as distance^2 / cos^2.
double explained(const PortalSet& set, const Vec3d& a, const Vec3d& b, bool pairs) {
  const Vec3d d = b - a;
  double worst = 0;
  for (uint32_t i = 0; i < set.facets(); ++i) {
    const PortalSet::PortalFacet& f = set.load_portal_facet(i);
    const double before = dot(f.normal, a - f.centre), after = dot(f.normal, b - f.centre);
    const double cos = dot(f.normal, d) / length(d);
    if (!(cos > 0) || (before > 0 || after < 0 ? -before / cos > 8 || after / cos < -8 : false))
      continue;
    worst = std::max(worst, 3 / cos + 2 / std::abs(before) + 2 / std::abs(after));
  }
  return 0x1p-24 * 8 * (1 + worst) * (pairs ? 4 : 1);
}

// `spoil` alters a density of the scalar build.
template <class Spoil>
Differences differences(const PortalSet& set, Spoil spoil) {
  constexpr int kEdges = 200000;
  const PortalTables tables(set);
  const ScalarPortals scalar(tables);
  Rng rng(31, 0, 0);
  Differences all;
  for (int i = 0; i < kEdges; ++i) {
    const auto [a, b] = edge(scalar, rng);
    const PortalSet::CrossingDensity c = set.portal_crossing(Vec3d(a), Vec3d(b), {});
    CrossingDensity mine = scalar.portal_crossing(a, b, drawn_otherwise());
    EXPECT_EQ(mine.density, scalar.portal_density(a, b, drawn_otherwise()));
    mine = spoil(mine);
    all.crossed += c.density > 0;
    const double may = explained(set, Vec3d(a), Vec3d(b), set.pairs() > 0);
    bool differs = false;
    const auto hold = [&](double theirs, double ours) {
      const double off = std::abs(ours - theirs) / std::max(theirs, 1e-30);
      if (off > 0.3)
        differs = true;
      else
        all.worst = std::max(all.worst, off / may);
    };
    hold(c.density, mine.density);
    hold(c.from_light, mine.from_light);
    hold(c.from_camera, mine.from_camera);
    all.share += differs;
  }
  all.share /= kEdges;
  all.crossed /= kEdges;
  return all;
}

TEST(portals_scalar, edges_have_the_crossings_that_they_have_in_doubles) {
  for (const auto& [name, set] : all_portals()) {
    const Differences d = differences(set, [](CrossingDensity c) { return c; });
    EXPECT_GT(d.crossed, 0.03) << name;
    // Borders have an error of some 1e-7, and margins of 2e-6, of edges a tenth to one long.
    EXPECT_LT(d.share, 1e-4) << name;
    EXPECT_LT(d.worst, 1) << name;
  }
}
TEST(portals_scalar, twin_densities_off_by_a_thousandth_are_seen) {
  const auto off = [](float CrossingDensity::*which) {
    return differences(portals_to_try()[1].set,
                       [&](CrossingDensity c) {
                         c.*which *= 1.001f;
                         return c;
                       })
        .worst;
  };
  EXPECT_GT(off(&CrossingDensity::density), 2);
  EXPECT_GT(off(&CrossingDensity::from_light), 2);
  EXPECT_GT(off(&CrossingDensity::from_camera), 2);
}

// Moved by the rounding error of a hit point.
vec3 jittered(const vec3& p, Rng& rng) {
  return p + place(rng, 4 * 0x1p-24);
}

struct Misses {
  int spanned = 0, segments = 0, undrawn = 0, aimed = 0, guide_totals = 0;
};
Misses misses(const PortalSet& set) {
  const PortalTables tables(set);
  const ScalarPortals scalar(tables);
  Rng rng(32, 0, 0);
  Misses m;
  for (int i = 0; i < 200000; ++i) {
    const SegmentDraw s = draw(scalar, rng);
    const vec3 begin = scalar.segment_start(s);
    const float before = 1.5f * number(rng), after = 1.5f * number(rng);
    const vec3 x_l = jittered(begin - s.direction * before, rng),
               x_c = jittered(begin + s.direction * after, rng);
    if (scalar.segment_spans(s.drawn, x_l, x_c)) {
      ++m.spanned;
      m.segments += !(scalar.portal_density(x_l, x_c, s.drawn) > 0);
      m.undrawn += !(scalar.portal_density(x_l, x_c, drawn_otherwise()) > 0);
    }
    const vec3 v = place(rng), facing = direction(rng);
    const float W = scalar.portal_guide_total(false, v, facing, FROM_CAMERA);
    if (!(W > 0)) continue;
    vec3 w;
    const float u = number(rng), u2 = number(rng), pick = number(rng);
    const int triangle = scalar.draw_towards_portal(v, facing, FROM_CAMERA, W, u, u2, pick, w);
    const float length = 0.1f + number(rng);
    const vec3 to = jittered(v + w * length, rng);
    // Skips edges that graze the plane so closely that rounding flips them.
    if (!(-dot(w, tables.facets[tables.polygons[static_cast<size_t>(triangle)].facet].normal) *
              length >
          1e-5f))
      continue;
    ++m.aimed;
    m.guide_totals +=
        !(scalar.portal_crossing(to, v, shader::drawn_through(triangle)).from_camera > 0);
  }
  return m;
}

TEST(portals_scalar, what_was_drawn_through_a_triangle_always_crosses_it) {
  for (const auto& [name, set] : all_portals()) {
    const Misses m = misses(set);
    EXPECT_GT(m.spanned, 100000) << name;
    EXPECT_GT(m.aimed, 30000) << name;
    EXPECT_EQ(m.segments, 0) << name;
    EXPECT_EQ(m.guide_totals, 0) << name;
    // Without the drawn polygon: the slit is narrow.
    if (name == "slit") {
      EXPECT_GT(m.undrawn, 0);
    }
  }
}

// Largest distance from a portal's plane of points on a wall in that plane, and least distance at
// which segments begin before it; both in margins.
struct Flush {
  double wall = 0, start = 1;
};
Flush flush() {
  Flush f;
  Rng rng(33, 0, 0);
  for (int i = 0; i < 3000; ++i) {
    const Onb<double> onb(normalize(Vec3d(place(rng))));
    const Vec3d middle(place(rng, 0.9));
    const double height = dot(onb.z, middle);
    // In the plane, mostly at distances as large as the scene.
    const auto in_plane = [&] {
      const Vec3d p(place(rng));
      return vec3(p - onb.z * (dot(onb.z, p) - height));
    };
    const PortalTables tables(PortalSet({plate(middle, onb.x * 0.1, onb.y * 0.05)}, Frame{}));
    const ScalarPortals scalar(tables);
    for (int k = 0; k < 30; ++k) {
      const vec3 a = in_plane(), e1 = in_plane() - a, e2 = in_plane() - a;
      const float b1 = number(rng), b2 = number(rng) * (1 - b1);
      f.wall = std::max(f.wall, std::abs(double{scalar.portal_height(scalar.load_portal_facet(0),
                                                                     a + e1 * b1 + e2 * b2)}));
      const SegmentDraw s = draw(scalar, rng);
      f.start = std::min(f.start, -double{scalar.portal_height(scalar.load_portal_facet(0),
                                                               scalar.segment_start(s))});
    }
  }
  f.wall /= shader::kPortalMargin;
  f.start /= shader::kPortalMargin;
  return f;
}
TEST(portals_scalar, what_lies_in_the_plane_of_a_portal_is_on_neither_side) {
  const Flush f = flush();
  EXPECT_LT(f.wall, 0.4);
  EXPECT_GT(f.start, 0.4);
  EXPECT_LT(f.start, 0.5001);
  EXPECT_GT(f.wall, 0.02);  // a margin of a fiftieth would be too small
}

TEST(portals_scalar, segments_are_those_of_the_same_numbers_in_doubles) {
  constexpr int kSegments = 100000;
  for (const auto& [name, set] : all_portals()) {
    const PortalTables tables(set);
    const ScalarPortals scalar(tables);
    Rng rng(34, 0, 0);
    int others = 0;
    double off = 0;
    for (int i = 0; i < kSegments; ++i) {
      std::array<float, 7> u;
      const SegmentDraw mine = draw(scalar, u, rng);
      const PortalSet::SegmentDraw s = set.sample({u[0], u[1], u[2], u[3], u[4], u[5], u[6]});
      EXPECT_EQ(mine.portal, set.polygon(mine.drawn.polygon).portal);
      if (s.drawn.polygon != mine.drawn.polygon || s.drawn.second != mine.drawn.second) {
        ++others;
        continue;
      }
      off = std::max({off, length(Vec3d(mine.position) - s.position),
                      length(Vec3d(mine.direction) - s.direction)});
    }
    EXPECT_LT(others, 5) << name;  // 1e-7 of them for every triangle and pair
    EXPECT_LT(off, 5e-6) << name;
  }
}

// Segments, each counted as 1 / D for every triangle that it crosses: the mean is pi A_q, whatever
// the mixture. Largest difference [standard errors]; `fault`: factor on D.
double worst_of_triangles(const PortalSet& set, double fault) {
  constexpr int kSamples = 60000;
  const PortalTables tables(set);
  const ScalarPortals scalar(tables);
  std::vector<double> sum(set.size() + 1), squares(set.size() + 1), expected(set.size() + 1);
  const auto add = [&](size_t k, double value) {
    sum[k] += value;
    squares[k] += value * value;
  };
  for (uint64_t i = 0; i < kSamples; ++i) {
    Rng rng(12, 0, i);
    const SegmentDraw s = draw(scalar, rng);
    const vec3 from = s.position - s.direction * 3.0f, to = s.position + s.direction * 3.0f;
    const double value = 1 / (fault * scalar.portal_density(from, to, s.drawn));
    const Vec3d d = Vec3d(to) - Vec3d(from);
    double all = 0;
    for (size_t k = 0; k < set.size(); ++k) {
      const PortalSet::Polygon& q = set.polygon(static_cast<int>(k));
      const double slope = dot(q.normal, d);
      const Vec3d at = Vec3d(from) + d * (dot(q.normal, q.p0 - Vec3d(from)) / slope);
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
    // With a single portal nothing varies.
    const double error = std::sqrt(std::max(squares[k] / kSamples - mean * mean, 0.0) / kSamples) +
                         1e-5 * expected[k];
    worst = std::max(worst, std::abs(mean - expected[k]) / error);
  }
  return worst;
}
TEST(portals_scalar, segments_follow_their_density) {
  for (const auto& [name, set] : all_portals()) EXPECT_LT(worst_of_triangles(set, 1), 4.5) << name;
}
TEST(portals_scalar, twin_a_density_of_segments_5_percent_off) {
  for (const auto& [name, set] : all_portals()) EXPECT_GT(worst_of_triangles(set, 1.05), 8) << name;
}

// Position in the square and cos^2 of segments through its triangles are uniform.
double uniform_p(double fault) {
  const PortalTables tables(
      PortalSet({plate({0.1, -0.2, 0.3}, {0.4, 0, 0}, {0, 0.4, 0})}, Frame{}));
  const ScalarPortals scalar(tables);
  Rng rng(35, 0, 0);
  std::vector<double> share(4 * 4 * 4, 1.0 / 64);
  share[9] *= fault;
  share[10] *= 2 - fault;
  const auto bin = [](double x) { return std::clamp(static_cast<int>(x * 4), 0, 3); };
  return chi_square_of_samples(200000, share,
                               [&](uint64_t) {
                                 SegmentDraw s = draw(scalar, rng);
                                 while (s.drawn.polygon == 2) s = draw(scalar, rng);
                                 const double x = (s.position.x + 0.3) / 0.8,
                                              y = (s.position.y + 0.6) / 0.8;
                                 const double c2 = double{s.direction.z} * s.direction.z;
                                 return static_cast<size_t>((bin(x) * 4 + bin(y)) * 4 + bin(c2));
                               })
      .p;
}
TEST(portals_scalar, segments_are_uniform_on_a_square_and_by_cosine) {
  EXPECT_GT(uniform_p(1), kLevel);
}
TEST(portals_scalar, twin_one_bin_that_has_a_fifth_more) {
  EXPECT_LT(uniform_p(1.2), kWrong);
}

// Bins of the sphere, obliquely oriented, by cosine and azimuth, and their integrals over a grid:
// borders cross many bins, where adaptive rules are accurate to a thousandth only. A grid cell gets
// about one sample.
class Sphere {
 public:
  size_t bin(const Vec3d& direction) const {
    const Vec3d w = onb_.to_local(direction);
    const double turns = std::atan2(w.y, w.x) / (2 * std::numbers::pi) + 0.5;
    const int ring = std::clamp(static_cast<int>((w.z + 1) / 2 * kRings), 0, kRings - 1);
    const int sector = std::clamp(static_cast<int>(turns * kSectors), 0, kSectors - 1);
    return static_cast<size_t>(ring * kSectors + sector);
  }
  template <class Density>
  std::vector<double> integrate(const Density& density) const {
    std::vector<double> sums(kRings * kSectors);
    constexpr int kRows = kRings * kFine, kColumns = kSectors * kFine;
    for (int i = 0; i < kRows; ++i)
      for (int j = 0; j < kColumns; ++j) {
        const double z = 2 * (i + 0.5) / kRows - 1, r = std::sqrt(1 - z * z);
        const double angle = 2 * std::numbers::pi * ((j + 0.5) / kColumns - 0.5);
        const Vec3d w = onb_.to_world({r * std::cos(angle), r * std::sin(angle), z});
        sums[static_cast<size_t>(i / kFine * kSectors + j / kFine)] +=
            density(w) * 4 * std::numbers::pi / (kRows * kColumns);
      }
    return sums;
  }

 private:
  static constexpr int kRings = 12, kSectors = 20, kFine = 120;
  Onb<double> onb_{normalize(Vec3d(0.31, -0.52, 0.83))};
};

// Guided directions from v against a(w), by chi-square over bins of the sphere.
double aims_p(const PortalSet& set, const Vec3d& at, const vec3& facing, uint32_t from,
              double fault, uint64_t stream) {
  const PortalTables tables(set);
  const ScalarPortals scalar(tables);
  const vec3 v(at);
  const float W = scalar.portal_guide_total(false, v, facing, from);
  EXPECT_GT(W, 0);
  const auto pdf_w = [&](const Vec3d& w) {
    const vec3 to = v + vec3(w) * 2.0f;
    const CrossingDensity c = from == FROM_LIGHT ? scalar.portal_crossing(v, to, drawn_otherwise())
                                                 : scalar.portal_crossing(to, v, drawn_otherwise());
    return fault * (from == FROM_LIGHT ? c.from_light : c.from_camera) / W;
  };
  Rng rng(36, stream, 0);
  const Sphere bins;
  return chi_square_of_samples(50000, bins.integrate(pdf_w),
                               [&](uint64_t) {
                                 const float u = number(rng), u2 = number(rng), pick = number(rng);
                                 vec3 w;
                                 scalar.draw_towards_portal(v, facing, from, W, u, u2, pick, w);
                                 return bins.bin(Vec3d(w));
                               })
      .p;
}
struct Aim {
  size_t portals;
  Vec3d v;
  uint32_t from;
};
const std::vector<Aim> kAims{
    {0, {-0.3, 0.2, 0.9}, FROM_LIGHT},  {0, {0.3, 0.2, -0.5}, FROM_CAMERA},
    {1, {0.1, 0.5, -0.3}, FROM_LIGHT},  {1, {0.1, -0.3, 0.8}, FROM_CAMERA},
    {3, {0.1, 0.05, -0.8}, FROM_LIGHT}, {3, {0.1, 0.05, 0.1}, FROM_CAMERA}};
TEST(portals_scalar, walks_are_aimed_as_their_density_says) {
  const std::vector<NamedPortals> all = portals_to_try();
  for (size_t i = 0; i < kAims.size(); ++i)
    EXPECT_GT(aims_p(all[kAims[i].portals].set, kAims[i].v, vec3(0.0f), kAims[i].from, 1, i),
              sidak(kLevel, kAims.size()))
        << i;
}
TEST(portals_scalar, twin_a_density_of_aiming_5_percent_off) {
  const std::vector<NamedPortals> all = portals_to_try();
  for (size_t i = 0; i < kAims.size(); ++i)
    EXPECT_LT(aims_p(all[kAims[i].portals].set, kAims[i].v, vec3(0.0f), kAims[i].from, 0.95, i),
              kWrong)
        << i;
}

// Rays of parallel light, by where they pass a plane perpendicular to them.
double lines_p(double fault) {
  const PortalSet set = portals_to_try()[1].set;
  const PortalTables tables(set);
  const ScalarPortals scalar(tables);
  const vec3 d(normalize(Vec3d(0.2, -0.3, 1)));
  const Onb<double> onb{Vec3d(d)};
  const float W = scalar.portal_guide_total(true, d, vec3(0.0f), FROM_LIGHT);
  constexpr int kSide = 16, kFine = 96;
  const auto index = [](double x) {
    return std::clamp(static_cast<int>((x + 1) * 0.5 * kSide), 0, kSide - 1);
  };
  std::vector<double> share(kSide * kSide);
  const double cell = 2.0 / (kSide * kFine);
  for (int i = 0; i < kSide * kFine; ++i)
    for (int j = 0; j < kSide * kFine; ++j) {
      const double x = (i + 0.5) * cell - 1, y = (j + 0.5) * cell - 1;
      const vec3 to(onb.x * x + onb.y * y + onb.z * 0.4);
      share[static_cast<size_t>(index(x) * kSide + index(y))] +=
          cell * cell * scalar.coverage_along(d, to, drawn_otherwise()) / W;
    }
  double total = 0;
  for (double s : share) total += s;
  EXPECT_NEAR(total, 1, 1e-3);
  for (double& s : share) s = s * fault + (1 - fault) / static_cast<double>(share.size());
  Rng rng(37, 0, 0);
  return chi_square_of_samples(150000, share,
                               [&](uint64_t) {
                                 const float u = number(rng), v = number(rng), pick = number(rng);
                                 vec3 at;
                                 scalar.draw_on_portal(true, d, vec3(0.0f), FROM_LIGHT, W, u, v,
                                                       pick, at);
                                 return static_cast<size_t>(index(dot(onb.x, Vec3d(at))) * kSide +
                                                            index(dot(onb.y, Vec3d(at))));
                               })
      .p;
}
TEST(portals_scalar, lines_of_parallel_light_follow_their_density) {
  EXPECT_GT(lines_p(1), kLevel);
}
TEST(portals_scalar, twin_lines_less_directed_than_their_density_says) {
  EXPECT_LT(lines_p(0.95), kWrong);
}

TEST(portals_scalar, walks_are_aimed_as_the_same_numbers_aim_them_in_doubles) {
  for (const auto& [name, set] : all_portals()) {
    const PortalSet& doubles = set;
    const PortalTables tables(set);
    const ScalarPortals scalar(tables);
    double area = 0;
    for (const shader::PortalFacet& f : tables.facets) area += f.area;
    Rng rng(38, 0, 0);
    int n = 0, others = 0;
    for (int i = 0; i < 100000; ++i) {
      const vec3 v = place(rng), facing = i % 4 == 0 ? vec3() : direction(rng), d = direction(rng);
      const uint32_t from = i % 2 == 0 ? FROM_LIGHT : FROM_CAMERA;
      const float u = number(rng), u2 = number(rng), pick = number(rng);
      const double W = doubles.portal_guide_total(false, Vec3d(v), Vec3d(facing), from);
      const float mine = scalar.portal_guide_total(false, v, facing, from);
      if (W > 0 && mine > 0 && std::abs(mine / W - 1) < 1e-5) {
        ++n;
        Vec3d w;
        vec3 my_w;
        const int triangle =
            doubles.draw_towards_portal(Vec3d(v), Vec3d(facing), from, W, u, u2, pick, w);
        others +=
            triangle != scalar.draw_towards_portal(v, facing, from, mine, u, u2, pick, my_w) ||
            length(w - Vec3d(my_w)) > 2e-5;
      } else {
        others += W > 0 || mine > 0;
      }
      const double along = set.portal_guide_total(true, Vec3d(d), Vec3d(), FROM_LIGHT),
                   mine_along = scalar.portal_guide_total(true, d, vec3(0.0f), FROM_LIGHT);
      // At a cosine of 0.01 five digits remain; some facets are left out edge-on.
      EXPECT_NEAR(mine_along, along, 1e-5 * along + shader::kPortalEdgeOn * area);
      Vec3d at;
      vec3 my_at;
      if (along < 0.01) continue;
      const int triangle =
          doubles.draw_on_portal(true, Vec3d(d), Vec3d(), FROM_LIGHT, along, u, u2, pick, at);
      others += triangle != scalar.draw_on_portal(
                                true, d, vec3(0.0f), FROM_LIGHT,
                                scalar.portal_guide_total(true, d, vec3(0.0f), FROM_LIGHT), u, u2,
                                pick, my_at) ||
                length(at - Vec3d(my_at)) > 1e-6;
    }
    EXPECT_GT(n, 20000) << name;
    EXPECT_LT(others, 30) << name;  // some 1e-5 on borders between triangles and facets
  }
}

// Nothing exceeds the range of floats: ends in the plane, coincident, grazing, far away.
TEST(portals_scalar, extremes_are_finite) {
  for (const auto& [name, set] : all_portals()) {
    const PortalTables tables(set);
    const ScalarPortals scalar(tables);
    Rng rng(39, 0, 0);
    for (int i = 0; i < 200000; ++i) {
      const SegmentDraw s = draw(scalar, rng);
      const vec3 normal =
          tables.facets[tables.polygons[static_cast<size_t>(s.drawn.polygon)].facet].normal;
      const vec3 along = vec3(normalize(cross(Vec3d(normal), Vec3d(direction(rng)))));
      const auto some = [&] {
        return static_cast<float>(std::exp2(-30 * rng.uniform()) * (rng.uniform() < 0.5 ? -1 : 1));
      };
      const vec3 a = s.position + normal * some() + along * some();
      const vec3 b = i % 10 == 0 ? a : s.position + normal * some() + along * some();
      const CrossingDensity c =
          scalar.portal_crossing(a, b, i % 2 == 0 ? s.drawn : drawn_otherwise());
      const float W = scalar.portal_guide_total(false, a, vec3(0.0f), FROM_LIGHT);
      for (const float x : {c.density, c.from_light, c.from_camera, W})
        EXPECT_TRUE(x >= 0 && x < 1e30f) << name << " " << x;
      if (!(W > 0)) continue;
      vec3 w;
      scalar.draw_towards_portal(a, vec3(0.0f), FROM_LIGHT, W, 0.0f, 0.9999999f,
                                 i % 3 == 0 ? 0.0f : 0.9999999f, w);
      EXPECT_NEAR(length(Vec3d(w)), 1, 1e-6);
    }
  }
}

}  // namespace tdpt::portals_scalar_test
