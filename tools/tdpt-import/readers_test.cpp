// Sources of the three formats and what they become: the tables testdata/import/*.case, whose
// README tells how they are written.
#include "tools/tdpt-import/described.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "libcommon/testing/files/temp_folder.h"
#include "tools/tdpt-import/meshes/meshes.h"

namespace tdpt::foreign::readers_test {

constexpr double kDegrees = 180 / std::numbers::pi;

// ---- a description in words: what is as in a fresh object is left out

std::string word(double v, int digits = 4) {
  return fmt::format("{:.{}g}", std::abs(v) < 5e-7 ? 0 : v, digits);
}
std::string words(const Vec3d& v, int digits = 4) {
  return word(v.x, digits) + " " + word(v.y, digits) + " " + word(v.z, digits);
}
std::string words(const Rgb& c) {
  const std::string all = words(Vec3d(c));
  return all == words(Vec3d(c.x)) ? word(c.x) : all;
}
std::string words(const Texture& t) {
  const char* wraps[] = {"", " mirror", " clamp"};
  std::string s = fmt::format("image {}", t.image);
  s += wraps[static_cast<int>(t.wrap_u)];
  if (t.wrap_v != t.wrap_u) s += " but v" + std::string(wraps[static_cast<int>(t.wrap_v)]);
  if (t.nearest) s += " nearest";
  if (!t.srgb) s += " raw";
  if (t.luminance) s += " luminance";
  if (t.alpha) s += " alpha";
  if (t.map != Texture{}.map) {
    s += " map";
    for (const double m : t.map) s += " " + word(m);
  }
  return s + (t.green_down ? " green down" : "");
}
// Curves are shown by what they make of 0.2, 0.4 and 0.6.
std::string words(const Colour& c) {
  if (!c.texture) return words(c.factor);
  std::string s = words(*c.texture);
  if (c.factor != Rgb(1)) s = words(c.factor) + " x " + s;
  if (c.curve) s += " through " + words(c.curve({0.2f, 0.4f, 0.6f}));
  return s;
}
std::string words(const Number& n) {
  const auto curve = [&](const Rgb& c) { return Rgb(n.curve(c.x), n.curve(c.y), n.curve(c.z)); };
  Colour c{Rgb(n.factor), n.texture, {}};
  if (n.curve) c.curve = curve;
  return words(c);
}
std::string words(const Material& m) {
  std::string s;
  const auto add = [&s](bool shown, const std::string& name, const std::string& value) {
    if (shown) s += ", " + name + (value.empty() ? "" : " ") + value;
  };
  add(words(m.base) != "1", "base", words(m.base));
  add(m.metallic > 0, "metallic", word(m.metallic));
  add(words(m.roughness) != "1", "roughness", words(m.roughness));
  add(m.specular > 0, "specular", word(m.specular));
  add(m.specular_colour != Rgb(1), "of colour", words(m.specular_colour));
  add(m.ior != 1.5f, "ior", word(m.ior));
  add(m.transmission > 0, m.solid ? "solid glass" : "sheet of glass", "");
  add(m.attenuation != Rgb(1), "attenuation", words(m.attenuation));
  if (m.eta_k) add(true, "eta " + words((*m.eta_k)[0]) + " k", words((*m.eta_k)[1]));
  add(m.coat > 0, "coat", word(m.coat));
  add(m.coat_roughness > 0, "coat's roughness", word(m.coat_roughness));
  add(words(m.opacity) != "1", "opacity", words(m.opacity));
  if (m.normal) add(true, "normal", words(*m.normal));
  if (m.bump) add(true, "bump", words(*m.bump));
  add(m.tinted, "tinted", "");
  add(m.invisible, "invisible", "");
  return s.empty() ? "as new" : s.substr(2);
}

// Its box in the world, in three digits, as round shapes are larger than their name says; the
// front, coordinates and normal of its first corner.
std::string words(const Shape& shape, const Mesh& mesh) {
  const auto at = [&](uint32_t i) { return shape.to_world.point(in_double(mesh.positions[i])); };
  Vec3d low(INFINITY), high(-INFINITY);
  for (uint32_t i = 0; i < mesh.positions.size(); ++i)
    low = min(low, at(i)), high = max(high, at(i));
  const auto& [a, b, c] = mesh.triangles.at(0);
  const Vec3d n = normalize(cross(at(b) - at(a), at(c) - at(a)));
  std::string s = words((low + high) * 0.5, 3) + " of " + words(high - low, 3);
  const bool few = mesh.triangles.size() < 3;
  if (few) s += ", front " + words(shape.to_world.mirrors() != shape.turned ? -n : n);
  if (!few && shape.turned) s += ", turned";
  if (!mesh.uv.empty()) s += ", uv " + word(mesh.uv[a][0]) + " " + word(mesh.uv[a][1]);
  if (few && !mesh.normals.empty()) s += ", normal " + words(in_double(mesh.normals[a]));
  if (shape.material > 0) s += fmt::format(", material {}", shape.material);
  if (!shape.emission) return s;
  return s + ", emits " + words(shape.emission->radiance) +
         (shape.emission->both_sides ? " on both sides" : "");
}
std::string words(const Camera& c) {
  std::string s = fmt::format("at {}, ahead {}, up {}", words(c.to_world.t), words(-c.to_world.z),
                              words(c.to_world.y));
  if (c.to_world.mirrors()) s += ", mirrored";
  s += fmt::format(", {} degrees high, {} x {}", word(c.yfov * kDegrees), c.width, c.height);
  if (c.shift_x != 0 || c.shift_y != 0) s += ", shift " + word(c.shift_x) + " " + word(c.shift_y);
  if (c.lens_radius > 0) s += ", lens " + word(c.lens_radius) + " focus " + word(c.focus_distance);
  return s;
}
std::string words(const Lamp& l) {
  if (l.kind == Lamp::Kind::point) return "point at " + words(l.at) + " of " + words(l.intensity);
  const std::string s = words(normalize(l.towards)) + " of " + words(l.intensity);
  if (l.kind == Lamp::Kind::sun) return "sun towards " + s;
  return fmt::format("spot at {} towards {} in {} to {} degrees", words(l.at), s,
                     word(l.inner * kDegrees), word(l.outer * kDegrees));
}
// Where the scene's axes are in the map: u and v from the upper left, or directions of its frame.
std::string words(const Sky& sky) {
  std::string s = words(sky.colour);
  if (sky.image) s += fmt::format(" x image {}{}", *sky.image, sky.srgb ? "" : " raw");
  const bool round = sky.layout == Sky::Layout::latlong;
  if (!round) s += ", octahedral";
  if (round && !sky.image) return s;
  const std::pair<const char*, Vec3d> axes[] = {
      {"x", {1, 0, 0}}, {"y", {0, 1, 0}}, {"z", {0, 0, 1}}};
  for (const auto& [name, axis] : axes) {
    const Vec3d d = sky.to_map.vector(axis);
    double u = 0.5 + std::atan2(d.x, -d.z) / (2 * std::numbers::pi);
    u -= std::floor(u + 1e-6);
    const double v = std::acos(d.y) / std::numbers::pi;
    s += fmt::format(", {} at ", name) + (!round              ? words(d)
                                          : std::abs(d.y) < 1 ? word(u) + " " + word(v)
                                          : d.y > 0           ? "the top"
                                                              : "the bottom");
  }
  return s;
}

std::vector<std::string> lines_of(const Described& d) {
  std::string names = "names:";
  for (const Material& m : d.materials) names += " " + m.name;
  std::vector<std::string> lines{fmt::format("meshes: {}", d.meshes.size()), names};
  for (const Camera& c : d.cameras) lines.push_back("camera: " + words(c));
  for (const Shape& s : d.shapes) lines.push_back("shape: " + words(s, d.meshes.at(s.mesh)));
  for (const Shape& p : d.portals) lines.push_back("portal: " + words(p, d.meshes.at(p.mesh)));
  for (const Material& m : d.materials) lines.push_back("material: " + words(m));
  for (const Lamp& l : d.lamps) lines.push_back("lamp: " + words(l));
  if (d.sky) lines.push_back("sky: " + words(*d.sky));
  for (const Image& i : d.images) {
    std::string texels = "image: " + i.name;
    for (const Rgb& t : i.texels) texels += ", " + words(t);
    lines.push_back(texels);
  }
  return lines;
}

// ---- the tables

using Parameters = std::map<std::string, std::string>;
using Reader = std::function<Described(Source&, const Parameters&)>;

// What a source becomes, line by line.
std::vector<std::string> read(const Reader& reader, const std::string& path,
                              const Parameters& parameters) {
  std::vector<std::string> lines;
  try {
    Source source(path);
    lines = lines_of(reader(source, parameters));
    source.lose_unread();
    for (const Source::Loss& loss : source.losses())
      lines.push_back("lost: " + loss.first.where + ": " + loss.sentence);
  } catch (const Error& e) {
    const std::string message = e.what();
    lines = {"refused: " + message.substr(message.find(path) == 0 ? path.size() + 1 : 0)};
  }
  return lines;
}

std::string kind_of(const std::string& line) {
  return line.substr(0, line.find(':'));
}

// Nothing if all lines of the kinds that are expected are as expected, and what is lost or refused
// has the words; otherwise all that was found.
std::string difference(const std::vector<std::string>& expected,
                       const std::vector<std::string>& found) {
  std::set<std::string> kinds{"lost", "refused"};
  for (const std::string& line : expected) kinds.insert(kind_of(line));
  std::vector<std::string> asked;
  std::string all;
  for (const std::string& line : found) {
    all += "\n> " + line;
    if (kinds.contains(kind_of(line))) asked.push_back(line);
  }
  const auto same = [](const std::string& line, const std::string& words) {
    const std::string kind = kind_of(words);
    if (kind != "lost" && kind != "refused") return line == words;
    return kind == kind_of(line) && line.find(words.substr(kind.size() + 2)) != line.npos;
  };
  return std::equal(asked.begin(), asked.end(), expected.begin(), expected.end(), same) ? "" : all;
}

void expect(const std::vector<std::string>& expected, const std::vector<std::string>& found) {
  const std::string all = difference(expected, found);
  if (!all.empty()) ADD_FAILURE() << "found instead:" << all;
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (size_t at = 0; (at = text.find(what, at)) != text.npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

std::string gzipped(std::string bytes) {
  z_stream z{};
  EXPECT_EQ(deflateInit2(&z, 9, Z_DEFLATED, 31, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string packed(bytes.size() + 100, 0);
  z.next_in = reinterpret_cast<Bytef*>(bytes.data());
  z.avail_in = static_cast<uInt>(bytes.size());
  z.next_out = reinterpret_cast<Bytef*>(packed.data());
  z.avail_out = static_cast<uInt>(packed.size());
  EXPECT_EQ(deflate(&z, Z_FINISH), Z_STREAM_END);
  packed.resize(z.total_out);
  deflateEnd(&z);
  return packed;
}

// Files that sources name.
void write_files(const testing::TempFolder& folder) {
  folder.write("square.obj",
               "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
               "f 1/1 2/2 3/3 4/4\n");
  folder.write("back.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nvn 0 0 -1\nf 1//1 2//1 3//1\n");
  folder.write("corner.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 4 2\n");
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty float u\nproperty float v\nelement face 1\nproperty list "
      "uchar int vertex_indices\nend_header\n0 0 0 0 0.25\n1 0 0 1 0\n0 1 0 0 1\n3 0 1 2\n";
  folder.write("a.ply", ply);
  folder.write("packed.ply.gz", gzipped(ply));
  folder.write("cut.ply.gz", gzipped(ply).substr(0, 80));
  folder.write("parts/ball.xml", "<scene version='3.0.0'>\n<shape type='sphere'/></scene>");
  folder.write("parts/box.xml", "<shape version='3.0.0' type='cube'/>");
  folder.write("loop.xml", "<scene version='3.0.0'><include filename='loop.xml'/></scene>");
  folder.write("parts/moved.pbrt", "Translate 0 0 1\n");
  folder.write("parts/mark.pbrt", "\xEF\xBB\xBF# a byte order mark\n");
  folder.write("parts/broken.pbrt", "Translate 0 0 1\nBroken");
  folder.write("wood.png", "not decoded here");
  folder.write("sky.exr", "not decoded here");
  folder.write("red.pfm", std::string("PF\n1 1\n-1\n\0\0\x80\x3f\0\0\0\0\0\0\0\0", 22));
  folder.write("grey.pfm", std::string("Pf\n1 1\n-1\n\0\0\x80\x3f", 14));
  folder.write("rgb.ppm", "P6 1 1 255\nabc");
  const std::string tga("\0\0\x02\0\0\0\0\0\0\0\0\0\x01\0\x01\0", 16);
  folder.write("red.tga", tga + std::string("\x18\x20\0\0\xff", 5));
  folder.write("half.tga", tga + std::string("\x20\x28\0\0\xff\x80", 6));
}

// A table, testdata/import/NAME.case, line by line.
class Table {
 public:
  Table(const std::string& name, Reader reader, std::string unheard)
      : name_(name), reader_(std::move(reader)), unheard_(std::move(unheard)) {
    write_files(folder_);
    std::ifstream table(TDPT_TESTDATA "/import/" + name + ".case");
    for (std::string line; std::getline(table, line); ++number_) take(line);
    finish();
    EXPECT_GT(asked_, 50u) << "sources of " << name;
  }

 private:
  void take(const std::string& line) {
    const bool is_expected = line.starts_with("> ");
    if (!is_expected && told_) finish();
    if (line.empty() || line.starts_with("# ")) return;
    if (is_expected) {
      told_ = true;
      if (line != "> nothing") expected_.push_back(line.substr(2));
    } else if (line.starts_with("= ")) {
      const size_t end = line.find(' ', 2);
      words_[line.substr(2, end - 2)] = replaced(line.substr(end + 1), "\\n", "\n");
    } else if (line.starts_with("--- ")) {
      around_.clear(), parameters_.clear();
      std::istringstream head(line.substr(4, line.find(": ") - 4));
      for (std::string word; head >> word;)
        if (const size_t equals = word.find('='); equals != word.npos)
          parameters_[word.substr(0, equals)] = word.substr(equals + 1);
        else
          around_.push_back(word);
    } else {
      source_ += line + "\n";
    }
  }
  // Asks what stands above.
  void finish() {
    for (const std::string& around : around_) {
      SCOPED_TRACE(fmt::format("{}.case:{}: {} in {}", name_, number_, source_, around));
      std::string whole = replaced(words_.at(around), "...", source_);
      for (const auto& [word, text] : words_)
        if (std::isupper(word[0])) whole = replaced(whole, word, text);
      const auto becomes = [&](const std::string& text) {
        return read(reader_, folder_.write("scene." + name_, text), parameters_);
      };
      expect(expected_, becomes(replaced(whole, "@", "")));
      for (size_t at = 0; (at = whole.find('@', at)) != whole.npos; ++at)
        expect({"lost: unheard"}, becomes(replaced(whole.substr(0, at), "@", "") + unheard_ +
                                          replaced(whole.substr(at + 1), "@", "")));
      ++asked_;
    }
    expected_.clear(), source_.clear(), told_ = false;
  }

  const std::string name_;
  const Reader reader_;
  const std::string unheard_;  // what @ stands for, one at a time
  const testing::TempFolder folder_;
  size_t number_ = 0, asked_ = 0;
  Parameters words_, parameters_;
  std::vector<std::string> around_, expected_;
  std::string source_;
  bool told_ = false;
};

Described by_pbrt(Source& source, const Parameters&) {
  return read_pbrt(source);
}
Described by_tungsten(Source& source, const Parameters&) {
  return read_tungsten(source);
}

TEST(Readers, MitsubasScenesBecomeWhatTheirTableSays) {
  Table("mitsuba", read_mitsuba, "<float name='unheard' value='1'/>");
}
TEST(Readers, PbrtsScenesBecomeWhatTheirTableSays) {
  Table("pbrt", by_pbrt, "\"float unheard\" [1]");
}
TEST(Readers, TungstensScenesBecomeWhatTheirTableSays) {
  Table("tungsten", by_tungsten, "\"unheard\": {\"of\": {}}, ");
}

// Twin: a wrong number, a loss that is not named and one too many are seen.
TEST(Readers, TwinATableThatIsWrongIsSeen) {
  const std::vector<std::string> found{"meshes: 1", "sky: 2", "lost: line 1: fog"};
  EXPECT_EQ(difference({"sky: 2", "lost: fog"}, found), "");
  for (const std::vector<std::string>& wrong : std::vector<std::vector<std::string>>{
           {"sky: 3", "lost: fog"}, {"sky: 2"}, {"lost: smoke"}, {"lost: fog", "lost: fog"}, {}})
    EXPECT_NE(difference(wrong, found), "");
}

std::string repeated(size_t times, const std::string& text) {
  std::string all;
  for (size_t i = 0; i < times; ++i) all += text;
  return all;
}

TEST(Readers, DepthsAndNumbersWithoutEndAreRefused) {
  const testing::TempFolder folder;
  const auto expect_refused = [&](const Reader& reader, const std::string& text,
                                  const std::string& words) {
    const std::string found = read(reader, folder.write("scene", text), {}).at(0);
    EXPECT_EQ(kind_of(found), "refused");
    EXPECT_NE(found.find(words), found.npos) << found;
  };
  const std::string masks = "<scene version='3'>" + repeated(100000, "<bsdf type='mask'>");
  expect_refused(read_mitsuba, masks, "");
  expect_refused(read_mitsuba, masks + repeated(100000, "</bsdf>") + "</scene>", "too deeply");
  const std::string world = "WorldBegin ";
  expect_refused(by_pbrt, world + repeated(10001, "AttributeBegin "), "more than 10000 states");
  expect_refused(by_pbrt,
                 world + "ObjectBegin \"a\" " + repeated(1001, "Shape \"sphere\" ") + "ObjectEnd " +
                     repeated(1000, "ObjectInstance \"a\" "),
                 "more than 1000000 shapes");
  expect_refused(by_pbrt,
                 world + "Texture \"t\" \"float\" \"constant\" " +
                     repeated(200, "Texture \"t\" \"float\" \"scale\" \"texture tex\" \"t\" "),
                 "more than 100 deep");
}

}  // namespace tdpt::foreign::readers_test
