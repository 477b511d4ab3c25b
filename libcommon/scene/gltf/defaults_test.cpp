// Rendering defaults in a scene's extras, and the files that a scene names.
#include "libcommon/scene/gltf/defaults.h"

#include <gtest/gtest.h>
#include <filesystem>

#include "libcommon/base/error.h"
#include "libcommon/testing/rooms/squares.h"
#include "libcommon/testing/scenes/materials.h"

namespace tdpt::testing::defaults_test {

namespace fs = std::filesystem;
using Json = nlohmann::json;

Json scene_of(const Json& extras) {
  return {{"scenes", {{{"extras", extras}}}}, {"scene", 0}};
}

SceneDefaults said(const Json& extras, const std::string& file = "room.glb") {
  return defaults_of(scene_of(extras), file);
}

TEST(SceneDefaults, AreNothingWhereNothingIsSaid) {
  for (const Json& json : {Json::object(), scene_of(nullptr), scene_of("text"),
                           scene_of(Json::object()), scene_of({{"author", "me"}})}) {
    const SceneDefaults d = defaults_of(json, "room.glb");
    EXPECT_EQ(d.environment + d.environment_file + d.camera, "") << json;
    EXPECT_FALSE(d.has_environment() || d.rotation || d.scale || d.width || d.height) << json;
  }
}

// Custom properties are integers or floats, depending on how they were created.
TEST(SceneDefaults, AreReadFromIntegersAndFloats) {
  const SceneDefaults d = said({{"tdpt_environment", "0.5,1,2"},
                                {"tdpt_environment_rotation", -90},
                                {"tdpt_environment_scale", 2},
                                {"tdpt_width", 320.0},
                                {"tdpt_height", 200},
                                {"tdpt_camera", "yard"}});
  EXPECT_EQ(d.place, "scenes[0].extras");
  EXPECT_EQ(d.environment, "0.5,1,2");
  EXPECT_EQ(d.rotation, -90);
  EXPECT_EQ(d.scale, 2);
  EXPECT_EQ(d.width, 320);
  EXPECT_EQ(d.height, 200);
  EXPECT_EQ(d.camera, "yard");
  EXPECT_EQ(d.environment_file, "");
  EXPECT_FALSE(d.environment_fault);
  EXPECT_EQ(said({{"tdpt_environment", {0.5, 1, 2e3}}}).environment, "0.5,1,2000");
  EXPECT_FALSE(said({{"tdpt_environment", "none"}}).has_environment());
}

TEST(SceneDefaults, AreThoseOfTheSceneThatIsShown) {
  Json json{{"scenes", {{{"extras", {{"tdpt_width", 1}}}}, {{"extras", {{"tdpt_width", 2}}}}}}};
  EXPECT_EQ(defaults_of(json, "a.glb").width, 1);
  json["scene"] = 1;
  EXPECT_EQ(defaults_of(json, "a.glb").width, 2);
  EXPECT_EQ(defaults_of(json, "a.glb").place, "scenes[1].extras");
}

TEST(SceneDefaults, AFileLiesInTheScenesFolderAndANameThatIsThereIsTakenAsItIs) {
  const TempFolder folder;
  const std::string scene = (folder.path / "scene/room.glb").string();
  const auto found = [&](const std::string& environment, const std::string& file) {
    const SceneDefaults d = said({{"tdpt_environment", environment}}, file);
    return d.environment_fault ? d.environment_fault->what() : d.environment_file;
  };
  const auto written = [&](const std::string& name) { return folder.write("scene/" + name, ""); };
  const std::string sky = written("skies/my sky.exr"), at = ":scenes[0].extras.tdpt_environment: ";
  EXPECT_EQ(found("skies/my sky.exr", scene), sky);
  EXPECT_EQ(found("skies/my%20sky.exr", scene), sky);
  const std::string encoded = written("skies/my%20sky.exr");
  EXPECT_EQ(found("skies/my%20sky.exr", scene), encoded);
  EXPECT_EQ(found("data:image/exr;base64,AAAA.exr", scene),
            scene + at +
                "\"data:image/exr;base64,AAAA.exr\" is not a file in the scene's folder, "
                "which is all that is read");
  EXPECT_EQ(found("none.exr", scene),
            scene + at + "\"none.exr\" cannot be opened: No such file or directory");
  EXPECT_EQ(found("sky.exr", "-"), "(standard input)" + at +
                                       "\"sky.exr\" is another file, expected "
                                       "a scene in one piece on standard input");
}

TEST(SceneDefaults, AreReadWithAScene) {
  GlbBuilder b = square();
  b.camera("yard", {0, 0, 3}, {0, 0, 0}, 1, 1);
  EXPECT_EQ(load(b).camera("").name, "camera");
  b.json["scenes"][0]["extras"] = {{"tdpt_camera", "yard"}};
  const Scene scene = load(b);
  EXPECT_EQ(scene.defaults.camera, "yard");
  EXPECT_EQ(scene.camera("").name, "yard");
  EXPECT_EQ(scene.camera("camera").name, "camera");
}

TEST(SceneFiles, AreThoseThatItsJsonNames) {
  const TempFolder folder;
  const auto files = [&](const std::string& text) {
    return files_of_scene(folder.write("scene.gltf", text));
  };
  const SceneFiles all = files(R"({"asset":{"version":"2.0"},"scene":0,
    "buffers":[{"uri":"a%20b.bin"},{"byteLength":1},{"uri":"data:;base64,AAAA"}],
    "images":[{"uri":"maps/wood.png"},{"uri":"a%20b.bin"},{"bufferView":0}],
    "extensions":{"EXT_lights_ies":{"lights":[{"uri":"spot.ies"},{"bufferView":0}]}},
    "scenes":[{"extras":{"tdpt_environment":"my%20sky.exr"}}]})");
  EXPECT_EQ(all.beside,
            (Sentences{"a b.bin", "maps/wood.png", "spot.ies", "my%20sky.exr", "my sky.exr"}));
  EXPECT_TRUE(all.has_environment);
  // A malformed scene names no files.
  for (const char* wrong : {"", "{", "no scene", R"({"buffers":7})", R"({"buffers":[7,{"uri":3}]})",
                            R"({"extensions":{"EXT_lights_ies":7}})"}) {
    EXPECT_EQ(files(wrong).beside, Sentences{}) << wrong;
    EXPECT_FALSE(files(wrong).has_environment);
  }
  EXPECT_THROW(files_of_scene(folder.path / "missing.glb"), InputError);
}

}  // namespace tdpt::testing::defaults_test
