// Portals drawn by hand are checked before rendering, each case with its message.
#include "tools/tdpt-render/portals/given_portals.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "libcommon/base/error.h"
#include "libcommon/options/shot_options.h"
#include "libcommon/formats/viewpoint.h"
#include "tools/tdpt-render/portals/portal_fit.h"
#include "tools/tdpt-render/testing/rooms.h"

namespace tdpt::given_portals_test {

using Strings = std::vector<std::string>;

class given_portals : public ::testing::Test {
 protected:
  given_portals()
      : folder_(std::filesystem::temp_directory_path() /
                ("given_portals_test." + std::to_string(::getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~given_portals() override { std::filesystem::remove_all(folder_); }

  GivenPortals given(const std::vector<Portal>& portals, const std::string& hash = "",
                     const std::string& made_for = "") const {
    PortalFile file;
    if (!made_for.empty()) file.made_for = {made_for};
    file.portals = portals;
    file.scene_hash = hash;
    return given(file, scene_.camera(""));
  }
  GivenPortals given(const PortalFile& file, const Camera& camera,
                     std::optional<int64_t> frame = {}) const {
    const std::string path = (folder_ / "drawn.glb").string();
    std::ofstream(path, std::ios::binary) << portal_bytes(file);
    return read_given_portals(path, scene_, camera, frame);
  }
  std::string refused(const std::string& path) const {
    try {
      read_given_portals(path, scene_, scene_.camera(""));
    } catch (const InputError& e) {
      const std::string text = e.what();
      return text.substr(text.find(": ") + 2);
    }
    return "no error";
  }
  std::string refused(const std::vector<Portal>& portals) const {
    try {
      given(portals);
    } catch (const InputError& e) {
      const std::string text = e.what();
      return text.substr(text.find(": ") + 2);
    }
    return "no error";
  }

  Scene scene_ = read_gltf(two_rooms_path());

 private:
  std::filesystem::path folder_;
};

Portal scaled(Portal portal, double factor) {
  for (Vec3d& v : portal.vertices) v = v * factor;
  return portal;
}
Portal box(const Vec3d& low, double size) {
  Portal body{"box", {}, {}, {}};
  for (uint32_t i = 0; i < 8; ++i)
    body.vertices.push_back(low +
                            Vec3d(i & 1 ? size : 0.0, i & 2 ? size : 0.0, i & 4 ? size : 0.0));
  for (const auto& f : {std::array<uint32_t, 4>{0, 2, 3, 1},
                        {4, 5, 7, 6},
                        {0, 1, 5, 4},
                        {2, 6, 7, 3},
                        {0, 4, 6, 2},
                        {1, 3, 7, 5}}) {
    body.triangles.push_back({f[0], f[1], f[2]});
    body.triangles.push_back({f[0], f[2], f[3]});
  }
  return body;
}

TEST_F(given_portals, nothing_is_said_of_one_that_is_well_drawn) {
  const GivenPortals one = given({portal_in_the_hole()});
  EXPECT_EQ(one.file.portals.size(), 1u);
  EXPECT_EQ(one.warnings, Strings{});
  EXPECT_EQ(one.notes, Strings{});
}

TEST_F(given_portals, outside_the_scene_they_are_left_out) {
  const GivenPortals two =
      given({portal_in_the_hole(), rectangle({2, 0.8, 30}, {0, 0, 0.25}, {0, 0.25, 0})});
  EXPECT_EQ(two.file.portals.size(), 1u);
  EXPECT_EQ(two.warnings, Strings{"portal.1: lies outside the scene: left out"});
  // Partly inside, reaching far out: it is used.
  EXPECT_EQ(given({rectangle({2, 0.8, -9}, {0, 0, 18}, {0, 0.25, 0})}).warnings, Strings{});
}

// Light from infinity passes in front of a house, too; a lamp out there is part of the scene.
TEST_F(given_portals, outside_the_scene_they_are_taken_if_light_comes_from_there) {
  const auto taken = [&](double z) {
    return given({rectangle({2, 0.8, z}, {0, 0, 0.25}, {0, 0.25, 0})}).file.portals.size();
  };
  const double side = scene_.frame.to_metres({0, 0, 1}).z;
  EXPECT_EQ(taken(side + 1), 0u);
  scene_.sky = std::make_shared<const Sky>(Sky::Map{1, 1, {Rgb(1)}}, 0);
  for (const double z : {side + 0.01, side + 1, -side - 1}) EXPECT_EQ(taken(z), 1u) << z;
  EXPECT_EQ(taken(side + 30), 0u);
  EXPECT_EQ(given({scaled(portal_in_the_hole(), 3.28084)}).warnings,
            Strings{"portal.0: lies outside the scene, seems drawn in feet: left out"});
  scene_.sky = nullptr;
  scene_.lights = {PunctualLight()};
  scene_.lights[0].kind = PunctualLight::Kind::directional;
  EXPECT_EQ(taken(side + 1), 1u);
  scene_.lights[0].kind = PunctualLight::Kind::point;
  scene_.lights[0].position = {0, 0, 2};
  EXPECT_EQ(taken(side + 1), 1u);
  scene_.lights[0].position = {0, 0, 0};
  EXPECT_EQ(taken(side + 1), 0u);
}

TEST_F(given_portals, in_another_unit_they_are_left_out_and_told_so) {
  const auto said = [&](double factor) {
    const GivenPortals one = given({scaled(portal_in_the_hole(), factor)});
    EXPECT_EQ(one.file.portals.size(), 0u);
    EXPECT_EQ(one.warnings.size(), 1u);
    return one.warnings.empty() ? "" : one.warnings[0];
  };
  EXPECT_EQ(said(100), "portal.0: lies outside the scene, seems drawn in centimetres: left out");
  EXPECT_EQ(said(1000), "portal.0: lies outside the scene, seems drawn in millimetres: left out");
  EXPECT_EQ(said(39.3701), "portal.0: lies outside the scene, seems drawn in inches: left out");
  EXPECT_EQ(said(-50), "portal.0: lies outside the scene: left out");
  // It fills no opening in any unit, but is too large in the one it was drawn in.
  const auto loose = [&](double factor) {
    const Portal portal = scaled(rectangle({1, 0.5, -0.5}, {0, 0, 0.8}, {0, 0.7, 0}), factor);
    return given({portal}).warnings;
  };
  EXPECT_EQ(loose(100),
            Strings{"portal.0: lies outside the scene, perhaps drawn in centimetres: left out"});
  EXPECT_EQ(loose(1000),
            Strings{"portal.0: lies outside the scene, perhaps drawn in millimetres: left out"});
  EXPECT_EQ(loose(1), Strings{});
  const GivenPortals wall = given({rectangle({1, -100, -80}, {0, 0, 160}, {0, 120, 0})});
  EXPECT_EQ(wall.warnings, Strings{"portal.0: is 39 times as large as the scene: left out"});
}

TEST_F(given_portals, a_portal_fits_its_opening_and_nothing_else) {
  const Tracer tracer(scene_);
  EXPECT_GT(fit_of(portal_in_the_hole(), 1, tracer, scene_.frame), 0.9);
  EXPECT_LT(fit_of(portal_in_the_hole(), 0.3, tracer, scene_.frame), 0.2);
  EXPECT_LT(fit_of(rectangle({1, 0.5, -0.5}, {0, 0, 0.3}, {0, 0.3, 0}), 1, tracer, scene_.frame),
            0.2);
  // At a hundredth of the scene's size it lies in a corner of the air.
  EXPECT_EQ(unit_words(scaled(portal_in_the_hole(), 0.01), tracer, scene_.frame),
            "seems drawn for the same scene in a hundredth of its size");
  EXPECT_EQ(unit_words(portal_in_the_hole(), tracer, scene_.frame), "");
}

TEST_F(given_portals, bodies_and_folded_ones_are_left_out) {
  Portal folded = rectangle({2.05, 0.875, -0.125}, {0, 0, 0.25}, {0, 0.25, 0});
  folded.vertices.push_back({2.06, 0.875, -0.125});
  folded.vertices.push_back({2.06, 0.875, 0.125});
  folded.triangles.push_back({3, 2, 5});
  folded.triangles.push_back({3, 5, 4});
  const GivenPortals three = given({box({2, 0.9, -0.1}, 0.1), folded, portal_in_the_hole()});
  ASSERT_EQ(three.file.portals.size(), 1u);
  EXPECT_EQ(three.file.portals[0].name, "portal.2");
  EXPECT_EQ(three.warnings,
            (Strings{"portal.0: is a closed body, expected a planar polygon: left out",
                     "portal.1: is folded, its triangles face all ways, expected a planar polygon: "
                     "left out"}));
}

TEST_F(given_portals, what_is_changed_is_told) {
  Portal bent = portal_in_the_hole(), far_bent = bent, fan = bent, turned = bent;
  bent.vertices[2].x += 0.01;
  far_bent.vertices[2].x += 0.1;
  fan.vertices.push_back({2.05, 1, 0});
  fan.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  std::swap(turned.triangles[1][1], turned.triangles[1][2]);
  const GivenPortals four = given({bent, far_bent, fan, turned});
  EXPECT_EQ(four.file.portals.size(), 4u);
  EXPECT_EQ(four.warnings,
            (Strings{"portal.0: is not planar, corners lie 0.0033 m off its plane: laid into it",
                     "portal.1: is not planar: used as 2 planes"}));
  EXPECT_EQ(four.notes,
            (Strings{"portal.2: 2 triangles cover the same as its 4",
                     "portal.3: some triangles faced another way than their neighbours: turned"}));
}

TEST_F(given_portals, a_dome_is_told_to_be_its_rim) {
  Portal dome{"dome", {{2.2, 1, 0}}, {}, {}};
  for (uint32_t i = 0; i < 16; ++i) {
    const double a = 2 * std::numbers::pi * i / 16;
    dome.vertices.push_back({2.05, 1 + 0.2 * std::sin(a), 0.2 * std::cos(a)});
    dome.triangles.push_back({0, 1 + i, 1 + (i + 1) % 16});
  }
  const GivenPortals one = given({dome});
  EXPECT_EQ(one.warnings, Strings{"portal.0: is not planar, but its rim is: the polygon in its rim "
                                  "is used"});
  EXPECT_EQ(one.file.portals.at(0).triangles.size(), 14u);
}

TEST_F(given_portals, of_another_state_of_the_scene_they_are_used_with_a_word) {
  const GivenPortals one = given({portal_in_the_hole()}, "0123");
  EXPECT_EQ(one.file.portals.size(), 1u);
  EXPECT_EQ(one.warnings, Strings{});
  ASSERT_EQ(one.notes.size(), 1u);
  EXPECT_NE(one.notes[0].find("drawn.glb was made for another state of the scene"),
            std::string::npos);
  EXPECT_EQ(given({portal_in_the_hole()}, scene_.hash).notes, Strings{});
}

TEST_F(given_portals, for_another_camera_they_are_used_with_a_warning) {
  const Camera own = scene_.camera("");
  const auto warned = [&](const Camera& made_for) {
    return given({portal_in_the_hole()}, scene_.hash, viewpoint_text(scene_.frame, made_for))
        .warnings;
  };
  EXPECT_EQ(warned(own), Strings{});
  Camera other = own;
  other.name = "another name for the same";
  EXPECT_EQ(warned(other), Strings{});
  other.name = "door";
  other.position = other.position + other.right * (1.5 * scene_.frame.scale);
  const Strings told = warned(other);
  ASSERT_EQ(told.size(), 1u);
  EXPECT_EQ(told[0].substr(told[0].find("its portals")),
            "its portals were found for camera \"door\"; \"camera\" is 1.5 m away: portals belong "
            "to a camera");
  other = own;
  other.culls = true;
  EXPECT_EQ(warned(other).size(), 1u);
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
  ASSERT_EQ(mine.notes.size(), 1u);
  EXPECT_NE(mine.notes[0].find("drawn.glb: 1 of its 3 portals serve other cameras"),
            std::string::npos);
  // A camera that the file does not know has all of them.
  Camera other = own;
  other.position = other.position + other.right * (3 * scene_.frame.scale);
  const GivenPortals all = given(file, other);
  EXPECT_EQ(all.file.portals.size(), 3u);
  ASSERT_EQ(all.warnings.size(), 1u);
  EXPECT_NE(
      all.warnings[0].find("its portals were found for camera \"camera\"; \"camera\" is 3 m away"),
      std::string::npos)
      << all.warnings[0];
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
  ASSERT_EQ(of_a_picture.notes.size(), 1u);
  EXPECT_NE(of_a_picture.notes[0].find("drawn.glb was made for the scene at another time of its "
                                       "animations"),
            std::string::npos);
}

TEST_F(given_portals, a_file_without_portals_is_a_note) {
  const GivenPortals none = given({});
  EXPECT_EQ(none.warnings, Strings{});
  ASSERT_EQ(none.notes.size(), 1u);
  EXPECT_NE(none.notes[0].find("there is no portal in "), std::string::npos);
}

constexpr const char* kExpected = ", expected portals: planar polygons that fill openings";

TEST_F(given_portals, a_whole_scene_is_refused) {
  EXPECT_EQ(refused(two_rooms_path()), std::string("is the scene itself") + kExpected);
  // Most of the scene's triangles, in another file.
  std::vector<Portal> walls;
  for (uint32_t t = 0; t + 6 < scene_.triangles.size(); ++t) {
    Portal& wall = walls.emplace_back();
    for (int i = 0; i < 3; ++i)
      wall.vertices.push_back(scene_.frame.to_metres(Vec3d(scene_.vertex(t, i))));
    wall.triangles = {{0, 1, 2}};
  }
  EXPECT_EQ(refused(walls).find("holds "), 0u) << refused(walls);
  EXPECT_NE(refused(walls).find("of the scene's"), std::string::npos) << refused(walls);
  // Other scenes: with a camera and lamps; with bodies only.
  EXPECT_EQ(refused(TDPT_TESTDATA "/scenes/three-rooms.glb").find("holds "), 0u);
  EXPECT_EQ(refused(furnace_path()).find("holds 1 bodies among 1 meshes"), 0u)
      << refused(furnace_path());
  std::vector<Portal> bodies{box({1, 0, 0}, 0.1), box({1, 0.3, 0}, 0.1), box({1, 0.6, 0}, 0.1)};
  EXPECT_EQ(refused(bodies), std::string("holds 3 bodies among 3 meshes") + kExpected);
  bodies.push_back(scaled(portal_in_the_hole(), 1));
  EXPECT_EQ(refused(bodies), std::string("holds 3 bodies among 4 meshes") + kExpected);
}

// Panes and the glass of lamps, which are triangles of the scene, may be portals.
TEST_F(given_portals, a_copy_of_a_pane_is_a_portal) {
  std::vector<Portal> panes;
  for (uint32_t t = 0; t < 8; ++t) {
    Portal& pane = panes.emplace_back();
    for (int i = 0; i < 3; ++i)
      pane.vertices.push_back(scene_.frame.to_metres(Vec3d(scene_.vertex(t, i))));
    pane.triangles = {{0, 1, 2}};
  }
  EXPECT_EQ(given(panes).file.portals.size(), 8u);
}

}  // namespace tdpt::given_portals_test
