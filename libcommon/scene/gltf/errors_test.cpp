// Malformed files are refused, and none crashes the reader.
#include <gtest/gtest.h>
#include <algorithm>
#include <filesystem>
#include <set>

#include "libcommon/base/error.h"
#include "libcommon/scene/scene.h"
#include "libcommon/testing/files/glb_builder.h"
#include "libcommon/testing/files/malformed.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::testing::errors_test {

namespace fs = std::filesystem;

const std::string kTestdata = TDPT_TESTDATA;

/// The error of reading `path` or of using its first camera; "" if there is none.
std::string refusal(const std::string& path) {
  try {
    const Scene scene = read_gltf(path);
    if (!scene.cameras.empty()) scene.camera("");
  } catch (const Error& e) {
    EXPECT_EQ(e.code, Exit::bad_input);
    return e.what();
  }
  return "";
}

TEST(Malformed, EveryFileIsRefusedWithItsPlaceAndMessage) {
  const TempFolder folder;
  // The files that two of them refer to exist.
  folder.write("scenes/two-rooms.glb", std::string(60, ' '));
  folder.write("README.md", std::string(60, ' '));
  std::set<std::string> names;
  for (const MalformedScene& s : malformed_scenes()) {
    EXPECT_TRUE(names.insert(s.file).second) << s.file << " is there twice";
    const std::string path = folder.write("malformed/" + s.file, s.bytes);
    EXPECT_EQ(refusal(path), path + ":" + s.expected) << s.file;
    EXPECT_EQ(s.expected.find_first_of("\r\n"), std::string::npos) << s.file;
  }
}

/// One triangle with its buffer at `uri`.
std::string external_scene(const std::string& uri) {
  GlbBuilder b;
  const int p = b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", p}}}})}});
  auto json = nlohmann::ordered_json::parse(b.gltf());
  json["buffers"][0]["uri"] = uri;
  return json.dump();
}
std::string external_buffer() {
  GlbBuilder b;
  b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  return b.bin;
}

TEST(ExternalFiles, LieInTheScenesFolderOrBelow) {
  const TempFolder folder;
  folder.write("scene/parts/room one.bin", external_buffer());
  EXPECT_EQ(refusal(folder.write("scene/a.gltf", external_scene("parts/room%20one.bin"))), "");
  for (const char* uri :
       {"./parts/room one.bin", "parts/../parts/room one.bin", "../scene/parts/room one.bin"})
    EXPECT_EQ(refusal(folder.write("scene/b.gltf", external_scene(uri))), "") << uri;
}

TEST(ExternalFiles, AreNotReachedThroughLinksThatLeaveTheFolder) {
  const TempFolder folder;
  folder.write("outside/room.bin", external_buffer());
  fs::create_directories(folder.path / "scene");
  fs::create_symlink("../outside/room.bin", folder.path / "scene/room.bin");
  fs::create_directory_symlink("../outside", folder.path / "scene/door");
  for (const std::string uri : {"room.bin", "door/room.bin"}) {
    const std::string scene = folder.write("scene/a.gltf", external_scene(uri));
    EXPECT_EQ(refusal(scene), scene + ":buffers[0].uri: \"" + uri +
                                  "\" leads out of the scene's folder, which is all that is read");
  }
}

TEST(ExternalFiles, ALinkInsideTheFolderIsFine) {
  const TempFolder folder;
  folder.write("scene/real.bin", external_buffer());
  fs::create_symlink("real.bin", folder.path / "scene/room.bin");
  EXPECT_EQ(refusal(folder.write("scene/a.gltf", external_scene("room.bin"))), "");
}

TEST(ExternalFiles, AScenesHashCoversThem) {
  const TempFolder folder;
  const std::string scene = folder.write("a.gltf", external_scene("room.bin"));
  folder.write("room.bin", external_buffer());
  const std::string before = read_gltf(scene).hash;
  EXPECT_EQ(read_gltf(scene).hash, before);
  std::string changed = external_buffer();
  changed[14] ^= 1;
  folder.write("room.bin", changed);
  EXPECT_NE(read_gltf(scene).hash, before);
}

TEST(ExternalFiles, APipeIsNotWaitedFor) {
  const TempFolder folder;
  const std::string pipe = (folder.path / "room.bin").string();
  ASSERT_EQ(std::system(("mkfifo '" + pipe + "'").c_str()), 0);
  const std::string scene = folder.write("a.gltf", external_scene("room.bin"));
  EXPECT_EQ(refusal(scene), scene + ":buffers[0].uri: \"room.bin\" is no regular file");
}

/// A mesh of `vertices` zeros and `instances` nodes that use it.
std::string crowd(size_t vertices, size_t instances) {
  GlbBuilder b;
  const int p = b.floats(std::vector<float>(3 * vertices), 3);
  const int mesh = b.mesh({{"attributes", {{"POSITION", p}}}});
  for (size_t i = 0; i < instances; ++i) b.node({{"mesh", mesh}});
  return b.glb();
}

TEST(Size, InstancesThatWouldFillTheMemoryAreRefusedBeforeTheyDo) {
  const TempFolder folder;
  const std::string scene = folder.write("crowd.glb", crowd(90000, 1500));
  EXPECT_EQ(refusal(scene),
            scene +
                ":nodes[1491]: brings the scene to 134280000 vertices and 44760000 triangles, "
                "expected at most 134217728 and 268435456");
}

TEST(Size, ImagesThatWouldFillTheMemoryAreRefusedBeforeTheyDo) {
  GlbBuilder b;
  const int p = b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  std::string image = png_of(1, 1, "\1\2\3\4");  // claims 8192 x 8192 texels
  image.replace(16, 8, std::string("\0\0\x20\0\0\0\x20\0", 8));
  image += std::string(300000, '\0');  // enough bytes to make that plausible
  for (int i = 0; i < 5; ++i) {
    const int material = b.material(
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", b.texture(image)}}}}}});
    b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", p}}}, {"material", material}})}});
  }
  const TempFolder folder;
  const std::string scene = folder.write("atlas.glb", b.glb());
  EXPECT_EQ(refusal(scene),
            scene + ":images[4]: brings the scene to 335544320 texels, expected at most 268435456");
}

TEST(Missing, AFileThatIsNotThere) {
  EXPECT_NE(refusal("/nowhere/room.glb").find("/nowhere/room.glb: cannot be opened"),
            std::string::npos);
  EXPECT_NE(refusal(kTestdata).find("is a folder"), std::string::npos);
}

}  // namespace tdpt::testing::errors_test
