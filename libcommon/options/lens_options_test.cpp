#include "libcommon/options/lens_options.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace tdpt::testing::lens_options_test {
namespace {

// On a film 36 mm wide a lens of 50 mm sees 39.6 degrees across: at f/2 its aperture is 25 mm wide.
TEST(Aperture, IsThatOfALensOf50Millimetres) {
  Camera camera;
  const double angle = 2 * std::atan(18.0 / 50);
  EXPECT_NEAR(angle * 180 / std::numbers::pi, 39.6, 0.01);
  camera.yfov = angle;
  EXPECT_NEAR(aperture_radius(FilmPlane(camera, 200, 300), 2), 0.0125, 1e-9);  // upright
  camera.yfov = 2 * std::atan(std::tan(angle / 2) * 200 / 300);
  EXPECT_NEAR(aperture_radius(FilmPlane(camera, 300, 200), 2), 0.0125, 1e-9);
  EXPECT_NEAR(aperture_radius(FilmPlane(camera, 300, 200), 4), 0.00625, 1e-9);
}

TEST(Words, TellLensAndShutter) {
  EXPECT_EQ(lens_words({}), "pinhole");
  EXPECT_EQ(lens_words({2.8, {}, 0}), "f/2.8 at what the middle shows");
  EXPECT_EQ(lens_words({2.8, 1.5, 0}), "f/2.8 at 1.5 m");
  EXPECT_EQ(focus_words(2.3456), "2.35 m");
  EXPECT_EQ(focus_words(HUGE_VAL), "infinity");
  EXPECT_EQ(shutter_words({}, {}), "an instant");
  EXPECT_EQ(shutter_words({{}, {}, 180}, {"1-4", 24}), "180 degrees at 24 frames per second");
}

}  // namespace
}  // namespace tdpt::testing::lens_options_test
