#include "libcommon/denoise/filter_picture.h"

#include <cstdlib>
#include <filesystem>

#include <gtest/gtest.h>

#include "libcommon/denoise/oidn.h"
#include "libcommon/testing/files/refusal.h"
#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/scenes/noisy_picture.h"

namespace tdpt::denoise {
namespace filter_picture_test {
namespace {

namespace fs = std::filesystem;

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

std::string message(ExrFile file, std::span<const NamedPicture> frames = {}) {
  return testing::refusal<InputError>(
      [&] { filter_picture(file, "a.exr", Kind::regression, frames); });
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
  const auto says = [&](const char* words) {
    return sentence_of(filtered).find(words) != std::string::npos;
  };
  EXPECT_TRUE(says("cannot be told from so few samples"));
  filtered.left = {0.00314, 0.00157, 0.00628};
  filtered.outliers = 12;
  filtered.left_out = 0.003;
  EXPECT_TRUE(says("relMSE 0.0031, 0.0016 to 0.0063; 12 outliers dimmed (0.3 %"));
  filtered.outliers = 0;
  filtered.denoiser = "regression + oidn 2.5.1";
  EXPECT_TRUE(says("with the help of Open Image Denoise 2.5.1"));
  filtered.denoiser = "oidn 2.5.1";
  EXPECT_TRUE(says("filtered by Open Image Denoise 2.5.1"));
}

TEST(FilterPicture, ASecondTimeChangesNothing) {
  ExrFile once = file_of(TestPicture(), 0.3, 2.0 / 3);
  EXPECT_NEAR(filter_picture(once, "a.exr").share_a, 2.0 / 3, 1e-6);
  ExrFile twice = once;
  filter_picture(twice, "a.exr");
  EXPECT_EQ(once.picture.pixels, twice.picture.pixels);
  EXPECT_EQ(once.layers["noisy"].pixels, twice.layers["noisy"].pixels);
}

// Rounding and conversion of colours leave a trace below zero, which is zero.
TEST(FilterPicture, ThroughAFileItIsTheSame) {
  ExrFile file = file_of(TestPicture(), 0.3);
  file.picture.alpha.assign(TestPicture::kSize.pixels(), 0.5f);
  for (Picture* p : {&file.picture, &file.layers["halfA"], &file.layers["halfB"]})
    p->pixels[7].x = 0;
  ExrFile read = parse_with_channels(exr_bytes(file), "a.exr");
  for (Picture* p : {&file.picture, &file.layers["halfA"], &file.layers["halfB"]})
    p->pixels[7].x = -1e-7f;
  filter_picture(file, "a.exr");
  filter_picture(read, "a.exr");
  EXPECT_EQ(read.picture.pixels, file.picture.pixels);
  EXPECT_EQ(read.picture.alpha, file.picture.alpha);
  EXPECT_EQ(read.channels[kErrorChannel], file.channels[kErrorChannel]);
}

// The guest filter is not even looked for.
TEST(FilterPicture, NoFilterTakesWhatIsNoLight) {
  ExrFile file = file_of(TestPicture(), 0.3);
  for (const float bad : {std::nanf(""), INFINITY, -0.5f}) {
    file.picture.pixels[96 * 3 + 4].y = bad;
    EXPECT_THROW(filter_picture(file, "a.exr", Kind::oidn), InputError) << bad;
  }
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
  const auto refused = [&](const auto& spoil, const char* place, const char* word) {
    ExrFile bad = good;
    spoil(bad);
    EXPECT_TRUE(testing::names(message(bad), place, word));
  };
  refused([](ExrFile& f) { f.layers.erase("halfB"); }, "channel halfB.R", "is missing");
  refused([](ExrFile& f) { f.layers["halfA"].pixels[96 * 2 + 7].y = NAN; },
          "channel halfA.G at pixel 7 2", "no finite number");
  refused([](ExrFile& f) { f.channels["normal.Y"][3] = INFINITY; }, "channel normal.Y at pixel 3 0",
          "no finite number");
  refused([](ExrFile& f) { f.picture.pixels[5] *= 2; }, "channel halfA.R at pixel 5 0",
          "is not half of this picture's samples");
  refused([](ExrFile& f) { f.layers["halfB"].pixels[96 * 3 + 4].z = -0.01f; },
          "channel halfB.B at pixel 4 3", "-0.01");
  refused(
      [](ExrFile& f) {
        for (Rgb& p : f.layers["halfA"].pixels) p *= -1;
      },
      "channel halfA.R at pixel 0 0", "is -");
  refused([](ExrFile& f) { f.picture.pixels[96].y = -2; }, "channel G at pixel 0 1", "-2");
  refused([](ExrFile& f) { f.picture = f.layers["halfA"]; }, "channel halfB.R", "is empty");
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
  const auto said = [&] { return message(file, {&before, 1}); };
  EXPECT_TRUE(testing::names(said(), "attribute camera", "a.exr"));
  file.attributes["camera"] = kCamera;
  before.file.attributes["camera"] = "0 0 0";
  EXPECT_TRUE(testing::names(said(), "attribute camera", "b.exr"));
  before.file.attributes["camera"] = kCamera;
  const auto depth = before.file.channels["depth.Z"];
  before.file.channels.erase("depth.Z");
  EXPECT_TRUE(testing::names(said(), "channel depth.Z", "b.exr"));
  before.file.channels["depth.Z"] = depth;
  const Filtered filtered = filter_picture(file, "a.exr", Kind::regression, {&before, 1});
  EXPECT_EQ(filtered.seen_elsewhere, 1);
  EXPECT_NE(sentence_of(filtered).find("; other frames show 100 % of it"), std::string::npos);
}

// Looks for the library in an environment of Python with the fake, or an empty one.
class Oidn : public ::testing::Test {
 protected:
  const testing::TempFolder temporary;
  const fs::path folder = temporary.path;
  void SetUp() override {
    setenv("VIRTUAL_ENV", folder.c_str(), 1);
    setenv("HOME", folder.c_str(), 1);
    if (has_another()) GTEST_SKIP() << "Open Image Denoise is installed";
  }
  void install() const {
    const fs::path lib = folder / "lib/python3.99/site-packages/pyoidn/oidn/lib";
    fs::create_directories(lib);
    fs::create_symlink(TDPT_FAKE_OIDN, lib / "libOpenImageDenoise.so.1.4.3");
  }
  // Whether the machine has the real one, which comes first.
  static bool has_another() {
    try {
      return OpenImageDenoise().version() != "1.4.3";
    } catch (const Error&) {
      return false;
    }
  }
};

TEST_F(Oidn, FiltersThroughAVersionOfOldNames) {
  install();
  for (const bool features : {false, true}) {
    ExrFile file;
    file.picture = {3, 2, std::vector<Rgb>(6, Rgb(4, 6, 8))};
    for (const char* name : {"albedo.R", "albedo.G", "albedo.B"})
      if (features) file.channels[name].assign(6, 0.5f);
    const Filtered filtered = filter_picture(file, "a.exr", Kind::oidn);
    EXPECT_EQ(filtered.has_features, features);
    EXPECT_EQ(filtered.denoiser, "oidn 1.4.3");
    EXPECT_EQ(file.attributes[denoiser_attribute], "oidn 1.4.3");
    EXPECT_EQ(file.picture.pixels[5], Rgb(2, 3, 4));
    EXPECT_EQ(file.layers["noisy"].pixels[5], Rgb(4, 6, 8));
  }
}

// By default it helps where it is there and runs; the fake, which halves the light, is no help.
TEST_F(Oidn, HelpsByDefault) {
  ExrFile alone = file_of(TestPicture(), 0.2), helped = alone;
  EXPECT_EQ(filter_picture(alone, "a.exr").denoiser, "regression");
  install();
  EXPECT_EQ(filter_picture(helped, "a.exr").denoiser, "regression + oidn 1.4.3");
  double off = 0;
  for (size_t i = 0; i < alone.picture.pixels.size(); ++i) {
    const float ratio = helped.picture.pixels[i].y / alone.picture.pixels[i].y;
    off += std::abs(static_cast<double>(ratio) - 1);
  }
  EXPECT_LT(off / static_cast<double>(alone.picture.pixels.size()), 0.05);
}

TEST_F(Oidn, TellsItsFailuresAndHowToGetIt) {
  const auto said = [](int width) {
    ExrFile file;
    file.picture = {width, 1, std::vector<Rgb>(static_cast<size_t>(width))};
    try {
      filter_picture(file, "a.exr", Kind::oidn);
    } catch (const Error& e) {
      EXPECT_EQ(e.code, Exit::no_device);
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_NE(said(3).find("pip install pyoidn"), std::string::npos);
  install();
  EXPECT_NE(said(1).find("too narrow"), std::string::npos);
}

}  // namespace
}  // namespace filter_picture_test
}  // namespace tdpt::denoise
