#include "libcommon/options/picture_options.h"

#include <gtest/gtest.h>

#include "libcommon/base/error.h"

namespace tdpt::picture_options_test {
namespace {

TEST(PictureOptions, ExposureGoesWithAPreview) {
  PictureArguments a;
  a.exposure = 1;
  EXPECT_THROW(check_picture_arguments(a), UsageError);
  a.preview = "a.png";
  EXPECT_NO_THROW(check_picture_arguments(a));
}

TEST(PictureOptions, ExposureIsAsGivenElseAutomatic) {
  const Picture picture{1, 1, {Rgb(0.36f)}};
  EXPECT_EQ(exposure_of(picture, "", 2.0), std::nullopt);
  EXPECT_EQ(exposure_of(picture, "a.png", 2.0), 2);
  EXPECT_EQ(exposure_of(picture, "a.png", {}), -1);
}

}  // namespace
}  // namespace tdpt::picture_options_test
