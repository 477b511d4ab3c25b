// Reads and writes portal files. They are ordinary glTF 2.0 from portalfit or any modelling
// program, so they are read with the same code and the same checks as scenes.
#include "libcommon/formats/portal.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "libcommon/base/words.h"
#include "libcommon/formats/format_version.h"
#include "libcommon/formats/glb.h"
#include "libcommon/formats/viewpoint.h"
#include "libcommon/scene/gltf/accessors.h"
#include "libcommon/scene/gltf/document.h"
#include "libcommon/scene/gltf/nodes.h"
#include "tdpt_version.h"

namespace tdpt {

namespace {

using Json = nlohmann::json;
using namespace gltf;

// Limits per file; flat triangles and repeated reads count, too, since a mesh may be instanced many
// times.
constexpr size_t kMostTriangles = 1'000'000, kMostVertices = 3 * kMostTriangles;

class PortalReader {
 public:
  explicit PortalReader(const Document& document) : d_(document) {}

  PortalFile read() {
    PortalFile file;
    file.hash = d_.hash;
    file.files = d_.files;
    read_asset(file);
    file.cameras = d_.cameras.size();
    read_lamps_and_materials(file);
    const PlacedNodes nodes = place_nodes(d_);
    for (const PlacedNode& n : nodes.of_scene)
      if (n.visible && d_.nodes[n.node].mesh != kNone) read_portal(n, file);
    return file;
  }

 private:
  void read_asset(PortalFile& file) const {
    const Json& asset = d_.json.at("asset");
    const auto extras = asset.find("extras");
    if (extras == asset.end() || !extras->is_object()) return;
    // Absent in portals modelled by hand.
    if (const auto version = extras->find(kPortalVersionKey); version != extras->end())
      if (const std::string fault = fault_of_version(version->dump(), format_version::portal);
          !fault.empty())
        d_.fail(fmt::format("asset.extras.{}", kPortalVersionKey), fault);
    if (const auto hash = extras->find("scene_hash"); hash != extras->end() && hash->is_string())
      file.scene_hash = hash->get<std::string>();
    if (const auto camera = extras->find("camera"); camera != extras->end())
      add_camera(*camera, file);
    if (const auto all = extras->find("cameras"); all != extras->end() && all->is_array())
      for (const Json& camera : *all) add_camera(camera, file);
    if (const auto lines = extras->find("provenance"); lines != extras->end() && lines->is_array())
      for (const Json& line : *lines)
        if (line.is_string()) file.provenance.lines.push_back(line.get<std::string>());
  }

  // Another program may use the name for something else.
  static void add_camera(const Json& camera, PortalFile& file) {
    if (!camera.is_string()) return;
    if (const auto text = camera.get<std::string>(); parse_viewpoint(text))
      file.made_for.push_back(text);
  }

  void read_lamps_and_materials(PortalFile& file) {
    for (const char* name : {"KHR_lights_punctual", "EXT_lights_ies", "EXT_lights_area"})
      file.lamps += d_.root().extension(name)["lights"].size();
    for (const Value& material : d_.root()["materials"].items()) {
      file.lamps += max_component(material["emissiveFactor"].triple({}, 0)) > 0;
      both_ways_.push_back(material["doubleSided"].boolean(false));
    }
  }

  void read_portal(const PlacedNode& n, PortalFile& file) {
    const Node& node = d_.nodes[n.node];
    const size_t m = node.mesh;
    const Mesh& mesh = d_.meshes[m];
    Portal portal;
    portal.name = !node.name.empty()   ? node.name
                  : !mesh.name.empty() ? mesh.name
                                       : fmt::format("portal.{}", file.portals.size());
    const Json& json = d_.json.at("nodes").at(n.node);
    if (const auto extras = json.find("extras"); extras != json.end() && extras->is_object())
      for (const auto& [key, value] : extras->items()) {
        if (value.is_number()) portal.figures[key] = value.get<double>();
        if (key != "cameras" || !value.is_object()) continue;
        for (const auto& [camera, share] : value.items())
          if (share.is_number()) portal.cameras[camera] = share.get<double>();
      }
    for (size_t p = 0; p < mesh.primitives.size(); ++p)
      add_primitive(mesh.primitives[p], fmt::format("meshes[{}].primitives[{}]", m, p), n.to_world,
                    portal);
    if (portal.triangles.empty()) d_.fail(place("nodes", n.node), "has no triangle with an area");
    file.portals.push_back(std::move(portal));
  }

  void add_primitive(const Primitive& p, const std::string& where, const Affine& map,
                     Portal& portal) {
    if (!p.is_surface()) return;  // points and lines enclose no area
    const bool list = p.mode == kTriangles, strip = p.mode == kStrip;
    const size_t accessor = find_attribute(p.attributes, "POSITION");
    if (accessor == kNone) d_.fail(where, "has no POSITION");
    if (p.material != kNone) portal.both_ways |= both_ways_[p.material];
    const std::vector<Vec3d> places = read_positions(d_, accessor);
    vertices_ += places.size();
    if (vertices_ > kMostVertices)
      d_.fail(where, fmt::format("more than {} vertices, too many for portals", kMostVertices));
    const size_t base = portal.vertices.size();
    for (size_t i = 0; i < places.size(); ++i) {
      portal.vertices.push_back(map.point(places[i]));
      if (!is_finite(portal.vertices.back()))
        d_.fail(place("accessors", accessor), fmt::format("vertex {} is not finite", i));
    }
    std::vector<uint32_t> corner;
    if (p.indices != kNone) {
      corner = read_indices(d_, p.indices, places.size());
    } else {
      corner.resize(places.size());
      std::iota(corner.begin(), corner.end(), 0u);
    }
    const size_t n = list ? corner.size() / 3 : corner.size() < 3 ? 0 : corner.size() - 2;
    triangles_ += n;
    if (triangles_ > kMostTriangles)
      d_.fail(where, fmt::format("more than {} triangles, too many for portals", kMostTriangles));
    for (size_t t = 0; t < n; ++t) {
      std::array<uint32_t, 3> tri;
      if (list)
        tri = {corner[3 * t], corner[3 * t + 1], corner[3 * t + 2]};
      else if (strip)
        tri = {corner[t], corner[t + 1 + t % 2], corner[t + 2 - t % 2]};
      else
        tri = {corner[t + 1], corner[t + 2], corner[0]};
      for (uint32_t& v : tri) v += static_cast<uint32_t>(base);
      if (map.mirrors()) std::swap(tri[1], tri[2]);
      const Vec3d &a = portal.vertices[tri[0]], &b = portal.vertices[tri[1]],
                  &c = portal.vertices[tri[2]];
      // Twice the area compared with the squared longest edge: needles thinner than rounding have
      // no area.
      const double longest = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
      if (length(cross(b - a, c - a)) > 1e-7 * longest) portal.triangles.push_back(tri);
    }
  }

  const Document& d_;
  std::vector<bool> both_ways_;  // by material
  size_t vertices_ = 0, triangles_ = 0;
};

}  // namespace

double area_of(const Portal& portal) {
  double sum = 0;
  for (const auto& t : portal.triangles)
    sum += 0.5 * length(cross(portal.vertices[t[1]] - portal.vertices[t[0]],
                              portal.vertices[t[2]] - portal.vertices[t[0]]));
  return sum;
}

PortalFile read_portals(const std::string& path) {
  Document document;
  open_document(path, document);
  return PortalReader(document).read();
}

namespace {

// A node, a mesh and two accessors for each portal, in one buffer.
void add_portal(Glb<Json>& glb, size_t n, const Portal& portal) {
  // Floats are relative to the first vertex, which is in the node's transform in full precision:
  // a portal far from the origin stays planar.
  const Vec3d origin = portal.vertices.empty() ? Vec3d{} : portal.vertices[0];
  std::vector<Vec3f> positions;
  for (const Vec3d& v : portal.vertices) positions.emplace_back(v - origin);
  const size_t position = glb.add_positions(positions),
               indices = glb.add_accessor(portal.triangles, 3 * portal.triangles.size(), "SCALAR",
                                          glb.uint32, glb.indices);
  const std::string name = fmt::format("portal.{}", n);
  const Json primitive = {{"attributes", {{"POSITION", position}}},
                          {"indices", indices},
                          {"material", portal.both_ways ? 1 : 0}};
  glb.add("meshes", {{"name", name}, {"primitives", Json::array({primitive})}});
  Json node = {{"name", name}, {"mesh", n}, {"translation", {origin.x, origin.y, origin.z}}};
  for (const auto& [key, value] : portal.figures)
    if (std::isfinite(value)) node["extras"][key] = value;
  if (!portal.cameras.empty()) node["extras"]["cameras"] = portal.cameras;
  glb.root["scenes"][0]["nodes"].push_back(glb.add("nodes", node));
}

}  // namespace

std::string portal_bytes(const PortalFile& file) {
  Glb<Json> glb;
  Json& root = glb.root;
  root["asset"] = {{"version", "2.0"}, {"generator", "tdpt " TDPT_VERSION}};
  Json& extras = root["asset"]["extras"];
  extras[kPortalVersionKey] = format_version::portal;
  extras["scene_hash"] = file.scene_hash;
  if (file.made_for.size() == 1) extras["camera"] = file.made_for[0];
  if (file.made_for.size() > 1) extras["cameras"] = file.made_for;
  if (!file.provenance.empty()) extras["provenance"] = file.provenance.lines;
  root["scene"] = 0;
  root["scenes"] = Json::array({{{"name", "portals"}}});
  for (size_t n = 0; n < file.portals.size(); ++n) add_portal(glb, n, file.portals[n]);
  if (file.portals.empty()) return glb.file();
  // One for one-way portals and, if needed, another for portals in both directions.
  Json material = {{"name", "portal"},
                   {"alphaMode", "BLEND"},
                   {"pbrMetallicRoughness",
                    {{"baseColorFactor", {1.0, 0.5, 0.1, 0.4}}, {"metallicFactor", 0.0}}}};
  root["materials"].push_back(material);
  material["doubleSided"] = true;
  if (std::any_of(file.portals.begin(), file.portals.end(),
                  [](const Portal& p) { return p.both_ways; }))
    root["materials"].push_back(material);
  return glb.file();
}

namespace {

std::optional<double> figure(const std::map<std::string, double>& figures, const char* key) {
  const auto at = figures.find(key);
  if (at == figures.end()) return {};
  return at->second;
}

}  // namespace

std::string drawback_of(const std::map<std::string, double>& figures) {
  const auto tightness = figure(figures, "tightness"), conductance = figure(figures, "conductance");
  if (tightness && *tightness < kNextToNothing)
    return fmt::format("{} of the lines through it pass from one side to the other",
                       percent_words(*tightness));
  if (conductance && *conductance > kWide)
    return fmt::format("a wide way, {} of the smaller side's light finds it alone",
                       percent_words(*conductance));
  return "";
}

std::string worth_sentence(const std::map<std::string, double>& figures, double area) {
  std::string text = fmt::format("{} m2", number_words(figure(figures, "area").value_or(area), 4));
  if (const auto tightness = figure(figures, "tightness"))
    text += fmt::format(", tightness {:.2f}", *tightness);
  if (const auto conductance = figure(figures, "conductance"))
    text += fmt::format(", conductance {}", number_words(*conductance, 2));
  const std::string drawback = drawback_of(figures);
  return drawback.empty() ? text : text + ": " + drawback;
}

}  // namespace tdpt
