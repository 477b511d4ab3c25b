// What is refused, and that nothing a file says makes the reader fall over.
#include <gtest/gtest.h>
#include <algorithm>
#include <filesystem>
#include <set>

#include "libcommon/base/error.h"
#include "libcommon/base/file.h"
#include "libcommon/math/rng.h"
#include "libcommon/scene/scene.h"
#include "libcommon/testing/glb_builder.h"
#include "libcommon/testing/malformed.h"
#include "libcommon/testing/rooms.h"
#include "libcommon/testing/temp_folder.h"

namespace tdpt::testing {
namespace {

namespace fs = std::filesystem;

const std::string kTestdata = TDPT_TESTDATA;

/// The message that reading `path` ends with; "" when it is read.
std::string refusal(const std::string& path) {
  try {
    read_gltf(path);
  } catch (const Error& e) {
    EXPECT_EQ(e.code, Exit::bad_input);
    return e.what();
  }
  return "";
}

TEST(Malformed, EveryFileIsRefusedWithItsPlaceAndMessage) {
  for (const MalformedScene& s : malformed_scenes()) {
    const std::string path = kTestdata + "/malformed/" + s.file;
    EXPECT_EQ(refusal(path), path + ":" + s.expected) << s.file;
  }
}

TEST(Malformed, FilesAreThoseThatTheProgramWrites) {
  std::set<std::string> names;
  for (const MalformedScene& s : malformed_scenes()) {
    EXPECT_TRUE(names.insert(s.file).second) << s.file << " is there twice";
    EXPECT_EQ(read_file(kTestdata + "/malformed/" + s.file), s.bytes) << s.file;
  }
  for (const auto& entry : fs::directory_iterator(kTestdata + "/malformed"))
    EXPECT_TRUE(entry.path().filename() == "README.md" || names.contains(entry.path().filename()))
        << entry.path();
}

TEST(Malformed, EveryMessageIsOneLine) {
  for (const MalformedScene& s : malformed_scenes())
    EXPECT_EQ(s.expected.find_first_of("\r\n"), std::string::npos) << s.file;
}

/// One triangle, its buffer behind `uri`.
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
  EXPECT_EQ(refusal(folder.write("scene/b.gltf", external_scene("./parts/room one.bin"))), "");
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

/// A mesh of `vertices` zeros, `instances` nodes that use it.
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

TEST(Missing, AFileThatIsNotThere) {
  EXPECT_NE(refusal("/nowhere/room.glb").find("/nowhere/room.glb: cannot be opened"),
            std::string::npos);
  EXPECT_NE(refusal(kTestdata).find("is a folder"), std::string::npos);
}

size_t get_json_size(const std::string& glb) {
  return static_cast<unsigned char>(glb[12]) + 256u * static_cast<unsigned char>(glb[13]);
}

TEST(Mutations, ALoadedOrARefusedScene) {
  const TempFolder folder;
  const std::string whole = read_file(kTestdata + "/scenes/two-rooms.glb");
  const size_t json_end =
      20 + static_cast<unsigned char>(whole[12]) + 256 * static_cast<unsigned char>(whole[13]);
  int loaded = 0, refused = 0;
  for (uint64_t i = 0; i < 2000; ++i) {
    Rng rng(20, 0, i);
    std::string bytes = whole;
    const uint64_t what = rng.below(10);
    // Most changes go where they do most harm: into the header and the JSON.
    const size_t reach = what < 7 ? json_end : bytes.size();
    for (uint32_t n = 1 + rng.below(3); n > 0; --n) {
      const size_t at = rng.below(static_cast<uint32_t>(reach));
      const bool digit = bytes[at] >= '0' && bytes[at] <= '9';
      bytes[at] = static_cast<char>(digit ? '0' + rng.below(10) : rng.below(256));
    }
    if (what == 9) bytes.resize(rng.below(static_cast<uint32_t>(bytes.size())));
    try {
      const Scene scene = read_gltf(folder.write("mutant.glb", bytes));
      ++loaded;
      for (const Triangle& t : scene.triangles) {
        for (uint32_t v : t.vertex) {
          ASSERT_LT(v, scene.positions.size());
          ASSERT_LE(std::abs(scene.positions[v].x), 1);
        }
        ASSERT_LT(t.material, scene.materials.size());
      }
    } catch (const Error& e) {
      ++refused;
      EXPECT_EQ(std::string(e.what()).find_first_of("\r\n"), std::string::npos) << i;
    }
  }
  EXPECT_GT(loaded, 200);
  EXPECT_GT(refused, 200);
}

TEST(Mutations, ExtremeNumbersInTheJson) {
  const TempFolder folder;
  const std::string whole = read_file(kTestdata + "/scenes/door-ajar.glb");
  const std::string text = whole.substr(20, get_json_size(whole));
  const std::string bin = whole.substr(20 + text.size() + 8);
  std::vector<std::pair<size_t, size_t>> numbers;  // place and length
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i - (i > 0)] == '"' || !(std::isdigit(text[i]) || text[i] == '-')) continue;
    const size_t end = text.find_first_not_of("0123456789.-+e", i);
    numbers.push_back({i, end - i});
    i = end;
  }
  ASSERT_GT(numbers.size(), 100u);
  const std::vector<std::string> extremes = {
      "-1",  "0",    "1",     "3",     "255",    "65536",      "2147483647",           "2147483648",
      "0.5", "1e30", "1e300", "-1e30", "1e-300", "4294967295", "18446744073709551615", "null"};
  int loaded = 0, refused = 0;
  for (uint64_t i = 0; i < 1500; ++i) {
    Rng rng(21, 0, i);
    const auto [at, length] = numbers[rng.below(static_cast<uint32_t>(numbers.size()))];
    std::string mutant = text;
    mutant.replace(at, length, extremes[rng.below(static_cast<uint32_t>(extremes.size()))]);
    try {
      const Scene scene = read_gltf(folder.write("mutant.glb", glb_of(mutant, bin)));
      ++loaded;
      for (const Vec3f& p : scene.positions) ASSERT_TRUE(is_finite(p));
    } catch (const Error& e) {
      ++refused;
      EXPECT_EQ(std::string(e.what()).find_first_of("\r\n"), std::string::npos) << i;
    }
  }
  EXPECT_GT(loaded, 100);
  EXPECT_GT(refused, 500);
}

TEST(Mutations, EveryTruncationIsRefused) {
  const TempFolder folder;
  const std::string whole = read_file(kTestdata + "/scenes/furnace.glb");
  for (size_t n = 0; n < whole.size(); n += 7)
    EXPECT_NE(refusal(folder.write("short.glb", whole.substr(0, n))), "") << n;
}

}  // namespace
}  // namespace tdpt::testing
