// Data that a few bytes repeat many times are counted before they are read.
#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/scene/gltf/document.h"
#include "libcommon/testing/scenes/materials.h"

namespace tdpt::testing::memory_test {

/// The error of reading with so much memory; "" if it is read.
template <class Read>
std::string complaint(uint64_t limit, const Read& read) {
  const uint64_t machine = memory_limit();
  limit_memory(limit);
  std::string text;
  try {
    read();
  } catch (const InputError& e) {
    text = e.what();
    text = text.substr(text.find(":", text.find(".gl")) + 1);
  }
  limit_memory(machine);
  return text;
}
std::string complaint(const GlbBuilder& b, uint64_t limit) {
  return complaint(limit, [&] { load(b); });
}

TEST(Memory, InstancesAndTheirNormalsAreCounted) {
  const auto crowd = [](bool normals) {
    GlbBuilder b;
    Json at = {{"POSITION", b.floats(std::vector<float>(9000), 3)}};
    if (normals) at["NORMAL"] = 0;
    b.mesh({{"attributes", at}});
    for (int i = 0; i < 10; ++i) b.node({{"mesh", 0}});
    return b;
  };
  const std::string what = "nodes: 30000 vertices and 10000 triangles take ",
                    most = " of memory, expected at most the 977 KiB of --max-memory";
  EXPECT_EQ(complaint(crowd(false), 1'000'000), what + "1.18 MiB" + most);
  EXPECT_EQ(complaint(crowd(true), 1'000'000), what + "1.53 MiB" + most);
  EXPECT_TRUE(complaint(crowd(false), 2'000'000).starts_with(" has no triangle"));
}

TEST(Memory, ElementsOfTheJsonAreCounted) {
  GlbBuilder b;
  for (int i = 0; i < 999; ++i) b.node(Json::object());
  const std::string text = complaint(b, 100'000);
  EXPECT_TRUE(text.starts_with("JSON: 1000 nodes, meshes, accessors and the like take ")) << text;
}

// The same file may be referenced many times.
TEST(Memory, FilesBesideAreCountedEachTime) {
  const TempFolder folder;
  folder.write("much", std::string(10'000, 'a'));
  const auto told = [&](const std::string& sections) {
    return complaint(50'000, [&] {
      read_gltf(folder.write("a.gltf", R"({"asset": {"version": "2.0"}, )" + sections + "}"));
    });
  };
  const std::string most =
      " take 58.6 KiB of memory, expected at most the 48.8 KiB of --max-memory";
  const std::string one = R"({"byteLength": 4, "uri": "much"})";
  EXPECT_EQ(told(R"("buffers": [)" + one + "," + one + "," + one + "]"),
            "buffers[2]: 30000 bytes of buffers" + most);
  EXPECT_EQ(told(R"("images": [{"uri": "much"}, {"uri": "much"}, {"uri": "much"}],
    "textures": [{"source": 0}, {"source": 1}, {"source": 2}], "nodes": [{"mesh": 0}],
    "accessors": [{"componentType": 5126, "count": 3, "type": "VEC3"}],
    "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0},
                                            "metallicRoughnessTexture": {"index": 1}},
                   "normalTexture": {"index": 2}}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}])"),
            "images[2]: 30000 bytes of image files" + most);
}

TEST(Memory, TexelsOfAllImagesAreCounted) {
  GlbBuilder b;
  const int p = b.floats({0, 0, 0, 2, 0, 0, 0, 1, 0}, 3);
  for (int i = 0; i < 3; ++i) {
    b.texture(i == 0 ? png_of(64, 64, std::string(4 * 64 * 64 - 1, '\0') + "\1") : kOne);
    b.json["images"][i]["bufferView"] = b.json["images"][0]["bufferView"];
    const int m = b.material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
    b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", p}}}, {"material", m}})}});
  }
  EXPECT_EQ(complaint(b, 60'000), "");
  EXPECT_EQ(complaint(b, 40'000),
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
