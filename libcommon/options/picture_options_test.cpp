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

PictureArguments with(const std::string& pixels, const std::string& compression) {
  PictureArguments a;
  a.pixels = pixels;
  a.compression = compression;
  return a;
}

TEST(PictureOptions, ExposureGoesWithAPreview) {
  PictureArguments a;
  a.exposure = 1;
  EXPECT_EQ(complaint([&] { check_picture_arguments(a); }), "2 --exposure goes with --preview");
  a.preview = "a.png";
  EXPECT_EQ(complaint([&] { check_picture_arguments(a); }), "");
}

TEST(PictureOptions, FilmsKeepEveryDigit) {
  const auto film = [](const PictureArguments& a) {
    return complaint([&] { check_stores_film(a, "--shard"); });
  };
  EXPECT_EQ(film(with("float", "zip")), "");
  for (const auto& a : {with("half", "zip"), with("float", "dwaa"), with("half", "dwab")})
    EXPECT_EQ(film(a),
              "2 --shard writes a film, which keeps every digit: --set pixels and --set "
              "compression are for pictures");
}

TEST(PictureOptions, WordsNameTheStorage) {
  EXPECT_EQ(with("float", "zip").storage().pixels, Storage::real);
  EXPECT_EQ(with("half", "dwaa").storage().pixels, Storage::half);
  EXPECT_EQ(with("half", "dwaa").storage().compression, Storage::dwaa);
  EXPECT_EQ(with("float", "dwab").storage().compression, Storage::dwab);
}

TEST(PictureOptions, ExposureIsAsGivenElseAutomatic) {
  const Picture picture{1, 1, {Rgb(0.36f)}};
  EXPECT_EQ(exposure_of(picture, "", 2.0), std::nullopt);
  EXPECT_EQ(exposure_of(picture, "a.png", 2.0), 2);
  EXPECT_EQ(exposure_of(picture, "a.png", {}), -1);
}

// What --explain says of an automatic exposure can be given to other pictures.
TEST(PictureOptions, ExposureIsExplained) {
  const auto told = [](std::optional<double> given, std::optional<double> used) {
    std::string text;
    for (const cli::Decision& d : with_exposure({}, given, used)) text += sentence(d);
    return text;
  };
  EXPECT_EQ(told({}, {}), "");
  EXPECT_EQ(told({}, -2.37),
            "exposure: -2.37 stops, because most of the picture is then middle grey "
            "(--exposure -2.37 shows other pictures alike)");
  EXPECT_EQ(told(1.5, 1.5), "exposure: 1.5 stops, because --exposure says so");
}

std::string warning(const ExrFile& file, const Storage& storage) {
  cli::Common common;
  common.tool = "t";
  ::testing::internal::CaptureStderr();
  warn_of_range(file, storage, common);
  return ::testing::internal::GetCapturedStderr();
}

TEST(PictureOptions, WarnsOfWhatHalfFloatsCannotHold) {
  const Storage half{Storage::half, Storage::zip}, dwaa{Storage::real, Storage::dwaa};
  ExrFile file;
  file.picture = {200, 1, {}};
  Picture& picture = file.picture;
  picture.pixels.resize(200, Rgb(1));
  file.layers["halfA"] = picture;
  picture.pixels[0] = Rgb(65504);
  picture.pixels[1] = Rgb(1e-9f, 0, 0);  // one of two hundred may vanish
  EXPECT_EQ(warning(file, half), "");
  EXPECT_EQ(warning(file, dwaa),
            "t: warning: stored as half floats, 1 pixel brighter than 60000 is cut to it\n");
  picture.pixels[0] = picture.pixels[5] = Rgb(0, 0, 65536);
  EXPECT_EQ(warning(file, Storage()), "");
  EXPECT_EQ(warning(file, half),
            "t: warning: stored as half floats, 2 pixels brighter than 65504 are cut to it\n");
  file.layers["halfA"].pixels[7] = Rgb(70000);
  EXPECT_EQ(warning(file, half),
            "t: warning: stored as half floats, 3 pixels brighter than 65504 are cut to it\n");
  file.layers.clear();
  for (Rgb& c : picture.pixels) c *= 1e-9f;
  EXPECT_EQ(warning(file, half),
            "t: warning: stored as half floats, 198 pixels darker than 6e-8 may be black\n");
  picture.pixels[2] = Rgb(1e6f);
  EXPECT_EQ(warning(file, half),
            "t: warning: stored as half floats, 1 pixel brighter than 65504 is cut to it, and 197 "
            "pixels darker than 6e-8 may be black\n");
}

}  // namespace
}  // namespace tdpt::picture_options_test
