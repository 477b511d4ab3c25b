#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/formats/tone.h"
#include "tools/exrdiff/measure.h"

namespace tdpt::exrdiff_test {

// Two pixels by hand: r = 1 1 1, 3 3 3, so m = 2 and peak = 3; a = 1 2 1, 0 3 4.
const Picture reference{2, 1, {Rgb(1), Rgb(3)}};
const Picture picture{2, 1, {{1, 2, 1}, {0, 3, 4}}};

Comparison by_hand() {
  return compare(picture, "a.exr", reference, "r.exr");
}

std::string complaint(const Picture& a, const Picture& r) {
  try {
    compare(a, "a.exr", r, "r.exr");
    return "";
  } catch (const InputError& e) {
    return e.what();
  }
}

TEST(Measures, AreThoseByHand) {
  const Comparison c = by_hand();
  EXPECT_DOUBLE_EQ(c.picture.mse, 11.0 / 6);  // squared errors 1, 9, 1
  EXPECT_DOUBLE_EQ(c.black.mse, (3 * 1 + 3 * 9) / 6.0);
  EXPECT_DOUBLE_EQ(c.peak, 3);  // of the reference
  EXPECT_DOUBLE_EQ(c.picture.psnr, 10 * std::log10(9 / (11.0 / 6)));
  EXPECT_DOUBLE_EQ(c.black.psnr, 10 * std::log10(9 / 5.0));
  // The offset is 0.01 m = 0.02.
  EXPECT_DOUBLE_EQ(c.picture.mape, 100 * (1 / 1.02 + 3 / 3.02 + 1 / 3.02) / 6);
  EXPECT_DOUBLE_EQ(c.black.mape, 100 * (1 / 1.02 + 3 / 3.02) / 2);
  // 0.01 m^2 = 0.04.
  EXPECT_DOUBLE_EQ(c.picture.relmse, (1 / 1.04 + 9 / 9.04 + 1 / 9.04) / 6);
  EXPECT_DOUBLE_EQ(c.black.relmse, (1 / 1.04 + 9 / 9.04) / 2);
  EXPECT_DOUBLE_EQ(c.mean, 11.0 / 6);
  EXPECT_DOUBLE_EQ(c.reference_mean, 2);
  EXPECT_DOUBLE_EQ(c.nonzero, 1);
  const Picture half{2, 1, {Rgb(0), {0, 0, 1e-30f}}};
  EXPECT_DOUBLE_EQ(compare(half, "a", reference, "r").nonzero, 0.5);
}

TEST(Measures, TrimmingForgivesAThousandthOfThePixels) {
  Picture r{50, 40, std::vector<Rgb>(2000, Rgb(1))}, a = r;
  a.pixels[7] = a.pixels[1999] = Rgb(1001);  // two fireflies in 2000 pixels
  EXPECT_DOUBLE_EQ(compare(a, "a", r, "r").picture.relmse, 2e6 / 1.01 / 2000);
  EXPECT_DOUBLE_EQ(compare(a, "a", r, "r").picture.relmse_trimmed, 0);
  a.pixels[8] = Rgb(2);  // one outlier more than is ignored
  EXPECT_DOUBLE_EQ(compare(a, "a", r, "r").picture.relmse_trimmed, 1 / 1.01 / 1998);
}

TEST(Measures, RefusesPicturesThatAreNotFinite) {
  Picture nan = picture;
  nan.pixels[1].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_NE(complaint(nan, reference).find("a.exr:pixel 1 0: is 0 nan 4"), std::string::npos);
  Picture infinite = reference;
  infinite.pixels[0] = Rgb(std::numeric_limits<float>::infinity());
  infinite.pixels[1].z = -std::numeric_limits<float>::infinity();
  EXPECT_NE(complaint(reference, infinite).find("r.exr:pixel 0 0: is inf inf inf"),
            std::string::npos);
  EXPECT_NE(complaint(reference, infinite).find("2 pixels"), std::string::npos);
}

TEST(Report, TextHasNoExponentsWhereNumbersAreEveryday) {
  Comparison c = by_hand();
  c.mean = 1234567;
  c.reference_mean = 123456;
  EXPECT_NE(report_text(c).find("mean                 1234600  (reference 123460)\n"),
            std::string::npos)
      << report_text(c);
}

TEST(Difference, HasItsSign) {
  const Picture d = difference(picture, reference);
  EXPECT_EQ(d.pixels, (std::vector<Rgb>{{0, 1, 0}, {-3, 0, 1}}));
}

TEST(Difference, FalseColourIsWhiteRedAndBlue) {
  const Picture a{3, 1, {Rgb(2), Rgb(0), Rgb(9)}}, r{3, 1, {Rgb(2), Rgb(2), Rgb(2)}};
  const Picture f = false_colour(a, r);
  EXPECT_EQ(f.pixels[0], Rgb(1));
  EXPECT_LT(f.pixels[1].x, 0.02f);
  EXPECT_EQ(f.pixels[1].z, 1);
  EXPECT_EQ(f.pixels[2], Rgb(1, 0, 0));
}

TEST(Difference, SideBySideHasOneExposure) {
  const Picture s = side_by_side(picture, reference, -1);
  EXPECT_EQ(s.width, 6);
  EXPECT_EQ(s.height, 1);
  for (size_t i : {0, 1}) {
    EXPECT_EQ(s.pixels[i], toned(picture, -1).pixels[i]);
    EXPECT_EQ(s.pixels[4 + i], toned(reference, -1).pixels[i]);
  }
}

}  // namespace tdpt::exrdiff_test
