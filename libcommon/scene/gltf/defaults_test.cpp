// Rendering defaults in a scene's extras: how they are read, and the errors for malformed ones.
#include "libcommon/scene/gltf/defaults.h"

#include <gtest/gtest.h>
#include <algorithm>
#include <filesystem>

#include "libcommon/base/error.h"
#include "libcommon/scene/scene.h"
#include "libcommon/testing/files/glb_builder.h"
#include "libcommon/testing/files/temp_folder.h"

namespace tdpt::testing::defaults_test {

namespace fs = std::filesystem;
using Json = nlohmann::json;

Json scene_of(const Json& extras) {
  return {{"scenes", {{{"extras", extras}}}}, {"scene", 0}};
}

SceneDefaults said(const Json& extras, const std::string& file = "room.glb") {
  return defaults_of(scene_of(extras), file);
}

std::string complaint(const Json& extras) {
  try {
    said(extras);
    return "";
  } catch (const InputError& e) {
    return e.what();
  }
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
  json["scene"] = 2;
  EXPECT_THROW(defaults_of(json, "a.glb"), InputError);
}

TEST(SceneDefaults, WhatIsWrongIsToldWithItsPlace) {
  const std::string at = "room.glb:scenes[0].extras.tdpt_";
  const std::string sky = "a file, or R,G,B: three numbers from 0 to 1e30";
  EXPECT_EQ(complaint({{"tdpt_width", 0}}),
            at + "width: is 0, expected an integer from 1 to 65536");
  EXPECT_EQ(complaint({{"tdpt_height", 65537}}),
            at + "height: is 65537, expected an integer from 1 to 65536");
  EXPECT_EQ(complaint({{"tdpt_height", "200"}}), at + "height: is \"200\", expected an integer");
  EXPECT_EQ(complaint({{"tdpt_environment_rotation", 361}}),
            at + "environment_rotation: is 361, expected a number from -360 to 360");
  EXPECT_EQ(complaint({{"tdpt_environment_scale", 0}}),
            at + "environment_scale: is 0, expected a number from 1e-09 to 1000000000");
  EXPECT_EQ(complaint({{"tdpt_camera", 2}}), at + "camera: is 2, expected a string");
  EXPECT_EQ(complaint({{"tdpt_environment", true}}), at + "environment: is true, expected " + sky);
  EXPECT_EQ(complaint({{"tdpt_environment", ""}}), at + "environment: is \"\", expected " + sky);
  EXPECT_EQ(complaint({{"tdpt_environment", {1, 2}}}),
            at + "environment: is an array of 2, expected " + sky);
  EXPECT_EQ(complaint({{"tdpt_environment", {1, -2, 3}}}),
            at + "environment: is \"1,-2,3\", expected " + sky);
  EXPECT_EQ(complaint({{"tdpt_environment", "1,2"}}),
            at + "environment: is \"1,2\", expected " + sky);
  EXPECT_EQ(complaint({{"tdpt_environment", "0,0,0"}}),
            at + "environment: is \"0,0,0\", expected a colour that is not black");
}

struct Folder : TempFolder {
  std::string scene = (path / "scene/room.glb").string();
  SceneDefaults naming(const std::string& environment) const {
    return said({{"tdpt_environment", environment}}, scene);
  }
  std::string found(const std::string& environment) const {
    const SceneDefaults d = naming(environment);
    return d.environment_fault ? d.environment_fault->what() : d.environment_file;
  }
  std::string in_scene(const std::string& name) const { return (path / "scene" / name).string(); }
};

TEST(SceneDefaults, AFileLiesInTheScenesFolderOrBelow) {
  const Folder folder;
  folder.write("scene/sky.exr", "");
  folder.write("scene/skies/my sky.exr", "");
  folder.write("outside/sky.exr", "");
  fs::create_symlink("../outside/sky.exr", folder.in_scene("link.exr"));
  EXPECT_EQ(folder.found("sky.exr"), folder.in_scene("sky.exr"));
  EXPECT_EQ(folder.found("skies/my sky.exr"), folder.in_scene("skies/my sky.exr"));
  const std::string at = folder.scene + ":scenes[0].extras.tdpt_environment: ";
  const std::string elsewhere = " is not a file in the scene's folder, which is all that is read";
  for (const std::string name :
       {"../outside/sky.exr", "/etc/sky.exr", "http://a/sky.exr", "data:image/exr;base64,AAAA.exr"})
    EXPECT_EQ(folder.found(name), at + "\"" + name + "\"" + elsewhere);
  EXPECT_EQ(folder.found("%2e%2e/outside/sky.exr"), at + "\"../outside/sky.exr\"" + elsewhere);
  EXPECT_EQ(folder.found("link.exr"),
            at + "\"link.exr\" leads out of the scene's folder, which is all that is read");
  EXPECT_EQ(folder.found("none.exr"),
            at + "\"none.exr\" cannot be opened: No such file or directory");
  EXPECT_EQ(folder.found("skies"), at + "\"skies\" is no regular file");
  EXPECT_EQ(said({{"tdpt_environment", "sky.exr"}}, "-").environment_fault->what(),
            std::string("(standard input):scenes[0].extras.tdpt_environment: \"sky.exr\" is "
                        "another file, expected a scene in one piece on standard input"));
}

TEST(SceneDefaults, ANameThatIsThereIsTakenAsItIsElseAsAUri) {
  const Folder folder;
  folder.write("scene/my sky.exr", "");
  EXPECT_EQ(folder.found("my%20sky.exr"), folder.in_scene("my sky.exr"));
  folder.write("scene/my%20sky.exr", "");
  EXPECT_EQ(folder.found("my%20sky.exr"), folder.in_scene("my%20sky.exr"));
}

TEST(SceneDefaults, AreReadWithAScene) {
  GlbBuilder b;
  const int p = b.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
  b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", p}}}})}});
  b.camera("hall", {0, 0, 2}, {0, 0, 0}, 1, 1);
  b.camera("yard", {0, 0, 3}, {0, 0, 0}, 1, 1);
  const TempFolder folder;
  EXPECT_EQ(read_gltf(folder.write("a.glb", b.glb())).camera("").name, "hall");
  b.json["scenes"][0]["extras"] = {{"tdpt_camera", "yard"}};
  const Scene scene = read_gltf(folder.write("a.glb", b.glb()));
  EXPECT_EQ(scene.defaults.camera, "yard");
  EXPECT_EQ(scene.camera("").name, "yard");
  EXPECT_EQ(scene.camera("hall").name, "hall");
}

}  // namespace tdpt::testing::defaults_test
