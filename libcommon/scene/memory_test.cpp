// What a few bytes put in many places is counted before it is read.
#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/base/memory_limit.h"
#include "libcommon/scene/distinct_names.h"
#include "libcommon/scene/test_materials.h"

namespace tdpt::testing {
namespace {

// What is said of a scene where reading may take this memory; "" where it is read.
std::string complaint(const std::vector<Json>& materials, const GlbBuilder& b, uint64_t limit) {
  const uint64_t machine = memory_limit();
  limit_memory(limit);
  std::string text;
  try {
    scene_with(materials, b);
  } catch (const InputError& e) {
    text = e.what();
    text = text.substr(text.find(".glb:") + 5);
  }
  limit_memory(machine);
  return text;
}

TEST(Memory, InstancesAreCounted) {
  GlbBuilder b;
  b.mesh({{"attributes", {{"POSITION", b.floats(std::vector<float>(9000), 3)}}}});
  for (int i = 0; i < 10; ++i) b.node({{"mesh", 0}});
  EXPECT_EQ(complaint({lambert(0.5, 0.5, 0.5)}, b, 2'000'000), "");
  EXPECT_EQ(complaint({lambert(0.5, 0.5, 0.5)}, b, 1'000'000),
            "nodes: 30003 vertices and 10001 triangles take 1.18 MiB of memory, expected at most "
            "the 977 KiB of --max-memory");
}

TEST(Memory, ElementsOfTheJsonAreCounted) {
  GlbBuilder b;
  for (int i = 0; i < 999; ++i) b.node(Json::object());
  const std::string text = complaint({lambert(0.5, 0.5, 0.5)}, b, 100'000);
  EXPECT_TRUE(text.starts_with("JSON: 1006 nodes, meshes, accessors and the like take ")) << text;
  EXPECT_TRUE(text.ends_with(" of memory, expected at most the 97.7 KiB of --max-memory")) << text;
}

// The same may stand in many places.
TEST(Memory, FilesBesideAreCounted) {
  const TempFolder folder;
  folder.write("much", std::string(10'000, 'a'));
  const auto complaint_of = [&](const std::string& sections) {
    limit_memory(50'000);
    try {
      read_gltf(folder.write("a.gltf", R"({"asset": {"version": "2.0"}, )" + sections + "}"));
    } catch (const InputError& e) {
      return std::string(e.what()).substr(std::string(e.what()).find(".gltf:") + 6);
    }
    return std::string();
  };
  const uint64_t machine = memory_limit();
  const std::string buffer = R"({"byteLength": 4, "uri": "much"})";
  EXPECT_EQ(complaint_of("\"buffers\": [" + buffer + "," + buffer + "," + buffer + "]"),
            "buffers[2]: 30000 bytes of buffers take 58.6 KiB of memory, expected at most the 48.8 "
            "KiB of --max-memory");
  limit_memory(machine);
}

TEST(Memory, TexelsOfAllImagesAreCounted) {
  GlbBuilder b;
  std::vector<Json> materials;
  for (int i = 0; i < 3; ++i) {
    b.texture(i == 0 ? png_of(64, 64, std::string(4 * 64 * 64 - 1, '\0') + "\1") : kOne);
    b.json["images"][i]["bufferView"] = b.json["images"][0]["bufferView"];
    materials.push_back(lambert(1, 1, 1));
    materials.back()["pbrMetallicRoughness"]["baseColorTexture"]["index"] = i;
  }
  EXPECT_EQ(complaint(materials, b, 60'000), "");
  EXPECT_EQ(complaint(materials, b, 40'000),
            "images[2]: 12288 texels, with those before, take 48 KiB of memory, expected at most "
            "the 39.1 KiB of --max-memory");
}

TEST(DistinctNames, AreNumberedInTheOrderTheyCome) {
  DistinctNames names;
  EXPECT_EQ(names.take("hall", "", "camera"), "hall");
  EXPECT_EQ(names.take("hall", "node", "camera"), "node");
  EXPECT_EQ(names.take("hall.2", "", "camera"), "hall.2");
  EXPECT_EQ(names.take("hall", "node", "camera"), "hall.1");
  EXPECT_EQ(names.take("hall", "", "camera"), "hall.3");
  EXPECT_EQ(names.take("", "node", "camera"), "node.1");
  EXPECT_EQ(names.take("", "", "camera"), "camera");
  EXPECT_EQ(names.take("", "", "camera"), "camera.1");
}

}  // namespace
}  // namespace tdpt::testing
