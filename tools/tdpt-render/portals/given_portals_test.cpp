// Portals are taken as drawn if they are flat; else they are refused, each case with its message.
#include "tools/tdpt-render/portals/given_portals.h"

#include <gtest/gtest.h>

#include "libcommon/base/error.h"
#include "libcommon/formats/viewpoint.h"
#include "libcommon/options/shot_options.h"
#include "libcommon/testing/files/temp_folder.h"
#include "tools/tdpt-render/portals/portals.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::given_portals_test {

using Strings = std::vector<std::string>;

/// Whether there is one sentence, and it holds `part`.
bool says(const Strings& sentences, const std::string& part) {
  return sentences.size() == 1 && sentences[0].find(part) != std::string::npos;
}

class given_portals : public ::testing::Test {
 protected:
  GivenPortals given(const std::vector<Portal>& portals, const std::string& hash = "",
                     const std::string& made_for = "") const {
    PortalFile file;
    if (!made_for.empty()) file.made_for = {made_for};
    file.portals = portals;
    file.scene_hash = hash;
    return given(file, scene_.camera(""));
  }
  GivenPortals given(const PortalFile& file, const Camera& camera, bool frame = false) const {
    return read_given_portals(folder_.write("drawn.glb", portal_bytes(file)), scene_, camera,
                              frame);
  }
  /// The message, without the place; empty: it is taken.
  std::string refused(const Portal& portal) const {
    try {
      given({portal_in_the_hole(), portal});
    } catch (const InputError& e) {
      const std::string text = e.what();
      EXPECT_EQ(text.find("drawn.glb:portal.1: "), text.rfind("drawn.glb"));
      return text.substr(text.find(": ") + 2);
    }
    return "";
  }

  Scene scene_ = read_gltf(two_rooms_path());

 private:
  const testing::TempFolder folder_;
};

Portal scaled(Portal portal, double factor) {
  for (Vec3d& v : portal.vertices) v = v * factor;
  return portal;
}
/// A corner of the hole's portal, 0.25 m wide, lifted out of its plane.
Portal bent(double by) {
  Portal portal = portal_in_the_hole();
  portal.vertices[2].x += by;
  return portal;
}

TEST_F(given_portals, what_is_flat_is_taken_as_drawn) {
  Portal fan = portal_in_the_hole(), frame = fan, turned = fan, back = fan, doubled = fan;
  fan.vertices.push_back({2.05, 1, 0});
  fan.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  for (const Vec3d& v : fan.vertices) frame.vertices.push_back(v * 0.5 + fan.vertices[4] * 0.5);
  frame.triangles.clear();  // around a hole of half its size
  for (uint32_t i = 0; i < 4; ++i) {
    frame.triangles.push_back({i, (i + 1) % 4, 4 + i});
    frame.triangles.push_back({(i + 1) % 4, 4 + (i + 1) % 4, 4 + i});
  }
  std::swap(turned.triangles[1][1], turned.triangles[1][2]);
  for (auto& t : back.triangles) std::swap(t[1], t[2]);
  for (const auto& t : back.triangles) doubled.triangles.push_back(t);
  const std::vector<Portal> drawn{portal_in_the_hole(), fan, frame, turned, back, doubled,
                                  bent(0.003)};
  const GivenPortals taken = given(drawn);
  EXPECT_EQ(taken.warnings, Strings{});
  EXPECT_EQ(taken.notes, Strings{});
  ASSERT_EQ(taken.file.portals.size(), drawn.size());
  for (size_t i = 0; i < drawn.size(); ++i) {
    const Portal& portal = taken.file.portals[i];
    EXPECT_EQ(portal.triangles, drawn[i].triangles);
    EXPECT_EQ(PortalSet({portal}, scene_.frame).size(), portal.triangles.size() + 1) << i;
  }
}

TEST_F(given_portals, what_is_not_flat_is_refused) {
  EXPECT_TRUE(refused(bent(0.01)).starts_with("is not flat: its corners lie up to 0.0033 m off"));
  const auto is_not_flat = [&](const Portal& portal) {
    return refused(portal).starts_with("is not flat: ");
  };
  EXPECT_FALSE(is_not_flat(bent(0.003)));
  Portal roof = portal_in_the_hole(), two = roof;
  roof.vertices.push_back({2.06, 0.875, -0.125});
  roof.vertices.push_back({2.06, 0.875, 0.125});
  roof.triangles.insert(roof.triangles.end(), {{3, 2, 5}, {3, 5, 4}});
  EXPECT_TRUE(is_not_flat(roof));
  // Two openings in one mesh, in walls that face each other; and with what is between them.
  for (const Vec3d& v : portal_in_the_hole().vertices) two.vertices.push_back(v - Vec3d(1, 0, 0));
  two.triangles.insert(two.triangles.end(), {{4, 6, 5}, {4, 7, 6}});
  EXPECT_TRUE(is_not_flat(two));
  two.triangles.insert(two.triangles.end(), {{0, 5, 1}, {0, 4, 5}, {1, 6, 2}, {1, 5, 6}});
  EXPECT_TRUE(is_not_flat(two));
}

TEST_F(given_portals, one_without_an_area_that_counts_is_refused) {
  const Portal hole = portal_in_the_hole();
  const Portal speck = rectangle(hole.vertices[0], {0, 0, 1e-12}, {0, 1e-12, 0});
  EXPECT_TRUE(refused(speck).starts_with("is too small, its area is 1e-24 m2"));
  const Portal small = rectangle(hole.vertices[0], {0, 0, 1e-6}, {0, 1e-6, 0});
  EXPECT_EQ(PortalSet(given({small}).file.portals, scene_.frame).size(), 3u);
}

TEST_F(given_portals, one_far_from_the_scene_is_refused) {
  EXPECT_TRUE(refused(scaled(portal_in_the_hole(), 100)).starts_with("reaches 200 m beyond"));
  EXPECT_TRUE(refused(rectangle({1, -100, -80}, {0, 0, 160}, {0, 120, 0})).starts_with("reaches"));
  EXPECT_TRUE(refused(scaled(portal_in_the_hole(), 1e12)).starts_with("reaches"));
  // Light from infinity passes in front of a house, too; a lamp out there is part of the scene.
  const auto at = [](double z) { return rectangle({2, 0.8, z}, {0, 0, 0.25}, {0, 0.25, 0}); };
  EXPECT_EQ(refused(at(10)), "");
  EXPECT_EQ(refused(at(-10)), "");
  EXPECT_NE(refused(at(30)), "");
  scene_.lights = {PunctualLight()};
  scene_.lights[0].kind = PunctualLight::Kind::point;
  scene_.lights[0].position = scene_.frame.to_canonical({2, 0.8, 40});
  EXPECT_EQ(refused(at(30)), "");
}

TEST_F(given_portals, for_another_scene_or_camera_they_are_used_with_a_word) {
  const GivenPortals one = given({portal_in_the_hole()}, "0123");
  EXPECT_EQ(one.file.portals.size(), 1u);
  EXPECT_EQ(one.warnings, Strings{});
  EXPECT_TRUE(says(one.notes, "another state of the scene"));
  EXPECT_EQ(given({portal_in_the_hole()}, scene_.hash).notes, Strings{});
  EXPECT_TRUE(says(given({}).notes, "there is no portal in "));
  const auto warned = [&](const Camera& made_for) {
    return given({portal_in_the_hole()}, scene_.hash, viewpoint_text(scene_.frame, made_for))
        .warnings;
  };
  Camera other = scene_.camera("");
  other.name = "another name for the same";
  EXPECT_EQ(warned(other), Strings{});
  other.name = "door";
  other.culls = true;
  EXPECT_EQ(warned(other).size(), 1u);
  other.culls = false;
  other.position = other.position + other.right * (1.5 * scene_.frame.scale);
  EXPECT_TRUE(says(warned(other), "for camera \"door\"; \"camera\" is 1.5 m away"));
}

TEST_F(given_portals, those_of_other_cameras_of_the_file_are_left_out) {
  const Camera own = scene_.camera("");
  Camera yard = own;
  yard.name = "yard";
  yard.position = yard.position + yard.right * (1.5 * scene_.frame.scale);
  PortalFile file;
  for (const Camera& camera : {yard, own})
    file.made_for.push_back(viewpoint_text(scene_.frame, camera));
  file.portals.assign(3, portal_in_the_hole());
  file.portals[0].cameras = {{"yard", 0.9}};
  file.portals[1].cameras = {{"yard", 0.9}, {own.name, 0.25}};
  const GivenPortals mine = given(file, own);
  EXPECT_EQ(mine.warnings, Strings{});
  ASSERT_EQ(mine.file.portals.size(), 2u);
  EXPECT_EQ(mine.file.portals[0].name, "portal.1");
  EXPECT_EQ(mine.file.portals[0].figures.at("flux_share"), 0.25);
  EXPECT_TRUE(says(mine.notes, "1 of its 3 portals serve other cameras"));
  // A camera that the file does not know has all of them.
  Camera other = own;
  other.position = other.position + other.right * (3 * scene_.frame.scale);
  const GivenPortals all = given(file, other);
  EXPECT_EQ(all.file.portals.size(), 3u);
  EXPECT_TRUE(says(all.warnings, "\"camera\" is 3 m away"));
}

TEST_F(given_portals, those_for_poses_of_a_shot_are_all_taken_without_a_word) {
  const Camera own = scene_.camera("");
  PortalFile file;
  file.scene_hash = scene_.hash + "@another pose";
  for (const int64_t frame : {1, 9}) {
    Camera pose = own;
    pose.name = camera_at_frame(own.name, frame);
    pose.position = pose.position + pose.right * (0.3 * static_cast<double>(frame));
    file.made_for.push_back(viewpoint_text(scene_.frame, pose));
    file.portals.push_back(portal_in_the_hole());
    file.portals.back().cameras = {{pose.name, 0.5}};
  }
  const GivenPortals at_a_frame = given(file, own, 4);
  EXPECT_EQ(at_a_frame.file.portals.size(), 2u);
  EXPECT_EQ(at_a_frame.warnings, Strings{});
  EXPECT_EQ(at_a_frame.notes, Strings{});
  // Those of another camera's shot are told of, and so is another time of a picture.
  Camera other = own;
  other.name = "other";
  EXPECT_EQ(given(file, other, 4).warnings.size(), 1u);
  const GivenPortals of_a_picture = given(file, own);
  EXPECT_EQ(of_a_picture.warnings.size(), 1u);
  EXPECT_TRUE(says(of_a_picture.notes, "another time of its animations"));
}

TEST_F(given_portals, the_scene_itself_and_other_large_meshes_are_refused) {
  EXPECT_THROW(read_given_portals(two_rooms_path(), scene_, scene_.camera("")), InputError);
  EXPECT_THROW(read_given_portals(furnace_path(), scene_, scene_.camera("")), InputError);
  Portal fine = portal_in_the_hole();
  while (fine.triangles.size() < 4096) fine.triangles.push_back(fine.triangles[0]);
  EXPECT_EQ(given({fine}).file.portals.size(), 1u);
  fine.triangles.push_back(fine.triangles[0]);
  EXPECT_THROW(given({fine}), InputError);
}

}  // namespace tdpt::given_portals_test
