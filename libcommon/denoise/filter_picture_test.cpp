#include "libcommon/denoise/filter_picture.h"

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/testing/scenes/noisy_picture.h"

namespace tdpt::denoise {
namespace filter_picture_test {
namespace {

Picture picture_of(const Colour& colour) {
  Picture picture{TestPicture::kSize.width, TestPicture::kSize.height, {}};
  for (size_t i = 0; i < TestPicture::kSize.pixels(); ++i)
    picture.pixels.push_back({colour[0][i], colour[1][i], colour[2][i]});
  return picture;
}

ExrFile file_of(const TestPicture& test, double noise, double share_a = 0.5) {
  const Input input = test.halves(noise);
  ExrFile file;
  file.layers["halfA"] = picture_of(input.halves.a);
  file.layers["halfB"] = picture_of(input.halves.b);
  file.picture = file.layers["halfA"];
  for (size_t i = 0; i < file.picture.pixels.size(); ++i)
    file.picture.pixels[i] = file.layers["halfA"].pixels[i] * static_cast<float>(share_a) +
                             file.layers["halfB"].pixels[i] * static_cast<float>(1 - share_a);
  constexpr std::array names{"albedo.R", "albedo.G", "albedo.B",
                             "normal.X", "normal.Y", "normal.Z"};
  for (size_t f = 0; f < names.size(); ++f) file.channels[names[f]] = test.features[f];
  file.channels["depth.Z"].assign(TestPicture::kSize.pixels(), 3);
  return file;
}

double error_of(const TestPicture& test, const Picture& picture) {
  Colour colour;
  for (size_t c = 0; c < 3; ++c)
    for (const Rgb& p : picture.pixels) colour[c].push_back(p[static_cast<int>(c)]);
  return test.error(colour);
}

std::string message(ExrFile file) {
  try {
    filter_picture(file, "a.exr");
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(FilterPicture, KeepsWhatWasRenderedBeside) {
  const TestPicture test;
  ExrFile file = file_of(test, 0.3);
  const Picture noisy = file.picture;
  const Filtered filtered = filter_picture(file, "a.exr", Kind::regression);
  EXPECT_TRUE(filtered.has_features);
  EXPECT_EQ(file.layers["noisy"].pixels, noisy.pixels);
  EXPECT_LT(error_of(test, file.picture), error_of(test, noisy) / 10);
  EXPECT_EQ(file.attributes[denoiser_attribute], "regression");
  EXPECT_EQ(file.channels[kErrorChannel].size(), noisy.pixels.size());
}

TEST(FilterPicture, SaysWhatWasDone) {
  Filtered filtered;
  filtered.denoiser = "regression";
  EXPECT_EQ(sentence_of(filtered),
            "filtered, no longer unbiased: how far it is from the truth cannot be told from so few "
            "samples");
  filtered.left = {0.00314, 0.00157, 0.00628};
  filtered.outliers = 12;
  filtered.left_out = 0.003;
  EXPECT_EQ(sentence_of(filtered),
            "filtered, no longer unbiased: relMSE 0.0031, 0.0016 to 0.0063; 12 outliers dimmed "
            "(0.3 % of the light is left out)");
  filtered.outliers = 0;
  filtered.denoiser = "regression + oidn 2.5.1";
  EXPECT_EQ(
      sentence_of(filtered),
      "filtered, with the help of Open Image Denoise 2.5.1, no longer unbiased: relMSE 0.0031, "
      "0.0016 to 0.0063");
  filtered.denoiser = "oidn 2.5.1";
  EXPECT_EQ(sentence_of(filtered), "filtered by Open Image Denoise 2.5.1, no longer unbiased");
}

TEST(FilterPicture, ASecondTimeChangesNothing) {
  ExrFile once = file_of(TestPicture(), 0.3);
  filter_picture(once, "a.exr");
  ExrFile twice = once;
  filter_picture(twice, "a.exr");
  EXPECT_EQ(once.picture.pixels, twice.picture.pixels);
  EXPECT_EQ(once.layers["noisy"].pixels, twice.layers["noisy"].pixels);
}

TEST(FilterPicture, ThroughAFile) {
  ExrFile file = file_of(TestPicture(), 0.3);
  file.picture.alpha.assign(TestPicture::kSize.pixels(), 0.5f);
  ExrFile read = parse_with_channels(exr_bytes(file), "a.exr");
  filter_picture(file, "a.exr");
  filter_picture(read, "a.exr");
  EXPECT_EQ(exr_bytes(read), exr_bytes(file));
}

TEST(FilterPicture, FindsTheShareOfTheHalves) {
  ExrFile file = file_of(TestPicture(), 0.3, 2.0 / 3);
  EXPECT_NEAR(filter_picture(file, "a.exr").share_a, 2.0 / 3, 1e-6);
}

// The guest filter is not even looked for.
TEST(FilterPicture, NoFilterTakesWhatIsNoLight) {
  ExrFile file = file_of(TestPicture(), 0.3);
  for (const float bad : {std::nanf(""), INFINITY, -0.5f}) {
    file.picture.pixels[96 * 3 + 4].y = bad;
    EXPECT_THROW(filter_picture(file, "a.exr", Kind::oidn), InputError) << bad;
  }
}

// As rounding and conversion of colours leave it.
TEST(FilterPicture, ATraceBelowZeroIsZero) {
  ExrFile file = file_of(TestPicture(), 0.3), zero = file;
  for (const char* layer : {"", "halfA", "halfB"}) {
    (*layer ? file.layers[layer] : file.picture).pixels[7].x = -1e-7f;
    (*layer ? zero.layers[layer] : zero.picture).pixels[7].x = 0;
  }
  filter_picture(file, "a.exr");
  filter_picture(zero, "a.exr");
  EXPECT_EQ(file.picture.pixels, zero.picture.pixels);
}

TEST(FilterPicture, WithoutFeatures) {
  const TestPicture test;
  ExrFile file = file_of(test, 0.3);
  file.channels.clear();
  const Picture noisy = file.picture;
  EXPECT_FALSE(filter_picture(file, "a.exr").has_features);
  EXPECT_LT(error_of(test, file.picture), error_of(test, noisy));
}

TEST(FilterPicture, RefusesWhatIsMissingOrNoNumber) {
  const ExrFile good = file_of(TestPicture(), 0.3);
  EXPECT_EQ(message(good), "");
  ExrFile bad = good;
  bad.layers.erase("halfB");
  EXPECT_EQ(message(bad),
            "a.exr:channel halfB.R: is missing; tdpt-render --aov halves,albedo,normal,depth makes "
            "what a filter needs");
  bad = good;
  bad.layers["halfA"].pixels[96 * 2 + 7].y = std::nanf("");
  EXPECT_EQ(message(bad), "a.exr:channel halfA.G at pixel 7 2: is no finite number");
  bad = good;
  bad.channels["normal.Y"][3] = INFINITY;
  EXPECT_EQ(message(bad), "a.exr:channel normal.Y at pixel 3 0: is no finite number");
  bad = good;
  bad.picture.pixels[5] = bad.picture.pixels[5] * 2;
  EXPECT_EQ(message(bad),
            "a.exr:channel halfA.R at pixel 5 0: is not half of this picture's samples, or lost "
            "digits in compression");
  bad = good;
  bad.layers["halfB"].pixels[96 * 3 + 4].z = -0.01f;
  EXPECT_EQ(message(bad), "a.exr:channel halfB.B at pixel 4 3: is -0.01, expected light from 0");
  bad = good;
  for (Rgb& p : bad.layers["halfA"].pixels) p *= -1;
  EXPECT_EQ(message(bad).find("a.exr:channel halfA.R at pixel 0 0: is -"), 0u);
  bad = good;
  bad.picture.pixels[96].y = -2;
  EXPECT_EQ(message(bad), "a.exr:channel G at pixel 0 1: is -2, expected light from 0");
  bad = good;
  bad.picture = bad.layers["halfA"];
  EXPECT_EQ(message(bad),
            "a.exr:channel halfB.R: is empty: a filter needs two samples per pixel or more");
}

// A film of that many samples of a picture.
Film film_of(uint64_t samples) {
  const TestPicture test;
  Film film(TestPicture::kSize.width, TestPicture::kSize.height, 1, {.halves = true});
  for (uint64_t s = 0; s < samples; ++s) {
    const Picture sample = picture_of(test.halves(0.3, s).halves.a);
    for (size_t i = 0; i < sample.pixels.size(); ++i)
      film.add(static_cast<int>(i % 96), static_cast<int>(i / 96), Vec3d(sample.pixels[i]), 0, s);
  }
  film.complete({0, samples});
  return film;
}

TEST(FilterPicture, OfAFilmIsFilteredAsItsFactsAsk) {
  const Film film = film_of(4);
  FilmFacts facts;
  const auto filtered = [&](const Film& of, std::vector<std::string> derived) {
    facts.derived = std::move(derived);
    std::optional<Filtered> how;
    return filtered_picture(of, facts, {}, how);
  };
  ExrFile expected = filtered(film, {"halves"});
  EXPECT_EQ(expected.layers.size(), 2u);
  filter_picture(expected, "a.exr", Kind::regression);
  const ExrFile all = filtered(film, {"halves", "denoise-regression"}),
                alone = filtered(film, {"denoise-regression"});
  EXPECT_EQ(exr_bytes(all), exr_bytes(expected));
  EXPECT_EQ(alone.picture.pixels, expected.picture.pixels);
  EXPECT_EQ(alone.layers.size(), 1u) << "noisy";
  EXPECT_TRUE(filtered(film_of(1), {"denoise-regression"}).layers.empty());
}

const char* const kCamera = "0 0 0 0 0 -1 0 1 0 1 1.5 all";

TEST(FilterPicture, FramesAreAlignedByCameraAndDepth) {
  const TestPicture test;
  ExrFile file = file_of(test, 0.3);
  NamedPicture before{file_of(test, 0.3), "b.exr"};
  const auto message_with = [&](ExrFile picture, const NamedPicture& frame) {
    try {
      filter_picture(picture, "a.exr", Kind::regression, {&frame, 1});
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(message_with(file, before),
            "a.exr:attribute camera: is missing or malformed: frames are aligned by camera and "
            "depth");
  file.attributes["camera"] = kCamera;
  before.file.attributes["camera"] = "0 0 0";
  EXPECT_EQ(message_with(file, before),
            "b.exr:attribute camera: is missing or malformed: frames are aligned by camera and "
            "depth");
  before.file.attributes["camera"] = kCamera;
  EXPECT_EQ(message_with(file, before), "");
  NamedPicture flat = before;
  flat.file.channels.erase("depth.Z");
  EXPECT_EQ(message_with(file, flat),
            "b.exr:channel depth.Z: is missing: frames are aligned by camera and depth");
  const Filtered filtered = filter_picture(file, "a.exr", Kind::regression, {&before, 1});
  EXPECT_EQ(filtered.seen_elsewhere, 1);
  EXPECT_NE(sentence_of(filtered).find("; other frames show 100 % of it"), std::string::npos);
}

}  // namespace
}  // namespace filter_picture_test
}  // namespace tdpt::denoise
