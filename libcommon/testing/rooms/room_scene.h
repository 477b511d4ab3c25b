// Building blocks of the rooms of rooms.h and glossy_rooms.h.
//
// Metres, +Y up. Rooms are arranged along +x, each 2 m wide, 2 m high and 2 m deep (z -1..1); walls
// between rooms are 0.1 m thick. Surfaces share corners exactly and no corner lies inside another's
// edge, so the rooms are watertight for any ray tracer.
#pragma once
#include "libcommon/math/vec.h"
#include "libcommon/testing/files/glb_builder.h"

namespace tdpt::testing {

using Json = nlohmann::ordered_json;

inline constexpr double kRoom = 2, kWall = 0.1;
inline constexpr double kFov = 1.0, kAspect = 4.0 / 3.0;

/// Quads of one material; counter-clockwise seen from their front.
struct Quads {
  std::vector<Vec3d> corners;
  void add(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    corners.insert(corners.end(), {a, b, c, d});
  }
};

/// Opening in a wall between rooms: y and z extents.
struct Opening {
  double y0, y1, z0, z1;
};

class RoomScene {
 public:
  RoomScene() {
    b.json["extensionsUsed"] = {"KHR_materials_emissive_strength", "KHR_materials_specular"};
  }

  int diffuse(const std::string& name, double r, double g, double blue) {
    return b.material({{"name", name},
                       {"pbrMetallicRoughness", lambert(r, g, blue)},
                       {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}},
                       {"doubleSided", true}});
  }
  /// Emits on its front side only.
  int emitter(const std::string& name, double rho, std::array<double, 3> colour, double strength) {
    Json m = {{"name", name},
              {"pbrMetallicRoughness", lambert(rho, rho, rho)},
              {"emissiveFactor", colour},
              {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0}}}}}};
    if (strength != 1)
      m["extensions"]["KHR_materials_emissive_strength"] = {{"emissiveStrength", strength}};
    return b.material(m);
  }

  void part(const std::string& name, int material, const Quads& q, Json placement = {}) {
    std::vector<float> positions, normals;
    std::vector<uint16_t> indices;
    for (size_t i = 0; i < q.corners.size(); i += 4) {
      const Vec3d n =
          normalize(cross(q.corners[i + 1] - q.corners[i], q.corners[i + 2] - q.corners[i]));
      for (size_t k = 0; k < 4; ++k)
        for (int c = 0; c < 3; ++c) {
          positions.push_back(static_cast<float>(q.corners[i + k][c]));
          normals.push_back(static_cast<float>(n[c]));
        }
      for (size_t k : {0, 1, 2, 0, 2, 3}) indices.push_back(static_cast<uint16_t>(i + k));
    }
    const int position = b.floats(positions, 3), normal = b.floats(normals, 3);
    Json primitive = {{"attributes", {{"POSITION", position}, {"NORMAL", normal}}},
                      {"indices", b.indices_u16(indices)},
                      {"material", material}};
    Json node = {{"name", name}, {"mesh", b.mesh(primitive, name)}};
    if (!placement.is_null()) node.update(placement);
    b.node(node);
  }

  /// Materials of a row's surfaces.
  struct Walls {
    int floor, grey, back, front;
    bool open = false;  ///< the last room has no end wall
  };
  /// `rooms` rooms in a row, with one opening in each wall between them.
  void row(int rooms, const Opening& hole) {
    const int grey = diffuse("grey", 0.7, 0.7, 0.7), red = diffuse("red", 0.65, 0.5, 0.5),
              green = diffuse("green", 0.5, 0.65, 0.5);
    row(rooms, hole, {grey, grey, red, green});
  }
  void row(int rooms, const Opening& hole, const Walls& walls) {
    for (int i = 0; i < rooms; ++i) {
      const double x0 = i * (kRoom + kWall), x1 = x0 + kRoom;
      const std::string name = "room." + std::to_string(i);
      Quads shell, floor;
      (walls.floor == walls.grey ? shell : floor)
          .add({x0, 0, 1}, {x1, 0, 1}, {x1, 0, -1}, {x0, 0, -1});
      shell.add({x0, 2, -1}, {x1, 2, -1}, {x1, 2, 1}, {x0, 2, 1});  // ceiling
      if (i == 0) shell.add({x0, 0, 1}, {x0, 0, -1}, {x0, 2, -1}, {x0, 2, 1});
      if (i == rooms - 1 && !walls.open)
        shell.add({x1, 0, -1}, {x1, 0, 1}, {x1, 2, 1}, {x1, 2, -1});
      part(name + ".shell", walls.grey, shell);
      if (!floor.corners.empty()) part(name + ".floor", walls.floor, floor);
      Quads back, front;
      back.add({x0, 0, -1}, {x1, 0, -1}, {x1, 2, -1}, {x0, 2, -1});
      front.add({x1, 0, 1}, {x0, 0, 1}, {x0, 2, 1}, {x1, 2, 1});
      part(name + ".back", walls.back, back);
      part(name + ".front", walls.front, front);
      if (i > 0) part("wall." + std::to_string(i - 1), walls.grey, wall(x0 - kWall, x0, hole));
    }
  }

  /// Horizontal lamp 1 cm below the ceiling, shining down; r: half its side.
  void ceiling_lamp(double x, double radiance, double r = 0.25) {
    Quads q;
    const double y = 1.99;
    q.add({x - r, y, -r}, {x + r, y, -r}, {x + r, y, r}, {x - r, y, r});
    part("lamp", emitter("lamp", 0, {1, 1, 1}, radiance), q);
  }

  GlbBuilder b;

 private:
  static Json lambert(double r, double g, double blue) {
    return {{"baseColorFactor", {r, g, blue, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 1}};
  }

  // Two faces of four trapezoids around the opening each, and the four jambs.
  static Quads wall(double xa, double xb, const Opening& h) {
    const double oy[] = {0, 0, 2, 2}, oz[] = {-1, 1, 1, -1};
    const double iy[] = {h.y0, h.y0, h.y1, h.y1}, iz[] = {h.z0, h.z1, h.z1, h.z0};
    Quads q;
    for (int k = 0; k < 4; ++k) {
      const int n = (k + 1) % 4;
      q.add({xa, oy[n], oz[n]}, {xa, iy[n], iz[n]}, {xa, iy[k], iz[k]}, {xa, oy[k], oz[k]});
      q.add({xb, oy[k], oz[k]}, {xb, iy[k], iz[k]}, {xb, iy[n], iz[n]}, {xb, oy[n], oz[n]});
      q.add({xa, iy[k], iz[k]}, {xa, iy[n], iz[n]}, {xb, iy[n], iz[n]}, {xb, iy[k], iz[k]});
    }
    return q;
  }
};

}  // namespace tdpt::testing
