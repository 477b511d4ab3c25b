#include <algorithm>
#include <cmath>
#include <tuple>

#include <gtest/gtest.h>

#include "libcommon/testing/files/temp_folder.h"
#include "tools/tdpt-import/images.h"
#include "tools/tdpt-import/materials.h"
#include "tools/tdpt-import/source.h"

namespace tdpt::foreign::import_test {

template <class F>
std::string complaint(const F& f) {
  try {
    f();
    return "";
  } catch (const InputError& e) {
    return e.what();
  }
}

TEST(Source, ReadsBelowItsFolderOnly) {
  const testing::TempFolder folder;
  folder.write("above.txt", "secret");
  folder.write("scene/models/a.txt",
               "\xEF\xBB\xBF"
               "a");  // after a byte order mark
  Source source(folder.write("scene/scene.xml", "\xEF\xBB\xBF<scene/>"));
  const Place place{"scene.xml", "line 3"};
  EXPECT_EQ(source.text(), "<scene/>");
  EXPECT_EQ(source.read("models/a.txt", place), "a");
  EXPECT_EQ(source.read("models\\a.txt", place), "a");  // as Windows writes it
  EXPECT_NE(complaint([&] { source.read("../above.txt", place); }).find("scene.xml:line 3: \"../"),
            std::string::npos);
  std::filesystem::create_symlink(folder.path / "above.txt", folder.path / "scene/link.txt");
  EXPECT_NE(
      complaint([&] { source.read("link.txt", place); }).find("leads out of the scene's folder"),
      std::string::npos);
  EXPECT_NE(complaint([&] { source.read("/etc/passwd", place); }), "");
  EXPECT_FALSE(source.has("b.txt", place));
  EXPECT_EQ(source.files().size(), 2u);  // the scene and a.txt, once
}

TEST(Source, GoesOnWithoutMissingFilesIfAllowed) {
  const testing::TempFolder folder;
  const std::string path = folder.write("scene.json", "{}");
  const Place place{"scene.json", "a"};
  Source strict(path), lenient(path, true);
  EXPECT_NE(complaint([&] { strict.read_picture("b.png", place); }), "");
  EXPECT_NE(complaint([&] { strict.read_mesh("b.ply", place); }), "");
  EXPECT_FALSE(lenient.read_mesh("b.ply", place));
  const Texels grey = decode(lenient.read_picture("b.png", place), "b.png");
  EXPECT_EQ(grey.rgb.at(0).y, 0.5f);
  ASSERT_EQ(lenient.losses().size(), 2u);
  EXPECT_EQ(lenient.losses()[0].sentence, "\"b.ply\" is missing: what shows it is left out");
  EXPECT_NE(complaint([&] { lenient.read_mesh("../b.ply", place); }),
            "");  // not missing, but outside
}

TEST(Source, NamesKeysThatNobodyTook) {
  const testing::TempFolder folder;
  Source source(folder.write("scene.json", "{}"));
  const Place place{"scene.json", ""};
  const Key held = source.enter({}, place, "held"), read = source.enter({}, place, "read");
  source.enter(held, place, "in what nobody took");
  source.enter(read, place, "in what was read");
  source.enter({}, place, "");
  read.take();
  read.take();
  Key().take();
  source.lose_unread();
  source.lose_unread();
  ASSERT_EQ(source.losses().size(), 2u);
  EXPECT_EQ(source.losses()[0].sentence, "held");
  EXPECT_EQ(source.losses()[1].sentence, "in what was read");
  EXPECT_EQ(source.losses()[0].times, 1u);
  source.lose({"scene.json", "again"}, "held");
  ASSERT_EQ(source.losses().size(), 2u);
  EXPECT_EQ(source.losses()[0].first.where, "");
  EXPECT_EQ(source.losses()[0].times, 2u);
}

TEST(Source, SearchesFoldersOfItsOwn) {
  const testing::TempFolder folder;
  folder.write("scene/models/a.txt", "in models");
  Source source(folder.write("scene/scene.xml", ""));
  const Place place{"scene.xml", "line 1"};
  source.search("models", place);
  EXPECT_EQ(source.read("a.txt", place), "in models");
  folder.write("outside.txt", "secret");
  source.search("..", place);
  source.search("/tmp", place);
  EXPECT_FALSE(source.has("outside.txt", place));
  EXPECT_EQ(source.losses().size(), 2u);
}

TEST(Materials, DiffuseFresnelOfGlass) {
  EXPECT_NEAR(diffuse_fresnel(1.5), 0.0918, 2e-4);      // tables: 0.092 from outside
  EXPECT_NEAR(diffuse_fresnel(1 / 1.5), 0.5963, 2e-4);  // and 0.596 from inside
  EXPECT_NEAR(1 - diffuse_fresnel(1 / 1.5), (1 - diffuse_fresnel(1.5)) / 2.25, 1e-4);
}

TEST(Materials, TexturedPlasticIsColouredPerTexel) {
  Colour wood{{0.5f, 0.5f, 0.5f}, Texture{}, {}};
  const Material m = plastic(wood, 1.5, {0.25f, {}, {}}, true);
  ASSERT_TRUE(m.base.curve);
  const Material flat = plastic({{0.4f, 0.4f, 0.4f}, {}, {}}, 1.5, {0.25f, {}, {}}, true);
  EXPECT_NEAR(m.base.curve({0.8f, 0.8f, 0.8f}).x * m.base.factor.x, flat.base.factor.x, 1e-6);
  EXPECT_NEAR(m.roughness.factor, 0.5f, 1e-6);
  const Material rough = metal({Rgb(1), {}, {}}, {3, Texture{}, {}});  // three times the texels
  EXPECT_EQ(rough.roughness.factor, 1);
  EXPECT_NEAR(rough.roughness.curve(0.12f), 0.6f, 1e-6);
}

// As the shares of Mitsuba 3.9.1's roughplastic of 0.1 and 0.3, found by sampling it: of what
// enters at a cosine of 0.7 these come out again.
TEST(Materials, RoughPlasticsAreDarkerInside) {
  const auto base = [](float r, float alpha) {
    return rough_plastic({Rgb(r), {}, {}}, 1.5, {alpha, {}, {}}, true).base.factor.x;
  };
  EXPECT_NEAR(base(0.1f, 0.1f), 0.0428, 0.0008);
  EXPECT_NEAR(base(0.8f, 0.1f), 0.5797, 0.01);
  EXPECT_NEAR(base(0.95f, 0.1f), 0.8082, 0.025);
  EXPECT_NEAR(base(0.5f, 0.3f), 0.2463, 0.005);
  EXPECT_NEAR(base(0.8f, 0.3f), 0.4675, 0.01);
  EXPECT_NEAR(base(0.95f, 0.3f), 0.6121, 0.016);
  const float smooth = plastic({Rgb(0.8f), {}, {}}, 1.5, {0.001f, {}, {}}, true).base.factor.x;
  EXPECT_NEAR(base(0.8f, 0.001f), smooth, 0.005);
  EXPECT_GT(smooth, base(0.8f, 0.1f) + 0.02f);  // and the smooth one would be noticed
}

// Smooth, in closed form: the diffuse part keeps (1 - 1/42)^2 by its two factors 1 - (1-mu)^5 / 2,
// the interface reflects F0 + (1 - F0) / 21 of diffuse light, both means over cosines.
TEST(Materials, BurleysBaseKeepsTheLightOfAUniformSky) {
  const Number smooth{0.0f, {}, {}};
  const double diffuse = std::pow(1 - 1 / 42.0, 2), e = 0.04 + 0.96 / 21;
  for (const float c : {0.0f, 0.2f, 0.8f}) {
    EXPECT_NEAR(burley({Rgb(c), {}, {}}, 1.5, smooth, 0, 1).base.factor.x, c * diffuse / (1 - e),
                0.002);
    EXPECT_NEAR(burley({Rgb(c), {}, {}}, 1.5, smooth, 0, 0).base.factor.x, c * diffuse, 0.002);
    EXPECT_NEAR(burley({Rgb(c), {}, {}}, 1.5, smooth, 1, 1).base.factor.x, c, 0.002);  // metal
    const Material half = burley({Rgb(c), {}, {}}, 1.5, smooth, 0.5, 1);
    const double b = half.base.factor.x, mixed = 0.02 + 0.5 * b;  // F0 of a half metal
    const double reflected = mixed + (1 - mixed) / 21;
    EXPECT_NEAR(0.5 * b * (1 - reflected) + reflected,
                0.5 * (c * diffuse + e) + 0.5 * (c + (1 - c) / 21), 0.002);
  }
  EXPECT_GT(burley({Rgb(0.5f), {}, {}}, 1.5, {1.0f, {}, {}}, 0, 1).base.factor.x,
            burley({Rgb(0.5f), {}, {}}, 1.5, {0.3f, {}, {}}, 0, 1).base.factor.x);
}

std::string pfm(const std::string& head, std::initializer_list<float> values) {
  std::string bytes = head;
  for (const float v : values) bytes.append(reinterpret_cast<const char*>(&v), 4);
  return bytes;
}

TEST(Images, PfmRowsGoUpwards) {
  const Texels t = decode(pfm("PF\n1 2\n-1.0\n", {1, 2, 3, 4, 5, 6}), "a.pfm");
  EXPECT_FALSE(t.is_8bit);
  EXPECT_EQ(t.rgb.at(0).x, 4);  // the last row of the file is the upper one
  EXPECT_EQ(t.rgb.at(1).z, 3);
  EXPECT_EQ(decode(pfm("Pf\n1 1\n-1\n", {7}), "a.pfm").rgb.at(0).y, 7);
  EXPECT_TRUE(std::isnan(decode(pfm("Pf\n1 1\n-1\n", {NAN}), "a.pfm").rgb.at(0).y));
}

TEST(Images, WhatIsNoneIsRefused) {
  const std::string ppm = "P6\n2 2\n255\n" + std::string(12, 'x');
  // Grey, of one texel, as painting programs write it.
  std::string tga("\0\0\x03\0\0\0\0\0\0\0\0\0\x01\0\x01\0\x08\0\x33", 19);
  EXPECT_EQ(decode(ppm, "a.ppm").rgb.size(), 4u);
  EXPECT_TRUE(decode(tga, "a.tga").is_8bit);
  EXPECT_NEAR(decode(tga, "a.tga").rgb.at(0).x, 0.2, 1e-6);
  tga[14] = 20;
  for (const auto& [name, bytes, words] :
       std::vector<std::tuple<std::string, std::string, std::string>>{
           {"a.pfm", "PF\n2 2\n-1\n123", "is cut short"},
           {"a.pfm", "PF\nx 2\n-1\n", "the header of the PFM is damaged"},
           {"a.pfm", "PF\n99999 2\n-1\n", "is 99999 x 2 texels"},
           {"a.png", "abc", "is no picture"},
           {"a.hdr", "", "is empty"},
           {"a.png", "something else", "is no picture that can be read"},
           {"a.png", "\x89PNG\r\n\x1a\n broken", ": "},
           {"a.ppm", ppm.substr(0, 11), "is cut short: 11 bytes for 2 x 2"},
           {"a.tga", tga, "is cut short: 19 bytes for 1 x 20"}}) {
    const std::string said = complaint([&] { decode(bytes, name); });
    EXPECT_TRUE(said.starts_with(name + ": ")) << said;
    EXPECT_NE(said.find(words), std::string::npos) << said;
  }
}

std::string chunk(const std::string& type, const std::string& data) {
  return std::string{0, 0, 0, static_cast<char>(data.size())} + type + data + "CRC.";
}

TEST(Images, PngKeepsItsPixelsOnly) {
  const std::string head = "\x89PNG\r\n\x1a\n" + chunk("IHDR", "size and kind");
  const std::string tail = chunk("IDAT", "pixels") + chunk("IEND", "");
  EXPECT_EQ(plain_file(head + chunk("gAMA", "2.2!") + chunk("pHYs", "1:2") + tail), head + tail);
  const std::string cut = (head + tail).substr(0, head.size() + 14);
  EXPECT_EQ(plain_file(cut), cut);
}

TEST(Images, JpegBecomesSquare) {
  using namespace std::string_literals;
  const auto jfif = [](const std::string& density) {
    return "\xff\xe0\0\x10JFIF\0\1\2"s + density + "\0\0"s;
  };
  const std::string profile = "\xff\xe2\0\6ICC!"s, scan = "\xff\xda\0\4ab and pixels"s;
  EXPECT_EQ(plain_file("\xff\xd8"s + jfif("\1\0\x48\0\x96"s) + profile + scan),
            "\xff\xd8"s + jfif("\0\0\1\0\1"s) + scan);
}

}  // namespace tdpt::foreign::import_test
