// One scene renders to the same picture however glTF encodes it: bit for bit if positions and the
// order of triangles are the same, else within noise; with lossy compression, bit for bit as
// decoded by the format's reference decoder.
#include <gtest/gtest.h>

#include "libcommon/base/file.h"
#include "libcommon/testing/files/compress.h"
#include "libcommon/testing/files/reencode.h"
#include "libcommon/testing/files/temp_folder.h"
#include "tools/tdpt-render/testing/agreement.h"
#include "tools/tdpt-render/testing/rendering.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::reencoding_test {

using testing::Encoding;
using testing::Same;

const std::vector<Portal> kPortals{rectangle({-0.6, 1.2, -0.6}, {1.2, 0, 0}, {0, 0, 1.2})};
constexpr AgreementSettings kSettings{.max_depth = 5, .runs = 16, .spp = 8};

Scene read(const std::vector<testing::QuadPart>& parts, Encoding encoding) {
  const testing::TempFolder folder;
  const testing::EncodedScene scene = testing::encode(parts, encoding);
  for (const auto& [name, bytes] : scene.files) folder.write(name, bytes);
  return read_gltf((folder.path / scene.file).string());
}

Picture picture_of(const Scene& scene) {
  const Vista vista(scene, scene.camera(""), 32, 24, kPortals);
  Job settings;
  settings.limits.spp = 4;
  return render(vista, tdpt_org, settings).picture;
}

DepthRuns runs_of(const Scene& scene) {
  const Vista vista(scene, scene.camera(""), 32, 24, kPortals);
  return render_runs(vista, tdpt_org, kSettings);
}

std::vector<testing::QuadPart> room_with_a_corner_moved() {
  std::vector<testing::QuadPart> room = testing::simple_room();
  room.back().positions.back() += Vec3f(-0.1f, 0.05f, -0.1f);  // of the block's top
  return room;
}

TEST(reencoding, same_bits_where_nothing_but_the_writing_differs) {
  const Scene plain = read(testing::simple_room(), Encoding::indices_u16);
  EXPECT_TRUE(plain.warnings.empty());
  const Picture picture = picture_of(plain);
  for (const testing::NamedEncoding& e : testing::kEncodings) {
    if (e.same != Same::bits) continue;
    EXPECT_EQ(picture.pixels, picture_of(read(testing::simple_room(), e.encoding)).pixels)
        << e.name;
  }
}

TEST(reencoding, same_picture_within_noise_where_order_or_rounding_differ) {
  const DepthRuns plain = runs_of(read(testing::simple_room(), Encoding::indices_u16));
  for (const testing::NamedEncoding& e : testing::kEncodings) {
    if (e.same == Same::bits) continue;
    const Scene scene = read(testing::simple_room(), e.encoding);
    EXPECT_EQ(scene.warnings.size(), e.encoding == Encoding::strip ? 1u : 0u)  // its joints
        << e.name;
    const DepthRuns runs = runs_of(scene);
    const testing::Agreement paired = testing::compare_paired(runs.of_depth[0], plain.of_depth[0]);
    std::printf("%-9s %s\n", e.name, paired.text().c_str());
    const Verdict verdict = judge(runs, plain);
    EXPECT_TRUE(holds(verdict, e.name, runs, plain));
    if (e.same == Same::but_rounding)  // the room shrinks by 15 micrometres
      EXPECT_LT(std::abs(paired.relative), 2e-4) << e.name;
    else
      EXPECT_TRUE(testing::holds(paired, std::string(e.name) + ", paired", runs.of_depth[0],
                                 plain.of_depth[0], plain.across));
  }
}

std::string plain_room() {
  return testing::encode(testing::simple_room(), Encoding::indices_u16).files.at("scene.glb");
}

Picture picture_of_bytes(const std::string& glb) {
  const testing::TempFolder folder;
  const Scene scene = read_gltf(folder.write("scene.glb", glb));
  EXPECT_EQ(scene.warnings, std::vector<std::string>{});
  return picture_of(scene);
}

TEST(reencoding, compressed_scenes_are_those_of_the_reference_decoders) {
  const Picture plain = picture_of_bytes(plain_room());
  for (const testing::NamedCompression& c : testing::kCompressions) {
    const std::string glb = testing::compress(plain_room(), c.compression);
    const Picture picture = picture_of_bytes(glb);
    EXPECT_TRUE(picture.pixels == picture_of_bytes(testing::decompress(glb)).pixels) << c.name;
    // Lossy encodings must change the picture, or equality with the decoder's would prove nothing.
    EXPECT_EQ(picture.pixels == plain.pixels, c.exact) << c.name;
  }
}

TEST(reencoding, files_of_other_programs_are_those_of_the_reference_decoders) {
  const DepthRuns plain = runs_of(read(testing::simple_room(), Encoding::indices_u16));
  // The last number: largest mean error.
  const std::vector<std::pair<const char*, double>> files{{"draco-gltf-pipeline", 3e-3},
                                                          {"draco-gltf-transform", 1e-3},
                                                          {"meshopt-gltf-transform", 1e-3},
                                                          {"meshopt-gltfpack", 1e-3},
                                                          {"webp-lossless", 0},
                                                          {"webp-lossy", 0.1}};
  for (const auto& [name, most] : files) {
    const std::string path = std::string(TDPT_TESTDATA "/compressed/") + name + ".glb";
    const Scene scene = read_gltf(path);
    EXPECT_EQ(scene.warnings, std::vector<std::string>{}) << name;
    const testing::TempFolder folder;
    const Scene decoded =
        read_gltf(folder.write("scene.glb", testing::decompress(read_file(path))));
    EXPECT_TRUE(picture_of(scene).pixels == picture_of(decoded).pixels) << name;
    const testing::Agreement paired =
        testing::compare_paired(runs_of(scene).of_depth[0], plain.of_depth[0]);
    std::printf("%-22s %s\n", name, paired.text().c_str());
    EXPECT_LE(std::abs(paired.relative), most) << name;
  }
}

TEST(reencoding, twin_one_vertex_moved_is_caught) {
  const Scene plain = read(testing::simple_room(), Encoding::indices_u16);
  const Scene moved = read(room_with_a_corner_moved(), Encoding::indices_u16);
  EXPECT_NE(picture_of(plain).pixels, picture_of(moved).pixels);
  EXPECT_FALSE(judge(runs_of(moved), runs_of(plain)).holds());
}

// Like a reader that does not flip the faces of a mirrored node: the lamp shines away.
TEST(reencoding, twin_a_lamp_turned_over_is_caught) {
  std::vector<testing::QuadPart> room = testing::simple_room();
  std::swap(room[3].positions[1], room[3].positions[3]);
  EXPECT_FALSE(judge(runs_of(read(room, Encoding::indices_u16)),
                     runs_of(read(testing::simple_room(), Encoding::indices_u16)))
                   .holds());
}

}  // namespace tdpt::reencoding_test
