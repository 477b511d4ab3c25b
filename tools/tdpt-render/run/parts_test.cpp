// Pictures rendered in parts: merged, they are byte-identical to the undivided one.
#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include "libcommon/film/film.h"
#include "tools/tdpt-render/testing/rendering.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::parts_test {

class parts : public ::testing::Test {
 protected:
  Film part(const SampleRange& samples, uint64_t step) {
    Film::Options options;
    options.layers = {"camera", "direct", "light", "bi", "portal"};
    options.halves = true;
    Film film(vista_.view.film.width(), vista_.view.film.height(), vista_.world->lights.power(),
              options);
    Tally tally(film.unit());
    ProgressBar progress("", "", 0, true);
    for (uint64_t s = samples.first; s < samples.end(); s += step)
      CpuRenderer(vista_).render(integrator_, {}, 0, {s, step}, film, tally, progress);
    energy_ = tally.energy[static_cast<size_t>(Technique::portal)];
    return film;
  }
  static void expect_same(const Film& a, const Film& b) {
    EXPECT_EQ(a.sums(), b.sums());
    EXPECT_EQ(a.ranges(), b.ranges());
    for (const uint64_t half : {0, 1}) EXPECT_EQ(a.half(half).pixels, b.half(half).pixels);
    EXPECT_EQ(a.variance(), b.variance());
    for (size_t layer = 0; layer < kTechniques; ++layer)
      EXPECT_EQ(a.layer_sums(layer), b.layer_sums(layer));
  }

  const Scene scene_ = read_gltf(two_rooms_path());
  const Vista vista_{scene_, scene_.camera(""), 24, 18, {portal_in_the_hole()}};
  const Integrator integrator_{tdpt_org.name, tdpt_org.stream,
                               expecting_connections(vista_, tdpt_org.mixture, kMaxDepth)};
  double energy_ = 0;
};

TEST_F(parts, have_the_bytes_of_the_undivided_picture_whatever_the_split_and_the_threads) {
  const Film whole = part({0, 16}, 4);
  const double energy = energy_;
  for (size_t threads : {1, 3}) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    // Merged as a tree, out of order.
    Film left = part({7, 9}, 3);
    double sum = energy_;
    Film right = part({3, 4}, 4);
    sum += energy_;
    right.merge(part({0, 3}, 3));
    sum += energy_;
    left.merge(right);
    expect_same(left, whole);
    EXPECT_NEAR(sum / energy, 1, 1e-14);
  }
  expect_same(part({0, 16}, 1), part({0, 16}, 16));
  // Twin: other samples make another picture.
  EXPECT_NE(part({0, 4}, 4).sums(), part({4, 4}, 4).sums());
}

TEST_F(parts, are_what_render_makes_of_the_plan) {
  Job settings;
  settings.limits.spp = 6;
  const RenderResult whole = render(vista_, tdpt_org, settings);
  Film film = part({0, 3}, 3);
  film.merge(part({3, 3}, 1));
  EXPECT_EQ(scaled_picture(24, 18, film.sums(), 1.0 / 6).pixels, whole.picture.pixels);
  EXPECT_EQ(whole.plan.spp, 6u);
  EXPECT_EQ(whole.plan.integrator.mixture, integrator_.mixture);
}

}  // namespace tdpt::parts_test
