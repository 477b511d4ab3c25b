#include "libcommon/denoise/oidn.h"

#include <cstdlib>
#include <filesystem>

#include <unistd.h>

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/denoise/filter_picture.h"
#include "libcommon/testing/scenes/noisy_picture.h"

namespace tdpt::denoise {
namespace oidn_test {
namespace {

namespace fs = std::filesystem;

// Looks for the library in an environment of Python with the fake, or an empty one.
class Oidn : public ::testing::Test {
 protected:
  fs::path folder = fs::path(testing::TempDir()) / ("oidn" + std::to_string(getpid()));
  void SetUp() override {
    fs::create_directories(folder);
    setenv("VIRTUAL_ENV", folder.c_str(), 1);
    setenv("HOME", folder.c_str(), 1);
  }
  void TearDown() override { fs::remove_all(folder); }
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

ExrFile picture(int width) {
  ExrFile file;
  file.picture = {width, 2, {}};
  file.picture.pixels.assign(static_cast<size_t>(2 * width), Rgb(4, 6, 8));
  return file;
}

TEST_F(Oidn, FiltersThroughAVersionOfOldNames) {
  if (has_another()) GTEST_SKIP() << "Open Image Denoise is installed";
  install();
  for (const bool features : {false, true}) {
    ExrFile file = picture(3);
    for (const char* name : {"albedo.R", "albedo.G", "albedo.B"})
      if (features) file.channels[name].assign(6, 0.5f);
    const Filtered filtered = filter_picture(file, "a.exr", Kind::oidn);
    EXPECT_EQ(filtered.has_features, features);
    EXPECT_EQ(sentence_of(filtered), "filtered by Open Image Denoise 1.4.3, no longer unbiased");
    EXPECT_EQ(file.attributes[denoiser_attribute], "oidn 1.4.3");
    EXPECT_EQ(file.picture.pixels[5], Rgb(2, 3, 4));
    EXPECT_EQ(file.layers["noisy"].pixels[5], Rgb(4, 6, 8));
  }
}

// By default it helps where it is there and runs; the fake, which halves the light, is no help.
TEST_F(Oidn, HelpsByDefault) {
  if (has_another()) GTEST_SKIP() << "Open Image Denoise is installed";
  const TestPicture test;
  const Input input = test.halves(0.2);
  const auto filtered = [&](std::string& denoiser) {
    ExrFile file;
    for (const auto& [layer, planes] :
         {std::pair("halfA", input.halves.a), {"halfB", input.halves.b}}) {
      file.layers[layer] = {TestPicture::kSize.width, TestPicture::kSize.height, {}};
      for (size_t i = 0; i < TestPicture::kSize.pixels(); ++i)
        file.layers[layer].pixels.emplace_back(planes[0][i], planes[1][i], planes[2][i]);
    }
    file.picture = file.layers["halfA"];
    for (size_t i = 0; i < file.picture.pixels.size(); ++i)
      file.picture.pixels[i] = (file.picture.pixels[i] + file.layers["halfB"].pixels[i]) * 0.5f;
    denoiser = filter_picture(file, "a.exr").denoiser;
    return file.picture.pixels;
  };
  std::string denoiser;
  const std::vector<Rgb> alone = filtered(denoiser);
  EXPECT_EQ(denoiser, "regression");
  install();
  const std::vector<Rgb> helped = filtered(denoiser);
  EXPECT_EQ(denoiser, "regression + oidn 1.4.3");
  double off = 0;
  for (size_t i = 0; i < alone.size(); ++i)
    off += std::abs(static_cast<double>(helped[i].y / alone[i].y) - 1);
  EXPECT_LT(off / static_cast<double>(alone.size()), 0.05);
}

TEST_F(Oidn, TellsItsFailures) {
  if (has_another()) GTEST_SKIP() << "Open Image Denoise is installed";
  install();
  ExrFile file = picture(1);
  try {
    filter_picture(file, "a.exr", Kind::oidn);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code, Exit::no_device);
    EXPECT_STREQ(e.what(), "Open Image Denoise: too narrow");
  }
}

TEST_F(Oidn, SaysHowToGetIt) {
  if (has_another()) GTEST_SKIP() << "Open Image Denoise is installed";
  ExrFile file = picture(3);
  try {
    filter_picture(file, "a.exr", Kind::oidn);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code, Exit::no_device);
    EXPECT_NE(std::string(e.what()).find("pip install pyoidn"), std::string::npos);
  }
}

}  // namespace
}  // namespace oidn_test
}  // namespace tdpt::denoise
