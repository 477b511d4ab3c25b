// Data that a few bytes repeat many times are counted before they are read.
#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/scene/gltf/document.h"
#include "libcommon/testing/scenes/materials.h"

namespace tdpt::testing::memory_test {

// The error of reading a scene under this memory limit; "" if it is read.
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

TEST(Memory, SoAreTheirNormals) {
  GlbBuilder b;
  const int p = b.floats(std::vector<float>(9000), 3);
  b.mesh({{"attributes", {{"POSITION", p}, {"NORMAL", p}}}});
  for (int i = 0; i < 10; ++i) b.node({{"mesh", 0}});
  EXPECT_EQ(complaint({lambert(0.5, 0.5, 0.5)}, b, 1'000'000),
            "nodes: 30003 vertices and 10001 triangles take 1.53 MiB of memory, expected at most "
            "the 977 KiB of --max-memory");
}

TEST(Memory, ElementsOfTheJsonAreCounted) {
  GlbBuilder b;
  for (int i = 0; i < 999; ++i) b.node(Json::object());
  const std::string text = complaint({lambert(0.5, 0.5, 0.5)}, b, 100'000);
  EXPECT_TRUE(text.starts_with("JSON: 1006 nodes, meshes, accessors and the like take ")) << text;
  EXPECT_TRUE(text.ends_with(" of memory, expected at most the 97.7 KiB of --max-memory")) << text;
}

// The same file may be referenced many times.
class FilesBeside : public ::testing::Test {
 protected:
  FilesBeside() {
    folder_.write("much", std::string(10'000, 'a'));
    limit_memory(50'000);
  }
  ~FilesBeside() override { limit_memory(machine_); }
  // The error for a .gltf with these sections.
  std::string complaint(const std::string& sections) const {
    try {
      read_gltf(folder_.write("a.gltf", R"({"asset": {"version": "2.0"}, )" + sections + "}"));
    } catch (const InputError& e) {
      const std::string text = e.what();
      return text.substr(text.find(".gltf:") + 6);
    }
    return "";
  }
  const TempFolder folder_;
  const uint64_t machine_ = memory_limit();
};

TEST_F(FilesBeside, AreCountedAsBuffers) {
  const std::string one = R"({"byteLength": 4, "uri": "much"})";
  const std::string used = R"("nodes": [{"mesh": 0}], "meshes": [{"primitives": [{"attributes":
    {"POSITION": 0, "NORMAL": 1, "TANGENT": 2}}]}], "accessors": [
    {"bufferView": 0, "componentType": 5126, "count": 1, "type": "VEC3"},
    {"bufferView": 1, "componentType": 5126, "count": 1, "type": "VEC3"},
    {"bufferView": 2, "componentType": 5126, "count": 1, "type": "VEC4"}], "bufferViews": [
    {"buffer": 0, "byteLength": 4}, {"buffer": 1, "byteLength": 4},
    {"buffer": 2, "byteLength": 4}], )";
  EXPECT_EQ(complaint(used + R"("buffers": [)" + one + "," + one + "," + one + "]"),
            "buffers[2]: 30000 bytes of buffers take 58.6 KiB of memory, expected at most the 48.8 "
            "KiB of --max-memory");
}

TEST_F(FilesBeside, AreCountedAsImages) {
  EXPECT_EQ(complaint(R"("images": [{"uri": "much"}, {"uri": "much"}, {"uri": "much"}],
    "textures": [{"source": 0}, {"source": 1}, {"source": 2}], "nodes": [{"mesh": 0}],
    "accessors": [{"componentType": 5126, "count": 3, "type": "VEC3"}],
    "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0},
                                            "metallicRoughnessTexture": {"index": 1}},
                   "normalTexture": {"index": 2}}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}])"),
            "images[2]: 30000 bytes of image files take 58.6 KiB of memory, expected at most the "
            "48.8 KiB of --max-memory");
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
  gltf::DistinctNames names;
  EXPECT_EQ(names.take("hall", "", "camera"), "hall");
  EXPECT_EQ(names.take("hall", "node", "camera"), "node");
  EXPECT_EQ(names.take("hall.2", "", "camera"), "hall.2");
  EXPECT_EQ(names.take("hall", "node", "camera"), "hall.1");
  EXPECT_EQ(names.take("hall", "", "camera"), "hall.3");
  EXPECT_EQ(names.take("", "node", "camera"), "node.1");
  EXPECT_EQ(names.take("", "", "camera"), "camera");
  EXPECT_EQ(names.take("", "", "camera"), "camera.1");
}

}  // namespace tdpt::testing::memory_test
