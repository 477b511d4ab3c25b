#include "libcommon/testing/rooms/rooms.h"

#include "libcommon/testing/rooms/room_scene.h"

namespace tdpt::testing {
namespace {

/// Closed box with the given half sides, standing on y = 0 at the origin, faces outwards.
Quads block(double hx, double height, double hz) {
  const double y = height;
  Quads q;
  q.add({-hx, 0, hz}, {hx, 0, hz}, {hx, y, hz}, {-hx, y, hz});
  q.add({hx, 0, -hz}, {-hx, 0, -hz}, {-hx, y, -hz}, {hx, y, -hz});
  q.add({hx, 0, hz}, {hx, 0, -hz}, {hx, y, -hz}, {hx, y, hz});
  q.add({-hx, 0, -hz}, {-hx, 0, hz}, {-hx, y, hz}, {-hx, y, -hz});
  q.add({-hx, y, hz}, {hx, y, hz}, {hx, y, -hz}, {-hx, y, -hz});
  q.add({-hx, 0, -hz}, {hx, 0, -hz}, {hx, 0, hz}, {-hx, 0, hz});
  return q;
}

/// A visible object for the camera's room.
void add_block(RoomScene& s) {
  const int white = s.diffuse("white", 0.7, 0.68, 0.62);
  // Turned by 0.35 rad about +Y: rotation (0, sin 0.175, 0, cos 0.175).
  s.part("block", white, block(0.25, 0.55, 0.25),
         {{"translation", {1.25, 0.001, -0.45}}, {"rotation", {0, 0.174108, 0, 0.984727}}});
}

/// Two rooms with a square hole with this side in the middle of their wall.
std::string two_rooms(double side) {
  RoomScene s;
  s.row(2, {1 - side / 2, 1 + side / 2, -side / 2, side / 2});
  s.ceiling_lamp(3.1, 20);
  add_block(s);
  s.b.camera("camera", {0.15, 1.25, 0.75}, {2, 0.8, -0.25}, kFov, kAspect);
  return s.b.glb();
}

std::string window() {
  RoomScene s;
  s.row(2, {0.2, 1.8, -0.8, 0.8});
  s.ceiling_lamp(3.1, 20);
  add_block(s);
  s.b.camera("camera", {0.15, 1.25, 0.75}, {2, 0.8, -0.25}, kFov, kAspect);
  return s.b.glb();
}

std::string three_rooms() {
  RoomScene s;
  s.row(3, {0.75, 1.25, -0.25, 0.25});
  s.ceiling_lamp(5.2, 40);
  add_block(s);
  s.b.camera("camera", {0.15, 1.25, 0.75}, {2, 0.8, -0.25}, kFov, kAspect);
  return s.b.glb();
}

// The leaf is hinged at z = -0.42 on the camera's side of the wall and overlaps the opening by 2 cm
// on every side; its hinge edge is 1 mm inside the wall, so no light passes behind it.
std::string door_ajar() {
  RoomScene s;
  s.row(2, {0.02, 1.82, -0.4, 0.4});
  const int wood = s.diffuse("wood", 0.6, 0.5, 0.4);
  Quads leaf = block(0.02, 1.83, 0.42);
  for (Vec3d& p : leaf.corners) p = p + Vec3d(-0.02, 0, 0.42);
  // Opened by 8 degrees: rotation (0, -sin 4 deg, 0, cos 4 deg).
  s.part("door", wood, leaf,
         {{"translation", {2.001, 0.005, -0.42}}, {"rotation", {0, -0.069756, 0, 0.997564}}});
  Quads lamp;  // 0.9 m behind the door, shining away from it
  lamp.add({3, 1.2, 0.25}, {3, 1.2, -0.25}, {3, 1.6, -0.25}, {3, 1.6, 0.25});
  s.part("lamp", s.emitter("lamp", 0, {1, 1, 1}, 50), lamp);
  s.b.camera("camera", {0.2, 1.3, -0.7}, {2, 0.8, 0.3}, kFov, kAspect);
  return s.b.glb();
}

std::string furnace() {
  RoomScene s;
  s.b.json["extensionsUsed"] = Json::array({"KHR_materials_specular"});
  Quads q = block(1, 2, 1);
  for (size_t i = 0; i < q.corners.size(); i += 4) std::swap(q.corners[i + 1], q.corners[i + 3]);
  s.part("box", s.emitter("glow", 0.5, {1, 1, 1}, 1), q);
  s.b.camera("camera", {-0.4, 0.9, 0.6}, {1, 1.1, -0.8}, kFov, kAspect);
  return s.b.glb();
}

}  // namespace

std::vector<NamedScene> make_scenes() {
  return {{"two-rooms.glb", two_rooms(0.25)},
          {"small-hole.glb", two_rooms(0.1)},
          {"half-metre-hole.glb", two_rooms(0.5)},
          {"door-ajar.glb", door_ajar()},
          {"window.glb", window()},
          {"three-rooms.glb", three_rooms()},
          {"furnace.glb", furnace()}};
}

}  // namespace tdpt::testing
