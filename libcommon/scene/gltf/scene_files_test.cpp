#include "libcommon/scene/gltf/defaults.h"

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::scene_files_test {

using Names = std::vector<std::string>;

TEST(scene_files, are_those_that_its_json_names) {
  const testing::TempFolder folder;
  const auto files = [&](const std::string& text) {
    return files_of_scene(folder.write("scene.gltf", text));
  };
  const SceneFiles all = files(R"({"asset":{"version":"2.0"},"scene":0,
    "buffers":[{"uri":"a%20b.bin"},{"byteLength":1},{"uri":"data:;base64,AAAA"}],
    "images":[{"uri":"maps/wood.png"},{"uri":"a%20b.bin"},{"bufferView":0}],
    "extensions":{"EXT_lights_ies":{"lights":[{"uri":"spot.ies"},{"bufferView":0}]}},
    "scenes":[{"extras":{"tdpt_environment":"my%20sky.exr"}}]})");
  EXPECT_EQ(all.beside,
            (Names{"a b.bin", "maps/wood.png", "spot.ies", "my%20sky.exr", "my sky.exr"}));
  EXPECT_TRUE(all.has_environment);
  // A malformed scene names no files.
  for (const char* wrong : {"", "{", "no scene", R"({"buffers":7})", R"({"buffers":[7,{"uri":3}]})",
                            R"({"extensions":{"EXT_lights_ies":7}})"}) {
    EXPECT_EQ(files(wrong).beside, Names{}) << wrong;
    EXPECT_FALSE(files(wrong).has_environment);
  }
  EXPECT_THROW(files_of_scene(folder.path / "missing.glb"), InputError);
}

}  // namespace tdpt::scene_files_test
