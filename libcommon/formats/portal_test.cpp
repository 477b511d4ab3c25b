#include "libcommon/formats/portal.h"

#include <filesystem>
#include <fstream>
#include <limits>

#include <unistd.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/error.h"
#include "libcommon/testing/rooms/squares.h"

namespace tdpt::portal_test {

using Json = nlohmann::json;

class PortalFormat : public ::testing::Test {
 protected:
  PortalFormat()
      : folder_(std::filesystem::temp_directory_path() /
                ("portal_test." + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~PortalFormat() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& bytes) const {
    const std::string path = (folder_ / name).string();
    std::ofstream(path, std::ios::binary) << bytes;
    return path;
  }
  PortalFile read(const Json& gltf) const { return read_portals(write("p.gltf", gltf.dump())); }
  std::string message(const Json& gltf) const { return error_of(write("p.gltf", gltf.dump())); }
  static std::string error_of(const std::string& path) {
    try {
      read_portals(path);
    } catch (const InputError& e) {
      const std::string text = e.what();
      return text.substr(text.find(path) + path.size() + 1);
    }
    return "no error";
  }
  /// The messages are tested with the scene reader; here only their place matters.
  static std::string place_of(const std::string& message) {
    return message.substr(0, message.find(": "));
  }

  std::filesystem::path folder_;
};

std::string base64(const std::string& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t v = 0;
    for (size_t k = 0; k < 3; ++k)
      v = v << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : digits[v >> (18 - 6 * k) & 63];
  }
  return text;
}

// A unit square in the plane z = 0, front towards +z, as a modelling program writes it: four
// corners and two triangles with six 16-bit indices.
Json square(const std::vector<uint16_t>& indices = {0, 1, 2, 0, 2, 3}) {
  std::string data;
  for (const float f : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.f, 0.f, 0.f, 1.f, 0.f})
    data.append(reinterpret_cast<const char*>(&f), 4);
  for (const uint16_t i : indices) data.append(reinterpret_cast<const char*>(&i), 2);
  Json g;
  g["asset"]["version"] = "2.0";
  g["scenes"] = Json::parse(R"([{"nodes":[0]}])");
  g["nodes"] = Json::parse(R"([{"mesh":0,"name":"door"}])");
  g["meshes"] = Json::parse(R"([{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}])");
  g["accessors"] = Json::parse(
      R"([{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},
          {"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}])");
  g["bufferViews"] = Json::parse(R"([{"buffer":0,"byteLength":48},
                                     {"buffer":0,"byteOffset":48,"byteLength":12}])");
  g["buffers"][0] = {{"byteLength", data.size()},
                     {"uri", "data:application/octet-stream;base64," + base64(data)}};
  return g;
}

Vec3d area_vector(const Portal& p) {
  Vec3d sum{};
  for (const auto& t : p.triangles)
    sum += cross(p.vertices[t[1]] - p.vertices[t[0]], p.vertices[t[2]] - p.vertices[t[0]]) * 0.5;
  return sum;
}

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance = 1e-12) {
  EXPECT_LE(length(a - b), tolerance) << a.x << ' ' << a.y << ' ' << a.z;
}

TEST_F(PortalFormat, ComesBackAsItWasWritten) {
  PortalFile file;
  file.scene_hash = "0123";
  file.made_for = {"1.5 -2 0 0 0 -1 0 1 0 0.9 1.5 fronts the eye"};
  file.provenance.lines = {"made by portalfit 1: portalfit", "from room.vdb 77"};
  Portal a;
  a.vertices = {{1e6, 0, 0}, {1e6 + 1, 0, 0}, {1e6 + 1, 1, 0.25}, {1e6, 1, 0.25}};
  a.triangles = {{0, 1, 2}, {0, 2, 3}};
  a.figures = {{"area", 1.0307764064044151}, {"support", 0.97}};
  Portal b = a;
  b.triangles.pop_back();
  file.portals = {a, b};
  const std::string bytes = portal_bytes(file);
  const PortalFile back = read_portals(write("p.glb", bytes));
  ASSERT_EQ(back.portals.size(), 2u);
  EXPECT_EQ(back.portals[0].name, "portal.0");
  EXPECT_EQ(back.portals[1].name, "portal.1");
  EXPECT_EQ(back.portals[0].figures, a.figures);
  EXPECT_EQ(back.portals[0].triangles, a.triangles);
  EXPECT_EQ(back.portals[1].triangles, b.triangles);
  for (size_t i = 0; i < 4; ++i) expect_near(back.portals[0].vertices[i], a.vertices[i]);
  EXPECT_EQ(back.scene_hash, "0123");
  EXPECT_EQ(back.made_for, file.made_for);
  EXPECT_EQ(back.provenance.lines, file.provenance.lines);
  EXPECT_EQ(portal_bytes(back), bytes);
}

TEST_F(PortalFormat, KeepsWhichCamerasEachPortalServes) {
  PortalFile file = read(square());
  file.made_for = {"1.5 -2 0 0 0 -1 0 1 0 0.9 1.5 fronts the eye",
                   "0 0 0 0 0 -1 0 1 0 0.9 1.5 all yard"};
  file.portals.push_back(file.portals[0]);
  file.portals[1].cameras = {{"the eye", 0.5}, {"yard", 0.25}};
  const PortalFile back = read_portals(write("p.glb", portal_bytes(file)));
  EXPECT_EQ(back.made_for, file.made_for);
  EXPECT_TRUE(back.portals[0].cameras.empty());
  EXPECT_EQ(back.portals[1].cameras, file.portals[1].cameras);
}

TEST_F(PortalFormat, OneForBothWaysComesBackAsSuch) {
  PortalFile file;
  Portal one;
  one.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  one.triangles = {{0, 1, 2}};
  Portal both = one;
  both.both_ways = true;
  EXPECT_EQ(portal_bytes({{one}, {}, {}, {}}).find("doubleSided"), std::string::npos);
  const std::string bytes = portal_bytes({{one, both}, {}, {}, {}});
  const PortalFile back = read_portals(write("p.glb", bytes));
  EXPECT_FALSE(back.portals.at(0).both_ways);
  EXPECT_TRUE(back.portals.at(1).both_ways);
  EXPECT_EQ(portal_bytes(back), bytes);
}

TEST_F(PortalFormat, CountsWhatPortalsDoNotNeed) {
  Json g = square();
  EXPECT_EQ(read(g).cameras + read(g).lamps, 0u);
  g["cameras"] = Json::parse(R"([{"type":"perspective","perspective":{"yfov":1,"znear":0.1}}])");
  g["materials"] = Json::parse(R"([{"emissiveFactor":[0,0,0.5]},{"emissiveFactor":[0,0,0]},{}])");
  EXPECT_EQ(read(g).cameras, 1u);
  EXPECT_EQ(read(g).lamps, 1u);
  g["extensionsUsed"] = {"KHR_lights_punctual"};
  g["extensions"]["KHR_lights_punctual"]["lights"] = Json::parse(R"([{"type":"point"}])");
  EXPECT_EQ(read(g).lamps, 2u);
  g["extensions"]["EXT_lights_area"]["lights"] = Json::parse(R"([{"type":"disk"}])");
  EXPECT_EQ(read(g).lamps, 3u);
}

// Blender writes doubleSided unless backface culling is on.
TEST_F(PortalFormat, ADoubleSidedMaterialLetsLightPassBothWays) {
  Json g = square();
  g["meshes"][0]["primitives"][0]["material"] = 1;
  g["materials"] = Json::parse(R"([{"doubleSided":true},{"name":"Material"}])");
  EXPECT_FALSE(read(g).portals.at(0).both_ways);
  g["meshes"][0]["primitives"][0]["material"] = 0;
  EXPECT_TRUE(read(g).portals.at(0).both_ways);
  // One double-sided primitive of two is enough; lines have no sides.
  g["meshes"][0]["primitives"].push_back(g["meshes"][0]["primitives"][0]);
  g["meshes"][0]["primitives"][0]["material"] = 1;
  EXPECT_TRUE(read(g).portals.at(0).both_ways);
  g["meshes"][0]["primitives"][1]["mode"] = 1;
  EXPECT_FALSE(read(g).portals.at(0).both_ways);
  g["meshes"][0]["primitives"][0]["material"] = 2;
  EXPECT_EQ(place_of(message(g)), "meshes[0].primitives[0].material");
  g["meshes"][0]["primitives"][0]["material"] = 0;
  g["materials"][0]["doubleSided"] = "yes";
  EXPECT_EQ(place_of(message(g)), "materials[0].doubleSided");
}

TEST_F(PortalFormat, NoPortalIsAFileToo) {
  const PortalFile back = read_portals(write("p.glb", portal_bytes({})));
  EXPECT_TRUE(back.portals.empty());
}

TEST_F(PortalFormat, ReadsWhatAModellingProgramWrites) {
  const PortalFile file = read(square());
  ASSERT_EQ(file.portals.size(), 1u);
  EXPECT_EQ(file.portals[0].name, "door");
  EXPECT_TRUE(file.scene_hash.empty());
  EXPECT_TRUE(file.made_for.empty());
  Json g = square();
  g["asset"]["extras"]["camera"] = "a Leica";  // another program's use of the name
  EXPECT_TRUE(read_portals(write("p.gltf", g.dump())).made_for.empty());
  expect_near(area_vector(file.portals[0]), {0, 0, 1});
}

TEST_F(PortalFormat, ReadsWhatIsCompressed) {
  for (const testing::GlbBuilder& b : {testing::square_by_draco(), testing::square_by_meshopt()}) {
    const PortalFile file = read_portals(write("p.glb", b.glb()));
    ASSERT_EQ(file.portals.size(), 1u);
    expect_near(area_vector(file.portals[0]), {0, 0, 1});
  }
}

TEST_F(PortalFormat, AppliesNodeTransforms) {
  Json g = square();
  // Quarter turn about x, then scale by 2, then translation; inside a parent with another
  // translation.
  g["nodes"] = Json::parse(R"([{"children":[1],"translation":[0,0,5]},
      {"mesh":0,"rotation":[0.7071067811865476,0,0,0.7071067811865476],"scale":[2,2,2],
       "translation":[1,0,0]}])");
  const Portal p = read(g).portals.at(0);
  expect_near(area_vector(p), {0, -4, 0});
  expect_near(p.vertices[0], {1, 0, 5});
  expect_near(p.vertices[2], {3, 0, 7});
  g["nodes"] = Json::parse(R"([{"mesh":0,"matrix":[0,1,0,0, 0,0,1,0, 1,0,0,0, 7,8,9,1]}])");
  expect_near(area_vector(read(g).portals.at(0)), {1, 0, 0});
}

TEST_F(PortalFormat, MirroringKeepsTheFrontSide) {
  Json g = square();
  g["nodes"] = Json::parse(R"([{"mesh":0,"scale":[-1,1,1]}])");
  expect_near(area_vector(read(g).portals.at(0)), {0, 0, 1});
  g["nodes"] = Json::parse(R"([{"mesh":0,"scale":[1,1,-1]}])");
  expect_near(area_vector(read(g).portals.at(0)), {0, 0, -1});
}

TEST_F(PortalFormat, ReadsStripsFansAndPlainCorners) {
  Json g = square();
  g["meshes"][0]["primitives"][0]["mode"] = 6;
  g["meshes"][0]["primitives"][0].erase("indices");
  expect_near(area_vector(read(g).portals.at(0)), {0, 0, 1});
  g = square({0, 1, 3, 2, 2, 2});
  g["meshes"][0]["primitives"][0]["mode"] = 5;
  expect_near(area_vector(read(g).portals.at(0)), {0, 0, 1});
  g = square();
  g["meshes"][0]["primitives"][0].erase("indices");
  EXPECT_EQ(read(g).portals.at(0).triangles.size(), 1u);  // four corners: one triangle, one left
}

TEST_F(PortalFormat, EveryMeshNodeIsAPortal) {
  Json g = square();
  g["nodes"] = Json::parse(R"([{"mesh":0},{"mesh":0,"translation":[5,0,0]},{"name":"empty"}])");
  g.erase("scenes");
  const PortalFile file = read(g);
  ASSERT_EQ(file.portals.size(), 2u);
  EXPECT_EQ(file.portals[1].name, "portal.1");
  expect_near(file.portals[1].vertices[0], {5, 0, 0});
}

TEST_F(PortalFormat, ReadsABufferBesideIt) {
  Json g = square();
  const float data[12] = {0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0};
  write("a b.bin", std::string(reinterpret_cast<const char*>(data), sizeof data) +
                       std::string("\0\0\1\0\2\0\0\0\2\0\3\0", 12));
  g["buffers"][0]["uri"] = "a%20b.bin";
  expect_near(area_vector(read(g).portals.at(0)), {0, 0, 2});
  g["buffers"][0]["uri"] = "../etc/passwd";
  EXPECT_EQ(place_of(message(g)), "buffers[0].uri");
  g["buffers"][0]["uri"] = "/etc/passwd";
  EXPECT_EQ(place_of(message(g)), "buffers[0].uri");
  g["buffers"][0]["uri"] = "file:///etc/passwd";
  EXPECT_EQ(place_of(message(g)), "buffers[0].uri");
}

TEST_F(PortalFormat, RefusesWhatReachesTooFar) {
  Json g = square();
  g["accessors"][0]["count"] = 5;
  EXPECT_EQ(place_of(message(g)), "accessors[0]");
  g["accessors"][0]["count"] = 0x7fffffffffffffffull;
  EXPECT_EQ(place_of(message(g)), "accessors[0].count");
  g = square();
  g["accessors"][0]["byteOffset"] = 0xfffffffffffffff0ull;
  EXPECT_EQ(place_of(message(g)), "accessors[0].byteOffset");
  g = square();
  g["bufferViews"][1]["byteOffset"] = 0xffffffffffffffffull;
  EXPECT_EQ(place_of(message(g)), "bufferViews[1].byteOffset");
  g = square();
  g["bufferViews"][0]["byteStride"] = 4;
  EXPECT_EQ(place_of(message(g)), "accessors[0]");
  g = square();
  g["buffers"][0]["byteLength"] = 1000;
  EXPECT_EQ(place_of(message(g)), "buffers[0]");
  g = square();
  g["accessors"][0]["count"] = 3;
  EXPECT_EQ(place_of(message(g)), "accessors[1]");
}

// A few bytes may instance a mesh many times, and reference its numbers many times.
TEST_F(PortalFormat, RefusesWhatStandsTooOften) {
  Json g = square();
  const Json primitive = g["meshes"][0]["primitives"][0], node = g["nodes"][0];
  for (int i = 1; i < 1001; ++i) g["meshes"][0]["primitives"].push_back(primitive);
  for (int i = 1; i < 500; ++i) {
    g["nodes"].push_back(node);
    g["scenes"][0]["nodes"].push_back(i);
  }
  EXPECT_EQ(message(g),
            "meshes[0].primitives[501]: more than 1000000 triangles, too many for portals");
  g["meshes"][0]["primitives"][0]["mode"] = 5;  // a strip with two more; one has an area
  for (int i = 1; i < 1001; ++i) g["meshes"][0]["primitives"][i]["indices"] = 2;
  g["accessors"].push_back(
      {{"bufferView", 1}, {"componentType", 5123}, {"count", 3}, {"type", "SCALAR"}});
  for (int i = 500; i < 1000; ++i) {
    g["nodes"].push_back(node);
    g["scenes"][0]["nodes"].push_back(i);
  }
  EXPECT_EQ(message(g),
            "meshes[0].primitives[251]: more than 3000000 vertices, too many for portals");
}

TEST_F(PortalFormat, RefusesWhatIsNotThere) {
  Json g = square();
  g["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 7;
  EXPECT_EQ(place_of(message(g)), "meshes[0].primitives[0].attributes.POSITION");
  g["meshes"][0]["primitives"][0]["attributes"] = Json::object();
  EXPECT_EQ(place_of(message(g)), "meshes[0].primitives[0]");
  g = square();
  g["nodes"][0]["mesh"] = -1;
  EXPECT_EQ(place_of(message(g)), "nodes[0].mesh");
  g["nodes"][0]["mesh"] = 3;
  EXPECT_EQ(place_of(message(g)), "nodes[0].mesh");
  g = square();
  g["scenes"][0]["nodes"] = {4};
  EXPECT_EQ(place_of(message(g)), "scenes[0].nodes[0]");
  g = square();
  g["nodes"] = Json::parse(R"([{"children":[1]},{"children":[0]}])");
  EXPECT_EQ(place_of(message(g)), "nodes[0]");
  g = square();
  g["accessors"][0].erase("bufferView");
  EXPECT_EQ(place_of(message(g)), "nodes[0]");
  g = square();
  g["accessors"][0]["type"] = "VEC2";
  EXPECT_EQ(place_of(message(g)), "accessors[0].type");
  g = square();
  g["accessors"][0]["componentType"] = 5124;
  EXPECT_EQ(place_of(message(g)), "accessors[0].componentType");
  g = square();
  g["accessors"][0]["sparse"] = Json::object();
  EXPECT_EQ(place_of(message(g)), "accessors[0].sparse.count");
  g = square();
  g["buffers"][0].erase("uri");
  EXPECT_EQ(place_of(message(g)), "buffers[0]");
  g["buffers"][0]["uri"] = "data:;base64,????";
  EXPECT_EQ(place_of(message(g)), "buffers[0].uri");
  g = square();
  g["nodes"] = Json("none");
  EXPECT_EQ(place_of(message(g)), "nodes");
  g = square();
  g["meshes"][0]["primitives"][0]["mode"] = 9;
  EXPECT_EQ(place_of(message(g)), "meshes[0].primitives[0].mode");
  g = square();
  g["extensionsRequired"] = {"ACME_unknown"};
  EXPECT_EQ(place_of(message(g)), "extensionsRequired");
}

TEST_F(PortalFormat, RefusesNotANumber) {
  Json g = square();
  const float nan[12] = {0, 0, 0, 1, 0, 0, std::numeric_limits<float>::quiet_NaN()};
  const std::string data = std::string(reinterpret_cast<const char*>(nan), sizeof nan) +
                           std::string("\0\0\1\0\2\0\0\0\2\0\3\0", 12);
  g["buffers"][0]["uri"] = "data:;base64," + base64(data);
  EXPECT_EQ(place_of(message(g)), "accessors[0]");
  g = square();
  g["nodes"][0]["translation"] = {1, "x", 2};
  EXPECT_EQ(place_of(message(g)), "nodes[0].translation[1]");
  g = square();
  g["nodes"][0]["rotation"] = {0, 0, 0, 0};
  EXPECT_EQ(place_of(message(g)), "nodes[0].rotation");
}

TEST_F(PortalFormat, DropsTrianglesWithoutArea) {
  Json g = square();
  g["nodes"][0]["scale"] = {1, 0, 1};
  EXPECT_EQ(message(g), "nodes[0]: has no triangle with an area");
  g = square();
  g["meshes"][0]["primitives"][0]["mode"] = 1;  // lines
  EXPECT_EQ(message(g), "nodes[0]: has no triangle with an area");
}

TEST_F(PortalFormat, RefusesAnotherVersion) {
  std::string glb = portal_bytes({});
  const std::string key = "\"tdpt_portal_format\":";
  const size_t at = glb.find(key + "1");
  ASSERT_NE(at, std::string::npos);
  glb[at + key.size()] = '2';
  EXPECT_EQ(error_of(write("p", glb)),
            "asset.extras.tdpt_portal_format: this file has version 2 of the format; this program "
            "reads version 1");
  Json g = square();
  g["asset"]["extras"]["tdpt_portal_format"] = 1;
  EXPECT_EQ(message(g), "no error");
  g["asset"]["extras"]["tdpt_portal_format"] = "one";
  EXPECT_EQ(place_of(message(g)), "asset.extras.tdpt_portal_format");
}

TEST_F(PortalFormat, RefusesWhatIsNoGltf) {
  EXPECT_NE(error_of(write("p", "")), "no error");
  EXPECT_NE(error_of(write("p", "[1]")), "no error");
  EXPECT_EQ(place_of(error_of(write("p", "{}"))), "asset");
  EXPECT_EQ(place_of(error_of(write("p", R"({"asset":{"version":"1.0"}})"))), "asset.version");
  std::string glb = portal_bytes({});
  glb[4] = 1;
  EXPECT_EQ(place_of(error_of(write("p", glb))), "header");
}

// Every prefix of a valid file and every single changed byte is either read or refused.
TEST_F(PortalFormat, SurvivesDamage) {
  PortalFile file;
  Portal a;
  a.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  a.triangles = {{0, 1, 2}};
  file.portals = {a};
  const std::string good = portal_bytes(file);
  const std::string path = (folder_ / "damaged").string();
  const auto attempt = [&](const std::string& bytes) {
    write("damaged", bytes);
    try {
      for (const Portal& p : read_portals(path).portals)
        for (const auto& t : p.triangles)
          for (const uint32_t v : t) ASSERT_LT(v, p.vertices.size());
    } catch (const InputError&) {
    }
  };
  for (size_t n = 0; n < good.size(); n += 31) attempt(good.substr(0, n));
  for (size_t n = 0; n < good.size(); n += 9) {
    std::string bad = good;
    for (const unsigned char change : {0x01, 0xff}) {
      bad[n] = static_cast<char>(good[n] ^ change);
      attempt(bad);
    }
  }
}

TEST(Drawback, IsWhatTheFiguresSayAgainstAPortal) {
  EXPECT_EQ(drawback_of({}), "");
  EXPECT_EQ(drawback_of({{"tightness", 0.05}, {"conductance", 0.08}}), "");
  EXPECT_EQ(drawback_of({{"tightness", 0.001}}),
            "0.1 % of the lines through it pass from one side to the other");
  EXPECT_EQ(drawback_of({{"tightness", 1}, {"conductance", 0.2}}),
            "a wide way, 20 % of the smaller side's light finds it alone");
  EXPECT_EQ(drawback_of({{"conductance", 1}}),
            "a wide way, 100 % of the smaller side's light finds it alone");
}

// Only figures, no statement about a picture.
TEST(WorthSentence, SaysWhatIsKnown) {
  EXPECT_EQ(worth_sentence({}, 0.25), "0.25 m2");
  EXPECT_EQ(worth_sentence({}, 23456), "23460 m2");
  EXPECT_EQ(worth_sentence({{"area", 0.0625}, {"tightness", 0.71}, {"conductance", 0.0021}}, 9),
            "0.0625 m2, tightness 0.71, conductance 0.0021");
  EXPECT_EQ(worth_sentence({{"conductance", 0.2}}, 1),
            "1 m2, conductance 0.2: a wide way, 20 % of the smaller side's light finds it alone");
}

}  // namespace tdpt::portal_test
