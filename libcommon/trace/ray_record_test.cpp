#include "libcommon/testing/ray_record.h"

#include <thread>

#include <gtest/gtest.h>

#include "libcommon/testing/scenes/meshes.h"
#include "libcommon/trace/tracer.h"

namespace tdpt::testing::ray_record_test {

// Traces first-hit and visibility rays alternately; so many of each.
constexpr uint64_t kOfEach = 500;
void cast_some(const Tracer& tracer, uint64_t stream) {
  Rng rng(3, stream, 0);
  for (uint64_t i = 0; i < kOfEach; ++i) {
    const Vec3d from = random_place(rng, 1), to = random_place(rng, 1);
    Hit hit;
    tracer.closest({from}, random_direction(rng), hit);
    tracer.visible({from}, {to});
  }
}

TEST(ray_record, keeps_what_is_cast_between_begin_and_end) {
  const Scene scene = soup(200, 0.3);
  const Tracer tracer(scene);
  cast_some(tracer, 0);
  ray_record::begin();
  EXPECT_EQ(ray_record::rays(), 0u);
  cast_some(tracer, 0);
  ray_record::end();
  cast_some(tracer, 1);
  EXPECT_EQ(ray_record::rays(), 2 * kOfEach);
  EXPECT_EQ(ray_record::threads(), 1u);
  ray_record::begin();
  ray_record::end();
  EXPECT_EQ(ray_record::rays(), 0u);
}

TEST(ray_record, rays_cast_again_meet_what_they_met) {
  const Scene scene = soup(200, 0.3);
  const Tracer tracer(scene);
  ray_record::begin();
  std::thread other([&] { cast_some(tracer, 1); });
  cast_some(tracer, 2);
  other.join();
  ray_record::end();
  EXPECT_EQ(ray_record::rays(), 4 * kOfEach);
  EXPECT_EQ(ray_record::threads(), 2u);
  EXPECT_EQ(ray_record::cast_again(), 0u);
  EXPECT_EQ(ray_record::rays(), 4 * kOfEach);  // replayed rays are not recorded
}

// Rays of another scene after the record end differently.
TEST(ray_record, twin_rays_of_two_scenes_are_told) {
  const Scene first = soup(200, 0.3), second = soup(10, 0.3);
  const Tracer tracer(first), another(second);
  ray_record::begin();
  cast_some(tracer, 1);
  cast_some(another, 1);
  ray_record::end();
  EXPECT_GT(ray_record::cast_again(), 100u);
}

}  // namespace tdpt::testing::ray_record_test
