#include "libcommon/options/picture_options.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "libcommon/base/error.h"

namespace tdpt::picture_options_test {
namespace {

template <class Call>
std::string complaint(const Call& call) {
  try {
    call();
    return "";
  } catch (const Error& e) {
    return fmt::format("{} {}", static_cast<int>(e.code), e.what());
  }
}

TEST(PictureOptions, ExposureGoesWithAPreview) {
  PictureArguments a;
  a.exposure = 1;
  EXPECT_EQ(complaint([&] { check_picture_arguments(a); }), "2 --exposure goes with --preview");
  a.preview = "a.png";
  EXPECT_EQ(complaint([&] { check_picture_arguments(a); }), "");
}

TEST(PictureOptions, ExposureIsAsGivenElseAutomatic) {
  const Picture picture{1, 1, {Rgb(0.36f)}};
  EXPECT_EQ(exposure_of(picture, "", 2.0), std::nullopt);
  EXPECT_EQ(exposure_of(picture, "a.png", 2.0), 2);
  EXPECT_EQ(exposure_of(picture, "a.png", {}), -1);
}

}  // namespace
}  // namespace tdpt::picture_options_test
