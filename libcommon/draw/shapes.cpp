#include "libcommon/draw/shapes.h"

#include <array>
#include <cmath>

#include <nlohmann/json.hpp>

#include "libcommon/formats/glb.h"
#include "tdpt_version.h"

namespace tdpt::draw {

namespace {

using Json = nlohmann::ordered_json;

// Vertex colours are linear in glTF.
uint8_t linear(float srgb) {
  const auto c = static_cast<double>(srgb);
  return static_cast<uint8_t>(
      std::lround(255 * (c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4))));
}

// A node, a mesh, a material and two accessors.
void add_shape(Glb<Json>& glb, const Shape& shape) {
  // Floats are relative to the centre, which is in the node's transform, so nothing is lost far
  // from the origin.
  Vec3d low(INFINITY), high(-INFINITY);
  for (const Vec3d& p : shape.positions) low = min(low, p), high = max(high, p);
  const Vec3d middle = (low + high) * 0.5;
  std::vector<Vec3f> positions;
  for (const Vec3d& p : shape.positions) positions.emplace_back(p - middle);
  std::vector<std::array<uint8_t, 4>> colours;
  bool opaque = true;
  for (const Paint& p : shape.paints) {
    colours.push_back({linear(p.ink.x), linear(p.ink.y), linear(p.ink.z),
                       static_cast<uint8_t>(std::lround(255 * p.alpha))});
    opaque = opaque && p.alpha >= 1;
  }
  const size_t position = glb.add_positions(positions),
               colour = glb.add_accessor(colours, colours.size(), "VEC4", glb.byte, glb.vertices);
  glb.root["accessors"][colour]["normalized"] = true;

  Json material = {{"name", shape.name},
                   {"pbrMetallicRoughness", {{"metallicFactor", 0.0}}},
                   {"doubleSided", true},
                   {"extensions", {{"KHR_materials_unlit", Json::object()}}}};
  if (!opaque) material["alphaMode"] = "BLEND";
  static constexpr int kMode[] = {0, 1, 4};
  const size_t n = glb.root["meshes"].size();
  glb.root["materials"].push_back(material);
  glb.root["meshes"].push_back(
      {{"name", shape.name},
       {"primitives", Json::array({{{"attributes", {{"POSITION", position}, {"COLOR_0", colour}}},
                                    {"material", n},
                                    {"mode", kMode[static_cast<size_t>(shape.kind)]}}})}});
  glb.root["nodes"].push_back(
      {{"name", shape.name}, {"mesh", n}, {"translation", {middle.x, middle.y, middle.z}}});
  glb.root["scenes"][0]["nodes"].push_back(n);
  glb.root["extensionsUsed"] = {"KHR_materials_unlit"};
}

}  // namespace

void Shape::point(const Vec3d& at, const Paint& c) {
  positions.push_back(at);
  paints.push_back(c);
}

void Shape::line(const Vec3d& a, const Vec3d& b, const Paint& at_a, const Paint& at_b) {
  point(a, at_a);
  point(b, at_b);
}

void Shape::arrow(const Vec3d& from, const Vec3d& way, const Vec3d& x, const Vec3d& y,
                  const Paint& p) {
  const Vec3d tip = from + way;
  const double head = 0.12 * length(way);
  line(from, tip, p);
  for (const Vec3d& side : {x, -x, y, -y}) line(tip, tip - way * 0.25 + side * head, p);
}

void Shape::triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Paint& colour) {
  for (const Vec3d& p : {a, b, c}) point(p, colour);
}

void Shape::square(const Vec3d& centre, const Vec3d& normal, double side, const Paint& c) {
  const Onb<double> frame(normal);
  const Vec3d x = frame.x * (0.5 * side), y = frame.y * (0.5 * side);
  triangle(centre - x - y, centre + x - y, centre + x + y, c);
  triangle(centre - x - y, centre + x + y, centre - x + y, c);
}

void Shape::cube(const Vec3d& centre, double side, const Paint& c) {
  for (int axis = 0; axis < 3; ++axis)
    for (const double sign : {-1.0, 1.0}) {
      Vec3d n{};
      n[axis] = sign;
      square(centre + n * (0.5 * side), n, side, c);
    }
}

std::string debug_glb_bytes(const std::vector<Shape>& shapes, const Provenance& provenance) {
  Glb<Json> glb;
  glb.root["asset"] = {{"version", "2.0"}, {"generator", "tdpt " TDPT_VERSION}};
  if (!provenance.empty()) glb.root["asset"]["extras"]["provenance"] = provenance.lines;
  glb.root["scene"] = 0;
  glb.root["scenes"] = Json::array({{{"name", "debug"}}});
  for (const Shape& shape : shapes)
    if (!shape.positions.empty()) add_shape(glb, shape);
  return glb.file();
}

}  // namespace tdpt::draw
