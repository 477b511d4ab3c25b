#include "libcommon/formats/portal.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "libcommon/testing/files/refusal.h"
#include "libcommon/testing/files/temp_folder.h"
#include "libcommon/testing/rooms/squares.h"

namespace tdpt::portal_test {

using Json = nlohmann::ordered_json;

PortalFile read_bytes(const std::string& bytes) {
  const testing::TempFolder folder;
  return read_portals(folder.write("p", bytes));
}
PortalFile read(const Json& gltf) {
  return read_bytes(gltf.dump());
}

// A unit square in the plane z = 0, front towards +z, as a modelling program writes it: four
// corners and two triangles with six 16-bit indices.
Json square(const std::vector<uint16_t>& indices = {0, 1, 2, 0, 2, 3}) {
  testing::GlbBuilder b;
  const int position = b.floats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, 3);
  const int index = b.indices_u16(indices);
  b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", position}}}, {"indices", index}})},
          {"name", "door"}});
  return Json::parse(b.gltf());
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

TEST(PortalFormat, ComesBackAsItWasWritten) {
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
  const PortalFile back = read_bytes(bytes);
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

TEST(PortalFormat, KeepsWhichCamerasEachPortalServes) {
  EXPECT_TRUE(read_bytes(portal_bytes({})).portals.empty()) << "there may be none";
  PortalFile file = read(square());
  file.made_for = {"1.5 -2 0 0 0 -1 0 1 0 0.9 1.5 fronts the eye",
                   "0 0 0 0 0 -1 0 1 0 0.9 1.5 all yard"};
  file.portals.push_back(file.portals[0]);
  file.portals[1].cameras = {{"the eye", 0.5}, {"yard", 0.25}};
  const PortalFile back = read_bytes(portal_bytes(file));
  EXPECT_EQ(back.made_for, file.made_for);
  EXPECT_TRUE(back.portals[0].cameras.empty());
  EXPECT_EQ(back.portals[1].cameras, file.portals[1].cameras);
}

TEST(PortalFormat, OneForBothWaysComesBackAsSuch) {
  PortalFile file;
  Portal one;
  one.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}};
  one.triangles = {{0, 1, 2}};
  Portal both = one;
  both.both_ways = true;
  EXPECT_EQ(portal_bytes({{one}, {}, {}, {}}).find("doubleSided"), std::string::npos);
  const std::string bytes = portal_bytes({{one, both}, {}, {}, {}});
  const PortalFile back = read_bytes(bytes);
  EXPECT_FALSE(back.portals.at(0).both_ways);
  EXPECT_TRUE(back.portals.at(1).both_ways);
  EXPECT_EQ(portal_bytes(back), bytes);
}

TEST(PortalFormat, CountsWhatPortalsDoNotNeed) {
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
TEST(PortalFormat, ADoubleSidedMaterialLetsLightPassBothWays) {
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
}

TEST(PortalFormat, ReadsWhatAModellingProgramWrites) {
  const PortalFile file = read(square());
  ASSERT_EQ(file.portals.size(), 1u);
  EXPECT_EQ(file.portals[0].name, "door");
  EXPECT_TRUE(file.scene_hash.empty());
  EXPECT_TRUE(file.made_for.empty());
  Json g = square();
  g["asset"]["extras"]["camera"] = "a Leica";  // another program's use of the name
  EXPECT_TRUE(read(g).made_for.empty());
  expect_near(area_vector(file.portals[0]), {0, 0, 1});
}

TEST(PortalFormat, ReadsWhatIsCompressed) {
  for (const testing::GlbBuilder& b : {testing::square_by_draco(), testing::square_by_meshopt()}) {
    const PortalFile file = read_bytes(b.glb());
    ASSERT_EQ(file.portals.size(), 1u);
    expect_near(area_vector(file.portals[0]), {0, 0, 1});
  }
}

TEST(PortalFormat, IsWhereItsNodeIsAndMirroringKeepsTheFrontSide) {
  Json g = square();
  g["nodes"] = Json::parse(R"([{"mesh":0,"matrix":[0,1,0,0, 0,0,1,0, 1,0,0,0, 7,8,9,1]}])");
  expect_near(area_vector(read(g).portals.at(0)), {1, 0, 0});
  expect_near(read(g).portals[0].vertices[0], {7, 8, 9});
  g["nodes"] = Json::parse(R"([{"mesh":0,"scale":[-1,1,1]}])");
  expect_near(area_vector(read(g).portals.at(0)), {0, 0, 1});
  g["nodes"] = Json::parse(R"([{"mesh":0,"scale":[1,1,-1]}])");
  expect_near(area_vector(read(g).portals.at(0)), {0, 0, -1});
}

TEST(PortalFormat, ReadsStripsFansAndPlainCorners) {
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

TEST(PortalFormat, EveryMeshNodeIsAPortal) {
  Json g = square();
  g["nodes"] = Json::parse(R"([{"mesh":0},{"mesh":0,"translation":[5,0,0]},{"name":"empty"}])");
  g.erase("scenes"), g.erase("scene");
  const PortalFile file = read(g);
  ASSERT_EQ(file.portals.size(), 2u);
  EXPECT_EQ(file.portals[1].name, "portal.1");
  expect_near(file.portals[1].vertices[0], {5, 0, 0});
}

// A few bytes may instance a mesh many times, and reference its numbers many times.
TEST(PortalFormat, RefusesWhatStandsTooOften) {
  Json g = square();
  const Json primitive = g["meshes"][0]["primitives"][0], node = g["nodes"][0];
  for (int i = 1; i < 1001; ++i) g["meshes"][0]["primitives"].push_back(primitive);
  for (int i = 1; i < 500; ++i) {
    g["nodes"].push_back(node);
    g["scenes"][0]["nodes"].push_back(i);
  }
  testing::expect_refused({{g.dump(), "meshes[0].primitives[501]", "1000000 triangles"}},
                          read_bytes);
  g["meshes"][0]["primitives"][0]["mode"] = 5;  // a strip with two more; one has an area
  for (int i = 1; i < 1001; ++i) g["meshes"][0]["primitives"][i]["indices"] = 2;
  g["accessors"].push_back(
      {{"bufferView", 1}, {"componentType", 5123}, {"count", 3}, {"type", "SCALAR"}});
  for (int i = 500; i < 1000; ++i) {
    g["nodes"].push_back(node);
    g["scenes"][0]["nodes"].push_back(i);
  }
  testing::expect_refused({{g.dump(), "meshes[0].primitives[251]", "3000000 vertices"}},
                          read_bytes);
}

// Portals are read as scenes are, whose tests have the rest: here are the places where that is
// called, and what portals need beyond.
TEST(PortalFormat, SaysWhatIsWrongAndWhere) {
  const auto with = [](const char* at, const Json& value) {
    Json g = square();
    g["materials"] = Json::parse(R"([{"doubleSided":true}])");
    g[Json::json_pointer(at)] = value;
    return g.dump();
  };
  const std::string primitive = "meshes[0].primitives[0]";
  EXPECT_NO_THROW(read_bytes(with("/nodes/0/mesh", 0)));
  testing::expect_refused(
      {{"", "", ""},
       {"{}", "asset", ""},
       {with("/nodes/0/mesh", 3), "nodes[0].mesh", ""},
       {with("/meshes/0/primitives/0/material", 2), primitive + ".material", ""},
       {with("/materials/0/doubleSided", "yes"), "materials[0].doubleSided", ""},
       {with("/meshes/0/primitives/0/attributes", Json::object()), primitive, "no POSITION"},
       {with("/accessors/0/count", 3), "accessors[1]", ""},  // an index beyond them
       {with("/accessors/0/count", 5), "accessors[0]", ""},
       {with("/nodes/0/scale", {1, 0, 1}), "nodes[0]", "no triangle with an area"},
       {with("/meshes/0/primitives/0/mode", 1), "nodes[0]", "no triangle with an area"},
       {with("/extensionsRequired", {"ACME_unknown"}), "extensionsRequired", ""},
       {with("/asset/extras/tdpt_portal_format", 2), "asset.extras.tdpt_portal_format",
        "version 2"},
       {with("/asset/extras/tdpt_portal_format", "one"), "asset.extras.tdpt_portal_format", ""}},
      read_bytes);
  EXPECT_NO_THROW(read_bytes(with("/asset/extras/tdpt_portal_format", 1)));
}

TEST(Drawback, IsWhatTheFiguresSayAgainstAPortal) {
  EXPECT_EQ(drawback_of({}), "");
  EXPECT_EQ(drawback_of({{"tightness", 0.05}, {"conductance", 0.08}}), "");
  EXPECT_EQ(drawback_of({{"tightness", 0.001}}).find("0.1 % of the lines"), 0u);
  EXPECT_EQ(drawback_of({{"tightness", 1}, {"conductance", 0.2}}).find("a wide way, 20 %"), 0u);
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
